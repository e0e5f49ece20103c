# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a picture is looked up, and what is seen there: of one picture, or of several with the same coordinates."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from .image import Picture
from .resample import fine_size, look_up

IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)


@dataclass(frozen=True)
class Lookup:
    """Which texel: two values with equal look-ups see the same one.

    `transform`: of six numbers, the affine map from the mesh's UVs to the picture's; of nine, the matrix from a direction of the
    world to the one that is looked up in a picture of all directions, of the `projection` "equirectangular" or "mirror-ball". `warp`: before that, in the unit square, two 3x4 matrices: the
    UVs as (u, v, 0, 1) times the first are a vector that is made a unit one, and it times the second gives the picture's UVs.
    """

    picture: Picture
    interpolation: str
    extension: str
    transform: tuple[float, ...]
    warp: tuple[float, ...] = ()
    projection: str = "equirectangular"

    @property
    def is_sky(self) -> bool:
        return len(self.transform) == 9

    @property
    def is_exact(self) -> bool:
        """Whether its texels are shown as they are, or may be filtered after what is made of them."""
        return self.interpolation == "Closest" and not self.warp

    def __str__(self) -> str:
        warp = f" {self.warp}" if self.warp else ""
        return f"{self.picture.name_full} {self.interpolation} {self.extension}{warp}"

    def goes_with(self, other: Lookup) -> bool:
        """Whether one image can show both."""
        mine, others = ((x.transform, x.extension, x.projection) for x in (self, other))
        return mine == others

    def seen(self, width: int, height: int) -> np.ndarray:
        """(height, width, 4) float32: linear RGBA over the unit square; one texel where there is nothing to look up."""

        def filtered(pixels: np.ndarray) -> np.ndarray:
            if pixels.shape[:2] == (height, width) and not self.warp:
                return pixels
            u, v = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
            if self.warp:
                u, v = self._warped(u, v)
            return look_up(pixels, u, v, self.interpolation, self.extension)

        return self.picture.texels(filtered)

    def _warped(self, u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        before, after = np.array(self.warp).reshape(2, 3, 4)
        vector = np.stack([u, v, 0 * u, 0 * u + 1], axis=-1) @ before.T
        length = np.linalg.norm(vector, axis=-1, keepdims=True)
        unit = np.divide(vector, length, out=np.zeros_like(vector), where=length > 0)
        coordinates = unit @ after[:, :3].T + after[:, 3]
        return coordinates[..., 0], coordinates[..., 1]


def common_size(lookups: Iterable[Lookup]) -> tuple[int, int]:
    """Width and height of an image that shows what is made of them: not below theirs, and finer unless all are shown as they are."""
    lookups = list(lookups)
    sizes = {tuple(lookup.picture.image.size) for lookup in lookups}
    width, height = (max(1, *side) if len(side) > 1 else max(1, side[0]) for side in zip(*sizes))
    return (width, height) if shown_exactly(lookups) else fine_size(width, height)


def shown_exactly(lookups: Iterable[Lookup]) -> bool:
    lookups = list(lookups)
    same_size = len({tuple(lookup.picture.image.size) for lookup in lookups}) == 1
    return same_size and all(lookup.is_exact for lookup in lookups)
