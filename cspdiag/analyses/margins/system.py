"""The laws of a program and its plant, linearized, with what lies between them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cspdiag.analyses.margins.composition.feedback import FeedbackSearch
from cspdiag.analyses.margins.law import LinearLaw, linearize
from cspdiag.analyses.margins.linear import NotLinearError
from cspdiag.analyses.margins.structure import initial_inputs
from cspdiag.base.graphs import reached
from cspdiag.network.ir.network import CoreNetwork, Environment, ProcessClass, SubmodelClass
from cspdiag.network.ir.zero import zero

if TYPE_CHECKING:
    import numpy

    Matrix = numpy.ndarray[tuple[int, ...], numpy.dtype[numpy.float64]]


class LinearizedProgram:
    """The laws of a program and one environment, linearized about an operating point."""

    def __init__(
        self,
        network: CoreNetwork,
        environment: Environment,
        point: dict[str, float],
        search: FeedbackSearch | None = None,
    ) -> None:
        if environment.system is None:
            raise NotLinearError(
                f"the environment `{environment.name}` has no model of the plant, only drivers", environment.span
            )
        self.network = network
        self.environment = environment
        self.search = search or FeedbackSearch(network, environment)
        before = {parameter.name: parameter.value for parameter in network.parameters}
        self.plant = linearize(environment.system, before, point=point)
        _refuse_offsets(network, self.plant)
        self.classes = {
            instance.path: entry
            for instance in network.instances
            if isinstance(entry := network.class_named(instance.class_name), SubmodelClass)
        }
        self.parameters = self.search.parameters
        self.external = {port.key: port for port in network.external_ports}
        self.net_of = self.search.composition.net_of
        self.outside = {net.path: net.path.partition(".")[2] for net in network.nets if net.external is not None}
        """The external port of a net, by the path of the net."""
        self.types = {net.path: net.type for net in network.nets if net.external != "in"}
        self.rendezvous = {net.path for net in network.nets if net.external is None and net.kind == "sync"}
        for instance in network.instances:
            process = network.class_named(instance.class_name)
            for channel in process.channels if isinstance(process, ProcessClass) else ():
                self.types.setdefault(f"{instance.path}.{channel.name}", channel.type)
        self._laws: dict[str, LinearLaw] = {}

    def law(self, path: str) -> LinearLaw:
        """The law at a path, linearized. Raises NotLinearError."""
        found = self._laws.get(path)
        if found is None:
            point = initial_inputs(self.network, path)
            found = self._laws[path] = linearize(self.classes[path], self.parameters[path], point=point)
        return found

    def check_operating_point(self, path: str, members: frozenset[str]) -> None:
        """Refuse a law whose coefficients depend on a variable outside the loop that the composition changes: it does
        not keep the initial value, at which the law is linearized. Raises NotLinearError.
        """
        entry, law, point = self.classes[path], self.law(path), initial_inputs(self.network, path)
        for port in entry.ports:
            place = self.net_of.get((path, port.name))
            if port.direction != "in" or place is None or place in members:
                continue
            initial = point.get(port.name, zero(port.type))
            changed = [part for part in self.search.composition.statements if part.target == place]
            if not changed or not isinstance(initial, bool | int | float):
                continue
            other = not initial if isinstance(initial, bool) else 2 * initial + 1
            elsewhere = linearize(entry, self.parameters[path], point={**point, port.name: other})
            if not _is_same(law, elsewhere):
                raise NotLinearError(
                    f"`{place.partition('.')[2]}` gets another value here than its initial one, and the coefficients "
                    f"of `{path.partition('.')[2]}` depend on it; pass on a constant, and try its values with --set",
                    changed[0].span,
                )

    def is_passed_on(self, path: str, port: str) -> bool:
        """Whether an output reaches the plant only through other laws of the same rate, so the loop is cut there."""
        search = self.search
        members = search.of(path).members
        others = {law for law in search.runs if law != path and search.period(law) == search.period(path)}
        net = self.net_of.get((path, port))
        if net is None or net not in members or not others & members:
            return False
        after = search.influences(path)
        beyond = reached([net], lambda node: () if node in others or node == path else after.get(node, ()))
        return not any(node in members and node in self.outside for node in beyond)

    def comes_back(self, path: str, port: str) -> bool:
        """Whether an output may come back to its law through the plant."""
        return self.net_of.get((path, port)) in self.search.of(path).members

    def responding_inputs(self, port: str) -> set[str]:
        """The inputs of the program at which the plant responds to an output, now or later."""
        plant = self.plant
        size = len(plant.discrete) + len(plant.continuous)
        rows = [*plant.next, *plant.rates]
        moved = {size + k for k, (name, _) in enumerate(plant.inputs) if name == port}
        while True:
            more = {k for k, row in enumerate(rows) if any(_has_effect(row, j) for j in moved)} - moved
            if not more:
                break
            moved |= more
        return {
            name
            for (name, _), row in zip(plant.output_names, plant.outputs, strict=True)
            if any(_has_effect(row, j) for j in moved)
        }


def _is_same(one: LinearLaw, other: LinearLaw) -> bool:
    import numpy

    pairs = ((one.next, other.next), (one.rates, other.rates), (one.outputs, other.outputs))
    return all(numpy.allclose(a, b, rtol=1e-9, atol=1e-12) for a, b in pairs)


def _has_effect(row: Matrix, column: int) -> bool:
    """Whether a coefficient is larger than the rounding error of terms that cancel."""
    return bool(abs(row[column]) > 1e-9 * max(1.0, abs(row).max()))


def _refuse_offsets(network: CoreNetwork, plant: LinearLaw) -> None:
    """Raises NotLinearError if laws do not begin together, or if discrete parts of the plant step off its grid."""
    for port in network.external_ports:
        if port.sampling is None or not port.sampling.offset:
            continue
        if port.direction == "in":
            raise NotLinearError(
                f"the samples of `{port.name}` have an offset, which margins follow for outputs only", port.span
            )
        if plant.discrete:
            raise NotLinearError(
                f"`{port.name}` has an offset, which margins follow only if the plant has no discrete parts", port.span
            )
