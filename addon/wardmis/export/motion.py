# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves while the shutter is open: objects, vertices and the camera at other times than the frame's own, as Cycles takes them.

Times are relative to the shutter's opening: -1 where it opens, 0 in its middle, 1 where it closes.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .. import compat
from .camera import export_camera
from .context import ExportContext
from .mesh import Geometry, Wanted, gather_geometry
from .model import CameraData, InstanceData, MeshData, SceneData

SetFrame = Callable[[int, float], None]  # a frame and a part of one
Key = tuple[Any, ...]

CURVE_POINTS = 256


@dataclass(frozen=True)
class Opening:
    """The shutter's, in frames."""

    middle: float
    length: float

    def frame(self, time: float) -> float:
        return self.middle + time * self.length / 2


def opening_of(scene: Any, layer: Any) -> Opening | None:
    """None where nothing is to be blurred."""
    if not compat.uses_motion_blur(scene, layer) or not scene.render.motion_blur_shutter > 0:
        return None
    length = scene.render.motion_blur_shutter
    shift = {"START": 0.5, "CENTER": 0.0, "END": -0.5}[compat.motion_blur_position(scene)]
    return Opening(scene.frame_current + scene.frame_subframe + shift * length, length)


def shutter_of(scene: Any) -> dict[str, Any]:
    """The film's, as docs/scene-format.md has it."""
    mapping = scene.render.motion_blur_shutter_curve
    result: dict[str, Any] = {}
    mapping.initialize()
    curve = [mapping.evaluate(mapping.curves[0], i / (CURVE_POINTS - 1)) for i in range(CURVE_POINTS)]
    curve = [min(max(value, 0.0), 1e6) for value in curve]
    if max(curve) > 0 and max(curve) - min(curve) > 1e-5 * max(curve):
        result["curve"] = curve
    rolling = compat.rolling_shutter(scene)
    if rolling is not None:
        result["rolling"] = rolling
    return result


@contextlib.contextmanager
def at_its_own_frame_again(scene: Any, set_frame: SetFrame) -> Iterator[None]:
    """Whatever happens within."""
    frame, part = scene.frame_current, scene.frame_subframe
    try:
        yield
    finally:
        set_frame(frame, part)


def go_to(set_frame: SetFrame, frame: float) -> None:
    whole = math.floor(frame)
    set_frame(whole, frame - whole)


def times(steps: int) -> list[float]:
    return [2 * i / (steps - 1) - 1 for i in range(steps)]


def steps_of(obj: Any, parent: Any) -> int:
    """How many an object has, 0 where it is not blurred; one that an instancer brings is so only if both are."""
    settings = [
        s for o in {obj.original, parent.original if parent else obj.original} if (s := compat.motion_settings(o))
    ]
    if not all(s.use_motion_blur for s in settings):
        return 0
    return int((2 << (max((s.motion_steps for s in settings), default=1) - 1)) + 1)


def _deforms(obj: Any, parent: Any, scene: Any) -> bool:
    owners = {obj.original, parent.original if parent else obj.original}
    if not all(s.use_deform_motion for o in owners if (s := compat.motion_settings(o))):
        return False
    return bool(obj.original.is_deform_modified(scene, "RENDER"))


def _key(instance: Any) -> Key:
    parent = instance.parent.name_full if instance.is_instance and instance.parent is not None else None
    return (instance.object.name_full, parent, *instance.persistent_id)


@dataclass
class _Placed:
    data: InstanceData
    mesh: int
    steps: int
    matrices: dict[float, np.ndarray] = field(default_factory=dict)


@dataclass
class _Shape:
    data: MeshData
    owner: str
    wanted: Wanted
    triangles: np.ndarray
    steps: int
    at: dict[float, Geometry | None] = field(default_factory=dict)


class Motion:
    """Told of everything that is exported at the middle of the opening, it finds the same at the other times."""

    def __init__(self, opening: Opening, set_frame: SetFrame, scene: Any, context: ExportContext) -> None:
        self.opening = opening
        self._set_frame = set_frame
        self._scene = scene
        self._context = context
        self._placed: dict[Key, list[_Placed]] = {}  # an object, and its hair
        self._shapes: dict[int, _Shape] = {}  # by mesh
        self._shape_of: dict[Key, int] = {}

    def add(self, instance: Any, data: InstanceData) -> None:
        steps = steps_of(instance.object, instance.parent if instance.is_instance else None)
        if steps:
            self._placed.setdefault(_key(instance), []).append(_Placed(data, data.mesh, steps))

    def add_shape(self, instance: Any, mesh: int, data: MeshData, geometry: Geometry, wanted: Wanted) -> None:
        """The first time that a mesh is exported."""
        obj, parent = instance.object, instance.parent if instance.is_instance else None
        steps = steps_of(obj, parent)
        if steps and compat.owner_of_mesh(instance) is not None and _deforms(obj, parent, self._scene):
            self._shapes[mesh] = _Shape(data, obj.name, wanted, geometry.triangles, steps)
            self._shape_of[_key(instance)] = mesh

    def follow(self, depsgraph: Any, camera: Any, scene: SceneData) -> None:
        """Through the opening, and notes in `scene` what has moved."""
        camera_steps = steps_of(camera, None)
        cameras: dict[float, CameraData] = {0.0: scene.camera}
        wanted = {p.steps for all_of in self._placed.values() for p in all_of} | {
            camera_steps,
            *(s.steps for s in self._shapes.values()),
        }
        for time in sorted({t for steps in wanted if steps for t in times(steps)} - {0.0}):
            self._context.check_cancelled()
            go_to(self._set_frame, self.opening.frame(time))
            if camera_steps and time in times(camera_steps):
                evaluated = camera.evaluated_get(depsgraph)
                cameras[time] = export_camera(evaluated, depsgraph.scene_eval.render)
            self._look(depsgraph, time)
        self._finish(scene)
        if camera_steps:
            self._finish_camera(scene.camera, camera_steps, cameras)

    def _look(self, depsgraph: Any, time: float) -> None:
        for instance in depsgraph.object_instances:
            self._context.check_cancelled()
            if instance.object.type not in {"MESH", "CURVES", "POINTCLOUD"}:
                continue
            key = _key(instance)
            for placed in self._placed.get(key, ()):
                if time in times(placed.steps):
                    placed.matrices[time] = np.array(instance.matrix_world)
            if instance.object.type == "MESH" and key in self._shape_of:
                shape = self._shapes[self._shape_of[key]]
                if time in times(shape.steps):
                    self._context.owner = shape.owner
                    with compat.whole_mesh(instance) as mesh:
                        shape.at[time] = gather_geometry(mesh, shape.wanted, self._context, instance.object)

    def _finish(self, scene: SceneData) -> None:
        for placed in (p for all_of in self._placed.values() for p in all_of):
            data = placed.data
            steps = _filled(placed.matrices, data.matrix, placed.steps)
            if all(np.array_equal(matrix, data.matrix) for matrix in steps):
                continue
            self._context.owner = data.name
            if placed.mesh != data.mesh or any(_has_no_inverse(matrix) for matrix in steps):
                self._context.note(f"object '{data.name}': it is flat at some time; its motion is not blurred")
                continue
            data.motion = steps
        for shape in self._shapes.values():
            self._finish_shape(shape)

    def _finish_shape(self, shape: _Shape) -> None:
        data = shape.data
        same = {
            time: g
            for time, g in shape.at.items()
            if g is not None
            and g.positions.shape == data.positions.shape
            and np.array_equal(g.triangles, shape.triangles)
            and (g.normals is None) == (data.normals is None)
        }
        if len(same) < len(shape.at):
            self._context.owner = shape.owner
            self._context.note(f"object '{shape.owner}': its topology changes; what deforms is not blurred")
            return
        positions = _filled({t: g.positions for t, g in same.items()}, data.positions, shape.steps)
        if all(np.array_equal(p, data.positions) for p in positions):
            return
        data.motion_positions = positions
        if data.normals is not None:
            normals = {t: g.normals for t, g in same.items() if g.normals is not None}
            data.motion_normals = _filled(normals, data.normals, shape.steps)

    def _finish_camera(self, camera: CameraData, steps: int, cameras: dict[float, CameraData]) -> None:
        matrices = _filled({t: c.matrix for t, c in cameras.items()}, camera.matrix, steps)
        if not all(np.array_equal(matrix, camera.matrix) for matrix in matrices):
            camera.motion = matrices
        planes = [cameras[time].view_plane for time in (-1.0, 0.0, 1.0)]
        if camera.projection == "perspective" and any(plane != camera.view_plane for plane in planes):
            camera.view_planes = planes


def _filled(found: dict[float, np.ndarray], middle: np.ndarray, steps: int) -> list[np.ndarray]:
    """One for each step; where something is not there, as it was before, or is in the middle."""
    result: list[np.ndarray] = []
    for time in times(steps):
        result.append(middle if time == 0 else found.get(time, result[-1] if result else middle))
    return result


def _has_no_inverse(matrix: np.ndarray) -> bool:
    axes = matrix[:3, :3]
    stretch = np.linalg.svd(axes, compute_uv=False) if np.isfinite(matrix).all() else np.zeros(3)
    return not stretch[2] > 1e-6 * stretch[0] or not stretch.prod() > 1e-37
