"""``cspdiag bench``, ``make bench`` or ``python benchmarks``: measures, prints a table, and writes a JSON file on
request.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from measuring import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
