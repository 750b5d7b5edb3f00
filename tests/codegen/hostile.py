"""Texts that would do harm, or break generated files, if anything took them for more than text."""

from __future__ import annotations

import re

TEXTS = {
    "python": 'Nice. """ + str(__import__("os").system("touch executed")) + """ End',
    "raw": "'''; __import__('os').system('touch executed'); '''",
    "quotes": 'He said "stop"""',
    "backslash": r"Reads C:\users\new\x.log and \N{no such name} \777 \u12, ends in \ ".strip(),
    "backslash and quote": 'Ends in \\"',
    "line": "one\rimport os; os.system('touch executed')\rtwo",
    "feeds": "one\fimport os\x0btwo\x1cthree\x85import os\u2028import os\u2029four",
    "bidi": "level \u202e } \u2066 user\u2069 is \u200b admin\ufeff",
    "control": "red \x1b[31m\x1b]0;title\x07 bell \x7f\x01\x08 end",
    "comment": '*/ int system(const char *); /* ??/ " */ #error no /* // \\',
    "markup": "]]> <script>alert(1)</script> & &lt; <!-- --> </title></svg> <a href='x'>",
    "template": "{{ 7 * 7 }} {% raw %} {# no #} ${HOME} $(shell touch executed) `touch executed`",
    "format": "%s %n %0A::error::no %(x)s {0} {x!r} $x^2$ \\frac",
    "table": "a | b \\| c `code | span` `` ` `` # 1. [x](y) *b* __init__",
    "letters": "Größe in °C, \u00e9, \U0001f468\u200d\U0001f527, \u4e2d\u6587, \u0301",
    "directive": "-*- coding: utf-7 -*- type: ignore # noqa fmt: off",
    "shell": "'; touch executed; ' && touch executed | tee -a x > y",
    "long": "word " * 60 + "x" * 300,
}
"""Hostile texts, by what they attack."""

FILE_NAMES = [
    'say "hi".csp',
    "it's `this` $(touch executed).csp",
    "back\\slash and\ttab.csp",
    "new\nline.csp",
    "carriage\rimport os.csp",
    "-rf.csp",
    "--output=x.csp",
    "*/ int x; /*.csp",
    "<b>&amp;.csp",
    "%0A::error::x.csp",
    "\u202egnp.csp",
    "\x1b[31mred.csp",
    "not UTF-8 \udcff\udc80.csp",
    "two:3:4,5.csp",
    "#comment.csp",
]


def program(text: str, string: str = "plain") -> str:
    """A program with a doc comment of ``text`` everywhere where one is allowed, comments within text that is copied,
    and strings in its arguments.
    """
    doc = "\n".join(f"/// {line}" for line in re.split(r"[\r\n]", text))
    inside = "" if "*/" in text else f" /* {text} */"
    return _PROGRAM.replace("///", doc).replace("/*inside*/", inside).replace("a string", string.replace('"', "'"))


_PROGRAM = """
///
const Tc = 10 ms
///
const gain = 2.0

///
enum Mode { off, low, high }

///
struct Pose {
  x : double<m>
  y : double<m>
}

///
exception Broken

///
submodel Law(
  ///
  kp : double = 3.0
) {
  ///
  in  error : double
  ///
  out steer : double
  ///
  let twice = 2 * error
  ///
  state sum : double = 0
  ///
  next sum = sum + twice /*inside*/
  steer = kp * sum
}

///
driver Wheel(name : text, place : int = 1) python "installed.wheel:Wheel" {
  ///
  in steer : double
}

///
process Inner(
  ///
  n : int = 3
) {
  ///
  in  level : double @ Tc
  ///
  in  stop  : int
  ///
  out steer : double @ Tc
  ///
  out mode  : Mode

  communication {
    ///
    var v : double = 0
    ///
    var s : int = 0
    ///
    var w : double
    ///
    law : Law(kp = gain)
    v -> law.error
    law.steer -> w
  }

  composition {
    ///
    (mu (
      ///
      stop ? s -> mode ! Mode.high
      []> when s /*inside*/ < n & level ? v -> (law ; mode ! (if s > 0 then Mode.low else Mode.off) ; steer ! v + w)
    ) until s == 1) catch Broken -> skip
  }
}

///
process Outer {
  ///
  in  level : double @ Tc
  ///
  in  stop  : int
  ///
  out steer : double @ Tc
  ///
  out mode  : Mode

  communication {
    ///
    inner : Inner
    level -> inner.level
    stop  -> inner.stop
    ///
  inner.steer -> steer
    inner.mode  -> mode
  }

  composition {
    label_of_it: inner /*inside*/
  }
}

///
submodel Plant {
  ///
  in  steer : double = 0.5
  ///
  out level : double
  ///
  out stop  : int
  ///
  state wave : double = 0
  ///
  next wave = wave + 0.01 * sign(steer + 2)
  level = wave
  stop = if wave > 0.3 then 1 else 0
}

///
environment Bench for Outer step 1 ms {
  ///
  plant : Plant
  steer -> plant.steer
  plant.level -> level
  plant.stop -> stop
  mode -> _
}

///
environment Rig for Outer step 1 ms {
  ///
  plant : Plant
  ///
  wheel : Wheel(name = "a string")
  plant.level -> level
  plant.stop -> stop
  steer -> wheel.steer
  mode -> _
}
"""
