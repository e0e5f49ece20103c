# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the unittest files of one folder: `run.py FOLDER [PATTERN]` takes the tests whose name contains PATTERN.
Closes with 'N passed, N failed'."""

import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def main(folder: Path, pattern: str | None) -> int:
    sys.dont_write_bytecode = True
    sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "addon"), str(ROOT)]
    loader = unittest.TestLoader()
    if pattern:
        loader.testNamePatterns = [f"*{pattern}*"]
    tests = loader.discover(str(folder), pattern="test_*.py", top_level_dir=str(folder))
    result = unittest.TextTestRunner(verbosity=2, stream=sys.stdout).run(tests)
    failed = len(result.failures) + len(result.errors) + len(result.unexpectedSuccesses)
    print(f"{result.testsRun - failed} passed, {failed} failed")
    return 0 if result.wasSuccessful() and result.testsRun else 1


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve(), sys.argv[2] if len(sys.argv) > 2 else None))
