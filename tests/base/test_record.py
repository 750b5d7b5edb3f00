"""Records report at the call what is wrong with their fields, compare as they promise, and do not change."""

from __future__ import annotations

import copy
import pickle
import re
import subprocess
import sys
from pathlib import Path
from typing import ClassVar

import pytest

import cspdiag
from cspdiag.base.record import Slotted, field_names, is_record, kept_for_same, lazily, node, record, replaced
from cspdiag.base.span import SourceFile, Span


@record
class Port:
    name: str
    size: int = 1
    unit: str = ""


@record(kw_only=True)
class Arrow(Port):
    """Begins with the fields of ``Port``, which may be given by position."""

    uncompared: ClassVar[frozenset[str]] = frozenset({"span", "drawn"})

    kind: str = "channel"
    span: int
    drawn: bool = False


@node
class Step:
    process: str
    repeated: bool = False
    span: int


@node
class Nothing:
    pass


@record
class Corner(Slotted):
    uncompared: ClassVar[frozenset[str]] = frozenset({"drawn"})

    x: int
    y: int = 0
    drawn: bool = False


@record(kw_only=True)
class Bend(Corner):
    """Begins with the fields of ``Corner``, one of them with another default."""

    y: int = 7
    radius: float


@node
class Line(Slotted):
    start: Corner
    dashed: bool = False


def make_often():
    """Then these records have constructors of their own."""
    for k in range(200):
        assert vars(Port("u", k)) == {"name": "u", "size": k, "unit": ""}
        assert vars(Arrow("u", k, span=k, drawn=True)) == {
            "name": "u", "size": k, "unit": "", "kind": "channel", "span": k, "drawn": True,
        }  # fmt: skip
        assert vars(Step(process="p", span=k)) == {"process": "p", "repeated": False, "span": k}
        assert (Corner(k).x, Corner(k, 2).y, Corner(k, drawn=True).drawn) == (k, 2, True)
        assert [getattr(Bend(k, radius=0.5), name) for name in field_names(Bend)] == [k, 7, False, 0.5]
        assert Line(start=Corner(k)).start.x == k


@pytest.mark.parametrize("often", [False, True])
@pytest.mark.parametrize(
    ("call", "reported"),
    [
        (lambda: Port(), "missing 1 required positional argument: 'name'"),
        (lambda: Port(size=2), "missing 1 required positional argument: 'name'"),
        (lambda: Port("u", width=2), "unexpected keyword argument 'width'"),
        (lambda: Port("u", 2, "V", "W"), "takes from 2 to 4 positional arguments but 5 were given"),
        (lambda: Port("u", name="y"), "multiple values for argument 'name'"),
        (lambda: Arrow("u"), "missing 1 required keyword-only argument: 'span'"),
        (lambda: Arrow("u", spam=1, span=1), "unexpected keyword argument 'spam'"),
        (lambda: Arrow("u", 1, "V", "event", span=1), "takes from 2 to 4 positional arguments but 5"),
        (lambda: Step(process="p"), "missing 1 required keyword-only argument: 'span'"),
        (lambda: Step(process="p", span=1, again=True), "unexpected keyword argument 'again'"),
        (lambda: Step("p", span=1), "takes 1 positional argument but 2"),
        (lambda: Corner(), "missing 1 required positional argument: 'x'"),
        (lambda: Corner(1, z=2), "unexpected keyword argument 'z'"),
        (lambda: Bend(1), "missing 1 required keyword-only argument: 'radius'"),
        (lambda: Line(Corner(1)), "takes 1 positional argument but 2 were given"),
        (lambda: Line(), "missing 1 required keyword-only argument: 'start'"),
        (lambda: Nothing(1), "takes 1 positional argument but 2 were given"),
        (lambda: Nothing(name=1), "unexpected keyword argument 'name'"),
        (lambda: replaced(Port("u"), width=2), "unexpected keyword argument 'width'"),
        (lambda: replaced(Step(process="p", span=1), again=True), "unexpected keyword argument 'again'"),
    ],
)
def test_a_call_with_wrong_fields_is_refused(call, reported, often):
    if often:
        make_often()
    with pytest.raises(TypeError, match=reported):
        call()


@pytest.mark.parametrize("often", [False, True])
def test_the_refusal_names_the_record(often):
    if often:
        make_often()
    with pytest.raises(TypeError, match=r"^Port\.__init__\(\) got an unexpected keyword argument 'width'$"):
        Port("u", width=2)


def test_fields_left_out_have_their_defaults():
    arrow = Arrow("u", span=7)
    assert (arrow.name, arrow.size, arrow.unit, arrow.kind, arrow.span, arrow.drawn) == (
        "u",
        1,
        "",
        "channel",
        7,
        False,
    )


def test_a_record_that_is_made_often_has_a_constructor_of_its_own():
    make_often()
    assert "__dict__" in Arrow.__init__.__code__.co_names
    assert "_keep" not in Arrow.__init__.__code__.co_names


def test_fields_may_be_given_by_name_in_any_order():
    assert Arrow(span=7, kind="event", unit="V", name="u", size=2) == Arrow("u", 2, "V", kind="event", span=7)


def test_a_record_whose_fields_cannot_be_distinguished_by_position_is_refused_where_it_is_defined():
    with pytest.raises(TypeError, match="Later has fields without a default after fields with one"):

        @record
        class Later(Port):
            limit: int


def test_records_compare_and_hash_by_value():
    assert Port("u", 2) == Port("u", 2)
    assert hash(Port("u", 2)) == hash(Port("u", 2))
    assert Port("u", 2) != Port("u", 3)
    assert len({Port("u"), Port("u"), Port("y")}) == 2


def test_the_place_of_a_record_is_not_part_of_its_value():
    assert Arrow("u", span=1) == Arrow("u", span=2, drawn=True)
    assert hash(Arrow("u", span=1)) == hash(Arrow("u", span=2, drawn=True))


def test_records_of_different_classes_differ():
    @record
    class Socket(Port):
        pass

    assert Port("u") != Socket("u")
    assert Port("u") != ("u", 1, "")


def test_nodes_compare_and_hash_by_identity():
    one, other = Step(process="p", span=1), Step(process="p", span=1)
    assert one == one
    assert one != other
    assert len({one, other}) == 2


@pytest.mark.parametrize("item", [Port("u"), Step(process="p", span=1), Bend("u", radius=1)])
def test_fields_cannot_be_changed(item):
    first = field_names(item)[0]
    with pytest.raises(AttributeError, match=f"{first} cannot be set: records do not change"):
        setattr(item, first, "other")
    with pytest.raises(AttributeError, match=f"{first} cannot be deleted: records do not change"):
        delattr(item, first)
    assert getattr(item, first) in ("u", "p")


def test_a_replaced_record_keeps_the_other_fields_and_forgets_the_hash():
    arrow = Arrow("u", 2, "V", kind="event", span=3)
    hash(arrow)
    changed = replaced(arrow, size=4)
    assert type(changed) is Arrow
    assert changed == Arrow("u", 4, "V", kind="event", span=3)
    assert changed.span == 3
    assert hash(changed) == hash(Arrow("u", 4, "V", kind="event", span=3))


def test_a_record_is_shown_as_it_would_be_written_without_its_place():
    assert repr(Arrow("u", span=1)) == "Arrow(name='u', size=1, unit='', kind='channel', drawn=False)"
    assert repr(Step(process="p", span=1)) == "Step(process='p', repeated=False)"


def test_fields_are_listed_in_their_order():
    assert field_names(Arrow("u", span=1)) == ("name", "size", "unit", "kind", "span", "drawn")
    assert is_record(Port("u"))
    assert is_record(Nothing())
    assert not is_record("u")


def test_fields_given_by_position_match_by_position():
    match Arrow("u", 2, span=1):
        case Arrow(name, size, unit):
            assert (name, size, unit) == ("u", 2, "")
    assert Step.__match_args__ == ()


def test_copies_equal_what_they_are_copies_of():
    port = Port("u", 2)
    hash(port)
    assert copy.copy(port) == copy.deepcopy(port) == pickle.loads(pickle.dumps(port)) == port


def test_another_process_does_not_inherit_a_hash():
    port = Port("u", 2)
    hash(port)
    assert vars(pickle.loads(pickle.dumps(port))) == {"name": "u", "size": 2, "unit": ""}


@pytest.mark.parametrize("item", [Corner(1), Bend(1, radius=0.5, drawn=True), Line(start=Corner(2))])
def test_a_slotted_record_has_no_dictionary_and_is_copied_whole(item):
    assert not hasattr(item, "__dict__")
    for copied in (copy.copy(item), copy.deepcopy(item), pickle.loads(pickle.dumps(item)), replaced(item)):
        assert type(copied) is type(item)
        assert [getattr(copied, name) for name in field_names(item)] == [
            getattr(item, name) for name in field_names(item)
        ]
        with pytest.raises(AttributeError, match="records do not change"):
            copied.x = 3


def test_slotted_records_compare_and_hash_as_others_do():
    assert Corner(1) == Corner(1, drawn=True) != Corner(2)
    assert len({Corner(1), Corner(1, 0), Bend(1, 0, radius=0.5)}) == 2
    one, other = Line(start=Corner(1)), Line(start=Corner(1))
    assert one != other
    assert len({one, other}) == 2
    match Corner(1, 2):
        case Corner(x, y):
            assert (x, y) == (1, 2)


def test_a_type_checker_sees_wrong_fields(tmp_path: Path):
    (tmp_path / "calls.py").write_text(
        """
from __future__ import annotations
from cspdiag.base.record import node, record

@record
class Port:
    name: str
    size: int = 1

@record(kw_only=True)
class Arrow(Port):
    kind: str = ""
    span: int

@node
class Step:
    process: str

Port("u", 2)
Arrow("u", span=1)
Step(process="p")
Port()
Port("u", width=2)
Port("u", 2, 3)
Port("u", name="y")
Port("u", "2")
Arrow("u")
Step("p")
Port("u").name = "y"
"""
    )
    command = [sys.executable, "-m", "mypy", "--no-error-summary", "--follow-imports=silent", "--cache-dir"]
    run = subprocess.run(
        [*command, str(tmp_path), "calls.py"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    lines = [int(line.split(":")[1]) for line in run.stdout.splitlines() if ": error:" in line]
    assert lines == list(range(22, 30)), run.stdout + run.stderr


def test_the_place_is_part_of_the_value_where_the_record_says_so():
    @record
    class Stop:
        span: int

        uncompared: ClassVar[frozenset[str]] = frozenset()

    assert Stop(1) != Stop(2)
    assert len({Stop(1), Stop(1), Stop(2)}) == 2


def test_records_without_fields_are_equal():
    @record
    class Skip:
        pass

    @record
    class Stop:
        pass

    assert Skip() == Skip()
    assert Skip() != Stop()
    assert len({Skip(), Skip(), Stop()}) == 2


def test_records_with_an_order_are_sorted_by_their_fields():
    @record(order=True)
    class Range:
        low: int
        high: int

    assert sorted([Range(2, 3), Range(1, 9), Range(1, 2)]) == [Range(1, 2), Range(1, 9), Range(2, 3)]
    with pytest.raises(TypeError, match="not supported"):
        sorted([Range(1, 2), 3])


def test_records_may_compare_by_identity_and_be_given_by_position():
    @record(eq=False)
    class Jump:
        target: int

    assert Jump(1) != Jump(1)
    assert Jump(1).target == 1


def test_fields_that_follow_from_others_are_completed_and_checked():
    @record
    class Task:
        work: int
        step: int = -1

        def __post_init__(self) -> None:
            if self.work < 0:
                raise ValueError("negative")
            if self.step < 0:
                object.__setattr__(self, "step", self.work)

    for work in range(200):
        assert Task(work).step == work
    assert Task(3) == Task(3, 3)
    assert replaced(Task(3), work=5) == Task(5, 3)
    with pytest.raises(ValueError, match="negative"):
        Task(-1)


def test_what_is_computed_lazily_is_computed_once_and_not_copied_with_changes():
    computed = []

    @record
    class Square:
        side: int

        @lazily
        def area(self) -> int:
            """The area."""
            computed.append(self.side)
            return self.side**2

    square = Square(3)
    assert computed == []
    assert (square.area, square.area, computed) == (9, 9, [3])
    assert square == Square(3)
    assert replaced(square, side=4).area == 16
    assert Square.area.__doc__ == "The area."


def declared(pattern: str) -> set[tuple[str, str]]:
    """The places in the package that match, except in the runtime, which stands alone, and in the given file."""
    package = Path(cspdiag.__file__).parent
    return {
        (name, path.relative_to(package).as_posix())
        for path in package.rglob("*.py")
        if path.relative_to(package).parts[0] != "runtime"
        for name in re.findall(pattern, path.read_text(encoding="utf-8"), re.MULTILINE)
    }


def test_plain_data_is_a_record_everywhere_but_in_the_runtime_which_stands_alone():
    """A class that collects temporaries while it prints is not plain data."""
    assert {path for _, path in declared(r"^@dataclass\(.*frozen=True")} == {
        "codegen/c/text/evaluation.py",
        "codegen/python/fast/expressions.py",
        "codegen/python/plain/expressions.py",
    }


def test_a_tuple_with_names_has_a_reason():
    results_that_users_unpack = {"Signal", "Communication", "Activity", "ExecutionTime"}
    made_for_each_token = {"Token", "Previous"}
    kept_as_plain_tuples_in_a_file = {"Rule", "Tables"}
    hashed_or_read_in_the_inner_loop_of_a_proof = {"Configuration", "Role", "Neighbour", "Session"}
    states_and_edges_of_threads = {
        "proofs/transitions/systems/labels.py",
        "proofs/transitions/systems/references.py",
        "proofs/transitions/threads/frames.py",
    }
    traces_that_are_compared_as_tuples = {"Ending", "Execution"}
    given_to_the_runtime_which_stands_alone = {"Change"}
    sent_to_other_places_as_plain_tuples = {"Frame", "Item"}
    made_for_many_rows_of_a_network = {"Repetition", "Strand"}
    found = declared(r"^class (\w+)\(NamedTuple\)")
    assert {name for name, path in found if path not in states_and_edges_of_threads} == (
        results_that_users_unpack
        | traces_that_are_compared_as_tuples
        | given_to_the_runtime_which_stands_alone
        | sent_to_other_places_as_plain_tuples
        | made_for_many_rows_of_a_network
        | made_for_each_token
        | kept_as_plain_tuples_in_a_file
        | hashed_or_read_in_the_inner_loop_of_a_proof
    )


def test_a_span_is_like_a_record_but_has_no_dictionary():
    source = SourceFile(name="main.csp", text="skip")
    span = Span(source, 1, 3)
    assert (is_record(span), field_names(span), hasattr(span, "__dict__")) == (True, ("source", "start", "end"), False)
    assert span == Span(source=source, start=1, end=3) != Span(source, 1, 4)
    assert span != Span(SourceFile(name="main.csp", text="skip"), 1, 3)
    assert len({span, Span(source, 1, 3), replaced(span, end=4)}) == 2
    assert copy.copy(span) == span
    other = pickle.loads(pickle.dumps(span))
    assert (other.source.name, other.text) == ("main.csp", "ki")
    assert repr(span) == "Span(source=SourceFile('main.csp'), start=1, end=3)"
    with pytest.raises(AttributeError, match="records do not change"):
        span.start = 2
    with pytest.raises(AttributeError, match="records do not change"):
        del span.start
    with pytest.raises(TypeError):
        Span(source, 1)


def test_results_are_kept_for_the_same_record_not_for_an_equal_one() -> None:
    @record
    class Place:
        name: str

    asked: list[Place] = []

    @kept_for_same(2)
    def name_of(place: Place) -> str:
        asked.append(place)
        return place.name

    one, equal, third = Place("one"), Place("one"), Place("third")
    assert [name_of(place) for place in (one, equal, equal, one)] == ["one"] * 4
    assert [id(place) for place in asked] == [id(one), id(equal)]
    assert name_of(third) == "third"
    name_of(one)
    assert len(asked) == 4  # Two are kept.


def test_a_slotted_record_has_no_base_with_a_dictionary() -> None:
    class Between(Corner):
        """Not a record, so it is not made with slots."""

    with pytest.raises(TypeError, match="a base of Last is no record"):

        @record
        class Last(Between):
            z: int


def test_classes_of_slotted_records_are_compared_quickly() -> None:
    """``isinstance`` looks up ``__instancecheck__`` where the class is not one of ``type`` itself."""
    assert {type(kind) for kind in (Corner, Bend, Line)} == {type}
