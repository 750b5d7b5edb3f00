"""How parameters of the program reach the classes that use them: as tunable parameters, passed by reference.

An argument that is computed from parameters of the program, such as ``2 * gains.kp``, cannot be passed by reference:
its parameter is replaced by the computation in a class of its own, which gets what the computation needs instead.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cspdiag.base.record import node, record, replaced
from cspdiag.model.program import Program
from cspdiag.model.types import UNKNOWN
from cspdiag.network.elaborate.expression import LoweringContext, lower_expression
from cspdiag.network.ir.actions import CoreAction
from cspdiag.network.ir.declared import Declared, DeclaredElement
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.expressions import Expression, ParameterValue, TunableValue, Value
from cspdiag.network.ir.network import (
    ClassParameter,
    CoreClass,
    InstanceOf,
    Instantiation,
    ProcessClass,
    ProgramParameter,
    SubmodelClass,
)
from cspdiag.network.ir.walk import parts
from cspdiag.network.lower.computed_arguments import law_with_arguments, names_of_law, process_with_arguments
from cspdiag.network.lower.distinct_names import DistinctNames
from cspdiag.syntax import ast

Class = ProcessClass[CoreAction] | SubmodelClass


@node
class Bound:
    """Classes whose tunable parameters are all bound, each after those of its instances; the instances; and the
    parameter of the program behind each tunable parameter of the outermost process.
    """

    classes: dict[str, Class]
    instances: tuple[Instantiation, ...]
    outermost: tuple[tuple[str, str], ...]


def program_parameters(program: Program, used: object) -> tuple[ProgramParameter, ...]:
    """The parameters of the program, and the constants that follow from them and occur in ``used``."""
    if not program.tunable:
        return ()
    found: dict[ast.Constant, ProgramParameter] = {}
    needed = {part.name for part in parts(used) if isinstance(part, TunableValue) and part.of_program}
    for constant in reversed(program.tunable):
        follows = None
        if not constant.tunable:
            if constant.name.text not in needed:
                continue
            follows = lower_expression(program, constant.value, LoweringContext(values={}))
            needed |= {part.name for part in parts(follows) if isinstance(part, TunableValue)}
        found[constant] = ProgramParameter(
            name=constant.name.text,
            doc=constant.doc,
            span=constant.name.span,
            type=program.types.get(constant, UNKNOWN),
            value=program.tunable[constant],
            follows=follows,
        )
    return tuple(reversed(found.values()))


def bound(
    classes: Mapping[str, CoreClass | SubmodelClass],
    top: str,
    arguments: Mapping[str, Expression],
    instances: tuple[Instantiation, ...],
    parameters: tuple[ProgramParameter, ...],
) -> Bound:
    """Binds the tunable parameters of all classes; ``arguments`` are those of the tunable parameters of ``top``."""
    if not parameters:
        return Bound(classes=dict(classes), instances=instances, outermost=())
    computed = _Computed(classes)
    # The outermost class has no reference to a parameter that an environment gives: it uses that of the program.
    computed.make(classes[top], top, dict(arguments))
    lifted = _Lifted({parameter.name: parameter for parameter in parameters})
    for entry in computed.made.values():
        lifted.add(entry)
    outermost = tuple((name, parameter) for parameter, name in lifted.own[top].items())
    listed = _listed(lifted.made, top, instances, dict(outermost), {one.name: one.value for one in parameters})
    return Bound(classes=lifted.made, instances=listed, outermost=outermost)


@record
class _Leaf:
    """A parameter that a computed argument needs: its name in the class inside, and its value in the class around."""

    name: str
    value: ParameterValue | TunableValue


class _Computed:
    """Replaces tunable parameters with computed arguments, from the outermost class inwards."""

    def __init__(self, classes: Mapping[str, Class]) -> None:
        self.classes = classes
        self.made: dict[str, Class] = {}
        """Each class after those of its instances."""
        self._names = DistinctNames(classes)
        self._known: dict[object, str] = {}

    def make(self, entry: Class, name: str, computed: Mapping[str, Expression]) -> None:
        """Makes a class with these values of parameters that it no longer has, in terms of its own parameters."""
        if isinstance(entry, ProcessClass):
            entry = process_with_arguments(entry, computed) if computed else entry
            entry = replaced(entry, instances=tuple(map(self._instance, entry.instances)))
        elif computed:
            entry = law_with_arguments(entry, computed)
        kept = tuple(parameter for parameter in entry.parameters if parameter.name not in computed)
        self.made[name] = replaced(entry, name=name, parameters=kept)

    def _instance(self, instance: InstanceOf) -> InstanceOf:
        inner = self.classes[instance.class_name]
        tunable = {parameter.name for parameter in inner.parameters if parameter.tunable}
        computed = {
            name: value for name, value in instance.arguments if name in tunable and not isinstance(value, TunableValue)
        }
        names = DistinctNames(_names_of(inner) if computed else ())
        leaves: dict[tuple[type, str], _Leaf] = {}
        inside = {name: rewritten(value, lambda part: _leaf(part, names, leaves)) for name, value in computed.items()}
        class_name = self._class(inner, inside, tuple(_parameter(leaf, inner) for leaf in leaves.values()))
        if not computed:
            return instance
        arguments = (
            *(item for item in instance.arguments if item[0] not in computed),
            *((leaf.name, leaf.value) for leaf in leaves.values()),
        )
        return replaced(instance, class_name=class_name, arguments=arguments)

    def _class(self, inner: Class, computed: Mapping[str, Expression], own: tuple[ClassParameter, ...]) -> str:
        """The name of a class with these computations, which need its ``own`` parameters."""
        key = (inner.name, tuple(computed.items()), own)
        name = self._known.get(key)
        if name is None:
            name = inner.name
            if computed:
                name = self._names.fresh(inner.name, lambda number: f"{inner.name}_{number}")
            self._known[key] = name
            self.make(replaced(inner, parameters=(*inner.parameters, *own)), name, computed)
        return name


def _leaf(part: Any, names: DistinctNames, leaves: dict[tuple[type, str], _Leaf]) -> Any:
    """A parameter of the class around an instance as one of the class of the instance."""
    if not isinstance(part, ParameterValue | TunableValue) or (isinstance(part, TunableValue) and part.of_program):
        return part
    key = (type(part), part.name)
    if key not in leaves:
        leaves[key] = _Leaf(names.fresh(part.name, lambda number: f"{part.name}_{number}"), part)
    return replaced(part, name=leaves[key].name)


def _parameter(leaf: _Leaf, inner: Class) -> ClassParameter:
    tunable = isinstance(leaf.value, TunableValue)
    return ClassParameter(name=leaf.name, type=leaf.value.type, span=inner.span, derived=True, tunable=tunable)


def _names_of(entry: Class) -> set[str]:
    """The names that something in a class has already."""
    if isinstance(entry, ProcessClass):
        declared: tuple[Declared | DeclaredElement, ...]
        declared = (*entry.parameters, *entry.ports, *entry.channels, *entry.instances)
        return {item.name for item in declared}
    return names_of_law(entry)


class _Lifted:
    """Gives each class a tunable parameter for every parameter of the program that it or an instance in it uses."""

    def __init__(self, parameters: Mapping[str, ProgramParameter]) -> None:
        self.parameters = parameters
        self.made: dict[str, Class] = {}
        self.own: dict[str, dict[str, str]] = {}
        """For each class the names of its parameters, by that of the program."""

    def add(self, entry: Class) -> None:
        """Adds a class; those of its instances were added before."""
        used = dict.fromkeys(part.name for part in parts(entry) if isinstance(part, TunableValue) and part.of_program)
        if isinstance(entry, ProcessClass):
            for instance in entry.instances:
                used |= dict.fromkeys(self.own[instance.class_name])
        names = DistinctNames(_names_of(entry))
        own = {name: names.fresh(name, lambda number, name=name: f"{name}_{number}") for name in used}  # type: ignore[misc]
        self.own[entry.name] = own
        if own:
            entry = rewritten(entry, lambda part: _of_class(part, own))
            if isinstance(entry, ProcessClass):
                entry = replaced(entry, instances=tuple(self._instance(one, own) for one in entry.instances))
            entry = replaced(entry, parameters=(*entry.parameters, *map(self._parameter, own, own.values())))
        self.made[entry.name] = entry

    def _parameter(self, parameter: str, name: str) -> ClassParameter:
        origin = self.parameters[parameter]
        return ClassParameter(name=name, doc=origin.doc, type=origin.type, span=origin.span, derived=True, tunable=True)

    def _instance(self, instance: InstanceOf, own: Mapping[str, str]) -> InstanceOf:
        more = tuple(
            (inner, TunableValue(type=self.parameters[name].type, name=own[name]))
            for name, inner in self.own[instance.class_name].items()
        )
        return replaced(instance, arguments=(*instance.arguments, *more)) if more else instance


def _of_class(part: Any, own: Mapping[str, str]) -> Any:
    if isinstance(part, TunableValue) and part.of_program:
        return replaced(part, name=own[part.name], of_program=False)
    return part


def _listed(
    classes: Mapping[str, Class],
    top: str,
    instances: tuple[Instantiation, ...],
    outermost: Mapping[str, str],
    before: Mapping[str, Value],
) -> tuple[Instantiation, ...]:
    """The instances with their classes, and with the values that their tunable parameters have before any change."""
    inside = {
        (entry.name, instance.name): instance
        for entry in classes.values()
        if isinstance(entry, ProcessClass)
        for instance in entry.instances
    }
    known: dict[str, tuple[str, dict[str, Value]]] = {}
    found = []
    for item in instances:
        outer, _, name = item.path.rpartition(".")
        values = dict(item.arguments)
        if not outer:
            class_name = top
            values |= {own: before[parameter] for own, parameter in outermost.items()}
        else:
            around_name, around = known[outer]
            instance = inside[around_name, name]
            class_name = instance.class_name
            for parameter, value in instance.arguments:
                if isinstance(value, ParameterValue | TunableValue) and parameter not in values:
                    values[parameter] = around[value.name]
        wanted = [parameter.name for parameter in classes[class_name].parameters]
        values = {parameter: values[parameter] for parameter in wanted}
        known[item.path] = class_name, values
        found.append(replaced(item, class_name=class_name, arguments=tuple(values.items())))
    return tuple(found)
