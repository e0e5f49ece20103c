# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes in every state that Blender keeps them in: with layers of all kinds, in Edit Mode, with modifiers."""

from __future__ import annotations

import bpy
import numpy as np
from support import SceneTest, textured_material
from wardmis.export.context import ExportContext
from wardmis.export.image import export_image
from wardmis.export.mesh import Wanted, gather_geometry


def smooth_by_angle(mesh) -> None:
    """Makes a cube a frustum that is smooth around its top, and sharp elsewhere."""
    for vertex in mesh.vertices:
        if vertex.co.z > 0:
            vertex.co.x, vertex.co.y = 0.3 * vertex.co.x, 0.3 * vertex.co.y
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth, mesh.auto_smooth_angle = True, 1.3
    else:
        mesh.set_sharp_from_angle(angle=1.3)
    mesh.update()


class Layers(SceneTest):
    def cube(self, maps: int, active: int, attributes: int):
        """Its corners' UVs in map k are (corner, k)."""
        bpy.ops.mesh.primitive_cube_add(calc_uvs=False)
        obj = bpy.context.object
        mesh = obj.data
        for k in range(maps):
            mesh.uv_layers.new(name=f"Map {k}")
        for k in range(maps):
            uvs = np.stack([np.arange(24), np.full(24, k)], 1).astype(np.float32)
            mesh.uv_layers[k].data.foreach_set("uv", uvs.reshape(-1))
        if maps:
            mesh.uv_layers[active].active_render = True
        for k in range(attributes):
            mesh.attributes.new(f"Float {k}", "FLOAT", "CORNER")
            mesh.attributes.new(f"Colour {k}", "BYTE_COLOR", "CORNER")
            mesh.attributes.new(f"Vector {k}", "FLOAT_VECTOR", "POINT")
        smooth_by_angle(mesh)
        mesh.materials.append(textured_material())
        return obj

    def test_uvs_are_those_of_the_map_for_renders_whatever_else_the_mesh_holds(self):
        for maps in (1, 2, 3):
            for active in range(maps):
                for attributes in (0, 1, 4):
                    with self.subTest(maps=maps, active=active, attributes=attributes):
                        self.setUp()
                        self.cube(maps, active, attributes)
                        mesh = self.gather().meshes[0]
                        self.assertEqual(len(mesh.uvs), 24)
                        np.testing.assert_array_equal(mesh.uvs[:, 0], np.arange(24))
                        np.testing.assert_array_equal(mesh.uvs[:, 1], active)
                        np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-4)
                        self.assertEqual(
                            (np.abs(mesh.normals).max(axis=1) < 0.9).sum(), 12
                        )  # the corners of five faces at the top

    def test_no_map(self):
        self.cube(0, 0, 2)
        self.assertIsNone(self.gather().meshes[0].uvs)


class EditMode(SceneTest):
    """A mesh that is being edited is exported as it is outside of Edit Mode."""

    def gather_in_and_out(self):
        bpy.ops.object.mode_set(mode="EDIT")
        inside = self.gather()
        bpy.ops.object.mode_set(mode="OBJECT")
        return inside, self.gather()

    def check(self, names) -> None:
        inside, outside = self.gather_in_and_out()
        for scene in (inside, outside):
            self.assertEqual(sorted(i.name for i in scene.instances), sorted(names))
            self.assertEqual(scene.notes, [])
        for a, b in zip(inside.instances, outside.instances, strict=True):
            np.testing.assert_array_equal(a.matrix, b.matrix)
            first, second = inside.meshes[a.mesh], outside.meshes[b.mesh]
            self.assertGreater(len(first.positions), 0)
            np.testing.assert_allclose(first.positions, second.positions, atol=1e-6)
            np.testing.assert_array_equal(first.primitives[0].triangles, second.primitives[0].triangles)
            for part in ("normals", "uvs"):
                self.assertIs(getattr(first, part) is None, getattr(second, part) is None, part)
                if getattr(first, part) is not None:
                    np.testing.assert_allclose(getattr(first, part), getattr(second, part), atol=1e-4)

    def cube(self):
        bpy.ops.mesh.primitive_cube_add()
        return bpy.context.object

    def test_mesh(self):
        self.cube()
        self.check(["Cube"])

    def test_uvs_and_split_normals(self):
        obj = self.cube()
        smooth_by_angle(obj.data)
        obj.data.materials.append(textured_material())
        self.check(["Cube"])

    def test_changes_that_are_not_left_yet(self):
        obj = self.cube()
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.transform.translate(value=(0, 0, 5))
        mesh = self.gather().meshes[0]
        np.testing.assert_allclose(mesh.positions[:, 2].min(), 4, atol=1e-6)
        bpy.ops.object.mode_set(mode="OBJECT")
        self.assertEqual(obj.data.vertices[0].co.z, 4)

    def test_modifiers(self):
        for kind, settings in (
            ("SUBSURF", {"levels": 2, "render_levels": 2}),
            ("SIMPLE_DEFORM", {"angle": 0.5, "show_on_cage": True}),
            ("BEVEL", {"width": 0.2}),
            ("ARRAY", {"count": 3}),
        ):
            with self.subTest(kind):
                self.setUp()
                modifier = self.cube().modifiers.new(kind, kind)
                modifier.show_in_editmode = True
                for name, value in settings.items():
                    setattr(modifier, name, value)
                self.check(["Cube"])

    def test_boolean(self):
        bpy.ops.mesh.primitive_uv_sphere_add(location=(1, 1, 1))
        sphere = bpy.context.object
        sphere.hide_render = sphere.hide_viewport = True
        modifier = self.cube().modifiers.new("Boolean", "BOOLEAN")
        modifier.object = sphere
        modifier.show_in_editmode = True
        self.check(["Cube"])

    def test_linked_duplicate(self):
        obj = self.cube()
        twin = self.add("Twin", obj.data)
        twin.location.x = 3
        self.check(["Cube", "Twin"])

    def test_linked_duplicate_with_a_modifier(self):
        obj = self.cube()
        twin = self.add("Twin", obj.data)
        twin.modifiers.new("Subdivision", "SUBSURF")
        self.check(["Cube", "Twin"])

    def test_member_of_an_instanced_collection(self):
        group = bpy.data.collections.new("Group")
        group.objects.link(self.cube())
        empty = self.add("Empty", None)
        empty.instance_type, empty.instance_collection, empty.location = "COLLECTION", group, (4, 0, 0)
        self.check(["Cube", "Cube"])

    def test_several_at_once(self):
        first, second = self.cube(), self.cube()
        first.location.x = 3
        first.select_set(True)
        second.select_set(True)
        self.check(["Cube", "Cube.001"])

    def test_nothing_of_it_stays_behind(self):
        obj = self.cube()
        bpy.ops.object.mode_set(mode="EDIT")
        self.gather()
        bpy.ops.object.mode_set(mode="OBJECT")
        self.assertEqual([mesh.name for mesh in bpy.data.meshes], [obj.data.name])


class Tangents(SceneTest):
    """As Blender's own, which it makes of triangles and quads alone."""

    def mesh(self, smooth: bool):
        """A bent grid of triangles whose UVs are mirrored on one half, have a seam, and no area in one corner."""
        x, y = np.meshgrid(np.linspace(-1, 1, 9), np.linspace(-1, 1, 8))
        z = 0.3 * x * x + 0.2 * np.sin(3 * y)
        index = np.arange(x.size).reshape(x.shape)
        corner = [index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]]
        faces = np.concatenate([np.stack([corner[k] for k in c], -1).reshape(-1, 3) for c in ((0, 1, 2), (0, 2, 3))])
        mesh = bpy.data.meshes.new("Bent")
        mesh.from_pydata(np.stack([x, y, z], -1).reshape(-1, 3).tolist(), [], faces.tolist())
        mesh.polygons.foreach_set("use_smooth", [smooth] * len(mesh.polygons))
        uvs = np.stack([np.abs(x) + 0.2 * y, y - 0.1 * x * x], -1).reshape(-1, 2)[faces]
        uvs[faces.mean(axis=1) > 50] += 0.5
        uvs[-1] = uvs[-1, 0]
        mesh.uv_layers.new(name="Bent").data.foreach_set("uv", uvs.astype(np.float32).ravel())
        mesh.update()
        return mesh

    def test_as_blenders_own(self):
        for smooth in (True, False):
            with self.subTest(smooth=smooth):
                mesh = self.mesh(smooth)
                wanted = Wanted(frozenset({"Bent"}), tangents=frozenset({"Bent"}))
                found = gather_geometry(mesh, wanted, ExportContext(export_image)).tangents["Bent"]
                mesh.calc_tangents(uvmap="Bent")
                theirs = np.empty(3 * len(mesh.loops), np.float32)
                mesh.loops.foreach_get("tangent", theirs)
                signs = np.empty(len(mesh.loops), np.float32)
                mesh.loops.foreach_get("bitangent_sign", signs)
                usual = (
                    np.arange(len(found)) < len(found) - 3
                )  # what one without an area gets there depends on the version
                np.testing.assert_allclose(found[usual, :3], theirs.reshape(-1, 3)[usual], atol=5e-5)
                np.testing.assert_array_equal(found[usual, 3], signs[usual])
                self.assertEqual({-1.0, 1.0}, set(signs))
                np.testing.assert_allclose(np.linalg.norm(found[:, :3], axis=1), 1, atol=1e-5)

    def test_none_without_the_uvs(self):
        wanted = Wanted(frozenset({"Other"}), tangents=frozenset({"Other"}))
        self.assertEqual(gather_geometry(self.mesh(True), wanted, ExportContext(export_image)).tangents, {})


class BentNormals(SceneTest):
    """Where normals are far from the faces' own, what is diffuse follows Cycles' rules for them."""

    def material_of(self, add, smooth=True, node="ShaderNodeBsdfDiffuse"):
        self.setUp()
        add()
        mesh = bpy.context.object.data
        mesh.polygons.foreach_set("use_smooth", [smooth] * len(mesh.polygons))
        material = bpy.data.materials.new("Material")
        material.use_nodes = True
        tree = material.node_tree
        output = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
        tree.links.new(tree.nodes.new(node).outputs[0], output.inputs["Surface"])
        mesh.materials.append(material)
        scene = self.gather()
        return scene.materials[scene.meshes[0].primitives[0].material]

    def test_a_smooth_cube_is_shaded_by_a_closure(self):
        made = self.material_of(bpy.ops.mesh.primitive_cube_add)
        self.assertEqual([c.type for c in made.closures], ["diffuse"])
        self.assertEqual(made.diffuse.value, (0.0, 0.0, 0.0))
        np.testing.assert_allclose(made.closures[0].inputs["color"].value, (0.8, 0.8, 0.8), atol=1e-6)

    def test_flat_and_finely_smooth_shapes_keep_the_short_form(self):
        for add, smooth in ((bpy.ops.mesh.primitive_cube_add, False), (bpy.ops.mesh.primitive_uv_sphere_add, True)):
            made = self.material_of(add, smooth)
            self.assertEqual(made.closures, [])
            np.testing.assert_allclose(made.diffuse.value, (0.8, 0.8, 0.8), atol=1e-6)

    def test_what_only_shines_keeps_it_too(self):
        self.assertEqual(self.material_of(bpy.ops.mesh.primitive_cube_add, node="ShaderNodeEmission").closures, [])
