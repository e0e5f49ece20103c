# SPDX-License-Identifier: GPL-3.0-or-later
"""The file that is written: valid GLB, and every array, matrix and setting readable from it again."""

from __future__ import annotations

import os
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
from support import accessor, read_glb
from wardmis.export import glb, target
from wardmis.export.context import ExportError
from wardmis.export.model import (
    CameraData,
    ColorInput,
    FilmData,
    ImageData,
    InstanceData,
    LightData,
    MaterialData,
    MeshData,
    PrimitiveData,
    ScalarInput,
    SceneData,
    TextureData,
    TextureUse,
    WorldData,
)


def rotation(random: np.random.Generator) -> np.ndarray:
    q, r = np.linalg.qr(random.normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


def matrix(linear: np.ndarray, translation=(0, 0, 0)) -> np.ndarray:
    result = np.eye(4)
    result[:3, :3], result[:3, 3] = linear, translation
    return result


def triangle(name: str = "Triangle", **arrays) -> MeshData:
    positions = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], np.float32)
    return MeshData(
        name, positions, arrays.get("normals"), arrays.get("uvs"), [PrimitiveData(0, np.array([(0, 1, 2)], np.uint32))]
    )


def scene(**parts) -> SceneData:
    camera = CameraData("Camera", np.eye(4), "perspective", (-0.36, 0.36, -0.2, 0.2), (0.1, 100))
    return SceneData(
        "test", FilmData((64, 32), (0, 0, 64, 32)), camera, **{"materials": [MaterialData("Grey")], **parts}
    )


class GlbTest(unittest.TestCase):
    def setUp(self) -> None:
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        self.path = self.folder / "scene.glb"

    def write(self, data: SceneData):
        glb.write_glb(data, self.path)
        return read_glb(self.path)


class Structure(GlbTest):
    def test_smallest_scene(self):
        document, binary = self.write(scene(materials=[]))
        self.assertEqual(document["asset"]["version"], "2.0")
        self.assertEqual(binary, b"")
        extension = document["extensions"]["WARDMIS_scene"]
        self.assertEqual((extension["version"], extension["upAxis"]), (1, "Z"))
        self.assertIn("camera", document["nodes"][extension["camera"]])
        self.assertNotIn("world", extension)
        self.assertNotIn("lights", extension)
        for key, value in document.items():
            self.assertNotEqual(value, [], f"{key} is empty, which glTF forbids")

    def test_arrays_come_back(self):
        normals = np.array([(0, 0, 1)] * 3, np.float32)
        uvs = np.array([(0, 0), (1, 0), (0, 0.25)], np.float32)
        document, binary = self.write(scene(meshes=[triangle(normals=normals, uvs=uvs)]))
        primitive = document["meshes"][0]["primitives"][0]
        read = {key: accessor(document, binary, index) for key, index in primitive["attributes"].items()}
        np.testing.assert_array_equal(read["NORMAL"], normals)
        np.testing.assert_array_equal(read["TEXCOORD_0"][:, 1], 1 - uvs[:, 1])  # glTF counts v from the top
        np.testing.assert_array_equal(accessor(document, binary, primitive["indices"]), (0, 1, 2))
        bounds = document["accessors"][primitive["attributes"]["POSITION"]]
        self.assertEqual((bounds["min"], bounds["max"]), ([0, 0, 0], [1, 1, 0]))
        for view in document["bufferViews"]:
            self.assertEqual(view["byteOffset"] % 4, 0)

    def test_shared_arrays_are_written_once(self):
        one, two = triangle("One"), triangle("Two")
        two.positions = one.positions
        document, _ = self.write(scene(meshes=[one, two]))
        positions = [m["primitives"][0]["attributes"]["POSITION"] for m in document["meshes"]]
        self.assertEqual(positions[0], positions[1])

    def test_too_large_for_a_glb(self):
        with (
            mock.patch.object(glb, "MAX_BYTES", 100),
            self.assertRaisesRegex(ExportError, "a GLB file holds 4 GiB; use instances"),
        ):
            self.write(scene(meshes=[triangle()]))
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_failed_write_leaves_the_old_file(self):
        self.path.write_text("old")
        with (
            mock.patch.object(target.os, "replace", side_effect=OSError(28, "No space left on device", "hidden.tmp")),
            self.assertRaisesRegex(ExportError, f"^{self.path} cannot be written: No space left on device$"),
        ):
            self.write(scene())
        self.assertEqual([p.read_text() for p in self.folder.iterdir()], ["old"])

    def test_what_is_no_file_is_refused_and_left_alone(self):
        pipe, link = self.folder / "pipe", self.folder / "link"
        os.mkfifo(pipe)
        link.symlink_to(pipe)
        for path, says in (
            (pipe, "is a device or a pipe"),
            (link, "is a device or a pipe"),
            (self.folder, "is a folder"),
            (self.folder / "none" / "scene.glb", "the folder .*none does not exist"),
        ):
            with self.assertRaisesRegex(ExportError, f"^{path} .*{says}"):
                glb.write_glb(scene(), path)
        self.assertTrue(pipe.is_fifo() and link.is_symlink())
        self.assertEqual(len(list(self.folder.iterdir())), 2)

    def test_link_to_a_file_stays(self):
        link = self.folder / "link.glb"
        link.symlink_to(self.path)
        glb.write_glb(scene(), link)
        self.assertEqual(link.read_bytes()[:4], b"glTF")
        self.assertTrue(link.is_symlink() and not self.path.is_symlink())


class Instances(GlbTest):
    def world_matrices(self, document, binary) -> list[np.ndarray]:
        """Of everything that has a mesh, in Blender's axes, as a reader of glTF sees it."""
        found = []

        def visit(index: int, parent: np.ndarray) -> None:
            node = document["nodes"][index]
            local = np.array(node.get("matrix", np.eye(4).reshape(-1))).reshape(4, 4).T
            world = parent @ local
            if "mesh" in node:
                instancing = node.get("extensions", {}).get("EXT_mesh_gpu_instancing")
                found.extend(
                    [world]
                    if instancing is None
                    else [world @ m for m in self.instances(document, binary, instancing["attributes"])]
                )
            for child in node.get("children", []):
                visit(child, world)

        for root in document["scenes"][document["scene"]]["nodes"]:
            visit(root, np.eye(4))
        z_up = np.array(
            [[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]
        )  # (x, y, z) of glTF is (x, -z, y) of Blender
        return [z_up @ m for m in found]

    def instances(self, document, binary, attributes):
        parts = (
            accessor(document, binary, attributes[key]).astype(float) for key in ("TRANSLATION", "ROTATION", "SCALE")
        )
        for t, (x, y, z, w), s in zip(*parts):
            turn = np.array(
                [
                    [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
                ]
            )
            yield matrix(turn * s, t)

    def check(self, matrices: list[np.ndarray]):
        document, binary = self.write(scene(meshes=[triangle()], instances=[InstanceData("I", 0, m) for m in matrices]))
        read = self.world_matrices(document, binary)
        self.assertEqual(len(read), len(matrices))
        unmatched = list(read)
        for expected in matrices:
            best = min(unmatched, key=lambda m: np.abs(m - expected).max())
            np.testing.assert_allclose(best, expected, atol=2e-6 * max(1, np.abs(expected).max()))
        return document

    def test_one_instance_is_a_node_with_its_matrix(self):
        document = self.check([matrix(rotation(np.random.default_rng(1)) * 2, (1, 2, 3))])
        self.assertNotIn("extensionsRequired", document)

    def test_turned_scaled_and_mirrored_instances_share_a_node(self):
        random = np.random.default_rng(2)
        matrices = [matrix(rotation(random) * (random.random(3) + 0.1), random.normal(size=3)) for _ in range(50)]
        matrices += [matrix(np.diag((-1, 1, 1))), matrix(rotation(random) * (1, -2, 3)), matrix(-np.eye(3))]
        for axis in range(3):  # half turns, where a quaternion's w is zero
            half = -np.ones(3)
            half[axis] = 1
            matrices.append(matrix(np.diag(half)))
        document = self.check(matrices)
        self.assertEqual(document["extensionsRequired"], ["EXT_mesh_gpu_instancing"])
        self.assertEqual(sum("mesh" in node for node in document["nodes"]), 1)

    def test_sheared_and_flattened_instances_are_nodes(self):
        sheared = matrix(np.array([(1, 0.5, 0), (0, 1, 0), (0, 0, 1)]))
        document = self.check([np.eye(4), matrix(np.eye(3), (2, 0, 0)), sheared, matrix(np.diag((1, 1, 0)))])
        self.assertEqual(sum("mesh" in node for node in document["nodes"]), 3)

    def test_visibility_divides_the_instances(self):
        hidden = frozenset({"camera", "shadow"})
        instances = [InstanceData("I", 0, np.eye(4), h) for h in (frozenset(), frozenset(), hidden, hidden)]
        document, _ = self.write(scene(meshes=[triangle()], instances=instances))
        extensions = [node.get("extensions", {}).get("WARDMIS_scene") for node in document["nodes"] if "mesh" in node]
        self.assertEqual(extensions, [None, {"visibility": ["diffuse", "glossy", "transmission"]}])


class Content(GlbTest):
    def test_material(self):
        material = MaterialData(
            "Brushed",
            "ward-dur",
            ColorInput((0.2, 0.1, 0)),
            ColorInput((1, 1, 1), TextureUse(0)),
            ScalarInput(0.1),
            ScalarInput(1.0, TextureUse(1, 2, (2, 0, 0, 0, 2, 0.5))),
            0.3,
            ColorInput((3, 3, 0)),
        )
        images = [
            ImageData("photo", encoded=b"PNG..", mime_type="image/png", filter_encoded=True, alpha="multiplies"),
            ImageData("data", "linear", pixels=np.zeros((2, 3, 4), np.float32)),
        ]
        textures = [TextureData(0), TextureData(1, "mirror", "nearest"), TextureData(0, "clip", "cubic")]
        document, _ = self.write(scene(materials=[material], images=images, textures=textures))
        written = document["materials"][0]["extensions"]["WARDMIS_scene"]
        self.assertEqual(written["variant"], "ward-dur")
        self.assertEqual(written["diffuse"], {"value": [0.2, 0.1, 0]})
        self.assertEqual(written["specular"], {"value": [1, 1, 1], "texture": {"index": 0}})
        self.assertEqual(
            written["alphaY"], {"value": 1.0, "texture": {"index": 1, "channel": 2, "transform": [2, 0, 0, 0, 2, 0.5]}}
        )
        self.assertEqual((written["rotation"], written["emission"]), (0.3, {"value": [3, 3, 0]}))
        self.assertEqual(
            document["materials"][0]["extensions"]["KHR_materials_emissive_strength"], {"emissiveStrength": 3}
        )
        self.assertEqual(document["materials"][0]["emissiveFactor"], [1, 1, 0])
        self.assertEqual(document["images"][1]["mimeType"], "application/x-wardmis-pixels")
        self.assertEqual(
            document["images"][0]["extensions"]["WARDMIS_scene"],
            {"colorSpace": "sRGB", "filterEncoded": True, "alpha": "multiplies"},
        )
        self.assertEqual(document["textures"][2]["extensions"]["WARDMIS_scene"], {"filter": "cubic", "wrap": "clip"})
        self.assertNotIn("extensions", document["textures"][1])
        expected = {"colorSpace": "linear", "width": 3, "height": 2, "channels": 4, "type": "f32"}
        self.assertEqual(document["images"][1]["extensions"]["WARDMIS_scene"], expected)
        self.assertEqual(
            document["samplers"][document["textures"][1]["sampler"]],
            {"magFilter": 9728, "wrapS": 33648, "wrapT": 33648},
        )
        # other viewers get the PNG
        self.assertEqual(document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"], {"index": 0})

    def test_lights(self):
        lights = [
            LightData("Area", "area", np.eye(4), (1, 1, 1), 5.0, shape="ellipse", size=(1, 2), spread=1.0),
            LightData(
                "Spot",
                "spot",
                np.eye(4),
                (1, 0, 0),
                7.0,
                radius=0.1,
                angle=0.5,
                blend=0.2,
                hidden_from=frozenset({"camera"}),
            ),
            LightData("Sun", "sun", np.eye(4), (1, 1, 1), 3.0, angle=0.01, shadow=False),
        ]
        document, _ = self.write(scene(lights=lights))
        area, spot, sun = document["extensions"]["WARDMIS_scene"]["lights"]
        self.assertEqual((area["shape"], area["size"], area["radiance"], area["spread"]), ("ellipse", [1, 2], 5.0, 1.0))
        self.assertEqual((spot["intensity"], spot["angle"], spot["blend"], spot["cosine"]), (7.0, 0.5, 0.2, False))
        self.assertEqual((sun["irradiance"], sun["angle"], sun["shadow"]), (3.0, 0.01, False))
        nodes = [n["extensions"]["WARDMIS_scene"] for n in document["nodes"] if "extensions" in n]
        seen = ["diffuse", "glossy", "transmission", "shadow"]
        self.assertEqual(nodes, [{"light": 0}, {"light": 1, "visibility": seen}, {"light": 2}])

    def test_world_film_and_notes(self):
        data = scene(
            images=[ImageData("sky", "linear", b"v/1\x01", "image/x-exr")], textures=[TextureData(0)], notes=["a note"]
        )
        turned = np.array([(0.0, -1, 0), (1, 0, 0), (0, 0, 1)])
        data.worlds = [WorldData((2, 2, 2), 0, matrix=turned)]
        data.film = FilmData((64, 32), (8, 4, 16, 12), "gaussian", 2.0, 0.5, True)
        extension = self.write(data)[0]["extensions"]["WARDMIS_scene"]
        self.assertEqual(
            extension["world"], {"radiance": [2, 2, 2], "texture": {"index": 0, "matrix": [0, -1, 0, 1, 0, 0, 0, 0, 1]}}
        )
        film = {
            "resolution": [64, 32],
            "border": [8, 4, 16, 12],
            "filter": {"type": "gaussian", "width": 2.0},
            "exposure": 0.5,
            "transparent": True,
        }
        self.assertEqual((extension["film"], extension["notes"]), (film, ["a note"]))

    def test_panorama(self):
        data = scene()
        data.camera.projection, data.camera.view_plane = "fisheye-polynomial", (-18, 18, -12, 12)
        data.camera.fov, data.camera.polynomial = 3.0, (0.0, 0.02, 0.0, 0.0, 0.0)
        camera = self.write(data)[0]["cameras"][0]
        self.assertEqual(camera["perspective"]["aspectRatio"], 1)
        extension = camera["extensions"]["WARDMIS_scene"]
        self.assertEqual((extension["projection"], extension["viewPlane"]), ("fisheye-polynomial", [-18, 18, -12, 12]))
        self.assertEqual((extension["fov"], extension["polynomial"]), (3.0, [0, 0.02, 0, 0, 0]))

    def test_orthographic_camera_for_other_viewers(self):
        data = scene()
        data.camera.projection, data.camera.view_plane = "orthographic", (-2, 4, -1, 1)
        camera = self.write(data)[0]["cameras"][0]
        self.assertEqual(camera["orthographic"], {"xmag": 3, "ymag": 1, "znear": 0.1, "zfar": 100})
        self.assertEqual(camera["extensions"]["WARDMIS_scene"]["viewPlane"], [-2, 4, -1, 1])
