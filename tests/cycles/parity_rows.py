# SPDX-License-Identifier: GPL-3.0-or-later
"""How far each output of each node is from Cycles', of the images that parity.py has made."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

PIXELS = 8  # of a patch, each way
COLUMNS = 32
EDGES = 1  # of a patch's pixels, so many may lie on the other side of a pattern's edge
DARK = 0.1  # of the patch's largest value: smaller ones count relative to this


@dataclass(frozen=True)
class Row:
    node: str
    case: str
    within: float
    worst: float  # relative difference of a pixel

    @property
    def deviates(self) -> bool:
        return not self.worst <= self.within


def rows(folder: Path) -> list[Row]:
    import exr  # late: parity.py, in Blender, wants the numbers above alone

    cases = json.loads((folder / "parity.json").read_text())
    if not cases:
        return []
    ours, theirs = (
        exr.read(folder / f"parity-{engine}.exr").passes["Combined"][::-1, :, :3].astype(float)
        for engine in ("wardmis", "cycles")
    )
    return [
        Row(c["node"], c["case"], c["within"], difference(*(_patch(x, i) for x in (ours, theirs))))
        for i, c in enumerate(cases)
    ]


def _patch(image: np.ndarray, i: int) -> np.ndarray:
    x, y = i % COLUMNS * PIXELS, i // COLUMNS * PIXELS
    return image[y : y + PIXELS, x : x + PIXELS]


def difference(a: np.ndarray, b: np.ndarray) -> float:
    scale = np.maximum(np.abs(b), DARK * max(float(np.abs(b).max()), 1e-3))
    return float(np.sort((np.abs(a - b) / scale).max(axis=-1).ravel())[-1 - EDGES])


def by_node(found: list[Row]) -> dict[str, tuple[int, float]]:
    """How many of its outputs and settings were compared, and their largest difference."""
    nodes = {row.node: [other.worst for other in found if other.node == row.node] for row in found}
    return {node: (len(worst), max(worst)) for node, worst in nodes.items()}
