# SPDX-License-Identifier: GPL-3.0-or-later
"""The light of Blender's sky textures: the mean of their radiance over all directions, as Cycles renders them.

Measured at the node's own densities, turbidity, height and colour of the ground; only the height of the sun is followed, and, of the
skies that have one, its disk.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .model import Rgb

# The sun's height in degrees, and the mean radiance of the sky without its disk
PREETHAM = (
    (0, 0.5955, 0.4756, 0.2278),
    (5, 0.6305, 0.5256, 0.3454),
    (10, 0.6511, 0.5665, 0.4673),
    (20, 0.6597, 0.6215, 0.6874),
    (30, 0.6428, 0.6451, 0.8325),
    (45, 0.6004, 0.6378, 0.8857),
    (60, 0.5561, 0.6052, 0.8256),
    (90, 0.5966, 0.6790, 0.9974),
)
HOSEK_WILKIE = (
    (0, 0.02085, 0.01138, 0.005446),
    (2, 0.04243, 0.02776, 0.01319),
    (5, 0.06144, 0.05141, 0.03055),
    (10, 0.07737, 0.07973, 0.06174),
    (20, 0.08885, 0.1121, 0.1124),
    (30, 0.09690, 0.1306, 0.1450),
    (45, 0.1081, 0.1458, 0.1731),
    (60, 0.1119, 0.1519, 0.1898),
    (90, 0.08303, 0.1544, 0.2191),
)
NISHITA = (
    (-10, 2.889e-05, 1.411e-05, 4.573e-06),
    (-5, 0.004877, 0.004642, 0.005077),
    (-2, 0.07443, 0.06885, 0.0704),
    (0, 0.3066, 0.242, 0.2057),
    (2, 0.8365, 0.6156, 0.4327),
    (5, 1.478, 1.222, 0.9035),
    (10, 1.986, 1.836, 1.586),
    (15, 2.106, 2.081, 2.001),
    (20, 2.073, 2.154, 2.236),
    (30, 1.895, 2.118, 2.440),
    (45, 1.663, 1.985, 2.496),
    (60, 1.511, 1.868, 2.467),
    (90, 1.394, 1.766, 2.417),
)
# how much more comes from the newer one, in which light is scattered more than once
MULTIPLE_SCATTERING = ((0, 1.0, 1.15, 1.65), (15, 0.93, 1.24, 1.73), (45, 1.25, 1.62, 2.0))
# and what the sun's disk adds to either
NISHITA_DISK = (
    (0, 0.0, 0.0, 0.0),
    (2, 2.383, 0.831, 0.004339),
    (5, 5.636, 2.946, 0.6294),
    (10, 8.368, 5.529, 2.401),
    (15, 9.648, 6.979, 3.873),
    (20, 10.37, 7.858, 4.936),
    (30, 11.13, 8.841, 6.283),
    (45, 11.65, 9.531, 7.328),
    (60, 11.91, 9.867, 7.858),
    (90, 12.10, 10.11, 8.217),
)


def mean_radiance(node: Any) -> Rgb:
    if node.sky_type in {"PREETHAM", "HOSEK_WILKIE"}:
        x, y, z = node.sun_direction
        height = math.degrees(math.atan2(z, math.hypot(x, y)))
        return _at(PREETHAM if node.sky_type == "PREETHAM" else HOSEK_WILKIE, height)
    # beyond the zenith it comes down on the other side
    height = math.degrees(math.asin(math.sin(node.sun_elevation)))
    r, g, b = _at(NISHITA, height)
    if node.sky_type == "MULTIPLE_SCATTERING":
        r, g, b = (v * more for v, more in zip((r, g, b), _at(MULTIPLE_SCATTERING, height)))
    if node.sun_disc:
        disk = _at(NISHITA_DISK, height)
        r, g, b = (v + d * node.sun_intensity for v, d in zip((r, g, b), disk))
    return (r, g, b)


def _at(table: tuple[tuple[float, ...], ...], height: float) -> Rgb:
    heights, *channels = np.array(table).T
    r, g, b = (float(np.interp(height, heights, channel)) for channel in channels)
    return (r, g, b)
