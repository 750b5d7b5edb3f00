"""What is to be proved of a program: its assertions, with the networks of the processes that they are about."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from cspdiag import pipeline
from cspdiag.base.record import node, replaced
from cspdiag.base.span import SourceFile

if TYPE_CHECKING:
    from cspdiag.model.program import Program, Value
    from cspdiag.model.types import Real
    from cspdiag.network.analyse import Analysis
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.network.lower.setting_paths import Root
    from cspdiag.proofs.answers.answer import Answer
    from cspdiag.proofs.answers.question import Question


@node
class ProofObligations:
    """A program and what is to be proved of it; ``networks`` has the networks of its processes, by name, as far as they
    were lowered. ``answers`` are those that need no states: fewer elements of the arrays have proved them, or a process
    has no value for a parameter. Without questions ``nothing`` says why there are none, if the program has no errors.
    """

    checked: pipeline.Checked
    questions: tuple[Question, ...]
    networks: dict[str, CoreNetwork]
    parameters: Mapping[str, Value]
    answers: dict[Question, Answer]
    nothing: str = ""

    def network(self, process: str) -> CoreNetwork | None:
        """The network of a process as the outermost one; None if lowering it reports an error. Raises
        MissingValueError.
        """
        if process not in self.networks:
            is_specification = process in {question.specification for question in self.questions}
            is_asked = process in {question.process for question in self.questions}
            network = pipeline.compile_network(
                self.checked,
                top=process,
                overrides=self.parameters,
                surroundings="specification" if is_specification and not is_asked else "environment",
            )
            if network is None:
                return None
            self.networks[process] = network
        return self.networks[process]

    def lower(self, questions: Sequence[Question] | None = None) -> None:
        """Lower the processes of some questions, or all, that are open; the report has what is wrong with them. Raises
        MissingValueError if nothing is asserted and the outermost process lacks a value.
        """
        from cspdiag.network.lower.program import MissingValueError
        from cspdiag.proofs.answers.undefined import without_values

        for question in self.questions if questions is None else questions:
            for name in () if question in self.answers else question.processes:
                try:
                    self.network(name)
                except MissingValueError as problem:
                    if not question.asserted:
                        raise
                    self.answers[question] = without_values(question, name, problem.parameters)
                    break


def proof_obligations(
    main: SourceFile,
    read: pipeline.Reader,
    *,
    process: str | None = None,
    settings: Mapping[str, str] | None = None,
    real: Real = "double",
    by_rules: bool = True,
) -> ProofObligations:
    """Check a program and collect what is to be proved: its assertions, or those about ``process``.

    If there are none, what is expected of ``process``, or else of the outermost process; a library has none. With
    ``by_rules``, what design rules prove once for all elements of arrays is proved already. Raises the same exceptions
    as ``build``, but for a library only if ``process`` is given.
    """
    from cspdiag.network.lower.program import NoProgramError, selection
    from cspdiag.proofs.answers.at_once import answers_at_once
    from cspdiag.proofs.answers.question import expected_of, questions_of

    def roots(program: Program, analysis: Analysis) -> Sequence[Root]:
        named = dict.fromkeys(name for question in questions_of(program, process) for name in question.processes)
        found: dict[Root, None] = {}
        for name in named or (process,):
            try:
                outermost, environments = selection(program, analysis, name, None)
            except NoProgramError:
                continue
            found |= dict.fromkeys((outermost, *environments))
        return tuple(found)

    checked, overrides = pipeline.check_with(main, read, settings, roots, real, for_findings=by_rules)
    proved: dict[Question, Answer] = {}
    fewer = checked.fewer
    if checked.program is not None and fewer is not None:
        questions, proved = answers_at_once(
            checked.program, fewer.varying, process, lambda name: pipeline.compile_network(fewer.checked, top=name)
        )
        if len(proved) == len(questions) > 0:
            return ProofObligations(checked=checked, questions=questions, networks={}, parameters={}, answers=proved)
        checked = pipeline.changed(checked, overrides.constants, overrides.places)
    obligations = ProofObligations(
        checked=checked, questions=(), networks={}, parameters=overrides.parameters, answers=proved
    )
    if checked.program is None or checked.report.has_errors:
        return obligations
    questions = questions_of(checked.program, process)
    if not questions:
        try:
            network = pipeline.compile_network(checked, top=process, overrides=overrides.parameters)
        except NoProgramError as problem:
            return replaced(obligations, nothing=str(problem))
        if network is None:
            return obligations
        outermost = network.class_named(network.top).definition
        obligations.networks[outermost] = network
        questions = expected_of(checked.program, outermost)
    return replaced(obligations, questions=questions)
