# SPDX-License-Identifier: GPL-3.0-or-later
"""What the depsgraph holds arrives in the plain data: meshes of every kind, instances, materials by slot, visibility."""

from __future__ import annotations

import math
import tempfile
import time
from pathlib import Path

import bpy
import numpy as np
import wardmis
from mathutils import Matrix
from support import SceneTest, textured_material
from wardmis import compat
from wardmis.export import ExportCancelled, ExportError, export_depsgraph
from wardmis.export.context import ExportContext
from wardmis.export.model import SceneData


def triangles_of(scene: SceneData, mesh: int) -> int:
    return sum(len(p.triangles) for p in scene.meshes[mesh].primitives)


class Meshes(SceneTest):
    def test_flat_mesh_needs_positions_alone(self):
        self.add_quad()
        mesh = self.gather().meshes[0]
        self.assertEqual((len(mesh.positions), mesh.normals, mesh.uvs), (4, None, None))
        corners = mesh.positions[mesh.primitives[0].triangles]
        areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        np.testing.assert_allclose(areas.sum(axis=0), (0, 0, 8))  # the right way round

    def test_smooth_mesh_has_a_normal_for_each_vertex(self):
        mesh = self.add_mesh(
            "Roof", [(-1, 0, 0), (0, 0, 1), (1, 0, 0), (-1, 1, 0), (0, 1, 1), (1, 1, 0)], [(0, 1, 4, 3), (1, 2, 5, 4)]
        ).data
        mesh.polygons.foreach_set("use_smooth", [True, True])
        exported = self.gather().meshes[0]
        self.assertEqual(len(exported.positions), 6)
        np.testing.assert_allclose(abs(exported.normals[1]), (0, 0, 1), atol=2e-5)  # Cycles 5.2 keeps them in 16 bits

    def test_flat_and_smooth_faces_together_have_a_normal_for_each_corner(self):
        mesh = self.add_mesh(
            "Roof", [(-1, 0, 0), (0, 0, 1), (1, 0, 0), (-1, 1, 0), (0, 1, 1), (1, 1, 0)], [(0, 1, 4, 3), (1, 2, 5, 4)]
        ).data
        mesh.polygons.foreach_set("use_smooth", [True, False])
        exported = self.gather().meshes[0]
        self.assertEqual(len(exported.positions), 8)
        flat = [n for p, n in zip(exported.positions, exported.normals) if p[0] > 0]
        np.testing.assert_allclose(np.abs(flat), np.full((2, 3), (math.sqrt(0.5), 0, math.sqrt(0.5))), atol=1e-4)

    def test_uvs_are_exported_only_for_a_material_that_needs_them(self):
        quad = self.add_quad()
        layer = quad.data.uv_layers.new(name="UV")
        for loop, uv in zip(layer.data, ((0, 0), (1, 0), (1, 0.5), (0, 0.5))):
            loop.uv = uv
        self.assertIsNone(self.gather().meshes[0].uvs)
        quad.data.materials.append(textured_material())
        mesh = self.gather().meshes[0]
        by_place = {tuple(p[:2]): tuple(uv) for p, uv in zip(mesh.positions.tolist(), mesh.uvs.tolist())}
        self.assertEqual(by_place[(1.0, 1.0)], (1.0, 0.5))

    def test_tangents_that_a_displacement_lacks_are_noted(self):
        material = textured_material()
        tree = material.node_tree
        moved = tree.nodes.new("ShaderNodeVectorDisplacement")
        tree.links.new(tree.nodes.new("ShaderNodeTexNoise").outputs["Color"], moved.inputs["Vector"])
        output = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial")
        tree.links.new(moved.outputs[0], output.inputs["Displacement"])
        quad = self.add_quad()
        quad.data.materials.append(material)
        self.assertTrue(any("its normals alone" in note for note in self.gather().notes))
        quad.data.uv_layers.new(name="UV")
        self.assertFalse(any("its normals alone" in note for note in self.gather().notes))

    def test_every_kind_of_object_with_a_surface(self):
        curve = bpy.data.curves.new("Curve", "CURVE")
        curve.dimensions = "3D"
        spline = curve.splines.new("POLY")
        spline.points.add(1)
        spline.points[1].co = (1, 0, 0, 1)
        curve.bevel_depth = 0.1
        text = bpy.data.curves.new("Text", "FONT")
        text.body = "W"
        ball = bpy.data.metaballs.new("Ball")
        ball.elements.new()
        for name, data in (("Curve", curve), ("Text", text), ("Ball", ball)):
            self.add(name, data)
        bpy.ops.surface.primitive_nurbs_surface_sphere_add()
        bpy.context.object.name = "Surface"
        scene = self.gather()
        self.assertEqual({i.name for i in scene.instances}, {"Curve", "Text", "Ball", "Surface"})
        self.assertEqual(len(scene.instances), 4)
        for instance in scene.instances:
            self.assertGreater(triangles_of(scene, instance.mesh), 0, instance.name)
        self.assertEqual(scene.notes, [])

    def test_what_cannot_be_shown_is_noted(self):
        self.add("Cloud", bpy.data.volumes.new("Cloud"))
        notes = "\n".join(self.gather().notes)
        self.assertIn("object 'Cloud': volume objects are not supported", notes)

    def test_domain_of_smoke_is_no_surface(self):
        """That of a liquid is one, and so is what pours the smoke."""
        for kind, domain, seen in (("DOMAIN", "GAS", 0), ("DOMAIN", "LIQUID", 1), ("FLOW", None, 1)):
            with self.subTest(kind=kind, domain=domain):
                self.setUp()
                modifier = self.add_quad().modifiers.new("Fluid", "FLUID")
                modifier.fluid_type = kind
                if domain:
                    modifier.domain_settings.domain_type = domain
                scene = self.gather()
                self.assertEqual(len(scene.instances), seen)
                self.assertEqual(any("smoke and fire are not supported" in n for n in scene.notes), not seen)

    def test_mesh_without_faces_is_nothing(self):
        self.add_mesh("Edge", [(0, 0, 0), (1, 0, 0)], [])
        self.assertEqual(self.gather().instances, [])

    def test_vertex_that_is_not_finite_names_the_object(self):
        quad = self.add_quad("Broken")
        quad.data.vertices[2].co.y = math.nan
        quad.data.update()
        with self.assertRaisesRegex(ExportError, "object 'Broken': vertex 2 of mesh 'Broken' is at .*nan.* not finite"):
            self.gather()

    def test_normals_of_every_kind_agree_with_blenders_corners(self):
        bpy.ops.mesh.primitive_monkey_add()
        mesh = bpy.context.object.data
        mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
        mesh.update()
        exported = self.gather().meshes[0]
        expected = compat.corner_normals(mesh)
        corners = compat.triangle_corners(mesh)
        np.testing.assert_allclose(exported.normals[exported.primitives[0].triangles], expected[corners], atol=1e-4)

    def test_raw_arrays_equal_those_of_foreach_get(self):
        bpy.ops.mesh.primitive_monkey_add()
        mesh = bpy.context.object.data
        mesh.calc_loop_triangles()
        slow = np.empty(3 * len(mesh.loop_triangles), np.int32)
        mesh.loop_triangles.foreach_get("loops", slow)
        np.testing.assert_array_equal(compat.triangle_corners(mesh), slow.reshape(-1, 3))
        vertices = np.empty(len(mesh.loops), np.int32)
        mesh.loops.foreach_get("vertex_index", vertices)
        np.testing.assert_array_equal(compat.corner_vertices(mesh), vertices)

    def test_two_million_triangles_in_less_than_a_second(self):
        n = 1000
        mesh = bpy.data.meshes.new("Large")
        x, y = np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1))
        mesh.vertices.add((n + 1) ** 2)
        mesh.vertices.foreach_set("co", np.stack([x, y, 0.1 * np.sin(9 * x)], -1).astype(np.float32).reshape(-1))
        corner = np.arange(n * n) + np.arange(n * n) // n
        mesh.loops.add(4 * n * n)
        mesh.loops.foreach_set(
            "vertex_index",
            np.stack([corner, corner + 1, corner + n + 2, corner + n + 1], -1).astype(np.int32).reshape(-1),
        )
        mesh.polygons.add(n * n)
        mesh.polygons.foreach_set("loop_start", np.arange(0, 4 * n * n, 4, dtype=np.int32))
        if compat.VERSION < (4, 1, 0):
            mesh.polygons.foreach_set("loop_total", np.full(n * n, 4, np.int32))
        mesh.polygons.foreach_set("use_smooth", np.full(n * n, True))
        mesh.update()
        self.add("Large", mesh)
        vertex_bytes = 1_000_000 * 24
        for textured in (False, True):
            if textured:  # a vertex for each corner, with UVs
                mesh.uv_layers.new()
                mesh.materials.append(textured_material())
                vertex_bytes = 4_000_000 * 32
            depsgraph = bpy.context.evaluated_depsgraph_get()
            best = math.inf
            with self.subTest(textured=textured), tempfile.TemporaryDirectory() as folder:
                for _ in range(3):
                    start = time.perf_counter()
                    export_depsgraph(depsgraph, Path(folder) / "large.glb")
                    best = min(best, time.perf_counter() - start)
                self.assertGreater((Path(folder) / "large.glb").stat().st_size, 2_000_000 * 12 + vertex_bytes)
                print(f"[{best:.2f} s]", end=" ")
                self.assertLess(best, 1.0)


class Materials(SceneTest):
    def test_slots_become_primitives_that_share_their_vertices(self):
        quads = self.add_mesh(
            "Two", [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0), (2, 1, 0)], [(0, 1, 2, 3), (1, 4, 5, 2)]
        )
        for name in ("Left", "Unused", "Right"):
            quads.data.materials.append(bpy.data.materials.new(name))
        quads.data.polygons[1].material_index = 2
        scene = self.gather()
        names = [scene.materials[p.material].name for p in scene.meshes[0].primitives]
        self.assertEqual(names, ["Left", "Right"])
        self.assertEqual([len(p.triangles) for p in scene.meshes[0].primitives], [2, 2])

    def test_face_beyond_the_slots_has_the_last_material(self):
        quad = self.add_quad()
        quad.data.materials.append(bpy.data.materials.new("Only"))
        quad.data.polygons[0].material_index = 7
        scene = self.gather()
        self.assertEqual([scene.materials[p.material].name for p in scene.meshes[0].primitives], ["Only"])

    def test_no_material_is_as_in_cycles(self):
        """From 5.0 on the same as a new material, whose numbers come from single precision; before, diffuse alone."""
        self.add_quad("Without")
        new = bpy.data.materials.new("New")
        new.use_nodes = True
        self.add_quad("With").data.materials.append(new)
        materials = {m.name: m for m in self.gather().materials}
        without, other = materials["(no material)"], materials["New"]
        if compat.VERSION < (5, 0, 0):
            self.assertEqual((without.diffuse.value, without.specular.value), ((0.8, 0.8, 0.8), (0, 0, 0)))
            return
        (a,), (b,) = without.closures, other.closures
        self.assertEqual((a.type, a.parameters), (b.type, b.parameters))
        for name, value in a.inputs.items():
            np.testing.assert_allclose(value.value, b.inputs[name].value, rtol=1e-6)
        # the rest as the renderer has it where it is not told
        off = {name for name in b.inputs if np.all(np.equal(b.inputs[name].value, 0)) and "Weight" in name}
        self.assertEqual(off, {name for name in b.inputs if name.endswith("Weight")})

    def test_material_of_the_object_goes_before_that_of_the_mesh(self):
        quad = self.add_quad("One")
        quad.data.materials.append(bpy.data.materials.new("Mesh's"))
        other = self.add("Two", quad.data)
        other.material_slots[0].link = "OBJECT"
        other.material_slots[0].material = bpy.data.materials.new("Object's")
        scene = self.gather()
        self.assertEqual(len(scene.meshes), 2)
        self.assertIs(scene.meshes[0].positions, scene.meshes[1].positions, "the vertices are not shared")
        used = {i.name: scene.materials[scene.meshes[i.mesh].primitives[0].material].name for i in scene.instances}
        self.assertEqual(used, {"One": "Mesh's", "Two": "Object's"})

    def test_no_material_and_empty_slots_are_as_in_cycles(self):
        self.add_quad("None")
        self.add_quad("Empty").data.materials.append(None)
        scene = self.gather()
        (material,) = scene.materials
        principled = bpy.app.version >= (5, 0, 0)
        self.assertEqual([c.type for c in material.closures], ["principled"] if principled else [])
        self.assertEqual(material.diffuse.value, (0.0,) * 3 if principled else (0.8,) * 3)

    def test_override_of_the_view_layer(self):
        self.add_quad().data.materials.append(bpy.data.materials.new("Own"))
        self.scene.view_layers[0].material_override = bpy.data.materials.new("Override")
        self.assertEqual([m.name for m in self.gather().materials], ["Override"])

    def test_materials_that_no_mesh_uses_are_left_out(self):
        bpy.data.materials.new("Unused").use_fake_user = True
        self.add_quad().data.materials.append(bpy.data.materials.new("Used"))
        self.assertEqual([m.name for m in self.gather().materials], ["Used"])


class Instances(SceneTest):
    def test_objects_that_share_a_mesh_are_instances(self):
        quad = self.add_quad()
        for k in range(3):
            self.add(f"Copy{k}", quad.data).location.x = k
        scene = self.gather()
        self.assertEqual((len(scene.meshes), len(scene.instances)), (1, 4))

    def test_modified_copies_are_meshes_of_their_own(self):
        quad = self.add_quad()
        self.add("Modified", quad.data).modifiers.new("Subdivide", "SUBSURF").levels = 2
        scene = self.gather()
        self.assertEqual(sorted(triangles_of(scene, m) for m in range(len(scene.meshes))), [2, 32])

    def test_collection_instances(self):
        inner = bpy.data.collections.new("Inner")
        quad = self.add("Quad", self.add_quad("Outside").data, inner)
        quad.location = (0, 0, 1)
        bpy.data.objects.remove(bpy.data.objects["Outside"])
        light = self.add("Lamp", bpy.data.lights.new("Lamp", "POINT"), inner)
        light.data.energy = 10
        for x in (5, 7):
            empty = self.add(f"Empty{x}", None)
            empty.instance_type, empty.instance_collection = "COLLECTION", inner
            empty.location.x = x
        scene = self.gather()
        self.assertEqual(sorted(tuple(i.matrix[:3, 3]) for i in scene.instances), [(5, 0, 1), (7, 0, 1)])
        self.assertEqual((len(scene.meshes), len(scene.lights)), (1, 2))

    def test_text_in_a_collection_instance(self):
        inner = bpy.data.collections.new("Inner")
        self.add("Text", bpy.data.curves.new("Text", "FONT"), inner).data.body = "W"
        for x in (5, 7):
            empty = self.add(f"Empty{x}", None)
            empty.instance_type, empty.instance_collection = "COLLECTION", inner
            empty.location.x = x
        scene = self.gather()
        self.assertEqual((len(scene.meshes), len(scene.instances)), (1, 2))

    def test_particles_that_are_objects(self):
        emitter = self.add_quad("Emitter")
        emitter.modifiers.new("Particles", "PARTICLE_SYSTEM")
        settings = emitter.particle_systems[0].settings
        settings.count, settings.frame_start, settings.frame_end, settings.lifetime = 20, 1, 1, 50
        settings.render_type, settings.instance_object = (
            "OBJECT",
            self.add_mesh("Leaf", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]),
        )
        emitter.show_instancer_for_viewport = False
        self.scene.frame_set(2)
        scene = self.gather()
        counts = {scene.meshes[k].name: sum(i.mesh == k for i in scene.instances) for k in range(len(scene.meshes))}
        self.assertEqual(counts, {"Leaf": 21})

    def test_instances_of_geometry_nodes(self):
        points = self.add_mesh("Points", [(0, 0, 0), (1, 0, 0), (2, 0, 0)], [])
        quad = self.add_quad()
        tree = bpy.data.node_groups.new("Instances", "GeometryNodeTree")
        compat.add_group_socket(tree, "Geometry", "NodeSocketGeometry", "INPUT")
        compat.add_group_socket(tree, "Geometry", "NodeSocketGeometry", "OUTPUT")
        given, made, instance, info = (
            tree.nodes.new(kind)
            for kind in ("NodeGroupInput", "NodeGroupOutput", "GeometryNodeInstanceOnPoints", "GeometryNodeObjectInfo")
        )
        info.inputs["Object"].default_value = quad
        tree.links.new(given.outputs[0], instance.inputs["Points"])
        tree.links.new(info.outputs["Geometry"], instance.inputs["Instance"])
        tree.links.new(instance.outputs[0], made.inputs[0])
        points.modifiers.new("Nodes", "NODES").node_group = tree
        quad.hide_viewport = True
        scene = self.gather()
        self.assertEqual((len(scene.meshes), len(scene.instances)), (1, 3))
        self.assertEqual(sorted(i.matrix[0, 3] for i in scene.instances), [0, 1, 2])

    def test_ten_thousand_instances_are_quick(self):
        quad = self.add_quad()
        points = self.add_mesh("Points", np.random.default_rng(0).random((10_000, 3)).tolist(), [])
        points.instance_type = "VERTS"
        quad.parent = points
        depsgraph = bpy.context.evaluated_depsgraph_get()
        start = time.perf_counter()
        with tempfile.TemporaryDirectory() as folder:
            export_depsgraph(depsgraph, Path(folder) / "many.glb")
        seconds = time.perf_counter() - start
        print(f"[{seconds:.2f} s]", end=" ")
        self.assertLess(seconds, 1.0)

    def test_scale_of_zero_flattens(self):
        """The transform has no inverse: the mesh takes the shape that it has in the world, and is shared where that is the same."""
        material = textured_material()
        vertices = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
        for name, x in (("First", 0), ("Second", 3)):
            obj = self.add_mesh(name, vertices, [(0, 1, 7, 6)])
            obj.data.materials.append(material)
            obj.data.uv_layers.new()
            obj.location, obj.scale, obj.rotation_euler = (x, 0, 2), (1, 2, 0), (0, math.radians(90), 0)
        bpy.data.objects["Second"].data = bpy.data.objects["First"].data
        scene = self.gather()
        self.assertEqual([i.name for i in scene.instances], ["First", "Second"])
        self.assertEqual(len({i.mesh for i in scene.instances}), 1)
        mesh = scene.meshes[scene.instances[0].mesh]
        corners = mesh.positions[mesh.primitives[0].triangles].reshape(-1, 3)
        np.testing.assert_allclose(corners.min(axis=0), (0, -2, -1), atol=1e-6)
        np.testing.assert_allclose(corners.max(axis=0), (0, 2, 1), atol=1e-6)
        self.assertIsNotNone(mesh.uvs)
        for instance, x in zip(scene.instances, (0, 3), strict=True):
            np.testing.assert_array_equal(instance.matrix, Matrix.Translation((x, 0, 2)))
        self.assertEqual(scene.notes, [])

    def test_flattened_by_a_turned_parent(self):
        """Rounding leaves such a matrix a determinant; what is thin, and what is small, keeps its inverse."""
        parent = bpy.data.objects.new("Parent", None)
        parent.scale, parent.rotation_euler = (1, 1, 0), (0.3, 0.2, 0.6)
        self.scene.collection.objects.link(parent)
        turned, thin, small = (self.add_quad(name) for name in ("Turned", "Thin", "Small"))
        turned.parent, turned.rotation_euler = parent, (0.4, 0.5, 0.6)
        thin.scale, thin.rotation_euler = (1, 1, 1e-4), (0.4, 0.5, 0.6)
        small.scale = (1e-9, 1e-9, 1e-9)
        scene = self.gather()
        own_axes = {i.name: np.array_equal(i.matrix[:3, :3], np.eye(3)) for i in scene.instances}
        self.assertEqual(own_axes, {"Turned": True, "Thin": False, "Small": False})

    def test_line_and_point_show_nothing(self):
        self.add_quad("Line").scale = (1, 0, 0)
        self.add_quad("Turned").scale, bpy.data.objects["Turned"].rotation_euler = (1, 0, 0), (0.3, 0.4, 0.5)
        self.add_quad("Gone").scale = (0, 0, 0)
        self.add_quad("Small").scale = (1e-13, 1e-13, 1e-13)
        scene = self.gather()
        self.assertEqual([i.name for i in scene.instances], ["Small"])
        self.assertEqual(scene.notes, [])

    def test_transform_that_is_not_finite(self):
        self.add_quad("Lost").location.x = math.nan
        with self.assertRaisesRegex(ExportError, "object 'Lost': its transform is not finite"):
            self.gather()


class Filters(SceneTest):
    """What the view layer leaves out."""

    def setUp(self):
        super().setUp()
        self.add_quad()
        self.add("Lamp", bpy.data.lights.new("Lamp", "POINT"))
        self.scene.world = bpy.data.worlds.new("World")
        self.scene.world.color = 0.1, 0.2, 0.3
        self.scene.world.use_nodes = False
        if compat.uses_nodes(self.scene.world):
            background = self.scene.world.node_tree.nodes.new("ShaderNodeBackground")
            background.inputs["Color"].default_value = (0.1, 0.2, 0.3, 1)
            output = self.scene.world.node_tree.get_output_node("CYCLES")
            self.scene.world.node_tree.links.new(background.outputs[0], output.inputs["Surface"])

    def seen(self):
        scene = self.gather()
        return len(scene.instances), len(scene.lights), bool(scene.worlds)

    def test_environment_and_surfaces(self):
        layer = self.scene.view_layers[0]
        self.assertEqual(self.seen(), (1, 1, True))
        layer.use_sky = False
        self.assertEqual(self.seen(), (1, 1, False))
        layer.use_sky, layer.use_solid = True, False
        self.assertEqual(self.seen(), (0, 1, True))

    def test_hair(self):
        quad = bpy.data.objects["Quad"]
        quad.modifiers.new("Hair", "PARTICLE_SYSTEM")
        quad.particle_systems[0].settings.type = "HAIR"
        self.assertEqual(self.seen(), (2, 1, True))
        self.scene.view_layers[0].use_strand = False
        self.assertEqual(self.seen(), (1, 1, True))


class OutOfReach(SceneTest):
    """Attributes of instances that Blender does not tell add-ons, and of Cycles' own, are named."""

    def placed(self, name: str = "Tint") -> None:
        made = bpy.data.materials.new("Tinted")
        made.use_nodes = True
        tree = made.node_tree
        node = tree.nodes.new("ShaderNodeAttribute")
        node.attribute_type, node.attribute_name = "INSTANCER", name
        tree.links.new(node.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
        self.shown, self.points = self.add_quad("Shown"), self.add_quad("Points")
        self.shown.data.materials.append(made)
        group = bpy.data.node_groups.new("Instances", "GeometryNodeTree")
        for way in ("INPUT", "OUTPUT"):
            compat.add_group_socket(group, "Geometry", "NodeSocketGeometry", way)
        kinds = ("NodeGroupInput", "NodeGroupOutput", "GeometryNodeInstanceOnPoints", "GeometryNodeObjectInfo")
        entry, end, points, source = (group.nodes.new(kind) for kind in kinds)
        source.inputs["Object"].default_value = self.shown
        group.links.new(entry.outputs[0], points.inputs["Points"])
        group.links.new(source.outputs["Geometry"], points.inputs["Instance"])
        group.links.new(points.outputs[0], end.inputs[0])
        self.points.modifiers.new("Nodes", "NODES").node_group = group

    def told(self) -> list[str]:
        return [note for note in self.gather().notes if "reads 'Tint' of its instances" in note]

    def test_of_nodes(self):
        self.placed()
        notes = self.told()
        self.assertEqual(len(notes), 0 if compat.TELLS_EVALUATED_GEOMETRY else 1, notes)
        self.points["Tint"] = 0.5  # which is found instead
        self.points.update_tag()
        self.assertEqual(self.told(), [])

    def test_coordinates_of_round_points(self):
        made = self.add_quad()
        tree = bpy.data.node_groups.new("Points", "GeometryNodeTree")
        for way in ("INPUT", "OUTPUT"):
            compat.add_group_socket(tree, "Geometry", "NodeSocketGeometry", way)
        kinds = ("NodeGroupInput", "NodeGroupOutput", "GeometryNodeMeshToPoints", "GeometryNodeSetMaterial")
        entry, end, points, paint = (tree.nodes.new(kind) for kind in kinds)
        tree.links.new(entry.outputs[0], points.inputs["Mesh"])
        tree.links.new(points.outputs[0], paint.inputs["Geometry"])
        tree.links.new(paint.outputs[0], end.inputs[0])
        made.modifiers.new("Nodes", "NODES").node_group = tree
        painted = paint.inputs["Material"].default_value = bpy.data.materials.new("Painted")
        painted.use_nodes = True
        nodes = painted.node_tree
        place = nodes.nodes.new("ShaderNodeTexCoord").outputs["Object"]
        nodes.links.new(place, nodes.nodes["Principled BSDF"].inputs["Base Color"])
        for scale, told in (((1, 1, 1), False), ((1, 2, 1), compat.SPHERES_STAY_ROUND)):
            made.scale = scale
            made.update_tag()
            notes = [n for n in self.gather().notes if "coordinates of points are not supported" in n]
            self.assertEqual(len(notes), int(told), scale)

    def test_what_cycles_makes_of_a_mesh(self):
        self.placed("Tint")
        node = next(n for n in self.shown.active_material.node_tree.nodes if n.type == "ATTRIBUTE")
        node.attribute_type, node.attribute_name = "GEOMETRY", "pointiness"
        self.assertEqual(len([n for n in self.gather().notes if "reads 'pointiness', which Cycles makes" in n]), 1)

    def test_of_nodes_in_a_collection_that_is_placed(self):
        self.placed()
        group = bpy.data.collections.new("Group")
        for obj in (self.shown, self.points):
            self.scene.collection.objects.unlink(obj)
            group.objects.link(obj)
        empty = self.add("Empty", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", group
        notes = self.told()
        self.assertEqual(len(notes), 1, notes)
        self.assertIn("object 'Empty'", notes[0])


class Visibility(SceneTest):
    def test_flags_of_objects_and_their_instancers(self):
        quad = self.add_quad()
        quad.visible_camera = quad.visible_glossy = False
        inner = bpy.data.collections.new("Inner")
        self.add("Inside", quad.data, inner).visible_shadow = False
        empty = self.add("Empty", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", inner
        empty.visible_diffuse = empty.visible_transmission = False
        hidden = {i.name: set(i.hidden_from) for i in self.gather().instances}
        self.assertEqual(hidden, {"Quad": {"camera", "glossy"}, "Inside": {"diffuse", "transmission", "shadow"}})

    def test_object_that_nothing_sees_is_left_out(self):
        quad = self.add_quad()
        for kind in ("camera", "diffuse", "glossy", "transmission", "shadow"):
            setattr(quad, f"visible_{kind}", False)
        self.assertEqual(self.gather().instances, [])

    def test_indirect_only_and_holdout_collections(self):
        for name in ("Indirect", "Holdout"):
            collection = bpy.data.collections.new(name)
            self.scene.collection.children.link(collection)
            self.add(name, self.add_quad(f"Mesh of {name}").data, collection)
        layers = self.scene.view_layers[0].layer_collection.children
        layers["Indirect"].indirect_only = layers["Holdout"].holdout = True
        scene = self.gather()
        self.assertEqual({i.name: set(i.hidden_from) for i in scene.instances}["Indirect"], {"camera"})
        self.assertEqual([i.name for i in scene.instances if i.holdout], ["Holdout"])
        self.assertEqual(scene.notes, [])

    def test_shadow_catchers(self):
        """Of themselves, or by what instances them; lamps are marked that are none."""
        self.add_quad("Other")
        self.add_quad("Catcher").is_shadow_catcher = True
        inner = bpy.data.collections.new("Inner")
        self.add("Inside", self.add_quad("Data").data, inner)
        empty = self.add("Empty", None)
        empty.instance_type, empty.instance_collection, empty.is_shadow_catcher = "COLLECTION", inner, True
        self.add("Usual", bpy.data.lights.new("Usual", "POINT"))
        self.add("Added", bpy.data.lights.new("Added", "POINT")).is_shadow_catcher = False
        scene = self.gather()
        self.assertEqual([i.name for i in scene.instances if i.shadow_catcher], ["Catcher", "Inside"])
        self.assertEqual([light.name for light in scene.lights if not light.on_catchers], ["Added"])
        self.assertEqual(scene.notes, [])

    def test_shadow_terminator(self):
        """Each object's own, also of what is instanced; .1 as it comes."""
        made = self.add_quad("Own")
        owner, *names = compat.shadow_terminator(made)
        for name, value in zip(names, (0.25, 0.5)):
            setattr(owner, name, value)
        inner = bpy.data.collections.new("Inner")
        self.add("Inside", made.data, inner)
        empty = self.add("Empty", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", inner
        found = {i.name: i.shadow_terminator for i in self.gather().instances}
        self.assertEqual(found["Own"], (0.25, 0.5))
        np.testing.assert_allclose(found["Inside"], (0.1, 0))

    def test_adaptive_subdivision_is_noted(self):
        quad = self.add_quad()
        divided = quad.modifiers.new("Finer", "SUBSURF")
        self.assertEqual(self.gather().notes, [])
        if bpy.app.version >= (5, 0, 0):
            divided.use_adaptive_subdivision = True
        else:
            cycles = self.scene.cycles
            self.addCleanup(setattr, cycles, "feature_set", cycles.feature_set)
            cycles.feature_set, quad.cycles.use_adaptive_subdivision = "EXPERIMENTAL", True
        self.assertIn("object 'Quad': adaptive subdivision is not supported", self.gather().notes[0])
        quad.modifiers.new("Later", "TRIANGULATE")  # then it is not the last
        self.assertEqual(self.gather().notes, [])

    def test_light_linking_is_noted(self):
        quad = self.add_quad()
        if not hasattr(quad, "light_linking"):
            self.skipTest("this Blender has no light linking")
        quad.light_linking.receiver_collection = bpy.data.collections.new("Receivers")
        self.assertIn("object 'Quad': light linking is not supported", self.gather().notes[0])

    def test_motion_blur_without_a_render_is_noted(self):
        self.scene.render.use_motion_blur = True
        self.assertIn("motion blur is left out", self.gather().notes[0])


class AsRendered(SceneTest):
    """The export without a depsgraph sees the scene as a render does, and leaves no trace in it."""

    def test_levels_and_visibility_of_the_render(self):
        from support import read_glb

        quad = self.add_quad()
        modifier = quad.modifiers.new("Subdivide", "SUBSURF")
        modifier.levels, modifier.render_levels = 1, 3
        self.add_quad("Hidden").hide_render = True
        self.scene.render.engine = "CYCLES"
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "scene.glb"
            wardmis.export_scene(path)
            document, _ = read_glb(path)
            self.assertEqual(list(Path(folder).iterdir()), [path])
        self.assertEqual([m["name"] for m in document["meshes"]], ["Quad"])
        indices = document["meshes"][0]["primitives"][0]["indices"]
        self.assertEqual(document["accessors"][indices]["count"], 3 * 2 * 4**3)
        self.assertEqual(self.scene.render.engine, "CYCLES")

    def test_operator_of_the_menu(self):
        self.add_quad()
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "scene.glb"
            self.assertEqual(bpy.ops.wardmis.export(filepath=str(path)), {"FINISHED"})
            self.assertTrue(path.is_file())
            with self.assertRaisesRegex(RuntimeError, "the folder .* does not exist"):
                bpy.ops.wardmis.export(filepath=str(Path(folder) / "none" / "scene.glb"))

    def test_failure_is_told(self):
        self.scene.camera.data.clip_start = 1e6
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaisesRegex(RuntimeError, "sees nothing"):
                wardmis.export_scene(Path(folder) / "scene.glb")
            self.assertEqual(list(Path(folder).iterdir()), [])


class Stopping(SceneTest):
    def test_export_stops_and_leaves_nothing(self):
        quad = self.add_quad()
        for _ in range(100):
            self.add("Copy", quad.data)
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaises(ExportCancelled):
                export_depsgraph(
                    bpy.context.evaluated_depsgraph_get(), Path(folder) / "scene.glb", cancelled=lambda: True
                )
            self.assertEqual(list(Path(folder).iterdir()), [])

    def test_question_is_asked_often_enough_and_not_too_often(self):
        asked = []
        context = ExportContext(None, lambda: asked.append(time.monotonic()))
        end = time.monotonic() + 0.45
        while time.monotonic() < end:
            context.check_cancelled()
        self.assertIn(len(asked), (4, 5))


class Matrices(SceneTest):
    def test_matrix_of_a_parented_and_scaled_object(self):
        parent, quad = self.add("Parent", None), self.add_quad()
        parent.location, parent.rotation_euler, parent.scale = (1, 2, 3), (0.1, 0.2, 0.3), (2, 2, 2)
        quad.parent, quad.location, quad.scale = parent, (0, 1, 0), (1, -3, 1)
        bpy.context.view_layer.update()
        expected = Matrix.LocRotScale(parent.location, parent.rotation_euler, parent.scale) @ Matrix.LocRotScale(
            quad.location, None, quad.scale
        )
        np.testing.assert_allclose(self.gather().instances[0].matrix, np.array(expected), rtol=1e-5, atol=1e-6)
