# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours of single wavelengths and of black bodies, as light of linear Rec. 709."""

from __future__ import annotations

import numpy as np

# XYZ to linear Rec. 709, with the digits that Cycles has: of version 5 those of the primaries
_ROUNDED = ((3.2404542, -1.5371385, -0.4985314), (-0.9692660, 1.8760108, 0.0415560), (0.0556434, -0.2040259, 1.0572252))
_EXACT = (
    (3.24096994, -1.53738318, -0.49861076),
    (-0.96924364, 1.8759675, 0.04155506),
    (0.05563008, -0.20397696, 1.05697151),
)
SECOND_RADIATION = 1.438777e7  # nm K


# The CIE's colour matching functions of 1931, at 380, 390 ... 780 nm: x, y and z, times 10000.
_TABLES = (
    "14 42 143 435 1344 2839 3483 3362 2908 1954 956 320 49 93 633 1655 2904 4334 5945 7621 9163 10263 10622 10026 8544 6424 "
    "4479 2835 1649 874 468 227 114 58 29 14 7 3 2 1 0",
    "0 1 4 12 40 116 230 380 600 910 1390 2080 3230 5030 7100 8620 9540 9950 9950 9520 8700 7570 6310 5030 3810 2650 1750 "
    "1070 610 320 170 82 41 21 10 5 3 1 1 0 0",
    "65 201 679 2074 6456 13856 17471 17721 16692 12876 8130 4652 2720 1582 782 422 203 87 39 21 17 11 8 3 2 0 0 0 0 0 0 0 0 "
    "0 0 0 0 0 0 0 0",
)
MATCHING = np.array([[float(v) / 1e4 for v in row.split()] for row in _TABLES])
STEPS = np.linspace(380.0, 780.0, MATCHING.shape[1])  # nm


def to_rgb(version: int) -> np.ndarray:
    """(3, 3)."""
    return np.array(_EXACT if version >= 5 else _ROUNDED)


def of_bytes(colors: np.ndarray, version: int) -> np.ndarray:
    """Colours of bytes (..., 3), which Cycles takes for those of a rounded Rec. 709."""
    return (colors @ (to_rgb(version) @ np.linalg.inv(_ROUNDED)).T).astype(colors.dtype) if version >= 5 else colors


def blackbody(kelvin: float, version: int) -> tuple[float, float, float]:
    """Of luminance 1; below 800 K and above 12000 K the colour does not change any more, as in Cycles."""
    radiance = STEPS**-5 / np.expm1(SECOND_RADIATION / (STEPS * min(max(kelvin, 800.0), 12000.0)))
    xyz = MATCHING @ radiance
    return _rgb(xyz / xyz[1], version)


def wavelength(nm: float, version: int) -> tuple[float, float, float]:
    """Of one nanometre's light, with the largest red at 1 as in Cycles; black where nothing is seen."""
    if not 380.0 <= nm <= 780.0:
        return (0.0, 0.0, 0.0)
    return _rgb(np.array([np.interp(nm, STEPS, row) for row in MATCHING]) / 2.52, version)


def _rgb(xyz: np.ndarray, version: int) -> tuple[float, float, float]:
    r, g, b = (float(v) for v in np.maximum(to_rgb(version) @ xyz, 0.0))
    return (r, g, b)
