from __future__ import annotations

import pytest

from cspdiag.base.manual import manual_pages, reference
from tests.cli.conftest import Command


def test_a_page_shows_both_programs(cspdiag: Command) -> None:
    result = cspdiag("explain", "E0101")
    assert (result.code, result.err) == (0, "")
    page = manual_pages()["E0101"]
    assert result.out == page.text
    assert "Refused:\n\n    " in result.out
    assert "Fixed:\n\n    " in result.out


def test_a_warning_refuses_nothing(cspdiag: Command) -> None:
    page = cspdiag("explain", "W0690").out
    assert "Warned about:\n\n    " in page
    assert "Refused" not in page


def test_small_letters_are_accepted(cspdiag: Command) -> None:
    assert cspdiag("explain", "e0101") == cspdiag("explain", "E0101")


@pytest.mark.parametrize("code", ["e312", "312", "0312", "E312", "w0312"])
def test_the_number_is_enough(cspdiag: Command, code: str) -> None:
    assert cspdiag("explain", code) == cspdiag("explain", "E0312")


def test_an_unknown_number_is_refused(cspdiag: Command) -> None:
    for code in ("9999", "0", "E", ""):
        assert cspdiag("explain", code).code == 2
    assert len({code[1:] for code in manual_pages()}) == len(manual_pages())


def test_without_a_code_all_are_listed(cspdiag: Command) -> None:
    lines = cspdiag("explain").out.splitlines()
    assert [line.split()[0] for line in lines] == sorted(manual_pages())


def test_the_reference_is_printed(cspdiag: Command) -> None:
    assert cspdiag("explain", "--markdown").out == reference()


def test_a_near_code_is_suggested(cspdiag: Command) -> None:
    result = cspdiag("explain", "E01O1")
    assert result.code == 2
    assert "did you mean E01" in result.err
