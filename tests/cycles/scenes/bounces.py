# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that comes by way of several surfaces."""

import math

from stage import ball, box, camera, diffuse, floor, lamp, mesh, scene, square


@scene(bounces=4)
def room():
    """Walls of two colours, one area light: five surface hits."""
    floor()
    ball(location=(-0.9, 0.2, 1))
    box(location=(1.3, 0.4, 0.6), scale=(0.6, 0.6, 0.6))
    for name, color, location, rotation in (
        ("Left", (0.8, 0.2, 0.2), (-3, 0, 0), (0, math.pi / 2, 0)),
        ("Right", (0.2, 0.7, 0.2), (3.2, 0, 0), (0, -math.pi / 2, 0)),
        ("Back", (0.7, 0.7, 0.7), (0, 3.6, 0), (math.pi / 2, 0, 0)),
        ("Ceiling", (0.7, 0.7, 0.7), (0, 0, 5), (math.pi, 0, 0)),
    ):
        wall = mesh(name, *square(6), diffuse(color))
        wall.location, wall.rotation_euler = location, rotation
    lamp("AREA", (0.5, -0.5, 4.5), 200, target=(0.3, 0, 0), shape="RECTANGLE", size=2, size_y=1)
    camera()
