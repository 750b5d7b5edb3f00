"""Control laws as part of the code of a generator function: they are executed, and fail, in their own name."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from cspdiag.codegen.python.fast.communications import text
from cspdiag.codegen.python.fast.laws.in_place import InlineLaw, external_calls, reset_statements
from cspdiag.codegen.python.fast.statements import assigned
from cspdiag.codegen.python.fast.values import Values
from cspdiag.codegen.python.text.statements import Block, Statement
from cspdiag.network.ir.actions import Action, ReadInputs, RunLaw, WriteOutputs
from cspdiag.network.ir.expressions import LiteralValue, ParameterValue, SignalValue

_LONGEST_COMMENT = 70


@dataclass
class LawSteps(Values):
    """Writes the inlined laws of one process class."""

    def _law(self, steps: Sequence[Action]) -> Iterator[Statement]:
        """Steps of one law: they are executed, and fail, in its name."""
        me, error = self.spelling["me"], self.spelling["error"]
        law = law_of(steps[0])
        part = self.spelling.part(law)
        process = "self" if self.process == "self" else self.process
        inner: list[Statement] = []
        for step in steps:
            match step:
                case ReadInputs():
                    inner += self._read_inputs(step)
                case WriteOutputs():
                    inner += self._write_outputs(step)
                case RunLaw():
                    inline = self._inline_law(step)
                    self.prologue += inline.prologue()
                    inner += inline.statements()
                case _:
                    raise AssertionError(f"{type(step).__name__} is no part of a step of a law")
        if not inner:
            return
        yield text(f"{me}.process = {part}")
        yield Block(text("try:"), tuple(inner))
        failed = (
            text(f"{me}.process = {process}"),
            text(f"{part}.blame({error})"),
            text("raise"),
        )
        yield Block(text(f"except Exception as {error}:"), failed)
        yield text(f"{me}.process = {process}")

    def _inline_law(self, law: RunLaw) -> InlineLaw:
        return InlineLaw(law, self.spelling.process, self.printer, self.spelling.names, self.place_of, self.modules)

    def _read_inputs(self, action: ReadInputs) -> Iterator[Statement]:
        if action.reads:
            yield self.comment(action, f"inputs of {action.law}")
        yield from self.communications.read_all(
            [(read.source, self.spelling.signal(read.name).flat) for read in action.reads]
        )

    def _write_outputs(self, action: WriteOutputs) -> Iterator[Statement]:
        if action.writes:
            yield self.comment(action, f"outputs of {action.law}")
        pairs = []
        for write in action.writes:
            if isinstance(write.value, SignalValue | LiteralValue | ParameterValue):
                pairs.append((write.sink, self.printer.print(write.value).flat))
            else:
                name = self.spelling.names.fresh(f"{action.law}_output")
                yield from assigned(name, self.printer, write.value, None)
                pairs.append((write.sink, name))
        yield from self.communications.write_all(pairs)

    def _reset(self, states: Sequence[str]) -> Iterator[Statement]:
        yield from reset_statements(states, self.spelling.process, self.printer, self.place_of)
        external = {item.name for item in external_calls(self.spelling.process.body)}
        for name in states:
            if name in external:
                spelled = self.spelling.signal(name).flat
                yield Block(text(f'if hasattr({spelled}, "reset"):'), (text(f"{spelled}.reset()"),))


def law_of(action: Action) -> str:
    """The law that an action belongs to, or nothing."""
    return action.law if isinstance(action, ReadInputs | WriteOutputs | RunLaw) else ""
