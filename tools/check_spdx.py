# SPDX-License-Identifier: GPL-3.0-or-later
"""Every source file says its licence in its first line (the second, after #!)."""

import subprocess
import sys
from pathlib import Path

SOURCES = (".cpp", ".h", ".py", ".sh", ".cmake", ".toml")
NAMES = ("CMakeLists.txt", "dev", "run")
LICENCE = "SPDX-License-Identifier: GPL-3.0-or-later"


def says_licence(text: str) -> bool:
    lines = text.splitlines()[:2]
    if lines and not lines[0].startswith("#!"):
        lines = lines[:1]
    return any(LICENCE in line for line in lines)


def main() -> int:
    tracked = subprocess.run(["git", "ls-files"], check=True, capture_output=True, text=True).stdout.splitlines()
    files = [Path(name) for name in tracked if Path(name).suffix in SOURCES or Path(name).name in NAMES]
    silent = [path for path in files if path.exists() and path.stat().st_size and not says_licence(path.read_text())]
    for path in silent:
        print(f"{path}:1: the first line must say '{LICENCE}'")
    return 1 if silent else 0


if __name__ == "__main__":
    sys.exit(main())
