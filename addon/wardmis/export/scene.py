# SPDX-License-Identifier: GPL-3.0-or-later
"""The evaluated depsgraph -> SceneData. Reads only; nothing of the user's is changed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .. import compat
from .camera import export_camera, export_film
from .context import ExportContext, ExportError
from .image import export_image
from .light import export_light
from .material import export_material
from .mesh import Geometry, assemble, gather_geometry
from .model import VISIBILITY, ColorInput, InstanceData, MaterialData, SceneData
from .world import export_world

NO_MATERIAL = MaterialData("(no material)", diffuse=ColorInput((0.8, 0.8, 0.8)))  # as Blender shows it

# their surfaces arrive as meshes of their own in the depsgraph
SEEN_AS_MESHES = {"CURVE", "SURFACE", "META", "FONT"}
# Blender draws them over the image of any engine
DRAWN_BY_BLENDER = {"GPENCIL", "GREASEPENCIL"}
# of a transform that the renderer can invert in single precision
SMALLEST_DETERMINANT = 1e-37
INVISIBLE = {"EMPTY", "CAMERA", "ARMATURE", "LATTICE", "SPEAKER", "LIGHT_PROBE"}


def gather_scene(
    depsgraph: Any, generator: str, camera: Any = None, cancelled: Callable[[], bool] | None = None
) -> SceneData:
    """Everything that the render of `depsgraph` needs. `camera`: instead of the scene's active one.

    Raises ExportError with a message for the user, and ExportCancelled once `cancelled()` answers true.
    """
    scene = depsgraph.scene_eval
    camera = camera or scene.camera
    film = export_film(scene)
    context = ExportContext(export_image, cancelled)
    gatherer = _Gatherer(depsgraph, context)
    _note_scene_settings(scene, context)
    camera_data = export_camera(camera.evaluated_get(depsgraph) if camera else None, scene.render)
    context.check_finite(film, "the scene's film")
    context.check_finite(camera_data, f"camera '{camera_data.name}'")
    gatherer.gather_objects(depsgraph)
    context.owner = ""
    world = export_world(compat.world_of(depsgraph.view_layer_eval, scene), context)
    return SceneData(
        generator,
        film,
        camera_data,
        world,
        context.images,
        context.textures,
        gatherer.materials,
        gatherer.meshes,
        gatherer.instances,
        gatherer.lights,
        context.notes,
    )


def _note_scene_settings(scene: Any, context: ExportContext) -> None:
    if scene.render.use_motion_blur:
        context.note("motion blur is not supported; the frame is rendered at its own time")


class _Gatherer:
    """One pass over the instances of the depsgraph; what is shared is exported once."""

    def __init__(self, depsgraph: Any, context: ExportContext) -> None:
        self.context = context
        self.view_layer = depsgraph.view_layer
        self.override = depsgraph.view_layer_eval.material_override
        self.materials: list[MaterialData] = []
        self.meshes: list[Any] = []
        self.instances: list[InstanceData] = []
        self.lights: list[Any] = []
        self._material_index: dict[str | None, int] = {}
        self._mesh_index: dict[tuple[int, tuple[int, ...]], int | None] = {}
        self._geometry: dict[tuple[int, bool], Geometry | None] = {}
        self._hidden: dict[int, frozenset[str]] = {}
        self._noted_hair: set[str] = set()

    def gather_objects(self, depsgraph: Any) -> None:
        for instance in depsgraph.object_instances:
            self.context.check_cancelled()
            obj = instance.object
            kind = obj.type
            if kind in INVISIBLE:
                continue
            self.context.owner = obj.name
            if instance.show_particles:
                self._note_hair(obj)
            if not instance.show_self:
                continue
            self._note_light_linking(obj.original)
            if kind == "MESH":
                self._mesh(obj, instance)
            elif kind == "LIGHT":
                matrix = self._matrix(instance)
                light = export_light(obj.data, obj.name, matrix, self._hidden_from(obj, instance), self.context)
                if light is not None:
                    self.lights.append(light)
            elif kind not in SEEN_AS_MESHES | DRAWN_BY_BLENDER:
                self.context.note(f"object '{obj.name}': {kind.lower()} objects are not supported; it is left out")
        self._leave_out_flattened()

    def _leave_out_flattened(self) -> None:
        """All at once: one matrix at a time would be slow for many instances."""
        if not self.instances:
            return
        determinants = np.linalg.det(np.array([instance.matrix[:3, :3] for instance in self.instances]))
        flat = np.abs(determinants) < SMALLEST_DETERMINANT
        names = sorted({instance.name for instance, is_flat in zip(self.instances, flat) if is_flat})
        if names:
            others = f" and {len(names) - 1} more" if len(names) > 1 else ""
            self.context.note(f"object '{names[0]}'{others}: a scale of 0, or next to it, cannot be rendered; left out")
            self.instances = [instance for instance, is_flat in zip(self.instances, flat) if not is_flat]

    def _matrix(self, instance: Any) -> np.ndarray:
        matrix = np.array(instance.matrix_world)  # a copy: the instance lives for one step of the iteration
        if not np.isfinite(matrix).all():
            raise ExportError(
                f"object '{self.context.owner}': its transform is not finite; clear its location, rotation and scale, "
                "or look at its constraints and drivers"
            )
        return matrix

    def _mesh(self, obj: Any, instance: Any) -> None:
        mesh = obj.data
        materials = self._slots(obj, mesh)
        # the evaluated mesh is the same one for objects that share a mesh and do not modify it
        key = (mesh.as_pointer(), materials)
        if key not in self._mesh_index:
            self._mesh_index[key] = self._add_mesh(instance, materials)
        index = self._mesh_index[key]
        if index is not None:
            self._note_compositing(obj.original)
            hidden = self._hidden_from(obj, instance)
            if len(hidden) < len(VISIBILITY):
                self.instances.append(InstanceData(obj.name, index, self._matrix(instance), hidden))

    def _add_mesh(self, instance: Any, materials: tuple[int, ...]) -> int | None:
        mesh = instance.object.data
        with_uvs = any(self.materials[m].needs_uv for m in materials)
        key = (mesh.as_pointer(), with_uvs)
        if key not in self._geometry:
            with compat.whole_mesh(instance) as whole:
                self._geometry[key] = gather_geometry(whole, with_uvs, self.context)
        geometry = self._geometry[key]
        if geometry is None:
            return None
        self.meshes.append(assemble(mesh.name, geometry, materials))
        return len(self.meshes) - 1

    def _slots(self, obj: Any, mesh: Any) -> tuple[int, ...]:
        """The exported material of each slot, at least one."""
        if self.override is not None:
            return (self._material(self.override),)
        materials = [slot.material for slot in obj.material_slots] or list(mesh.materials) or [None]
        return tuple(self._material(m) for m in materials)

    def _material(self, material: Any) -> int:
        key = None if material is None else material.name_full
        if key not in self._material_index:
            data = NO_MATERIAL if material is None else export_material(material, self.context)
            self._material_index[key] = len(self.materials)
            self.materials.append(data)
        return self._material_index[key]

    def _hidden_from(self, obj: Any, instance: Any) -> frozenset[str]:
        """The kinds of ray that do not see the object; an instance is hidden with its instancer, too."""
        hidden = self._object_hidden_from(obj)
        if instance.is_instance and instance.parent is not None:
            hidden |= self._object_hidden_from(instance.parent)
        return hidden

    def _object_hidden_from(self, obj: Any) -> frozenset[str]:
        original = obj.original
        key = original.as_pointer()
        if key not in self._hidden:
            hidden = {kind for kind in VISIBILITY if not getattr(original, f"visible_{kind}")}
            if original.indirect_only_get(view_layer=self.view_layer):
                hidden.add("camera")
            self._hidden[key] = frozenset(hidden)
        return self._hidden[key]

    def _note_compositing(self, original: Any) -> None:
        holdout = original.is_holdout or original.holdout_get(view_layer=self.view_layer)
        for flag, what in ((holdout, "holdouts"), (original.is_shadow_catcher, "shadow catchers")):
            if flag:
                self.context.note(
                    f"object '{original.name}': {what} are not supported; it is rendered as any other object"
                )

    def _note_light_linking(self, original: Any) -> None:
        linking = getattr(original, "light_linking", None)
        if linking is not None and (linking.receiver_collection or linking.blocker_collection):
            self.context.note(
                f"object '{original.name}': light linking is not supported; its light reaches all objects"
            )

    def _note_hair(self, obj: Any) -> None:
        for system in obj.particle_systems:
            if system.settings.type == "HAIR" and system.settings.render_type == "PATH":
                self.context.note(
                    f"object '{obj.name}': the hair strands of '{system.name}' are not supported; they are left out"
                )
