"""``cspdiag run --replay``: step a program through a counterexample."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterator
from typing import TYPE_CHECKING

from cspdiag.base.sources import read_source
from cspdiag.cli.support.failure import FINE, UNSUCCESSFUL, NoResultError, UsageError
from cspdiag.cli.support.terminal import say, show_diagnostics

if TYPE_CHECKING:
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.verify.replay.result import Replay
    from cspdiag.verify.runs.trace import Trace

_UNFIT = ("environment", "until", "record", "trace", "plot", "json")


def run(arguments: Namespace) -> int:
    """Report what happens, and whether that agrees with the trace; exit code 0 if it does."""
    _refuse_other_options(arguments)
    from cspdiag.codegen import target_errors
    from cspdiag.proofs.verdict import LimitError
    from cspdiag.simulate.run.execute import BodyError
    from cspdiag.verify.confirm import replayed
    from cspdiag.verify.runs.trace import TraceError, read_trace

    try:
        trace = read_trace(read_source(str(arguments.replay)).text)
    except TraceError as problem:
        raise UsageError(f"{arguments.replay}: {problem}") from None
    network = _network(arguments, trace)
    if network is None:
        return UNSUCCESSFUL
    try:
        result = replayed(network, trace, read_source)
    except (BodyError, LimitError, target_errors()) as problem:
        raise NoResultError(str(problem)) from None
    if not arguments.quiet:
        say("\n".join((*_report(network, trace, result), *_other_settings(arguments, trace, result))))
    return FINE if result.succeeded else UNSUCCESSFUL


def _refuse_other_options(arguments: Namespace) -> None:
    given = [name for name in _UNFIT if getattr(arguments, name) is not None]
    if arguments.real_time:
        given.append("real_time")
    if given:
        names = ", ".join("--for" if name == "until" else f"--{name.replace('_', '-')}" for name in given)
        raise UsageError(f"--replay cannot be combined with {names}: the trace says what happens and when")


def _network(arguments: Namespace, trace: Trace) -> CoreNetwork | None:
    from cspdiag.network.lower.program import SelectionError
    from cspdiag.pipeline import build
    from cspdiag.settings import SettingError, split_settings

    try:
        own = split_settings(arguments.settings)
        settings = {**trace.settings, **own}
        real = arguments.real or trace.real
        built = build(read_source(arguments.file), read_source, top=trace.process, settings=settings, real=real)
    except (SettingError, SelectionError) as problem:
        kept = [f"{name}={value}" for name, value in trace.settings.items() if name not in own]
        source = f" ({arguments.replay} has the settings {', '.join(kept)})" if own and kept else ""
        raise UsageError(f"{problem}{source}") from None
    show_diagnostics(built.checked.report.diagnostics, arguments.color)
    return built.network


def _report(network: CoreNetwork, trace: Trace, result: Replay) -> Iterator[str]:
    from cspdiag.network.dump.expression import value_text
    from cspdiag.runtime.kernel.durations import shown
    from cspdiag.verify.runs.names import below
    from cspdiag.verify.runs.values import types_of

    types = types_of(network)
    yield f"replay of the counterexample to `{trace.assertion}`"
    rounds, lasting = result.repeated or (0, 0)
    instants = [f"{shown(instant)}  " for instant in result.instants] if lasting or any(result.instants) else []
    width = max(map(len, instants), default=0)
    round_from = None if result.divergence is not None else result.round_from
    for number, (channel, value) in enumerate(result.communications):
        if number == round_from:
            every = f"every {shown(lasting)}" if rounds == 1 else f"{rounds} rounds in {shown(lasting)}"
            yield f"then again and again{f', {every}' if lasting else ''}:"
        when = instants[number].rjust(width) if instants else ""
        name = channel.removeprefix(f"{trace.process}.")
        yield f"{number + 1:>5}  {when}{name}  {value_text(value, types[channel])}"
    if round_from == len(result.communications):
        yield f"then again and again, {trace.round}"
    if result.deadlock is not None:
        yield below(result.deadlock, trace.process).text
    yield _conclusion(trace, result, repeats_forever=round_from is not None)


def _other_settings(arguments: Namespace, trace: Trace, result: Replay) -> Iterator[str]:
    """How the settings differ from those of the trace, if that may be the reason why it cannot be replayed."""
    from cspdiag.settings import split_settings

    if result.divergence is None:
        return
    if arguments.real not in (None, trace.real):
        yield f"  --real is {arguments.real}; the trace was made with {trace.real}"
    for name, value in split_settings(arguments.settings).items():
        made = trace.settings.get(name)
        if made is None:
            yield f"  {name} is set to {value}; the trace was made without this setting"
        elif made != value:
            yield f"  {name} is set to {value}; the trace was made with {name}={made}"


def _conclusion(trace: Trace, result: Replay, *, repeats_forever: bool) -> str:
    from cspdiag.verify.runs.names import in_words

    total = trace.shown_before(len(trace.steps) + len(trace.cycle))
    if result.divergence is not None:
        done = trace.shown_before(result.steps)
        after = f"after {done} of {total} step{'' if total == 1 else 's'}, " if total else ""
        return f"not replayed: {after}{in_words(result.divergence, trace.process)}"
    did = ["did what the trace says", "did the one step"][total] if total < 2 else f"did all {total} steps"
    if not repeats_forever:
        return f"replayed: the program {did}"
    return f"replayed: the program {did + ', and ' if total else ''}can repeat this forever"
