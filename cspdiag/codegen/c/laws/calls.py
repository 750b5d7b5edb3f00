"""What callers of a control law in C have to know: which of its functions can fault, and the names of its members."""

from __future__ import annotations

from cspdiag.codegen.c.text.code import CSP, Code
from cspdiag.codegen.c.text.names import INTEGRATION_LOCALS, Names, PackageNames, snake_case
from cspdiag.codegen.c.text.types import scalars
from cspdiag.codegen.shared.laws.equations import constants_needed, values
from cspdiag.model.types import EnumType
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.faults import may_fault
from cspdiag.network.ir.network import SubmodelClass

STEPS = "integration_steps"
SUB_STEP = "sub_step"
"""Members of laws that integrate in steps shorter than a sample."""


def law_may_fault(class_: SubmodelClass) -> bool:
    """Whether one run of the law can fault, so its caller has to check."""
    items = [part for equation in class_.equations for part in values(equation)]
    items += [value for _, value in class_.next_values]
    calls = [equation for equation in class_.equations if isinstance(equation, ExternalCall)]
    numbers_enumerators = any(isinstance(s, EnumType) for c in calls for _, _, t in c.outputs for s in scalars(t))
    return bool(class_.derivatives) or numbers_enumerators or any(map(may_fault, items))


def law_verbs(class_: SubmodelClass) -> frozenset[str]:
    """Which functions of a law can note a fault, and so are passed the state of the run: ``initialize``, ``reset``,
    ``calculate``. Those that are written by hand note none.
    """
    if class_.external is not None:
        return frozenset()
    calls = [equation for equation in class_.equations if isinstance(equation, ExternalCall)]
    first = [item.value for item in constants_needed(class_)]
    first += [value for item in calls for _, value in item.arguments]
    verbs = {"calculate"} if law_may_fault(class_) else set()
    verbs |= {"reset", "initialize"} if any(may_fault(state.initial) for state in class_.states) else set()
    return frozenset(verbs | ({"initialize"} if any(map(may_fault, first)) else set()))


def kernel_of(verbs: frozenset[str], verb: str) -> tuple[Code, ...]:
    """The first argument of a call of such a function."""
    return (CSP,) if verb in verbs else ()


def law_members(class_: SubmodelClass, names: PackageNames) -> Names:
    """The C names of the members of the struct of a law and of the local variables of its functions, by their names in
    the source text.
    """
    own = () if class_.external is not None else (*names.globals, *INTEGRATION_LOCALS, STEPS, SUB_STEP)
    members = Names((*own, *names.macros))
    for item in (*class_.ports, *class_.parameters, *class_.states):
        members[item.name]
    return members


def body_name(call: ExternalCall) -> str:
    """The name of the struct of a nested body in C, which is also the prefix of its functions."""
    return snake_case(call.definition)
