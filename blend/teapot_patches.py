# SPDX-License-Identifier: GPL-3.0-or-later
"""Martin Newell's teapot (1975), the 32 bicubic Bezier patches, z up.

Most of it is turned about the z axis: a curve of (radius, height) stands for its four quarters. Handle and spout are
given for y <= 0, each row from the inner to the outer side, and mirrored.
"""

import numpy as np

ARC = 0.56  # of the radius: the length of the control arms of Newell's quarter circles

# (radius, height), and the arc where it differs: the knob's widest ring is a little rounder
RIM = ((1.4, 2.4), (1.3375, 2.53125), (1.4375, 2.53125), (1.5, 2.4))
UPPER_BODY = ((1.5, 2.4), (1.75, 1.875), (2.0, 1.35), (2.0, 0.9))
LOWER_BODY = ((2.0, 0.9), (2.0, 0.45), (1.5, 0.225), (1.5, 0.15))
KNOB = ((0.0, 3.15), (0.8, 3.15, 0.5625), (0.0, 2.85), (0.2, 2.7))
LID = ((0.2, 2.7), (0.4, 2.55), (1.3, 2.55), (1.3, 2.4))
BOTTOM = ((1.5, 0.15), (1.5, 0.075), (1.425, 0.0), (0.0, 0.0))

# a row: (x, z) of its inner side, of its outer side, and the half width
UPPER_HANDLE = (
    ((-1.6, 2.025), (-1.5, 2.25), 0.3),
    ((-2.3, 2.025), (-2.5, 2.25), 0.3),
    ((-2.7, 2.025), (-3.0, 2.25), 0.3),
    ((-2.7, 1.8), (-3.0, 1.8), 0.3),
)
LOWER_HANDLE = (
    ((-2.7, 1.8), (-3.0, 1.8), 0.3),
    ((-2.7, 1.575), (-3.0, 1.35), 0.3),
    ((-2.5, 1.125), (-2.65, 0.9375), 0.3),
    ((-2.0, 0.9), (-1.9, 0.6), 0.3),
)
LOWER_SPOUT = (
    ((1.7, 1.425), (1.7, 0.6), 0.66),
    ((2.6, 1.425), (3.1, 0.825), 0.66),
    ((2.3, 2.1), (2.4, 2.025), 0.25),
    ((2.7, 2.4), (3.3, 2.4), 0.25),
)
UPPER_SPOUT = (
    ((2.7, 2.4), (3.3, 2.4), 0.25),
    ((2.8, 2.475), (3.525, 2.49375), 0.25),
    ((2.9, 2.475), (3.45, 2.5125), 0.15),
    ((2.8, 2.4), (3.2, 2.4), 0.15),
)


def ring(r, z, arc=ARC):
    """A quarter circle of radius r at height z."""
    return (r, 0, z), (r, -arc * r, z), (arc * r, -r, z), (0, -r, z)


def turned(curve):
    """The four quarters of a surface of revolution."""
    quarter = np.array([ring(*point) for point in curve])
    turn = np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]])  # by -90 degrees about z, as the quarters go
    return [quarter @ np.linalg.matrix_power(turn, k).T for k in range(4)]


def mirrored(rows):
    """The halves at y <= 0 and at y >= 0, the second with its rows reversed so that both face the same way."""
    half = np.array([[(a, 0, b), (a, -w, b), (c, -w, d), (c, 0, d)] for (a, b), (c, d), w in rows])
    return [half, half[:, ::-1] * (1, -1, 1)]


def patches():
    """The control points, an array [32, 4, 4, 3]: patch, row (u), point in the row (v). d/dv x d/du points outwards."""
    parts = [turned(RIM), turned(UPPER_BODY), turned(LOWER_BODY), turned(KNOB), turned(LID), turned(BOTTOM)]
    parts += [mirrored(UPPER_HANDLE), mirrored(LOWER_HANDLE), mirrored(LOWER_SPOUT), mirrored(UPPER_SPOUT)]
    return np.array([patch for part in parts for patch in part])


def tessellate(subdivisions):
    """Vertices [n, 3] and faces [m, 4], a corner twice at a pole: every patch as a grid, welded where patches meet."""
    t = np.linspace(0.0, 1.0, subdivisions + 1)[:, None]
    basis = np.hstack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3])
    points = np.einsum("ui,vj,pijc->puvc", basis, basis, patches()).reshape(-1, 3)
    index = np.arange(len(points)).reshape(32, subdivisions + 1, subdivisions + 1)
    quads = np.stack([index[:, :-1, :-1], index[:, :-1, 1:], index[:, 1:, 1:], index[:, 1:, :-1]], axis=-1)
    _, first, inverse = np.unique(np.round(points, 6) + 0.0, axis=0, return_index=True, return_inverse=True)
    return points[first], inverse[quads.reshape(-1, 4)]
