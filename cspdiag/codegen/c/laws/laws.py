"""Submodel classes as pairs of C files: a struct of ports, parameters and states, `reset`, and `calculate` for one
sample.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property

from cspdiag.base.record import record
from cspdiag.codegen.c.laws.calls import STEPS, SUB_STEP, body_name, kernel_of, law_may_fault, law_members, law_verbs
from cspdiag.codegen.c.laws.equations import (
    EquationWriter,
    LocalVariable,
    Target,
    leave_if_faulted,
    record_fault_place,
    without_last_return,
)
from cspdiag.codegen.c.laws.integration import Integration, sub_steps
from cspdiag.codegen.c.text.code import PRODUCT, Code, address, call, cast, code, ignored, infix, own
from cspdiag.codegen.c.text.documents import comment, wrapped
from cspdiag.codegen.c.text.expressions import Printer
from cspdiag.codegen.c.text.kernel import KERNEL
from cspdiag.codegen.c.text.names import Names, PackageNames
from cspdiag.codegen.c.text.statements import (
    Block,
    Function,
    Remark,
    Statement,
    define,
    lines,
    run,
    signature,
    store,
)
from cspdiag.codegen.c.text.types import CTypes
from cspdiag.codegen.shared.laws.equations import (
    changes,
    constants_needed,
    defined,
    evaluated_in_runs,
    held,
    inputs,
    needed,
    outputs,
    parameters,
    read_after_change,
    signal_types,
    signals,
)
from cspdiag.model.types import TimeType, Type, is_single
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.expressions import FunctionCall
from cspdiag.network.ir.network import ClassParameter, SubmodelClass
from cspdiag.network.ir.walk import parts


@record
class LawFiles:
    """Writes the files of one class."""

    class_: SubmodelClass
    names: PackageNames
    types: CTypes

    @cached_property
    def name(self) -> str:
        """The name of the struct and of the files, and the prefix of the functions."""
        return self.names.classes[self.class_.name]

    @cached_property
    def members(self) -> Names:
        """The C names of all signals, states, parameters and constants of the law."""
        return law_members(self.class_, self.names)

    @cached_property
    def signal_types(self) -> dict[str, Type]:
        """The type of every signal."""
        return signal_types(self.class_)

    @cached_property
    def can_fault(self) -> bool:
        """Whether one run can fault."""
        return law_may_fault(self.class_)

    @cached_property
    def _calls(self) -> list[ExternalCall]:
        return [equation for equation in self.class_.equations if isinstance(equation, ExternalCall)]

    @cached_property
    def _used_in_runs(self) -> set[str]:
        """Parameters and constants that are used after `initialize`."""
        late = evaluated_in_runs(self.class_)
        return {*signals(late), *parameters(late)}

    @cached_property
    def _single_seconds(self) -> set[str]:
        """The parameters of type ``time`` that runs only use in seconds of single precision."""
        late = evaluated_in_runs(self.class_)
        uses = [part for part in parts(late) if isinstance(part, FunctionCall) and part.function == "seconds"]
        of_single, of_double = (
            parameters(use for use in uses if is_single(use.type) is kind) for kind in (True, False)
        )
        return set(of_single) - set(of_double)

    @cached_property
    def _sub_steps(self) -> bool:
        return bool(self.class_.derivatives) and self.class_.step is not None

    def files(self) -> dict[str, str]:
        """The header and the source."""
        return {f"{self.name}.h": self._header(), f"{self.name}.c": self._source()}

    def _place(self, item: Declared) -> str:
        return self.names.place(item.span.file, item.span.line)

    # ---- The header

    def _header(self) -> str:
        class_, guard = self.class_, f"{self.name.upper()}_H"
        about = [*wrapped(class_.doc or f"The submodel {class_.definition}."), "", f"Source: {self._place(class_)}"]
        rows = [*comment(about), f"#ifndef {guard}", f"#define {guard}", ""]
        rows += ['#include "csp_core.h"'] if law_verbs(class_) else []
        rows += ['#include "types.h"']
        rows += sorted({f'#include "{body_name(item)}.h"' for item in self._calls})
        rows += ["", *lines([Block(tuple(self._fields()), f"struct {self.name}", "};")]), ""]
        rows += self._prototypes()
        return "\n".join([*rows, "", "#endif", ""])

    def _fields(self) -> Iterable[Statement]:
        class_ = self.class_
        groups: list[tuple[str, list[tuple[str, str, str | None]]]] = [
            ("Inputs", [self._field(port) for port in class_.ports if port.direction == "in"]),
            ("Outputs", [self._field(port) for port in class_.ports if port.direction == "out"]),
            ("States", [self._field(state) for state in class_.states]),
        ]
        stored = [
            self._parameter(item)
            for item in class_.parameters
            if item.name in self._used_in_runs or self._needs_sample(item)
        ]
        stored += [self._field(item) for item in constants_needed(class_) if item.name in self._used_in_runs]
        if self._sub_steps:
            stored += [("int64_t", STEPS, "of the integration in a sample"), ("double", SUB_STEP, "in seconds")]
        groups.append(("Parameters and what follows from them", stored))
        groups.append(
            ("Parts in C", [(f"struct {body_name(item)}", self.members[item.name], None) for item in self._calls])
        )
        filled = [(title, fields) for title, fields in groups if fields]
        if not filled:
            yield define("bool", "unused", remark="C has no empty structs")
        for title, fields in filled:
            yield Remark(f"{title}.")
            for type_name, member, doc in fields:
                yield define(type_name, member, remark=" ".join(doc.split()) if doc else None)

    def _needs_sample(self, item: Declared) -> bool:
        return item.name == "sample" and bool(self.class_.derivatives) and self.class_.step is None

    def _parameter(self, item: ClassParameter) -> tuple[str, str, str | None]:
        if not item.tunable:
            return self._field(item)
        return f"const {self.types.type_name(item.type)} *", self.members[item.name], item.doc

    def _field(self, item: Declared) -> tuple[str, str, str | None]:
        type_ = self.signal_types[item.name]
        seconds = isinstance(type_, TimeType) and any(item.name == p.name for p in self.class_.parameters)
        if seconds:
            return "float" if item.name in self._single_seconds else "double", self.members[item.name], item.doc
        return self.types.type_name(type_), self.members[item.name], item.doc

    def _parameters(self) -> list[str]:
        parameters = [self.types.parameter(item, self.members[item.name]) for item in self.class_.parameters]
        return [*self._given("initialize"), *parameters]

    def _prototypes(self) -> list[str]:
        durations = any(isinstance(item.type, TimeType) for item in self.class_.parameters)
        resets_fail = "reset" in law_verbs(self.class_)
        failing = "; csp_faulted says whether it failed"
        return [
            f"/* Before the first run{'; durations are in nanoseconds' if durations else ''}. */",
            *signature(f"void {self.name}_initialize", self._parameters(), ";"),
            f"/* Puts the states back to their initial values{failing if resets_fail else ''}. */",
            f"void {self.name}_reset({', '.join(self._given('reset'))});",
            "/* One run, from inputs to outputs and next states" + (f"{failing}. */" if self.can_fault else ". */"),
            f"void {self.name}_calculate({', '.join(self._given('calculate'))});",
        ]

    # ---- The source

    def _printer(self, local: Iterable[str], *, initializing: bool = False) -> Printer:
        """Names in ``local`` are local variables, the others members; parameters are arguments while the law is
        initialized.
        """
        known = set(local)
        parameters = {item.name for item in self.class_.parameters}

        def lvalue(name: str) -> Code:
            member = self.members[name]
            return code(member) if name in known or (initializing and name in parameters) else own(member)

        def seconds(name: str, double: bool) -> Code:
            member = self.members[name]
            if not initializing and not double and name in self._single_seconds:
                return own(member)
            value = call("csp_seconds", member) if initializing else own(member)
            return value if double else cast("float", value)

        return Printer(self.types, parameter=lvalue, signal=lvalue, seconds=seconds)

    def _writer(self, printer: Printer, *, checked: bool = True) -> EquationWriter:
        check = leave_if_faulted if checked else record_fault_place
        return EquationWriter(printer, self._place, check, lambda name: own(self.members[name]), body_name)

    def _source(self) -> str:
        rows = [f"/* See {self.name}.h. */", f'#include "{self.name}.h"', ""]
        rows += ['#include "csp_arithmetic.h"', '#include "constants.h"', ""]
        functions = [self._initialize(), self._reset()]
        if self.class_.derivatives:
            functions.append(self._slopes())
        for function in (*functions, self._calculate()):
            rows += [*lines(function), ""]
        return "\n".join(rows)

    def _initialize(self) -> list[Statement]:
        class_ = self.class_
        constants = constants_needed(class_)
        local = [item.name for item in constants if item.name not in self._used_in_runs]
        printer = self._printer(local, initializing=True)
        writer = self._writer(printer, checked=False)
        statements: list[Statement] = []
        used = {*parameters(tuple(item.value for item in constants)), *self._used_in_runs}
        for item in class_.parameters:
            member = self.members[item.name]
            if item.name in self._used_in_runs or self._needs_sample(item):
                value = code(member)
                if isinstance(item.type, TimeType) and not item.tunable:
                    seconds = call("csp_seconds", member)
                    value = cast("float", seconds) if item.name in self._single_seconds else seconds
                statements.append(store(own(member), value))
            elif (
                item.name not in used
                and not (self._sub_steps and item.name == "sample")
                and not self._is_passed_on(item.name)
            ):
                statements.append(run(ignored(code(member))))
        for constant in constants:
            member = self.members[constant.name]
            type_name = f"const {self.types.type_name(constant.type)}"
            target: Target = LocalVariable(type_name, member) if constant.name in local else own(member)
            statements += writer.assign(target, constant.value, self._place(constant))
        if self._sub_steps:
            sample, steps = code(self.members["sample"]), own(STEPS)
            statements.append(store(steps, sub_steps(sample, float(class_.step or 1))))
            statements.append(store(own(SUB_STEP), infix("/", PRODUCT, sample, cast("double", steps))))
        for called in self._calls:
            setup, arguments = printer.arguments([value for _, value in called.arguments])
            statements += setup
            body = address(own(self.members[called.name]))
            statements.append(run(call(f"{body_name(called)}_initialize", body, *arguments)))
        statements.append(run(call(f"{self.name}_reset", *kernel_of(law_verbs(class_), "reset"), "self")))
        return [Function(f"void {self.name}_initialize", tuple(self._parameters()), tuple(statements))]

    def _is_passed_on(self, name: str) -> bool:
        """Whether a parameter is passed to a nested body."""
        return bool(parameters(tuple(call.arguments for call in self._calls))[name])

    def _reset(self) -> list[Statement]:
        writer = self._writer(self._printer(()))
        statements: list[Statement] = []
        for state in self.class_.states:
            statements += writer.reset(own(self.members[state.name]), state)
        for called in self._calls:
            statements.append(run(call(f"{body_name(called)}_reset", address(own(self.members[called.name])))))
        return [self._function("reset", statements)]

    def _function(self, verb: str, body: list[Statement]) -> Function:
        statements = without_last_return(body) or [run(ignored(code("self")))]
        return Function(f"void {self.name}_{verb}", tuple(self._given(verb)), tuple(statements))

    def _given(self, verb: str) -> list[str]:
        """The first parameters of a function."""
        kernel = [KERNEL] if verb in law_verbs(self.class_) else []
        return [*kernel, f"struct {self.name} *self"]

    @cached_property
    def _continuous(self) -> tuple[str, ...]:
        return tuple(state.name for state in self.class_.states if state.continuous)

    @cached_property
    def _integration(self) -> Integration:
        class_ = self.class_
        return Integration(
            name=f"{self.name}_slopes",
            owner=self.name,
            local=lambda name: self.members[name],
            types=self.signal_types,
            states=self._continuous,
            held=tuple(held(class_)),
            equations=class_.derivative_equations,
            derivatives=class_.derivatives,
            changes=changes(class_),
            method=class_.method,
        )

    def _slopes(self) -> list[Statement]:
        moving = [*self._continuous, *(equation.name for equation in self.class_.derivative_equations)]
        printer = self._printer([*moving, *self._integration.held])
        return self._integration.function(printer, self._writer(printer, checked=False))

    def _calculate(self) -> list[Statement]:
        class_ = self.class_
        results = outputs(class_)
        roots = [*results, *signals((class_.next_values,)), *(self._integration.held if class_.derivatives else [])]
        equations = needed(class_.equations, roots)
        hoisted = self._hoisted()
        ports = {*inputs(class_), *results}
        local = [*hoisted, *(name for equation in equations for name in defined(equation) if name not in ports)]
        printer = self._printer(local)
        writer = self._writer(printer)

        def target(name: str) -> Target:
            return printer.signal(name) if name in ports else self._variable(name)

        statements: list[Statement] = []
        for name in hoisted:
            variable = self._variable(name, fixed=name not in self._continuous)
            statements.append(define(variable.type_name, variable.name, own(self.members[name])))
        statements += writer.equations(equations, target)
        places = {name: self._place(state) for name, state in changes(class_).items()}
        if class_.derivatives:
            statements += self._integration_statements(printer, places)
        for name, value in class_.next_values:
            statements += writer.assign(own(self.members[name]), value, places[name])
        return [self._function("calculate", [*statements, *self._state_updates()])]

    def _variable(self, name: str, *, fixed: bool = True) -> LocalVariable:
        type_name = self.types.type_name(self.signal_types[name])
        return LocalVariable(f"const {type_name}" if fixed else type_name, self.members[name])

    def _integration_statements(self, printer: Printer, places: Mapping[str, str]) -> list[Statement]:
        step = own(SUB_STEP) if self._sub_steps else own(self.members["sample"])
        count = own(STEPS) if self._sub_steps else None
        statements: list[Statement] = [define("const double", "h", step)]
        statements += self._integration.steps(printer.signal, count)
        check = self._writer(printer).check
        return [*statements, *self._integration.check([places[name] for name in self._continuous], check)]

    def _state_updates(self) -> list[Statement]:
        """The assignments of continuous states, which follow those of the discrete ones: nothing can fault then."""
        statements: list[Statement] = []
        for name in self._continuous if self.class_.derivatives else ():
            statements.append(store(own(self.members[name]), code(self.members[name])))
        return statements

    def _hoisted(self) -> list[str]:
        """States that are read after they have changed, and so become local variables first."""
        class_ = self.class_
        late = set(read_after_change(class_.next_values))
        if class_.derivatives:
            late |= set(self._integration.held) & {state.name for state in class_.states if not state.continuous}
            late |= set(self._continuous)
        return [state.name for state in class_.states if state.name in late]


def law_files(class_: SubmodelClass, names: PackageNames, types: CTypes) -> dict[str, str]:
    """The header and the source of a submodel class; nothing for one that is written in C by hand, whose files are
    copied.
    """
    return {} if class_.external is not None else LawFiles(class_, names, types).files()
