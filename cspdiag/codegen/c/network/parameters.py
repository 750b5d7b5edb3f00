"""The parameters of the program in C: where they are, how they are set, and what follows from them."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

from cspdiag.base.record import record
from cspdiag.codegen.c.laws.calls import body_name
from cspdiag.codegen.c.laws.equations import Check, EquationWriter
from cspdiag.codegen.c.text.code import CSP, Aggregate, Call, Code, address, call, cast, code, ignored, own
from cspdiag.codegen.c.text.expressions import Printer
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.names import PackageNames
from cspdiag.codegen.c.text.statements import (
    Blank,
    Block,
    Function,
    Remark,
    Statement,
    choose,
    define,
    lines,
    return_if,
    return_value,
    run,
    store,
)
from cspdiag.codegen.c.text.types import CTypes
from cspdiag.codegen.shared.trees import nodes
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.network import Network, ProgramParameter


def parameter_of(program: Code, name: str, network: Network, names: PackageNames) -> Code:
    """The lvalue of a parameter, or of a constant that follows from some, in the network that ``program`` points to."""
    follows = next(item.follows for item in network.parameters if item.name == name) is not None
    return program.arrow("following" if follows else "parameters").field(names.parameters[name])


@record
class ParameterText:
    """What the files of a network say about its parameters; nothing, if it has none."""

    network: Network
    names: PackageNames
    types: CTypes

    @property
    def struct(self) -> str:
        """The structure with the parameters."""
        return f"struct {self.names.prefix}_parameters"

    @cached_property
    def own(self) -> list[ProgramParameter]:
        """The parameters that can be set."""
        return [item for item in self.network.parameters if item.follows is None]

    @cached_property
    def following(self) -> list[ProgramParameter]:
        """The constants that follow from them."""
        return [item for item in self.network.parameters if item.follows is not None]

    @property
    def given(self) -> tuple[str, ...]:
        """The last parameter of the function that builds the network."""
        return (f"const {self.struct} *parameters",) if self.own else ()

    def memory(self) -> Iterator[Statement]:
        """The members of the structure with all state of the program."""
        if not self.own:
            return
        yield define(self.struct, "parameters")
        if self.following:
            members = [
                define(self.types.type_name(item.type), self.names.parameters[item.name]) for item in self.following
            ]
            yield Block(tuple(members), "struct", "} following; /* from the parameters */")
        yield define("csp_refusal", "refusal", remark="of those that were given last")

    def declarations(self) -> list[str]:
        """The function that sets them, for the header."""
        if not self.own:
            return []
        return [
            "/* Sets the parameters, between two steps; false: nothing was done, and `refusal` says why. */",
            f"bool network_change_parameters(struct network *self, const {self.struct} *parameters);",
            "",
            "/* The values of the text. */",
            f"extern const {self.struct} network_default_parameters;",
            "",
        ]

    def reference(self, name: str) -> Code:
        """A pointer to a parameter, in a function of the network."""
        return address(parameter_of(code("self"), name, self.network, self.names))

    def initialization(self) -> list[Statement]:
        """The statements that give them their first values."""
        if not self.own:
            return []
        stored = store(own("parameters"), "network_default_parameters")
        given = run(ignored(call("network_change_parameters", "self", "parameters")))
        return [stored, run(ignored(call("follow", "self"))), *choose(code("parameters != NULL"), [given])]

    def functions(self) -> list[str]:
        """The functions that set them, and the values of the text."""
        if not self.own:
            return []
        follow = self._follow()
        # Numbers that are not real, from which nothing follows, are never refused.
        can_refuse = any(isinstance(part, Call) and part.function == "refuse" for part in nodes(follow.body))
        rows = [
            *lines([Remark("The values of the text."), self._defaults(), Blank()]),
            *lines([self._refuse(), Blank()] if can_refuse else []),
            *lines([Remark("Tests the parameters, and computes what follows from them; false: they are refused.")]),
            *lines([follow, Blank(), self._set(), Blank(), *self._set_any()]),
        ]
        return [*rows, ""]

    def program(self) -> list[str]:
        """The members of the description of the program."""
        if not self.own:
            return []
        return [
            "    .parameters = offsetof(struct network, parameters),",
            f"    .parameters_size = sizeof({self.struct}),",
            "    .set_parameters = set_parameters,",
        ]

    def _defaults(self) -> Statement:
        entries = tuple(
            (f".{self.names.parameters[item.name]}", self.types.initial(item.value, item.type)) for item in self.own
        )
        return define(f"const {self.struct}", "network_default_parameters", Aggregate(entries))

    def _place(self, item: Declared) -> str:
        return self.names.place(item.span.file, item.span.line)

    def _follow(self) -> Function:
        """Tests the parameters, and computes what follows from them."""
        printer = Printer(self.types, program=self.reference)
        statements: list[Statement] = []
        for number, item in enumerate(self.network.parameters):
            value = parameter_of(code("self"), item.name, self.network, self.names)
            if item.follows is not None:
                check = _check("CSP_NOT_COMPUTED", number)
                writer = EquationWriter(printer, self._place, check, lambda name: code(name), body_name)
                statements += writer.assign(value, item.follows, self._place(item))
            test = self.types.finite_check(item.type, value, code(quoted(item.name)))
            if test is not None:
                cause = "CSP_NOT_FINITE" if item.follows is None else "CSP_NOT_COMPUTED"
                statements += [run(test), *_check(cause, number)("")]
        statements.append(return_value("true"))
        kernel = define("csp_kernel *const", "csp", "&self->kernel")
        changed = run("csp->changes++")
        return Function("static bool follow", ("struct network *self",), (kernel, changed, *statements))

    @staticmethod
    def _refuse() -> Function:
        """Notes why parameters are refused, instead of the fault that was found."""
        refusal = own("refusal")
        return Function(
            "static bool refuse",
            ("struct network *self", "csp_refusal_cause cause", "uint16_t parameter"),
            (
                store(refusal.field("cause"), cast("uint16_t", code("cause"))),
                store(refusal.field("parameter"), "parameter"),
                store(own("kernel").field("fault").field("describe"), "NULL"),
                return_value("false"),
            ),
        )

    def _set(self) -> Function:
        return Function(
            "bool network_change_parameters",
            ("struct network *self", f"const {self.struct} *parameters"),
            (
                define(f"const {self.struct}", "before", own("parameters")),
                store(own("parameters"), "*parameters"),
                store(own("refusal").field("cause"), cast("uint16_t", code("CSP_ACCEPTED"))),
                Block((return_value("true"),), "if (follow(self))", "}"),
                store(own("parameters"), "before"),
                run(ignored(call("follow", "self"))),
                return_value("false"),
            ),
        )

    def _set_any(self) -> list[Statement]:
        enclosing = call("CSP_ENCLOSING", CSP, "struct network", "kernel")
        made = return_value(call("network_change_parameters", enclosing, "parameters"))
        return [Function("static bool set_parameters", ("csp_kernel *csp", "const void *parameters"), (made,))]


def _check(cause: str, number: int) -> Check:
    """The check after which parameters are refused, because of the one with this number."""
    return lambda _: [return_if(call("csp_faulted"), call("refuse", "self", cause, f"{number}U"))]
