"""Control laws inlined in a generator function: they are executed, and fail, under their own name."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from cspdiag.codegen.python.fast.laws.in_place import InlineLaw, reset_statements
from cspdiag.codegen.python.fast.spelling import is_plain_access
from cspdiag.codegen.python.fast.statements import assigned
from cspdiag.codegen.python.fast.values import Values
from cspdiag.codegen.python.text.code import Code, Constant, Name, call
from cspdiag.codegen.python.text.literals import quoted
from cspdiag.codegen.python.text.statements import RAISE, Block, Declare, Statement, assign, if_, run, try_
from cspdiag.codegen.python.text.types import annotation
from cspdiag.network.ir.actions import Action, End, ReadInputs, RunLaw, WriteOutputs
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.expressions import LiteralValue, ParameterValue, SignalValue
from cspdiag.network.ir.external import external_calls


@dataclass
class LawSteps(Values):
    """Writes the inlined laws of one process class."""

    def _law(self, steps: Sequence[Action]) -> Iterator[Statement]:
        """Steps of one law, executed under its name."""
        error = self.spelling["error"]
        law = law_of(steps[0])
        part = self.spelling.part(law)
        inner: list[Statement] = []
        for step in steps:
            match step:
                case ReadInputs():
                    inner += self._read_inputs(step)
                case WriteOutputs():
                    inner += self._write_outputs(step)
                case RunLaw():
                    inline = self._inline_law(step)
                    self._declare_kept(inline)
                    self.prologue += inline.prologue()
                    inner += inline.statements()
                    self.communications.finite = frozenset(inline.finite_signals())
                case _:
                    raise AssertionError(f"{type(step).__name__} is no part of a step of a law")
        self.communications.finite = frozenset()
        if not inner:
            return
        enter, leave = self.executes(part), self.executes(self.process)
        blamed = (run(part.call("blame", error)), RAISE)
        if all(map(self._is_unseen, steps)):
            yield try_(*inner)
            yield Block("except", Name("Exception"), blamed, bound=error.text)
            return
        yield enter
        yield try_(*inner)
        yield Block("except", Name("Exception"), (leave, *blamed), bound=error.text)
        yield leave

    def _declare_kept(self, inline: InlineLaw) -> None:
        """Declare the local variables that keep their values from one run to the next, each once."""
        for name, type_ in inline.kept():
            if name not in self.spelling.kept:
                self.spelling.kept.add(name)
                self.prologue.append(Declare(Name(name), annotation(type_, self.imports)))
        self.spelling.kept.update(inline.present())

    def executes(self, part: Code) -> Statement:
        """From now on the task executes ``part``."""
        return assign(self.spelling["me"].field("process"), part)

    def _is_unseen(self, step: Action) -> bool:
        """Whether nothing outside can see, during a step of a law, what executes it: it does not wait, reports no
        communication and calls no code of others.
        """
        match step:
            case RunLaw(equations=equations):
                return not any(isinstance(item, ExternalCall) for item in equations)
            case ReadInputs(reads=reads):
                return all(is_plain_access(read.source, self.spelling.medium(read.source)) for read in reads)
            case WriteOutputs(writes=writes):
                return all(self.communications.is_unseen(write.sink) for write in writes)
            case _:  # No other action is a step of a law.
                return False

    def _inline_law(self, law: RunLaw) -> InlineLaw:
        return InlineLaw(law, self.spelling.process, self.printer, self.spelling.names, self.place_of, self.modules)

    def _read_inputs(self, action: ReadInputs) -> Iterator[Statement]:
        if action.reads:
            yield self.comment(action, f"inputs of {action.law}")
        yield from self.communications.read_all(
            [(read.source, self.spelling.signal(read.name)) for read in action.reads]
        )

    def _write_outputs(self, action: WriteOutputs) -> Iterator[Statement]:
        if action.writes:
            yield self.comment(action, f"outputs of {action.law}")
        pairs: list[tuple[End, Code]] = []
        for write in action.writes:
            if isinstance(write.value, SignalValue | LiteralValue | ParameterValue):
                pairs.append((write.sink, self.printer.print(write.value)))
            else:
                name = Name(self.spelling.names.fresh(f"{action.law}_output"))
                yield from assigned(name, self.printer, write.value, None)
                pairs.append((write.sink, name))
        yield from self.communications.write_all(pairs)

    def _reset(self, states: Sequence[str]) -> Iterator[Statement]:
        yield from reset_statements(states, self.spelling.process, self.printer, self.place_of)
        external = {item.name for item in external_calls(self.spelling.process)}
        for name in states:
            if name in external:
                spelled = self.spelling.signal(name)
                yield if_(call("hasattr", spelled, Constant(quoted("reset"))), run(spelled.call("reset")))


def law_of(action: Action) -> str:
    """The law that an action belongs to; empty if there is none."""
    return action.law if isinstance(action, ReadInputs | WriteOutputs | RunLaw) else ""
