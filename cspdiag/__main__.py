"""``python -m cspdiag``."""

from __future__ import annotations

import sys

from cspdiag.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
