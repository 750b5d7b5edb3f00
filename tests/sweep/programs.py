"""Programs of the tests of sweeps."""

from __future__ import annotations

HEATER = """\
/// How strongly the heater reacts, and what it is to reach.
parameter gain : double = 0.5
parameter target : double = 20.0

/// The largest power.
const strongest = 4 * gain
const T = 100 ms

process Thermostat {
  in  temperature : double @ T
  out power       : double @ T

  communication {
    law : Proportional(gain = gain)
    temperature -> law.temperature
    law.power   -> power
  }

  composition {
    mu law
  }
}

submodel Proportional(gain: double) {
  in  temperature : double
  out power       : double
  power = limit(gain * (target - temperature), 0, strongest)
}

/// Its mass follows from its volume.
submodel Room(volume: double = 2, loss: double = 0.1) {
  in  power       : double
  out temperature : double
  let mass = 0.5 * volume
  state t : double = 15
  der t = (power - loss * (t - 10)) / (mass * 1<s>)
  temperature = t
}

environment House for Thermostat step 10 ms {
  room : Room
  power            -> room.power
  room.temperature -> temperature
}
"""
"""It never ends by itself. ``gain`` and ``target`` are parameters, ``T`` is compiled in."""

FATES = """\
/// 0: it ends; 1: it divides by zero; 2: two processes wait for each other; 3: it never ends; 4: it raises.
parameter fate : int = 0

exception Broken

process Fates {
  out answer : int

  communication {
    var x : int = 0
    left  : Polite
    right : Polite

    left.said  -> right.heard
    right.said -> left.heard
  }

  composition {
    x := fate ;
    if x == 1 then answer ! 10 / (x - 1)
    else if x == 2 then (left || right)
    else if x == 3 then mu (wait 1 s)
    else if x == 4 then (wait 20 ms ; raise Broken)
    else (answer ! 5 ; wait 1 s ; answer ! 7)
  }
}

/// Listens before it speaks.
process Polite {
  in  heard : int
  out said  : int

  communication {
    var got : int = 0
  }

  composition {
    heard ? got ; said ! got
  }
}

submodel Sink {
  in  answer  : int
  out nothing : double
  nothing = 0
}

environment Desk for Fates step 10 ms {
  sink : Sink

  answer -> sink.answer
}
"""
