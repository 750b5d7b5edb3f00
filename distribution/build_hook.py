"""Puts what ``third_party`` fetches into wheels; if it cannot be fetched, the wheel cannot draw, and the
build says so.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

sys.path.insert(0, str(Path(__file__).resolve().parent))
import third_party


class ThirdParty(BuildHookInterface):  # type: ignore[type-arg]
    """Runs before a distribution is built; also fetches for a checkout that is installed as editable."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Fetch, and add the folder to what a wheel includes."""
        try:
            third_party.fetch()
        except (third_party.FetchError, OSError) as problem:
            self.app.display_warning(f"cspdiag draw will not work: {problem}")
            return
        if self.target_name == "wheel" and version != "editable":
            build_data["force_include"][str(third_party.FOLDER)] = "cspdiag/_resources/third-party"
