"""Compares what cppcheck's addon for MISRA C:2012 finds in the kernel and in generated programs with the record of
deviations, `docs/misra.md`:

    python distribution/misra.py                 # all models at both levels, and all of the kernel
    python distribution/misra.py --quick         # JIWY at -O1, with the headers of the kernel
    python distribution/misra.py --write         # renews the counts of the record

Rules that are not in the record have no findings; a rule that is not found as often as the record says is reported too.
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

from cspdiag import pipeline
from cspdiag.base.sources import read_source

ROOT = Path(__file__).parents[1]
RECORD = ROOT / "docs" / "misra.md"
MODELS = ("buffer", "cascade", "commstime", "dining", "emergency", "jiwy", "ring", "watchdog")
_OF_A_HOST = re.compile(
    r"csp_(linear|signals|simulation|steering|stream|tuning|watch|port_(posix|simulation|board)|run|platform|leaf)"
)
"""Files that are not on a target: simulation, recordings, POSIX."""
_IN_ASSEMBLY = "csp_port_cortex_m"
_FINDING = re.compile(r"^(?P<file>[^:\n]+):(?P<line>\d+):\d+: \w+: .*\[misra-c2012-(?P<rule>\d+\.\d+)\]$", re.MULTILINE)


_ROW = re.compile(r"^\| (?P<rule>\d+\.\d+) \| (?P<count>\d+) \|", re.MULTILINE)


def deviations() -> dict[str, int]:
    """The rules of the record, and how often it says that each is found."""
    return {row["rule"]: int(row["count"]) for row in _ROW.finditer(RECORD.read_text(encoding="utf-8"))}


def write(counts: Mapping[str, int]) -> None:
    """Writes into the record how often each of its rules is found."""
    text = RECORD.read_text(encoding="utf-8")
    RECORD.write_text(_ROW.sub(lambda row: f"| {row['rule']} | {counts.get(row['rule'], 0)} |", text), encoding="utf-8")


def package(model: str, level: int, folder: Path) -> Path:
    """The generated package of a model, in a folder of its own."""
    network = pipeline.build(read_source(str(ROOT / "models" / model / f"{model}.csp")), read_source).network
    assert network is not None
    for path, text in pipeline.generate(network, read_source, "c", level).items():
        file = folder / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
    return folder


def sources_of(folder: Path, *, kernel: bool) -> list[Path]:
    """What runs on a target: the program, and the ``kernel`` of the package."""
    program = [file for file in sorted(folder.glob("*.c")) if not re.search("main_|_environment", file.name)]
    support = sorted((folder / "support").glob("*.c")) if kernel else []
    return program + [
        file for file in support if not _OF_A_HOST.match(file.name) and not file.name.startswith(_IN_ASSEMBLY)
    ]


def findings(folder: Path, sources: list[Path]) -> set[tuple[str, str, str]]:
    """Rule, file and line of what is found in these sources and in the headers that they include."""
    command = ["cppcheck", "--quiet", "--std=c99", "--addon=misra", "--platform=unix32", "-DCSP_TRACE=0"]
    command += [f"-I{folder}", f"-I{folder / 'support'}", *map(str, sources)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return {
        (found["rule"], str(Path(found["file"]).relative_to(folder)), found["line"])
        for found in _FINDING.finditer(done.stderr)
    }


def main(arguments: list[str]) -> int:
    """Prints the number of findings of each rule; 1 if the record does not say the same."""
    quick = "--quick" in arguments
    programs = [("jiwy", 1)] if quick else [(model, level) for model in MODELS for level in (0, 1)]
    found: set[tuple[str, str, str, str]] = set()
    with TemporaryDirectory() as name:
        for model, level in programs:
            folder = package(model, level, Path(name) / f"{model}-O{level}")
            sources = sources_of(folder, kernel=not quick and (model, level) == ("jiwy", 0))
            found |= {
                (rule, "" if file.startswith("support/") else f"{model} -O{level}: ", file, line)
                for rule, file, line in findings(folder, sources)
            }
    counts = Counter(rule for rule, *_ in found)
    allowed = deviations()
    for rule, count in sorted(counts.items(), key=lambda entry: [int(part) for part in entry[0].split(".")]):
        print(f"{rule:>6} {count:5}  {'' if rule in allowed else 'not in docs/misra.md'}")
        if rule not in allowed:
            places = sorted(f"{program}{file}:{line}" for one, program, file, line in found if one == rule)
            print("\n".join(f"           {place}" for place in places[:20]))
    if "--write" in arguments:
        write(counts)
        allowed = deviations()
    others = {} if quick else {rule: count for rule, count in allowed.items() if count == 0 or count != counts[rule]}
    for rule, count in others.items():
        print(f"docs/misra.md says {count} of {rule}, and {counts[rule]} are found: see `--write`")
    return 1 if others or counts.keys() - allowed.keys() else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
