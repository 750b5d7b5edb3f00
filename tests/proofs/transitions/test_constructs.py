"""What each construct of the language becomes."""

from __future__ import annotations

import pytest

from cspdiag.proofs.transitions.systems.system import INTERNAL
from tests.proofs.transitions.building import component, listing, system_of

WRITER = "process P { out c : int composition { c ! 1 } }\n"
READER = "process Q { in c : int communication { var x : int } composition { c ? x } }\n"


def main(declarations: str, composition: str, ports: str = "") -> str:
    return f"process Main {{ {ports} communication {{ {declarations} }} composition {{ {composition} }} }}"


def test_alternative_offers_every_enabled_guard() -> None:
    text = main("var x : int", "mu (a ? x -> b ! x [] after 5 ms -> skip)", "in a : int out b : int")
    assert listing(system_of(text), "Main").splitlines() == [
        "state 0 initial",
        "external visible Main.a -> 1",
        "time Main: after 5 ms -> 0",
        "state 1",
        "external visible Main.b -> 0",
    ]


def test_guard_with_a_condition_that_does_not_hold_is_not_offered() -> None:
    text = main(
        "var x : int = 0", "(when x > 0 & a ? x -> skip [] when x == 0 & b ! 1 -> skip)", "in a : int out b : int"
    )
    assert [str(event) for event in system_of(text).events] == ["Main.b.1"]


def test_alternative_without_an_enabled_guard_is_stuck() -> None:
    text = main("var x : int = 0", "(when x > 0 & a ? x -> skip [] when x < 0 & a ? x -> skip)", "in a : int")
    stuck = component(system_of(text), "Main")
    assert stuck.edges == ((),)
    assert stuck.terminal == frozenset()


def test_values_that_conditions_depend_on_are_followed_through_channels() -> None:
    text = (
        "process P { out c : bool communication { var b : bool = false } composition { mu (c ! b ; b := not b) } }\n"
        "process Q { in c : bool out d : int communication { var x : bool }"
        " composition { mu (c ? x ; if x then d ! 1 else d ! 0) } }\n"
        + main("p : P q : Q p.c -> q.c q.d -> d", "p || q", "out d : int")
    )
    system = system_of(text)
    assert listing(system, "Main.q").splitlines() == [
        "state 0 initial",
        "communication Main.p.c.false with Main.p -> 1",
        "communication Main.p.c.true with Main.p -> 2",
        "state 1",
        "external visible Main.d.0 -> 0",
        "state 2",
        "external visible Main.d.1 -> 0",
    ]
    assert not system.abstractions


def test_values_that_decide_nothing_are_not_followed() -> None:
    text = WRITER + READER + main("p : P q : Q p.c -> q.c", "p || q")
    assert [str(event) for event in system_of(text).events if event.kind == "communication"] == ["Main.p.c"]


def test_a_counter_with_too_many_values_may_continue_or_have_ended() -> None:
    text = main("var n : int = 0", "mu (b ! n ; n := n + 1) until n == 1000", "out b : int")
    system = system_of(text)
    assert [edge[0] for edge in system.components[0].edges[1]] == [INTERNAL, INTERNAL]
    assert [abstraction.what for abstraction in system.abstractions] == [
        "of the values of `n` only ranges are followed: there are too many",
    ]
    assert all(abstraction.span is not None for abstraction in system.abstractions)


def test_bounded_counter_is_followed() -> None:
    text = main("var n : int = 0", "mu (b ! n ; n := n + 1) until n == 3", "out b : int")
    system = system_of(text)
    assert [len(edges) for edges in system.components[0].edges] == [1, 1, 1, 0]
    assert system.components[0].terminal == {3}


def test_condition_on_what_a_law_computes_is_left_open() -> None:
    text = "submodel Law { in x : double out high : bool high = x > 1 }\n" + main(
        "law : Law y -> law.x law.high -> high : bool", "mu law until high", "in y : double @ 1 ms"
    )
    system = system_of(text)
    assert [abstraction.what for abstraction in system.abstractions] == ["`high` in `Main` may hold or not"]


def test_an_open_condition_evaluated_twice_has_one_result() -> None:
    text = "submodel Law { in x : double out high : bool high = x > 1 }\n" + main(
        "law : Law y -> law.x law.high -> high : bool",
        "law ; (if high then b ! 1 else b ! 2) ; (if high then b ! 3 else b ! 4)",
        "in y : double @ 1 ms out b : int",
    )
    system = system_of(text)
    follows = {}
    for edges in component(system, "Main").edges:
        for event, target in edges:
            if event != INTERNAL and system.events[event].value in ("1", "2"):
                ((after, _),) = component(system, "Main").edges[target]
                follows[system.events[event].value] = system.events[after].value
    assert follows == {"1": "3", "2": "4"}


def test_buffer_is_a_component_that_counts() -> None:
    text = WRITER.replace("c ! 1", "mu (c ! 1)") + READER.replace("c ? x", "mu (c ? x)")
    buffer = component(system_of(text + main("p : P q : Q p.c -> buffer 2 -> q.c", "p || q")), "Main.p.c")
    assert [[target for _, target in edges] for edges in buffer.edges] == [[1], [2, 0], [1]]
    assert not buffer.process


def test_overwriting_buffer_takes_values_when_it_is_full() -> None:
    text = WRITER.replace("c ! 1", "mu (c ! 1 ; wait 1 ms)") + READER.replace("c ? x", "mu (c ? x)")
    buffer = component(system_of(text + main("p : P q : Q p.c -> overwrite 1 -> q.c", "p || q")), "Main.p.c")
    assert [[target for _, target in edges] for edges in buffer.edges] == [[1], [1, 0]]


def test_broadcast_is_delivered_when_every_end_has_taken_it() -> None:
    text = WRITER + READER + main("p : P q[2] : Q p.c -> broadcast -> q[0].c, q[1].c", "p || q[0] || q[1]")
    system = system_of(text)
    assert listing(system, "Main.p").splitlines()[:4] == [
        "state 0 initial",
        "take Main.p.c (written) with Main.p.c to Main.q[0], Main.p.c to Main.q[1] -> 1",
        "state 1",
        "delivered Main.p.c (taken by all) with Main.p.c to Main.q[0], Main.p.c to Main.q[1] -> 2",
    ]
    assert listing(system, "Main.q[1]").splitlines()[1] == "communication Main.p.c with Main.p.c to Main.q[1] -> 1"


def test_any_channel_joins_every_writer_with_every_reader() -> None:
    text = WRITER + READER + main("p[2] : P q : Q p[0].c, p[1].c -> any -> q.c", "p[0] || p[1] || q")
    system = system_of(text)
    joined = [
        sorted(system.components[party].name for party in event.parties)
        for event in system.events
        if event.kind == "communication"
    ]
    assert joined == [["Main.p[0]", "Main.q"], ["Main.p[1]", "Main.q"]]


def test_first_sample_is_never_missed_and_later_ones_may_be() -> None:
    text = main(
        "var x : double = 0", "(mu (y ? x ; u ! x)) catch Timeout -> u ! 0", "in y : double @ 1 ms out u : double"
    )
    assert listing(system_of(text), "Main").splitlines() == [
        "state 0 initial",
        "sample visible Main.y -> 1",
        "state 1",
        "external visible Main.u -> 2",
        "state 2",
        "sample visible Main.y -> 1",
        "miss Main.y -> 3",
        "state 3",
        "external visible Main.u.0.0 -> 4",
        "state 4 terminal",
    ]


def test_misses_that_are_counted_raise_nothing() -> None:
    text = (
        main("var x : double = 0", "mu (y ? x ; u ! x)", "in y : double @ 1 ms out u : double")
        + "\nsubmodel Plant { in u : double out y : double state s : double = 0 next s = u y = s }"
        + "\nenvironment Bench for Main on miss count { plant : Plant u -> plant.u plant.y -> y }"
    )
    assert all(event.kind != "miss" for event in system_of(text).events)


def test_exception_cancels_the_other_branches() -> None:
    text = (
        "exception Odd\n"
        "process P { in a : int communication { var x : int } composition { a ? x ; raise Odd } }\n"
        "process Q { out b : int composition { mu (b ! 1 ; wait 1 ms) } }\n"
        + main("p : P q : Q a -> p.a q.b -> b", "(p || q) catch Odd -> b ! 0", "in a : int out b : int")
    )
    system = system_of(text)
    assert listing(system, "Main").splitlines() == [
        "state 0 initial terminal",
        "end Main: parallel end with Main.p, Main.q -> 1",
        "exception Main.p: Odd with Main.p -> 2",
        "state 1 terminal",
        "state 2 terminal",
        "cancel Main: parallel cancel with Main.p, Main.q -> 3",
        "state 3 terminal",
        "end Main: parallel end with Main.p, Main.q -> 4",
        "state 4",
        "external visible Main.b.0 -> 1",
    ]
    cancels = next(number for number, event in enumerate(system.events) if event.kind == "cancel")
    running = [edges for edges in component(system, "Main.q").edges if any(event != cancels for event, _ in edges)]
    assert all(any(event == cancels for event, _ in edges) for edges in running[:2])


def test_interrupt_offers_its_guard_wherever_the_body_waits() -> None:
    text = main("var x : int", "(mu (b ! 1 ; wait 1 ms)) interrupt a ? x -> b ! 0", "in a : int out b : int")
    assert listing(system_of(text), "Main").splitlines() == [
        "state 0 initial",
        "external visible Main.b.1 -> 1",
        "external visible Main.a -> 2",
        "state 1",
        "time Main: wait 1 ms -> 0",
        "external visible Main.a -> 2",
        "state 2",
        "external visible Main.b.0 -> 3",
        "state 3 terminal",
    ]


def test_law_reads_its_inputs_in_any_order() -> None:
    text = (
        "submodel Law { in x, z : double out y : double y = x + z }\n"
        "process P { out x : double composition { mu (x ! 1) } }\n"
        + main("law : Law p : P q : P p.x -> law.x q.x -> law.z law.y -> y", "p || q || mu law", "out y : double")
    )
    assert listing(system_of(text), "Main.law").splitlines() == [
        "state 0 initial",
        "communication Main.p.x with Main.p -> 1",
        "communication Main.q.x with Main.q -> 2",
        "state 1",
        "communication Main.q.x with Main.q -> 3",
        "state 2",
        "communication Main.p.x with Main.p -> 3",
        "state 3",
        "external visible Main.y -> 0",
    ]


def test_law_with_many_inputs_reads_each_in_a_component_of_its_own() -> None:
    text = (
        "submodel Law { in x[8] : double out y : double y = x[0] }\n"
        "process P { out x : double composition { mu (x ! 1) } }\n"
        + main(
            "law : Law p[8] : P for i < 8 { p[i].x -> law.x[i] } law.y -> y",
            "(par i < 8 : p[i]) || mu law",
            "out y : double",
        )
    )
    system = system_of(text)
    assert len(system.components) == 1 + 8 + 1 + 8
    assert max(len(one.edges) for one in system.components) < 6


def test_variable_that_two_components_access_is_a_component() -> None:
    text = (
        "process P { in a : bool out v : bool communication { var x : bool } composition { a ? x ; v ! x } }\n"
        + main(
            "p : P var flag : bool = false a -> p.a p.v -> flag",
            "(p || wait 1 ms) ; if flag then b ! 1 else b ! 0",
            "in a : bool out b : int",
        )
    )
    system = system_of(text)
    flag = component(system, "Main.flag")
    assert not flag.process
    assert len(flag.edges) == 2
    assert flag.initial == 0
    assert not system.abstractions


def test_a_partner_that_never_arrives_is_nobody() -> None:
    text = WRITER.replace("c ! 1", "if 1 > 2 then c ! 1 else stop") + READER + main("p : P q : Q p.c -> q.c", "p || q")
    system = system_of(text)
    (event,) = system.events
    assert [system.components[party].name for party in event.parties] == ["Main.q", "nobody"]
    assert component(system, "Main.p").edges[0] == ()


def test_instance_that_runs_again_is_started_again() -> None:
    text = "process Q { out b : int composition { b ! 1 || wait 1 ms } }\n" + main(
        "q : Q q.b -> b", "q ; wait 1 ms ; q", "out b : int"
    )
    system = system_of(text)
    assert listing(system, "Main.q.1").splitlines() == [
        "state 0 initial",
        "external visible Main.b.1 -> 1",
        "state 1 terminal",
        "end Main.q: parallel end with Main, Main.q.2 -> 2",
        "state 2 terminal",
        "start Main.q: parallel start with Main, Main.q.2 -> 0",
    ]


def test_process_written_by_hand_may_do_anything_on_its_ports() -> None:
    text = 'process Hand python "hand.py:Hand" { in a : int out b : int }\n' + main(
        "h : Hand a -> h.a h.b -> b", "h", "in a : int out b : int"
    )
    system = system_of(text)
    assert sorted(str(event) for event in system.events) == ["Main.a", "Main.b"]
    assert [edge[0] for edge in system.components[0].edges[0]] == [INTERNAL] * 3
    (abstraction,) = system.abstractions
    assert "`Hand` is written by hand" in abstraction.what


def test_circle_without_communication_is_an_internal_edge_to_itself() -> None:
    text = main("var n : int = 0", "mu (n := 1 - n) until n > 5")
    system = system_of(text)
    assert system.components[0].edges == (((INTERNAL, 0),),)


def test_fault_is_left_open_only_where_it_is_caught() -> None:
    composition = "a ? x ; (b ! 10 / x) catch Fault -> b ! -1"
    ports = "in a : int out b : int"
    caught = system_of(main("var x : int", composition, ports))
    assert [abstraction.what for abstraction in caught.abstractions] == ["`10 / x` in `Main` may end in a fault or not"]
    assert not system_of(main("var x : int", "a ? x ; b ! 10 / x", ports)).abstractions
    assert not system_of(main("var x : int", composition.replace("10 / x", "x / 10"), ports)).abstractions


def test_index_out_of_range_is_a_fault() -> None:
    composition = "((a ? x ; v[INDEX] := x ; b ! 1) catch Fault -> b ! 2)"
    declarations = "var x : int = 0 var v : int[3] = [1, 2, 3]"
    ports = "in a : int out b : int"
    written = {
        index: {
            event.value for event in system_of(main(declarations, composition.replace("INDEX", index), ports)).events
        }
        for index in ("2", "7", "x")
    }
    assert {index for index, values in written.items() if "2" in values} == {"7", "x"}


@pytest.mark.parametrize(
    "statement",
    [
        "v := int8(x)",
        "v := small + small",
        "v := -least",
        "n := word + 1",
        "t := pause + pause",
        "n := v3[at]",
        "n := v3[at - 4]",
    ],
)
def test_what_is_out_of_range_is_a_fault_also_where_it_is_known_before_the_run(statement: str) -> None:
    parameters = (
        "small : int8 = 100, least : int8 = -128, word : int = 9223372036854775807, "
        "pause : time = 9223372036854775807 ns, at : int = 3"
    )
    declarations = "var x : int = 0 var n : int = 0 var t : time = 0 s var v : int8 = 0 var v3 : int[3] = [1, 2, 3]"
    text = main(declarations, f"a ? x ; (({statement}) catch Fault -> b ! 2)", "in a : int out b : int")
    events = system_of(text.replace("process Main", f"process Main({parameters})")).events
    assert "2" in {event.value for event in events}


def test_nested_parallels_are_one() -> None:
    text = (
        WRITER
        + READER
        + main("p[2] : P q[2] : Q for i < 2 { p[i].c -> q[i].c }", "(par i < 2 : p[i]) || (par i < 2 : q[i])")
    )
    assert [one.name for one in system_of(text).components] == [
        "Main",
        "Main.p[0]",
        "Main.p[1]",
        "Main.q[0]",
        "Main.q[1]",
    ]


def test_alternative_with_many_open_conditions_stays_small() -> None:
    guards = " [] ".join(f"when x[{number}] > 0 & a[{number}] ? x[{number}] -> skip" for number in range(12))
    zeros = ", ".join(["0"] * 12)
    text = main(f"var x : double[12] = [{zeros}]", f"mu ((seq i < 12 : a[i] ? x[i]) ; ({guards}))", "in a[12] : double")
    system = system_of(text)
    decides = component(system, "Main").edges[12]
    assert [event for event, _ in decides] == [INTERNAL] * 13
    offered = [len(component(system, "Main").edges[target]) for _, target in decides]
    assert sorted(offered) == [0] + [1] * 12
    assert len(system.abstractions) == 12


def test_deep_hierarchies_are_followed() -> None:
    text = "process P0 { out c : int composition { c ! 1 ; wait 1 ms } }\n"
    for depth in range(1, 100):
        inner = f"communication {{ p : P{depth - 1} p.c -> c }} composition {{ p || wait 1 ms }}"
        text += f"process P{depth} {{ out c : int {inner} }}\n"
    assert len(system_of(text, "P99").components) == 1 + 2 * 99


def test_branches_have_names_of_their_own() -> None:
    text = "submodel Law { in x : double out y : double y = x }\n" + main(
        "law : Law x -> law.x law.y -> y",
        "(law || wait 1 ms) ; ((law ; wait 2 ms) || group: (wait 1 ms ; wait 1 ms))",
        "in x : double out y : double",
    )
    names = [one.name for one in system_of(text).components]
    assert names == ["Main", "Main.law", "Main.2", "Main.law (2)", "Main.group"]


READY = "process P { out c : int composition { mu (c ! 1) } }\n" + main(
    "p : P channel c : int p.c -> c var x : int",
    "p || mu (c -> (BODY) [] a ? x -> skip)",
    "in a : int out b : int",
)


def test_ready_guard_is_the_communication_that_its_process_begins_with() -> None:
    system = system_of(READY.replace("BODY", "c ? x ; b ! x"))
    assert listing(system, "Main.2").splitlines() == [
        "state 0 initial",
        "communication Main.c with Main.p -> 1",
        "external visible Main.a -> 0",
        "state 1",
        "external visible Main.b -> 0",
    ]
    assert not system.abstractions


def test_ready_guard_of_a_parallel_is_left_open() -> None:
    system = system_of(READY.replace("BODY", "c ? x || b ! 1"))
    (abstraction,) = system.abstractions
    assert abstraction.what == "a ready guard is taken before its communication, which another process might make"
    assert component(system, "Main.2").edges[0][0][0] == INTERNAL


def test_sample_may_be_missed_after_another_guard_was_taken() -> None:
    text = main(
        "var x : double = 0 var n : int = 0",
        "(mu (y ? x -> u ! 1 [] a ? n -> wait 3 ms) ) catch Timeout -> u ! 0",
        "in y : double @ 1 ms in a : int out u : int",
    )
    system = system_of(text)
    first, *others = component(system, "Main").edges
    kinds = [sorted(system.events[event].kind for event, _ in edges) for edges in (first, *others)]
    assert kinds[0] == ["external", "sample"]
    assert ["external", "miss", "sample"] in kinds
    assert all("sample" not in kind or "miss" in kind for kind in kinds[1:])


def test_reader_of_a_value_that_nobody_writes_waits() -> None:
    text = (
        "process P { out c : bool composition { if 1 > 2 then c ! true else stop } }\n"
        "process Q { in c : bool out d : int communication { var x : bool }"
        " composition { c ? x ; if x then d ! 1 else d ! 2 } }\n"
        + main("p : P q : Q p.c -> q.c q.d -> d", "p || q", "out d : int")
    )
    system = system_of(text)
    ((event, _),) = component(system, "Main.q").edges[0]
    assert [system.components[party].name for party in system.events[event].parties] == ["Main.q", "nobody"]


def test_the_guard_of_an_interrupt_is_checked_where_the_body_begins_another() -> None:
    text = main(
        "var x : int var n : int = 0",
        "((n := 1 interrupt after 1 ms -> skip) interrupt a ? x -> b ! 1)",
        "in a : int out b : int",
    )
    system = system_of(text)
    begins = component(system, "Main").edges[0]
    assert sorted("internal" if event == INTERNAL else str(system.events[event]) for event, _ in begins) == [
        "Main.a",
        "internal",
    ]


def test_body_that_was_abandoned_in_vain_waits_for_its_guard() -> None:
    text = (
        "process Alarm { out ring : int composition { ring ! 1 } }\n"
        "process Work { in ring : int out done : int communication { var x : int }"
        " composition { (done ! 1) interrupt ring ? x -> skip } }\n"
        + main(
            "alarm : Alarm work[2] : Work alarm.ring -> any -> work[0].ring, work[1].ring"
            " work[0].done, work[1].done -> any -> done",
            "alarm || work[0] || work[1]",
            "out done : int",
        )
    )
    system = system_of(text)
    assert listing(system, "Main.work[0]").splitlines()[:6] == [
        "state 0 initial",
        "external visible Main.done.1 -> 1",
        "communication Main.alarm.ring with Main.alarm -> 1",
        "ready Main.alarm.ring with Main.alarm -> 2",
        "state 1 terminal",
        "end Main: parallel end with Main, Main.alarm, Main.work[1] -> 3",
    ]
    assert "communication Main.alarm.ring with Main.alarm -> 1" in listing(system, "Main.work[0]").split("state 2")[1]
    ready = [number for number, event in enumerate(system.events) if event.kind == "ready"]
    assert [edge for edge in component(system, "Main.alarm").edges[0] if edge[0] in ready] == [
        (ready[0], 0),
        (ready[1], 0),
    ]


def interrupted(partner: str) -> str:
    """Work that is interrupted by a partner of some form."""
    return (
        "exception Enough\n"
        f"process Partner {{ out ring : int composition {{ {partner} }} }}\n"
        "process Work { in ring : int out done : int communication { var x : int }"
        " composition { (mu (done ! 1 ; wait 1 ms)) interrupt ring ? x -> skip } }\n"
    )


@pytest.mark.parametrize(
    ("partner", "in_vain"),
    [("ring ! 1", False), ("(ring ! 1 -> skip [] after 1 ms -> skip)", True), ("(ring ! 1 -> skip)", False)],
)
def test_body_is_abandoned_in_vain_where_the_offer_may_be_withdrawn(partner: str, in_vain: bool) -> None:
    text = interrupted(partner) + main(
        "partner : Partner work : Work partner.ring -> work.ring work.done -> done", "partner || work", "out done : int"
    )
    system = system_of(text)
    assert any(event.kind == "ready" for event in system.events) == in_vain
    assert ("ready Main.partner.ring" in listing(system, "Main.work")) == in_vain
    assert len(component(system, "Main.work").edges) == (5 if in_vain else 4)


def test_offer_of_a_process_that_is_cancelled_is_withdrawn() -> None:
    text = interrupted("(ring ! 1 || raise Enough) catch Enough -> skip") + main(
        "partner : Partner work : Work partner.ring -> work.ring work.done -> done", "partner || work", "out done : int"
    )
    assert "ready Main.partner.ring" in listing(system_of(text), "Main.work")


def test_a_withdrawn_value_of_a_broadcast_was_seen() -> None:
    both = (
        "partner : Partner work : Work more : Work partner.ring -> broadcast -> work.ring, more.ring"
        " work.done, more.done -> any -> done"
    )
    seen = interrupted("(ring ! 1 || raise Enough) catch Enough -> skip")
    system = system_of(seen + main(both, "partner || work || more", "out done : int"))
    latch = component(system, "Main.partner.ring to Main.work")
    ready = {number for number, event in enumerate(system.events) if event.kind == "ready"}
    assert [sorted(target for event, target in edges if event in ready) for edges in latch.edges] == [[], [1]]
    kept = system_of(interrupted("ring ! 1") + main(both, "partner || work || more", "out done : int"))
    assert not any(event.kind == "ready" for event in kept.events)


def test_output_guard_on_a_broadcast_is_seen_by_the_guard_of_an_interrupt() -> None:
    both = (
        "partner : Partner work : Work more : Work partner.ring -> broadcast -> work.ring, more.ring"
        " work.done, more.done -> any -> done"
    )
    text = interrupted("(ring ! 1 -> skip [] after 1 ms -> skip)")
    system = system_of(text + main(both, "partner || work || more", "out done : int"))
    ready = [event for event in system.events if event.kind == "ready"]
    parties = [{system.components[party].name for party in event.parties} for event in ready]
    assert parties
    assert all(names == {"Main.partner", "Main.work", "Main.more"} for names in parties)


def test_alternative_is_bound_to_a_ready_guard_that_may_be_cancelled_before_it_reads() -> None:
    reader = (
        "exception Enough\n"
        "process Writer { out c : int composition { (c ! 1 -> skip [] after 1 ms -> skip) } }\n"
        "process Reader { in c : int communication { var x : int } composition { BODY } }\n"
    )
    both = main("w : Writer r : Reader w.c -> r.c", "w || r")
    alone = system_of(reader.replace("BODY", "(c -> c ? x [] after 2 ms -> skip)") + both)
    assert not any(event.kind == "ready" for event in alone.events), "nothing comes between its guard and its reading"
    body = "((c -> c ? x [] after 2 ms -> skip) || raise Enough) catch Enough -> skip"
    system = system_of(reader.replace("BODY", body) + both)
    (bound,) = (number for number, event in enumerate(system.events) if event.kind == "ready")
    writer = component(system, "Main.w")
    (after,) = (target for event, target in writer.edges[0] if event == bound)
    assert [system.events[event].channel for event, _ in writer.edges[after]] == ["Main.w.c"]
