# SPDX-License-Identifier: GPL-3.0-or-later
"""SceneData -> a binary glTF file with the extension WARDMIS_scene (docs/scene-format.md). No bpy in here."""

from __future__ import annotations

import json
import math
import os
import struct
from collections.abc import Callable
from typing import Any

import numpy as np

from .context import ExportError
from .model import (
    IDENTITY_TRANSFORM,
    VISIBILITY,
    CameraData,
    ClosureData,
    ColorInput,
    FileOnDisk,
    ImageData,
    InstanceData,
    LightData,
    MaterialData,
    MeshData,
    ScalarInput,
    SceneData,
    TextureUse,
    WorldData,
)
from .target import writing

EXTENSION = "WARDMIS_scene"
INSTANCING = "EXT_mesh_gpu_instancing"
EMISSIVE_STRENGTH = "KHR_materials_emissive_strength"

# Blender's axes (Z up) to glTF's (Y up): (x, y, z) -> (x, z, -y)
Z_UP = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], np.float64)

FLOAT, UINT32 = 5126, 5125
TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
ARRAY_BUFFER, INDEX_BUFFER = 34962, 34963
POINTS, LINES = 0, 1
WRAP = {"repeat": 10497, "clamp": 33071, "mirror": 33648, "clip": 33071}
NEAREST, LINEAR = 9728, 9729
CORE_IMAGES = {"image/png", "image/jpeg"}
PANORAMA_OF_OTHERS = (-1.0, 1.0, -1.0, 1.0)
WRITE_STEP = 16 << 20
MAX_BYTES = 2**32 - 1  # a GLB counts its bytes in 32 bits


def write_glb(
    scene: SceneData, path: str | os.PathLike[str], check_cancelled: Callable[[], None] = lambda: None
) -> None:
    """Writes `scene` to `path`, completely or not at all. ExportError if that fails, or if the scene is too large."""
    encoder = _Encoder()
    document = encoder.encode(scene)
    text = json.dumps(document, separators=(",", ":"), allow_nan=False).encode()
    text += b" " * (-len(text) % 4)
    size = 12 + 8 + len(text) + 8 + encoder.length
    if size > MAX_BYTES:
        raise ExportError(
            f"the scene needs {size / 2**30:.1f} GiB, and a GLB file holds 4 GiB; use instances, or fewer or smaller meshes and images"
        )
    header = struct.pack("<4sII", b"glTF", 2, size) + struct.pack("<I4s", len(text), b"JSON") + text
    header += struct.pack("<I4s", encoder.length, b"BIN\0")
    with writing(path) as file:
        for chunk in (header, *encoder.chunks):
            view = memoryview(_content(chunk)).cast("B")
            for start in range(0, len(view), WRITE_STEP):
                _write_all(file, view[start : start + WRITE_STEP])
                check_cancelled()


def _content(chunk: Any) -> Any:
    if not isinstance(chunk, FileOnDisk):
        return chunk
    try:
        with open(chunk.path, "rb") as file:
            content = file.read()
    except OSError as error:
        raise ExportError(f"image file '{chunk.path}' cannot be read any more: {error.strerror}") from error
    if len(content) != chunk.size:
        raise ExportError(f"image file '{chunk.path}' has changed while the scene was exported; export it again")
    return content


def _write_all(file: Any, view: memoryview) -> None:
    while len(view):
        view = view[file.write(view) :]


class _Encoder:
    """Collects the JSON and, in `chunks`, what follows it in the binary part: views of the scene's own arrays, and files."""

    def __init__(self) -> None:
        self.chunks: list[Any] = []
        self.length = 0
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        self.nodes: list[dict[str, Any]] = []
        self.used = {EXTENSION}
        self.required: set[str] = set()
        self._accessor_of: dict[tuple[int, str], int] = {}  # arrays live as long as the scene, so that id() is a key
        self._texture_is_core: list[bool] = []

    def encode(self, scene: SceneData) -> dict[str, Any]:
        document: dict[str, Any] = {"asset": {"version": "2.0", "generator": scene.generator}, "scene": 0}
        document["images"] = [self._image(image) for image in scene.images]
        document["samplers"], document["textures"] = self._textures(scene)
        document["materials"] = [self._material(material) for material in scene.materials]
        document["meshes"] = [self._mesh(mesh) for mesh in scene.meshes]
        root = self._node({"name": "Blender (Z up)", "matrix": _column_major(Z_UP)})
        children = self._instances(scene.instances, scene.meshes)
        children += [self._light_node(light, i) for i, light in enumerate(scene.lights)]
        motion = {"motion": [_column_major(matrix) for matrix in scene.camera.motion]} if scene.camera.motion else {}
        camera = self._node(
            {"name": scene.camera.name, "matrix": _column_major(scene.camera.matrix), "camera": 0}, motion
        )
        self.nodes[root]["children"] = [*children, camera]
        document["cameras"] = [_camera(scene.camera)]
        document["scenes"] = [{"nodes": [root]}]
        document["nodes"] = self.nodes
        document["extensions"] = {EXTENSION: self._scene_extension(scene, camera)}
        document["accessors"] = self.accessors
        document["bufferViews"] = self.views
        document["buffers"] = [{"byteLength": self.length}] if self.length else []
        document["extensionsUsed"] = sorted(self.used)
        document["extensionsRequired"] = sorted(self.required)
        return {key: value for key, value in document.items() if value != []}

    # --- binary -----------------------------------------------------------------------------------------------------

    def _view(self, data: Any, target: int | None = None) -> int:
        size = data.size if isinstance(data, FileOnDisk) else memoryview(data).nbytes
        view = {"buffer": 0, "byteOffset": self.length, "byteLength": size}
        if target is not None:
            view["target"] = target
        self.views.append(view)
        padding = -size % 4
        self.chunks.append(data)
        if padding:
            self.chunks.append(bytes(padding))
        self.length += size + padding
        return len(self.views) - 1

    def _accessor(self, array: np.ndarray, role: str = "") -> int:
        """`role` is POSITION (which must carry its bounds), INDICES, UV (whose v glTF counts from the top) or nothing."""
        key = (id(array), role)
        if key in self._accessor_of:
            return self._accessor_of[key]
        data = np.ascontiguousarray(array)
        if role == "UV":
            data = data.copy()
            np.subtract(1, data[:, 1], out=data[:, 1])
        flat = data.reshape(-1) if role == "INDICES" else data
        target = {"INDICES": INDEX_BUFFER, "INSTANCES": None}.get(role, ARRAY_BUFFER)
        accessor: dict[str, Any] = {
            "bufferView": self._view(flat, target),
            "componentType": UINT32 if data.dtype == np.uint32 else FLOAT,
            "count": len(flat),
            "type": TYPES[1 if flat.ndim == 1 else flat.shape[1]],
        }
        if role == "POSITION":
            # column by column: numpy's reduction over the first axis of narrow arrays is slow
            accessor["min"] = [float(data[:, k].min()) for k in range(3)]
            accessor["max"] = [float(data[:, k].max()) for k in range(3)]
        self.accessors.append(accessor)
        self._accessor_of[key] = len(self.accessors) - 1
        return self._accessor_of[key]

    # --- images and materials ---------------------------------------------------------------------------------------

    def _image(self, image: ImageData) -> dict[str, Any]:
        extension: dict[str, Any] = {"colorSpace": image.color_space}
        if image.filter_encoded:
            extension["filterEncoded"] = True
        if image.alpha != "kept":
            extension["alpha"] = image.alpha
        extension |= {name: value for name in ("halvings", "limit") if (value := getattr(image, name))}
        if image.encoded is not None:
            return {
                "name": image.name,
                "mimeType": image.mime_type,
                "bufferView": self._view(image.encoded),
                "extensions": {EXTENSION: extension},
            }
        assert image.pixels is not None
        height, width, channels = image.pixels.shape
        kind = "u8" if image.pixels.dtype == np.uint8 else "f32"
        extension |= {"width": width, "height": height, "channels": channels, "type": kind}
        return {
            "name": image.name,
            "mimeType": "application/x-wardmis-pixels",
            "bufferView": self._view(np.ascontiguousarray(image.pixels)),
            "extensions": {EXTENSION: extension},
        }

    def _textures(self, scene: SceneData) -> tuple[list[dict[str, int]], list[dict[str, Any]]]:
        samplers: list[dict[str, int]] = []
        textures = []
        for texture in scene.textures:
            wrap = WRAP[texture.wrap]
            sampler = {"magFilter": NEAREST if texture.filter == "nearest" else LINEAR, "wrapS": wrap, "wrapT": wrap}
            if sampler not in samplers:
                samplers.append(sampler)
            result: dict[str, Any] = {"sampler": samplers.index(sampler), "source": texture.image}
            extension = {}
            if texture.filter == "cubic":
                extension["filter"] = "cubic"
            if texture.wrap == "clip":
                extension["wrap"] = "clip"
            if extension:
                result["extensions"] = {EXTENSION: extension}
            textures.append(result)
            self._texture_is_core.append(scene.images[texture.image].mime_type in CORE_IMAGES)
        return samplers, textures

    def _material(self, material: MaterialData) -> dict[str, Any]:
        extension: dict[str, Any] = {}
        if material.closures:
            extension["closures"] = [_closure(closure) for closure in material.closures]
            if not material.transparent_shadow:
                extension["transparentShadow"] = False
        else:
            extension["variant"] = material.variant
        for key, value in (
            ("diffuse", material.diffuse),
            ("specular", material.specular),
            ("emission", material.emission),
        ):
            if any(value.value):
                extension[key] = _input(value)
        if "specular" in extension:
            extension |= {
                "alphaX": _input(material.alpha_x),
                "alphaY": _input(material.alpha_y),
                "rotation": material.rotation,
            }
        if material.normal is not None:
            extension["normal"] = {"result": material.normal.result}
        if material.index:
            extension["index"] = material.index
        if material.program is not None:
            extension["program"] = {"operations": material.program.operations}
        return {
            "name": material.name,
            **self._core_material(material),
            "extensions": self._core_extensions(material, extension),
        }

    def _core_material(self, material: MaterialData) -> dict[str, Any]:
        """What other glTF viewers show."""
        base, texture, metallic, roughness = _plain_look(material)
        pbr: dict[str, Any] = {
            "baseColorFactor": [*np.clip(base, 0, 1).tolist(), 1.0],
            "metallicFactor": min(max(metallic, 0.0), 1.0),
            "roughnessFactor": min(max(roughness, 0.0), 1.0),
        }
        if texture is not None and self._texture_is_core[texture.index]:
            pbr["baseColorTexture"] = {"index": texture.index}
        core: dict[str, Any] = {"pbrMetallicRoughness": pbr, "doubleSided": True}
        peak = max(material.emission.value)
        if peak > 0:
            core["emissiveFactor"] = [max(v, 0.0) / max(peak, 1.0) for v in material.emission.value]
        return core

    def _core_extensions(self, material: MaterialData, extension: dict[str, Any]) -> dict[str, Any]:
        extensions = {EXTENSION: extension}
        peak = max(material.emission.value)
        if peak > 1:
            self.used.add(EMISSIVE_STRENGTH)
            extensions[EMISSIVE_STRENGTH] = {"emissiveStrength": peak}
        return extensions

    # --- meshes and instances ---------------------------------------------------------------------------------------

    def _mesh(self, mesh: MeshData) -> dict[str, Any]:
        attributes = {"POSITION": self._accessor(mesh.positions, "POSITION")}
        if mesh.normals is not None:
            attributes["NORMAL"] = self._accessor(mesh.normals)
        if mesh.uvs is not None:
            attributes["TEXCOORD_0"] = self._accessor(mesh.uvs, "UV")
        names = [name for name, uvs in mesh.uv_sets.items() if uvs is mesh.uvs]
        names = names or ([""] if mesh.uvs is not None else [])
        for name, uvs in mesh.uv_sets.items():
            if uvs is not mesh.uvs:
                attributes[f"TEXCOORD_{len(names)}"] = self._accessor(uvs, "UV")
                names.append(name)
        attributes |= {f"_{name}": self._accessor(values) for name, values in mesh.attributes.items()}
        for name, values in mesh.tangents.items():
            attributes[f"_TANGENT_{name}" if name else "TANGENT"] = self._accessor(values)
        extension: dict[str, Any] = {"uvSets": names} if any(names) else {}
        if mesh.motion_positions:
            extension["motion"] = {"positions": [self._accessor(p, "POSITION") for p in mesh.motion_positions]}
            if mesh.motion_normals:
                extension["motion"]["normals"] = [self._accessor(n) for n in mesh.motion_normals]
        more: dict[str, Any] = {}
        if mesh.radii is not None:
            attributes["_RADIUS"] = self._accessor(mesh.radii)
            more["mode"] = POINTS if mesh.shape == "spheres" else LINES
            extension |= {"shape": mesh.shape} | ({"pieces": mesh.pieces} if mesh.shape == "ribbons" else {})
            extension |= {"inside": True} if mesh.inside else {}
        if extension:
            more["extensions"] = {EXTENSION: extension}
        primitives = [
            {
                "attributes": attributes,
                "indices": self._accessor(p.triangles, "INDICES"),
                "material": p.material,
                **more,
            }
            for p in mesh.primitives
        ]
        return {"name": mesh.name, "primitives": primitives}

    def _instances(self, instances: list[InstanceData], meshes: list[MeshData]) -> list[int]:
        """A node for each instance; those of one mesh that can be said as translation, rotation and scale share a node."""
        groups: dict[tuple[Any, ...], list[InstanceData]] = {}
        for instance in instances:
            key = (instance.mesh, instance.hidden_from, instance.color, instance.index, instance.random)
            # what moves has a node of its own
            alone_by = (
                id(instance)
                if instance.motion
                else (instance.holdout, instance.shadow_catcher, instance.shadow_terminator)
            )
            groups.setdefault((*key, instance.attributes, alone_by), []).append(instance)
        nodes = []
        for (mesh, *_), members in groups.items():
            alone = members
            extension = _node_extension(members[0], meshes[mesh])
            if len(members) > 1:
                matrices = np.array([m.matrix for m in members])
                translation, rotation, scale, exact = decompose(matrices)
                alone = [member for member, ok in zip(members, exact) if not ok]
                if exact.sum() > 1:
                    parts = {"TRANSLATION": translation[exact], "ROTATION": rotation[exact], "SCALE": scale[exact]}
                    nodes.append(self._instancing_node(mesh, meshes[mesh].name, extension, parts))
                else:
                    alone = members
            for member in alone:
                node = {"name": member.name, "mesh": mesh, "matrix": _column_major(member.matrix)}
                nodes.append(self._node(node, extension))
        return nodes

    def _instancing_node(self, mesh: int, name: str, extension: dict[str, Any], parts: dict[str, np.ndarray]) -> int:
        self.used.add(INSTANCING)
        self.required.add(INSTANCING)
        attributes = {
            key: self._accessor(np.ascontiguousarray(value, np.float32), "INSTANCES") for key, value in parts.items()
        }
        return self._node({"name": name, "mesh": mesh}, extension, {INSTANCING: {"attributes": attributes}})

    def _node(
        self, node: dict[str, Any], extension: dict[str, Any] | None = None, others: dict[str, Any] | None = None
    ) -> int:
        extensions = dict(others or {})
        if extension:
            extensions[EXTENSION] = extension
        if extensions:
            node["extensions"] = extensions
        self.nodes.append(node)
        return len(self.nodes) - 1

    # --- lights, camera, scene --------------------------------------------------------------------------------------

    def _light_node(self, light: LightData, index: int) -> int:
        node = {"name": light.name, "matrix": _column_major(light.matrix)}
        return self._node(node, {"light": index, **_visibility(light.hidden_from)})

    def _scene_extension(self, scene: SceneData, camera: int) -> dict[str, Any]:
        film = scene.film
        result: dict[str, Any] = {
            "version": 1,
            "generator": scene.generator,
            "upAxis": "Z",
            "camera": camera,
            "film": {
                "resolution": list(film.resolution),
                "border": list(film.border),
                "filter": {"type": film.filter_type, "width": film.filter_width},
                "exposure": film.exposure,
                "transparent": film.transparent,
            },
            "notes": scene.notes,
        }
        if film.shutter:
            result["film"]["shutter"] = film.shutter
        if film.alpha_threshold != 0.5:
            result["film"]["alphaThreshold"] = film.alpha_threshold
        if film.keep_uvs:
            result["film"]["keepUvs"] = True
        worlds = [_world(world) for world in scene.worlds if any(world.radiance)]
        if worlds:
            result["world"] = worlds[0] if len(worlds) == 1 else worlds
        if scene.lights:
            result["lights"] = [_light(light) for light in scene.lights]
        return result


def decompose(matrices: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Translations, rotations (quaternions x y z w) and scales of (n, 4, 4) matrices, and which of them are just that (no shear)."""
    axes = matrices[:, :3, :3]
    scale = np.linalg.norm(axes, axis=1)
    scale[np.linalg.det(axes) < 0, 0] *= -1  # a mirrored object: turned, and mirrored along x
    rotation = axes / np.where(scale == 0, 1, scale)[:, None, :]
    product = np.swapaxes(rotation, 1, 2) @ rotation
    exact = np.abs(product - np.eye(3)).max(axis=(1, 2)) < 1e-6
    return matrices[:, :3, 3], _quaternions(rotation), scale, exact


def _quaternions(r: np.ndarray) -> np.ndarray:
    """From rotation matrices, by the largest of the four components, which keeps every digit."""
    xx, yy, zz = r[:, 0, 0], r[:, 1, 1], r[:, 2, 2]
    candidates = np.stack(
        [
            [1 + xx - yy - zz, r[:, 0, 1] + r[:, 1, 0], r[:, 0, 2] + r[:, 2, 0], r[:, 2, 1] - r[:, 1, 2]],
            [r[:, 0, 1] + r[:, 1, 0], 1 - xx + yy - zz, r[:, 1, 2] + r[:, 2, 1], r[:, 0, 2] - r[:, 2, 0]],
            [r[:, 0, 2] + r[:, 2, 0], r[:, 1, 2] + r[:, 2, 1], 1 - xx - yy + zz, r[:, 1, 0] - r[:, 0, 1]],
            [r[:, 2, 1] - r[:, 1, 2], r[:, 0, 2] - r[:, 2, 0], r[:, 1, 0] - r[:, 0, 1], 1 + xx + yy + zz],
        ]
    )  # (candidate, component, n)
    diagonal = candidates[range(4), range(4)]
    best = candidates[diagonal.argmax(axis=0), :, np.arange(len(r))]
    return best / np.linalg.norm(best, axis=1, keepdims=True)


def _column_major(matrix: np.ndarray) -> list[float]:
    return matrix.T.reshape(-1).tolist()


def _visibility(hidden: frozenset[str]) -> dict[str, Any]:
    return {"visibility": [kind for kind in VISIBILITY if kind not in hidden]} if hidden else {}


def _node_extension(instance: InstanceData, mesh: MeshData) -> dict[str, Any]:
    result = _visibility(instance.hidden_from)
    if mesh.generated is not None:
        result["generated"] = list(mesh.generated)
    if instance.color != (1.0, 1.0, 1.0, 1.0):
        result["color"] = list(instance.color)
    if instance.index:
        result["index"] = instance.index
    if instance.motion:
        result["motion"] = [_column_major(matrix) for matrix in instance.motion]
    if instance.holdout:
        result["holdout"] = True
    if instance.shadow_catcher:
        result["shadowCatcher"] = True
    if any(instance.shadow_terminator):
        result["shadowTerminator"] = list(instance.shadow_terminator)
    if instance.random:
        result["random"] = instance.random
    if instance.attributes:
        result["attributes"] = {name: list(values) for name, values in instance.attributes}
    return result


def _texture_use(use: TextureUse, scalar: bool) -> dict[str, Any]:
    result: dict[str, Any] = {"index": use.index}
    if scalar:
        result["channel"] = use.channel
    if tuple(use.transform) != IDENTITY_TRANSFORM:
        result["transform"] = list(use.transform)
    return result


def _plain_look(material: MaterialData) -> tuple[Any, TextureUse | None, float, float]:
    """Colour, its texture, metallic and roughness: a metal where the specular part is larger, else a plastic; of closures the strongest."""
    if not material.closures:
        metallic = float(sum(material.specular.value) > sum(material.diffuse.value))
        color = material.specular if metallic else material.diffuse
        alpha = math.sqrt(material.alpha_x.value * material.alpha_y.value)
        roughness = math.sqrt(alpha) if any(material.specular.value) else 1.0
        return np.add(material.diffuse.value, material.specular.value), color.texture, metallic, roughness

    def color_of(closure: ClosureData) -> ColorInput:
        given: ColorInput | None = closure.inputs.get("baseColor", closure.inputs.get("color"))
        return given or ColorInput((0.8, 0.8, 0.8))

    def number(closure: ClosureData, name: str, default: float) -> float:
        given = closure.inputs.get(name)
        return default if given is None or given.result is not None else float(given.value)

    def strength(closure: ClosureData) -> float:
        weight = closure.weight.value if closure.weight else (1.0, 1.0, 1.0)
        return float(np.dot(weight, color_of(closure).value))

    most = max(material.closures, key=strength)
    color = color_of(most)
    alpha = number(most, "alphaX", number(most, "alpha", 1.0))
    metallic = number(most, "metallic", 1.0 if most.type in {"glossy", "ward"} else 0.0)
    return color.value, color.texture, metallic, number(most, "roughness", math.sqrt(max(alpha, 0.0)))


def _closure(closure: ClosureData) -> dict[str, Any]:
    result: dict[str, Any] = {"type": closure.type, **closure.parameters}
    if closure.weight is not None:
        result["weight"] = _input(closure.weight)
    result |= {name: _input(value) for name, value in closure.inputs.items()}
    for name, normal in (("normal", closure.normal), ("coatNormal", closure.coat_normal), ("tangent", closure.tangent)):
        if normal is not None:
            result[name] = {"result": normal.result}
    return result


def _input(value: ColorInput | ScalarInput) -> dict[str, Any]:
    scalar = isinstance(value, ScalarInput)
    result: dict[str, Any] = {"value": value.value if isinstance(value, ScalarInput) else list(value.value)}
    if value.texture is not None:
        result["texture"] = _texture_use(value.texture, scalar)
    if value.result is not None:
        result["result"] = value.result
    return result


def _world(world: WorldData) -> dict[str, Any]:
    result: dict[str, Any] = {"radiance": list(world.radiance), **_visibility(world.hidden_from)}
    if world.max_bounces != WorldData.max_bounces:
        result["maxBounces"] = world.max_bounces
    if world.cone is not None:
        result["cone"] = {"axis": list(world.cone[:3]), "angle": world.cone[3]}
    if world.program is not None:
        result |= {"program": {"operations": world.program.operations}, "result": world.result}
    if world.texture is not None:
        result["texture"] = {"index": world.texture, "matrix": world.matrix.reshape(-1).tolist()}
        if world.projection != WorldData.projection:
            result["texture"]["projection"] = world.projection
    return result


def _light(light: LightData) -> dict[str, Any]:
    result: dict[str, Any] = {
        "name": light.name,
        "type": light.type,
        "color": list(light.color),
        "shadow": light.shadow,
        "maxBounces": light.max_bounces,
    }
    if not light.met:
        result["met"] = False
    if not light.on_catchers:
        result["onCatchers"] = False
    if light.type == "area":
        result |= {"shape": light.shape, "size": list(light.size), "radiance": light.emission, "spread": light.spread}
    elif light.type == "sun":
        result |= {"irradiance": light.emission, "angle": light.angle}
        if light.flat:
            result["flat"] = True
    else:
        result |= {"intensity": light.emission, "radius": light.radius, "facing": light.facing}
        if light.type == "spot":
            result |= {"angle": light.angle, "blend": light.blend, "cosine": light.cosine}
    if light.program is not None:
        result |= {"program": {"operations": light.program.operations}, "result": light.result}
    return result


def _camera(camera: CameraData) -> dict[str, Any]:
    left, right, bottom, top = camera.view_plane
    near, far = camera.clip
    extension = {
        "projection": camera.projection,
        "viewPlane": list(camera.view_plane),
        "clip": [near, far],
        "lensRadius": camera.lens_radius,
        "focusDistance": camera.focus_distance,
        "blades": camera.blades,
        "bladeRotation": camera.blade_rotation,
        "bladeRatio": camera.blade_ratio,
    }
    if camera.fov is not None:
        extension["fov"] = camera.fov
    if camera.polynomial is not None:
        extension["polynomial"] = list(camera.polynomial)
    if camera.view_planes:
        extension["viewPlanes"] = [list(plane) for plane in camera.view_planes]
    core: dict[str, Any]
    if camera.projection != "orthographic":  # a panorama is none of core glTF's: others see its middle
        if camera.projection != "perspective":
            left, right, bottom, top = PANORAMA_OF_OTHERS
        shape = {"yfov": 2 * math.atan((top - bottom) / 2), "aspectRatio": (right - left) / (top - bottom)}
        core = {"type": "perspective", "perspective": {**shape, "znear": near, "zfar": far}}
    else:
        shape = {"xmag": (right - left) / 2, "ymag": (top - bottom) / 2}
        core = {"type": "orthographic", "orthographic": {**shape, "znear": near, "zfar": far}}
    return {"name": camera.name, **core, "extensions": {EXTENSION: extension}}
