#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of docs/nodes.md: how far each node's outputs are from Cycles' in each version of Blender.

Run as a command it writes the columns of all Blenders whose figures `./dev test cycles parity` has left in build/cycles. That
test asks `untrue` whether the table says what it has found."""

from __future__ import annotations

import json
import math
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCUMENT = ROOT / "docs/nodes.md"

Column = dict[str, tuple[int, float]]  # by node: how many outputs and settings, and their largest difference
Table = dict[str, Column]  # by version, "3.4"

ROUNDING = 1e-5  # such differences change from one processor to another
CELL = re.compile(r"(\d+): (0|\de-\d+)")


def read(text: str) -> Table:
    rows = [[cell.strip() for cell in line.strip()[1:-1].split("|")] for line in text.splitlines() if line[:1] == "|"]
    versions = rows[0][1:] if rows else []
    table: Table = {version: {} for version in versions}
    for node, *cells in rows[2:]:
        for version, cell in zip(versions, cells, strict=True):
            if found := CELL.fullmatch(cell):
                table[version][node] = int(found[1]), float(found[2])
    return table


def written(table: Table) -> str:
    versions = sorted(table, key=lambda version: [int(part) for part in version.split(".")])
    nodes = sorted({node for column in table.values() for node in column})
    lines = [f"| node | {' | '.join(versions)} |", f"|---|{'---:|' * len(versions)}"]
    for node in nodes:
        cells = [f"{of[0]}: {_up(of[1])}" if (of := table[version].get(node)) else "" for version in versions]
        lines.append(f"| {node} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def _up(difference: float) -> str:
    """To one digit, never to less than it is."""
    if difference == 0:
        return "0"
    power = math.floor(math.log10(difference))
    digit = math.ceil(difference / 10.0**power - 1e-9)
    return f"{digit}e{power}" if digit < 10 else f"1e{power + 1}"


def untrue(table: Table, version: str, found: Column) -> list[str]:
    """What the table says otherwise than was found; nothing where it has no column for the version."""
    if version not in table:
        return []
    said = table[version]
    faults = [f"{node} is not in it" for node in found if node not in said]
    faults += [f"{node} is in it, and was not compared" for node in said if node not in found]
    for node in said.keys() & found.keys():
        (count, limit), (cases, worst) = said[node], found[node]
        if count != cases:
            faults.append(f"{node} has {cases} outputs and settings, not {count}")
        if not worst <= max(2 * limit, ROUNDING):
            faults.append(f"{node} differs by {worst:.1e}, not {limit:.0e}")
    return sorted(faults)


def main() -> int:
    text = DOCUMENT.read_text()
    begin = text.index("| node |")
    table = read(text[begin:])
    for path in sorted((ROOT / "build/cycles").glob("*-nodes.json")):
        major, minor = path.name.split(".")[:2]
        table[f"{major}.{minor}"] = {
            node: (count, worst) for node, (count, worst) in json.loads(path.read_text()).items()
        }
    end = begin + len("".join(line for line in text[begin:].splitlines(keepends=True) if line[0] == "|"))
    DOCUMENT.write_text(text[:begin] + written(table) + text[end:])
    return 0


if __name__ == "__main__":
    sys.exit(main())
