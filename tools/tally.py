# SPDX-License-Identifier: GPL-3.0-or-later
"""Adds up what the GoogleTest programs wrote to BUILD/test-results: `tally.py BUILD` prints 'N passed, N failed'."""

import json
import sys
from pathlib import Path


def tally(build: Path) -> tuple[int, int]:
    passed = failed = 0
    reported = set()
    for path in (build / "test-results").glob("*.json"):
        report = json.loads(path.read_text())
        bad = report["failures"] + report.get("errors", 0)
        passed += report["tests"] - report.get("disabled", 0) - bad
        failed += bad
        reported.add(path.stem.removeprefix("test_"))
    # A program that crashed wrote no report; CTest remembers it, as "NUMBER:NAME".
    failures = build / "Testing" / "Temporary" / "LastTestsFailed.log"
    if failures.exists():
        names = [line.split(":", 1)[-1] for line in failures.read_text().split()]
        failed += len([name for name in names if name not in reported])
    return passed, failed


if __name__ == "__main__":
    passed, failed = tally(Path(sys.argv[1]))
    print(f"{passed} passed, {failed} failed")
    sys.exit(1 if failed else 0)
