# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that comes by way of several surfaces."""

import math
from collections.abc import Callable
from typing import Any

import bpy
from stage import add, ball, box, camera, diffuse, floor, lamp, material, mesh, scene, square

SAMPLES = 16  # of many bounces
SELDOM = {
    "diffuse_2",
    "glossy_1",
}


@scene(bounces=4, samples=24)
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


def mirror() -> Any:
    """A Ward lobe so narrow that it is also Cycles'."""
    made, tree, output = material()
    node = tree.nodes.new("WardBSDFNode")
    node.inputs["Diffuse Color"].default_value = 0, 0, 0, 1
    node.inputs["Specular Color"].default_value = 0.9, 0.9, 0.9, 1
    node.inputs["Alpha X"].default_value = node.inputs["Alpha Y"].default_value = 0.005
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return made


def dull(color: Any) -> Any:
    """What walls of a new file are made of: rough gloss over something diffuse."""
    made, tree, output = material()
    node = add(tree, "BsdfPrincipled", Base_Color=(*color, 1), Roughness=0.9)
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return made


def interior(mirrors: bool = False, of: Callable[[Any], Any] = diffuse) -> None:
    """A closed room of bright walls, most of whose light comes by many bounces. `mirrors`: two walls that face each other."""
    grey = (0.9, 0.9, 0.9)
    for color, location, rotation in (
        (grey, (0, 0, 0), (0, 0, 0)),
        ((0.9, 0.6, 0.6), (-3, 0, 3), (0, math.pi / 2, 0)),
        ((0.6, 0.9, 0.6), (3, 0, 3), (0, -math.pi / 2, 0)),
        (grey, (0, 3, 3), (math.pi / 2, 0, 0)),
        (grey, (0, -3, 3), (-math.pi / 2, 0, 0)),
        (grey, (0, 0, 6), (math.pi, 0, 0)),
    ):
        shows = mirrors and location[0] != 0
        wall = mesh("Wall", *square(6), mirror() if shows else of(color))
        wall.location, wall.rotation_euler = location, rotation
    box(location=(1, 1, 1), scale=(0.7, 0.7, 1))
    camera((-1.5, -2.6, 3.4), (1.2, 2, 1.5), lens=28)


def limited(diffuse_bounces: int, glossy_bounces: int) -> None:
    """Cycles' limits by kind, in both."""
    settings = bpy.context.scene
    settings.cycles.diffuse_bounces, settings.cycles.glossy_bounces = diffuse_bounces, glossy_bounces
    settings.wardmis.bounces = "cycles"


def enter(name: str, build: Callable[[], None], **more: Any) -> None:
    build.__name__ = name
    scene(bounces=12, **more)(build)


def lit(size: float) -> None:
    lamp("AREA", (0.3, 0.3, 5.5), 100, target=(0.1, 0.2, 0), shape="RECTANGLE", size=size, size_y=size / 2)


for count in (0, 2, 4):
    enter(f"diffuse_{count}", lambda count=count: (interior(), limited(count, 4), lit(2)))
for count in (0, 1, 4):
    # a lamp that rays find which a mirror turns towards it
    enter(
        f"glossy_{count}", lambda count=count: (interior(mirrors=True), limited(2, count), lit(5)), block=16, samples=24
    )

enter(
    "of_two_lobes",
    lambda: (interior(of=dull), limited(4, 4), lit(2)),
    within=0.04,
    why="at the first hit each limit cuts the light of its own lobe, in Cycles of the one that was drawn",
)
