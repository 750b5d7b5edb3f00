"""Submodel classes as Python modules."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from cspdiag.codegen.python.plain.docs import class_doc
from cspdiag.codegen.python.plain.expressions import Printer
from cspdiag.codegen.python.plain.external import ExternalModules, external_call
from cspdiag.codegen.python.plain.laws.integration import Integration
from cspdiag.codegen.python.text.code import PRODUCT, Argument, Call, Code, Constant, Name, awaited, call, own, tuple_of
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.literals import docstring, quoted
from cspdiag.codegen.python.text.modules import ClassModule, parameter_annotation, port_annotation
from cspdiag.codegen.python.text.names import INTEGRATION_LOCALS, MEMBERS, Names, PackageNames, identifier
from cspdiag.codegen.python.text.operators import infix
from cspdiag.codegen.python.text.splitting import methods
from cspdiag.codegen.python.text.statements import Assign, Function, Statement, assign, return_, run, unpack
from cspdiag.codegen.python.text.types import accepted, annotation, duration
from cspdiag.codegen.shared.laws.equations import (
    Equation,
    changes,
    constants_needed,
    defined,
    evaluated_in_runs,
    inputs,
    needed,
    outputs,
    parameters,
    read_after_change,
    signal_types,
    signals,
    values,
)
from cspdiag.model.types import TimeType
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.equations import ExternalBody, ExternalCall
from cspdiag.network.ir.faults import may_fault
from cspdiag.network.ir.network import SubmodelClass

INTEGRATION = INTEGRATION_LOCALS | {"_steps", "_h", "_derivative", "_derivatives"}
"""Names that the integration uses itself, for its variables and for members."""


def signal_names(class_: SubmodelClass) -> Names:
    """Python names of everything in a submodel, for keywords of its constructor, attributes and local variables."""
    names = Names({*MEMBERS, "_body", *(INTEGRATION if class_.derivatives else ())})
    for item in (*class_.parameters, *class_.ports, *class_.states):
        names[item.name]
    return names


def submodel_module(class_: SubmodelClass, names: PackageNames, modules: ExternalModules) -> ClassModule:
    """The module of a submodel class."""
    if class_.external is not None:
        return _BodyWriter(class_, names, modules, class_.external).module()
    return _SubmodelWriter(class_, names, modules).module()


class _SubmodelWriter:
    def __init__(self, class_: SubmodelClass, names: PackageNames, modules: ExternalModules) -> None:
        self.class_ = class_
        self.package = names
        self.modules = modules
        self.names = signal_names(class_)
        self.types = signal_types(class_)
        taken = {self.names[name] for name in self.types}
        self.names.avoid(names.globals)
        self.imports = Imports(names, taken=taken | INTEGRATION)
        self.constants = constants_needed(class_)
        self.integration = Integration(class_, self.names, self._place, self.imports)
        self.attributes = self._attributes()
        self.place = names.place(class_.span.file, class_.span.line)

    def module(self) -> ClassModule:
        functions = [self._constructor()]
        reset = self._reset_statements()
        if reset:
            functions.append(Function("reset", ("self",), tuple(reset)))
        functions += [self._run(), self._calculate()]
        if self.class_.derivatives:
            printer = self._printer(local=[*self.integration.held, *self._moving()])
            functions.append(self.integration.derivatives(printer, self._annotations()))
        name, base = self.package.classes[self.class_.name], self.imports.runtime("Submodel")
        bodies = methods(functions, self.imports)
        return ClassModule(
            f"The submodel {self.class_.definition}.",
            self.imports.lines(),
            f"class {name}({base}):",
            docstring(class_doc(self.class_, self.place, "submodel"), "    "),
            bodies,
        )

    def _place(self, item: Declared) -> str:
        return self.package.place(item.span.file, item.span.line)

    def _annotations(self) -> dict[str, str]:
        return {name: annotation(type_, self.imports) for name, type_ in self.types.items()}

    def _moving(self) -> list[str]:
        continuous = [state.name for state in self.class_.states if state.continuous]
        return [*continuous, *(equation.name for equation in self.class_.derivative_equations)]

    def _calls(self) -> list[ExternalCall]:
        return [equation for equation in self.class_.equations if isinstance(equation, ExternalCall)]

    def _attributes(self) -> set[str]:
        """Parameters and constants that are needed after construction."""
        class_ = self.class_
        late = evaluated_in_runs(class_)
        period = {"sample"} if class_.derivatives and class_.step is None else set()
        return {*signals(late), *parameters(late), *period}

    def _printer(self, *, local: Iterable[str] = (), constructing: bool = False) -> Printer:
        """A printer for which names in ``local`` are local variables and the others attributes."""
        known = set(local)

        def parameter(name: str) -> Code:
            return Name(self.names[name]) if constructing else signal(name)

        def signal(name: str) -> Code:
            return Name(self.names[name]) if name in known else own(self.names[name])

        def seconds(name: str) -> Code:
            if constructing:
                return infix("/", PRODUCT, Name(self.names[name]), Name(self.imports.runtime("s")))
            return parameter(name)

        return Printer(self.imports, parameter=parameter, signal=signal, seconds=seconds)

    def _constructor(self) -> Function:
        class_ = self.class_
        keywords = [f"{self.names[p.name]}: {parameter_annotation(p, self.imports)}" for p in class_.parameters]
        keywords += [f"{self.names[p.name]}: {port_annotation(p, self.imports)}" for p in class_.ports]
        ports = [self.names[port.name] for port in class_.ports]
        statements = (
            run(call(call("super").field("__init__"), Name("name"), source=Constant(quoted(self.place)))),
            *(assign(own(port), Name(port)) for port in ports),
            *self._made(),
        )
        return Function("__init__", ("self", "name: str", *(["*", *keywords] if keywords else [])), statements)

    def _made(self) -> Iterable[Statement]:
        """The statements of the constructor after it has stored the ports."""
        yield from self._kept_parameters()
        yield from self._constants()
        yield from self._sub_steps()
        yield from (self._external_body(item) for item in self._calls())
        if self.class_.states:
            yield run(own("reset").called())

    def _kept_parameters(self) -> Iterable[Statement]:
        for item in self.class_.parameters:
            if item.name in self.attributes:
                python = self.names[item.name]
                value: Code = Name(python)
                if isinstance(item.type, TimeType) and not item.tunable:
                    value = infix("/", PRODUCT, value, Name(self.imports.runtime("s")))
                yield assign(own(python), value)

    def _constants(self) -> Iterable[Statement]:
        local = [item.name for item in self.constants if item.name not in self.attributes]
        printer = self._printer(local=local, constructing=True)
        for item in self.constants:
            python = self.names[item.name]
            target = Name(python) if item.name in local else own(python)
            yield assign(target, printer.print(item.value), self._place(item))

    def _sub_steps(self) -> Iterable[Statement]:
        if not self.class_.derivatives or self.class_.step is None:
            return
        sample = infix("*", PRODUCT, Name(self.names["sample"]), Name(self.imports.runtime("s")))
        step = duration(self.class_.step, self.imports)
        ratio = infix("/", PRODUCT, call("round", sample), step)
        yield assign(own("_steps"), call(self.imports.standard("math", "ceil"), ratio))
        yield assign(own("_h"), infix("/", PRODUCT, Name(self.names["sample"]), own("_steps")))

    def _external_body(self, item: ExternalCall) -> Statement:
        printer = self._printer(constructing=True, local=[])
        given = {name: printer.print(value) for name, value in item.arguments}
        return assign(own(self.names[item.name]), self.modules.construct(item.external, given, self.imports))

    def _reset_statements(self) -> list[Statement]:
        printer = self._printer()
        statements: list[Statement] = [
            assign(
                own(self.names[state.name]),
                printer.print(state.initial),
                self._place(state) if may_fault(state.initial) else None,
            )
            for state in self.class_.states
        ]
        statements += [
            run(own(self.names[item.name]).call("reset"))
            for item in self._calls()
            if self.modules.describe(item.external).has_reset
        ]
        return statements

    def _run(self) -> Function:
        """All inputs are read together, and then all outputs are written together."""
        given = [self.names[name] for name in inputs(self.class_)]
        results = [self.names[name] for name in outputs(self.class_)]
        statements: list[Statement] = []
        if len(given) == 1:
            statements.append(assign(given[0], awaited(own(given[0]).call("read"))))
        elif given:
            read = call(self.imports.runtime("read_all"), *map(own, given))
            statements.append(unpack([*map(Name, given)], awaited(read)))
        statements.append(unpack([*map(Name, results)], own("calculate").called(*map(Name, given))))
        if len(results) == 1:
            statements.append(run(awaited(own(results[0]).call("write", Name(results[0])))))
        elif results:
            pairs = (tuple_of((own(name), Name(name))) for name in results)
            statements.append(run(awaited(call(self.imports.runtime("write_all"), *pairs))))
        return Function("run", ("self",), tuple(statements), waits=True)

    def _calculate(self) -> Function:
        class_ = self.class_
        given, results = inputs(class_), outputs(class_)
        roots = [*results, *signals((class_.next_values,)), *(self.integration.held if class_.derivatives else [])]
        equations = needed(class_.equations, roots)
        expressions = (tuple(part for equation in equations for part in values(equation)), class_.next_values)
        hoisted = self._hoisted(expressions)
        local = [*given, *hoisted, *(name for equation in equations for name in defined(equation))]
        printer = self._printer(local=local)

        statements: list[Statement] = [assign(self.names[name], own(self.names[name])) for name in hoisted]
        statements += [statement for equation in equations for statement in self._equation(equation, printer)]
        if class_.derivatives:
            statements += self._integrate()
        states = changes(class_)
        statements += [
            assign(own(self.names[name]), printer.print(value), self._place(states[name]))
            for name, value in class_.next_values
        ]
        statements += [assign(own(state), Name(state)) for state in self._moved]
        statements += self._returned(statements, results, printer)

        return self._calculation(statements)

    def _calculation(self, statements: Sequence[Statement]) -> Function:
        given, results = inputs(self.class_), outputs(self.class_)
        types = self._annotations()
        parameters_ = [f"{self.names[name]}: {types[name]}" for name in given]
        returned = _return_annotation([types[name] for name in results])
        return Function("calculate", ("self", *parameters_), tuple(statements), returned)

    def _equation(self, equation: Equation, printer: Printer) -> Iterator[Statement]:
        if isinstance(equation, ExternalCall):
            yield from external_call(equation, self.names, printer, self.modules, time=None)
        else:
            yield assign(self.names[equation.name], printer.print(equation.value), self._place(equation))

    def _hoisted(self, expressions: Sequence[object]) -> list[str]:
        """Attributes that are read several times, or after they have changed, and so are first copied to local
        variables.
        """
        class_ = self.class_
        read = signals(expressions) + parameters(expressions)
        discrete = [state.name for state in class_.states if not state.continuous]
        continuous = [state.name for state in class_.states if state.continuous]
        late = read_after_change(class_.next_values)
        candidates = [
            *discrete,
            *(item.name for item in class_.parameters),
            *(item.name for item in self.constants),
        ]
        hoisted = [name for name in candidates if read[name] > 1 or name in late]
        if class_.derivatives:
            hoisted += [name for name in discrete if name in self.integration.held and name not in hoisted]
            hoisted += continuous
        return hoisted

    def _integrate(self) -> Iterable[Statement]:
        if self.class_.step is None:
            yield assign("h", own(self.names["sample"]))
            yield from self.integration.loop(None)
        else:
            yield assign("h", own("_h"))
            yield from self.integration.loop(own("_steps"))
        for name, state in changes(self.class_).items():
            if state.continuous:
                moved = self.names[name]
                yield assign(moved, call(self.imports.runtime("finite"), Name(moved)), self._place(state))

    @property
    def _moved(self) -> list[str]:
        """Continuous states, which are assigned at the same time as the discrete ones."""
        return self.integration.states if self.class_.derivatives else []

    def _returned(self, before: list[Statement], results: list[str], printer: Printer) -> Iterable[Statement]:
        if len(results) == 1:
            last = before[-1] if before else None
            if isinstance(last, Assign) and last.target == Name(self.names[results[0]]):
                before.pop()
                return [return_(last.value, comment=last.comment)]
            return [return_(printer.signal(results[0]))]
        return [return_(*(Name(self.names[name]) for name in results))] if results else []


class _BodyWriter(_SubmodelWriter):
    """A law written by hand: the class around it has its ports, and passes on what it calculates."""

    def __init__(
        self, class_: SubmodelClass, names: PackageNames, modules: ExternalModules, body: ExternalBody
    ) -> None:
        super().__init__(class_, names, modules)
        self.body = body

    def _made(self) -> Iterable[Statement]:
        given = {item.name: Name(self.names[item.name]) for item in self.class_.parameters if not item.derived}
        yield assign(own("_body"), self.modules.construct(self.body, given, self.imports))

    def _reset_statements(self) -> list[Statement]:
        return [run(own("_body").call("reset"))] if self.modules.describe(self.body).has_reset else []

    def _calculate(self) -> Function:
        arguments = tuple(Argument(Name(self.names[name]), identifier(name)) for name in inputs(self.class_))
        calculated = Call(own("_body").field("calculate"), arguments)
        results = outputs(self.class_)
        if not results:
            return self._calculation([run(calculated)])
        annotations = self._annotations()
        names = [Name(self.names[name]) for name in results]
        if len(results) == 1:
            made = self._taken(calculated, results[0])
            return self._calculation(
                [Assign(names[0], made, self.place, annotation=annotations[results[0]]), return_(names[0])]
            )
        taken = [self._taken(name, result) for name, result in zip(names, results, strict=True)]
        return self._calculation([unpack(names, calculated, self.place), return_(*taken)])

    def _taken(self, value: Code, output: str) -> Code:
        """What the body has calculated, as a value of an output."""
        return call(self.imports.runtime("calculated"), value, accepted(self.types[output], self.imports))


def _return_annotation(types: Sequence[str]) -> str:
    if not types:
        return "None"
    return types[0] if len(types) == 1 else f"tuple[{', '.join(types)}]"
