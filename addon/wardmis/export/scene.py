# SPDX-License-Identifier: GPL-3.0-or-later
"""The evaluated depsgraph -> SceneData. Reads only; nothing of the user's is changed."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from .. import compat
from .attribute import NOWHERE, OF_OBJECT, object_attributes
from .camera import export_camera, export_film
from .context import ExportContext, ExportError, Tell
from .hashing import random_of
from .image import WithinMemory
from .instance_attributes import InstanceAttributes, are_out_of_reach
from .light import export_light
from .material import by_rules_of_cycles, export_material, is_matte
from .mesh import Geometry, Wanted, assemble, gather_geometry, has_bent_normals, transformed, wanted_of
from .model import VISIBILITY, ClosureData, ColorInput, InstanceData, MaterialData, ScalarInput, SceneData
from .motion import Motion, Opening, SetFrame, at_its_own_frame_again, go_to, opening_of, shutter_of
from .program.lamp import LampObject
from .simplify import not_simplified, shrinking_of
from .strands import curve_settings, gather_curves, gather_hair, gather_points, particle_hair
from .world import export_worlds

NO_MATERIAL = MaterialData("(no material)", diffuse=ColorInput((0.8, 0.8, 0.8)))  # as Cycles shows it
if compat.NO_MATERIAL_IS_PRINCIPLED:
    _inputs = {"baseColor": NO_MATERIAL.diffuse, "roughness": ScalarInput(0.5), "ior": ScalarInput(1.5)}
    _parameters = {"version": compat.CYCLES, "distribution": "multi-ggx"}
    NO_MATERIAL = MaterialData(
        NO_MATERIAL.name, closures=[ClosureData("principled", None, _inputs, _parameters, None, None, None)]
    )

# their surfaces arrive as meshes of their own in the depsgraph
SEEN_AS_MESHES = {"CURVE", "SURFACE", "META", "FONT"}
# Blender draws them over the image of any engine
DRAWN_BY_BLENDER = {"GPENCIL", "GREASEPENCIL"}
# of a transform that the renderer can invert in single precision
SMALLEST_DETERMINANT = 1e-37
# of a shape's thickness to its length, and of its width: less is nothing, since a matrix of single precision, turned by those of
# its parents, is that inexact
SMALLEST_STRETCH = 1e-6
INVISIBLE = {"EMPTY", "CAMERA", "ARMATURE", "LATTICE", "SPEAKER", "LIGHT_PROBE"}


def gather_scene(
    depsgraph: Any,
    generator: str,
    camera: Any = None,
    cancelled: Callable[[], bool] | None = None,
    set_frame: SetFrame | None = None,
    tell: Tell | None = None,
) -> SceneData:
    """Everything that the render of `depsgraph` needs. `camera`: instead of the scene's active one. `set_frame`: takes `depsgraph` to
    another time; without it nothing is blurred by its motion. `tell` is called with what takes long.

    Raises ExportError with a message for the user, and ExportCancelled once `cancelled()` answers true.
    """
    opening = opening_of(depsgraph.scene_eval, depsgraph.view_layer_eval)
    if opening is None:
        return _gather(depsgraph, generator, camera, cancelled, None, None, tell)
    if set_frame is None:
        result = _gather(depsgraph, generator, camera, cancelled, None, None, tell)
        result.notes.append("motion blur is left out: it needs a render; the frame is exported at its own time")
        return result
    with at_its_own_frame_again(depsgraph.scene, set_frame):
        return _gather(depsgraph, generator, camera, cancelled, opening, set_frame, tell)


def _gather(
    depsgraph: Any,
    generator: str,
    camera: Any,
    cancelled: Callable[[], bool] | None,
    opening: Opening | None,
    set_frame: SetFrame | None,
    tell: Tell | None,
) -> SceneData:
    frame = depsgraph.scene_eval.frame_current
    if opening is not None and set_frame is not None and opening.middle != frame + depsgraph.scene_eval.frame_subframe:
        go_to(set_frame, opening.middle)
    scene = depsgraph.scene_eval
    camera = camera or scene.camera
    film = export_film(scene)
    film.keep_uvs = depsgraph.view_layer.use_pass_uv
    film.alpha_threshold = depsgraph.view_layer.pass_alpha_threshold
    context = ExportContext(WithinMemory(shrinking_of(depsgraph.scene)), cancelled, frame, tell)
    for deviation in not_simplified(depsgraph):
        context.note(deviation)
    if film.transparent and getattr(getattr(scene, "cycles", None), "film_transparent_glass", False):
        context.note("the film's Transparent Glass is not supported: what is seen through glass stays opaque")
    space = compat.working_space()
    if space != compat.LINEAR:
        context.note(
            f"the file's working space, {space}, is not supported: colours of images and spectra are in {compat.LINEAR}"
        )
    context.layer = (depsgraph.view_layer, depsgraph.scene, depsgraph.scene.world)
    motion = None
    if opening is not None and set_frame is not None:
        motion = Motion(opening, set_frame, depsgraph.scene, context)
        film.shutter = shutter_of(scene)
    gatherer = _Gatherer(depsgraph, context, motion)
    camera_data = export_camera(camera.evaluated_get(depsgraph) if camera else None, scene.render)
    context.check_finite(film, "the scene's film")
    context.check_finite(camera_data, f"camera '{camera_data.name}'")
    gatherer.gather_objects(depsgraph)
    context.owner = ""
    layer = depsgraph.view_layer_eval
    worlds = export_worlds(compat.world_of(layer, scene), context) if layer.use_sky else []
    result = SceneData(
        generator,
        film,
        camera_data,
        worlds,
        context.images,
        context.textures,
        gatherer.materials,
        gatherer.meshes,
        gatherer.instances,
        gatherer.lights,
        context.notes,
    )
    if motion is not None:
        motion.follow(depsgraph, camera.original, result)
    return result


def _flat(axes: np.ndarray) -> np.ndarray:
    """Which of (n, 3, 3) matrices have no inverse to render with."""
    determinant = np.abs(np.linalg.det(axes))
    # the product of the three stretches: where it is more, none can be so small; what that leaves are few
    doubtful = determinant <= SMALLEST_STRETCH * np.linalg.norm(axes, axis=(1, 2)) ** 3
    flat: np.ndarray = determinant < SMALLEST_DETERMINANT
    stretch = np.linalg.svd(axes[doubtful], compute_uv=False)
    flat[doubtful] |= stretch[:, 2] <= SMALLEST_STRETCH * stretch[:, 0]
    return flat


def _random_of(obj: Any, instance: Any) -> float:
    return random_of(instance.random_id if instance.is_instance else None, obj.name)


def _place_on(instance: Any) -> dict[str, tuple[float, ...]]:
    """Of what brings an instance; as Cycles has it."""
    if not instance.is_instance:
        return {}
    return {"UV": (*instance.uv, 0.0), "Generated": tuple(0.5 * x - 0.5 for x in instance.orco)}


def _is_gas_domain(obj: Any) -> bool:
    """Whether a fluid simulation's smoke is what there is to see of the object, not its mesh."""
    domains = (
        m.domain_settings for m in (obj.modifiers if obj else ()) if m.type == "FLUID" and m.fluid_type == "DOMAIN"
    )
    return any(settings.domain_type == "GAS" for settings in domains)


def _color_owner(obj: Any, instance: Any) -> Any:
    """Whose Color in the viewport is that of a placed object: the outermost instancer's, as Blender draws it."""
    return instance.parent if instance.is_instance and instance.parent is not None else obj


class Look(NamedTuple):
    """How an object is seen, whatever it is made of."""

    hidden: frozenset[str]  # kinds of ray that do not see it
    holdout: bool
    shadow_catcher: bool
    shadow_terminator: tuple[float, float]


class _Gatherer:
    """One pass over the instances of the depsgraph; what is shared is exported once."""

    def __init__(self, depsgraph: Any, context: ExportContext, motion: Motion | None) -> None:
        self.context = context
        self.motion = motion
        self.view_layer = depsgraph.view_layer
        self.scene = depsgraph.scene
        self.override = depsgraph.view_layer_eval.material_override
        self.materials: list[MaterialData] = []
        self.meshes: list[Any] = []
        self.instances: list[InstanceData] = []
        self.lights: list[Any] = []
        self._material_index: dict[str | None, int] = {}
        self._mesh_index: dict[tuple[int, str, tuple[int, ...]], int | None] = {}
        self._geometry: dict[tuple[int, str, Wanted], Geometry | None] = {}
        self._hidden: dict[int, frozenset[str]] = {}
        self._looks: dict[tuple[int, int], Look] = {}
        self._instance_attributes = InstanceAttributes()
        self._curves = curve_settings(depsgraph.scene_eval)

    def gather_objects(self, depsgraph: Any) -> None:
        for instance in depsgraph.object_instances:
            self.context.check_cancelled()
            obj = instance.object
            kind = obj.type
            if kind in INVISIBLE:
                continue
            self.context.owner = obj.name
            if instance.show_particles and self.view_layer.use_strand:
                self._hair(obj, instance)
            if not instance.show_self:
                continue
            self._note_light_linking(obj.original)
            if kind == "MESH":
                if self.view_layer.use_solid:
                    self._place(obj, instance, "mesh", obj.data, self._mesh_geometry)
            elif kind == "CURVES":
                if self.view_layer.use_strand:
                    self._place(obj, instance, "curves", obj.data, self._curves_geometry)
            elif kind == "POINTCLOUD":
                self._place(obj, instance, "points", obj.data, self._points_geometry)
            elif kind == "LIGHT":
                matrix, hidden = self._matrix(instance), self._hidden_from(obj, instance)
                light = export_light(obj.data, obj.name, matrix, hidden, self.context, self._lamp_object(obj, instance))
                if light is not None:
                    light.on_catchers = obj.original.is_shadow_catcher
                    self.lights.append(light)
            elif kind not in SEEN_AS_MESHES | DRAWN_BY_BLENDER:
                self.context.note(f"object '{obj.name}': {kind.lower()} objects are not supported; it is left out")
        self._bake_flattened()
        if compat.SPHERES_STAY_ROUND and self.motion is None:
            self._keep_spheres_round()

    def _bake_flattened(self) -> None:
        """Gives what a transform without an inverse makes flat a mesh of its own, in the shape that it has in the world.

        All at once: one matrix at a time would be slow for many instances.
        """
        if not self.instances:
            return
        axes = np.array([instance.matrix[:3, :3] for instance in self.instances], float)
        flat = _flat(axes)
        baked: dict[tuple[int, bytes], int] = {}
        kept = []
        for instance, linear, is_flat in zip(self.instances, axes, flat):
            if is_flat:
                if self.meshes[instance.mesh].radii is not None:
                    continue  # it has no thickness left
                stretch = np.linalg.svd(linear, compute_uv=False)
                if not stretch[1] > SMALLEST_STRETCH * stretch[0]:
                    continue  # a line or a point has nothing to show
                key = (instance.mesh, linear.tobytes())
                if key not in baked:
                    baked[key] = len(self.meshes)
                    self.meshes.append(transformed(self.meshes[instance.mesh], linear))
                instance.mesh = baked[key]
                instance.matrix[:3, :3] = np.eye(3)
            kept.append(instance)
        self.instances = kept

    def _keep_spheres_round(self) -> None:
        """Puts point clouds that are placed once, and unevenly scaled, into the world as they are in Cycles."""
        uses = Counter(instance.mesh for instance in self.instances)
        for instance in self.instances:
            mesh, linear = self.meshes[instance.mesh], instance.matrix[:3, :3]
            if mesh.shape == "spheres" and uses[instance.mesh] == 1:
                product = linear.T @ linear
                if np.abs(product - np.eye(3) * product[0, 0]).max() > SMALLEST_STRETCH * np.abs(product).max():
                    self.meshes[instance.mesh] = transformed(mesh, linear)
                    instance.matrix[:3, :3] = np.eye(3)
                    programs = (self.materials[primitive.material].program for primitive in mesh.primitives)
                    if any(p is not None and p.reads("object", "object-normal", "generated") for p in programs):
                        self.context.note(
                            f"object '{instance.name}': Object and Generated coordinates of points are not supported under a scale "
                            "that is not even; they are those without its scale and rotation; apply these to the points"
                        )

    def _matrix(self, instance: Any) -> np.ndarray:
        # a copy, since the instance lives for one step of the iteration; of the matrix itself numpy takes five times as long
        values = [x for row in instance.matrix_world for x in row]
        if not math.isfinite(sum(values)):
            raise ExportError(
                f"object '{self.context.owner}': its transform is not finite; clear its location, rotation and scale, "
                "or look at its constraints and drivers"
            )
        return np.array(values).reshape(4, 4)

    def _hair(self, obj: Any, instance: Any) -> None:
        """Strands of particles: of the object itself, or of its instances by collections and particles."""
        owner = instance.instance_object if instance.is_instance else obj
        if obj.type != "MESH" or compat.owner_of_mesh(instance) is None or not particle_hair(owner):
            return
        if owner.original.mode in {"EDIT", "PARTICLE_EDIT"}:
            self.context.note(f"object '{owner.name}': its hair is not rendered while it is edited, as in Cycles")
            return
        if self.motion is not None and owner.original.is_deform_modified(self.scene, "RENDER"):
            self.context.note(f"object '{owner.name}': its hair is blurred as the object moves, not as it bends")
        self._place(obj, instance, "hair", owner, self._hair_geometry)

    def _place(self, obj: Any, instance: Any, kind: str, source: Any, gather: Callable[..., Geometry | None]) -> None:
        """An instance of what `gather(instance, source, wanted)` makes of an evaluated datablock, once for all that share it."""
        materials = self._slots(obj, obj.data)
        # the evaluated mesh is the same one for objects that share a mesh and do not modify it
        key = (source.as_pointer(), kind, materials)
        if key not in self._mesh_index:
            self._mesh_index[key] = self._add_mesh(instance, kind, source, materials, gather)
        index = self._mesh_index[key]
        if index is not None:
            look = self._look(obj, instance)
            if len(look.hidden) < len(VISIBILITY):
                data = InstanceData(obj.name, index, self._matrix(instance), look.hidden)
                data.holdout, data.shadow_catcher = look.holdout, look.shadow_catcher
                data.shadow_terminator = look.shadow_terminator
                self._describe(data, obj, instance, materials)
                self.instances.append(data)
                if self.motion is not None:
                    self.motion.add(instance, data)

    def _look(self, obj: Any, instance: Any) -> Look:
        """The same for all instances of an object by one instancer, of which there may be many."""
        original, parent = obj.original, instance.parent if instance.is_instance else None
        key = original.as_pointer(), 0 if parent is None else parent.as_pointer()
        if key not in self._looks:
            owner, *offsets = compat.shadow_terminator(obj)
            geometry, shading = (float(getattr(owner, name, 0.0)) for name in offsets)
            self._looks[key] = Look(
                self._hidden_from(obj, instance),
                bool(original.is_holdout or original.holdout_get(view_layer=self.view_layer)),
                original.is_shadow_catcher or (parent is not None and parent.is_shadow_catcher),
                (geometry, shading),
            )
        return self._looks[key]

    def _describe(self, data: InstanceData, obj: Any, instance: Any, materials: tuple[int, ...]) -> None:
        """What programs read of the object."""
        programs = [p for m in set(materials) if (p := self.materials[m].program) is not None]
        if self.view_layer.use_pass_object_index or any(p.reads("object-index") for p in programs):
            data.index = obj.pass_index
        for program in programs:
            if program.reads("object-color", "object-alpha"):
                r, g, b, a = _color_owner(obj, instance).color
                data.color = (r, g, b, a)
            if program.reads("object-random"):
                data.random = _random_of(obj, instance)
            if any(name.startswith(OF_OBJECT) for name in program.attributes):
                owners = self._owners_of_attributes(obj, instance) | {"layer:": self.context.layer}
                named = object_attributes(program.attributes, owners)
                self._note_out_of_reach(instance, named)
                data.attributes = tuple(sorted({*data.attributes, *named}))

    def _owners_of_attributes(self, obj: Any, instance: Any) -> dict[str, tuple[Any, ...]]:
        """What has the attributes of the object, of what places it, and of the place, by how their names begin; as Blender looks."""
        own = obj, obj.data
        by_instancer = own
        if instance.is_instance:
            particles = () if instance.particle_system is None else (instance.particle_system.settings,)
            parents = () if instance.parent is None else (instance.parent,)
            by_instancer = *particles, *self._instance_attributes.of(instance), *parents, *own
        return {"object:": own, "instancer:": by_instancer, "instance:": (_place_on(instance),)}

    def _note_out_of_reach(self, instance: Any, named: Iterable[tuple[str, tuple[float, ...]]]) -> None:
        for name, value in named:
            if name.startswith("instancer:") and value == NOWHERE and are_out_of_reach(instance):
                self.context.note(
                    f"object '{instance.parent.name}': an Attribute node of what it places reads '{name[len('instancer:') :]}' of its "
                    f"instances; this is not supported {compat.WHERE_INSTANCES_TELL_NOTHING}; 0 is used instead"
                )

    def _lamp_object(self, obj: Any, instance: Any) -> LampObject:
        r, g, b, alpha = _color_owner(obj, instance).color
        owners = self._owners_of_attributes(obj, instance)
        return LampObject((r, g, b), alpha, float(obj.pass_index), _random_of(obj, instance), owners)

    def _add_mesh(
        self, instance: Any, kind: str, source: Any, materials: tuple[int, ...], gather: Callable[..., Geometry | None]
    ) -> int | None:
        wanted = wanted_of(self.materials[m] for m in materials)
        if self.view_layer.use_pass_uv:
            wanted = replace(wanted, uv_sets=wanted.uv_sets | {""})
        key = (source.as_pointer(), kind, wanted)
        if key not in self._geometry:
            self._geometry[key] = gather(instance, source, wanted)
        geometry = self._geometry[key]
        if geometry is None:
            return None
        programs = (self.materials[m].program for m in materials)
        if not geometry.tangents and any(p is not None and p.reads("vector-displacement") for p in programs):
            self.context.note(
                f"object '{self.context.owner}': its material displaces along tangents of a UV map, which it has not; it is displaced along "
                "its normals alone"
            )
        if any(is_matte(self.materials[m]) for m in materials) and has_bent_normals(geometry):
            for m in set(materials):
                self.materials[m] = by_rules_of_cycles(self.materials[m])
        self.meshes.append(assemble(source.name, geometry, materials))
        if self.motion is not None and kind == "mesh":
            self.motion.add_shape(instance, len(self.meshes) - 1, self.meshes[-1], geometry, wanted)
        return len(self.meshes) - 1

    def _mesh_geometry(self, instance: Any, _mesh: Any, wanted: Wanted) -> Geometry | None:
        owner = compat.owner_of_mesh(instance)
        if _is_gas_domain(owner):
            self.context.note(
                f"object '{self.context.owner}': smoke and fire are not supported; their domain is left out"
            )
            return None
        if owner is not None and compat.is_subdivided_by_pixels(self.scene, owner.original):
            self.context.note(
                f"object '{self.context.owner}': adaptive subdivision is not supported; its modifier subdivides it as often as it says"
            )
        with compat.whole_mesh(instance) as whole:
            return gather_geometry(whole, wanted, self.context, instance.object)

    def _hair_geometry(self, _instance: Any, owner: Any, wanted: Wanted) -> Geometry | None:
        return gather_hair(owner, wanted, self._curves, self.context)

    def _curves_geometry(self, _instance: Any, curves: Any, wanted: Wanted) -> Geometry | None:
        return gather_curves(curves, wanted, self._curves, self.context)

    def _points_geometry(self, _instance: Any, cloud: Any, wanted: Wanted) -> Geometry | None:
        return gather_points(cloud, wanted, self.context)

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

    def _note_light_linking(self, original: Any) -> None:
        linking = getattr(original, "light_linking", None)
        if linking is not None and (linking.receiver_collection or linking.blocker_collection):
            self.context.note(
                f"object '{original.name}': light linking is not supported; its light reaches all objects"
            )
