"""What can be wrong with the equations of a submodel once they are put together."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record


@record
class AlgebraicLoop(Diagnostic):
    code = "E0450"
    title = "an algebraic loop"

    loop: tuple[tuple[str, Span], ...]
    """Name and place of each equation, each reading the next and the last the first."""
    in_environment: bool = False

    @property
    def message(self) -> str:
        if len(self.loop) == 1:
            return f"`{self.loop[0][0]}` depends on itself within one sample"
        names = [name for name, _ in self.loop]
        return "these equations need each other within one sample: " + " ← ".join([*names, names[0]])

    @property
    def label(self) -> str:
        return f"reads `{self.loop[1 % len(self.loop)][0]}`"

    @property
    def labels(self) -> tuple[Label, ...]:
        following = [*self.loop[1:], self.loop[0]]
        pairs = list(zip(self.loop, following, strict=True))[1:]
        return tuple(Label(span, f"`{name}` reads `{other}`") for (name, span), (other, _) in pairs)

    @property
    def help(self) -> str:
        if self.in_environment:
            return (
                "let one of these submodels output its value of the previous sample, `pre(x, 0)`, or keep it in a state"
            )
        names = [name for name, _ in self.loop]
        name = min(reversed(names), key=lambda name: (name.count("."), not name.replace(".", "").isidentifier()))
        return f"take one of them from the previous sample, for example `pre({name}, 0)`, or make it a state"


@record
class TimeOutsideEnvironment(Diagnostic):
    code = "E0458"
    title = "time outside an environment"
    help = "count samples in a state: `next t = t + sample`"

    submodel: str

    @property
    def message(self) -> str:
        return f"the submodel `{self.submodel}` runs in a process, where there is no `time`"


@record
class IntegrationStepNotPositive(Diagnostic):
    code = "E0459"
    title = "a step that is not positive"
    message = "the step of an integration must be positive"


@record
class TooManyEquations(Diagnostic):
    code = "E0461"
    title = "too many equations"
    help = "compute them in a body in another language, or divide them over several submodels of a process"

    submodel: str
    limit: int

    @property
    def message(self) -> str:
        return f"the submodels nested in `{self.submodel}` have more than {self.limit} equations in all"
