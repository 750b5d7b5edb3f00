"""Handmade networks, for tests that should not depend on the earlier phases."""

from __future__ import annotations

from cspdiag.base import SourceFile, Span
from cspdiag.model.sampling import Sampling
from cspdiag.model.types import BOOL, DOUBLE, INT, TIME, EnumType, RealType, StructType
from cspdiag.model.units import Unit
from cspdiag.network.ir.actions import (
    AfterEvent,
    AssignValue,
    Branch,
    CatchException,
    ChannelEnd,
    Choice,
    Group,
    IfElse,
    InputEvent,
    ParallelSteps,
    PortEnd,
    RaiseException,
    ReadValue,
    ReadyEvent,
    Repeat,
    RunInstance,
    SequentialSteps,
    SkipStep,
    Target,
    WriteValue,
)
from cspdiag.network.ir.equations import SubmodelEquation
from cspdiag.network.ir.expressions import (
    BinaryOperation,
    FunctionCall,
    LiteralValue,
    ParameterValue,
    PresentTime,
    SignalValue,
    VariableValue,
)
from cspdiag.network.ir.network import (
    ClassParameter,
    Connection,
    Environment,
    ExternalPort,
    InstanceOf,
    LocalChannel,
    NamedConstant,
    Network,
    Port,
    ProcessClass,
    SubmodelClass,
    SubmodelState,
)

TEXT = SourceFile(name="models/hand/hand.csp", text="\n" * 200)
RAD = RealType(unit=Unit(angle=1, text="rad"))
VOLT = RealType(unit=Unit(exponents=(2, 1, -3, -1, 0, 0, 0), text="V"))


TWO_MS = Sampling(2_000_000)


def at(line: int) -> Span:
    return Span(TEXT, line - 1, line - 1)


def integer(value: int) -> LiteralValue:
    return LiteralValue(type=INT, value=value)


def real(value: float) -> LiteralValue:
    return LiteralValue(type=DOUBLE, value=value)


def signal(name: str, type_=DOUBLE) -> SignalValue:
    return SignalValue(type=type_, name=name)


def parameter(name: str, type_=DOUBLE) -> ParameterValue:
    return ParameterValue(type=type_, name=name)


def binary(operator: str, left, right, type_=None) -> BinaryOperation:
    return BinaryOperation(type=type_ or left.type, operator=operator, left=left, right=right)


def port(name: str, direction: str, type_, line: int, **more) -> Port:
    return Port(name=name, direction=direction, type=type_, span=at(line), **more)


def network(classes, top, **more) -> Network:
    values = {
        "name": f"hand_{top.lower()}",
        "source": TEXT.name,
        "top": top,
        "arguments": (),
        "constants": (),
        "enums": (),
        "structs": (),
        "exceptions": (),
        "external_ports": (),
        "environments": (),
        "instances": (),
        "nets": (),
    }
    return Network(classes=tuple(classes), **{**values, **more})


def _var(name: str, type_=INT, initial=None, line: int = 1) -> LocalChannel:
    return LocalChannel(name=name, type=type_, kind="var", initial=initial, span=at(line))


def _sync(name: str, line: int = 1) -> LocalChannel:
    return LocalChannel(name=name, type=INT, kind="sync", span=at(line))


def _instance(name: str, class_name: str, line: int, connections, arguments=(), **more) -> InstanceOf:
    attached = tuple(Connection(port=p, index=i, attachment=a) for p, i, a in connections)
    return InstanceOf(
        name=name, class_name=class_name, span=at(line), connections=attached, arguments=tuple(arguments), **more
    )


def commstime() -> Network:
    """Prefix, Delta, Successor and a Consumer that ends after 100 numbers."""
    number = VariableValue(type=INT, channel="number")

    def read(line: int) -> ReadValue:
        return ReadValue(span=at(line), source=PortEnd("source"), target=Target("number"))

    def write(sink: str, value, line: int) -> WriteValue:
        return WriteValue(span=at(line), sink=PortEnd(sink), value=value)

    def process(name: str, sinks, body, line: int, parameters=(), doc=None) -> ProcessClass:
        ports = [port("source", "in", INT, line + 1), *(port(s, "out", INT, line + 2) for s in sinks)]
        return ProcessClass(
            name=name,
            definition=name,
            doc=doc,
            parameters=tuple(parameters),
            ports=tuple(ports),
            channels=(_var("number", line=line + 3),),
            body=body,
            span=at(line),
        )

    def forever(*steps, until=None) -> Repeat:
        body = SequentialSteps(span=at(1), steps=steps) if len(steps) > 1 else steps[0]
        return Repeat(span=at(1), body=body, until=until)

    first = ClassParameter(name="first", type=INT, span=at(1))
    prefix = process(
        "Prefix",
        ["sink"],
        SequentialSteps(
            span=at(9),
            steps=(write("sink", parameter("first", INT), 9), forever(read(10), write("sink", number, 11))),
        ),
        5,
        [first],
        "Writes a first value, then passes on what it reads",
    )
    delta = process(
        "Delta",
        ["left", "right"],
        forever(
            read(25),
            ParallelSteps(
                span=at(26), steps=(write("left", number, 26), write("right", number, 26)), prioritized=False
            ),
        ),
        20,
    )
    successor = process(
        "Successor", ["sink"], forever(read(35), write("sink", binary("+", number, integer(1)), 36)), 30
    )
    consumer = process("Consumer", [], forever(read(45), until=binary(">=", number, integer(100), BOOL)), 40)
    top = ProcessClass(
        name="Commstime",
        definition="Commstime",
        span=at(50),
        channels=tuple(_sync(name, 51) for name in ("a", "b", "c", "d")),
        instances=(
            _instance(
                "prefix",
                "Prefix",
                52,
                [("source", None, ChannelEnd("d")), ("sink", None, ChannelEnd("a"))],
                [("first", integer(0))],
            ),
            _instance(
                "delta",
                "Delta",
                53,
                [
                    ("source", None, ChannelEnd("a")),
                    ("left", None, ChannelEnd("b")),
                    ("right", None, ChannelEnd("c")),
                ],
            ),
            _instance(
                "successor", "Successor", 54, [("source", None, ChannelEnd("b")), ("sink", None, ChannelEnd("d"))]
            ),
            _instance("consumer", "Consumer", 55, [("source", None, ChannelEnd("c"))]),
        ),
        body=ParallelSteps(
            span=at(57),
            prioritized=False,
            steps=tuple(
                RunInstance(span=at(57), instance=name) for name in ("prefix", "delta", "successor", "consumer")
            ),
        ),
    )
    return network([prefix, delta, successor, consumer, top], "Commstime")


def _low_pass() -> SubmodelClass:
    """A first-order low-pass with a slope limit, and an integrated angle."""
    sample = ClassParameter(name="sample", type=DOUBLE, derived=True, span=at(61))
    tau = ClassParameter(name="tau", type=TIME, span=at(60))
    tau_seconds = FunctionCall(type=DOUBLE, function="seconds", arguments=(parameter("tau", TIME),))

    def equation(name: str, value, line: int) -> SubmodelEquation:
        return SubmodelEquation(name=name, type=value.type, value=value, span=at(line))

    gain = binary("/", parameter("sample"), binary("+", tau_seconds, parameter("sample")))
    filtered = binary(
        "+",
        signal("held"),
        binary("*", signal("gain"), binary("-", signal("feedback"), signal("held"))),
    )
    limited = FunctionCall(
        type=DOUBLE,
        function="limit",
        arguments=(
            binary("*", parameter("stiffness"), binary("-", signal("set"), signal("filtered"))),
            real(-12.0),
            real(12.0),
        ),
    )
    return SubmodelClass(
        name="PositionController",
        definition="PositionController",
        doc="Holds a joint at its set-point through a low-pass filter.",
        span=at(60),
        parameters=(tau, ClassParameter(name="stiffness", type=VOLT, span=at(60)), sample),
        ports=(
            port("feedback", "in", RAD, 61),
            port("set", "in", DOUBLE, 62),
            port("control", "out", VOLT, 63),
            port("stop", "out", BOOL, 64),
        ),
        constants=(equation("gain", gain, 65),),
        states=(SubmodelState(name="held", type=DOUBLE, initial=real(0.0), continuous=False, span=at(66)),),
        equations=(
            equation("filtered", filtered, 67),
            equation("control", limited, 68),
            equation(
                "stop",
                binary(">", FunctionCall(type=DOUBLE, function="abs", arguments=(signal("control"),)), real(6.0), BOOL),
                69,
            ),
        ),
        next_values=(("held", signal("filtered")),),
    )


def joint() -> Network:
    """One joint that follows a stick until a button is pressed, in an environment with a continuous plant."""
    servo = _low_pass()
    status = VariableValue(type=INT, channel="status")
    follow = ProcessClass(
        name="MotionControl",
        definition="MotionControl",
        doc="Servo that follows the joystick until the stop button is pressed, then releases the motor.",
        span=at(10),
        parameters=(
            ClassParameter(name="T", type=TIME, span=at(10)),
            ClassParameter(name="stiffness", type=VOLT, span=at(10)),
            ClassParameter(name="sample", type=DOUBLE, derived=True, span=at(10)),
        ),
        ports=(
            port("feedback", "in", RAD, 11, period=parameter("T", TIME)),
            port("joystick_axis", "in", DOUBLE, 12, period=parameter("T", TIME), doc="From -1 to 1."),
            port("joystick_buttons", "in", INT, 13),
            port("control", "out", VOLT, 14, period=parameter("T", TIME)),
            port("max", "out", BOOL, 15),
        ),
        channels=(_var("status", INT, integer(0), 17), _var("stopped", BOOL, None, 18)),
        instances=(
            _instance(
                "servo",
                "PositionController",
                16,
                [
                    ("feedback", None, PortEnd("feedback")),
                    ("set", None, PortEnd("joystick_axis")),
                    ("control", None, PortEnd("control")),
                    ("stop", None, ChannelEnd("stopped")),
                ],
                [
                    ("tau", LiteralValue(type=TIME, value=500_000, name="Filter")),
                    ("stiffness", parameter("stiffness")),
                    ("sample", parameter("sample")),
                ],
            ),
        ),
        body=SequentialSteps(
            span=at(20),
            steps=(
                Repeat(
                    span=at(20),
                    body=Choice(
                        span=at(21),
                        prioritized=True,
                        branches=(
                            Branch(
                                span=at(21),
                                condition=None,
                                event=InputEvent(
                                    span=at(21), source=PortEnd("joystick_buttons"), target=Target("status")
                                ),
                                body=SkipStep(span=at(21)),
                            ),
                            Branch(
                                span=at(22),
                                condition=None,
                                event=ReadyEvent(span=at(22), source=PortEnd("feedback")),
                                body=RunInstance(span=at(22), instance="servo"),
                            ),
                        ),
                    ),
                    until=binary("==", status, integer(2), BOOL),
                ),
                WriteValue(span=at(23), sink=PortEnd("control"), value=real(0.0)),
                WriteValue(span=at(24), sink=PortEnd("max"), value=VariableValue(type=BOOL, channel="stopped")),
            ),
        ),
    )
    top = ProcessClass(
        name="Joint",
        definition="Joint",
        span=at(30),
        doc="One joint of the end-effector",
        ports=(
            port("feedback", "in", RAD, 31),
            port("axis", "in", DOUBLE, 32),
            port("buttons", "in", INT, 33),
            port("control", "out", VOLT, 34),
        ),
        channels=(_var("at_max", BOOL, None, 35), _var("misses", INT, integer(0), 35)),
        instances=(
            _instance(
                "motionControl",
                "MotionControl",
                36,
                [
                    ("feedback", None, PortEnd("feedback")),
                    ("joystick_axis", None, PortEnd("axis")),
                    ("joystick_buttons", None, PortEnd("buttons")),
                    ("control", None, PortEnd("control")),
                    ("max", None, ChannelEnd("at_max")),
                ],
                [
                    ("T", LiteralValue(type=TIME, value=2_000_000, name="Tsh")),
                    ("stiffness", real(24.0)),
                    ("sample", real(0.002)),
                ],
            ),
        ),
        body=Group(
            span=at(40),
            label="horizontal",
            body=SequentialSteps(
                span=at(40),
                steps=(
                    CatchException(
                        span=at(40),
                        body=RunInstance(span=at(40), instance="motionControl"),
                        exception="Timeout",
                        handler=AssignValue(
                            span=at(41),
                            target=Target("misses"),
                            value=binary("+", VariableValue(type=INT, channel="misses"), integer(1)),
                        ),
                    ),
                    IfElse(
                        span=at(42),
                        condition=binary(
                            "and",
                            VariableValue(type=BOOL, channel="at_max"),
                            binary(">", VariableValue(type=INT, channel="misses"), integer(3), BOOL),
                        ),
                        then=RaiseException(span=at(42), exception="Overloaded"),
                        otherwise=Choice(
                            span=at(43),
                            prioritized=False,
                            branches=(
                                Branch(
                                    span=at(43),
                                    condition=binary("==", VariableValue(type=INT, channel="misses"), integer(0), BOOL),
                                    event=AfterEvent(span=at(43), duration=LiteralValue(type=TIME, value=5_000_000)),
                                    body=SkipStep(span=at(43)),
                                ),
                                Branch(
                                    span=at(44),
                                    condition=None,
                                    event=InputEvent(span=at(44), source=PortEnd("buttons"), target=Target("misses")),
                                    body=SkipStep(span=at(44)),
                                ),
                            ),
                        ),
                    ),
                ),
            ),
        ),
    )
    return network(
        [servo, follow, top],
        "Joint",
        constants=(
            NamedConstant(name="Tsh", type=TIME, value=2_000_000, span=at(1), doc="Sample period of the joint."),
            NamedConstant(name="Filter", type=TIME, value=500_000, span=at(2)),
        ),
        exceptions=("Overloaded",),
        enums=(EnumType(name="Mode", literals=("idle", "run", "real")),),
        structs=(
            StructType(
                name="Pose", fields=(("x", DOUBLE), ("mode", EnumType(name="Mode", literals=("idle", "run", "real"))))
            ),
        ),
        external_ports=(
            ExternalPort(name="feedback", direction="in", type=RAD, sampling=TWO_MS, span=at(31)),
            ExternalPort(name="axis", direction="in", type=DOUBLE, sampling=TWO_MS, span=at(32)),
            ExternalPort(name="buttons", direction="in", type=INT, span=at(33)),
            ExternalPort(name="control", direction="out", type=VOLT, sampling=TWO_MS, safe=0.0, span=at(34)),
        ),
        environments=(_bench(),),
    )


def _bench() -> Environment:
    def equation(name: str, value, line: int) -> SubmodelEquation:
        return SubmodelEquation(name=name, type=value.type, value=value, span=at(line))

    speed, angle = signal("pan.speed"), signal("pan.angle")
    torque = binary("*", signal("pan.gain"), binary("-", signal("control"), binary("*", real(0.25), speed)))
    system = SubmodelClass(
        name="Bench",
        definition="Bench",
        span=at(80),
        ports=(
            port("control", "in", VOLT, 34),
            port("feedback", "out", RAD, 31),
            port("axis", "out", DOUBLE, 32),
            port("buttons", "out", INT, 33),
        ),
        constants=(equation("pan.inertia", real(1e-3), 81), equation("pan.gain", real(0.05), 82)),
        states=(
            SubmodelState(name="pan.angle", type=DOUBLE, initial=real(0.3), continuous=True, span=at(83)),
            SubmodelState(name="pan.speed", type=DOUBLE, initial=real(0.0), continuous=True, span=at(84)),
            SubmodelState(name="hand.count", type=INT, initial=integer(0), continuous=False, span=at(85)),
        ),
        equations=(
            equation("pan.torque", torque, 86),
            equation("feedback", angle, 87),
            equation("axis", FunctionCall(type=DOUBLE, function="sin", arguments=(PresentTime(type=DOUBLE),)), 88),
            equation(
                "buttons",
                BinaryOperation(
                    type=INT,
                    operator="/",
                    left=signal("hand.count", INT),
                    right=integer(1000),
                ),
                89,
            ),
        ),
        next_values=(("hand.count", binary("+", signal("hand.count", INT), integer(1))),),
        derivative_equations=(equation("pan.torque", torque, 86),),
        derivatives=(("pan.angle", speed), ("pan.speed", binary("/", signal("pan.torque"), signal("pan.inertia")))),
        step=500_000,
    )
    return Environment(name="Bench", doc="A motor on a table.", span=at(80), system=system, drivers=(), step=1_000_000)


ALL = {"hand_commstime": commstime, "hand_joint": joint}
