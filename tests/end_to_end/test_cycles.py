# SPDX-License-Identifier: GPL-3.0-or-later
"""Cameras and lights against Cycles, through Blender: the same mean in each block of 8x8 pixels within 4 standard errors.

The error of WardMIS' mean comes from its Variance pass, that of Cycles' mean from its seeds; with few seeds the quotient is
Student's t, and is counted as the normal deviate of the same probability. Of 2000 blocks of 3 channels, one in three runs has a
deviate beyond 4 by chance (6.3e-5 each). So such a scene is rendered again with other seeds, and a block fails when it deviates
both times, to the same side: once in 80 000 runs by chance."""

import math
import tempfile
import unittest
from pathlib import Path

import blender
import exr
import numpy as np

SCENES = [
    "shifted",
    "orthographic",
    "depth_of_field",
    "polygonal_lens",
    "orthographic_lens",
    "vertical_fit",
    "portrait",
    "horizontal_fit",
    "border",
    "points",
    "spots",
    "suns",
    "areas",
    "round_areas",
    "overcast",
    "sky_image",
    "emissive_meshes",
    "room",
]
SCRIPT = Path(__file__).parent / "cycles_scenes.py"
BLOCK = 8
LIMIT = 4.0


class Cycles(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name)
        cls.addClassCleanup(cls.temporary.cleanup)
        render(cls.folder / "first", 0, *SCENES)

    def compare(self, name):
        z = deviations(self.folder / "first", name)
        beyond = abs(z) > LIMIT
        if beyond.any():
            render(self.folder / "again", 1000, name)
            again = deviations(self.folder / "again", name)
            both = beyond & (abs(again) > LIMIT) & (z * again > 0)
            self.assertFalse(
                both.any(), f"{name}: {both.sum()} blocks of {z.size} differ\n{np.where(both, z, 0).round(1)}"
            )
        # the blocks together show smaller differences, and that the errors are what they are said to be; the channels may be one
        self.assertLess(np.mean(z**2), 1 + 5 * math.sqrt(2 / (z.size / 3)), name)
        self.assertGreater(np.mean(z**2), 0.5, name)


def render(folder, first_seed, *names):
    folder.mkdir(exist_ok=True)
    blender.run(
        "--factory-startup", "--python-exit-code", "1", "--python", SCRIPT, "--", folder, str(first_seed), *names
    )


def deviations(folder, name):
    """Of WardMIS from Cycles in standard errors, of each block and channel."""
    ours = exr.read(folder / f"{name}-wardmis.exr").passes
    theirs = np.stack(
        [block_means(exr.read(f).passes["Combined"]) for f in sorted(folder.glob(f"{name}-cycles-*.exr"))]
    )
    seeds, cycles = len(theirs), theirs.mean(axis=0)
    their_variance = theirs.var(axis=0, ddof=1) / seeds
    our_variance = block_means(ours["Variance"]) / block_sums(np.ones_like(ours["Variance"]))
    # what is exact, as a background, may differ by rounding
    variance = our_variance + their_variance + (1e-5 * cycles) ** 2 + 1e-20
    degrees = (seeds - 1) * (variance / (their_variance + 1e-30)) ** 2  # Welch and Satterthwaite
    return normal_deviate((block_means(ours["Combined"]) - cycles) / np.sqrt(variance), degrees)


def block_sums(image):
    """Of the first three channels; the blocks at the lower and right border may be smaller."""
    sums = image[..., :3].astype(np.float64)
    for axis in (0, 1):
        sums = np.add.reduceat(sums, range(0, sums.shape[axis], BLOCK), axis=axis)
    return sums


def block_means(image):
    return block_sums(image) / block_sums(np.ones_like(image))


def normal_deviate(t, degrees):
    """The normal deviate that is exceeded as often as Student's t (Wallace 1959)."""
    scale = (8 * degrees + 1) / (8 * degrees + 3)
    return np.sign(t) * scale * np.sqrt(degrees * np.log1p(t**2 / degrees))


for _name in SCENES:
    setattr(Cycles, f"test_{_name}", lambda self, name=_name: self.compare(name))
