# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders in background by a renderer that is told how to behave: what arrives, and that every failure is told."""

from __future__ import annotations

import json
import os
import shutil
import signal
import time
from pathlib import Path

import bpy
from support import HERE, RenderTest, blender, exr_attributes, read_exr
from wardmis.lock import alone
from wardmis.seed import animated

MULTILAYER = """
image = scene.render.image_settings
if hasattr(image, "media_type"):
    image.media_type = "MULTI_LAYER_IMAGE"
    image.use_exr_interleave = True
image.file_format = "OPEN_EXR_MULTILAYER"
image.color_depth = "32"
image.exr_codec = "NONE"
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 40, 20, 100
"""


def value(pass_number: int, x: int, y: int) -> float:
    """What the fake renderer paints at (x, y), counted from the bottom left of a frame of 40 x 20."""
    return pass_number + x / 40 + 10 * y / 20


EVERY_PASS = """
for layer in scene.view_layers:
    layer.use_pass_z = layer.use_pass_normal = True
    own = layer.wardmis
    own.use_pass_albedo = own.use_pass_variance = own.use_pass_allocation = True
"""
# what a window does: the image so far comes again and again
WITH_PREVIEW = """
import wardmis.engine
arguments = wardmis.engine._Render._arguments
wardmis.engine._Render._arguments = lambda self: [*arguments(self), "--preview", str(self.preview_path)]
"""
WRITE_PASSES = """
import hashlib
import json
import numpy
show = wardmis.engine._Render._show
def show_and_write(self, path):
    show(self, path)
    digests = {}
    for p in self.result.layers[0].passes:
        shape = (self.width * self.height, p.channels)
        pixels = numpy.zeros(shape if bpy.app.version < (4, 0, 0) else shape[0] * shape[1], numpy.float32)
        p.rect.foreach_get(pixels)
        assert pixels.reshape(-1)[-1] != 0  # all of it was got
        digests[p.name] = hashlib.md5(pixels.tobytes()).hexdigest()
    with open(scene.render.filepath + "passes", "a") as file:
        print(json.dumps((self.layer.name, digests)), file=file)
wardmis.engine._Render._show = show_and_write
"""
# of Blender 3.4, and of later ones
COMPLAINTS = ("IMB_exr_set_channel", "Reading render result")


class Passes(RenderTest):
    def passes_of(self, image: dict) -> set[str]:
        return {name.rpartition(".")[0] for name in image}

    def test_all_passes_arrive_where_they_belong(self):
        run = self.run_blender(MULTILAYER + EVERY_PASS + WITH_PREVIEW)
        self.assertEqual(run.code, 0, run.output)
        for complaint in COMPLAINTS:
            self.assertNotIn(complaint, run.output)
        image = read_exr(run.images[0])
        first_channels = (
            "Combined.R",
            "Depth.Z",
            "Normal.X",
            "Albedo.R",
            "Variance.R",
            "Allocation Lobe.X",
            "Allocation Cosine.X",
            "Allocation Light.X",
        )
        self.assertEqual(
            self.passes_of(image), {f"ViewLayer.{channel.rpartition('.')[0]}" for channel in first_channels}
        )
        for k, channel in enumerate(first_channels):
            pixels = image[f"ViewLayer.{channel}"]
            self.assertEqual(pixels.shape, (20, 40))
            for x, y in ((0, 0), (39, 0), (7, 13)):
                self.assertAlmostEqual(float(pixels[19 - y, x]), value(k, x, y), 5, channel)
        statistics = json.loads(exr_attributes(run.images[0])[0]["wardmis.ViewLayer.statistics"])
        self.assertEqual(statistics["samples_per_pixel"], 64)

    def test_each_technique_of_the_scene_has_a_pass(self):
        """More than were registered, one of which the file lacks."""
        run = self.run_blender(MULTILAYER + EVERY_PASS + WITH_PREVIEW, fake="many-lobes")
        self.assertEqual(run.code, 0, run.output)
        for complaint in COMPLAINTS:
            self.assertNotIn(complaint, run.output)
        image = read_exr(run.images[0])
        names = ("Combined.R", "Depth.Z", "Normal.X", "Albedo.R", "Variance.R", "Allocation Cosine.X", "Allocation Light.X",
                 "Allocation Glass.X", "Allocation Glossy.X", "Allocation Lobe 3.X")  # fmt: skip
        for k, channel in enumerate(names):
            pixels = image[f"ViewLayer.{channel}"]
            for x, y in ((0, 0), (39, 0), (7, 13)):
                self.assertAlmostEqual(float(pixels[19 - y, x]), value(k, x, y), 5, channel)

    def test_only_what_was_asked_for_is_in_the_file(self):
        run = self.run_blender(MULTILAYER + WITH_PREVIEW)
        self.assertEqual(self.passes_of(read_exr(run.images[0])), {"ViewLayer.Combined"})
        for complaint in COMPLAINTS:
            self.assertNotIn(complaint, run.output)
        self.assertEqual(run.calls[0]["arguments"][run.calls[0]["arguments"].index("--passes") + 1], "combined")

    def test_each_layer_has_its_own(self):
        run = self.run_blender(
            MULTILAYER + "second = scene.view_layers.new('Second')\nsecond.wardmis.use_pass_variance = True\n"
            "scene.view_layers['ViewLayer'].use_pass_z = True\n"
        )
        self.assertEqual(
            self.passes_of(read_exr(run.images[0])),
            {"ViewLayer.Combined", "ViewLayer.Depth", "Second.Combined", "Second.Variance"},
        )

    def test_a_pass_that_there_is_not_is_named(self):
        run = self.run_blender(MULTILAYER + "bpy.context.view_layer.use_pass_mist = True\n")
        self.assertIn("view layer 'ViewLayer': there is no pass Mist; it is left out", run.output)
        self.assertEqual(self.passes_of(read_exr(run.images[0])), {"ViewLayer.Combined"})

    def test_compositor_has_a_socket_for_each_pass(self):
        from wardmis import passes

        scene = bpy.data.scenes.new("Compositor")
        scene.render.engine = "WARDMIS"
        if hasattr(scene, "node_tree"):
            scene.use_nodes = True
            tree = scene.node_tree
        else:
            tree = scene.compositing_node_group = bpy.data.node_groups.new("Compositor", "CompositorNodeTree")
        node = tree.nodes.new("CompositorNodeRLayers")
        node.scene = scene
        layer = scene.view_layers[0]

        def sockets() -> set[str]:
            return {socket.name for socket in node.outputs if socket.enabled}

        self.assertFalse({"Depth", "Normal", "Albedo", "Variance", "Allocation Light"} & sockets())
        layer.use_pass_z = layer.use_pass_normal = True
        own = layer.wardmis
        own.use_pass_albedo = own.use_pass_variance = own.use_pass_allocation = True
        # the socket of the pass Combined has been called Image since ever
        asked = {p.name for p in passes.passes_of(scene, layer) if p.group in passes.wanted(layer)}
        self.assertLessEqual(asked - {"Combined"}, sockets())
        self.assertIn("Allocation Lobe", asked)
        passes.tell(scene, layer, ["Combined", "Allocation Glass", "Allocation Glossy", "Allocation Light"])
        layer.update_render_passes()
        self.assertLessEqual({"Allocation Glass", "Allocation Glossy", "Allocation Light"}, sockets())
        self.assertNotIn("Allocation Cosine", sockets())
        bpy.data.scenes.remove(scene)

    def test_every_view_layer_is_rendered(self):
        run = self.run_blender(
            MULTILAYER + "scene.view_layers.new('Second')\nscene.view_layers.new('Off').use = False\n" + EVERY_PASS
        )
        self.assertEqual(run.code, 0, run.output)
        self.assertEqual(
            [word for call in run.calls for word in call["arguments"] if word.startswith("--layer")],
            ["--layer=ViewLayer", "--layer=Second"],
        )
        image = read_exr(run.images[0])
        for layer in ("ViewLayer", "Second"):
            self.assertAlmostEqual(float(image[f"{layer}.Variance.R"][19, 3]), value(4, 3, 0), 5, layer)

    def test_view_layers_of_any_name(self):
        """Blender cuts the names of an image's channels, which begin with the layer's, and takes none that it does not find."""
        names = [f"{length:02}{'x' * (length - 2)}" for length in (10, 42, 43, 53, 54, 63)]
        names += ["\u00fc" * 31, "a.b" * 18]
        run = self.run_blender(
            WITH_PREVIEW
            + f"scene.view_layers[0].name = {names[0]!r}\nfor name in {names[1:]!r}:\n    scene.view_layers.new(name)\n"
            + EVERY_PASS
            + WRITE_PASSES
        )
        self.assertEqual(run.code, 0, run.output)
        for complaint in COMPLAINTS:
            self.assertNotIn(complaint, run.output)
        printed = [json.loads(line) for line in next(self.folder.glob("image*passes")).read_text().splitlines()]
        self.assertEqual({name for name, _ in printed}, set(names))
        first = printed[0][1]
        self.assertEqual(len(set(first.values())), len(first))
        self.assertEqual({name: passes for name, passes in printed if passes != first}, {})

    def test_render_border(self):
        border = """
scene.render.use_border = True
scene.render.border_min_x, scene.render.border_max_x = 0.3, 0.7
scene.render.border_min_y, scene.render.border_max_y = 0.1, 0.6
"""
        whole = read_exr(self.run_blender(MULTILAYER + border).images[0])["ViewLayer.Combined.R"]
        self.assertEqual(whole.shape, (20, 40))
        self.assertAlmostEqual(float(whole[19 - 2, 12]), value(0, 12, 2), 5)
        self.assertAlmostEqual(float(whole[19 - 11, 27]), value(0, 27, 11), 5)
        self.assertEqual(float(whole[19 - 1, 12]), 0)
        self.assertEqual(float(whole[19 - 2, 28]), 0)
        cropped = self.run_blender(MULTILAYER + border + "scene.render.use_crop_to_border = True\n")
        pixels = read_exr(cropped.images[0])["ViewLayer.Combined.R"]
        self.assertEqual(pixels.shape, (10, 16))
        self.assertAlmostEqual(float(pixels[9, 0]), value(0, 12, 2), 5)


class Arguments(RenderTest):
    def test_settings_reach_the_command(self):
        run = self.run_blender(
            "s = scene.wardmis\n"
            "s.allocation, s.weights, s.integrand, s.integrator = 'variance', 'power', 'joint', 'direct'\n"
            "s.samples, s.samples_per_hit, s.pilot_samples, s.min_fraction = 7, 5, 2, 0.05\n"
            "s.max_depth, s.sampler, s.seed, s.pixels = 3, 'independent', 11, 'by-error'\n"
        )
        arguments = run.calls[0]["arguments"]
        expected = (
            "--allocation variance --weights power --integrand joint --integrator direct --spp 7 --samples-per-hit 5 "
        )
        expected += "--pilot-spp 2 --min-fraction 0.05 --max-depth 3 --sampler independent --seed 11 --pixels by-error"
        words = expected.split()
        for option, setting in zip(words[::2], words[1::2]):
            self.assertEqual(arguments[arguments.index(option) + 1], setting, option)
        self.assertNotIn("--time", arguments)

    def test_numbers_of_light_paths_go_with_their_integrator(self):
        numbers = (
            "s = scene.wardmis\ns.light_paths, s.connections, s.later_connections, s.light_tracing = 2.5, 3, 0, False\n"
        )
        run = self.run_blender(numbers + "s.integrator = 'bidirectional'\n")
        words = run.calls[0]["arguments"]
        expected = (
            "--light-paths",
            "2.5",
            "--connections",
            "3",
            "--later-connections",
            "0",
            "--light-tracing",
            "false",
        )
        for option, setting in zip(expected[::2], expected[1::2]):
            self.assertEqual(words[words.index(option) + 1], setting, option)
        self.assertNotIn("--light-paths", self.run_blender(numbers).calls[-1]["arguments"])

    def test_the_default_allocation_yields_to_other_weights(self):
        """By not being named: the command refuses it."""
        for weights, allocation in (("balance", ["--allocation", "auto"]), ("nonbalance", []), ("power", [])):
            run = self.run_blender(f"scene.wardmis.weights = {weights!r}")
            words = run.calls[-1]["arguments"]
            self.assertEqual(words[words.index("--weights") + 1], weights)
            self.assertEqual(
                words[words.index("--allocation") :][:2] if "--allocation" in words else [], allocation, weights
            )
            self.assertEqual("--pilot-spp" in words, weights == "balance")

    def test_stop_by_seconds_and_blenders_threads(self):
        run = self.run_blender(
            "s = scene.wardmis\ns.stop_by, s.seconds = 'seconds', 2.5\nscene.render.threads_mode = 'FIXED'\nscene.render.threads = 3\n"
        )
        arguments = run.calls[0]["arguments"]
        self.assertEqual(arguments[arguments.index("--time") + 1], "2.5")
        self.assertEqual(arguments[arguments.index("--threads") + 1], "3")
        self.assertNotIn("--spp", arguments)

    def test_stop_by_error(self):
        run = self.run_blender(
            "s = scene.wardmis\ns.stop_by, s.target_error, s.max_samples = 'target_error', 0.02, 512\n"
        )
        arguments = run.calls[0]["arguments"]
        self.assertEqual(arguments[arguments.index("--target-error") + 1], "0.02")
        self.assertEqual(arguments[arguments.index("--spp") + 1], "512")

    def test_bounces_reach_the_command(self):
        limits = "s.max_depth, s.max_diffuse, s.max_glossy = 6, 2, 5\n"
        more = "s.max_transmission, s.max_transparent = 1, 3\n"
        cycles = (
            "c = scene.cycles\nc.max_bounces, c.diffuse_bounces, c.glossy_bounces = 7, 3, 0\ns.bounces = 'cycles'\n"
            "c.transmission_bounces, c.transparent_max_bounces = 2, 5\n"
        )
        for changes, options in (
            ("", "--max-depth 8"),
            (limits, "--max-depth 6 --max-diffuse 2"),  # 5 is all of them
            (limits + more, "--max-depth 6 --max-diffuse 2 --max-transmission 1 --max-transparent 3"),
            (
                limits + cycles,
                "--max-depth 8 --max-diffuse 3 --max-glossy 0 --max-transmission 2 --max-transparent 5",
            ),
            ("s.bounces = 'cycles'\n", "--max-depth 13 --max-diffuse 4 --max-glossy 4"),
        ):
            run = self.run_blender("s = scene.wardmis\n" + changes)
            words = [w for w in " ".join(run.calls[-1]["arguments"]).split(" --") if w.startswith("max-")]
            self.assertEqual("--" + " --".join(words), options)


class Animation(RenderTest):
    def test_animation_leaves_nothing_behind(self):
        run = self.run_blender("scene.frame_end = 3\n", "--render-anim")
        self.assertEqual(run.code, 0, run.output)
        self.assertEqual([p.name for p in run.images], ["image_0001.png", "image_0002.png", "image_0003.png"])
        self.assertEqual(len(run.calls), 3)
        self.assertEqual(run.left_over, [])

    def test_seeds_stand_still_unless_they_are_animated(self):
        frames = "scene.frame_start, scene.frame_end = 3, 5\nscene.wardmis.seed = 9\n"
        for changes, seeds in (
            ("", ["9", "9", "9"]),
            ("scene.wardmis.use_animated_seed = True\n", [str(animated(9, frame)) for frame in (3, 4, 5)]),
        ):
            run = self.run_blender(frames + changes, "--render-anim")
            arguments = [call["arguments"] for call in run.calls[-3:]]
            self.assertEqual([a[a.index("--seed") + 1] for a in arguments], seeds, run.output)

    def test_animation_ends_with_its_first_failure(self):
        run = self.run_blender("scene.frame_end = 3\n", "--render-anim", fake="exit3")
        self.assertEqual((run.code, len(run.calls), run.images), (1, 1, []), run.output)


class Failures(RenderTest):
    """Exit code 1, the message, no image, no file and no process left, whatever the format of the output."""

    def check(self, message: str, script: str = "", *arguments: str, **options: str) -> None:
        run = self.run_blender(script, *arguments, **options)
        self.assertIn(message, run.output)
        self.assertEqual(run.code, 1, run.output)
        self.assertEqual(run.images, [])
        self.assertEqual(run.left_over, [])
        for call in run.calls:
            self.assertFalse(Path(f"/proc/{call['pid']}").exists(), "the renderer is still there")

    def test_crash(self):
        self.check("WardMIS: the renderer crashed (SIGSEGV)", fake="crash")

    def test_crash_with_exr_output(self):
        self.check(
            "WardMIS: the renderer crashed (SIGSEGV)",
            "scene.render.image_settings.file_format = 'OPEN_EXR'\n",
            fake="crash",
        )

    def test_message_of_the_renderer(self):
        self.check("exit code 3): bufferViews[0]: lies beyond the file", fake="exit3")

    def test_failure_without_a_message(self):
        self.check("exit code 4) without a message", fake="silent")

    def test_garbage_instead_of_events(self):
        self.check(
            "ended without an image; it never said that it started, so that it may be another program; it said: ",
            fake="garbage",
        )

    def test_another_program(self):
        self.check("the renderer /bin/true ended without an image; it never said", WARDMIS_BINARY="/bin/true")

    def test_no_image(self):
        self.check("ended without an image", MULTILAYER, fake="nothing")

    def test_image_of_the_wrong_size(self):
        self.check("cannot read the image of the renderer as one of 40 x 20 pixels", MULTILAYER, fake="wrong-size")

    def test_event_that_is_not_understood(self):
        self.check("sent what this add-on does not understand (KeyError('fraction')", fake="odd-event")

    def test_full_disk(self):
        full = "import shutil, types\nshutil.disk_usage = lambda path: types.SimpleNamespace(free={})\n"
        self.check(f"the disk of {self.folder} has 1 KiB free, and the image wants 15", full.format(1024))
        # room enough for an image of this size, but not for the file that has been rendered
        self.check(f"the disk of {self.folder} has 3 KiB free", MULTILAYER + full.format(3_000))

    def test_renderer_not_found(self):
        self.check("which the environment variable WARDMIS_BINARY names", WARDMIS_BINARY=str(self.folder / "none"))

    def test_renderer_nowhere(self):
        # Blender needs no PATH of its own here
        self.check("none is on the PATH", WARDMIS_BINARY="", PATH="/nowhere")

    def test_renderer_that_is_no_program(self):
        bad = self.folder / "bad"
        bad.write_bytes(b"\x7fELF nothing")
        bad.chmod(0o755)
        self.check("cannot be run: Exec format error", WARDMIS_BINARY=str(bad))

    def test_renderer_that_may_not_be_run(self):
        bad = self.folder / "bad"
        bad.write_text("#!/bin/sh\n")
        bad.chmod(0o644)
        self.check("cannot be run: Permission denied", WARDMIS_BINARY=str(bad))

    def test_no_camera(self):
        self.check("no camera", "bpy.data.objects.remove(scene.camera)\n")

    def test_camera_that_sees_nothing(self):
        self.check("camera 'Camera' sees nothing", "scene.camera.data.clip_start = 1e6\n")

    def test_stereoscopy(self):
        self.check("stereoscopy is not supported", "scene.render.use_multiview = True\n")

    def test_mesh_that_is_not_finite(self):
        self.check(
            "object 'Cube': vertex 3 of mesh 'Cube' is at (nan,",
            "bpy.data.meshes['Cube'].vertices[3].co.x = float('nan')\n",
        )

    def test_mistake_of_the_addon(self):
        self.check(
            "an error in the add-on, please report it with the console's text: ZeroDivisionError",
            "import wardmis.engine\nwardmis.engine.renderer_path = lambda: 1 / 0\nscene.render.image_settings.file_format = 'OPEN_EXR'\n",
        )

    def test_output_that_cannot_be_written(self):
        (self.folder / "taken").write_text("")
        self.check("taken", "", "--render-output", str(self.folder / "taken" / "image"), "--render-frame", "1")


class Stopping(RenderTest):
    def start(self, fake: str):
        process = blender(self.folder, "", "--render-frame", "1", fake=fake)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        log = self.folder / "calls.log"
        deadline = time.monotonic() + 60
        while not log.exists() or not log.read_text().endswith("\n"):
            self.assertLess(time.monotonic(), deadline, "the renderer never started")
            time.sleep(0.05)
        return process, json.loads(log.read_text())["pid"]

    def wait_for_end(self, pid: int, seconds: float) -> None:
        def runs() -> bool:
            """An orphan that has ended keeps its number as a zombie where process 1 does not ask for it."""
            try:
                return (Path("/proc") / str(pid) / "stat").read_text().rpartition(")")[2].split()[0] != "Z"
            except (FileNotFoundError, ProcessLookupError):
                return False

        deadline = time.monotonic() + seconds
        while runs():
            self.assertLess(time.monotonic(), deadline, "the renderer is still there")
            time.sleep(0.02)

    def test_interrupt_stops_a_renderer_that_hangs(self):
        process, renderer = self.start("hang")
        process.send_signal(signal.SIGINT)
        self.wait_for_end(renderer, 5)
        output, _ = process.communicate(timeout=10)
        self.assertIn("WardMIS: stopped before the image was complete", output)
        self.assertEqual(process.returncode, 1)
        self.assertEqual(list(self.folder.glob("image*")), [])
        self.assertEqual(list((self.folder / "tmp").rglob("wardmis-*")), [])

    def test_renderer_ends_when_blender_is_killed(self):
        for kill in (signal.SIGKILL, signal.SIGTERM):
            with self.subTest(kill):
                (self.folder / "calls.log").unlink(missing_ok=True)
                process, renderer = self.start("slow")
                folder = next((self.folder / "tmp").rglob("wardmis-work-*"))
                deadline = time.monotonic() + 10
                while (folder / "scene.glb").exists():  # until it has been read
                    self.assertLess(time.monotonic(), deadline, "the scene is still there")
                    time.sleep(0.02)
                process.send_signal(kill)
                self.wait_for_end(renderer, 10)
                process.communicate()
                shutil.rmtree(folder)

    def test_what_a_killed_blender_leaves_goes_with_the_next_render(self):
        left, young, used = (self.folder / "tmp" / "blender_x" / f"wardmis-work-{name}" for name in ("a", "b", "c"))
        for path in (left, young, used):
            path.mkdir(parents=True)
            (path / "scene.glb").write_bytes(b"glTF")
            if path != young:
                os.utime(path, (0, 0))
        with alone(used):
            run = self.run_blender()
        self.assertEqual(run.code, 0, run.output)
        self.assertEqual([path.exists() for path in (left, young, used)], [False, True, True])


class Finding(RenderTest):
    def test_order_of_the_places(self):
        import shutil
        from unittest import mock

        from wardmis import process

        one, two, three = (self.folder / name for name in ("one", "two", "wardmis"))
        for path in (one, two, three):
            shutil.copy(HERE / "fake_renderer.py", path)
        with mock.patch.dict(os.environ, {"WARDMIS_BINARY": str(two), "PATH": str(self.folder)}):
            self.assertEqual(process.find_renderer(str(one)), one)
            self.assertEqual(process.find_renderer(""), two)
            with mock.patch.object(process, "PACKAGED", three):
                three.chmod(0o644)  # as Blender unpacks it
                self.assertEqual(process.find_renderer(""), three)
                self.assertTrue(os.access(three, os.X_OK))
            del os.environ["WARDMIS_BINARY"]
            self.assertEqual(process.find_renderer(""), three)

    def test_version_of_a_renderer(self):
        from wardmis import process

        self.assertEqual(process.version(HERE / "fake_renderer.py"), "wardmis 0.0.0 (fake)")
        with self.assertRaisesRegex(process.RendererError, "is not the WardMIS renderer"):
            process.version(Path("/bin/true"))
