# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's camera -> the exact view plane of the full frame, and the film."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np

from .. import compat, film
from .context import ExportError
from .model import CameraData, FilmData

# Cycles' own limits
NEAREST_FOCUS = 1e-5
SMALLEST_FSTOP = 1e-5

PANORAMAS = {
    "EQUIRECTANGULAR": "equirectangular",
    "CENTRAL_CYLINDRICAL": "central-cylindrical",
    "EQUIANGULAR_CUBEMAP_FACE": "equiangular-cube-face",
    "MIRRORBALL": "mirror-ball",
    "FISHEYE_EQUIDISTANT": "fisheye-equidistant",
    "FISHEYE_EQUISOLID": "fisheye-equisolid",
    "FISHEYE_LENS_POLYNOMIAL": "fisheye-polynomial",
}


def full_resolution(render: Any) -> tuple[int, int]:
    """The pixels of the frame without its border, rounded down as Blender does."""
    scale = render.resolution_percentage
    return (max(1, render.resolution_x * scale // 100), max(1, render.resolution_y * scale // 100))


def border(render: Any, resolution: tuple[int, int]) -> tuple[int, int, int, int]:
    """x0, y0, x1, y1 from the bottom left, end exclusive; in single precision as Blender rounds."""
    width, height = resolution
    if not render.use_border:
        return (0, 0, width, height)
    x0, x1 = (int(np.float32(v) * np.float32(width)) for v in (render.border_min_x, render.border_max_x))
    y0, y1 = (int(np.float32(v) * np.float32(height)) for v in (render.border_min_y, render.border_max_y))
    if x1 <= x0 or y1 <= y0:
        raise ExportError("the render region holds no pixel; draw a larger one (Ctrl-B) or turn Render Region off")
    return (x0, y0, x1, y1)


def export_film(scene: Any) -> FilmData:
    resolution, of = full_resolution(scene.render), film.in_force(scene)
    transparent = scene.render.film_transparent
    return FilmData(resolution, border(scene.render, resolution), of.filter, of.width, of.exposure, transparent)


def export_camera(camera: Any, render: Any) -> CameraData:
    """`camera` is the evaluated object."""
    if camera is None:
        raise ExportError("the scene has no active camera; add one, or choose one in Scene Properties > Camera")
    data = camera.data if camera.type == "CAMERA" else _view_of(camera)
    if data.type not in {"PERSP", "ORTHO", "PANO"}:
        raise ExportError(
            f"camera '{camera.name}' is a custom one, made by a script, which WardMIS does not render; "
            "set Lens > Type to Perspective, Orthographic or Panoramic"
        )
    resolution = full_resolution(render)
    if data.type == "PANO":
        projection, plane, extra = panorama(camera.name, data, render, resolution)
    else:
        projection = "orthographic" if data.type == "ORTHO" else "perspective"
        plane, extra = view_plane(data, render, resolution), {}
    matrix = np.array(camera.matrix_world)
    lengths = np.linalg.norm(matrix[:3, :3], axis=0)
    if not np.isfinite(matrix).all() or not lengths.all():
        raise ExportError(
            f"camera '{camera.name}' has a scale of zero or a transform that is not finite; set its scale to 1"
        )
    matrix[:3, :3] /= lengths
    if data.clip_start >= data.clip_end:
        raise ExportError(f"camera '{camera.name}' sees nothing: its Clip Start is not below its Clip End; correct it")
    result = CameraData(
        camera.name,
        matrix,
        projection,
        plane,
        (data.clip_start, data.clip_end),
        **extra,
    )
    if data.dof.use_dof:
        aperture = max(data.dof.aperture_fstop, SMALLEST_FSTOP) * 2
        result.lens_radius = (1.0 if projection == "orthographic" else data.lens * 1e-3) / aperture
        result.focus_distance = max(_focus_distance(camera, data.dof, matrix), NEAREST_FOCUS)
        result.blades = data.dof.aperture_blades if data.dof.aperture_blades > 2 else 0
        result.blade_rotation = data.dof.aperture_rotation
        result.blade_ratio = data.dof.aperture_ratio
    return result


def _view_of(obj: Any) -> Any:
    """Of an active camera that is none, as Cycles has it: a lens of 50 mm, and of a spot lamp that of its cone."""
    is_spot = obj.type == "LIGHT" and obj.data.type == "SPOT"
    return SimpleNamespace(
        type="PERSP",
        lens=16.0 / math.tan(obj.data.spot_size / 2) if is_spot else 50.0,
        sensor_fit="AUTO",
        sensor_width=36.0,
        sensor_height=24.0,
        shift_x=0.0,
        shift_y=0.0,
        clip_start=1e-5,
        clip_end=1e5,
        dof=SimpleNamespace(use_dof=False),
    )


def view_plane(data: Any, render: Any, resolution: tuple[int, int]) -> tuple[float, float, float, float]:
    """left, right, bottom, top: at distance 1 for a perspective camera, in metres for an orthographic one."""
    horizontal, aspect, sensor = _fit(data, render, resolution)
    x_half, y_half = (aspect, 1.0) if horizontal else (1.0, aspect)
    # the longer side is 2 aspect long; shifts are measured in it
    scale = data.ortho_scale / (2 * aspect) if data.type == "ORTHO" else 0.5 * sensor / data.lens / aspect
    x_shift = 2 * aspect * data.shift_x
    y_shift = 2 * aspect * data.shift_y
    return (
        (x_shift - x_half) * scale,
        (x_shift + x_half) * scale,
        (y_shift - y_half) * scale,
        (y_shift + y_half) * scale,
    )


def panorama(
    name: str, data: Any, render: Any, resolution: tuple[int, int]
) -> tuple[str, tuple[float, float, float, float], dict[str, Any]]:
    """The projection, its view plane, and what else the camera has of it, as docs/scene-format.md has them."""
    settings = compat.panorama_settings(data)
    if settings is None:
        raise ExportError(
            f"camera '{name}' is panoramic, and the settings of that are Cycles': turn on that add-on in the Preferences"
        )
    kind = settings.panorama_type
    horizontal, aspect, sensor = _fit(data, render, resolution)
    width, height = (sensor, sensor / aspect) if horizontal else (sensor / aspect, sensor)
    half, extra = math.pi / 4, {}
    if kind == "EQUIRECTANGULAR":
        plane = (settings.longitude_min, settings.longitude_max, settings.latitude_min, settings.latitude_max)
    elif kind == "CENTRAL_CYLINDRICAL":
        z = (
            v / settings.central_cylindrical_radius
            for v in (settings.central_cylindrical_range_v_min, settings.central_cylindrical_range_v_max)
        )
        plane = (settings.central_cylindrical_range_u_min, settings.central_cylindrical_range_u_max, *z)
    elif kind == "EQUIANGULAR_CUBEMAP_FACE":
        plane = (-half, half, -half, half)
    elif kind == "MIRRORBALL":
        plane = (-1.0, 1.0, -1.0, 1.0)
    else:
        extra["fov"] = settings.fisheye_fov
        half = settings.fisheye_fov / 2
        if kind == "FISHEYE_EQUIDISTANT":
            plane = (-half, half, -half, half)
        else:
            unit = settings.fisheye_lens if kind == "FISHEYE_EQUISOLID" else 1.0  # a lens, or millimetres
            plane = (-width / 2 / unit, width / 2 / unit, -height / 2 / unit, height / 2 / unit)
        if kind == "FISHEYE_LENS_POLYNOMIAL":
            extra["polynomial"] = tuple(-getattr(settings, f"fisheye_polynomial_k{i}") for i in range(5))
    left, right, bottom, top = plane
    if left == right or bottom == top:
        raise ExportError(f"camera '{name}' sees nothing: its panorama spans no angle; correct its Lens settings")
    # shifts are measured in the frame
    x, y = data.shift_x * (right - left), data.shift_y * (top - bottom)
    return PANORAMAS[kind], (left + x, right + x, bottom + y, top + y), extra


def _fit(data: Any, render: Any, resolution: tuple[int, int]) -> tuple[bool, float, float]:
    """Whether the sensor's size is the frame's width (or its height), that divided by the other side, and the size."""
    x_ratio = resolution[0] * render.pixel_aspect_x
    y_ratio = resolution[1] * render.pixel_aspect_y
    horizontal = x_ratio > y_ratio if data.sensor_fit == "AUTO" else data.sensor_fit == "HORIZONTAL"
    sensor = data.sensor_height if data.sensor_fit == "VERTICAL" else data.sensor_width
    return horizontal, x_ratio / y_ratio if horizontal else y_ratio / x_ratio, sensor


def _focus_distance(camera: Any, dof: Any, matrix: np.ndarray) -> float:
    focus = dof.focus_object
    if focus is None:
        return float(dof.focus_distance)
    target = focus.matrix_world
    if dof.focus_subtarget and focus.pose is not None and dof.focus_subtarget in focus.pose.bones:
        target = target @ focus.pose.bones[dof.focus_subtarget].matrix
    return float(abs(matrix[:3, 2] @ (matrix[:3, 3] - np.array(target.translation))))
