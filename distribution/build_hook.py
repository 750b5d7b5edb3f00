"""Puts what ``third_party`` fetches into wheels, and the page that ``make studio`` builds; what is not there is said by
the build, and the wheel cannot draw, or has no studio.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

sys.path.insert(0, str(Path(__file__).resolve().parent))
import third_party

STUDIO = Path(__file__).resolve().parent.parent / "studio" / "build"


class ThirdParty(BuildHookInterface):  # type: ignore[type-arg]
    """Runs before a distribution is built; also fetches for a checkout that is installed as editable."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Fetch, and add the folder to what a wheel includes."""
        included = {}
        try:
            third_party.fetch()
        except (third_party.FetchError, OSError) as problem:
            self.app.display_warning(f"cspdiag draw will not work: {problem}")
        else:
            included[str(third_party.FOLDER)] = "cspdiag/_resources/third-party"
        if (STUDIO / "main.js").is_file():
            included[str(STUDIO)] = "cspdiag/_resources/studio/build"
        elif version != "editable":
            self.app.display_warning("cspdiag studio will not work: run `make studio` before building")
        if self.target_name == "wheel" and version != "editable":
            build_data["force_include"].update(included)
