# SPDX-License-Identifier: GPL-3.0-or-later
"""Ward's reflection, which is another model's in Cycles: how far apart they may be, and that no light is lost; others beside it."""

import bpy
from stage import add as node
from stage import ball, box, camera, floor, lamp, material, scene, sky

OTHER_MODEL = "another model of reflection"


def things(kind, settings=None, **inputs):
    """A ball and a box of a material, under a lamp and a sky."""
    of, tree, output = material()
    shader = node(tree, kind, settings, **inputs)
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    floor()
    ball(of, location=(-1, 0, 1), fineness=96)
    box(of, location=(1.3, 0, 0.7), scale=(0.7, 0.7, 0.7))
    sky((0.4, 0.5, 0.6))
    lamp("AREA", (2, -3, 4), 200, size=1.5)
    camera()


def ward(**inputs):
    """The add-on's own node: Cycles shows it as a Beckmann lobe."""
    things("BsdfDiffuse")
    of = bpy.data.objects["Ball"].active_material
    tree = of.node_tree
    shader = tree.nodes.new("WardBSDFNode")
    for name, value in inputs.items():
        shader.inputs[name.replace("_", " ")].default_value = value
    tree.links.new(shader.outputs[0], tree.nodes["Material Output"].inputs["Surface"])


@scene
def nothing_but_a_thin_volume():
    """Whose surface is air; the volume scatters nothing."""
    things("VolumeScatter", Density=0.0)
    tree = bpy.data.objects["Ball"].active_material.node_tree
    output = tree.nodes["Material Output"]
    tree.links.new(output.inputs["Surface"].links[0].from_socket, output.inputs["Volume"])
    tree.links.remove(output.inputs["Surface"].links[0])
    bpy.data.objects["Box"].location.z += 0.1  # its bottom is to be no part of the floor


@scene
def ward_diffuse():
    """Without a specular part the node is Lambert's."""
    ward(Diffuse_Color=(0.7, 0.4, 0.2, 1), Specular_Color=(0, 0, 0, 1))


@scene(within=0.15, why=OTHER_MODEL)
def ward_rough():
    ward(Diffuse_Color=(0.3, 0.2, 0.1, 1), Specular_Color=(0.3, 0.3, 0.3, 1), Alpha_X=0.3, Alpha_Y=0.3)


@scene(within=0.15, why=OTHER_MODEL, samples=128)
def ward_smooth():
    ward(Diffuse_Color=(0.3, 0.2, 0.1, 1), Specular_Color=(0.3, 0.3, 0.3, 1), Alpha_X=0.05, Alpha_Y=0.05)


@scene
def glossy_beckmann():
    things(
        "BsdfGlossy" if bpy.app.version < (4, 0) else "BsdfAnisotropic",
        {"distribution": "BECKMANN"},
        Color=(0.7, 0.6, 0.3, 1),
        Roughness=0.4,
    )


@scene
def principled():
    things("BsdfPrincipled", Base_Color=(0.6, 0.3, 0.2, 1), Roughness=0.5)


@scene
def principled_metal():
    things("BsdfPrincipled", Base_Color=(0.8, 0.6, 0.3, 1), Roughness=0.4, Metallic=1.0)


@scene
def rough_diffuse_of_none():
    things("BsdfDiffuse", Color=(0.6, 0.3, 0.2, 1), Roughness=0.0)
