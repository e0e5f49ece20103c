# SPDX-License-Identifier: GPL-3.0-or-later
"""False colours, and the scale that says what they mean. No bpy in here. Images are (height, width, channels), rows from the top."""

from __future__ import annotations

import numpy as np

# matplotlib's inferno as a polynomial of degree 6 in t (Matt Zucker, shadertoy.com/view/WlfXRN, CC0): sRGB
INFERNO = np.array(
    [
        (0.0002189403691192265, 0.001651004631001012, -0.01948089843709184),
        (0.1065134194856116, 0.5639564367884091, 3.932712388889277),
        (11.60249308247187, -3.972853965665698, -15.9423941062914),
        (-41.70399613139459, 17.43639888205313, 44.35414519872813),
        (77.162935699427, -33.40235894210092, -81.80730925738993),
        (-71.31942824499214, 32.62606426397723, 73.20951985803202),
        (25.13112622477341, -12.24266895238567, -23.07032500287172),
    ]
)
NOT_A_NUMBER = (0.0, 0.6, 1.0)  # a blue that inferno has not
EPSILON = 0.01  # as in relMSE

SMALLEST_TOP = 1e-4  # of a scale

# of the scale's letters, in pixels of the image a pixel of theirs: legible where the image is shown as large as it is
SMALLEST_LETTERS, LARGEST_LETTERS = 2, 6
HEIGHT_OF_LETTERS = 100  # of the image, for each such pixel
SPACE_OF_LETTERS = 35  # in the height, which five numbers need
# three by five pixels each, a row a string
GLYPHS = {
    "0": "### #.# #.# #.# ###",
    "1": ".#. ##. .#. .#. ###",
    "2": "### ..# ### #.. ###",
    "3": "### ..# ### ..# ###",
    "4": "#.# #.# ### ..# ..#",
    "5": "### #.. ### ..# ###",
    "6": "### #.. ### #.# ###",
    "7": "### ..# ..# ..# ..#",
    "8": "### #.# ### #.# ###",
    "9": "### #.# ### ..# ###",
    ".": "... ... ... ... .#.",
    "e": "... ### ##. #.. ###",
    "-": "... ... ### ... ...",
    "+": "... .#. ### .#. ...",
}


def inferno(t: np.ndarray) -> np.ndarray:
    """sRGB of values from 0 to 1; others are taken as the nearer end."""
    t = np.clip(np.nan_to_num(t), 0, 1)[..., None]
    result = np.zeros((*t.shape[:-1], 3))
    for coefficient in INFERNO[::-1]:
        result = result * t + coefficient
    return np.clip(result, 0, 1)


def relative_difference(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """|a - b| / (|b| + EPSILON), mean of the three channels."""
    a, b = a[..., :3].astype(np.float64), b[..., :3].astype(np.float64)
    return (np.abs(a - b) / (np.abs(b) + EPSILON)).mean(axis=-1)


def fitting_top(values: np.ndarray) -> float:
    """The round number (1, 2 or 5 times a power of ten) from which on 1 % of the values at most are cut off."""
    finite = values[np.isfinite(values)]
    wanted = max(float(np.percentile(finite, 99)) if finite.size else 0.0, SMALLEST_TOP)
    decade = int(np.floor(np.log10(wanted) + 1e-9))
    return next(top for top in (float(f"{step}e{decade}") for step in (1, 2, 5, 10)) if top >= wanted * (1 - 1e-9))


def false_colour(values: np.ndarray, top: float) -> np.ndarray:
    """`values` from 0 to `top` as sRGB colours, with the scale on the right."""
    image = inferno(values / top)
    image[~np.isfinite(values)] = NOT_A_NUMBER
    return np.concatenate([image, _scale(len(image), top)], axis=1)


def _scale(height: int, top: float) -> np.ndarray:
    """A strip with the colours of 0 (below) to `top`, and five numbers beside."""
    wanted = min(max(height // HEIGHT_OF_LETTERS, SMALLEST_LETTERS), LARGEST_LETTERS)
    size = max(1, min(wanted, height // SPACE_OF_LETTERS))  # of the pixels of a glyph
    labels = [f"{top * k / 4:.3g}" for k in range(5)]
    gap, bar = 4 * size, 8 * size
    width = gap + bar + gap + max(map(len, labels)) * 4 * size
    strip = np.full((height, width, 3), 0.05)
    strip[:, gap : gap + bar] = inferno(np.linspace(1, 0, height))[:, None]
    for k, label in enumerate(labels):
        middle = round((1 - k / 4) * (height - 1))
        row = min(max(middle - 2 * size, size), max(0, height - 6 * size))
        _write(strip, label, row, gap + bar + gap // 2, size)
    return strip


def _write(image: np.ndarray, text: str, row: int, column: int, size: int) -> None:
    for i, letter in enumerate(text):
        for y, line in enumerate(GLYPHS[letter].split()):
            for x, dot in enumerate(line):
                if dot == "#":
                    top, left = row + y * size, column + (4 * i + x) * size
                    image[top : top + size, left : left + size] = 0.9
