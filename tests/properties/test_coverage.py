"""Random programs contain every construct, in every place where implementations treat it differently."""

from __future__ import annotations

from collections import Counter
from itertools import product

from cspdiag.base import SourceFile
from tests.conformance.sources import network_of
from tests.properties.constructs import constructs
from tests.properties.drawing import draw_programs

EVENTS = ("InputEvent", "OutputEvent", "ReadyEvent", "AfterEvent", "SkipEvent")
OPERATORS = ("ParallelSteps", "Choice", "Repeat", "WhileLoop", "CatchException", "InterruptOn", "Group")
CHANNELS = ("sync", "any", "broadcast", "buffer", "overwrite", "var")

WANTED = {
    *(f"{choice} with {event}{condition}"
      for choice, event, condition in product(
          ("Choice", "Choice prioritized"), EVENTS, ("", " under a condition"))),
    *(f"InterruptOn with {event}{condition}"
      for event, condition in product(EVENTS[:4], ("", " under a condition"))
      if (event, condition) != ("ReadyEvent", " under a condition")),
    *(f"channel {kind}" for kind in CHANNELS),
    *(f"{kind} with {side} guards" for kind, side in product((*CHANNELS, "sampled", "event"), ("input", "output"))
      if (kind, side) not in {("sampled", "output"), ("event", "output")}),
    "ParallelSteps prioritized", "CatchException of a declared one", "CatchException of Fault",
    "CatchException of Timeout", "RaiseException of a declared one", "Repeat forever", "CountedLoop",
    "StopStep", "WaitStep", "PresentTime", "until of time", "ResetInstance", "IfElse",
    "lone InputEvent", "lone ReadyEvent",
    "array of in ports", "array of out ports", "element of an array of ports", "instance of a process in an array",
    "instance run twice", "process of processes", "several ends of one input", "wcet", "named constant",
    "parameter of a process", "parameter of a submodel", "constant of a submodel", "default of a process's input",
    "default of a submodel's input", "discarded output of a process", "discarded output of a submodel",
    "array of submodel inputs", "array of submodel outputs", "integration rk4", "integration euler in steps",
    "continuous state of double", "discrete state of an enum", "discrete state of int8", "discrete state of bool",
    "discrete state of an array of int", "discrete state of a struct of double and int",
    "sampled input", "sampled output with safe value", "sampled input with offset",
    "sampled output with offset with safe value", "sampled output immediate with safe value", "event input",
    "event input any", "event input broadcast", "event output", "on miss count", "on miss timeout",
    "assignment to an element", "run of a process in a parallel", "run of a submodel in a parallel",
    *(f"channel of {kind}" for kind in (
        "bool", "int", "int8", "int16", "uint16", "double", "float", "time", "an enum", "an array of int",
        "a struct of double and int", "a struct of a struct of double and int and an array of int")),
    *(f"{function} of double" for function in (
        "abs", "min", "max", "limit", "sign", "sqrt", "exp", "log", "sin", "cos", "tan", "atan2",
        "floor", "ceil", "round", "quantize", "deadzone")),
    *(f"{operator} on int" for operator in ("+", "-", "*", "/", "%", "^", "==", "<")),
}  # fmt: skip
"""Constructs under the names that ``constructs`` uses."""

NESTED = {f"{inner} in {outer}" for inner, outer in product(OPERATORS, OPERATORS)}


def test_every_construct_occurs() -> None:
    found: Counter[str] = Counter()

    def count(text: str) -> None:
        found.update(constructs(network_of(SourceFile(name="random.csp", text=text))))

    for start in range(14):
        draw_programs(count, 15, start)
        if set(found) >= WANTED and len(NESTED & set(found)) >= 0.8 * len(NESTED):
            break
    assert sorted(WANTED - set(found)) == []
    assert len(NESTED & set(found)) >= 0.8 * len(NESTED)
