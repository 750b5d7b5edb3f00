"""Random compositions as text: every construct within every other. They need not have a meaning."""

from __future__ import annotations

from random import Random

_NAMES = ("a", "servo", "joystick_buttons", "a_process_with_quite_a_long_name", "cell[i]")
_EXPRESSIONS = ("1", "x + 1", "limit(gain * (wanted - latest.temperature), 0<W>, 100<W>) + offset[i + 1]")
_CONDITIONS = ("stop", "x < 3 and not (y == 12)", "count < capacity or latest.temperature > 5<K>")


def random_composition(seed: int) -> str:
    """The text of a composition, the same for the same seed."""
    random = Random(seed)
    return _composition(random, random.randint(1, 4))


def _composition(random: Random, depth: int) -> str:
    return random.choice(_FORMS)(random, depth - 1) if depth > 0 else _activity(random)


def _activity(random: Random) -> str:
    name, value = random.choice(_NAMES), random.choice(_EXPRESSIONS)
    forms = (name, name, f"{name} ? x", f"{name} ! {value}", f"x := {value}")
    return random.choice((*forms, "skip", "stop", "wait 5 ms", "reset servo", "raise Timeout"))


def _part(random: Random, depth: int) -> str:
    return f"({_composition(random, depth - random.randint(0, 2))})"


def _guard(random: Random) -> str:
    name = random.choice(_NAMES)
    event = random.choice((name, f"{name} ? x", f"{name} ! {random.choice(_EXPRESSIONS)}", "after 5 ms", "skip"))
    return event if random.random() < 0.6 else f"when {random.choice(_CONDITIONS)} & {event}"


def _branch(random: Random, depth: int) -> str:
    return f"{_guard(random)} -> {_part(random, depth)}"


def _chain(random: Random, depth: int) -> str:
    operator = random.choice((" ; ", " ; ", " || ", " ||> "))
    return operator.join(_part(random, depth) for _ in range(random.choice((2, 2, 3, 4, 9))))


def _alternative(random: Random, depth: int) -> str:
    operator = random.choice((" [] ", " []> "))
    branches = [_branch(random, depth) for _ in range(random.randint(2, 4))]
    if random.random() < 0.3:
        branches.append(f"alt i < 3 : {_branch(random, depth)}")
    return operator.join(branches)


def _loop(random: Random, depth: int) -> str:
    part, condition = _part(random, depth), random.choice(_CONDITIONS)
    return random.choice((f"mu {part}", f"mu {part} until {condition}", f"while {condition} do {part}"))


def _choice(random: Random, depth: int) -> str:
    cases = " else ".join(
        f"if {random.choice(_CONDITIONS)} then {_part(random, depth)}" for _ in range(random.randint(1, 3))
    )
    return cases if random.random() < 0.5 else f"{cases} else {_part(random, depth)}"


def _watched(random: Random, depth: int) -> str:
    handlers = (
        f"catch Timeout -> {_part(random, depth)}"
        if random.random() < 0.5
        else f"interrupt {_guard(random)} -> {_part(random, depth)}"
        for _ in range(random.randint(1, 3))
    )
    return f"{_part(random, depth)} {' '.join(handlers)}"


def _replication(random: Random, depth: int) -> str:
    operator = random.choice(("seq", "par", "pripar", "alt", "prialt"))
    inner = _branch(random, depth) if operator.endswith("alt") else _part(random, depth)
    return f"{operator} i < producers : {inner}"


def _named(random: Random, depth: int) -> str:
    return f"{random.choice(('h', 'horizontal_joint'))}: {_part(random, depth)}"


_FORMS = (_chain, _chain, _alternative, _branch, _loop, _choice, _watched, _replication, _named)
