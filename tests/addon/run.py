# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the add-on's tests inside Blender: blender --background --factory-startup --python tests/addon/run.py -- [PATTERN]

PATTERN is a part of the tests' names, as for `python -m unittest -k`. The exit code is 1 if a test failed.
"""

import os
import sys
import time
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "addon")]


def main() -> int:
    patterns = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    import addon_utils

    if addon_utils.enable("wardmis", default_set=True, handle_error=report) is None:
        return 1
    loader = unittest.TestLoader()
    loader.testNamePatterns = [p if "*" in p else f"*{p}*" for p in patterns] or None
    suite = loader.discover(str(HERE), top_level_dir=str(HERE))
    start = time.monotonic()
    result = unittest.TextTestRunner(stream=sys.stdout, verbosity=2).run(suite)
    failed = len(result.failures) + len(result.errors)
    print(f"{result.testsRun - failed} passed, {failed} failed, in {time.monotonic() - start:.0f} s")
    if result.testsRun == 0:
        print(f"no test matches {patterns}")
    return 1 if failed or result.testsRun == 0 else 0


def report(_error: Exception) -> None:
    import traceback

    traceback.print_exc()


# neither an exception nor sys.exit() in a --python script reliably sets Blender's exit code
code = 1
try:
    code = main()
finally:
    sys.stdout.flush()
    os._exit(code)
