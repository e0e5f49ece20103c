# SPDX-License-Identifier: GPL-3.0-or-later
"""clang-tidy over native/, in parallel. A file that passed is not looked at again until it, a header of this project
that it includes, or .clang-tidy changes: `tidy.py BUILD JOBS`."""

import hashlib
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from check_layers import INCLUDE

ROOT = Path(__file__).resolve().parent.parent


def with_headers(source: Path, seen: set[Path]) -> Iterator[Path]:
    """The file and, transitively, what it includes from native/."""
    if source in seen:
        return
    seen.add(source)
    yield source
    for quoted, _ in INCLUDE.findall(source.read_text()):
        header = ROOT / "native" / quoted
        if quoted and header.exists():
            yield from with_headers(header, seen)


def fingerprint(source: Path) -> str:
    digest = hashlib.sha256((ROOT / ".clang-tidy").read_bytes())
    for path in with_headers(source, set()):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def passes(source: Path, build: Path) -> bool:
    stamp = build / "lint" / "tidy" / source.relative_to(ROOT).with_suffix(".stamp")
    print_ = fingerprint(source)
    if stamp.exists() and stamp.read_text() == print_:
        return True
    result = subprocess.run(
        # The compiler's own warnings are the build's business; GCC's options are unknown to clang.
        ["clang-tidy", "--quiet", "-p", str(build), "--extra-arg=-Wno-everything", str(source)],
        capture_output=True,
        text=True,
    )
    if result.returncode != 0:
        print(result.stdout + result.stderr, flush=True)
        return False
    stamp.parent.mkdir(parents=True, exist_ok=True)
    stamp.write_text(print_)
    return True


def main(build: Path, jobs: int) -> int:
    sources = sorted((ROOT / "native").rglob("*.cpp"))
    with ThreadPoolExecutor(jobs) as pool:
        passed = list(pool.map(lambda source: passes(source, build), sources))
    return 0 if all(passed) else 1


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), int(sys.argv[2])))
