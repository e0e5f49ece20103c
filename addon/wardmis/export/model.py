# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene as plain data, between what Blender holds (gathered by the other files here) and GLB (written by glb.py).

The field names and units are those of docs/scene-format.md. No bpy in here: everything can be made and tested without Blender.
Matrices are row-major 4x4 numpy arrays in Blender's axes (Z up); the writer adds the turn to glTF's axes in one root node.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any

import numpy as np

Rgb = tuple[float, float, float]
IDENTITY_TRANSFORM = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)
LARGEST = float(np.finfo(np.float32).max)  # the renderer computes in single precision


def not_finite(data: Any) -> str | None:
    """Of one of the dataclasses here: what holds a NaN, or a number too large for the renderer, in words; None if nothing does."""
    for entry in fields(data):
        value = getattr(data, entry.name)
        if isinstance(value, (list, dict)):
            parts = value.values() if isinstance(value, dict) else value
            wrong = any(not_finite(part) is not None for part in parts if is_dataclass(part))
        elif is_dataclass(value):
            wrong = not_finite(value) is not None
        else:
            wrong = isinstance(value, (float, tuple, np.ndarray)) and not (np.abs(value) <= LARGEST).all()
        if wrong:
            return entry.name.replace("_", " ")
    return None


@dataclass(frozen=True)
class FileOnDisk:
    """The bytes of a file, read when they are written: not all images' are in memory at once."""

    path: str
    size: int


@dataclass
class ImageData:
    """An image: either a complete file (`encoded`) or raw `pixels`, exactly one of the two."""

    name: str
    color_space: str = "sRGB"  # how to decode: "sRGB" or "linear"
    encoded: bytes | FileOnDisk | None = None  # the bytes of a file of type `mime_type`
    mime_type: str = ""  # image/png, image/jpeg, image/x-exr
    pixels: np.ndarray | None = None  # (height, width, channels 1..4), uint8 or float32, rows from the bottom
    filter_encoded: bool = False  # sRGB values are filtered as they are, and decoded after that
    alpha: str = "kept"  # or "multiplies" the colours as they are, or "ignored": 1
    halvings: int = 0  # of both sides
    limit: int = 0  # both are halved further until none is longer; 0: no limit


@dataclass
class TextureData:
    """How an image is looked up. Its index in `SceneData.textures` is what materials and the world hold."""

    image: int  # index into SceneData.images
    wrap: str = "repeat"  # "repeat", "clamp", "mirror", "clip", in both directions
    filter: str = "linear"  # "linear", "nearest", "cubic"


@dataclass
class TextureUse:
    """A look-up at u' = a u + b v + c, v' = d u + e v + f; v is Blender's, 0 at the bottom row."""

    index: int  # from ExportContext.texture()
    channel: int = 0  # for scalars: 0 red, 1 green, 2 blue, 3 alpha
    transform: tuple[float, float, float, float, float, float] = IDENTITY_TRANSFORM


@dataclass
class ColorInput:
    """`value`, multiplied by the texture, or by value `result` of the material's program, if there is one."""

    value: Rgb = (0.0, 0.0, 0.0)
    texture: TextureUse | None = None
    result: int | None = None


@dataclass
class ScalarInput:
    """`value`, multiplied by one channel of the texture, or by value `result` of the material's program, if there is one."""

    value: float = 0.1
    texture: TextureUse | None = None
    result: int | None = None


OF_TANGENTS = {"tangent-uv", "normal-map-tangent", "vector-displacement"}


@dataclass
class ProgramData:
    """Operations as docs/scene-format.md, "Programs", has them: op, in, and parameters by name."""

    operations: list[dict[str, Any]]

    @property
    def uv_sets(self) -> set[str]:
        """The UV sets that it reads, the one without a name being "". Tangents are made of them."""
        return {o.get("set", "") for o in self.operations if o["op"] in {"uv", *OF_TANGENTS}}

    @property
    def tangents(self) -> set[str]:
        """The UV sets whose tangents at vertices it needs."""
        return {o.get("set", "") for o in self.operations if o["op"] in OF_TANGENTS}

    @property
    def attributes(self) -> set[str]:
        return {o["name"] for o in self.operations if o["op"].startswith("attribute")}

    def reads(self, *names: str) -> bool:
        return any(o["op"] in names for o in self.operations)


@dataclass
class ClosureData:
    """One lobe, or several, of a surface: docs/scene-format.md, "Closures"."""

    type: str
    weight: ColorInput | None  # None: 1
    inputs: dict[str, Any]  # ColorInput, ScalarInput
    parameters: dict[str, Any]
    normal: ColorInput | None  # of a result alone
    coat_normal: ColorInput | None
    tangent: ColorInput | None


@dataclass
class MaterialData:
    """In the short form, or, where there are `closures`, with these in place of variant ... rotation and normal."""

    name: str
    variant: str = "ward-gmd"  # "ward", "ward-dur", "ward-gmd"
    diffuse: ColorInput = field(default_factory=ColorInput)
    specular: ColorInput = field(default_factory=ColorInput)
    alpha_x: ScalarInput = field(default_factory=ScalarInput)
    alpha_y: ScalarInput = field(default_factory=ScalarInput)
    rotation: float = 0.0  # radians
    emission: ColorInput = field(default_factory=ColorInput)  # W m^-2 sr^-1, both sides
    normal: ColorInput | None = None  # of a result alone
    closures: list[ClosureData] = field(default_factory=list)
    program: ProgramData | None = None
    index: int = 0
    transparent_shadow: bool = True

    @property
    def uv_sets(self) -> set[str]:
        """The UV sets that a mesh with this material must carry: for textures, programs, or the direction of the anisotropy."""
        inputs: list[ColorInput | ScalarInput] = [
            self.diffuse,
            self.specular,
            self.emission,
            self.alpha_x,
            self.alpha_y,
        ]
        anisotropic = any(self.specular.value) and self.alpha_x != self.alpha_y
        for closure in self.closures:
            anisotropic |= "rotation" in closure.inputs
            inputs += [*closure.inputs.values(), *([closure.weight] if closure.weight else [])]
        own = {""} if anisotropic or any(i.texture is not None for i in inputs) else set()
        return own | (self.program.uv_sets if self.program else set())


@dataclass
class PrimitiveData:
    """What of a mesh has one material."""

    material: int  # index into SceneData.materials
    triangles: np.ndarray  # (n, 3) uint32 into the vertex arrays; of curves (n, 2): segments; of spheres (n,)


@dataclass
class MeshData:
    """Vertex arrays shared by primitives. Without normals the triangles are flat; with radii it has curves or spheres."""

    name: str
    positions: np.ndarray  # (n, 3) float32
    normals: np.ndarray | None  # (n, 3) float32
    uvs: np.ndarray | None  # (n, 2) float32, v = 0 at the bottom: the set without a name
    primitives: list[PrimitiveData]
    uv_sets: dict[str, np.ndarray] = field(default_factory=dict)  # those that programs read by name
    attributes: dict[str, np.ndarray] = field(default_factory=dict)  # (n,) or (n, 2 to 4) float32, by name
    tangents: dict[str, np.ndarray] = field(default_factory=dict)  # (n, 4) float32, by UV set
    motion_positions: list[np.ndarray] = field(default_factory=list)  # at equal steps of the shutter's time
    motion_normals: list[np.ndarray] = field(default_factory=list)
    generated: tuple[float, ...] | None = None  # 12 numbers, from object space to Generated coordinates
    radii: np.ndarray | None = None  # (n,) float32
    shape: str = ""  # of what has radii: "ribbons", "tubes", "cones", "spheres"
    pieces: int = 5  # flat ones of a ribbon's segment
    inside: bool = False  # whether what is round is seen from inside, too


@dataclass
class InstanceData:
    name: str
    mesh: int  # index into SceneData.meshes
    matrix: np.ndarray  # (4, 4) float64
    hidden_from: frozenset[str] = frozenset()  # out of VISIBILITY
    color: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    index: int = 0
    random: float = 0.0
    attributes: tuple[tuple[str, tuple[float, ...]], ...] = ()  # of the object, not the mesh
    motion: list[np.ndarray] = field(default_factory=list)  # `matrix` at equal steps of the shutter's time
    holdout: bool = False
    shadow_catcher: bool = False
    shadow_terminator: tuple[float, float] = (0.0, 0.0)  # geometry offset and shading offset


VISIBILITY = ("camera", "diffuse", "glossy", "transmission", "shadow")


@dataclass
class LightData:
    """A light; `emission` holds radiance (area), intensity (point, spot) or irradiance (sun), without the colour."""

    name: str
    type: str  # "area", "point", "spot", "sun"
    matrix: np.ndarray
    color: Rgb
    emission: float
    shape: str = "rectangle"  # area: "rectangle", "ellipse"
    size: tuple[float, float] = (1.0, 1.0)  # area
    spread: float = np.pi  # area, full angle
    radius: float = 0.0  # point, spot
    facing: bool = True  # point, spot with a radius
    angle: float = 0.0  # spot: full cone; sun: full angular diameter
    flat: bool = False  # sun: a flat disk, brighter towards its rim
    blend: float = 0.0  # spot
    cosine: bool = False  # spot
    shadow: bool = True
    met: bool = True
    on_catchers: bool = True
    max_bounces: int = 1024  # of paths whose surfaces it lights
    hidden_from: frozenset[str] = frozenset()
    program: ProgramData | None = None  # the light is multiplied by its value `result`
    result: int = 0


@dataclass
class CameraData:
    name: str
    matrix: np.ndarray  # without scale
    projection: str  # as docs/scene-format.md calls it
    view_plane: tuple[float, float, float, float]  # left, right, bottom, top of the full frame
    clip: tuple[float, float]
    lens_radius: float = 0.0
    focus_distance: float = 10.0
    blades: int = 0
    blade_rotation: float = 0.0
    blade_ratio: float = 1.0
    fov: float | None = None  # fisheyes: full angle
    polynomial: tuple[float, ...] | None = None  # fisheye-polynomial: five
    motion: list[np.ndarray] = field(default_factory=list)  # `matrix` at equal steps of the shutter's time
    view_planes: list[tuple[float, float, float, float]] = field(default_factory=list)  # likewise


@dataclass
class FilmData:
    resolution: tuple[int, int]
    border: tuple[int, int, int, int]  # x0, y0, x1, y1 from the bottom left, end exclusive
    filter_type: str = "blackman-harris"  # "box", "gaussian", "blackman-harris"
    filter_width: float = 1.5
    exposure: float = 1.0
    transparent: bool = False
    keep_uvs: bool = False  # for the pass
    alpha_threshold: float = 0.5  # passes of data show what is at least as opaque
    shutter: dict[str, Any] = field(default_factory=dict)


@dataclass
class WorldData:
    """A sky; several lie over each other, as a rule for other kinds of ray each."""

    radiance: Rgb = (0.0, 0.0, 0.0)  # times what the texture, or value `result` of the program, has in a direction
    texture: int | None = None  # index into SceneData.textures
    program: ProgramData | None = None
    result: int = 0
    matrix: np.ndarray = field(default_factory=lambda: np.eye(3))
    projection: str = "equirectangular"  # or "mirror-ball"
    cone: tuple[float, float, float, float] | None = (
        None  # a direction, and the full angle around it from which light comes alone
    )
    hidden_from: frozenset[str] = frozenset()
    max_bounces: int = 1024  # as of a light


@dataclass
class SceneData:
    generator: str
    film: FilmData
    camera: CameraData
    worlds: list[WorldData] = field(default_factory=list)
    images: list[ImageData] = field(default_factory=list)
    textures: list[TextureData] = field(default_factory=list)
    materials: list[MaterialData] = field(default_factory=list)
    meshes: list[MeshData] = field(default_factory=list)
    instances: list[InstanceData] = field(default_factory=list)
    lights: list[LightData] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
