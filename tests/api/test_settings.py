"""What ``--set`` and ``set=`` change, and what they refuse."""

from __future__ import annotations

from pathlib import Path

import pytest

import cspdiag
from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.cli.main import main
from cspdiag.network.dump.network import dump
from cspdiag.settings import SettingError, split_settings

PROGRAM = """
const Ts = 1 ms
const base = 2.0

struct Gains {
  kp: double
  ki: double<1/s>
}

struct Plant {
  gains: Gains
  on: bool
}

const panGains = Gains(kp = base, ki = 1<1/s>)
const plantful = Plant(gains = Gains(kp = 1.0, ki = 2<1/s>), on = true)
const table : double[3] = [1.0, 2.0, 3.0]

submodel Filter(tau: time = 5 ms) {
  in x : double
  out y : double
  y = lag(x, tau)
}

submodel Law(kp: double = 20, g: Gains = panGains) {
  in  x : double
  out y : double
  f[2] : Filter
  f[0].x = x
  f[1].x = f[0].y
  y = kp * f[1].y * g.kp + table[1] + plantful.gains.kp
}

process Follow(T: time) {
  in  x : double @ T
  out y : double @ T
  communication {
    law : Law
    x -> law.x
    law.y -> y
  }
  composition { mu law }
}

process Cell(id: int) {
  out o : int
  composition { o ! id }
}

process Main(T: time) {
  in  x : double @ T
  out y : double @ T
  communication {
    follow : Follow(T)
    cell[i < 3] : Cell(id = i)
    for i < 2 { deep[j < 2] : Cell(id = i + j)
      deep[0].o -> _
      deep[1].o -> _
      }
    x -> follow.x
    follow.y -> y
    cell[0].o -> _
    cell[1].o -> _
    cell[2].o -> _
  }
  composition { follow || (par i < 3 : cell[i]) || (par i < 2 : deep[i][0]) || (par i < 2 : deep[i][1]) }
}

submodel Source(a: double = 1) { out y : double
  y = a * sin(time / 1<s>) }
submodel Sink(k: double = 1) { in u : double
  state s: double = 0
  next s = k * u
 }

environment Bench for Main(Ts) {
  source[i < 2] : Source
  sink : Sink
  source[0].y -> x
  y -> sink.u
}
environment Other for Main(Ts) {
  lamp : Source
  sink : Sink
  lamp.y -> x
  y -> sink.u
}
"""


def network(settings: dict[str, str], *, alone: bool = True) -> str:
    built = pipeline.build(SourceFile(name="set.csp", text=PROGRAM), read_source, settings=settings, alone=alone)
    assert built.network is not None
    instances = "\n".join(f"{instance.path} {instance.arguments}" for instance in built.network.instances)
    return f"{dump(built.network)}\n{instances}"


@pytest.fixture(scope="module")
def plain() -> str:
    return network({})


@pytest.mark.parametrize(
    "setting",
    [
        "Ts=2ms",
        "T=2ms",
        "base=3",
        "follow.law.kp=30",
        "cell[2].id=7",
        "cell[02].id=7",
        "deep[1][1].id=5",
        "follow.law.f[1].tau=3ms",
        "source[0].a=2",
        "sink.k=2",
        "panGains.kp=3",
        "plantful.gains.kp=7",
        "table[1]=5",
        "table=[1,9,3]",
        "Main.T=2ms",
        "Main.follow.law.kp=30",
        "Bench.sink.k=2",
        "const.Ts=2ms",
        "const.panGains.kp=3",
        "const.table[1]=5",
    ],
)
def test_what_can_be_set_is_changed(setting: str, plain: str) -> None:
    assert network(split_settings([setting])) != plain


@pytest.mark.parametrize(
    ("setting", "reason"),
    [
        ("Ts=3", "write it with a unit, such as 10ms"),
        ("law.kp=30", "did you mean 'follow.law.kp'?"),
        ("kp=30", "did you mean 'follow.law.kp'?"),
        ("follow.lw.kp=3", "did you mean 'follow.law.kp'?"),
        ("follow.law.kq=3", "did you mean 'follow.law.kp'?"),
        ("Mian.follow.law.kp=3", "did you mean 'follow.law.kp'?"),
        ("Bunch.sink.k=2", "did you mean 'sink.k'?"),
        ("const.follow.law.kp=3", "the constants are Ts, base"),
        ("const.bsae=3", "did you mean 'base'?"),
        ("const.Tz=1ms", "the constants are Ts, base"),
        ("follow.law.x=3", "`x` is an in port of `follow.law`; parameters there: follow.law.kp, follow.law.g"),
        ("follow.law=3", "`follow.law` is an instance of `Law`; parameters there: follow.law.kp, follow.law.g"),
        ("follow=3", "`follow` is an instance of `Follow`; parameters there: follow.T"),
        ("x=3", "`x` is an in port; parameters there: T"),
        ("cell=2", "`cell` is an array of instances of `Cell`; parameters there: cell[0].id"),
        ("Main.cell=2", "`cell` is an array of instances of `Cell`; parameters there: cell[0].id"),
        ("cell[1]=2", "`cell[1]` is an instance of `Cell`; parameters there: cell[1].id"),
        ("cell[1][0]=2", "`cell` is an array of instances of `Cell`; parameters there: cell[0].id"),
        ("deep[1]=2", "`deep` is an array of instances of `Cell`; parameters there: deep[0][0].id"),
        ("follow[0]=2", "`follow` is an instance of `Follow`; parameters there: follow.T"),
        ("cell.o=2", "`o` is an out port of `cell[0]`; parameters there: cell[0].id"),
        ("cell.xyzzy=2", "cell has the parameters id"),
        ("follow[0].law.f.tau=3ms", "'follow.law.f[0].tau'"),
        ("sink.s=3", "`s` is a state of `sink`; parameters there: sink.k"),
        ("cell[99].id=7", "`cell` has cell[0] to cell[2]"),
        ("cell[xyz].id=7", "'cell[0].id'"),
        ("cell.id=7", "'cell[0].id'"),
        ("deep[1].id=5", "2 indexes: 'deep[0][0].id'"),
        ("deep[1][4].id=5", "`deep` has deep[0][0] to deep[1][1]"),
        ("follow[0].law.kp=3", "'follow.law.kp'"),
        ("follow.law.f.tau=3ms", "'follow.law.f[0].tau'"),
        ("follow.law.f[2].tau=3ms", "follow.law.f[0] to follow.law.f[1]"),
        ("f[1].tau=3ms", "did you mean 'follow.law.f[1].tau'?"),
        ("source[5].a=2", "(`source` has source[0] to source[1])"),
        ("Bench.source[5].a=2", "(`Bench.source` has source[0] to source[1])"),
        ("Main.cell[99].id=7", "(`Main.cell` has cell[0] to cell[2])"),
        ("lamp.a=2", "`Other` has it"),
        ("panGains.kq=3", "Gains has the fields kp, ki"),
        ("panGains=3", "panGains.kp, panGains.ki"),
        ("table[3]=5", "[0] to [2]"),
        ("table=[3]", "`[3]` has one element, not 3"),
        ("table.x=5", "[0] to [2]"),
        ("follow.law.g.kp=4", "set as a whole"),
        ("Main.follow.law.g.kp=4", "'g' is a parameter, and is set as a whole"),
        ("Main.T[0]=4", "'T' is a parameter, and is set as a whole"),
        ("Main.follow.law.x=3", "`x` is an in port of `follow.law`; parameters there: follow.law.kp, follow.law.g"),
        ("follow.law.g=4", "make its argument a constant"),
        ("sink.k=3<V>", "the units do not agree"),
        ("cell[1].id=2.5", "not of type int"),
        ("a..b=3", "INSTANCE.PARAMETER"),
        ("Tz=1ms", "the constants are Ts, base"),
    ],
)
def test_a_name_that_cannot_be_set_is_refused_with_a_reason(setting: str, reason: str) -> None:
    with pytest.raises(SettingError) as refused:
        network(split_settings([setting]))
    assert reason in str(refused.value)
    assert setting.partition("=")[0] in str(refused.value)


def test_fields_are_set_in_values_from_other_settings() -> None:
    """``panGains.kp`` is computed from ``base``; a setting of one of its fields has priority, and the others follow
    ``base``.
    """
    built = pipeline.build(
        SourceFile(name="set.csp", text=PROGRAM),
        read_source,
        settings={"panGains.ki": "5", "base": "3", "table[0]": "9"},
    )
    assert built.network is not None
    constants = {constant.name: constant.value for constant in built.network.constants}
    assert (constants["panGains"], constants["table"]) == ((3.0, 5.0), (9.0, 2.0, 3.0))


def test_a_package_is_for_all_its_environments(plain: str) -> None:
    assert network({"lamp.a": "2"}, alone=False) != plain


def test_nothing_is_set_twice() -> None:
    with pytest.raises(SettingError, match="Ts is set twice: to 1ms and to 2ms"):
        split_settings(["Ts=1ms", "Ts=2ms"])
    with pytest.raises(SettingError, match=r"cell\[1\].id is set twice: as cell\[1\].id and as cell\[01\].id"):
        network({"cell[1].id": "1", "cell[01].id": "2"})
    with pytest.raises(SettingError, match=r"table\[01\] is set twice: as table\[1\] and as table\[01\]"):
        network({"table[1]": "1", "table[01]": "2"})


NESTED = """
struct Row {
  on: bool
  gains: double[2]
}
const rows : Row[2] = [Row(on = true, gains = [1.0, 2.0]), Row(on = true, gains = [1.0, 2.0])]
const tab : int[2][3] = [[1, 2, 3], [4, 5, 6]]
process Main {
  out o : int @ 10 ms
  composition { o ! tab[1][0] + int(rows[0].gains[1]) }
}
"""

OVERLAPPING = [
    ("table", "[1, 2, 3]", "table[1]", "5"),
    ("const.table", "[1, 2, 3]", "table[02]", "5"),
    ("tab[1]", "[7, 8, 9]", "tab[1][0]", "100"),
    ("tab[01]", "[7, 8, 9]", "const.tab[1][0]", "100"),
    ("rows[0].gains", "[3, 4]", "rows[0].gains[1]", "5"),
]
"""A constant as a whole, and a part of it."""


@pytest.mark.parametrize("part_first", [False, True])
@pytest.mark.parametrize(("whole", "value", "part", "part_value"), OVERLAPPING)
def test_a_whole_and_a_part_of_it_are_not_both_set(
    whole: str, value: str, part: str, part_value: str, *, part_first: bool
) -> None:
    """Otherwise the setting that came last might silently undo the other."""
    given = [(whole, value), (part, part_value)]
    program = SourceFile(name="set.csp", text=PROGRAM if "table" in whole else NESTED)
    with pytest.raises(SettingError) as refused:
        pipeline.build(program, read_source, settings=dict(given[::-1] if part_first else given), alone=True)
    assert str(refused.value) == f"{part} is set twice: by itself and as a part of {whole}"


def test_separate_parts_can_both_be_set() -> None:
    settings = {
        "tab[1][0]": "100",
        "tab[1][2]": "7",
        "tab[0]": "[7, 8, 9]",
        "rows[0].gains[1]": "3",
        "rows[1].gains": "[5, 6]",
        "rows[0].on": "false",
    }
    for given in (settings, dict(reversed(settings.items()))):
        built = pipeline.build(SourceFile(name="set.csp", text=NESTED), read_source, settings=given, alone=True)
        assert built.network is not None
        constants = {constant.name: constant.value for constant in built.network.constants}
        assert constants["tab"] == ((7, 8, 9), (100, 5, 7))
        assert constants["rows"] == ((False, (1.0, 3.0)), (True, (5.0, 6.0)))


AMBIGUOUS = """
const T = 4 ms
struct Gains {
  n: int
  kp: double
}
const gains = Gains(n = 3, kp = 1.0)

submodel Law(n: int = 3) {
  in x : double
  out y : double
  y = x * double(n) * gains.kp * double(gains.n) + T / 1<s>
}
process Main(T: time = 2 ms) {
  in  x : double @ T
  out y : double @ T
  communication {
    gains : Law
    x -> gains.x
    gains.y -> y
  }
  composition { mu gains }
}
submodel Plant(n: int = 1) {
  in u : double
  out y : double
  state s : double = 0
  next s = u
  y = s * double(n)
}
environment Bench for Main {
  gains : Plant
  y -> gains.u
  gains.y -> x
}
"""
"""``T`` and ``gains.n`` are both a constant, or a part of one, and parameters."""


@pytest.mark.parametrize(
    ("name", "ways"),
    [
        ("T", ("const.T (the constant in set.csp:2)", "Main.T (the parameter in set.csp:14)")),
        (
            "gains.n",
            (
                "const.gains.n (the constant in set.csp:7)",
                "Main.gains.n (the parameter in set.csp:9)",
                "Bench.gains.n (the parameter in set.csp:24)",
            ),
        ),
    ],
)
def test_a_name_that_means_several_things_sets_none(name: str, ways: tuple[str, ...]) -> None:
    source = SourceFile(name="set.csp", text=AMBIGUOUS)

    def dumped(*settings: str) -> str:
        built = pipeline.build(source, read_source, settings=split_settings(settings), alone=True)
        assert built.network is not None
        instances = "\n".join(f"{instance.path} {instance.arguments}" for instance in built.network.instances)
        return f"{dump(built.network)}\n{instances}"

    value = "3ms" if name == "T" else "8"
    with pytest.raises(SettingError, match="means more than one thing") as refused:
        dumped(f"{name}={value}")
    assert str(refused.value).endswith(": " + ", ".join(ways))
    results = {dumped(), *(dumped(f"{way.split()[0]}={value}") for way in ways)}
    assert len(results) == 1 + len(ways), "each way sets a thing of its own"


@pytest.mark.parametrize(
    ("name", "message"),
    [
        (
            "gains.x",
            "there is no constant 'gains.x' (Gains has the fields n, kp) and no such parameter "
            "(in `Main` `x` is an in port of `gains`; parameters there: gains.n; in `Bench` `gains` has the parameters "
            "n)",
        ),
        (
            "gains[0].n",
            "there is no constant 'gains[0].n' (Gains has the fields n, kp) and no such parameter "
            "(in `Main` 'gains' is a single instance, not an array: 'gains.n'; in `Bench` 'gains' is a single "
            "instance, not an array: 'gains.n')",
        ),
        ("const.gains.x", "there is no constant 'const.gains.x' (Gains has the fields n, kp)"),
    ],
)
def test_an_unknown_name_is_explained_by_what_its_beginning_means(name: str, message: str) -> None:
    source = SourceFile(name="set.csp", text=AMBIGUOUS)
    with pytest.raises(SettingError) as refused:
        pipeline.build(source, read_source, settings={name: "1"}, alone=True)
    assert str(refused.value) == message


def test_a_parameter_is_set_once_whatever_it_is_called(plain: str) -> None:
    for two in (("T=2ms", "Main.T=3ms"), ("Main.cell[0].id=3", "cell[0].id=4"), ("const.Ts=2ms", "Ts=3ms")):
        with pytest.raises(SettingError, match="is set twice"):
            network(split_settings(two))
    assert network({"Main.T": "2ms"}) == network({"T": "2ms"}) != plain


@pytest.mark.parametrize(
    "command", [["run", "--for", "1ms"], ["compile", "-o", "out"], ["margins"], ["verify"], ["verify", "--timing"]]
)
def test_every_verb_refuses_a_path_that_leads_nowhere(
    command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("set.csp").write_text(PROGRAM)
    for path in ("law.kp", "cell[99].id", "cell.id"):
        assert main([*command, "set.csp", "--set", f"{path}=30"]) == 2
        assert f"there is no parameter {path!r}" in capsys.readouterr().err
    assert not Path("out").exists()


@pytest.mark.parametrize(
    "command", [["run", "--for", "1ms"], ["compile", "-o", "out"], ["margins"], ["verify"], ["verify", "--timing"]]
)
def test_every_verb_refuses_a_whole_and_a_part_of_it(
    command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("set.csp").write_text(PROGRAM)
    assert main([*command, "set.csp", "--set", "table[1]=5", "--set", "table=[7, 8, 9]"]) == 2
    assert "table[1] is set twice: by itself and as a part of table" in capsys.readouterr().err
    assert not Path("out").exists()


def test_python_refuses_a_whole_and_a_part_of_it(tmp_path: Path) -> None:
    (tmp_path / "set.csp").write_text(PROGRAM)
    program = cspdiag.load(tmp_path / "set.csp")
    for use in (program.run, program.build, program.margins, program.timing, program.verify):
        with pytest.raises(SettingError, match=r"table\[1\] is set twice: by itself and as a part of table"):
            use(set={"table": "[7, 8, 9]", "table[1]": 5})


def test_python_refuses_a_path_that_leads_nowhere(tmp_path: Path) -> None:
    (tmp_path / "set.csp").write_text(PROGRAM)
    program = cspdiag.load(tmp_path / "set.csp")
    for use in (program.run, program.build, program.margins, program.timing, program.verify):
        with pytest.raises(SettingError, match=r"did you mean 'follow\.law\.kp'"):
            use(set={"law.kp": 30})
        with pytest.raises(SettingError, match=r"cell\[0\] to cell\[2\]"):
            use(set={"cell[99].id": 30})


def test_an_error_shows_what_was_set(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The program has no errors without the setting, so the setting is where to look."""
    path = tmp_path / "narrow.csp"
    path.write_text("const n = 3\nconst m : int8 = int8(n * 100 - 200)\n" + PROGRAM)
    assert main(["check", str(path)]) == 0
    for command in (["run", "--for", "1ms"], ["compile", "-o", str(tmp_path / "out")], ["margins"], ["verify"]):
        assert main([*command, str(path), "--set", "n=7"]) == 1
        error = capsys.readouterr().err
        assert "error[E0902]: this is 500" in error
        assert "- set from outside: n=7" in error, command
    assert main(["run", "--for", "1ms", str(path), "--set", "follow.T=0ms", "--set", "base=2"]) == 1
    assert "set from outside: follow.T=0ms" in capsys.readouterr().err
