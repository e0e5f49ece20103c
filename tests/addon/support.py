# SPDX-License-Identifier: GPL-3.0-or-later
"""What the add-on's tests share: fresh scenes, exports as data, renders in a Blender of their own, and a small EXR reader."""

from __future__ import annotations

import json
import os
import struct
import subprocess
import tempfile
import unittest
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from wardmis.export.model import SceneData
from wardmis.export.scene import gather_scene

HERE = Path(__file__).resolve().parent
ADDON = HERE.parents[1] / "addon" / "wardmis"
FAKE = HERE / "fake_renderer.py"


class SceneTest(unittest.TestCase):
    """A test that begins with a new scene of one camera."""

    def setUp(self) -> None:
        old = list(bpy.data.scenes)
        self.scene = bpy.data.scenes.new("Test")
        bpy.context.window.scene = self.scene
        bpy.data.batch_remove(old)
        names = "objects collections meshes materials worlds lights cameras images curves metaballs node_groups volumes"
        for name in names.split():
            bpy.data.batch_remove(list(getattr(bpy.data, name)))
        self.scene.render.engine = "WARDMIS"
        self.camera = self.add("Camera", bpy.data.cameras.new("Camera"))
        self.scene.camera = self.camera

    def add(self, name: str, data: Any, collection: Any = None) -> Any:
        obj = bpy.data.objects.new(name, data)
        (collection or self.scene.collection).objects.link(obj)
        return obj

    def add_mesh(self, name: str, vertices: Any, faces: Any) -> Any:
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata(vertices, [], faces)
        return self.add(name, mesh)

    def add_quad(self, name: str = "Quad") -> Any:
        return self.add_mesh(name, [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2, 3)])

    def gather(self) -> SceneData:
        return gather_scene(bpy.context.evaluated_depsgraph_get(), "test")


def textured_material(name: str = "Textured") -> Any:
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = bpy.data.images.new(name, 4, 4)
    principled = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    tree.links.new(texture.outputs["Color"], principled.inputs["Base Color"])
    return material


def read_glb(path: Path) -> tuple[dict[str, Any], bytes]:
    data = path.read_bytes()
    magic, version, size, length, kind = struct.unpack_from("<4sII I4s", data)
    assert (magic, version, size, kind) == (b"glTF", 2, len(data), b"JSON"), (magic, version, size, len(data), kind)
    binary_length, binary_kind = struct.unpack_from("<I4s", data, 20 + length)
    assert binary_kind == b"BIN\0" and 28 + length + binary_length == size
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def accessor(document: dict[str, Any], binary: bytes, index: int) -> np.ndarray:
    a = document["accessors"][index]
    view = document["bufferViews"][a["bufferView"]]
    width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[a["type"]]
    dtype = {5125: np.uint32, 5126: np.float32}[a["componentType"]]
    values = np.frombuffer(binary, dtype, a["count"] * width, view["byteOffset"])
    assert values.nbytes == view["byteLength"]
    return values.reshape(-1, width) if width > 1 else values


class Run:
    """The outcome of a Blender that ran on its own, with clean user folders."""

    def __init__(self, folder: Path, process: subprocess.CompletedProcess[str], log: Path) -> None:
        self.code = process.returncode
        self.output = process.stdout + process.stderr
        self.images = sorted(p for p in folder.iterdir() if p.name.startswith("image"))
        self.calls = [json.loads(line) for line in log.read_text().splitlines()] if log.exists() else []
        self.left_over = [p.name for p in (folder / "tmp").rglob("wardmis-*")]


def blender(
    folder: Path, script: str, *arguments: str, fake: str = "good", window: bool = False, **environment: str
) -> subprocess.Popen[str]:
    """Starts a Blender with the add-on, without a window if not told; `script` sets the scene up, `arguments` are Blender's own."""
    scripts = folder / "scripts"
    if not scripts.exists():
        (scripts / "addons").mkdir(parents=True)
        (scripts / "addons" / "wardmis").symlink_to(ADDON, target_is_directory=True)
        (folder / "config").mkdir()
        (folder / "tmp").mkdir(exist_ok=True)
    (folder / "setup.py").write_text(
        "import bpy\nscene = bpy.context.scene\nscene.render.resolution_percentage = 5\n" + script
    )
    clean = {
        "BLENDER_USER_RESOURCES": str(folder / "resources"),
        "BLENDER_USER_SCRIPTS": str(scripts),
        "BLENDER_USER_CONFIG": str(folder / "config"),
        "TMPDIR": str(folder / "tmp"),
        "WARDMIS_BINARY": str(FAKE),
        "WARDMIS_FAKE": fake,
        "WARDMIS_FAKE_LOG": str(folder / "calls.log"),
    }
    command = [
        bpy.app.binary_path,
        *([] if window else ["--background"]),
        "--factory-startup",
        "--python-exit-code",
        "1",
        "--addons",
        "wardmis",
    ]
    command += [
        "--python",
        str(folder / "setup.py"),
        "--engine",
        "WARDMIS",
        "--render-output",
        str(folder / "image_####"),
        *arguments,
    ]
    return subprocess.Popen(
        command,
        env={**os.environ, **clean, **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
    )


class RenderTest(unittest.TestCase):
    """A test that renders in a Blender of its own."""

    def setUp(self) -> None:
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def run_blender(self, script: str = "", *arguments: str, **options: Any) -> Run:
        process = blender(self.folder, script, *(arguments or ("--render-frame", "1")), **options)
        output, errors = process.communicate(timeout=120)
        return Run(
            self.folder,
            subprocess.CompletedProcess(process.args, process.returncode, output, errors),
            self.folder / "calls.log",
        )


def exr_attributes(path: Path) -> tuple[dict[str, bytes], int]:
    """The header of an OpenEXR, and where it ends."""
    data = path.read_bytes()
    assert struct.unpack_from("<I", data)[0] == 20000630, path
    attributes, at = {}, 8
    while data[at]:
        name, at = _string(data, at)
        _, at = _string(data, at)
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def read_exr(path: Path) -> dict[str, np.ndarray]:
    """The channels of an uncompressed, single-part, scan-line OpenEXR; row 0 is the top one."""
    data = path.read_bytes()
    attributes, at = exr_attributes(path)
    assert attributes["compression"] == b"\0", f"{path} is compressed"
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    channels, position = [], 0
    while attributes["channels"][position]:
        name, position = _string(attributes["channels"], position)
        (kind,) = struct.unpack_from("<i", attributes["channels"], position)
        channels.append((name, {1: np.dtype("<f2"), 2: np.dtype("<f4")}[kind]))
        position += 16
    image = {name: np.empty((height, width), np.float32) for name, _ in channels}
    for offset in struct.unpack_from(f"<{height}Q", data, at):
        (line,) = struct.unpack_from("<i", data, offset)
        start = offset + 8
        for name, kind in channels:
            image[name][line - y0] = np.frombuffer(data, kind, width, start)
            start += width * kind.itemsize
    return image


def _string(data: bytes, at: int) -> tuple[str, int]:
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1
