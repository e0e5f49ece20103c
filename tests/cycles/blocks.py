# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether two sets of renders are of one picture: the means of square blocks of pixels, and how sure they are.

Each engine renders with several seeds, whose spread gives the error of its mean (Welch's t, counted as the normal deviate of the same
probability). A block fails where it lies further from Cycles' than the scene's tolerance, by more than LIMIT standard errors; the
image's mean, which is the last block, where it does so by more than half of that."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import exr
import numpy as np
from metrics import normal_deviate

LIMIT = 4.0
DARK = 0.2  # of the brightest block: in darker ones a deviation counts relative to this


@dataclass
class Deviation:
    """Of every block and channel, (blocks + 1, channels): those of Combined, alpha being the last, or of the passes in order."""

    relative: np.ndarray  # (ours - theirs) / theirs
    error: np.ndarray  # of one standard deviation, by noise
    z: np.ndarray  # of what is beyond the tolerance, 0 within it; its sign is that of the deviation

    @property
    def beyond(self) -> np.ndarray:
        return np.abs(self.z) > LIMIT

    @property
    def worst(self) -> float:
        return float(np.abs(self.relative).max())

    @property
    def median(self) -> float:
        """Of blocks; a block deviates as its worst channel does."""
        return float(np.median(np.abs(self.relative).max(axis=-1)))

    @property
    def noise(self) -> float:
        """One standard error of the worst block."""
        return float(self.error.ravel()[np.abs(self.relative).argmax()])

    @property
    def most_noise(self) -> float:
        """The largest standard error of any block: by how much the picture may differ somewhere without being found."""
        return float(self.error.max())


def deviation(folder: Path, name: str, within: float, block: int, passes: Sequence[str] = ("Combined",)) -> Deviation:
    """`block`: pixels a side. ValueError where the images are not of one size, or have no finite numbers."""
    ours, theirs, scale = [], [], []
    for one in passes:
        a, b = (block_means(images(folder, name, engine, one), block) for engine in ("wardmis", "cycles"))
        if a.shape != b.shape:
            raise ValueError(f"the images differ in size or channels ({one})")
        ours.append(a)
        theirs.append(b)
        size = np.abs(b.mean(axis=0))
        scale.append(np.maximum(size, DARK * size[..., :3].max()) + 1e-9)
        if one == "Combined":
            scale[-1][..., 3] = 1  # an alpha of 0 is as good as one of 1
    return _deviation(*(np.concatenate(x, axis=-1) for x in (ours, theirs, scale)), within)


def _deviation(ours: np.ndarray, theirs: np.ndarray, scale: np.ndarray, within: float) -> Deviation:
    """scale: what a relative deviation is relative to."""
    a, b = (x.mean(axis=0) for x in (ours, theirs))
    variances = [x.var(axis=0, ddof=1) / len(x) for x in (ours, theirs)]
    error = np.sqrt(sum(variances) + (1e-5 * scale) ** 2)  # what is exact, as a background, may differ by rounding
    degrees = error**4 / sum(v**2 / (len(x) - 1) + 1e-40 for v, x in zip(variances, (ours, theirs)))
    tolerance = np.full((len(a), 1), within)
    tolerance[-1] /= 2
    excess = np.sign(a - b) * np.maximum(np.abs(a - b) - tolerance * scale, 0)
    return Deviation((a - b) / scale, error / scale, normal_deviate(excess / error, degrees))


def images(folder: Path, name: str, engine: str, one: str) -> np.ndarray:
    """Of one pass: (seeds, height, width, channels)."""
    files = sorted(folder.glob(f"{name}-{engine}-*.exr"))
    made = [exr.read(file).passes for file in files]
    if missing := [file.name for file, passes in zip(files, made) if one not in passes]:
        raise ValueError(f"{missing[0]} has no pass {one}")
    stack = np.stack([passes[one] for passes in made]).astype(np.float64)
    if not np.isfinite(stack).all():
        raise ValueError(f"{engine}'s image has numbers that are not finite ({one})")
    return stack


def block_means(stack: np.ndarray, block: int) -> np.ndarray:
    """(seeds, blocks + 1, channels). The blocks at the lower and right border may be smaller; the last one is the whole image."""
    sums, counts = stack, np.ones_like(stack[:1])
    for axis in (1, 2):
        starts = range(0, stack.shape[axis], block)
        sums, counts = (np.add.reduceat(x, starts, axis=axis) for x in (sums, counts))
    blocks = (sums / counts).reshape(len(stack), -1, stack.shape[-1])
    return np.concatenate([blocks, stack.mean(axis=(1, 2))[:, None]], axis=1)
