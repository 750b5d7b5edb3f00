"""Sample periods along nets, and the period at which every submodel instance runs.

A net has one period: that of any port on it that declares one. A submodel instance runs at the period of the nets that
it is connected to; if none of them has one, at that of the submodels with which it exchanges values, if they agree.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeAlias

from cspdiag.base import Report, Span
from cspdiag.base.record import record
from cspdiag.model.sampling import Sampling
from cspdiag.network.diagnostics.samples.periods import PeriodsDisagree, SampledInsideOnly, SamplesDisagree
from cspdiag.network.shapes import (
    UNKNOWN_PERIOD,
    UNKNOWN_SAMPLING,
    InstanceShape,
    Key,
    Shape,
    attached_key,
    element_name,
)


@record
class Rate:
    """Sample instants, or UNKNOWN_SAMPLING, and where they are declared."""

    sampling: Sampling
    declared: Span


Rates: TypeAlias = "dict[Key, Rate]"


def net_rates(shape: Shape, inside: Mapping[Shape, Rates], report: Report) -> Rates:
    """The sample instants of the ports and channels of a shape, declared by the process itself or by ports of its
    instances.
    """
    rates: Rates = {}
    for port, _, key in shape.port_elements():
        if port.sampling is not None:
            declared = port.symbol.declaration.sampling
            rates[key] = Rate(port.sampling, port.span if declared is None else declared.span)
    for instance in shape.instances.values():
        theirs = inside.get(instance.shape)
        if not theirs:
            continue
        for element, attached in instance.attachments.items():
            net, rate = attached_key(attached), theirs.get(element_name(*element))
            if net is None or rate is None:
                continue
            known = rates.setdefault(net, rate)
            if UNKNOWN_SAMPLING in (known.sampling, rate.sampling):
                rates[net] = Rate(UNKNOWN_SAMPLING, known.declared)
            elif known.sampling != rate.sampling:
                report.add(
                    PeriodsDisagree(
                        span=attached.span,
                        net=net,
                        one=known.sampling,
                        one_span=known.declared,
                        other=rate.sampling,
                        other_span=rate.declared,
                    )
                )
    return rates


def check_event_ports(shape: Shape, rates: Rates, report: Report) -> None:
    """Reports ports of the outermost process without a period, which are event ports, that are sampled inside."""
    for port, _, key in shape.port_elements():
        rate = rates.get(key)
        if port.sampling is None and rate is not None and rate.sampling != UNKNOWN_SAMPLING:
            report.add(SampledInsideOnly(span=port.span, port=key, sampling=rate.sampling, inner=rate.declared))


class Samples:
    """The sample period of each submodel instance of a shape, in nanoseconds, as far as it is defined.

    ``unknown`` are the instances that have a period which is not known.
    """

    def __init__(self, shape: Shape, rates: Rates, periods: Mapping[Key, int], report: Report) -> None:
        self.shape = shape
        self.rates = rates
        self.periods = periods
        self.report = report
        self.found: dict[str, int] = {}
        self._infer()
        self.unknown = frozenset(name for name, period in self.found.items() if period == UNKNOWN_PERIOD)
        for name in self.unknown:
            del self.found[name]

    def _infer(self) -> None:
        submodels = [i for i in self.shape.instances.values() if i.shape.is_submodel]
        pending: list[InstanceShape] = []
        for instance in submodels:
            sample = self._direct(instance)
            if sample is None:
                pending.append(instance)
            else:
                self.found[instance.name] = sample
        if pending and self.found:
            self._spread(submodels, pending)

    def _direct(self, instance: InstanceShape) -> int | None:
        """The period of the nets that have one; the first of two that disagree, unknown if one of them is unknown."""
        first: tuple[int, Key] | None = None
        is_unknown = False
        for attached in instance.attachments.values():
            key = attached_key(attached)
            period = None if key is None else self.periods.get(key)
            if key is None or period is None:
                continue
            if period == UNKNOWN_PERIOD:
                is_unknown = True
            elif first is None:
                first = period, key
            elif first[0] != period:
                self._report(instance, first, (period, key))
        if is_unknown:
            return UNKNOWN_PERIOD
        return None if first is None else first[0]

    def _report(self, instance: InstanceShape, one: tuple[int, Key], other: tuple[int, Key]) -> None:
        self.report.add(
            SamplesDisagree(
                span=instance.span,
                instance=instance.name,
                one=one[0],
                one_span=self._place(instance, one[1]),
                other=other[0],
                other_span=self._place(instance, other[1]),
            )
        )

    def _place(self, instance: InstanceShape, key: Key) -> Span:
        rate = self.rates.get(key)
        if rate is not None:
            return rate.declared
        return next(a.span for a in instance.attachments.values() if attached_key(a) == key)

    def _spread(self, submodels: list[InstanceShape], pending: list[InstanceShape]) -> None:
        """Spreads periods from neighbour to neighbour until nothing changes; each instance is visited once, when it has
        a period.
        """
        users: dict[Key, list[InstanceShape]] = {}
        for instance in submodels:
            for key in {attached_key(a) for a in instance.attachments.values()}:
                if key is not None and key in self.shape.channels:
                    users.setdefault(key, []).append(instance)
        waiting = {instance.name for instance in pending}
        front = [instance for instance in submodels if instance.name not in waiting]
        while front:
            offers: dict[str, set[int]] = {}
            for instance in front:
                for key in {attached_key(a) for a in instance.attachments.values()}:
                    for other in users.get(key or "", ()):
                        if other.name in waiting:
                            offers.setdefault(other.name, set()).add(self.found[instance.name])
            front = []
            for name in sorted(offers):
                if len(offers[name]) == 1 or UNKNOWN_PERIOD in offers[name]:
                    self.found[name] = min(offers[name])
                    waiting.discard(name)
                    front.append(self.shape.instances[name])
