# SPDX-License-Identifier: GPL-3.0-or-later
"""How often light may go through surfaces."""

import math
from collections.abc import Callable
from typing import Any

import bpy
from stage import add, ball, camera, diffuse, floor, lamp, material, mesh, scene, sky, square

KINDS: dict[str, dict[str, Any]] = {"Refraction": {"IOR": 1.2, "Roughness": 0.0}}


def shader(kind: str) -> Any:
    made, tree, output = material(kind)
    tree.links.new(add(tree, f"Bsdf{kind}", **KINDS[kind]).outputs[0], output.inputs["Surface"])
    return made


def panes(kind: str, count: int = 4) -> None:
    """Before two balls on a floor, each a step to the side, so that the view passes none to all of them."""
    floor()
    ball(diffuse((0.8, 0.3, 0.1)), location=(-0.8, 0.5, 0.8), radius=0.8)
    ball(diffuse((0.1, 0.4, 0.8)), location=(1.1, 0.8, 0.8), radius=0.8)
    made = shader(kind)
    for i in range(count):
        pane = mesh("Pane", *square(2.4), made)
        pane.location, pane.rotation_euler = (-1.6 + 0.7 * i, -1 - 0.3 * i, 1.2), (math.pi / 2, 0, 0.1)
    lamp("AREA", (1, -1, 5), 200, target=(0, 0, 0), shape="RECTANGLE", size=2, size_y=1)
    sky((0.3, 0.4, 0.5))
    camera()


def limited(transmission: int, transparent: int) -> None:
    settings = bpy.context.scene
    settings.cycles.transmission_bounces, settings.cycles.transparent_max_bounces = transmission, transparent
    settings.wardmis.bounces = "cycles"


def enter(name: str, build: Callable[[], None]) -> None:
    build.__name__ = name
    scene(bounces=8)(build)


for bounces in (0, 1):
    enter(f"refraction_{bounces}", lambda bounces=bounces: (panes("Refraction"), limited(bounces, 8)))
