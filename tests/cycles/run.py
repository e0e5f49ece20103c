# SPDX-License-Identifier: GPL-3.0-or-later
"""Small scenes against Cycles, block by block: `./dev test cycles` takes a sample of them, `./dev test cycles all` each, and
`./dev test cycles PATTERN` those whose name has PATTERN in it.

`./dev test cycles parity` compares nodes alone, output by output. Writes the table of what was compared to build/cycles/VERSION.md and .json, the images beside it, and closes with 'N passed, N failed'.
A scene that deviates is rendered again with other seeds, and fails when a block does so both times, to the same side. One in
which a block has so much noise that it would hide a fault fails, too. By chance
one block and channel of 16 000 deviates: of the table's 20 000 about one, and one run in some 20 000 fails."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE), str(ROOT / "tools")]

import blocks  # noqa: E402
import parity_rows  # noqa: E402
import parity_table  # noqa: E402

AGAIN = 100_000  # the seeds of a second render
CERTAIN = 10.0  # standard errors that need none


@dataclass
class Row:
    name: str
    why: str
    within: float
    worst: float | None = None
    noise: float | None = None
    median: float | None = None
    most_noise: float | None = None
    fault: str = ""  # empty: as in Cycles


def blender(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    command = [os.environ["BLENDER"], "--background", "--factory-startup", "--addons", "wardmis", *map(str, arguments)]
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")


def render(folder: Path, seed: int, pattern: str, part: int = 0, parts: int = 1) -> None:
    """All scenes of a part. One that ends Blender is a fault of its own, and the others are rendered by another."""
    while True:
        done = blender(
            "--python-exit-code",
            "1",
            "--python",
            HERE / "render.py",
            "--",
            folder,
            f"{seed}",
            f"{part}",
            f"{parts}",
            pattern,
        )
        (folder / f"part-{part}.log").write_text(done.stdout)
        try:
            names = json.loads((folder / f"part-{part}.json").read_text())
        except OSError:
            sys.exit(f"Blender did not start:\n{done.stdout[-2000:]}")
        left = [name for name in names if not (folder / f"{name}.json").exists()]
        if not left:
            return
        outcome = {
            "within": 0,
            "why": "",
            "block": 1,
            "noise": 0,
            "passes": ["Combined"],
            "error": f"Blender ended with exit code {done.returncode}",
        }
        (folder / f"{left[0]}.json").write_text(json.dumps(outcome))


def compared(folder: Path, name: str) -> Row:
    outcome = json.loads((folder / f"{name}.json").read_text())
    row = Row(name, outcome["why"], outcome["within"], fault=outcome["error"])
    if row.fault:
        return row
    try:
        first = blocks.deviation(folder, name, row.within, outcome["block"], outcome["passes"])
        row.worst, row.noise, row.median, row.most_noise = first.worst, first.noise, first.median, first.most_noise
        both = first.beyond
        if both.any() and not (abs(first.z) > CERTAIN).any():
            again = folder / "again" / name  # several scenes are compared at a time
            again.mkdir(parents=True)
            render(again, AGAIN, f"={name}")
            second = blocks.deviation(again, name, row.within, outcome["block"], outcome["passes"])
            both = first.beyond & second.beyond & (first.z * second.z > 0)
        if both.any():
            row.fault = f"{both.any(axis=-1).sum()} of {len(both)} blocks differ"
        elif first.most_noise > outcome["noise"]:
            row.fault = too_noisy(first.most_noise, outcome["noise"])
    except (OSError, ValueError) as error:
        row.fault = str(error)
    return row


def too_noisy(most: float, bound: float) -> str:
    return (
        f"a block has {100 * most:.1f} % of noise, which would hide a fault; {100 * bound:.1f} % is allowed: give the scene more "
        "samples, larger lamps or larger blocks"
    )


def parity(folder: Path) -> list[parity_rows.Row]:
    """Node by node, pixel by pixel; writes the figures of each beside the table of scenes."""
    done = blender("--python-exit-code", "1", "--python", HERE / "parity.py", "--", folder)
    (folder / "parity.log").write_text(done.stdout)
    if done.returncode != 0:
        sys.exit(f"the nodes could not be rendered:\n{done.stdout[-2000:]}")
    found = parity_rows.rows(folder)
    folder.with_name(f"{folder.name}-nodes.json").write_text(json.dumps(parity_rows.by_node(found), indent=1))
    return found


def table(rows: list[Row]) -> str:
    lines = ["| scene | worst block | ± | median | most noise | |", "|---|---:|---:|---:|---:|---|"]
    for row in rows:
        numbers = ["–" if x is None else f"{100 * x:.2f} %" for x in (row.worst, row.noise, row.median, row.most_noise)]
        remark = f"**{row.fault}**" if row.fault else row.why
        lines.append(f"| {row.name} | {' | '.join(numbers)} | {remark} |")
    return "\n".join(lines) + "\n"


def main(pattern: str) -> int:
    said = blender("--version").stdout
    version = re.search(r"Blender (\d+\.\d+\.\d+)", said)
    if version is None:
        sys.exit(f"'{os.environ['BLENDER']} --version' names no version:\n{said}")
    folder = ROOT / "build" / "cycles" / version[1]
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    parts = int(os.environ.get("WARDMIS_JOBS") or os.cpu_count() or 1)
    nodes_too = pattern in {"", "all"} or pattern in "parity"
    with ThreadPoolExecutor(parts + 1) as pool:
        nodes = pool.submit(parity, folder) if nodes_too else None
        list(pool.map(lambda part: render(folder, 0, pattern, part, parts), range(parts)))
    lists = [json.loads((folder / f"part-{part}.json").read_text()) for part in range(parts)]
    names = [names[i] for i in range(max(map(len, lists))) for names in lists if i < len(names)]
    rows = []
    with ThreadPoolExecutor(parts) as pool:
        for row in pool.map(lambda name: compared(folder, name), names):
            rows.append(row)
            worst = "" if row.worst is None else f"{100 * row.worst:7.2f} % ± {100 * (row.noise or 0):.2f} %"
            print(f"{'FAIL' if row.fault else 'ok  '} {row.name:36} {worst} {row.fault or row.why}", flush=True)
    folder.with_suffix(folder.suffix + ".md").write_text(table(rows))
    folder.with_suffix(folder.suffix + ".json").write_text(json.dumps([vars(row) for row in rows], indent=1))
    failed = sum(bool(row.fault) for row in rows)
    passed = len(rows) - failed
    if nodes:
        for node in nodes.result():
            if node.deviates:
                print(f"FAIL parity: {node.case}: {node.worst:.1e}, and {node.within:.0e} is allowed", flush=True)
        failed += (deviating := sum(node.deviates for node in nodes.result()))
        passed += len(nodes.result()) - deviating
        said = parity_table.read(parity_table.DOCUMENT.read_text())
        untrue = parity_table.untrue(said, ".".join(version[1].split(".")[:2]), parity_rows.by_node(nodes.result()))
        for fault in untrue:
            print(f"FAIL docs/nodes.md: {fault}", flush=True)
        failed += bool(untrue)
        passed += not untrue
    print(f"{passed} passed, {failed} failed")
    return 1 if failed or not passed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else ""))
