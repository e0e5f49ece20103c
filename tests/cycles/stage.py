# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scenes are made of: plain diffuse things, lamps, a sky and a camera, and the list that scenes enter themselves in."""

from __future__ import annotations

import itertools
import math
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix, Vector

sys.path[:0] = [str(Path(__file__).resolve().parents[2] / "blend")]

from make_scenes import box_mesh, sphere_mesh, square  # noqa: E402

WHITE, RED, GREEN, BLUE, BLACK = (1, 1, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0)
TOLERANCE = 0.005
SAMPLES = 32
BLOCK = 8
NOISE = 0.025


@dataclass(frozen=True)
class Scene:
    """What is compared. `within` is how far a block may be from Cycles' beyond noise, and `noise` one standard error of it at most: a
    scene with more has not the power to find a fault. `why` is the reason if either is more than usual."""

    name: str  # TOPIC-FUNCTION
    build: Callable[[], None]
    bounces: int
    within: float
    why: str
    since: tuple[int, int]  # the first Blender that can make it
    without: tuple[int, int] | None  # one that cannot
    samples: int = SAMPLES  # per pixel, of each seed
    block: int = BLOCK  # pixels a side
    noise: float = NOISE
    seldom: bool = False  # others show nearly the same: left out where a sample is enough
    passes: tuple[str, ...] = ()  # that are compared instead of Combined, as passes.BLENDERS calls them


SCENES: dict[str, Scene] = {}


def scene(
    function: Callable[[], None] | None = None,
    *,
    bounces: int = 0,
    within: float = TOLERANCE,
    why: str = "",
    since: tuple[int, int] = (3, 4),
    without: tuple[int, int] | None = None,
    samples: int | None = None,
    block: int | None = None,
    noise: float = NOISE,
    passes: tuple[str, ...] = (),
) -> Any:
    """Enters a function that builds into an empty Blender scene; it is named after it and its file. `bounces` are Cycles'; 0: direct light.
    `samples` and `block` are what the topic says in its SAMPLES and BLOCK, if it does; its SELDOM names the scenes that a sample leaves out."""
    if function is None:
        given = {"bounces": bounces, "within": within, "why": why, "since": since, "without": without}
        return lambda f: scene(f, samples=samples, block=block, noise=noise, passes=passes, **given)
    name = f"{function.__module__.rpartition('.')[2]}-{function.__name__}"
    assert name not in SCENES, f"two scenes are called {name}"
    assert within <= TOLERANCE or why, f"{name} may deviate by {within}: why?"
    assert noise <= NOISE or why, f"{name} may have {noise} of noise: why?"
    samples = samples or function.__globals__.get("SAMPLES", SAMPLES)
    block = block or function.__globals__.get("BLOCK", BLOCK)
    seldom = function.__name__ in function.__globals__.get("SELDOM", ())
    SCENES[name] = Scene(name, function, bounces, within, why, since, without, samples, block, noise, seldom, passes)
    return function


# ---- materials ------------------------------------------------------------------------------------------------------


def material(name: str = "Material") -> tuple[Any, Any, Any]:
    """A material with an output alone, its node tree, and the output."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    made.node_tree.nodes.clear()
    return made, made.node_tree, made.node_tree.nodes.new("ShaderNodeOutputMaterial")


def diffuse(color: Iterable[float] = (0.8, 0.8, 0.8)) -> Any:
    made, tree, output = material()
    node = add(tree, "BsdfDiffuse", Color=(*color, 1))
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return made


def emitter(color: Iterable[float], strength: float = 1.0) -> Any:
    made, tree, output = material()
    node = add(tree, "Emission", Color=(*color, 1), Strength=strength)
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return made


def painted(build: Callable[[Any], Any]) -> Any:
    """A diffuse material whose colour is the socket that `build(tree)` returns."""
    made, tree, output = material()
    shader = add(tree, "BsdfDiffuse")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    tree.links.new(build(tree), shader.inputs["Color"])
    return made


def add(tree: Any, kind: str, settings: dict[str, Any] | None = None, **inputs: Any) -> Any:
    """A new shader node with `settings`; an input is a value, or the socket that is linked to it."""
    node = tree.nodes.new(f"ShaderNode{kind}")
    for key, value in (settings or {}).items():
        setattr(node, key, value)
    for key, value in inputs.items():
        feed(tree, node.inputs[key.replace("_", " ")], value)
    return node


def feed(tree: Any, socket: Any, value: Any) -> None:
    """A value, or the socket to link."""
    if isinstance(value, bpy.types.NodeSocket):
        tree.links.new(value, socket)
    else:
        socket.default_value = value


def image(name: str, pixels: Any, *, floats: bool = False, alpha: str = "STRAIGHT") -> Any:
    """An image of (height, width, 3 or 4) numbers, row 0 at the bottom; of 8 bits they are sRGB values."""
    pixels = np.asarray(pixels, np.float32)
    height, width, channels = pixels.shape
    rgba = np.ones((height, width, 4), np.float32)
    rgba[..., :channels] = pixels
    made = bpy.data.images.new(name, width, height, alpha=channels == 4, float_buffer=floats)
    made.pixels.foreach_set(rgba.ravel())
    made.alpha_mode = alpha
    made.pack()
    return made


def saved_image(name: str, pixels: Any, suffix: str = "png", depth: str = "8") -> Any:
    """The same as a file, which is loaded: its values are as stored, not those of a view."""
    file_format = {"png": "PNG", "exr": "OPEN_EXR", "tga": "TARGA", "tif": "TIFF"}[suffix]
    made = image(name, pixels, floats=suffix == "exr" or depth == "16")
    path = Path(bpy.app.tempdir) / f"{name}.{suffix}"
    made.filepath_raw, made.file_format = str(path), file_format
    made.save()
    bpy.data.images.remove(made)
    return bpy.data.images.load(str(path))


def weighted(tree: Any, outputs: Iterable[tuple[Any, str | int, float]]) -> Any:
    """The sum of (node, output, weight): a colour to which many outputs contribute. A node is its kind, or that with settings."""
    total = None
    for node, name, weight in outputs:
        made = add(tree, node) if isinstance(node, str) else add(tree, *node)
        part = add(tree, "VectorMath", {"operation": "MULTIPLY_ADD"}, Vector=made.outputs[name])
        part.inputs[1].default_value, part.inputs[2].default_value = (weight,) * 3, (0.3,) * 3
        if total is not None:
            tree.links.new(total, part.inputs[2])
        total = part.outputs[0]
    return total


COLOR, FACTOR, ALPHA = 0, 2, 3  # outputs of Attribute nodes: one changes its name between Blenders
OF_LAYERS = (
    ("frame_current", COLOR),
    ("two", COLOR),
    ("two", FACTOR),
    ("two", ALPHA),
    ("four", ALPHA),
    ("none", ALPHA),
)
OF_OBJECTS = (
    ("own", COLOR),
    ('["own"]', FACTOR),
    ("data", COLOR),
    ("location", COLOR),
    ("color", ALPHA),
    *OF_LAYERS[1:],
)


def with_properties(*owners: Any) -> None:
    """What Attribute nodes may ask for; an object's data have a property of their own."""
    for owner in owners:
        owner["own"], owner["two"], owner["four"] = 0.6, [0.5, 0.2], [0.1, 0.2, 0.3, 0.4]
        if isinstance(owner, bpy.types.Object):
            owner.data["data"], owner.color = 0.7, (0.2, 0.4, 0.6, 0.8)


def attribute(of: str, name: str) -> tuple[str, dict[str, str]]:
    return "Attribute", {"attribute_type": of, "attribute_name": name}


# ---- things ---------------------------------------------------------------------------------------------------------


def mesh(name: str, vertices: Any, faces: Any, of: Any = None, smooth: bool = False) -> Any:
    """An object in the scene; without a material it gets a grey one."""
    data = bpy.data.meshes.new(name)
    # at a pole a face names one vertex twice
    unique = [list(dict.fromkeys(face)) for face in np.asarray(faces, object).tolist()]
    data.from_pydata([tuple(v) for v in np.asarray(vertices, float).tolist()], [], unique)
    data.polygons.foreach_set("use_smooth", [smooth] * len(data.polygons))
    data.materials.append(diffuse() if of is None else of)
    return place(name, data)


def place(name: str, data: Any, location: Any = (0, 0, 0), rotation: Any = (0, 0, 0), scale: Any = (1, 1, 1)) -> Any:
    made = bpy.data.objects.new(name, data)
    made.location, made.rotation_euler, made.scale = location, rotation, scale
    bpy.context.scene.collection.objects.link(made)
    return made


def floor(of: Any = None, size: float = 6) -> Any:
    return mesh("Floor", *square(size), of)


def box(of: Any = None, location: Any = (0, 0, 1), scale: Any = (1, 1, 1), rotation: Any = (0, 0, 0.4)) -> Any:
    made = mesh("Box", *box_mesh(), of)
    made.location, made.scale, made.rotation_euler = location, scale, rotation
    return made


def ball(of: Any = None, location: Any = (0, 0, 1), radius: float = 1, fineness: int = 48) -> Any:
    """Finely tessellated: under interpolated normals some samples point into a facet."""
    made = mesh("Ball", *sphere_mesh(2 * fineness, fineness), of, smooth=True)
    made.location, made.scale = location, (radius, radius, radius)
    return made


def sheet(of: Any, divisions: int = 1, maps: Iterable[str] = ("UVMap",), size: float = 2.4) -> Any:
    """A square that faces the camera of face_on(), with UV maps: the first from 0 to 1, the others turned by 90, 180 ... degrees."""
    steps = np.linspace(-1, 1, divisions + 1)
    x, y = np.meshgrid(steps, steps)
    index = np.arange(x.size).reshape(x.shape)
    faces = np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]], axis=-1).reshape(-1, 4)
    made = mesh("Sheet", np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3) * size, faces, of)
    corners = np.stack([x, y], axis=-1).reshape(-1, 2)[faces.ravel()]
    for turns, name in enumerate(maps):
        angle = turns * math.pi / 2
        turned = corners @ np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        made.data.uv_layers.new(name=name).data.foreach_set("uv", (turned / 2 + 0.5).ravel())
    if made.data.uv_layers:
        made.data.uv_layers[0].active_render = True
        made.data.uv_layers.active_index = 0
    return made


# ---- camera, sky, lamps ---------------------------------------------------------------------------------------------


def aim(made: Any, location: Any, target: Any, turned: float = 0.0) -> None:
    made.location = location
    matrix = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_matrix()
    made.rotation_euler = (matrix @ Matrix.Rotation(turned, 3, "Z")).to_euler()


def camera(location: Any = (0.6, -7, 4), target: Any = (0, 0, 0.5), lens: float = 40, turned: float = 0.0) -> Any:
    data = bpy.data.cameras.new("Camera")
    data.lens = lens
    made = place("Camera", data)
    aim(made, location, target, turned)
    bpy.context.scene.camera = made
    return made


def face_on() -> Any:
    """An orthographic camera that sees a sheet from above, every light being the sky's: the image shows its colour."""
    made = camera((0, 0, 5), (0, 0, 0))
    made.rotation_euler = 0, 0, 0
    made.data.type, made.data.ortho_scale = "ORTHO", 4
    sky((1, 1, 1))
    return made


def sky(radiance: Iterable[float], strength: float = 1.0) -> Any:
    """A constant one; returns its tree."""
    world = bpy.data.worlds.new("World")
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (*radiance, 1)
    background.inputs["Strength"].default_value = strength
    bpy.context.scene.world = world
    return world.node_tree


def lamp(
    kind: str,
    location: Any,
    energy: float,
    color: Any = WHITE,
    target: Any = (0, 0, 0.5),
    turned: float = 0.0,
    scale: Any = (1, 1, 1),
    **settings: Any,
) -> Any:
    data = bpy.data.lights.new(kind.title(), kind)
    data.energy, data.color = energy, color
    if kind in {"POINT", "SPOT"}:
        data.shadow_soft_size = 0
    for name, value in settings.items():
        setattr(data, name, value)
    made = place(data.name, data, scale=scale)
    aim(made, location, target, turned)
    made.scale = scale
    return made


def sun(color: Any = WHITE, energy: float = 2.0, location: Any = (3, -2, 4), angle: float = 0.0) -> Any:
    return lamp("SUN", location, energy, color, angle=angle)


def daylight() -> None:
    """What shows shapes best: one sharp shadow, and some light everywhere."""
    sky((0.3, 0.3, 0.3))
    sun((1, 0.9, 0.8))


def stage() -> None:
    """A floor under daylight, seen from above at an angle."""
    floor()
    daylight()
    camera()


# ---- names ----------------------------------------------------------------------------------------------------------


def select(made: Any) -> None:
    """For operators."""
    for other in bpy.context.view_layer.objects:
        other.select_set(False)
    made.select_set(True)
    bpy.context.view_layer.objects.active = made


def collection(name: str, *members: Any, linked: bool = False) -> Any:
    """A collection of these objects alone; not in the scene unless `linked`."""
    made = bpy.data.collections.new(name)
    for member in members:
        for old in list(member.users_collection):
            old.objects.unlink(member)
        made.objects.link(member)
    if linked:
        bpy.context.scene.collection.children.link(made)
    return made


def instance(made: Any, location: Any = (0, 0, 0), rotation: Any = (0, 0, 0), scale: Any = (1, 1, 1)) -> Any:
    """An empty that shows a collection."""
    empty = place("Instance", None, location, rotation, scale)
    empty.instance_type, empty.instance_collection = "COLLECTION", made
    return empty


def gradient(width: int = 8, height: int = 8) -> np.ndarray:
    """Coloured pixels that differ from each other, (height, width, 3), between 0.1 and 0.9."""
    v, u = (np.mgrid[0:height, 0:width] + 0.5) / np.array([height, width])[:, None, None]
    return np.stack([0.1 + 0.8 * u, 0.1 + 0.8 * v, 0.9 - 0.4 * u - 0.4 * v], axis=-1)


def checker(*colors: Any) -> np.ndarray:
    """2 x 2 pixels of these colours."""
    return np.array(list(itertools.islice(itertools.cycle(colors), 4)), np.float32).reshape(2, 2, -1)
