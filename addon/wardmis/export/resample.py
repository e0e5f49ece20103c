# SPDX-License-Identifier: GPL-3.0-or-later
"""Looking pixels up as the renderer does, for images that are baked: (height, width, channels) arrays, rows from the bottom."""

from __future__ import annotations

import numpy as np

FINE = 256  # texels a side that an image which is baked has at least


def look_up(pixels: np.ndarray, u: np.ndarray, v: np.ndarray, interpolation: str, extension: str) -> np.ndarray:
    """(*shape, channels) float32 at coordinates of one shape, (0, 0) the bottom left corner. The settings are those of an image node."""
    height, width = pixels.shape[:2]
    columns, rows = _taps(u, width, interpolation, extension), _taps(v, height, interpolation, extension)
    found = np.zeros((*np.shape(u), pixels.shape[2]), np.float32)
    for j, share_of_row in rows:
        for i, share in columns:
            weight = share * share_of_row * ((i >= 0) & (j >= 0))
            found += pixels[j, i] * weight[..., None].astype(np.float32)
    return found


def fine_size(width: int, height: int) -> tuple[int, int]:
    """Of what a small image is baked into: nodes see colours after they are filtered, and what they make of them is not linear."""
    times = max(1, -(-FINE // max(width, height, 1)))
    return width * times, height * times


def _taps(u: np.ndarray, n: int, interpolation: str, extension: str) -> list[tuple[np.ndarray, np.ndarray]]:
    """The texels that count, -1 for none, and their weights."""
    if interpolation == "Closest":
        return [(_wrapped(np.floor(u * n).astype(int), n, extension), np.ones_like(u))]
    x = u * n - 0.5
    first = np.floor(x).astype(int)
    t = x - first
    s = 1 - t
    if interpolation == "Linear":
        weights = [(0, s), (1, t)]
    else:  # a cubic B-spline
        inner = [(4 + a * a * (3 * a - 6)) / 6 for a in (t, s)]
        weights = [(-1, s**3 / 6), (0, inner[0]), (1, inner[1]), (2, t**3 / 6)]
    return [(_wrapped(first + offset, n, extension), weight) for offset, weight in weights]


def _wrapped(i: np.ndarray, n: int, extension: str) -> np.ndarray:
    if extension == "REPEAT":
        return i % n
    if extension == "MIRROR":
        i = i % (2 * n)
        return np.where(i < n, i, 2 * n - 1 - i)
    if extension == "CLIP":
        return np.where((i < 0) | (i >= n), -1, i)
    return np.clip(i, 0, n - 1)
