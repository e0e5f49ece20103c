# SPDX-License-Identifier: GPL-3.0-or-later
"""Displacement where it moves nothing, Blender's default: Cycles makes a bump of it, from which all that has a normal begins."""

from stage import add, face_on, lamp, material, scene, sheet

from .surfaces import AMBER, GLOSSY, ROSE, SEA, WHITE, constant_light, on_balls, structured_light

BOUNCES = 3
SAMPLES, BLOCK = 24, 16


def noise(tree, output="Fac", scale=3.0):
    texture = add(tree, "TexNoise", Scale=scale, Vector=add(tree, "TexCoord").outputs["Object"])
    return texture.outputs[0 if output == "Fac" else output]


def displaced(shader, displacement):
    """`shader(tree)` and `displacement(tree)` make sockets."""

    def build(tree):
        output = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial")
        tree.links.new(displacement(tree), output.inputs["Displacement"])
        return shader(tree)

    return build


def shader(kind, settings=None, **inputs):
    return lambda tree: add(tree, kind, settings, **inputs).outputs[0]


def height(tree, space="OBJECT", **inputs):
    return add(tree, "Displacement", {"space": space}, Height=noise(tree), Scale=0.25, **inputs).outputs[0]


def vector(space, midlevel=0.0, moved=noise):
    return lambda tree: add(
        tree, "VectorDisplacement", {"space": space}, Vector=moved(tree, "Color"), Midlevel=midlevel, Scale=0.2
    ).outputs[0]


DIFFUSE = shader("BsdfDiffuse", Color=SEA)


@scene(bounces=BOUNCES)
def shaders():
    def anisotropic(tree):
        tangent = add(tree, "Tangent", {"direction_type": "RADIAL", "axis": "Y"}).outputs[0]
        return add(
            tree, "BsdfAnisotropic", {"distribution": "GGX"}, Roughness=0.4, Anisotropy=0.7, Tangent=tangent
        ).outputs[0]

    on_balls(
        *(
            displaced(made, height)
            for made in (
                DIFFUSE,
                shader("BsdfDiffuse", Color=ROSE, Roughness=0.8),
                shader(GLOSSY, Color=AMBER, Roughness=0.4),
                anisotropic,
                shader("BsdfTranslucent", Color=WHITE),
                shader("BsdfGlass", Color=SEA, Roughness=0.0, IOR=1.3),
                shader("BsdfGlass", Color=AMBER, Roughness=0.4, IOR=1.5),
                shader("BsdfPrincipled", Roughness=0.4),
                shader("BsdfPrincipled", Base_Color=AMBER, Metallic=1.0, Roughness=0.3),
            )
        )
    )


@scene(bounces=BOUNCES)
def displacements():
    """Of each node and space, and of what is no displacement at all."""

    def along(tree):
        normal = add(tree, "NewGeometry").outputs["Position"]
        return height(tree, "WORLD", Normal=normal, Midlevel=0.2)

    on_balls(
        *(
            displaced(DIFFUSE, made)
            for made in (
                lambda tree: height(tree, "WORLD"),
                along,
                vector("OBJECT"),
                vector("WORLD", 0.3),
                lambda tree: add(
                    tree, "VectorMath", {"operation": "SCALE"}, Vector=noise(tree, "Color"), Scale=0.3
                ).outputs[0],
                lambda tree: noise(tree, scale=1.0),
                lambda tree: add(tree, "Displacement", Height=0.7).outputs[0],
            )
        )
    )


@scene(bounces=BOUNCES)
def normals_upon_it():
    def bumped(tree):
        normal = add(tree, "Bump", Strength=0.5, Distance=0.1, Height=noise(tree, scale=9.0)).outputs[0]
        return add(tree, "BsdfPrincipled", Roughness=0.4, Normal=normal).outputs[0]

    def mapped(tree):
        normal = add(tree, "NormalMap", {"space": "WORLD"}, Color=(0.8, 0.3, 0.6, 1), Strength=0.4).outputs[0]
        return add(tree, "BsdfPrincipled", Roughness=0.4, Normal=normal).outputs[0]

    def told(kind, output, **inputs):
        return lambda tree: add(tree, "BsdfDiffuse", Color=add(tree, kind, **inputs).outputs[output]).outputs[0]

    def also_before(tree):
        """What the displacement reads before it bends the normal, the surface reads after that."""
        facing = add(tree, "LayerWeight", Blend=0.4).outputs["Facing"]
        return add(tree, "Displacement", Height=facing, Scale=0.3, Normal=noise(tree, "Color")).outputs[0]

    on_balls(
        displaced(bumped, height),
        displaced(mapped, height),
        displaced(told("Fresnel", 0, IOR=1.6), height),
        displaced(told("LayerWeight", "Facing"), height),
        displaced(told("NewGeometry", "Normal"), height),
        displaced(told("NewGeometry", "True Normal"), height),
        displaced(told("TexCoord", "Normal"), height),
        displaced(told("TexCoord", "Reflection"), height),
        displaced(told("LayerWeight", "Facing", Blend=0.4), also_before),
        surroundings=constant_light,
    )


@scene
def along_tangents():
    """Of a UV map, on sheets that face several ways."""
    face_on()
    structured_light()
    lamp("AREA", (-3, -5, 4), 350, (1, 0.9, 0.8), target=(0, 0, 0), size=6)

    def moved(tree, _output):
        return add(tree, "TexNoise", Scale=2.0, Vector=add(tree, "TexCoord").outputs["UV"]).outputs["Color"]

    for number in range(4):
        made, tree, output = material()
        tree.links.new(vector("TANGENT", 0.4, moved)(tree), output.inputs["Displacement"])
        tree.links.new(DIFFUSE(tree), output.inputs["Surface"])
        one = sheet(made, size=0.8)
        one.location = number % 2 * 2 - 1, number // 2 * 2 - 1, 0
        one.rotation_euler, one.scale = (0.5 * number, 0.3, 0.4 * number), (1, 1.2, 1)


@scene(samples=8)
def seen_from_behind():
    """By what vertices tell, by the place in a triangle, and by the place in space: heights are sampled beside the point."""

    def coloured(coordinate, displaced=False):
        made, tree, output = material(f"Behind by {coordinate}")
        texture = add(tree, "TexNoise", Scale=3.0)
        if coordinate == "Parametric":
            tree.links.new(add(tree, "NewGeometry").outputs[coordinate], texture.inputs["Vector"])
        else:
            tree.links.new(add(tree, "TexCoord").outputs[coordinate], texture.inputs["Vector"])
        half = add(tree, "VectorMath", {"operation": "MULTIPLY_ADD"})
        half.inputs[1].default_value = half.inputs[2].default_value = (0.5, 0.5, 0.5)
        if displaced:
            moved = add(tree, "Displacement", Height=texture.outputs[0], Scale=0.5).outputs[0]
            tree.links.new(moved, output.inputs["Displacement"])
            normal = add(tree, "NewGeometry").outputs["Normal"]
        else:
            normal = add(tree, "Bump", Height=texture.outputs[0], Distance=0.5).outputs[0]
        tree.links.new(normal, half.inputs[0])
        tree.links.new(add(tree, "Emission", Color=half.outputs[0]).outputs[0], output.inputs["Surface"])
        return made

    looks = [coloured(c) for c in ("UV", "Generated", "Parametric", "Object")] + [coloured("UV", displaced=True)]
    for k, look in enumerate(looks):
        for y, turned in ((-0.6, False), (0.6, True)):
            one = sheet(look, size=0.36)
            one.location = 0.78 * (k - 2), y, 0
            one.rotation_euler.x = 3.1415927 if turned else 0
    face_on()
