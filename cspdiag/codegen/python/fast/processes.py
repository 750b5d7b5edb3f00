"""Process classes as Python modules: the constructor makes what the process owns, ``steps`` contains its code."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cspdiag.base.record import replaced
from cspdiag.codegen.options import Options
from cspdiag.codegen.python.fast.actions import Composition
from cspdiag.codegen.python.fast.cancellation import checked_classes
from cspdiag.codegen.python.fast.communications import Communications
from cspdiag.codegen.python.fast.expressions import FastPrinter
from cspdiag.codegen.python.fast.spelling import Spelling, is_alternated, is_inline
from cspdiag.codegen.python.fast.statements import assigned
from cspdiag.codegen.python.fast.temporaries import Temporaries
from cspdiag.codegen.python.fast.whole_program import classes_of_elements, has_levels, has_parts_by_hand, keeps_state
from cspdiag.codegen.python.plain.constructors import ConstructorWriter
from cspdiag.codegen.python.plain.docs import class_doc
from cspdiag.codegen.python.plain.external import ExternalModules
from cspdiag.codegen.python.plain.instances import Instances, path
from cspdiag.codegen.python.plain.members import Array, Row
from cspdiag.codegen.python.plain.processes import all_readers
from cspdiag.codegen.python.text.code import (
    FALSE,
    SELF,
    TRUE,
    Code,
    Comprehension,
    Constant,
    Name,
    Prefix,
    WholeNumber,
    attributes_of_self,
    call,
    own,
    tuple_of,
)
from cspdiag.codegen.python.text.imports import Imports, member_order
from cspdiag.codegen.python.text.literals import docstring, quoted
from cspdiag.codegen.python.text.modules import ClassModule
from cspdiag.codegen.python.text.names import PackageNames
from cspdiag.codegen.python.text.splitting import methods
from cspdiag.codegen.python.text.statements import (
    RAISE,
    YIELD,
    Assign,
    Block,
    Declare,
    Function,
    Statement,
    Statements,
    assign,
    attributes_set,
    bound_in,
    if_,
    lines,
    nonlocal_,
    run,
    try_,
)
from cspdiag.codegen.python.text.types import annotation
from cspdiag.codegen.shared.trees import nodes
from cspdiag.network.elaborate.fewer.rows import without_repeated
from cspdiag.network.flow.ends import may_end
from cspdiag.network.ir.actions import ChannelEnd, End, PortEnd
from cspdiag.network.ir.external import external_calls
from cspdiag.network.ir.network import (
    CreatedChoice,
    CreatedInstance,
    LocalChannel,
    Medium,
    Network,
    Port,
    ProcessClass,
)

_EXTERNAL_CLASSES = {"constant": "Constant", "sampled": "SampledInput", "latched": "SampledOutput"}


def process_module(
    process: ProcessClass, network: Network, names: PackageNames, modules: ExternalModules, options: Options
) -> ClassModule:
    """The module of a process class of an optimized network."""
    return _ProcessWriter(process, network, names, modules, options).module()


class _ProcessWriter(ConstructorWriter):
    initial: FastPrinter

    def __init__(
        self, process: ProcessClass, network: Network, names: PackageNames, modules: ExternalModules, options: Options
    ) -> None:
        self.process = process
        self.network = network
        self.names = names
        self.modules = modules
        self.spelling = Spelling(process, network, keeps_state(process, network), options.probed)
        self.members = self.spelling.members
        self._name_everything()
        self.imports = Imports(names, taken=self.spelling.taken())
        self.place = names.place(process.span.file, process.span.line)
        temporaries = Temporaries(self.spelling.names)
        spelling = self.spelling
        self.initial = FastPrinter(
            self.imports, parameter=self._argument, signal=spelling.constant_made, temporaries=temporaries
        )
        running = FastPrinter(
            self.imports,
            parameter=spelling.parameter,
            variable=spelling.variable,
            signal=spelling.signal,
            temporaries=temporaries,
        )
        self.traced = options.traced
        self.checked = process.name in checked_classes(network)
        self.tracked = has_parts_by_hand(network) or has_levels(network)
        communications = Communications(
            spelling, self.imports, self.checked, options.traced, self.tracked, has_levels(network)
        )
        self.composition = Composition(spelling, communications, running, self.initial, self.imports, modules)
        self.instances = Instances(network, self.members, self.initial, self.imports, modules)

    def _name_everything(self) -> None:
        """Name every signal before the imports are named."""
        for item in (*self.process.constants, *self.process.states):
            self.spelling.signal(item.name)
        self.spelling.bound.clear()

    def module(self) -> ClassModule:
        process = self.process
        body = self.composition.statements(process.body) if process.body is not None else ()
        steps = self._steps(body)
        constructor = self._constructor()
        slots = sorted({*attributes_set(constructor.body)}, key=member_order)
        attributes = lines([assign("__slots__", tuple_of(Constant(quoted(name)) for name in slots))], "    ")
        is_element = not self.traced and process.name in classes_of_elements(self.network)
        name, base = self.names.classes[process.name], self.imports.runtime("Numbered" if is_element else "Routine")
        facts = {"kind": Constant(quoted(process.definition)), "source": Constant(quoted(self.place))}
        facts |= {"checked": TRUE} if self.checked else {}
        facts |= {"tracked": TRUE} if self.tracked else {}
        bodies = methods((constructor, steps), self.imports)
        attributes += ["", *lines([assign(fact, value) for fact, value in facts.items()], "    ")]
        return ClassModule(
            f"The process {process.definition}.",
            self.imports.lines(),
            f"class {name}({base}):",
            docstring(class_doc(process, self.place, "process"), "    "),
            [attributes, *bodies],
        )

    # The code

    def _steps(self, body: Statements) -> Function:
        spelling, process = self.spelling, self.process
        me, error = spelling["me"], spelling["error"]
        states = tuple(self._initial_states()) if not spelling.runs_again else ()
        declared = tuple(self._declared_variables())
        memories = tuple(assign(name, WholeNumber(0)) for name in self.composition.memories.values())
        for item in external_calls(process):
            spelling.bind(spelling.signal_name(item.name))
        bound = tuple(assign(name, own(name)) for name in spelling.bound)
        task, steps = self.imports.runtime("Task"), self.imports.runtime("Steps")
        code: Statements = (*self._of_run(), *bound, *self.composition.prologue, *states, *declared, *memories)
        for function in self.composition.functions:
            inner = (*nonlocal_(self._set_in(function.body)), *function.body)
            code += (replaced(function, body=self._generator(inner)),)
        failed = (run(own("fail").called(me, error)), RAISE)
        code += (
            *self.composition.prepared,
            *self.composition.communications.owned,
            run(own("start").called(me)),
            try_(*self._generator(body)),
            Block("except", Name("BaseException"), failed, bound=error.text),
        )
        if process.body is None or may_end(process.body):
            code += (run(own("end").called(me)),)
        return Function("steps", ("self", f"{me.text}: {task}"), code, steps)

    def _of_run(self) -> Iterator[Statement]:
        """The local variables for the scheduler of the run, if the code uses them."""
        spelling = self.spelling
        scheduler: Code = spelling["me"].field("scheduler")
        if "scheduler" in spelling.run:
            yield assign(spelling["scheduler"], scheduler)
            scheduler = spelling["scheduler"]
        for helper in ("queue", "observe"):
            if helper in spelling.run:
                yield assign(spelling[helper], scheduler.field(helper))

    @staticmethod
    def _generator(body: Statements) -> Statements:
        """The body as that of a generator, even if it never waits."""
        waits = any(node == YIELD or (isinstance(node, Prefix) and node.text == "yield from ") for node in nodes(body))
        return body if waits else (*body, if_(FALSE, YIELD))

    def _set_in(self, body: Statements) -> list[str]:
        """Local variables of ``steps`` that the statements of a nested function assign."""
        candidates = self.spelling.shared() | set(self.composition.memories.values())
        return sorted(candidates.intersection(bound_in(body)))

    def _initial_states(self) -> Iterator[Statement]:
        printer = self.composition.printer
        for state in self.process.states:
            target = self.spelling.signal(state.name)
            place = self.composition.place_of(state)
            yield from assigned(target, printer, state.initial, place, annotation(state.type, self.imports))

    def _declared_variables(self) -> Iterator[Statement]:
        channels = {channel.name: channel for channel in self.process.channels}
        for name, local in self.spelling.local_declarations():
            channel = channels[name]
            type_ = annotation(channel.type, self.imports)
            if channel.initial is None or self.spelling.runs_again:
                yield Declare(Name(local), type_)
            else:
                yield Assign(Name(local), self.composition.printer.print(channel.initial), annotation=type_)

    # The constructor

    def _constructor(self) -> Function:
        statements: Statements = (
            run(call(call("super").field("__init__"), Name("name"))),
            *self._stored_arguments(),
            *self._constants(),
            *self._parts(),
            *self._external_calls(),
            *self._channels(),
            *self._created(),
        )
        return Function("__init__", self._parameters(), statements)

    def _port_annotation(self, port: Port) -> str:
        kinds = {
            self._end_class(medium, port.direction, PortEnd(port.name, None if port.size is None else index))
            for index, medium in enumerate(port.media)
        }
        value = annotation(port.type, self.imports)
        if len(kinds) == 1:
            one = f"{self.imports.runtime(kinds.pop())}[{value}]"
        else:
            one = self.imports.standard("typing", "Any")
        return one if port.size is None else f"{self.imports.standard('collections.abc', 'Sequence')}[{one}]"

    def _end_class(self, medium: Medium, direction: str, end: End) -> str:
        if self.spelling.is_dedicated(end):
            return "Dedicated"
        if is_inline(medium):
            return "Alternated" if is_alternated(medium) else "Rendezvous"
        if medium.kind == "var":
            return "Variable"
        if medium.kind in _EXTERNAL_CLASSES:
            return _EXTERNAL_CLASSES[medium.kind]
        return "In" if direction == "in" else "Out"

    def _stored_arguments(self) -> Iterator[Statement]:
        """Parameters and ports that the code or its guards use."""
        guards = set(attributes_of_self(tuple(self.composition.choices.values())))
        read = {end.port for end in self.members.reading_ends if isinstance(end, PortEnd)}
        for name in (item.name for item in (*self.process.parameters, *self.process.ports)):
            python = self.members.arguments[name]
            if (python in self.spelling.bound or python in guards) and name not in read:
                yield assign(own(python), Name(python))
        ends = [end for end in self.members.reading_ends if isinstance(end, PortEnd) and not self._has_end(end)]
        if not ends:
            return
        made = guards.union(*(attributes_of_self(self.instances.made(item)) for item in self.process.instances))
        ports = {self.members.end_name(end): self.members.arguments[end.port] for end in ends}
        for name, port in ports.items():
            if name in self.spelling.bound or name in made:
                yield assign(own(name), Name(port))

    def _has_end(self, end: End) -> bool:
        """Whether a reading end is an object of its own."""
        kind = self.spelling.medium(end).kind
        return kind in ("sampled", "event", "broadcast")

    def _constants(self) -> Iterator[Statement]:
        for item in self.process.constants:
            target = self.spelling.constant_made(item.name)
            yield from assigned(target, self.initial, item.value, self.composition.place_of(item))
        if self.spelling.runs_again:
            for state in self.process.states:
                target, place = self.spelling.signal(state.name), self.composition.place_of(state)
                yield from assigned(target, self.initial, state.initial, place, annotation(state.type, self.imports))

    def _parts(self) -> Iterator[Statement]:
        if not self.spelling.parts:
            return
        class_ = self.imports.runtime("Inlined")
        for scope in self.spelling.scopes:
            source = Constant(quoted(self.names.place(scope.span.file, scope.span.line)))
            made = call(class_, path(scope.instance), Constant(quoted(scope.class_name)), source=source)
            yield assign(own(self.spelling.parts[scope.instance]), made)
        for law, action in self.spelling.laws.items():
            source = Constant(quoted(self.names.place(action.span.file, action.span.line)))
            yield assign(own(self.spelling.parts[law]), call(class_, path(law), source=source))

    def _external_calls(self) -> Iterator[Statement]:
        for item in external_calls(self.process):
            given = {name: self.initial.print(value) for name, value in item.arguments}
            made = self.modules.construct(item.external, given, self.imports)
            yield assign(own(self.spelling.signal_name(item.name)), made)

    def _channels(self) -> Iterator[Statement]:
        channels: Sequence[LocalChannel] = self.process.channels
        if self.spelling.has_locals:
            channels = [channel for channel in channels if not self.spelling.is_local(channel.name)]
        yield from self._channels_made(channels)

    def _have_one_class(self, channels: Sequence[Row]) -> bool:
        return len(set(self.spelling.are_dedicated(channels))) == 1

    def _channel_class(self, channel: LocalChannel) -> str:
        medium = Medium(channel.kind, channel.guarded_reads, channel.guarded_writes)
        if not is_inline(medium):
            return super()._channel_class(channel)
        return self._end_class(medium, "in", ChannelEnd(channel.name))

    def _created(self) -> Iterator[Statement]:
        """Reading ends, instances and alternatives, in the required order of creation."""
        instances = {item.name: item for item in self.process.instances}
        made_ends: set[str] = set()
        made_arrays: set[str] = set()
        done: set[str] = set()
        choices = dict(self.composition.choices)
        for item in self._creation():
            match item:
                case CreatedInstance(instance=name):
                    if name in instances:
                        yield from self._made_instance(instances[name], made_arrays)
                        done.add(name)
                case CreatedChoice(choice=name):
                    if name in choices:
                        yield assign(own(self.composition.choice_names[name]), choices.pop(name))
                case PortEnd() | ChannelEnd():
                    yield from self._made_end(item, made_ends)
        for end in self.members.reading_ends:
            yield from self._made_end(end, made_ends)
        for instance in self.members.with_lists_once(self.process.instances):
            if instance.name not in done:
                yield from self._made_instance(instance, made_arrays)
        for name, choice in choices.items():
            yield assign(own(self.composition.choice_names[name]), choice)

    def _creation(self) -> Iterator[End | CreatedInstance | CreatedChoice]:
        """What is created, in order, but of instances that are known to repeat and to be elements of lists only the
        first.
        """

        def is_element(item: End | CreatedInstance | CreatedChoice) -> bool:
            return isinstance(item, CreatedInstance) and self.members.place_of(item.instance) is not None

        return without_repeated(self.process.creation, is_element)

    def _array(self, array: Array, elements: Code) -> Code:
        if self.traced or not isinstance(elements, Comprehension) or not self._has_label(array.rows[0].name):
            return elements
        return replaced(elements, brackets=f"{self.imports.runtime('numbered')}()")

    def _has_label(self, element: str) -> bool:
        """Whether a channel or an instance can share the names of its array."""
        for channel in self.process.channels:
            if channel.name == element:
                return is_inline(Medium(channel.kind, channel.guarded_reads, channel.guarded_writes))
        instance = next(item for item in self.process.instances if item.name == element)
        class_ = self.network.class_named(instance.class_name)
        return isinstance(class_, ProcessClass) and class_.external is None

    def _made_end(self, end: End, made: set[str]) -> Iterator[Statement]:
        if end not in self.members.reading_ends or not self._has_end(end):
            return
        name = self.members.end_name(end)
        if name in made:
            return
        made.add(name)
        owner = self._owner(end)
        if isinstance(end, ChannelEnd):
            yield assign(own(name), self.members.channel(end.channel).call("reader", owner))
            return
        port = self.members.arguments[end.port]
        size = next(item.size for item in self.process.ports if item.name == end.port)
        readers = Name(port).call("reader", owner) if size is None else all_readers(port, owner)
        yield assign(own(name), readers)

    def _owner(self, end: End) -> Code:
        """The process that an end belongs to: an inlined one, or this one."""
        for scope in self.spelling.scopes:
            if end in scope.ends:
                return own(self.spelling.parts[scope.instance])
        return SELF
