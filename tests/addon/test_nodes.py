# SPDX-License-Identifier: GPL-3.0-or-later
"""The Ward BSDF node: its life in a file, and that its inside is what it says in Cycles."""

import os
import tempfile
import unittest
from types import SimpleNamespace

import bpy
import numpy as np
from wardmis import compat, nodes
from wardmis.export.program.closures import SHADERS


def trees():
    return [tree for tree in bpy.data.node_groups if tree.name.startswith(nodes.TREE_NAME)]


def ward_material(name="Ward"):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node = tree.nodes.new("WardBSDFNode")
    tree.links.new(node.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material, node


def render_with_cycles(samples, path):
    """The pixels of the scene, linear, (height, width, 4). Writes `path`.exr."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = samples
    scene.cycles.use_denoising = False
    scene.cycles.use_adaptive_sampling = False
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth = "OPEN_EXR", "32"
    scene.render.filepath = f"{path}.exr"
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(image.size[1], image.size[0], -1)


class Recorder:
    """A layout that remembers its operators."""

    def __init__(self):
        self.items = []

    def operator(self, _name, text):
        self.items.append(SimpleNamespace(text=text))
        return self.items[-1]


class Node(unittest.TestCase):
    def setUp(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.ops.preferences.addon_enable(module="wardmis")
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = os.path.join(folder.name, "test")

    def test_new_node_has_the_documented_inputs_and_defaults(self):
        _, node = ward_material()
        self.assertEqual([socket.name for socket in node.inputs], [name for name, *_ in nodes.INPUTS])
        self.assertEqual(node.variant, "ward-gmd")
        self.assertAlmostEqual(node.inputs["Alpha X"].default_value, 0.1)
        self.assertTrue(node.inputs["Normal"].hide_value)

    def test_nodes_and_copies_share_one_tree_that_goes_with_the_last(self):
        material, node = ward_material()
        second = material.node_tree.nodes.new("WardBSDFNode")
        copy = material.copy()
        self.assertEqual(len(trees()), 1)
        material.node_tree.nodes.remove(second)
        material.node_tree.nodes.remove(node)
        self.assertEqual(len(trees()), 1)
        for left in [n for n in copy.node_tree.nodes if n.bl_idname == "WardBSDFNode"]:
            copy.node_tree.nodes.remove(left)
        self.assertEqual(trees(), [])

    def test_node_survives_saving_and_appending(self):
        _, node = ward_material()
        node.variant = "ward-dur"
        node.inputs["Alpha Y"].default_value = 0.25
        bpy.data.materials["Ward"].use_fake_user = True
        path = f"{self.path}.blend"
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.read_factory_settings(use_empty=True)
        with bpy.data.libraries.load(path) as (_, wanted):
            wanted.materials = ["Ward"]
        appended = bpy.data.materials["Ward"].node_tree.nodes["Ward BSDF"]
        self.assertEqual(appended.variant, "ward-dur")
        self.assertAlmostEqual(appended.inputs["Alpha Y"].default_value, 0.25)
        self.assertEqual(appended.node_tree, trees()[0])

    def test_change_of_variant_reaches_the_evaluated_material(self):
        material, node = ward_material()
        mesh = bpy.data.meshes.new("Mesh")
        mesh.materials.append(material)
        obj = bpy.data.objects.new("Object", mesh)
        bpy.context.collection.objects.link(obj)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        node.variant = "ward"
        depsgraph.update()
        evaluated = obj.evaluated_get(depsgraph).data.materials[0].node_tree.nodes[node.name]
        self.assertEqual(evaluated.variant, "ward")

    def test_menu_of_the_shader_editor_lists_it_once(self):
        drawn = [f for f in compat.add_shader_menu()._dyn_ui_initialize() if f.__name__ == "draw_menu"]
        self.assertEqual(len(drawn), 1)

    def test_menu_offers_what_can_be_rendered(self):
        """3.4 hides its own shaders from engines that it does not know."""
        own = [kind for kind in SHADERS if hasattr(bpy.types, kind) and kind not in nodes.HIDDEN]
        offered = ["WardBSDFNode", *own, "ShaderNodeOutputMaterial"]
        for engine, expected in (("CYCLES", ["WardBSDFNode"]), ("WARDMIS", offered)):
            layout = Recorder()
            editor = SimpleNamespace(tree_type="ShaderNodeTree", shader_type="OBJECT")
            nodes.draw_menu(SimpleNamespace(layout=layout), SimpleNamespace(space_data=editor, engine=engine))
            hidden = compat.add_shader_menu_is_for_blenders_engines()
            self.assertEqual([item.type for item in layout.items], expected if hidden else ["WardBSDFNode"])
            self.assertEqual(layout.items[0].text, "Ward BSDF")

    def test_inside_is_diffuse_plus_beckmann_of_the_same_alphas(self):
        """A flat patch under a small sun, seen by Cycles, against f = rho_d/pi + D/(4 c_i c_o) without Fresnel or shadowing.

        At 20 degrees and these alphas Beckmann's shadowing term is 1 to 1e-4, so the formula is Cycles' to that accuracy.
        """
        scene = bpy.context.scene
        scene.world = None
        material, node = ward_material()
        mesh = bpy.data.meshes.new("Patch")
        mesh.from_pydata([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], [], [(0, 1, 2, 3)])
        mesh.materials.append(material)
        scene.collection.objects.link(bpy.data.objects.new("Patch", mesh))
        camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
        camera.location = 0, -5, 50  # there Cycles' tangent of an object without UVs, about its z axis, is +x
        camera.data.angle = 0.001
        scene.collection.objects.link(camera)
        scene.camera = camera
        sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
        sun.data.energy, sun.data.angle = 1.0, 0.0
        scene.collection.objects.link(sun)
        scene.render.resolution_x = scene.render.resolution_y = 4
        rho_d, rho_s = 0.3, 0.5
        for ax, ay, rotation in ((0.2, 0.2, 0.0), (0.15, 0.3, 0.0), (0.3, 0.15, 0.0), (0.15, 0.3, 0.25)):
            for axis in (0, 1):  # the sun in the plane of x, of y
                with self.subTest(alpha=(ax, ay), rotation=rotation, axis="xy"[axis]):
                    node.inputs["Alpha X"].default_value = ax
                    node.inputs["Alpha Y"].default_value = ay
                    node.inputs["Rotation"].default_value = rotation
                    theta = np.radians(20)
                    sun.rotation_euler = (0, theta, 0) if axis == 0 else (-theta, 0, 0)
                    mean = render_with_cycles(4, self.path)[..., 0].mean()
                    alpha = (ax, ay)[axis if rotation == 0.0 else 1 - axis]
                    slope = np.tan(theta / 2) / alpha
                    cos_h, cos_i = np.cos(theta / 2), np.cos(theta)
                    d = np.exp(-(slope**2)) / (np.pi * ax * ay * cos_h**4)
                    expected = rho_d / np.pi * cos_i + rho_s * d / 4
                    self.assertAlmostEqual(mean / expected, 1.0, delta=0.01)
