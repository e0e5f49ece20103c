# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of the comparison share."""

from __future__ import annotations

import itertools
import json
import os
import tempfile
from pathlib import Path
from unittest import mock

import bpy
import numpy as np
from support import FAKE, SceneTest, read_glb
from wardmis.comparison import run

SMALL = {"seeds": 2, "max_spp": 2, "cycles_reference_spp": 4}


class ComparisonTest(SceneTest):
    """A test with a lit diffuse floor of 16 x 8 pixels, a fake renderer, and a folder."""

    def setUp(self) -> None:
        super().setUp()
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        # names as users have them
        self.folder = Path(temporary.name) / "Vergleich Nr. 1 – äöü"
        self.log = Path(temporary.name) / "calls.log"
        environment = {"WARDMIS_BINARY": str(FAKE), "WARDMIS_FAKE_LOG": str(self.log), "WARDMIS_FAKE": "good"}
        patch = mock.patch.dict(os.environ, environment)
        patch.start()
        self.addCleanup(patch.stop)
        render = self.scene.render
        render.resolution_x, render.resolution_y, render.resolution_percentage = 16, 8, 100
        self.camera.location = (0, 0, 3)
        self.floor = self.add_quad("Floor")
        self.material = bpy.data.materials.new("Plaster")
        self.material.use_nodes = True
        tree = self.material.node_tree
        self.shader = tree.nodes.new("ShaderNodeBsdfDiffuse")
        tree.links.new(self.shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
        self.floor.data.materials.append(self.material)
        lamp = self.add("Lamp", bpy.data.lights.new("Lamp", "POINT"))
        lamp.location, lamp.data.energy = (0.3, 0.2, 2), 100

    def calls(self) -> list[list[str]]:
        return (
            [json.loads(line)["arguments"] for line in self.log.read_text().splitlines()] if self.log.exists() else []
        )

    def manifest(self) -> dict:
        return json.loads((self.folder / "cycles" / "manifest.json").read_text(encoding="utf-8"))

    def export_with_noise(self) -> None:
        """From now on each export differs in the last bits of its normals, as those of large meshes do."""
        for polygon in self.floor.data.polygons:
            polygon.use_smooth = True
        counted, export = itertools.count(1), run.export_scene

        def noisy(path: Path) -> None:
            export(path)
            perturb(path, "NORMAL", 1e-7 * next(counted))

        patch = mock.patch.object(run, "export_scene", noisy)
        patch.start()
        self.addCleanup(patch.stop)

    def make_shiny(self) -> None:
        tree = self.material.node_tree
        node = tree.nodes.new("WardBSDFNode")
        tree.links.new(node.outputs[0], tree.get_output_node("ALL").inputs["Surface"])


def perturb(path: Path, attribute: str, by: float) -> None:
    """Adds `by` to the first number of the first mesh's `attribute`."""
    document, binary = read_glb(path)
    accessor = document["accessors"][document["meshes"][0]["primitives"][0]["attributes"][attribute]]
    data = bytearray(path.read_bytes())
    at = len(data) - len(binary) + document["bufferViews"][accessor["bufferView"]]["byteOffset"]
    number = np.frombuffer(data, "<f4", 1, at)
    number += np.float32(by)
    path.write_bytes(data)
