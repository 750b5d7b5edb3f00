"""A runtime for communicating sequential processes.

Processes communicate over channels by rendezvous, choose between communications with alternatives, and run in sequence, in parallel and
in prioritized parallel, in virtual or in real time. Needs nothing but the standard library.
"""

from __future__ import annotations

from .accepted import array, boolean, double, enumeration, integer, record, single, text
from .alternative import Alternative
from .any_channel import AnyChannel
from .arithmetic import (
    acos,
    asin,
    atan,
    atan2,
    ceil,
    cos,
    deadzone,
    element,
    exp,
    finite,
    float32,
    floor,
    int8,
    int16,
    int32,
    int64,
    limit,
    log,
    nearest,
    power,
    quantize,
    quotient,
    remainder,
    replaced,
    sign,
    sin,
    sqrt,
    tan,
    uint8,
    uint16,
    uint32,
)
from .broadcast import Broadcast
from .buffers import Buffer, Overwriting
from .channel import Channel
from .choice import After, Input, Output, Ready, Skip
from .composition import Rounds, begin_delay, group, parallel, prioritized_parallel, stop, wait
from .deadlock import DeadlockReport, WaitingProcess
from .drivers import DevicePort, Driver, Signal
from .durations import ms, nanoseconds, ns, s, seconds, us
from .exceptions import (
    Cancelled,
    ChannelMisuse,
    Deadlock,
    DriverError,
    EnvironmentFailure,
    Fault,
    ProcessError,
    Timeout,
)
from .external import EventOutput, SampledOutput
from .inputs import EventInput, SampledInput
from .instants import Environment
from .interrupt import interrupt, interrupted
from .network import Network
from .observer import Observer
from .outcome import Jitter, Outcome
from .ports import In, Out
from .process import Process, Submodel
from .rendezvous import Alternated, Rendezvous
from .routine import Inlined, Part, Routine, Steps, end_group, push, start_group
from .scheduler import Task, scheduler
from .selector import lower_bits
from .together import read_all, write_all
from .variable import Constant, Discard, Variable

__all__ = [
    "After",
    "Alternated",
    "Alternative",
    "AnyChannel",
    "Broadcast",
    "Buffer",
    "Cancelled",
    "Channel",
    "ChannelMisuse",
    "Constant",
    "Deadlock",
    "DeadlockReport",
    "DevicePort",
    "Discard",
    "Driver",
    "DriverError",
    "Environment",
    "EnvironmentFailure",
    "EventInput",
    "EventOutput",
    "Fault",
    "In",
    "Inlined",
    "Input",
    "Jitter",
    "Network",
    "Observer",
    "Out",
    "Outcome",
    "Output",
    "Overwriting",
    "Part",
    "Process",
    "ProcessError",
    "Ready",
    "Rendezvous",
    "Rounds",
    "Routine",
    "SampledInput",
    "SampledOutput",
    "Signal",
    "Skip",
    "Steps",
    "Submodel",
    "Task",
    "Timeout",
    "Variable",
    "WaitingProcess",
    "acos",
    "array",
    "asin",
    "atan",
    "atan2",
    "begin_delay",
    "boolean",
    "ceil",
    "cos",
    "deadzone",
    "double",
    "element",
    "end_group",
    "enumeration",
    "exp",
    "finite",
    "float32",
    "floor",
    "group",
    "int8",
    "int16",
    "int32",
    "int64",
    "integer",
    "interrupt",
    "interrupted",
    "limit",
    "log",
    "lower_bits",
    "ms",
    "nanoseconds",
    "nearest",
    "ns",
    "parallel",
    "power",
    "prioritized_parallel",
    "push",
    "quantize",
    "quotient",
    "read_all",
    "record",
    "remainder",
    "replaced",
    "s",
    "scheduler",
    "seconds",
    "sign",
    "sin",
    "single",
    "sqrt",
    "start_group",
    "stop",
    "tan",
    "text",
    "uint8",
    "uint16",
    "uint32",
    "us",
    "wait",
    "write_all",
]
