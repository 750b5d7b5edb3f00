"""What the site has, in the reader's order: sections, groups of pages in them, and a sentence for each page."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple


class Entry(NamedTuple):
    """A page: its file in the repository, its place on the site, what the navigation calls it, and what it is about."""

    source: str
    place: str
    name: str
    about: str


class Group(NamedTuple):
    """Pages that belong together."""

    title: str
    entries: tuple[Entry, ...]


class Section(NamedTuple):
    """A section of the site: the folder of its pages, its name, its introduction, and its groups."""

    folder: str
    name: str
    introduction: str
    groups: tuple[Group, ...]


def _docs(folder: str, *rows: tuple[str, str, str]) -> tuple[Entry, ...]:
    """Entries for pages of ``docs/``, by name."""
    return tuple(Entry(f"docs/{page}.md", f"{folder}/{page}", name, about) for page, name, about in rows)


def _models(*rows: tuple[str, str, str]) -> tuple[Entry, ...]:
    return tuple(Entry(f"models/{model}/README.md", f"gallery/{model}", name, about) for model, name, about in rows)


def _lectures(*rows: tuple[str, str, str]) -> tuple[Entry, ...]:
    return tuple(Entry(f"docs/lectures/{page}.md", f"gallery/{page}", name, about) for page, name, about in rows)


LEARN = Section(
    "learn",
    "Learn",
    "Begin here: the tutorial needs twenty minutes and no knowledge of CSP.",
    (
        Group(
            "",
            _docs(
                "learn",
                ("tutorial", "Tutorial", "From nothing to a controller with two modes."),
                ("language-in-brief", "The language in brief", "Enough to write correct programs, in 3,000 words."),
            ),
        ),
    ),
)

GUIDES = Section(
    "guides",
    "Guides",
    "How to do one thing, from nothing to the thing running.",
    (
        Group(
            "Write and review",
            _docs(
                "guides",
                ("editors", "Editors", "Diagnostics, completion and diagrams as you type, in the editor you have."),
                ("drawing", "Drawing", "Diagrams as pictures, with mistakes and differences marked in them."),
                ("review", "Review and CI", "What a change does to the diagrams: in git, in pull requests, in CI."),
                ("studio", "The studio", "Text, diagrams, runs and proofs on one page, in the browser."),
                ("animate", "Animate your plant", "A drawing of the plant that moves with the run."),
                ("assistants", "Assistants", "Assistants that check, prove, run and draw programs."),
            ),
        ),
        Group(
            "Analyse",
            _docs(
                "guides",
                ("timing", "Timing and margins", "Deadlines, latencies, and what they leave of the stability."),
                ("sweeps", "Sweeps", "A thousand runs with other values, and one table."),
                ("tuning", "Tuning", "Parameters that change while a program runs."),
                ("recordings", "Recordings", "Signals for Foxglove, PlotJuggler, ROS 2, pandas and numpy."),
            ),
        ),
        Group(
            "Run and connect",
            _docs(
                "guides",
                (
                    "devices",
                    "Devices",
                    "Gamepads, serial lines, CAN, GPIO and others, and what happens when one fails.",
                ),
                ("hosts", "Several hosts", "One program on several computers."),
                (
                    "c",
                    "C and microcontrollers",
                    "C99 without heap or operating system, with your own drivers and laws.",
                ),
                ("fmi", "FMI", "With Simulink, 20-sim, OpenModelica and others."),
                ("python", "From Python", "Runs as tables, loops for python-control, exceptions."),
                ("gymnasium", "Reinforcement learning", "The plant of a program as a Gymnasium environment."),
                ("tool-chain", "Your tool chain", "What you have already, and how cspdiag meets it."),
            ),
        ),
    ),
)

REFERENCE = Section(
    "reference",
    "Reference",
    "Exactly what everything means.",
    (
        Group(
            "The language",
            _docs(
                "reference",
                ("language", "The language", "Every construct, with a program for each; every program is compiled."),
                ("notation", "Notation", "How each composition is drawn."),
                ("semantics", "Semantics", "The meaning on a few pages, with traces that are compared."),
                ("glossary", "Glossary", "The terms, and what they are called in the code."),
            ),
        ),
        Group(
            "The tool",
            (
                Entry("", "reference/commands", "Commands", "Every verb with its options, as `--help` shows them."),
                Entry(
                    "", "reference/diagnostics/index", "Diagnostics", "A page for each: why, and how it is corrected."
                ),
                Entry("", "reference/python-api", "Python API", "Every public name, from the docstrings."),
                *_docs(
                    "reference",
                    ("runtime", "Runtime", "What generated Python runs on; it can be used by hand."),
                    ("misra", "MISRA C", "The record of deviations of generated C."),
                ),
            ),
        ),
    ),
)

EXPLANATIONS = Section(
    "explanations",
    "Explanations",
    "Why it is so, what is promised, and what is not.",
    (
        Group(
            "What it promises",
            _docs(
                "explanations",
                ("verification", "Proofs", "What is proved, how, and what is not."),
                ("benchmarks", "Benchmarks", "How fast it is, what that is compared with, and what bounds it."),
                ("scale", "Scale", "What each verb costs for 10 to 100,000 instances."),
            ),
        ),
        Group(
            "How it is built",
            _docs(
                "explanations",
                ("architecture", "Where things are", "The layers as a picture, and a walk through them."),
                ("design/README", "Design decisions", "A page for each decision: alternatives, costs, code, tests."),
                ("targets", "Adding a target", "How to add a target in a day, and how it is certified."),
                ("releasing", "Releasing", "How a release is made."),
            ),
        ),
    ),
)

GALLERY = Section(
    "gallery",
    "Gallery",
    "Programs to read, run and change. Each opens in the playground; every picture, figure and answer was made by the "
    "code when this site was built.",
    (
        Group(
            "Lectures, with questions",
            _lectures(
                (
                    "philosophers",
                    "A deadlock, and its repair",
                    "Five philosophers wait for each other; the tool says what helps.",
                ),
                (
                    "button",
                    "The stolen button",
                    "A published design in which one joint takes the press from the other.",
                ),
                (
                    "slow-loop",
                    "Timing alone breaks a loop",
                    "Gains that are stable at 2\u00a0ms, and at 10\u00a0ms swing from limit to limit.",
                ),
                ("two-rates", "Two rates", "A current loop at 10\u00a0kHz inside a speed loop at 1\u00a0kHz."),
                ("emergency-stop", "Emergency stop", "An interrupt that abandons whatever is running."),
            ),
        ),
        Group(
            "Models",
            _models(
                ("jiwy", "JIWY", "A pan-and-tilt robot with two joints, four modes each."),
                ("jiwy_mujoco", "JIWY in MuJoCo", "The same program on a machine with contacts; needs MuJoCo."),
                ("cascade", "Cascade", "Two loops at two rates."),
                ("emergency", "Spindle", "A spindle, its brake and its button."),
                ("watchdog", "Watchdog", "A time-out, exceptions, and a way back."),
                ("dining", "Dining philosophers", "Forks as processes."),
                ("buffer", "Bounded buffer", "Producers, a buffer, and a slow consumer."),
                ("ring", "Ring", "A token and an array of cells."),
                ("commstime", "Commstime", "The classic benchmark of a communication."),
            ),
        ),
    ),
)

_ROOT = Path(__file__).parents[2]
_LISTED = (LEARN, GUIDES, REFERENCE, EXPLANATIONS, GALLERY)


def _further() -> tuple[Group, ...]:
    """Pages of ``docs/`` that have no row above: guides, until someone says what they are."""
    listed = {entry.source for section in _LISTED for group in section.groups for entry in group.entries}
    found = [
        Entry(f"docs/{page.name}", f"guides/{page.stem}", _title(page), "")
        for page in sorted((_ROOT / "docs").glob("*.md"))
        if f"docs/{page.name}" not in listed | {"docs/diagnostics.md"}
    ]
    return (Group("Further pages", tuple(found)),) if found else ()


def _title(page: Path) -> str:
    return page.read_text(encoding="utf-8").partition("\n")[0].removeprefix("# ")


GUIDES = GUIDES._replace(groups=(*GUIDES.groups, *_further()))

SECTIONS = (LEARN, GUIDES, REFERENCE, EXPLANATIONS, GALLERY)

PICTURES = {
    "philosophers": "pictures/deadlock.svg",
    "button": "pictures/check.svg",
    "slow-loop": "slow.svg",
    "two-rates": "pictures/cascade.svg",
    "emergency-stop": "pictures/emergency.svg",
    "jiwy": "images/jiwy.svg",
    "jiwy_mujoco": "../models/jiwy_mujoco/frames.png",
    "cascade": "pictures/cascade.svg",
    "emergency": "pictures/emergency.svg",
    "watchdog": "pictures/watchdog.svg",
    "dining": "pictures/dining.svg",
    "buffer": "pictures/buffer.svg",
    "ring": "pictures/ring.svg",
    "commstime": "pictures/commstime.svg",
}
"""The pictures of the first page of the gallery, by page, as seen from ``docs/``, or that the page's commands make."""

RUN = ("docs/lectures/", "models/")
"""Where the pages are whose commands are run when the site is built."""

KEYWORDS = {
    "learn/tutorial": "install, installation, getting started, first program, state machine, modes",
    "learn/language-in-brief": "cheat sheet, syntax",
    "guides/timing": "gain margin, phase margin, delay margin, stability margin, sample period, deadline, Bode, "
    "jitter, real time jitter, response time, latency, schedulability, worst-case execution time, WCET",
    "guides/tuning": "gain tuning, tuning, gains",
    "guides/sweeps": "Monte Carlo, parameter study",
    "guides/studio": "browser, playground",
    "guides/review": "git, GitHub, GitLab, pull request",
    "guides/assistants": "MCP, language model",
    "guides/hosts": "distributed, several computers",
    "guides/editors": "VS Code, Vim, Neovim, Emacs, language server",
    "guides/recordings": "CSV, MCAP, Parquet, ROS 2, rosbag, PlotJuggler, Foxglove, log, logging",
    "guides/devices": "gamepad, joystick, keyboard, CAN, MQTT, OPC UA, GPIO, serial port, UDP, real time",
    "guides/c": "FreeRTOS, Zephyr, microcontroller, STM32, ARM, Cortex-M, RISC-V, embedded, bare metal, RTOS, flash, "
    "stack, real time, interrupt handler",
    "guides/fmi": "FMU, FMI, Simulink, MATLAB, 20-sim, OpenModelica, co-simulation, hybrid",
    "guides/python": "python-control, python control, numpy, pandas, notebook",
    "guides/tool-chain": "MATLAB, Simulink, Stateflow, ROS 2, ROS",
    "guides/gymnasium": "gym, reinforcement learning",
    "reference/language": "rendezvous, broadcast, buffer, float32, units, parameter, environment, import, sample time, "
    "sample period, sampling, PID, anti-windup, hybrid, plant, exception, overwrite, ||, ||>, [], []>, mu, par, "
    "pripar, seq, alt, prialt, parallel, alternative",
    "explanations/verification": "deadlock, deadlock free, livelock, counterexample, refinement, proof, model checking",
    "gallery/emergency-stop": "emergency stop, interrupt",
    "gallery/jiwy": "PID, state machine, robot, joystick",
    "gallery/watchdog": "timeout, time-out, exception",
}
"""What readers search for, by the page that should come first; the search of the site finds a page by these words, also
if the search has more words, before it finds it by its text.
"""
