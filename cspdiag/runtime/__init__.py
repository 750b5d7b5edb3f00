"""A runtime for communicating sequential processes.

Processes communicate over channels by rendezvous, choose between communications with alternatives, and run in sequence,
in parallel and in prioritized parallel, in virtual or in real time. Needs nothing but the standard library.
"""

from __future__ import annotations

from .channels.any_channel import AnyChannel
from .channels.broadcast import Broadcast
from .channels.buffers import Buffer, Overwriting
from .channels.channel import Channel
from .channels.converting import Converting
from .channels.ports import In, Out
from .channels.selector import lower_bits
from .channels.variable import Constant, Discard, Variable
from .choice.alternative import Alternative
from .choice.guards import After, Input, Output, Ready, Skip
from .choice.interrupt import interrupt, interrupted
from .choice.together import read_all, write_all
from .compiled.arithmetic import (
    acos,
    asin,
    atan,
    atan2,
    ceil,
    cos,
    deadzone,
    duration,
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
from .compiled.linear import rk4_matrices
from .compiled.numbered import numbered
from .compiled.rendezvous import Alternated, Dedicated, Rendezvous
from .compiled.routine import Inlined, Numbered, Part, Routine, Steps, end_group, start_group
from .composition import Rounds, group, now, parallel, prioritized_parallel, stop, wait
from .deadlock.reports import DeadlockReport, WaitingProcess
from .kernel.durations import ms, nanoseconds, ns, s, seconds, us
from .kernel.exceptions import (
    Cancelled,
    ChannelMisuse,
    Deadlock,
    DriverError,
    EnvironmentFailure,
    Fault,
    ProcessError,
    Timeout,
)
from .kernel.observer import Observer
from .kernel.parameters import Change, Parameter, ProgramParameters
from .kernel.policy import Option, Policy
from .kernel.scheduler import Task
from .kernel.timers import begin_delay
from .network import Network
from .outcome import Outcome
from .outside.accepted import array, boolean, calculated, double, enumeration, integer, record, single, text
from .outside.drivers import DevicePort, Driver, Signal
from .outside.event_inputs import EventInput
from .outside.external import EventOutput, SampledOutput
from .outside.instants import Environment
from .outside.sampled_inputs import SampledInput
from .process import Process, Submodel
from .real_time.jitter import Jitter

__all__ = [
    "After",
    "Alternated",
    "Alternative",
    "AnyChannel",
    "Broadcast",
    "Buffer",
    "Cancelled",
    "Change",
    "Channel",
    "ChannelMisuse",
    "Constant",
    "Converting",
    "Deadlock",
    "DeadlockReport",
    "Dedicated",
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
    "Numbered",
    "Observer",
    "Option",
    "Out",
    "Outcome",
    "Output",
    "Overwriting",
    "Parameter",
    "Part",
    "Policy",
    "Process",
    "ProcessError",
    "ProgramParameters",
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
    "calculated",
    "ceil",
    "cos",
    "deadzone",
    "double",
    "duration",
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
    "now",
    "ns",
    "numbered",
    "parallel",
    "power",
    "prioritized_parallel",
    "quantize",
    "quotient",
    "read_all",
    "record",
    "remainder",
    "replaced",
    "rk4_matrices",
    "s",
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
