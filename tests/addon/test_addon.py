# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on as a guest in Blender: it comes and goes without a trace, and agrees with its documents."""

from __future__ import annotations

import ast
import os
import re
import types
import unittest
from unittest import mock

import bpy
import wardmis
from support import ADDON, FAKE
from wardmis import data_panels, nodes, panels, properties
from wardmis.export import VERSION

COMMAND = (ADDON.parents[1] / "docs" / "command.md").read_text()


def traces() -> dict[str, object]:
    theirs = [p for p in bpy.types.Panel.__subclasses__() if not p.__module__.startswith("wardmis.")]
    return {
        "classes": sorted(name for name in dir(bpy.types) if "WARDMIS" in name.upper()),
        "panels": sorted(p.__name__ for p in theirs if "WARDMIS" in getattr(p, "COMPAT_ENGINES", ())),
        "scene": any(hasattr(bpy.types.Scene, name) for name in ("wardmis", "wardmis_comparison")),
        "view layer": hasattr(bpy.types.ViewLayer, "wardmis"),
        "window manager": hasattr(bpy.types.WindowManager, "wardmis_results"),
        "handlers": len(bpy.app.handlers.load_pre),
        "menu": len(bpy.types.TOPBAR_MT_file_export._dyn_ui_initialize()),
    }


class Registration(unittest.TestCase):
    def test_twice_without_a_trace(self):
        registered = traces()
        for _ in range(2):
            wardmis.unregister()
            gone = traces()
            self.assertEqual((gone["classes"], gone["panels"], gone["scene"]), ([], [], False))
            self.assertEqual(gone["menu"], registered["menu"] - 1)
            self.assertEqual((gone["window manager"], gone["view layer"]), (False, False))
            self.assertEqual(gone["handlers"], registered["handlers"] - 3)
            wardmis.register()
            self.assertEqual(traces(), registered)

    def test_one_version(self):
        self.assertEqual(".".join(map(str, wardmis.bl_info["version"])), VERSION)
        self.assertIn(f'version = "{VERSION}"', (ADDON / "blender_manifest.toml").read_text())

    def test_bl_info_is_readable_without_running(self):
        tree = ast.parse((ADDON / "__init__.py").read_text())
        values = [node.value for node in tree.body if isinstance(node, ast.Assign) and node.targets[0].id == "bl_info"]
        self.assertEqual(ast.literal_eval(values[0]), wardmis.bl_info)


class Settings(unittest.TestCase):
    def default(self, name: str):
        return properties.WARDMIS_PG_scene.bl_rna.properties[name].default

    def test_choices_and_defaults_are_those_of_the_command(self):
        for option, name, items in (
            ("--allocation", "allocation", properties.ALLOCATIONS),
            ("--pixels", "pixels", properties.PIXELS),
            ("--weights", "weights", properties.WEIGHTS),
            ("--integrand", "integrand", properties.INTEGRANDS),
            ("--integrator", "integrator", properties.INTEGRATORS),
            ("--sampler", "sampler", properties.SAMPLERS),
        ):
            line = next(line for line in COMMAND.splitlines() if line.startswith(f"| `{option}`"))
            words = re.findall(r"`([^`]+)`", line.split("|")[2])
            self.assertEqual(words[-1], self.default(name), option)
            self.assertEqual(set(words), {item[0] for item in items}, option)

    def test_numbers_are_those_of_the_command(self):
        for option, name in (
            ("--samples-per-hit n", "samples_per_hit"),
            ("--pilot-spp P", "pilot_samples"),
            ("--min-fraction A", "min_fraction"),
            ("--light-paths N", "light_paths"),
            ("--connections K", "connections"),
            ("--max-depth D", "max_depth"),
            ("--max-diffuse B", "max_diffuse"),
            ("--max-glossy B", "max_glossy"),
            ("--max-transmission B", "max_transmission"),
            ("--max-transparent B", "max_transparent"),
        ):
            line = next(line for line in COMMAND.splitlines() if line.startswith(f"| `{option}`"))
            default = float(re.search(r"\(([\d.]+)\)", line.split("|")[2])[1])
            self.assertAlmostEqual(self.default(name), default, 6, option)
        self.assertEqual(self.default("samples"), 64)

    def test_every_setting_is_described_and_shown(self):
        source = (ADDON / "panels.py").read_text()
        for prop in properties.WARDMIS_PG_scene.bl_rna.properties:
            if prop.identifier in {"rna_type", "name"}:
                continue
            self.assertTrue(prop.description, prop.identifier)
            # what stops a render is shown by the name of the choice
            self.assertIn(
                "stop_by" if prop.identifier in {"samples", "seconds", "target_error"} else f'"{prop.identifier}"',
                source,
            )


class Tooltips(unittest.TestCase):
    """What a user reads to decide."""

    # of operators: what Blender's file browser sets, and what a button sets for itself
    INTERNAL = {
        "rna_type",
        "name",
        "directory",
        "filepath",
        "filter_folder",
        "filter_glob",
        "check_existing",
        "material",
    }

    def texts(self):
        for variant, _label, text in nodes.VARIANTS:  # the node's own type could not be registered again
            yield f"variant {variant}", text
        types_ = bpy.types
        bases = types_.Operator, types_.PropertyGroup, types_.AddonPreferences
        ours = [c for base in bases for c in base.__subclasses__() if c.__module__.startswith("wardmis")]
        for cls in ours:
            if issubclass(cls, types_.Operator):
                described = getattr(cls, "bl_description", "") or getattr(cls, "description", None)
                yield cls.__name__, described if isinstance(described, str) else "one for each button"
            own = getattr(cls, "__annotations__", {})
            for prop in cls.bl_rna.properties:
                if prop.identifier in self.INTERNAL or prop.identifier not in own:
                    continue
                yield f"{cls.__name__}.{prop.identifier}", prop.description
                for item in getattr(prop, "enum_items", ()):
                    yield f"{cls.__name__}.{prop.identifier} {item.identifier}", item.description

    def test_there_is_one_for_everything_and_it_says_more_than_the_name(self):
        found = dict(self.texts())
        self.assertGreater(len(found), 80)
        short = {name: text for name, text in found.items() if len(text.split()) < 3}
        self.assertEqual(short, {})

    def test_the_paper_is_named_where_it_is_meant(self):
        for name, text in self.texts():
            if re.search(r"\b(paper|Definition|Equation|Def\.|Eq\.)", text):
                self.assertIn("Lopez Garces and Kong", text, name)


class Preferences(unittest.TestCase):
    def test_button_tests_the_renderer(self):
        with mock.patch.dict(os.environ, {"WARDMIS_BINARY": str(FAKE)}):
            self.assertEqual(bpy.ops.wardmis.test_renderer(), {"FINISHED"})
        other = mock.patch.dict(os.environ, {"WARDMIS_BINARY": "/bin/true"})
        with other, self.assertRaisesRegex(RuntimeError, "is not the WardMIS renderer"):
            bpy.ops.wardmis.test_renderer()

    def test_path_in_the_preferences_goes_first(self):
        preferences = bpy.context.preferences.addons["wardmis"].preferences
        preferences.renderer = "/nowhere/wardmis"
        self.addCleanup(setattr, preferences, "renderer", "")
        with self.assertRaisesRegex(
            RuntimeError, "no renderer at /nowhere/wardmis, which the add-on's preferences name"
        ):
            bpy.ops.wardmis.test_renderer()


class Panels(unittest.TestCase):
    def test_what_the_engine_reads_can_be_edited(self):
        shown = {
            p.__name__ for p in bpy.types.Panel.__subclasses__() if panels.ENGINE in getattr(p, "COMPAT_ENGINES", ())
        }
        for name in (
            "DATA_PT_lens",
            "DATA_PT_camera_dof",
            "EEVEE_MATERIAL_PT_surface",
            "EEVEE_MATERIAL_PT_context_material",
            "EEVEE_WORLD_PT_surface",
            "WORLD_PT_context_world",
            "WARDMIS_LIGHT_PT_light",
            "RENDER_PT_output",
            "RENDER_PT_format",
            "VIEWLAYER_PT_layer",
        ):
            self.assertIn(name, shown)
        self.assertFalse({"MATERIAL_PT_preview", "DATA_PT_preview", "RENDER_PT_freestyle"} & shown)
        # without effect here; panels within them go with them
        for name in ("OBJECT_PT_shading", "OBJECT_PT_visibility", "RENDER_PT_simplify", "DATA_PT_volume_render"):
            self.assertNotIn(name, shown)
        self.assertFalse([name for name in shown if "light_linking" in name or "shadow_linking" in name])

    def test_order_is_that_of_cycles(self):
        import cycles.ui

        for context, module in (("render", panels), ("view_layer", panels), ("data", data_panels)):
            theirs = [p.bl_label for p in cycles.ui.classes if getattr(p, "bl_context", "") == context]
            own = [p for p in module._CLASSES if p.bl_context == context and not hasattr(p, "bl_parent_id")]
            ours = [p.bl_label for p in own]
            common = [label for label in ours if label in theirs]
            self.assertGreater(len(common), 1, context)
            self.assertEqual(common, sorted(common, key=theirs.index), context)

    def test_lights_have_cycles_names(self):
        import cycles.ui

        ours = [p for p in data_panels._CLASSES if p.__name__.startswith("WARDMIS_LIGHT")]
        theirs = [p for p in cycles.ui.classes if p.__name__ in {"CYCLES_LIGHT_PT_light", "CYCLES_LIGHT_PT_settings"}]
        theirs.append(bpy.types.CYCLES_LIGHT_PT_beam_shape)
        for kind, shape in (("POINT", None), ("SPOT", None), ("SUN", None), ("AREA", "SQUARE"), ("AREA", "RECTANGLE")):
            light = bpy.data.lights.new("Light", kind)
            self.addCleanup(bpy.data.lights.remove, light)
            if shape:
                light.shape = shape
            here = {"scene": bpy.context.scene, "preferences": bpy.context.preferences}
            context = types.SimpleNamespace(light=light, engine="WARDMIS", **here)
            names = dict(label for panel in ours if panel.poll(context) for label in drawn(panel, context))
            context.engine = "CYCLES"
            expected = dict(label for panel in theirs if panel.poll(context) for label in drawn(panel, context))
            names.pop("use_nodes", None)  # a button without a label of its own in Cycles
            self.assertEqual(names, {name: expected[name] for name in names}, kind)
            self.assertIn({"POINT": "Radius", "SPOT": "Radius", "SUN": "Angle", "AREA": "Spread"}[kind], names.values())
            self.assertIn("Cast Shadow", names.values())

    def test_every_panel_of_a_scene_can_be_drawn(self):
        obj = bpy.data.objects.new("Object", bpy.data.meshes.new("Mesh"))
        self.addCleanup(bpy.data.objects.remove, obj)
        scene = bpy.context.scene
        context = types.SimpleNamespace(
            object=obj, scene=scene, view_layer=scene.view_layers[0], engine="WARDMIS", light=None
        )
        for panel in (*panels._CLASSES, *data_panels._CLASSES):
            if panel.poll(context):
                self.assertTrue(drawn(panel, context), panel)


class Recorder:
    """A layout that keeps what is drawn: (property, label)."""

    def __init__(self) -> None:
        self.drawn: list[tuple[str, str]] = []

    def prop(self, owner, name, text=None, **_):
        prop = owner.bl_rna.properties[name]
        if text != "":
            self.drawn.append((name, prop.name if text is None else text))

    def part(self, *_, **__):
        return self

    column = row = grid_flow = split = separator = label = template_node_view = prop_decorator = part
    template_curve_mapping = part


def drawn(panel, context):
    layout = Recorder()
    panel.draw(types.SimpleNamespace(layout=layout, bl_space_type="PROPERTIES", _column=layout.part), context)
    return layout.drawn
