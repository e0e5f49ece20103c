# SPDX-License-Identifier: GPL-3.0-or-later
"""Each lobe on a plane, seen at angles from 0 to 89 degrees, under a constant and under a structured light.

The image's blocks are planes of their own: to the right at larger angles, downwards of the shaders given. They are seen by the camera
alone, so that each is lit as if it were the only one."""

import math

from stage import camera, material, mesh, scene, square
from wardmis import compat

from scenes import surfaces

DEGREES = (0, 20, 40, 55, 68, 78, 85, 89)
ROUGHNESSES = (0, 0.1, 0.25, 0.5, 0.75, 1)
OLD = compat.CYCLES == 3
SAMPLES = 16
SELDOM = {"matte_structured"}  # and what enter() adds


def on_planes(rows, degrees_of_columns):
    for row, build in enumerate(rows):
        of, tree, output = material()
        tree.links.new(build(tree), output.inputs["Surface"])
        for column, degrees in enumerate(degrees_of_columns):
            made = mesh("Plane", *square(0.5), of)
            made.location = column - 3.5, 2.5 - row, 0
            made.rotation_euler = 0, math.radians(degrees), 0
            made.scale = 1 / math.cos(math.radians(degrees)), 1, 1
            for ray in ("diffuse", "glossy", "transmission", "volume_scatter", "shadow"):
                setattr(made, f"visible_{ray}", False)
    seen = camera((0, 0, 100), (0, 0, 0))
    seen.rotation_euler = 0, 0, 0
    seen.data.type, seen.data.ortho_scale, seen.data.clip_end = "ORTHO", 8, 200


def enter(name, rows, *, degrees=DEGREES, seldom=True, **more):
    """Under both lights; `seldom` of both. `rows`: at most six."""

    def constant():
        on_planes(rows, degrees)
        surfaces.constant_light()

    def structured():
        on_planes(rows, degrees)
        surfaces.structured_light()

    for light in (constant, structured):
        light.__name__ = f"{name}_{light.__name__}"
        if seldom:
            SELDOM.add(light.__name__)
        scene(**more)(light)


def sheen(roughness):
    if OLD:
        return surfaces.shader("BsdfVelvet", Color=surfaces.ROSE, Sigma=roughness)
    return surfaces.sheen("MICROFIBER", roughness, surfaces.ROSE)


def of_indices(kind, distribution, indices, roughnesses):
    return [kind(distribution, r, IOR=ior) for ior in indices for r in roughnesses]


# the walk from facet to facet of Cycles 3.4 goes wrong where the view is along the normal itself
WALK = {**surfaces.MANY_OF_3_4, "degrees": (2, *DEGREES[1:])} if OLD else {}


def matte(roughness):
    return surfaces.shader("BsdfDiffuse", Color=surfaces.AMBER, Roughness=roughness)


PAPER = surfaces.shader("BsdfTranslucent", Color=surfaces.SEA)
enter(
    "matte", [*map(matte, (0, 0.5, 1)), *map(sheen, (0.1, 0.5, 1))], seldom=False, samples=192
)  # cloth shines at grazing angles
enter(
    "paper",
    [
        PAPER,
        surfaces.mixed(0.4, PAPER, matte(1)),
        *([] if OLD else [surfaces.sheen("ASHIKHMIN", r) for r in (0.1, 0.3, 1)]),
    ],
    samples=192,
)
for kind in ("GGX", "BECKMANN", "ASHIKHMIN_SHIRLEY"):
    enter(kind.lower(), [surfaces.glossy(kind, r) for r in ROUGHNESSES], seldom=kind == "BECKMANN")
enter("multi_ggx", [surfaces.glossy("MULTI_GGX", r) for r in ROUGHNESSES], seldom=False, **WALK)
ANISOTROPIES = (0.1, 0.9), (0.4, 0.5), (0.4, 0.9), (0.8, -0.7)
enter("anisotropic", [surfaces.glossy("GGX", r, a, 0.1) for r, a in ANISOTROPIES])
enter("anisotropic_ashikhmin", [surfaces.glossy("ASHIKHMIN_SHIRLEY", r, a, 0.1) for r, a in ANISOTROPIES])
enter("anisotropic_beckmann", [surfaces.glossy("BECKMANN", r, a, 0.1) for r, a in ANISOTROPIES], **surfaces.ONE_AXIS)
enter("anisotropic_multi_ggx", [surfaces.glossy("MULTI_GGX", r, a, 0.1) for r, a in ANISOTROPIES], without=(3, 4))

enter("glass", of_indices(surfaces.glass, "GGX", (0.9, 1.5, 3), (0.1, 0.6)), seldom=False)
enter("glass_ggx", of_indices(surfaces.glass, "GGX", (0.9, 1.05, 3), (0.3, 1)))
enter("glass_beckmann", of_indices(surfaces.glass, "BECKMANN", (0.9, 1.05, 1.5), (0.3, 1)))
enter("glass_multi_ggx", of_indices(surfaces.glass, "MULTI_GGX", (0.9, 1.05, 1.5), (0.3, 1)), without=(3, 4))
enter("refraction", of_indices(surfaces.refraction, "BECKMANN", (0.9, 1.5, 3), (0.1, 0.6)), seldom=False)
enter("refraction_ggx", of_indices(surfaces.refraction, "GGX", (0.9, 1.05, 3), (0.3, 1)))
enter(
    "sharp",
    [
        *(surfaces.glass("GGX", 0, IOR=ior) for ior in (0.9, 1.05, 3)),
        *(surfaces.refraction("GGX", 0, IOR=ior) for ior in (0.9, 3)),
        surfaces.refraction("BECKMANN", 0.5, IOR=1.01),
    ],
)

GGX, MULTI_GGX = {"distribution": "GGX"}, {"distribution": "MULTI_GGX"}
SHINES = [{"Metallic": metallic, "Roughness": r} for metallic in (0, 1) for r in (0.1, 0.5, 1)]
enter("principled", [surfaces.principled(GGX, **shine) for shine in SHINES], seldom=False)
enter(
    "principled_multiple",
    [surfaces.principled(MULTI_GGX, **shine) for shine in SHINES],
    **WALK | ({"within": 0.12} if OLD else {}),
)
enter(
    "principled_glass",
    [surfaces.named(transmission=1, IOR=ior, Roughness=r) for ior in (0.9, 1.5) for r in (0.1, 0.5, 1)],
)
enter("principled_coat", [surfaces.named(coat=1, coat_roughness=r, Roughness=1) for r in (0, 0.1, 0.3, 0.6, 1)])
enter("principled_sheen", [surfaces.named(sheen=1, **{} if OLD else {"Sheen_Roughness": r}) for r in (0.1, 0.5, 1)])
enter("metals", [surfaces.metal(d, r) for d in ("GGX", "MULTI_GGX") for r in (0.1, 0.5, 1)], since=(4, 3))
enter(
    "thin_walls",
    [
        *(surfaces.named(Thin_Wall=True, transmission=1, Roughness=r) for r in (0, 0.3, 1)),
        surfaces.named(Thin_Wall=True, transmission=1, IOR=1.1, Roughness=0.5),
        *(
            surfaces.named(Thin_Wall=True, Subsurface_Weight=1, Subsurface_Anisotropy=a, Diffuse_Roughness=a)
            for a in (0, 0.6)
        ),
    ],
    since=(5, 2),
)
