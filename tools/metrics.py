# SPDX-License-Identifier: GPL-3.0-or-later
"""How far an image is from its reference, and whether by more than chance."""

import numpy as np
from exr import Pixels

EPSILON = 0.01
FORMULA = f"relMSE = mean((x - r)² / (r² + {EPSILON})) over pixels and RGB; x: image, r: reference"


def relative_squares(image: Pixels, reference: Pixels) -> np.ndarray:
    """One number a pixel: the mean of the three channels."""
    if image.shape[:2] != reference.shape[:2]:
        raise ValueError(f"an image of {image.shape[:2]} cannot be compared with a reference of {reference.shape[:2]}")
    x, r = (pixels[..., :3].astype(np.float64) for pixels in (image, reference))
    return ((x - r) ** 2 / (r**2 + EPSILON)).mean(axis=-1)


def rel_mse(image: Pixels, reference: Pixels) -> float:
    return float(relative_squares(image, reference).mean())


def rel_mse_trimmed(image: Pixels, reference: Pixels) -> float:
    """Without the 0.1 % of the pixels that are worst: a few fireflies must not hide how the rest fares."""
    squares = np.sort(relative_squares(image, reference), axis=None)
    return float(squares[: squares.size - -(-squares.size // 1000)].mean())


def reference_noise(reference: Pixels, variance: Pixels) -> float:
    """What the reference's own variance adds to every relMSE that is measured against it."""
    r = reference[..., :3].astype(np.float64)
    return float((variance[..., :3] / (r**2 + EPSILON)).mean())


def normal_deviate(t: np.ndarray, degrees: np.ndarray) -> np.ndarray:
    """The normal deviate that is exceeded as often as Student's t (Wallace 1959)."""
    scale = (8 * degrees + 1) / (8 * degrees + 3)
    return np.sign(t) * scale * np.sqrt(degrees * np.log1p(t**2 / degrees))
