from __future__ import annotations

import json
from xml.etree import ElementTree

from cspdiag.base import Label
from cspdiag.base.manual import manual_page
from cspdiag.base.render import concise as concise
from cspdiag.base.render import github as github
from cspdiag.base.render import json as json_format
from cspdiag.base.render import junit as junit
from cspdiag.base.render import sarif as sarif
from tests.base.render.samples import Sample, SampleWarning, at, source

ARM = source("process Arm {\n  in  angle : double\n}\n", "my arm.csp")
ERROR = Sample(at(ARM, "angle"), "ends differ", "here", "use 100%, or:\nless", (Label(at(ARM, "Arm"), "of this"),))
WARNING = SampleWarning(at(ARM, "in"), "odd")


def test_concise_has_a_line_for_each() -> None:
    assert concise.render([ERROR, WARNING]) == (
        "my arm.csp:2:7: error[E0316] ends differ\nmy arm.csp:2:3: warning[W0512] odd\n"
    )


def test_json_has_the_documented_keys() -> None:
    assert json.loads(json_format.render([])) == []
    assert json.loads(json_format.render([ERROR])) == [
        {
            "code": "E0316",
            "severity": "error",
            "message": "ends differ",
            "file": "my arm.csp",
            "line": 2,
            "column": 7,
            "end_line": 2,
            "end_column": 12,
            "help": "use 100%, or:\nless",
            "related": [{"message": "of this", "file": "my arm.csp", "line": 1, "column": 9}],
            "edits": [],
        }
    ]


def test_github_escapes_what_its_commands_need() -> None:
    assert github.render([ERROR]) == (
        "::error file=my arm.csp,line=2,endLine=2,col=7,endColumn=12,title=E0316%3A ends differ"
        "::ends differ%0Ahelp: use 100%25, or:%0Aless\n"
    )
    assert github.render([WARNING]).startswith("::warning ")


def test_sarif_results_refer_to_their_rules() -> None:
    document = json.loads(sarif.render([WARNING, ERROR]))
    assert document["version"] == "2.1.0"
    (run,) = document["runs"]
    rules = run["tool"]["driver"]["rules"]
    assert [rule["id"] for rule in rules] == ["E0316", "W0512"]
    assert rules[0]["fullDescription"]["text"] == "The two ends of a communication have different types or units."
    page = manual_page("E0316")
    assert rules[0]["help"] == {"text": page.text, "markdown": page.markdown}
    assert rules[1]["defaultConfiguration"]["level"] == "warning"
    for result in run["results"]:
        assert rules[result["ruleIndex"]]["id"] == result["ruleId"]
    error = run["results"][1]
    place = error["locations"][0]["physicalLocation"]
    assert place["artifactLocation"]["uri"] == "my%20arm.csp"
    assert place["region"] == {"startLine": 2, "startColumn": 7, "endLine": 2, "endColumn": 12}
    assert error["relatedLocations"][0]["message"] == {"text": "of this"}


def test_sarif_of_a_clean_program_has_a_run_without_results() -> None:
    (run,) = json.loads(sarif.render([]))["runs"]
    assert run["results"] == []
    assert run["tool"]["driver"]["name"] == "cspdiag"


def test_sarif_names_files_outside_by_uri() -> None:
    file = source("x", "/models/arm 2.csp")
    (run,) = json.loads(sarif.render([Sample(at(file, "x"), "e")]))["runs"]
    place = run["results"][0]["locations"][0]["physicalLocation"]
    assert place["artifactLocation"]["uri"] == "file:///models/arm%202.csp"


def test_junit_has_a_suite_for_each_file_and_a_failure_for_each_error() -> None:
    root = ElementTree.fromstring(junit.render([ERROR, WARNING], ["my arm.csp", "clean.csp"]))
    suites = {suite.get("name"): suite for suite in root}
    assert suites["my arm.csp"].get("tests") == "2"
    assert suites["my arm.csp"].get("failures") == "1"
    failure = suites["my arm.csp"].find("testcase/failure")
    assert failure is not None
    assert failure.get("message") == "ends differ"
    assert suites["clean.csp"].get("failures") == "0"
    assert len(suites["clean.csp"].findall("testcase")) == 1


def test_junit_is_well_formed_whatever_the_source_says() -> None:
    file = source("x \x01 <&>\n", "a\x02<&>.csp")
    root = ElementTree.fromstring(junit.render([Sample(at(file, "x"), "\x03 <&> ]]>", "", "\x04")], ["b.csp"]))
    assert root.tag == "testsuites"
