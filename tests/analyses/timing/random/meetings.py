"""Random programs of loops that meet: rounds of communications in an order that all of them follow, or nearly all, with
and without samples of their own.
"""

from __future__ import annotations

from tests.analyses.timing.random.shapes import Shapes, Unit


class Meetings(Shapes):
    """A random program of two to four loops and the channels between them."""

    def _program(self) -> str:
        source = self.source
        main = Unit("Main")
        count = source.choice([2, 2, 3, 4])
        period = source.choice([1, 2, 4])
        units = [Unit(self._name("U")) for _ in range(count)]
        rounds: list[list[str]] = [[] for _ in units]
        for _ in range(source.randint(1, count + 1)):
            writer, reader = source.sample(range(count), 2)
            channel = self._name("c")
            kind = source.choice(["", "", "", "", "overwrite 1", "buffer 1", "buffer 2"])
            main.declared.append(f"channel {channel} : double {kind}")
            units[writer].writes.append(channel)
            units[reader].reads.append(channel)
            rounds[writer].append(f"{channel} ! {self._variable(units[writer])}")
            rounds[reader].append(f"{channel} ? {self._variable(units[reader])}")
        runs = []
        sampled = source.sample(range(count), source.randint(1, count))
        for k, (unit, steps) in enumerate(zip(units, rounds, strict=True)):
            if self._wild():
                source.shuffle(steps)
            own = period if source.random() < 0.8 else source.choice([1, 2, 4, 8])
            unit.text = self._loop(unit, steps, own if k in sampled else None)
            if source.random() < 0.6:
                runs.append(self._process(unit, main))
            else:
                main.declared += unit.declared
                main.inputs |= unit.inputs
                runs.append(unit.text)
        source.shuffle(runs)
        if source.random() < 0.3:
            runs.append(f"(mu {self._sampled(main, source.choice([1, 2, 5]))})")
        main.text = source.choice([" || ", " ||> "]).join(runs)
        if self._wild():
            main.text = f"({main.text}) interrupt {self._guard(main, period)} -> {self._sampled(main, period)}"
        return self._written(main)

    def _loop(self, unit: Unit, steps: list[str], period: int | None) -> str:
        source = self.source
        parts: list[str] = []
        for step in steps:
            if source.random() < 0.3:
                parts.append(self._law(unit, None))
            parts.append(self._changed(unit, step, period or 2) if self._wild() else step)
        if source.random() < 0.5 or not parts:
            parts.append(self._law(unit, None))
        if period is not None and source.random() < 0.35:
            return f"(mu ({self._beside(unit, parts, period)}))"
        if period is not None:
            parts.insert(source.choice([0, 0, 0, len(parts)]), self._sampled(unit, period))
        elif not steps:
            parts.append(f"wait {self.length(unit)}")
        elif self._wild():
            parts.insert(source.randint(0, len(parts)), self._harm(unit, 2, 1))
        loop = f"(mu ({' ; '.join(parts)}))"
        if self._wild():
            loop = f"({loop[:-1]} until {self._condition(unit)}) ; {self._work(unit, period or 2, 1)})"
        return loop

    def _beside(self, unit: Unit, parts: list[str], period: int) -> str:
        """Communications as branches of an alternative with the sample."""
        branches = []
        rest: list[str] = []
        for part in parts:
            if "?" in part and "(" not in part:
                body = "skip" if self.source.random() < 0.5 else self._law(unit, None)
                branches.append(f"{part} -> {body}")
            else:
                rest.append(part)
        port = self._port(unit, period)
        own = " ; ".join([self._law(unit, port), *rest])
        branches.append(f"{port} -> ({own})")
        self.source.shuffle(branches)
        return f" {self._or()} ".join(branches)

    def _changed(self, unit: Unit, step: str, period: int) -> str:
        """A communication that does not take place in every round, or not on its own."""
        match self.source.randint(0, 6):
            case 0:
                return f"(if {self._condition(unit)} then {step})"
            case 1:
                return f"({step} ; {step})"
            case 2:
                return f"({step} -> skip {self._or()} {self._guard(unit, period)} -> skip)"
            case 3:
                return f"(when {self._condition(unit)} & {step} -> skip {self._or()} after 300 us -> skip)"
            case 4:
                return f"({step} ; {self._harm(unit, period, 1)})"
            case 5:
                return f"({step} interrupt {self._guard(unit, period)} -> skip)"
            case _:
                return f"({step} || {self._work(unit, period, 1)})"
