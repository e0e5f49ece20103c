# SPDX-License-Identifier: GPL-3.0-or-later
"""Each lobe on a plane, seen at angles from 0 to 89 degrees, under a constant and under a structured light.

The image's blocks are planes of their own: to the right at larger angles, downwards of the shaders given. They are seen by the camera
alone, so that each is lit as if it were the only one."""

import math

from stage import WHITE, camera, material, mesh, scene, sky, square
from wardmis import compat

from scenes import surfaces

DEGREES = (0, 20, 40, 55, 68, 78, 85, 89)
ROUGHNESSES = (0, 0.1, 0.25, 0.5, 0.75, 1)
OLD = compat.CYCLES == 3
SAMPLES = 16
SELDOM = {"matte_structured"}


def on_planes(rows):
    for row, build in enumerate(rows):
        of, tree, output = material()
        tree.links.new(build(tree), output.inputs["Surface"])
        for column, degrees in enumerate(DEGREES):
            made = mesh("Plane", *square(0.5), of)
            made.location = column - 3.5, 2.5 - row, 0
            made.rotation_euler = 0, math.radians(degrees), 0
            made.scale = 1 / math.cos(math.radians(degrees)), 1, 1
            for ray in ("diffuse", "glossy", "transmission", "volume_scatter", "shadow"):
                setattr(made, f"visible_{ray}", False)
    seen = camera((0, 0, 100), (0, 0, 0))
    seen.rotation_euler = 0, 0, 0
    seen.data.type, seen.data.ortho_scale, seen.data.clip_end = "ORTHO", 8, 200


def enter(name, rows, **more):
    """Under both lights."""

    def constant():
        on_planes(rows)
        sky(WHITE, 0.5)

    def structured():
        on_planes(rows)
        surfaces.structured_light()

    for light in (constant, structured):
        light.__name__ = f"{name}_{light.__name__}"
        scene(**more)(light)


def sheen(roughness):
    if OLD:
        return surfaces.shader("BsdfVelvet", Color=surfaces.ROSE, Sigma=roughness)
    return surfaces.sheen("MICROFIBER", roughness, surfaces.ROSE)


enter(
    "matte",
    [
        *(surfaces.shader("BsdfDiffuse", Color=surfaces.AMBER, Roughness=r) for r in (0, 0.5, 1)),
        *(sheen(r) for r in (0.1, 0.5, 1)),
    ],
    samples=192,  # of cloth that shines at grazing angles alone
)
for kind in ("GGX", "BECKMANN", *(() if OLD else ("MULTI_GGX",))):
    enter(kind.lower(), [surfaces.glossy(kind, r) for r in ROUGHNESSES])
# at grazing angles Cycles brings light to rougher ones of Ashikhmin and Shirley by half vectors that it has turned over
enter(
    "anisotropic",
    [
        *(surfaces.glossy("GGX", r, a, 0.1) for r, a in ((0.1, 0.9), (0.4, 0.5), (0.4, 0.9), (0.8, -0.7))),
        *(surfaces.glossy("ASHIKHMIN_SHIRLEY", r, a) for r, a in ((0.05, 0), (0.1, 0.5))),
    ],
)
enter("glass", [surfaces.glass("GGX", r, IOR=ior, Color=surfaces.WHITE) for ior in (0.9, 1.5, 3) for r in (0.1, 0.6)])
# beyond the critical angle light samples of Cycles 3.4 alone find light that no facet refracts, of which half is missing here
enter(
    "refraction",
    [surfaces.refraction("BECKMANN", r, IOR=ior) for ior in (1.1 if OLD else 0.9, 1.5, 3) for r in (0.1, 0.6)],
)
enter(
    "principled",
    [
        surfaces.principled({"distribution": "GGX"}, Roughness=r, Metallic=metallic)
        for metallic in (0, 1)
        for r in (0.1, 0.5, 1)
    ],
)
