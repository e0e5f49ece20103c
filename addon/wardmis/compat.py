# SPDX-License-Identifier: GPL-3.0-or-later
"""Every difference between the Blender versions (3.4 to 5.x) that the add-on meets."""

from __future__ import annotations

import contextlib
import ctypes
import sys
from collections.abc import Iterator
from typing import Any

import bpy
import numpy as np

VERSION = bpy.app.version

# Cycles normalised its lights anew in 4.0: see export/light.py.
LIGHTS_OF_4_0 = VERSION >= (4, 0, 0)


# --- meshes ---------------------------------------------------------------------------------------------------------
#
# The functions take the mesh, never a layer of it: a call may move the layers, and what was taken from Python before points nowhere.


def owner_of_mesh(instance: Any) -> Any:
    """The object whose own the mesh of a depsgraph instance is; None where geometry nodes made it."""
    owner = instance.instance_object if instance.is_instance else instance.object
    return owner if owner.data is not None and owner.data.as_pointer() == instance.object.data.as_pointer() else None


@contextlib.contextmanager
def whole_mesh(instance: Any) -> Iterator[Any]:
    """The mesh of a depsgraph instance with all its arrays, within the block: one in Edit Mode has them in a copy alone."""
    mesh = instance.object.data
    owner = owner_of_mesh(instance)
    if not mesh.is_editmode or owner is None:
        yield mesh
        return
    try:
        yield owner.to_mesh()
    finally:
        owner.to_mesh_clear()


def _foreach(collection: Any, attribute: str, width: int, dtype: type) -> np.ndarray:
    out: np.ndarray = np.empty(len(collection) * width, dtype)
    collection.foreach_get(attribute, out)
    return out.reshape(-1, width) if width > 1 else out


def _raw_or_foreach(collection: Any, attribute: str, width: int, dtype: type) -> np.ndarray:
    """As _foreach, but up to 60 times faster where the attribute is at the start of each element of a plain array.

    Whether it is, is checked on the addresses and on a few elements; if not, foreach_get does it.
    """
    count = len(collection)
    if count < 2:
        return _foreach(collection, attribute, width, dtype)
    first = collection[0].as_pointer()
    stride = collection[1].as_pointer() - first
    in_a_row = collection[count - 1].as_pointer() - first == stride * (count - 1)
    if not in_a_row or stride % 4 or not 4 * width <= stride <= 16:
        return _foreach(collection, attribute, width, dtype)
    words: np.ndarray = np.ctypeslib.as_array((ctypes.c_uint32 * (count * stride // 4)).from_address(first))
    words = words.view(dtype).reshape(count, -1)
    for i in (0, 1, count // 3, count // 2, count - 1):
        if not np.array_equal(words[i, :width], np.array(getattr(collection[i], attribute), dtype, ndmin=1)):
            return _foreach(collection, attribute, width, dtype)
    copy: np.ndarray = words[:, :width].copy()  # Blender owns the array
    return copy if width > 1 else copy.reshape(-1)


def positions(mesh: Any) -> np.ndarray:
    """(n, 3) float32."""
    if VERSION >= (3, 5, 0):
        return _foreach(mesh.attributes["position"].data, "vector", 3, np.float32)
    return _foreach(mesh.vertices, "co", 3, np.float32)


def corner_vertices(mesh: Any) -> np.ndarray:
    """The vertex of every face corner, (n,) int32."""
    if VERSION >= (3, 6, 0):
        return _foreach(mesh.attributes[".corner_vert"].data, "value", 1, np.int32)
    return _raw_or_foreach(mesh.loops, "vertex_index", 1, np.int32)


def triangle_corners(mesh: Any) -> np.ndarray:
    """The three corners of every triangle of the tessellation, (n, 3) uint32."""
    mesh.calc_loop_triangles()
    return _raw_or_foreach(mesh.loop_triangles, "loops", 3, np.int32).view(np.uint32)


def triangle_faces(mesh: Any) -> np.ndarray:
    """The face of every triangle, (n,) int32. After triangle_corners()."""
    if VERSION >= (4, 0, 0):
        return _foreach(mesh.loop_triangle_polygons, "value", 1, np.int32)
    return _foreach(mesh.loop_triangles, "polygon_index", 1, np.int32)


def face_material_indices(mesh: Any) -> np.ndarray | None:
    """The material slot of every face, (n,) int32; None: all 0."""
    attribute = mesh.attributes.get("material_index")
    return None if attribute is None else _foreach(attribute.data, "value", 1, np.int32)


def shading(mesh: Any) -> str:
    """Where the normals change: 'FACE' (all flat), 'POINT' (all smooth) or 'CORNER' (mixed, sharp edges, custom normals)."""
    if VERSION >= (4, 1, 0):
        return str(mesh.normals_domain)
    smooth = _foreach(mesh.polygons, "use_smooth", 1, bool)
    if not smooth.any():
        return "FACE"
    if mesh.use_auto_smooth or not smooth.all():  # custom normals and sharp edges count with auto smooth only
        return "CORNER"
    return "POINT"


# Cycles rounds normals to them, which moves them by up to 5e-5.
NORMALS_HAVE_32_BITS = VERSION >= (5, 2, 0)


def vertex_normals(mesh: Any) -> np.ndarray:
    """(n, 3) float32."""
    return _foreach(mesh.vertex_normals, "vector", 3, np.float32)


def face_normals(mesh: Any) -> np.ndarray:
    """(n, 3) float32."""
    return _foreach(mesh.polygons, "normal", 3, np.float32)


def corner_normals(mesh: Any) -> np.ndarray:
    """(n, 3) float32."""
    if VERSION >= (4, 1, 0):
        return _foreach(mesh.corner_normals, "vector", 3, np.float32)
    mesh.calc_normals_split()
    normals = _foreach(mesh.loops, "normal", 3, np.float32)
    mesh.free_normals_split()
    return normals


def uvs(mesh: Any, name: str = "") -> np.ndarray | None:
    """The UVs of this name, or else those that renders use, one for each corner, (n, 2) float32; None: there are none."""
    layer = next((layer for layer in mesh.uv_layers if (layer.name == name if name else layer.active_render)), None)
    if layer is None:
        return None
    if VERSION >= (3, 5, 0):
        return _foreach(layer.uv, "vector", 2, np.float32)
    return _raw_or_foreach(layer.data, "uv", 2, np.float32)


def packed_file(image: Any, tile: int | None) -> Any:
    """The file that is packed in an image, or that of this UDIM tile; None: it is not packed."""
    files = image.packed_files
    if tile is None:
        return files[0].packed_file
    if VERSION < (3, 5, 0):  # tells no numbers; the files are in the order of the tiles
        numbers = [t.number for t in image.tiles]
        return files[numbers.index(tile)].packed_file if numbers.index(tile) < len(files) else None
    return next((f.packed_file for f in files if f.tile_number == tile), None)


def attribute_values(attribute: Any, name: str, width: int) -> np.ndarray:
    """(n,) or (n, width) float32."""
    kinds: dict[str, type] = {"INT": np.int32, "INT8": np.int8, "BOOLEAN": bool}
    return _foreach(attribute.data, name, width, kinds.get(attribute.data_type, np.float32)).astype(np.float32)


# Whether Cycles reads attributes as Blender itself converts them, with vertex groups among them, not by rules of its own.
# Measured in 3.4, 4.3 and 5.2.
ATTRIBUTES_ARE_BLENDERS = VERSION >= (4, 1, 0)


def edge_vertices(mesh: Any) -> np.ndarray:
    """(n, 2) int32."""
    return _foreach(mesh.edges, "vertices", 2, np.int32)


def vertex_weights(mesh: Any, group: int) -> np.ndarray:
    """Of the group of this index, (n,) float32; 0 for a vertex that is not in it."""
    weights = np.zeros(len(mesh.vertices), np.float32)
    for vertex, of_vertex in enumerate(mesh.vertices):
        for element in of_vertex.groups:
            if element.group == group:
                weights[vertex] = element.weight
    return weights


# Whether Blender tells add-ons what geometry nodes have made of an object besides its own data.
TELLS_EVALUATED_GEOMETRY = hasattr(bpy.types.Object, "evaluated_geometry")


WHERE_INSTANCES_TELL_NOTHING = "in collections that are placed" if TELLS_EVALUATED_GEOMETRY else "before Blender 5"


def evaluated_geometry(obj: Any) -> Any:
    """A GeometrySet of an evaluated object; None: Blender does not tell it."""
    return obj.evaluated_geometry() if TELLS_EVALUATED_GEOMETRY else None


def whole_numbers(data: Any, name: str) -> np.ndarray:
    """Of an attribute of the type INT, (n,) int32."""
    return _foreach(data.attributes[name].data, "value", 1, np.int32)


def corner_faces(mesh: Any) -> np.ndarray:
    """The face of every corner, (n,) int."""
    return np.repeat(np.arange(len(mesh.polygons)), _foreach(mesh.polygons, "loop_total", 1, np.int32))


def undeformed_positions(mesh: Any) -> np.ndarray:
    """Before modifiers that only move, (n, 3) float32."""
    return _foreach(mesh.vertices, "undeformed_co", 3, np.float32)


# --- curves and point clouds -----------------------------------------------------------------------------------------

# of what has no attribute of the name "radius", as Cycles takes it
RADIUS_OF_CURVES = 0.005 if VERSION >= (4, 0, 0) else 0.0
RADIUS_OF_POINTS = 0.01 if VERSION >= (4, 0, 0) else 0.0

# Whether rays that begin inside a tube or a sphere meet it: since Cycles has the fourth version of Embree.
INSIDE_IS_SEEN = VERSION >= (3, 6, 0)

# Those of a point cloud that is placed once are as round as before under a scale that is not even.
SPHERES_STAY_ROUND = VERSION < (5, 0, 0)


def point_values(data: Any, name: str) -> np.ndarray | None:
    """The attribute "position", (n, 3), or "radius", (n,) float32, of curves or a point cloud; None: it has none."""
    attribute = data.attributes.get(name)
    kind, key, width = ("FLOAT_VECTOR", "vector", 3) if name == "position" else ("FLOAT", "value", 1)
    if attribute is None or attribute.domain != "POINT" or attribute.data_type != kind:
        return None
    return _foreach(attribute.data, key, width, np.float32)


def curve_offsets(curves: Any) -> np.ndarray:
    """The first point of each curve, and the number of all: (curves + 1,) int."""
    return _foreach(curves.curve_offset_data, "value", 1, np.int32).astype(np.int64)


def curves_are_chains(curves: Any) -> bool:
    """Whether Cycles draws them as cones, since the first of them is a Poly curve."""
    attribute = curves.attributes.get("curve_type") if VERSION >= (5, 0, 0) else None
    return attribute is not None and len(attribute.data) > 0 and attribute.data[0].value == 1


# --- lights, world, objects -----------------------------------------------------------------------------------------


def light_shadow_setting(light: Any) -> tuple[Any, str]:
    """Who has the setting whether a light casts shadows, and its name: Cycles had one of its own until 4.2."""
    cycles: Any = getattr(light, "cycles", None)
    return (cycles, "cast_shadow") if hasattr(cycles, "cast_shadow") else (light, "use_shadow")


def light_casts_shadow(light: Any) -> bool:
    return bool(getattr(*light_shadow_setting(light)))


def max_bounces(light: Any) -> int:
    """By which a path has come to the last surface that the light, or world, lights; it is Cycles' setting."""
    return int(getattr(getattr(light, "cycles", None), "max_bounces", 1024))


def transparent_shadow(material: Any) -> bool:
    """Whether what it lets through shows in its shadow; it was Cycles' own setting until 4.2."""
    return bool(getattr(material, "use_transparent_shadow", getattr(material.cycles, "use_transparent_shadow", True)))


def displacement_method(material: Any) -> str:
    """BUMP, DISPLACEMENT or BOTH; it was Cycles' own setting until 4.0."""
    return str(getattr(material, "displacement_method", getattr(material.cycles, "displacement_method", "BUMP")))


def light_is_met(light: Any) -> bool:
    """Whether surfaces' rays find the light too; it is Cycles' Multiple Importance."""
    return bool(getattr(getattr(light, "cycles", None), "use_multiple_importance_sampling", True))


def light_has_soft_falloff(light: Any) -> bool:
    """Whether a point or spot light with a radius is a disk that faces the shading point (always, until the option came)."""
    return bool(getattr(light, "use_soft_falloff", True))


def light_exposure(light: Any) -> float:
    return float(2.0 ** getattr(light, "exposure", 0.0))


def light_temperature_color(light: Any) -> tuple[float, float, float]:
    if getattr(light, "use_temperature", False):
        r, g, b = light.temperature_color
        return (r, g, b)
    return (1.0, 1.0, 1.0)


def light_is_normalized(light: Any) -> bool:
    return bool(getattr(light, "normalize", True))


def world_of(view_layer: Any, scene: Any) -> Any:
    """The world that the view layer shows."""
    return getattr(view_layer, "world_override", None) or scene.world


def world_is_seen_by(world: Any, ray: str) -> bool:
    """Whether a "camera", "diffuse", "glossy" or "transmission" ray sees it; it is Cycles' setting, and gone where that add-on is off."""
    settings: Any = getattr(world, "cycles_visibility", None)
    return settings is None or bool(getattr(settings, ray))


def uses_nodes(owner: Any) -> bool:
    """Whether a light or a world is made by its node tree. From 5.0 `use_nodes` is always true and deprecated."""
    return owner.node_tree is not None and (VERSION >= (5, 0, 0) or owner.use_nodes)


# A Background node in a lamp shines as an Emission does; before it gave nothing.
BACKGROUND_LIGHTS_LAMPS = VERSION >= (4, 0, 0)


def is_subdivided_by_pixels(scene: Any, obj: Any) -> bool:
    """Whether Cycles subdivides a mesh as finely as it is seen: its last modifier's, in sets of experimental features before 5.0."""
    last = obj.modifiers[-1] if obj.modifiers else None
    if last is None or last.type != "SUBSURF" or not last.show_render:
        return False
    if VERSION >= (5, 0, 0):
        return last.use_adaptive_subdivision
    cycles = getattr(scene, "cycles", None)
    return cycles is not None and cycles.feature_set == "EXPERIMENTAL" and obj.cycles.use_adaptive_subdivision


def panorama_settings(camera: Any) -> Any:
    """Who has the kind of a panoramic camera, and its angles: they were Cycles' own until 4.2. None where that add-on is off."""
    return camera if hasattr(camera, "panorama_type") else getattr(camera, "cycles", None)


def uses_motion_blur(scene: Any, layer: Any) -> bool:
    return bool(scene.render.use_motion_blur) and bool(getattr(layer, "use_motion_blur", True))


def motion_blur_owner(scene: Any) -> Any:
    """Who has `motion_blur_position`: it was Cycles' own until 4.2. None where that add-on is off."""
    return scene.render if hasattr(scene.render, "motion_blur_position") else getattr(scene, "cycles", None)


def motion_blur_position(scene: Any) -> str:
    return str(getattr(motion_blur_owner(scene), "motion_blur_position", "CENTER"))


def rolling_shutter(scene: Any) -> float | None:
    """The part of the shutter's time that each line has, where lines have their own; it is Cycles' setting."""
    cycles: Any = getattr(scene, "cycles", None)
    return cycles.rolling_shutter_duration if getattr(cycles, "rolling_shutter_type", "NONE") == "TOP" else None


def motion_settings(obj: Any) -> Any:
    """An object's `use_motion_blur`, `use_deform_motion` and `motion_steps`; None where Cycles, whose they are, is off."""
    return getattr(obj, "cycles", None)


@contextlib.contextmanager
def deep_recursion() -> Iterator[None]:
    """For calls as deep as chains of nodes are long, within the block, or as a decorator.

    Python keeps calls of its own functions off the machine's stack from 3.11 on, and minds that stack from 3.12 on.
    """
    before = sys.getrecursionlimit()
    deep = 200_000 if sys.version_info >= (3, 12) else 20_000 if sys.version_info >= (3, 11) else before
    sys.setrecursionlimit(max(before, deep))
    try:
        yield
    finally:
        sys.setrecursionlimit(before)


# --- nodes ----------------------------------------------------------------------------------------------------------

# Whose formulas this Blender's Cycles has: 3.4's (3), 4.3's (4) or 5.2's (5), which docs/scene-format.md calls `version`.
CYCLES = 3 if VERSION < (4, 0, 0) else 4 if VERSION < (5, 0, 0) else 5
NORMAL_MAP = CYCLES if VERSION < (5, 0, 0) or VERSION >= (5, 1, 0) else 4
DISPLACEMENT_WIDTH = 1.0 if VERSION < (4, 5, 0) else 0.1  # of the steps in which Cycles makes a bump of it
MAGIC = 4 if VERSION < (5, 2, 0) else 5
BRICK = 3 if VERSION < (3, 5, 0) else 5
RAMP_STEPS = 255 if VERSION < (4, 0, 0) else 256  # of the tables that Cycles makes of colour ramps and curves

# What tells a number of an attribute makes three of it and takes their mean, which may have another last bit.
NUMBERS_ARE_MEANS = VERSION >= (5, 2, 0)

# Whether an image that is missing is clipped as others are; later it is everywhere.
MISSING_IMAGES_ARE_CLIPPED = VERSION < (5, 2, 0)
# Cycles is given trees without groups, reroutes and muted nodes, which convert nothing any more.
NODE_TREES_ARE_INLINED = VERSION >= (5, 0, 0)
# A Mix of numbers or vectors whose factor is 0 or 1 is none to Cycles, as one of colours always was.
MIXED_NUMBERS_FOLD = VERSION >= (4, 0, 0)
# Cycles takes the word of an image's Alpha Mode whether colours are multiplied by alpha; before, that of the file.
ALPHA_MODES_ARE_TRUSTED = VERSION >= (5, 1, 0)


def add_group_socket(tree: Any, name: str, kind: str, in_out: str) -> Any:
    """A new 'INPUT' or 'OUTPUT' of a node group, of the type `kind` ("NodeSocketColor" ...)."""
    if VERSION >= (4, 0, 0):
        return tree.interface.new_socket(name, in_out=in_out, socket_type=kind)
    return (tree.inputs if in_out == "INPUT" else tree.outputs).new(kind, name)


def add_shader_menu() -> Any:
    """The menu Add > Shader of the shader editor."""
    return getattr(bpy.types, "NODE_MT_category_shader_shader", None) or bpy.types.NODE_MT_category_SH_NEW_SHADER


def add_shader_menu_is_for_blenders_engines() -> bool:
    """Whether that menu hides Blender's own shaders from engines that it does not know, as it does in 3.4."""
    return not hasattr(bpy.types, "NODE_MT_category_shader_shader")


# What has no material is Lambert's grey in Cycles, from 5.0 on the Principled node as it comes.
NO_MATERIAL_IS_PRINCIPLED = VERSION >= (5, 0, 0)

# The Principled BSDF was renamed and rebuilt in 4.0; the extras are those of its inputs that are left out.
PRINCIPLED_EXTRAS: tuple[str, ...]
if VERSION >= (4, 0, 0):
    PRINCIPLED_SPECULAR, PRINCIPLED_SPECULAR_OF_IOR = "Specular IOR Level", True
    PRINCIPLED_LAYERS = True  # the diffuse reflection is below the dielectric one, and gets what that leaves
    PRINCIPLED_EMISSION = "Emission Color"
    PRINCIPLED_EXTRAS = (
        "Subsurface Weight",
        "Transmission Weight",
        "Coat Weight",
        "Sheen Weight",
        "Thin Film Thickness",
    )
else:
    PRINCIPLED_SPECULAR, PRINCIPLED_SPECULAR_OF_IOR = "Specular", False
    PRINCIPLED_LAYERS = False
    PRINCIPLED_EMISSION = "Emission"
    PRINCIPLED_EXTRAS = ("Subsurface", "Transmission", "Clearcoat", "Sheen")


# --- images of a render ----------------------------------------------------------------------------------------------

# What Blender calls passes that render engines have in common, by what `wardmis --passes` does
PASS_NAMES = {
    "position": "Position",
    "uv": "UV",
    "object-index": "Object Index" if VERSION >= (5, 0, 0) else "IndexOB",
    "material-index": "Material Index" if VERSION >= (5, 0, 0) else "IndexMA",
    "emission": "Emission" if VERSION >= (5, 0, 0) else "Emit",
    "environment": "Environment" if VERSION >= (5, 0, 0) else "Env",
    **{
        f"{component.lower()}-{part.lower()}": f"{component} {part}" if VERSION >= (5, 0, 0) else short + part[:3]
        for component, short in (("Diffuse", "Diff"), ("Glossy", "Gloss"), ("Transmission", "Trans"))
        for part in ("Direct", "Indirect", "Color")
    },
}

LONGEST_CHANNEL = (
    62  # bytes of a channel's name in an OpenEXR file, "<layer>.<pass>.<channel>": Blender cuts longer ones
)


def set_pixels(render_pass: Any, pixels: np.ndarray) -> None:
    """`pixels`: (height * width, channels) float32, rows from the bottom."""
    render_pass.rect.foreach_set(pixels if VERSION < (4, 0, 0) else pixels.reshape(-1))


# --- Cycles and its files -------------------------------------------------------------------------------------------


def multilayer_exr(image_settings: Any) -> list[tuple[Any, str, Any]]:
    """What makes Blender write one part of all layers and passes, in linear Rec. 709, 32 bits: (owner, setting, value), in order."""
    return [
        (image_settings, "media_type", "MULTI_LAYER_IMAGE"),  # from 5.0, and before the format
        (image_settings, "file_format", "OPEN_EXR_MULTILAYER"),
        (image_settings, "color_depth", "32"),
        (image_settings, "exr_codec", "ZIP"),
        (image_settings, "use_exr_interleave", True),  # 5.2 writes a part for each pass without it
        (image_settings, "color_management", "FOLLOW_SCENE"),
    ]


def cycles_samples(cycles: Any, first: int, count: int) -> list[tuple[Any, str, Any]]:
    """What makes Cycles take `count` samples of its sequence from number `first` on: (owner, setting, value)."""
    if not hasattr(cycles, "use_sample_subset"):
        return [(cycles, "sample_offset", first), (cycles, "samples", count)]
    return [  # in 5.x the samples are those of all parts
        (cycles, "use_sample_subset", first > 0),
        (cycles, "sample_offset", first),
        (cycles, "sample_subset_length", count),
        (cycles, "samples", first + count),
    ]


def shadow_terminator(obj: Any) -> tuple[Any, str, str]:
    """Who has the settings of the edge of a smooth surface's own shadow, and their names: how far light samples are moved, and by
    how much the light's angle is greater. They were Cycles' own until 4.2."""
    geometry = "shadow_terminator_geometry_offset"
    if hasattr(obj, geometry):
        return obj, geometry, "shadow_terminator_shading_offset"
    return getattr(obj, "cycles", None), geometry, "shadow_terminator_offset"


def working_space() -> str:
    """The colour space in which the file's scenes are linear: another than this can be chosen since 5.0."""
    return str(getattr(getattr(bpy.data, "colorspace", None), "working_space", LINEAR))


LINEAR = "Linear Rec.709"


# --- the user interface ---------------------------------------------------------------------------------------------

# What Cycles calls a spot light's angle, and whether a light or a world can be without nodes
SPOT_SIZE = "Angle" if VERSION >= (5, 0, 0) else "Spot Size"
HAS_USE_NODES = VERSION < (5, 0, 0)
LINEAR_SPACE = "Linear Rec.709" if VERSION >= (4, 0, 0) else "Linear"


def progress_bar(layout: Any, fraction: float) -> None:
    """From 4.0 on; before, the text beside it has to say it all."""
    if hasattr(layout, "progress"):
        layout.progress(factor=fraction)


def uniform_colour_shader() -> Any:
    import gpu

    return gpu.shader.from_builtin("UNIFORM_COLOR" if VERSION >= (4, 0, 0) else "3D_UNIFORM_COLOR")


def pixel_projection(width: int, height: int) -> Any:
    """From pixels to what the GPU takes, -1 to 1."""
    from mathutils import Matrix

    return Matrix(((2 / width, 0, 0, -1), (0, 2 / height, 0, -1), (0, 0, -1, 0), (0, 0, 0, 1)))


def text_size(font: int, size: float) -> None:
    import blf  # type: ignore[import-not-found]

    if VERSION >= (4, 0, 0):
        blf.size(font, size)
    else:
        blf.size(font, size, 72)
