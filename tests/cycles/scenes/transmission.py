# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes through surfaces: how often it may, and what it sees."""

import math
from collections.abc import Callable
from typing import Any

import bpy
from stage import add, ball, box, camera, diffuse, floor, lamp, material, mesh, scene, sky, square

from scenes.worlds import image_sky

SELDOM = {
    "behind_1_of_0",
    "behind_1_of_2",
    "behind_2_of_0",
    "behind_3_of_2",
}

KINDS: dict[str, dict[str, Any]] = {
    "Refraction": {"IOR": 1.2, "Roughness": 0.0},
    "Glass": {"IOR": 1.3, "Roughness": 0.3},
    "Translucent": {},
    "Transparent": {"Color": (0.8, 0.7, 0.6, 1)},
}


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
        pane = mesh("Pane", *square(0.9), made)
        pane.location, pane.rotation_euler = (-0.8 + 0.5 * i, -1 - 0.3 * i, 1.2), (math.pi / 2, 0, 0.1)
    size, size_y = (2, 1) if kind == "Transparent" else (4, 3)  # what is refracted finds it by chance
    lamp("AREA", (1, -1, 5), 200, target=(0, 0, 0), shape="RECTANGLE", size=size, size_y=size_y)
    sky((0.3, 0.4, 0.5))
    camera()


def limited(transmission: int, transparent: int) -> None:
    settings = bpy.context.scene
    settings.cycles.transmission_bounces, settings.cycles.transparent_max_bounces = transmission, transparent
    settings.wardmis.bounces = "cycles"


def enter(name: str, build: Callable[[], None], **more: Any) -> None:
    build.__name__ = name
    scene(bounces=8, **more)(build)


@scene(bounces=8, samples=64)
def mirrored_glass():
    """Its inside is that of the mesh: boxes of a mesh of their own and of a shared one, whose objects are mirrored."""
    floor()
    ball(diffuse((0.8, 0.3, 0.1)), location=(0, 2, 0.8), radius=0.8)
    glass = shader("Glass")
    box(glass, location=(-1.4, -0.4, 0.9), scale=(0.5, 0.5, -0.7))
    shared = box(glass, location=(0, -0.4, 0.9), scale=(-0.5, 0.5, 0.7))
    other = bpy.data.objects.new("Other", shared.data)
    bpy.context.scene.collection.objects.link(other)
    other.location, other.scale = (1.4, -0.4, 0.9), (0.5, 0.5, 0.7)
    sky((0.3, 0.4, 0.5))
    camera()


for bounces in (0, 1):
    enter(f"refraction_{bounces}", lambda bounces=bounces: (panes("Refraction"), limited(bounces, 8)))
enter("translucent_1", lambda: (panes("Translucent"), limited(1, 8)))
enter("glass_1", lambda: (panes("Glass"), limited(1, 8)), samples=64)
enter(
    "transparent_1",
    lambda: (panes("Transparent"), limited(8, 1)),
    within=0.02,
    why="a lamp that a ray passes counts as a surface in Cycles",
)


def behind(count: int, limit: int) -> None:
    """A floor, a glowing ball and the sky, behind panes that fill the view."""
    floor()
    glow, tree, output = material("Glow")
    tree.links.new(add(tree, "Emission").outputs[0], output.inputs["Surface"])
    ball(glow, location=(0, 0, 1), radius=0.8)
    made = shader("Transparent")
    for i in range(count):
        pane = mesh("Pane", *square(20), made)
        pane.location, pane.rotation_euler = (0, -1.5 - 0.2 * i, 0), (math.pi / 2, 0, 0)
    sky((0.3, 0.4, 0.5))
    camera()
    limited(8, limit)


for count, limit in ((1, 0), (2, 0), (1, 2), (2, 2), (3, 2), (4, 2)):
    # what rays from the floor meet by chance behind one more pane, as in transparent_0
    far = (
        {} if limit else {"within": 0.05, "why": "rays that meet what glows by chance pass one surface more in Cycles"}
    )
    enter(f"behind_{count}_of_{limit}", lambda count=count, limit=limit: behind(count, limit), **far)


@scene(bounces=8, within=0.02, why="rays that meet the lamp by chance pass one surface more in Cycles")
def transparent_0():
    panes("Transparent")
    limited(8, 0)


@scene(bounces=8)
def shadow_of_one_that_casts_it_whole():
    """Under a sun, which no ray of a surface finds by chance."""
    panes("Transparent", 2)
    bpy.data.objects.remove(bpy.data.objects["Area"])
    lamp("SUN", (1, -1, 5), 3, target=(0, 0, 0), angle=0.0)
    made = bpy.data.materials["Transparent"]
    owner = made if hasattr(made, "use_transparent_shadow") else made.cycles
    owner.use_transparent_shadow = False


@scene(bounces=8)
def ball_not_by_what_is_refracted():
    panes("Refraction", 2)
    bpy.data.objects["Ball"].visible_transmission = False


@scene(bounces=8)
def lamp_not_by_what_is_transmitted():
    """But Cycles counts what is translucent as diffuse, where lamps are concerned."""
    panes("Translucent", 2)
    lamp("POINT", (-0.3, 1.2, 2.6), 200, (1, 0.2, 0.2)).visible_transmission = False


@scene(bounces=8)
def lamp_not_by_what_is_diffuse():
    panes("Translucent", 2)
    lamp("POINT", (-0.3, 1.2, 2.6), 200, (1, 0.2, 0.2)).visible_diffuse = False


@scene(bounces=8)
def sky_not_by_what_is_diffuse():
    panes("Translucent", 2)
    bpy.context.scene.world.cycles_visibility.diffuse = False


@scene(bounces=8, samples=48)
def sky_not_by_what_is_refracted():
    panes("Refraction", 2)
    bpy.context.scene.world.cycles_visibility.transmission = False


def rough_panes(kind: str) -> None:
    """In front of a lamp that shines along them from behind, where Cycles has light that no facet refracts so."""
    new = kind == "Glass" and bpy.app.version >= (4, 0)  # Beckmann's would be the same
    for i, distribution in enumerate(("GGX", "MULTI_GGX" if new else "BECKMANN")):
        for k, (ior, turned) in enumerate(((1.45, 1), (0.8, 1), (1.45, -1))):
            made, tree, output = material(kind)
            settings = {"distribution": distribution}
            shader = add(tree, f"Bsdf{kind}", settings, IOR=ior, Roughness=0.6, Color=(1, 0.8, 0.6, 1))
            tree.links.new(shader.outputs[0], output.inputs["Surface"])
            pane = mesh("Pane", *square(0.45), made)
            pane.location, pane.rotation_euler = (k - 1, 0, 0.6 + i), (turned * math.pi / 2, 0, 0)
    lamp("AREA", (0, 1, 4), 200, target=(0, 0, 1), size=1)
    sky((0, 0, 0))
    camera((0.3, -4, 1.6), (0, 0, 1.1))


@scene
def rough_glass_beside_lamp():
    rough_panes("Glass")


@scene
def rough_refraction_beside_lamp():
    rough_panes("Refraction")


def rough_panes_under_sky() -> None:
    for i, (ior, roughness) in enumerate(((1.45, 0.3), (0.8, 0.6), (1.45, 1))):
        made, tree, output = material()
        settings = {"distribution": "GGX"}
        shader = add(tree, "BsdfRefraction", settings, IOR=ior, Roughness=roughness)
        tree.links.new(shader.outputs[0], output.inputs["Surface"])
        pane = mesh("Pane", *square(0.45), made)
        pane.location, pane.rotation_euler = (i - 1, 0, 1), (math.pi / 2, 0, 1.2)
    camera((0.3, -4, 1.6), (0, 0, 1.1))


@scene
def rough_refraction_under_sky():
    """A sky that is sampled, and the panes at grazing angles."""
    image_sky(64, rough_panes_under_sky, Rotation=(0.4, -0.3, 1.1))
