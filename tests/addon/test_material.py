# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader trees -> MaterialData, and the notes about what has no counterpart."""

import math
import tempfile
import unittest
from pathlib import Path

import bpy
import numpy as np
from wardmis import compat
from wardmis.export.context import ExportContext
from wardmis.export.image import export_image
from wardmis.export.material import export_material
from wardmis.export.program.folding import FOLDS

MAGENTA = (1.0, 0.0, 1.0)


class MaterialCase(unittest.TestCase):
    def setUp(self):
        for collection in (bpy.data.materials, bpy.data.images, bpy.data.node_groups):
            for block in collection:
                collection.remove(block)
        self.material = bpy.data.materials.new("M")
        self.material.use_nodes = True
        self.tree = self.material.node_tree
        self.tree.nodes.clear()
        self.output = self.tree.nodes.new("ShaderNodeOutputMaterial")
        self.context = ExportContext(export_image)
        self.context.owner = "O"

    def node(self, kind, tree=None, **inputs):
        """A node with constant inputs; keys are socket names with _ for a space, or i0, i1 ... for their index."""
        node = (tree or self.tree).nodes.new(kind)
        for key, value in inputs.items():
            socket = node.inputs[int(key[1:])] if key[1:].isdigit() else node.inputs[key.replace("_", " ")]
            socket.default_value = value
        if "Anisotropy" in node.inputs and "Anisotropy" not in inputs:
            node.inputs["Anisotropy"].default_value = 0.0  # 3.4 begins with 0.5
        return node

    def link(self, source, target, key=0, output=0):
        tree = source.id_data
        tree.links.new(source.outputs[output], target.inputs[key])

    def export(self, surface=None):
        if surface is not None:
            self.link(surface, self.output, "Surface")
        return export_material(self.material, self.context)

    def image(self, values, name="I", color_space="Non-Color", is_float=True):
        """A float image of rows from the bottom."""
        values = np.array(values, np.float32)
        image = bpy.data.images.new(name, values.shape[1], values.shape[0], float_buffer=is_float, alpha=True)
        image.colorspace_settings.name = color_space
        image.pixels.foreach_set(values.ravel())
        return image

    def texture(self, image):
        node = self.node("ShaderNodeTexImage")
        node.image = image
        node.interpolation = "Closest"  # baked images keep their size
        return node

    def assertRgb(self, found, expected):
        np.testing.assert_allclose(found, expected, rtol=1e-5, atol=1e-6)

    def closures(self, surface):
        """Of a material that is no short form."""
        data = self.export(surface)
        self.assertTrue(data.closures)
        self.assertRgb((*data.diffuse.value, *data.specular.value), [0.0] * 6)
        return data.closures

    def assertInputs(self, closure, **expected):
        """Of a closure: constants all."""
        for name, value in expected.items():
            with self.subTest(name):
                self.assertIsNone(getattr(closure.inputs[name], "result", None))
                self.assertRgb(closure.inputs[name].value, value)

    def assertNoted(self, *words):
        self.assertTrue(any(all(word in note for word in words) for note in self.context.notes), self.context.notes)


class Shaders(MaterialCase):
    def test_ward(self):
        node = self.node("WardBSDFNode", Diffuse_Color=(0.1, 0.2, 0.3, 1), Specular_Color=(0.4, 0.5, 0.6, 1))
        node.inputs["Alpha X"].default_value, node.inputs["Alpha Y"].default_value = 0.05, 0.3
        node.inputs["Rotation"].default_value = 0.25
        node.variant = "ward-dur"
        data = self.export(node)
        self.assertEqual((data.name, data.variant), ("M", "ward-dur"))
        self.assertRgb(data.diffuse.value, (0.1, 0.2, 0.3))
        self.assertRgb(data.specular.value, (0.4, 0.5, 0.6))
        self.assertRgb((data.alpha_x.value, data.alpha_y.value, data.rotation), (0.05, 0.3, math.pi / 2))
        self.assertEqual(self.context.notes, [])

    def test_diffuse(self):
        data = self.export(self.node("ShaderNodeBsdfDiffuse", Color=(0.1, 0.2, 0.3, 1)))
        self.assertRgb(data.diffuse.value, (0.1, 0.2, 0.3))
        self.assertRgb(data.specular.value, (0, 0, 0))
        self.assertEqual(self.context.notes, [])

    def test_rough_diffuse_is_a_closure(self):
        (rough,) = self.closures(self.node("ShaderNodeBsdfDiffuse", Color=(0.1, 0.2, 0.3, 1), Roughness=0.5))
        self.assertEqual((rough.type, rough.weight, rough.parameters), ("diffuse", None, {"version": compat.CYCLES}))
        self.assertInputs(rough, color=(0.1, 0.2, 0.3), roughness=0.5)
        self.assertEqual(self.context.notes, [])

    def test_glossy_under_every_name_that_this_blender_has(self):
        for kind in ("ShaderNodeBsdfGlossy", "ShaderNodeBsdfAnisotropic"):
            if not hasattr(bpy.types, kind):
                continue
            with self.subTest(kind):
                node = self.node(kind, Color=(0.5, 0.6, 0.7, 1), Roughness=0.3)
                node.distribution = "BECKMANN"
                (glossy,) = self.closures(node)
                self.assertEqual(glossy.type, "glossy")
                self.assertEqual(glossy.parameters, {"distribution": "beckmann", "version": compat.CYCLES})
                self.assertInputs(glossy, color=(0.5, 0.6, 0.7), alphaX=0.09, alphaY=0.09)

    def test_anisotropy_as_in_cycles(self):
        for anisotropy, expected in ((0.5, (0.045, 0.18)), (-0.5, (0.18, 0.045))):
            (glossy,) = self.closures(
                self.node("ShaderNodeBsdfAnisotropic", Roughness=0.3, Anisotropy=anisotropy, Rotation=0.5)
            )
            self.assertInputs(glossy, alphaX=expected[0], alphaY=expected[1], rotation=math.pi)
            self.assertIsNotNone(glossy.tangent)
        self.assertEqual(self.export().program.operations, [{"op": "tangent", "axis": "z"}])
        tangent = self.node("ShaderNodeTangent")
        tangent.direction_type, tangent.axis = "RADIAL", "X"
        self.link(tangent, self.output.inputs["Surface"].links[0].from_node, "Tangent")
        self.assertEqual(self.export().program.operations, [{"op": "tangent", "axis": "x"}])
        self.assertEqual(self.context.notes, [])

    def test_principled(self):
        node = self.node("ShaderNodeBsdfPrincipled", Base_Color=(0.8, 0.4, 0.2, 1), Metallic=0.25, Roughness=0.4)
        node.inputs[compat.PRINCIPLED_SPECULAR].default_value = 0.3
        node.inputs["IOR"].default_value = 1.6
        (principled,) = self.closures(node)
        self.assertEqual((principled.type, principled.weight), ("principled", None))
        self.assertEqual(principled.parameters["version"], compat.CYCLES)
        level = "specular" if compat.CYCLES == 3 else "specularIorLevel"
        self.assertInputs(principled, baseColor=(0.8, 0.4, 0.2), metallic=0.25, roughness=0.4, ior=1.6, **{level: 0.3})
        self.assertRgb(self.export().emission.value, (0, 0, 0))
        self.assertEqual(self.context.notes, [])

    def test_principled_has_every_input_of_its_node_or_names_it(self):
        node = self.node("ShaderNodeBsdfPrincipled", Emission_Strength=3.0, Alpha=0.5, Anisotropic=0.5)
        node.inputs[compat.PRINCIPLED_EMISSION].default_value = (0.5, 1, 2, 1)
        data = self.export(node)
        self.assertRgb(data.emission.value, (0.75, 1.5, 3))
        *transparent, principled = data.closures
        if compat.CYCLES == 3:  # where the node's alpha is a mix with a transparent one
            self.assertEqual([c.type for c in transparent], ["transparent"])
            self.assertRgb((*transparent[0].weight.value, *principled.weight.value), [0.5] * 6)
        else:
            self.assertEqual(transparent, [])
            self.assertInputs(principled, alpha=0.5)
        self.assertEqual(self.context.notes, [])
        given = {"Emission Strength", "Emission", "Emission Color", "Alpha", "Weight", "Tangent"}
        given |= {name for name in node.inputs.keys() if name.endswith("Normal")}  # noqa: SIM118  sockets
        # of what is named if it is there at all
        given |= {"Subsurface Radius", "Subsurface Scale", "Subsurface IOR", "Subsurface Anisotropy", "Thin Film IOR"}
        for socket in node.inputs:
            if socket.name in given or not hasattr(socket, "default_value") or socket.type == "BOOLEAN":
                continue
            with self.subTest(socket.name):
                self.context.notes.clear()
                before, old = self.export().closures[-1], socket.default_value
                old = tuple(old) if socket.type in {"RGBA", "VECTOR"} else old
                socket.default_value = 0.37 if isinstance(old, float) else [0.37] * len(old)
                after = self.export().closures[-1]
                changed = after.inputs != before.inputs
                named = any(f"'{socket.name}'" in note for note in self.context.notes)
                socket.default_value = old
                self.assertTrue(changed or named)

    def test_emission(self):
        data = self.export(self.node("ShaderNodeEmission", Color=(1, 0.5, 0.25, 1), Strength=8.0))
        self.assertRgb(data.emission.value, (8, 4, 2))
        self.assertEqual(data.uv_sets, set())

    def test_add_and_mix(self):
        diffuse = self.node("ShaderNodeBsdfDiffuse", Color=(0.4, 0.4, 0.4, 1))
        glossy = self.node("ShaderNodeBsdfAnisotropic", Color=(0.8, 0.8, 0.8, 1), Roughness=0.5)
        add, mix = self.node("ShaderNodeAddShader"), self.node("ShaderNodeMixShader", i0=0.25)
        for parent, first in ((add, 0), (mix, 1)):
            self.link(diffuse, parent, first)
            self.link(glossy, parent, first + 1)
        first, second = self.closures(add)
        self.assertEqual((first.type, first.weight, second.type, second.weight), ("diffuse", None, "glossy", None))
        self.assertInputs(first, color=[0.4] * 3)
        self.assertInputs(second, color=[0.8] * 3, alphaX=0.25)
        first, second = self.closures(mix)
        self.assertEqual((first.type, second.type), ("diffuse", "glossy"))
        self.assertRgb((*first.weight.value, *second.weight.value), [0.75] * 3 + [0.25] * 3)
        self.assertEqual(self.context.notes, [])

    def test_two_lobes_of_one_shape_add_exactly(self):
        add = self.node("ShaderNodeAddShader")
        for i in range(2):
            ward = self.node("WardBSDFNode", Diffuse_Color=(0.1, 0.1, 0.1, 1), Specular_Color=(0.3, 0.3, 0.3, 1))
            self.link(ward, add, i)
        data = self.export(add)
        self.assertEqual(data.closures, [])
        self.assertRgb((data.diffuse.value[0], *data.specular.value), (0.2, 0.6, 0.6, 0.6))
        self.assertEqual(self.context.notes, [])

    def test_without_nodes_the_viewport_color_is_diffuse(self):
        if bpy.app.version >= (5, 0, 0):
            self.skipTest("every material has nodes")
        self.material.use_nodes = False
        self.material.diffuse_color = (0.2, 0.4, 0.6, 1)
        self.assertRgb(self.export().diffuse.value, (0.2, 0.4, 0.6))
        self.material.metallic, self.material.roughness = 1.0, 0.5
        data = self.export()
        self.assertRgb(data.diffuse.value, (0, 0, 0))
        self.assertRgb((*data.specular.value, data.alpha_x.value), (0.2, 0.4, 0.6, 0.25))


class NotUnderstood(MaterialCase):
    def test_what_has_no_lobe_is_named_and_never_magenta(self):
        self.node("ShaderNodeRGB")
        for kind, rendered in (
            ("ShaderNodeSubsurfaceScattering", "diffuse"),
            ("ShaderNodeBsdfToon", "diffuse"),
            ("ShaderNodeBsdfHairPrincipled", "diffuse"),
        ):
            with self.subTest(kind):
                self.tree.nodes.remove(self.tree.nodes[-1])
                node = self.node(kind)
                node.name = "Odd one"
                self.assertNotEqual(self.export(node).diffuse.value, MAGENTA)
                expected = f"material 'M' on object 'O': node 'Odd one' ({node.bl_label}) is not supported; rendered as {rendered}"
                self.assertIn(expected, self.context.notes)

    def test_what_has_but_a_volume_is_air_and_named(self):
        volume = self.node("ShaderNodeVolumeScatter")
        output = next(node for node in self.tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial")
        self.tree.links.new(volume.outputs[0], output.inputs["Volume"])
        self.assertEqual([closure.type for closure in self.export().closures], ["transparent"])
        self.assertNoted("has a volume, which is not supported")
        self.assertFalse([note for note in self.context.notes if "no surface" in note])

    def test_nothing_is_black_as_in_cycles_and_named(self):
        self.assertRgb(self.export().diffuse.value, (0, 0, 0))
        self.assertNoted("no surface connected")
        shader = self.node("ShaderNodeBsdfDiffuse")
        shader.mute = True
        self.context.notes.clear()
        self.assertRgb(self.export(shader).diffuse.value, (0, 0, 0))
        self.assertNoted("no surface connected")
        self.tree.nodes.clear()
        self.assertRgb(self.export().diffuse.value, (0, 0, 0))
        self.assertNoted("no output node")

    def test_nodes_in_a_circle_are_black_as_in_cycles_and_named(self):
        mix = self.node("ShaderNodeMixShader")
        self.tree.links.new(mix.outputs[0], mix.inputs[1])
        self.assertRgb(self.export(mix).diffuse.value, (0, 0, 0))
        self.assertNoted("linked in a circle")

    def test_long_chains_of_nodes_are_no_circles(self):
        """Of more nodes than Python commonly has calls within each other."""
        last = self.node("ShaderNodeTexCoord").outputs["Generated"]
        for _ in range(300):
            node = self.node("ShaderNodeMath", i1=0.01)
            self.tree.links.new(last, node.inputs[0])
            last = node.outputs[0]
        shader = self.node("ShaderNodeBsdfDiffuse")
        self.tree.links.new(last, shader.inputs["Color"])
        self.assertEqual(len(self.export(shader).program.operations), 303)
        self.assertEqual(self.context.notes, [])

    def test_muted_output_is_black_and_named(self):
        self.output.mute = True
        if not self.output.mute:
            self.skipTest("this Blender's outputs cannot be muted")
        self.assertRgb(self.export(self.node("ShaderNodeBsdfDiffuse")).diffuse.value, (0, 0, 0))
        self.assertNoted("no output node that is not muted")

    def test_numbers_that_are_not_finite_are_magenta_and_named(self):
        ward = self.node("WardBSDFNode")
        ward.inputs["Rotation"].default_value = math.nan
        alpha = self.node("WardBSDFNode")
        alpha.inputs["Alpha X"].default_value = math.nan
        huge = self.node("ShaderNodeEmission", Color=(1e38, 1, 1, 1), Strength=1e38)
        for node, name in (
            (self.node("ShaderNodeBsdfDiffuse", Color=(math.nan, 1, 1, 1)), "has a 'Color'"),
            (ward, "has a 'Rotation'"),
            (alpha, "has a 'Alpha X'"),
            (huge, "its emission"),
        ):
            with self.subTest(name):
                self.context.notes.clear()
                data = self.export(node)
                self.assertRgb(data.diffuse.value, MAGENTA)
                self.assertFalse(any(data.emission.value))
                self.assertNoted("material 'M' on object 'O'", name, "not a finite number")
        self.material.use_nodes = False
        self.material.diffuse_color = (1, math.nan, 1, 1)
        self.assertRgb(self.export().diffuse.value, MAGENTA)

    def test_missing_images_are_magenta_and_named(self):
        diffuse = self.node("ShaderNodeBsdfDiffuse")
        texture = self.texture(None)
        self.link(texture, diffuse, "Color")
        self.assertRgb(self.export(diffuse).diffuse.value, MAGENTA)
        self.assertNoted("has no image")
        image = bpy.data.images.new("Lost", 1, 1)
        image.source, image.filepath = "FILE", "//nowhere/lost.png"
        texture.image = image
        data = self.export(diffuse)
        self.assertRgb(data.diffuse.value, MAGENTA)
        self.assertIsNone(data.diffuse.texture)
        self.assertNoted("material 'M'", "'Lost'", "lost.png", "missing")

    def test_light_of_missing_images_is_magenta(self):
        texture = self.texture(None)
        diffuse, emission = self.node("ShaderNodeBsdfDiffuse"), self.node("ShaderNodeEmission")
        both = self.node("ShaderNodeAddShader")
        self.link(texture, diffuse, "Color")
        self.link(texture, emission, "Color")
        self.link(diffuse, both, 0)
        self.link(emission, both, 1)
        data = self.export(both)
        self.assertRgb(data.diffuse.value, MAGENTA)
        self.assertRgb(data.emission.value, MAGENTA)
        self.assertNoted("has no image", "magenta")

    def test_what_cannot_be_said_is_neutral_and_noted(self):
        diffuse = self.node("ShaderNodeBsdfDiffuse", Color=(0.1, 0.2, 0.3, 1))
        occlusion = self.node("ShaderNodeAmbientOcclusion", Color=(0.3, 0.4, 0.5, 1))
        for node, output, expected in (
            (occlusion, "Color", (0.3, 0.4, 0.5)),
            (occlusion, "AO", (1, 1, 1)),
            (self.node("ShaderNodeWireframe"), 0, (0, 0, 0)),
        ):
            with self.subTest(node.bl_idname):
                self.context.notes.clear()
                self.link(node, diffuse, "Color", output)
                self.assertRgb(self.export(diffuse).diffuse.value, expected)
                self.assertNoted(f"({node.bl_label}) is not supported as a colour or number", "instead")

    def test_every_node_that_gives_a_value_is_understood_or_has_a_neutral_one(self):
        from wardmis.export.program.neutral import NEUTRAL
        from wardmis.export.program.nodes import NODES

        # Cycles does not know them, or they are the ends of trees, or need a script
        others = {"Script", "ShaderToRGB", "UVAlongStroke", "Squeeze", "Output", "Holdout", "EeveeSpecular", "Custom"}
        for name in dir(bpy.types):
            if not name.startswith("ShaderNode") or any(other in name for other in others):
                continue
            try:
                node = self.tree.nodes.new(name)
            except RuntimeError:
                continue  # the name of a kind of nodes
            if any(socket.type in {"VALUE", "RGBA", "VECTOR"} for socket in node.outputs):
                with self.subTest(name):
                    self.assertIn(name, NODES | NEUTRAL)

    def test_parts_of_shaders_that_are_left_out_are_named_where_they_are_there(self):
        for kind, name, words in (
            ("ShaderNodeBsdfPrincipled", "Subsurface", "rendered as diffuse"),
            ("ShaderNodeBsdfPrincipled", "Subsurface Weight", "rendered as diffuse"),
            ("ShaderNodeBsdfPrincipled", "Thin Film Thickness", "left out"),
            ("ShaderNodeBsdfGlass", "Thin Film Thickness", "left out"),
            ("ShaderNodeBsdfMetallic", "Thin Film Thickness", "left out"),
        ):
            node = self.node(kind) if hasattr(bpy.types, kind) else None
            if node is None or name not in node.inputs:
                continue
            with self.subTest(f"{kind} {name}"):
                self.context.notes.clear()
                self.export(node)
                self.assertEqual(self.context.notes, [])
                node.inputs[name].default_value = 0.5
                self.export()
                self.assertEqual(len(self.context.notes), 1)
                self.assertNoted(f"has a '{name}'" if "Film" in name else f"has '{name}'", words)
                if "Thin Wall" in node.inputs and "Film" not in name:
                    node.inputs["Thin Wall"].default_value = True
                    self.context.notes.clear()
                    self.assertIs(self.export().closures[0].parameters["thinWall"], True)
                    self.assertEqual(self.context.notes, [])

    def test_metals(self):
        if not hasattr(bpy.types, "ShaderNodeBsdfMetallic"):
            self.skipTest("came with Blender 4.3")
        metal = self.node(
            "ShaderNodeBsdfMetallic", Base_Color=(0.9, 0.6, 0.3, 1), Edge_Tint=(1, 0.9, 0.8, 1), Roughness=0.3
        )
        metal.distribution, metal.fresnel_type = "MULTI_GGX", "F82"
        (f82,) = self.closures(metal)
        self.assertInputs(f82, baseColor=(0.9, 0.6, 0.3), specularTint=(1, 0.9, 0.8), metallic=1.0, roughness=0.3)
        self.assertEqual(self.context.notes, [])
        # without extinction it is a dielectric: of index 1.5, 0.04 straight on
        metal.fresnel_type = "PHYSICAL_CONDUCTOR"
        metal.inputs["IOR"].default_value, metal.inputs["Extinction"].default_value = [1.5] * 3, [0.0] * 3
        (physical,) = self.export().closures
        self.assertNoted("physical Fresnel")
        inside = math.sqrt(1 - (1 - 1 / 49) / 2.25)
        s, t = (1 / 7 - 1.5 * inside) / (1 / 7 + 1.5 * inside), (inside - 1.5 / 7) / (inside + 1.5 / 7)
        edge = 0.5 * (s * s + t * t) / (0.04 + 0.96 * (6 / 7) ** 5)
        self.assertInputs(physical, baseColor=[0.04] * 3, specularTint=[edge] * 3)

    def test_volumes_are_noted(self):
        self.link(self.node("ShaderNodeVolumeScatter"), self.output, "Volume")
        self.export(self.node("ShaderNodeBsdfDiffuse"))
        self.assertNoted("volume")

    def test_displacement_bends_the_normal(self):
        displacement = self.node("ShaderNodeDisplacement")
        self.link(self.node("ShaderNodeTexNoise"), displacement, "Height")
        self.link(displacement, self.output, "Displacement")
        glossy = self.node("ShaderNodeBsdfGlossy" if compat.CYCLES == 3 else "ShaderNodeBsdfAnisotropic")
        self.link(self.node("ShaderNodeNewGeometry"), glossy, "Color", "Normal")
        data = self.export(glossy)
        names = [o["op"] for o in data.program.operations]
        self.assertEqual(names[names.index("bend") - 1], "bump")
        self.assertIsNone(data.closures[0].normal)
        # what is read afterwards is not what the height was told along
        self.assertEqual([i > names.index("bend") for i, name in enumerate(names) if name == "normal"], [False, True])
        self.assertEqual(data.closures[0].inputs["color"].result, len(names) - 1)
        self.assertEqual(self.context.notes, [])

    def test_a_displacement_that_moves_the_surface_is_noted(self):
        self.link(self.node("ShaderNodeTexNoise"), self.output, "Displacement")
        owner = self.material if hasattr(self.material, "displacement_method") else self.material.cycles
        for method, moves in (("BUMP", False), ("DISPLACEMENT", True), ("BOTH", True)):
            with self.subTest(method):
                owner.displacement_method = method
                self.context.notes.clear()
                data = self.export(self.node("ShaderNodeBsdfDiffuse"))
                self.assertTrue(data.program.reads("bend"))
                self.assertEqual(any("moves the surface" in note for note in self.context.notes), moves)

    def test_a_displacement_of_nothing_costs_nothing(self):
        self.link(self.node("ShaderNodeDisplacement", Height=0.7), self.output, "Displacement")
        data = self.export(self.node("ShaderNodeBsdfDiffuse"))
        self.assertEqual(data.program is None, compat.CYCLES > 3)  # 3.4 turns normals towards the viewer


class Trees(MaterialCase):
    def test_reroutes_mutes_and_groups(self):
        group = bpy.data.node_groups.new("G", "ShaderNodeTree")
        compat.add_group_socket(group, "Paint", "NodeSocketColor", "INPUT").default_value = (0.9, 0, 0, 1)
        compat.add_group_socket(group, "Shader", "NodeSocketShader", "OUTPUT")
        given, result = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
        diffuse, reroute = group.nodes.new("ShaderNodeBsdfDiffuse"), group.nodes.new("NodeReroute")
        gamma = self.node("ShaderNodeGamma", group, Gamma=3.0)
        gamma.mute = True
        for source, target, key in (
            (given, gamma, "Color"),
            (gamma, reroute, 0),
            (reroute, diffuse, "Color"),
            (diffuse, result, 0),
        ):
            self.link(source, target, key)
        first, second = (self.tree.nodes.new("ShaderNodeGroup") for _ in range(2))
        first.node_tree = second.node_tree = group
        green = self.node("ShaderNodeRGB")
        green.outputs[0].default_value = (0, 0.5, 0, 1)
        self.link(green, first, 0)
        mix = self.node("ShaderNodeMixShader", i0=0.5)
        self.link(first, mix, 1)
        self.link(second, mix, 2)
        self.assertRgb(self.export(mix).diffuse.value, (0.45, 0.25, 0))
        self.assertEqual(self.context.notes, [])

    def test_muted_link_and_muted_shader_are_black(self):
        mix, diffuse = (
            self.node("ShaderNodeMixShader", i0=0.5),
            self.node("ShaderNodeBsdfDiffuse", Color=(0.4, 0.4, 0.4, 1)),
        )
        emission = self.node("ShaderNodeEmission")
        emission.mute = True
        self.link(diffuse, mix, 1)
        self.link(emission, mix, 2)
        data = self.export(mix)
        self.assertRgb((data.diffuse.value[0], data.emission.value[0]), (0.2, 0))

    def test_the_output_that_cycles_takes(self):
        self.link(self.node("ShaderNodeBsdfDiffuse", Color=(0.1, 0.1, 0.1, 1)), self.output, "Surface")
        self.output.target = "EEVEE"
        other = self.node("ShaderNodeOutputMaterial")
        other.target = "CYCLES"
        self.link(self.node("ShaderNodeBsdfDiffuse", Color=(0.7, 0.7, 0.7, 1)), other, "Surface")
        self.assertRgb(self.export().diffuse.value, (0.7, 0.7, 0.7))

    def test_groups_that_their_file_lacks_give_nothing_and_are_named(self):
        group = bpy.data.node_groups.new("Borrowed", "ShaderNodeTree")
        compat.add_group_socket(group, "Shader", "NodeSocketShader", "OUTPUT")
        self.link(group.nodes.new("ShaderNodeBsdfDiffuse"), group.nodes.new("NodeGroupOutput"))
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "library.blend"
            bpy.data.libraries.write(str(path), {group})
            bpy.data.node_groups.remove(group)
            with bpy.data.libraries.load(str(path), link=True) as (_, wanted):
                wanted.node_groups = ["Borrowed"]
            library = bpy.data.libraries[-1]
            user = self.tree.nodes.new("ShaderNodeGroup")
            user.node_tree = wanted.node_groups[0]
            self.link(user, self.output, "Surface")
            bpy.data.libraries.write(str(path), {bpy.data.node_groups.new("Another", "ShaderNodeTree")})
            library.reload()
        data = self.export()
        self.assertRgb((*data.diffuse.value, *data.specular.value, *data.emission.value), [0] * 9)
        self.assertNoted("M", "Borrowed", "library.blend")
        bpy.data.libraries.remove(library)

    def test_color_in_a_shaders_place_shines(self):
        rgb = self.node("ShaderNodeRGB")
        rgb.outputs[0].default_value = (1, 2, 3, 1)
        self.assertRgb(self.export(rgb).emission.value, (1, 2, 3))


class Values(MaterialCase):
    def of(self, node, output=0):
        diffuse = self.node("ShaderNodeBsdfDiffuse")
        self.link(node, diffuse, "Color", output)
        return self.export(diffuse).diffuse

    def pixels(self, color_input):
        return self.context.images[self.context.textures[color_input.texture.index].image].pixels

    def test_math_of_constants(self):
        node = self.node("ShaderNodeMath", i0=0.5, i1=0.25)
        for operation, expected in (
            ("ADD", 0.75),
            ("SUBTRACT", 0.25),
            ("MULTIPLY", 0.125),
            ("DIVIDE", 2.0),
            ("POWER", 0.5**0.25),
        ):
            node.operation = operation
            self.assertRgb(self.of(node).value, [expected] * 3)
        node.operation, node.inputs[1].default_value = "DIVIDE", 0.0
        self.assertRgb(self.of(node).value, (0, 0, 0))

    def test_mix_gamma_invert_and_channels_of_constants(self):
        mix = self.node("ShaderNodeMixRGB", i0=0.25, i1=(1, 0, 0, 1), i2=(0, 1, 0, 1))
        self.assertRgb(self.of(mix).value, (0.75, 0.25, 0))
        mix.blend_type = "ADD"
        self.assertRgb(self.of(mix).value, (1, 0.25, 0))
        new_mix = self.node("ShaderNodeMix")
        new_mix.data_type = "RGBA"
        enabled = [socket for socket in new_mix.inputs if socket.enabled]
        for socket, value in zip(enabled, (0.5, (1, 0, 0, 1), (0, 0, 1, 1))):
            socket.default_value = value
        self.assertRgb(self.of(new_mix, [o.enabled for o in new_mix.outputs].index(True)).value, (0.5, 0, 0.5))
        self.assertRgb(
            self.of(self.node("ShaderNodeGamma", Color=(0.5, 0.25, 1, 1), Gamma=2.0)).value, (0.25, 0.0625, 1)
        )
        self.assertRgb(self.of(self.node("ShaderNodeInvert", Color=(0.2, 0.3, 0.4, 1))).value, (0.8, 0.7, 0.6))
        separate = self.node("ShaderNodeSeparateColor", i0=(0.1, 0.2, 0.3, 1))
        self.assertRgb(self.of(separate, 1).value, (0.2, 0.2, 0.2))
        self.assertRgb(self.of(self.node("ShaderNodeCombineColor", i0=0.1, i1=0.2, i2=0.3)).value, (0.1, 0.2, 0.3))

    def test_number_from_a_color_is_its_luminance(self):
        glossy, rgb = self.node("ShaderNodeBsdfAnisotropic"), self.node("ShaderNodeRGB")
        rgb.outputs[0].default_value = (0, 1, 0, 1)
        self.link(rgb, glossy, "Roughness")
        self.assertInputs(self.closures(glossy)[0], alphaX=(0.7151522 if compat.CYCLES < 5 else 0.7151687) ** 2)

    def test_plain_texture_is_handed_on_as_it_is(self):
        image = self.image([[(0.1, 0.2, 0.3, 1), (0.4, 0.5, 0.6, 1)]])
        found = self.of(self.texture(image))
        self.assertRgb(found.value, (1, 1, 1))
        np.testing.assert_allclose(self.pixels(found)[0, :, :3], [(0.1, 0.2, 0.3), (0.4, 0.5, 0.6)], rtol=1e-6)
        self.assertEqual(found.texture.transform, (1, 0, 0, 0, 1, 0))

    def test_mix_shader_scales_a_texture_without_a_new_image(self):
        image = self.image([[(0.1, 0.2, 0.3, 1)]])
        diffuse, mix = self.node("ShaderNodeBsdfDiffuse"), self.node("ShaderNodeMixShader", i0=0.25)
        self.link(self.texture(image), diffuse, "Color")
        self.link(diffuse, mix, 1)
        data = self.export(mix)
        self.assertRgb(data.diffuse.value, (0.75, 0.75, 0.75))
        self.assertEqual(self.context.images[0].name, "I")

    def test_nodes_behind_a_texture_become_a_program(self):
        texture, gamma = self.texture(self.image([[(0.25, 0.5, 1, 1)]])), self.node("ShaderNodeGamma", Gamma=2.0)
        self.link(texture, gamma, "Color")
        diffuse = self.node("ShaderNodeBsdfDiffuse")
        self.link(gamma, diffuse, "Color")
        data = self.export(diffuse)
        self.assertEqual(
            data.program.operations,
            [
                {"op": "uv"},
                {"op": "image", "in": [{"result": 0}], "texture": 0},
                {"op": "gamma", "in": [{"result": 1}, 2.0]},
            ],
        )
        self.assertEqual((data.diffuse.value, data.diffuse.result, data.diffuse.texture), ((1, 1, 1), 2, None))
        self.assertEqual(self.context.notes, [])

    def test_alpha_output_of_an_image_divides_its_colors_after_they_are_filtered(self):
        image = self.image([[(0.5, 0.5, 0.5, 0.25)]], color_space="sRGB", is_float=False)
        emission, texture = self.node("ShaderNodeEmission"), self.texture(image)
        self.link(texture, emission, "Color")
        self.link(texture, emission, "Strength", "Alpha")
        names = {o["op"]: o for o in self.export(emission).program.operations}
        self.assertTrue(names["image"]["unassociate"] and names["image-alpha"]["unassociate"])
        self.assertTrue(self.context.images[0].pixels[0, 0, 0] < 64)  # they are multiplied before

    def test_every_node_may_stand_behind_an_image_with_alpha(self):
        """Whether an image's alpha counts is found by what Cycles folds, of operations with as many inputs as they have."""
        image = self.image([[(0.5, 0.5, 0.5, 0.25)]], color_space="sRGB", is_float=False)
        self.assertEqual(image.alpha_mode, "STRAIGHT")
        texture = self.texture(image)
        for kind in FOLDS:
            probe = self.node(kind)
            settings = [("", "")]
            for name in ("operation", "blend_type", "data_type"):
                settings += [
                    (name, item.identifier) for item in getattr(probe.bl_rna.properties.get(name), "enum_items", ())
                ]
            for name, value in settings:
                with self.subTest(kind=kind, **{name: value}):
                    if name:
                        try:
                            setattr(probe, name, value)
                        except TypeError:  # of other kinds of trees
                            continue
                    self.tree.links.clear()
                    for socket in probe.inputs:
                        if socket.enabled:
                            self.tree.links.new(texture.outputs["Color"], socket)
                    output = next(o for o in probe.outputs if o.enabled)
                    self.tree.links.new(output, self.output.inputs["Surface"])
                    export_material(self.material, ExportContext(export_image))
            self.tree.nodes.remove(probe)

    def test_bump_has_its_height_at_three_places(self):
        diffuse, bump = self.node("ShaderNodeBsdfDiffuse"), self.node("ShaderNodeBump")
        self.link(self.node("ShaderNodeTexNoise"), bump, "Height")
        self.link(bump, diffuse, "Normal")
        data = self.export(diffuse)
        places = [o.get("shift", "none") for o in data.program.operations if o["op"] == "generated"]
        self.assertEqual(sorted(places), ["none", "x", "y"])
        self.assertEqual(data.program.operations[data.closures[0].normal.result]["op"], "bump")

    def test_ward_with_a_normal_keeps_its_short_form(self):
        ward = self.node("WardBSDFNode")
        self.link(self.node("ShaderNodeBump"), ward, "Normal")
        self.link(self.node("ShaderNodeTexNoise"), self.tree.nodes["Bump"], "Height")
        data = self.export(ward)
        self.assertEqual(data.closures, [])
        self.assertEqual(data.program.operations[data.normal.result]["op"], "bump")

    def test_uv_mapping(self):
        image = self.image([[(1, 1, 1, 1)]])
        texture, mapping = self.texture(image), self.node("ShaderNodeMapping")
        mapping.inputs["Location"].default_value = (0.1, 0.2, 0)
        mapping.inputs["Rotation"].default_value = (0, 0, math.pi / 2)
        mapping.inputs["Scale"].default_value = (2, 3, 1)
        self.link(mapping, texture, "Vector")
        coordinates = self.node("ShaderNodeTexCoord")
        self.link(coordinates, mapping, "Vector", "UV")
        # (u, v) is scaled, turned by a quarter, moved: u' = -3 v + 0.1, v' = 2 u + 0.2
        np.testing.assert_allclose(self.of(texture).texture.transform, (0, -3, 0.1, 2, 0, 0.2), atol=1e-6)
        mapping.vector_type = "TEXTURE"
        # the inverse: u = (v' - 0.2)/2 ..., v = -(u' - 0.1)/3
        np.testing.assert_allclose(self.of(texture).texture.transform, (0, 0.5, -0.1, -1 / 3, 0, 0.1 / 3), atol=1e-6)
        mapping.vector_type = "VECTOR"  # without its location
        np.testing.assert_allclose(self.of(texture).texture.transform, (0, -3, 0, 2, 0, 0), atol=1e-6)
        own = texture.texture_mapping
        own.translation, own.scale, own.mapping_x, own.mapping_y = (0.5, 0, 0), (4, 1, 1), "Y", "X"
        # (-3 v, 2 u) is swapped, scaled and moved
        np.testing.assert_allclose(self.of(texture).texture.transform, (8, 0, 0.5, 0, -3, 0), atol=1e-6)
        self.assertEqual(self.context.notes, [])
        mapping.vector_type = "NORMAL"
        self.assertIsNone(self.of(texture).texture)  # that is a program
