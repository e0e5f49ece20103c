# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's images -> files as they are, or pixels; and what is said about those that cannot be shown."""

import os
import struct
import tempfile
import unittest
from types import SimpleNamespace

import bpy
import numpy as np
from wardmis.export.context import ExportContext, ExportError
from wardmis.export.elsewhere import assign
from wardmis.export.file_alpha import file_alpha
from wardmis.export.glb import write_glb
from wardmis.export.image import Picture, WithinMemory, export_image, frame_of, path_of_frame, picture_of
from wardmis.export.model import CameraData, FileOnDisk, FilmData, SceneData
from wardmis.export.world import export_worlds

LINEAR = "Linear" if bpy.app.version < (4, 0, 0) else "Linear Rec.709"


class Images(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = os.path.join(self.folder.name, "image")

    def generated(self, is_float, color_space="sRGB"):
        """2 x 1 texels."""
        image = bpy.data.images.new("I", 2, 1, alpha=True, float_buffer=is_float)
        image.colorspace_settings.name = color_space
        image.pixels.foreach_set(np.array([0.2, 0.4, 0.6, 1.0, 0.0, 1.0, 0.8, 0.5], np.float32))
        self.addCleanup(lambda: bpy.data.images.remove(image))
        return image

    def file(self, file_format, is_float=False):
        """An image read from a file of this format, and the file's bytes."""
        image = self.generated(is_float, LINEAR if is_float else "sRGB")
        path = self.path
        image.filepath_raw, image.file_format = path, file_format
        image.save()
        loaded = bpy.data.images.load(path)
        loaded.colorspace_settings.name = LINEAR if is_float else "sRGB"  # 5.2 keeps an EXR's own
        self.addCleanup(lambda: bpy.data.images.remove(loaded))
        with open(path, "rb") as file:
            return loaded, file.read()

    def test_files_that_the_renderer_reads_are_handed_on_byte_for_byte(self):
        cases = (
            ("PNG", False, "image/png"),
            ("JPEG", False, "image/jpeg"),
            ("OPEN_EXR", True, "image/x-exr"),
        )
        for file_format, is_float, mime_type in cases:
            with self.subTest(file_format):
                image, content = self.file(file_format, is_float)
                data = export_image(Picture(image))
                self.assertEqual((data.mime_type, data.encoded), (mime_type, FileOnDisk(self.path, len(content))))
                self.assertIsNone(data.pixels)
                self.assertEqual(data.color_space, "linear" if is_float else "sRGB")
                self.assertIsNone(Picture(image).missing())

    def test_other_files_become_pixels(self):
        image, _ = self.file("TIFF")
        data = export_image(Picture(image))
        self.assertIsNone(data.encoded)
        self.assertEqual((data.pixels.dtype, data.pixels.shape[:2], data.color_space), (np.uint8, (1, 2), "sRGB"))
        self.assertEqual(data.pixels[0, 0, :3].tolist(), [51, 102, 153])

        path = os.path.join(self.folder.name, "sky.hdr")
        with open(path, "wb") as file:  # 2 x 1: (1, 2, 3) and (1/4, 1/2, 3/4)
            file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x40\x80\xc0\x82\x40\x80\xc0\x80")
        image = bpy.data.images.load(path)
        self.addCleanup(lambda: bpy.data.images.remove(image))
        data = export_image(Picture(image))
        self.assertIsNone(data.encoded)
        self.assertEqual((data.pixels.dtype, data.color_space), (np.float32, "linear"))
        np.testing.assert_allclose(data.pixels[0, :, :3], [(1, 2, 3), (0.25, 0.5, 0.75)], rtol=0.01)

    def test_generated_images_become_pixels(self):
        data = export_image(Picture(self.generated(is_float=False)))
        self.assertEqual(data.pixels.tolist(), [[[51, 102, 153, 255], [0, 255, 204, 128]]])
        data = export_image(Picture(self.generated(is_float=True, color_space=LINEAR)))
        self.assertEqual(data.color_space, "linear")
        np.testing.assert_allclose(data.pixels[0, 0], (0.2, 0.4, 0.6, 1.0), rtol=1e-6)

    def test_packed_file_survives_the_loss_of_the_original(self):
        image, content = self.file("PNG")
        image.pack()
        os.remove(os.path.join(self.folder.name, "image"))
        self.assertIsNone(Picture(image).missing())
        self.assertEqual(export_image(Picture(image)).encoded, content)

    def test_painted_image_is_not_its_file_any_more(self):
        image, content = self.file("PNG")
        image.pixels[0] = 1.0
        data = export_image(Picture(image))
        self.assertIsNone(data.encoded)
        self.assertEqual(data.pixels[0, 0, 0], 255)
        with open(os.path.join(self.folder.name, "image"), "rb") as file:
            self.assertEqual(file.read(), content)
        self.assertTrue(image.is_dirty)

    def test_missing_file_is_named_and_magenta(self):
        image, _ = self.file("PNG")
        path = os.path.join(self.folder.name, "image")
        os.remove(path)
        self.assertIn(path, Picture(image).missing())
        np.testing.assert_array_equal(export_image(Picture(image)).pixels, [[[1, 0, 1]]])

    def test_folder_is_named_as_one(self):
        image = self.generated(is_float=False)
        image.source, image.filepath = "FILE", self.folder.name
        self.assertIn(f"its file '{self.folder.name}' is a folder", Picture(image).missing())

    def test_damaged_file_is_named_and_magenta(self):
        for file_format in ("PNG", "JPEG", "OPEN_EXR"):
            with self.subTest(file_format):
                _, content = self.file(file_format, file_format == "OPEN_EXR")
                path = os.path.join(self.folder.name, "damaged")
                with open(path, "wb") as file:
                    file.write(content[:20])
                image = bpy.data.images.load(path)
                self.assertIn(f"cannot be read from '{path}'", Picture(image).missing())
                np.testing.assert_array_equal(export_image(Picture(image)).pixels, [[[1, 0, 1]]])
                bpy.data.images.remove(image)

    def test_non_color_is_linear_and_others_are_noted(self):
        image, _ = self.file("PNG")
        image.colorspace_settings.name = "Non-Color"
        self.assertEqual(export_image(Picture(image)).color_space, "linear")
        self.assertEqual(Picture(image).deviations(), [])
        image.colorspace_settings.name = "Filmic sRGB" if bpy.app.version < (4, 0, 0) else "AgX Base sRGB"
        self.assertIn("is not supported", Picture(image).deviations()[0])
        self.assertEqual(export_image(Picture(image)).color_space, "sRGB")

    def test_movie_that_cannot_be_read_is_named_and_magenta(self):
        path = os.path.join(self.folder.name, "film.avi")
        image = self.generated(is_float=False)
        image.source, image.filepath = "MOVIE", path
        user = SimpleNamespace(frame_start=1, frame_offset=0, frame_duration=1, use_cyclic=False)
        picture = picture_of(image, False, user, 1)
        self.assertIn(f"its file '{path}' is missing", picture.missing())
        with open(path, "wb") as file:
            file.write(bytes(1000))
        self.assertIn(f"cannot be read from '{path}'", picture.missing())
        np.testing.assert_array_equal(export_image(picture).pixels, [[[1, 0, 1]]])

    def test_assigns_when_blender_has_drawn_its_interface(self):
        class Refusing:
            refusals = 3

            def __setattr__(self, name, value):
                if self.refusals > 0:
                    Refusing.refusals -= 1
                    raise AttributeError("Writing to ID classes in this context is not allowed")
                object.__setattr__(self, name, value)

        owner = Refusing()
        assign(owner, frame=7, source="MOVIE")
        self.assertEqual((owner.frame, owner.source), (7, "MOVIE"))

    def test_pixels_of_other_files_are_read_in_data_of_their_own(self):
        """Where the renderer cannot, and Blender holds those of another one."""
        first, _ = self.file("TIFF")
        second = np.array([[[9, 8, 7, 255], [6, 5, 4, 255]]], np.uint8)
        made = self.generated(is_float=False)
        made.pixels.foreach_set(second.ravel() / np.float32(255))
        for name in ("t.1002.tif", "s.0007.tif"):
            made.filepath_raw, made.file_format = os.path.join(self.folder.name, name), "TIFF"
            made.save()
        there = len(bpy.data.images), len(bpy.data.textures)
        first.filepath, first.source = os.path.join(self.folder.name, "s.0001.tif"), "SEQUENCE"
        picture = Picture(first, frame=7)
        self.assertEqual((picture.missing(), picture.deviations()), (None, []))
        np.testing.assert_array_equal(export_image(picture).pixels, second)
        first.source, first.filepath = "TILED", os.path.join(self.folder.name, "t.<UDIM>.tif")
        first.tiles.new(1002)
        picture = Picture(first, tile=1002)
        self.assertEqual((picture.missing(), picture.deviations()), (None, []))
        np.testing.assert_array_equal(export_image(picture).pixels, second)
        self.assertEqual((len(bpy.data.images), len(bpy.data.textures)), there)

    def test_tiles_beyond_the_first_are_files(self):
        """Of which Blender tells no pixels."""
        tiled = bpy.data.images.new("Tiled", 2, 2, tiled=True)
        self.addCleanup(lambda: bpy.data.images.remove(tiled))
        tiled.tiles.new(1012)
        self.assertEqual(export_image(Picture(tiled, tile=1001)).pixels.shape[:2], (2, 2))
        self.assertIn("tile 1012", Picture(tiled, tile=1012).missing())
        self.assertIn("save", Picture(tiled, tile=1012).missing())
        tiled.filepath = "//a.<UDIM>.png"
        self.assertTrue(Picture(tiled, tile=1012).path.endswith("a.1012.png"))
        tiled.filepath = "//a.<UVTILE>.png"
        self.assertTrue(Picture(tiled, tile=1012).path.endswith("a.u2_v2.png"))

    def test_render_result_cannot_be_a_texture(self):
        viewer = SimpleNamespace(
            name="Render Result", type="RENDER_RESULT", source="VIEWER"
        )  # Blender makes them by rendering alone
        self.assertIn("result", Picture(viewer).missing())

    def test_picture_of_a_sequence_as_blender_counts(self):
        for (start, offset, length, cyclic), expected in (
            ((1, 0, 5, False), 3),
            ((1, 2, 3, False), 5),
            ((1, 0, 2, False), 2),  # the last one stays
            ((2, 0, 3, True), 2),
            ((-7, 0, 3, True), 2),
            ((3, 0, 3, True), 1),
            ((4, 0, 3, True), 3),
            ((5, 0, 9, False), 0),  # the first one has not come yet
        ):
            user = SimpleNamespace(frame_start=start, frame_offset=offset, frame_duration=length, use_cyclic=cyclic)
            self.assertEqual(frame_of(user, 3), expected, (start, offset, length, cyclic))
        self.assertEqual(path_of_frame("/a/b1/shot_007_v.png", 12), "/a/b1/shot_012_v.png")
        self.assertEqual(path_of_frame("/a/b1/shot.png", 12), "/a/b1/shot.png")

    def test_sequence_is_the_file_of_its_frame(self):
        image, content = self.file("PNG")
        path = os.path.join(self.folder.name, "frame_03.png")
        os.rename(os.path.join(self.folder.name, "image"), path)
        image.filepath = path.replace("frame_03", "frame_01")
        image.source = "SEQUENCE"
        self.assertEqual(export_image(Picture(image, frame=3)).encoded, FileOnDisk(path, len(content)))
        self.assertIn("frame_04.png' is missing", Picture(image, frame=4).missing())

    def test_files_are_written_as_they_are_then(self):
        image, content = self.file("PNG")
        film = FilmData((1, 1), (0, 0, 1, 1))
        camera = CameraData("C", np.eye(4), "perspective", (-1, 1, -1, 1), (0.1, 100))
        scene = SceneData("test", film, camera, images=[export_image(Picture(image))])
        path = os.path.join(self.folder.name, "scene.glb")
        write_glb(scene, path)
        with open(path, "rb") as file:
            self.assertIn(content, file.read())
        with open(self.path, "ab") as file:
            file.write(b"more")
        with self.assertRaisesRegex(ExportError, "image' has changed"):
            write_glb(scene, path)
        os.remove(self.path)
        with self.assertRaisesRegex(ExportError, "image' cannot be read any more"):
            write_glb(scene, path)

    def test_what_blender_has_read_for_the_export_is_given_back(self):
        _, content = self.file("PNG")
        images = []
        for k in range(4):
            path = os.path.join(self.folder.name, f"image{k}")
            with open(path, "wb") as file:
                file.write(content)
            images.append(bpy.data.images.load(path))
            self.addCleanup(bpy.data.images.remove, images[-1])
        images[0].pixels[0]  # it is read before the export
        self.assertEqual([image.has_data for image in images], [True, False, False, False])
        export = WithinMemory(limit=16)  # two images of two texels
        for image in images:
            self.assertEqual(export(Picture(image)).mime_type, "image/png")
        self.assertEqual([image.has_data for image in images], [True, False, True, True])
        images[2].pixels[0] = 0.5  # what is painted must stay
        export(Picture(images[1]))
        self.assertEqual([image.has_data for image in images], [True, True, True, True])
        self.assertAlmostEqual(images[2].pixels[0], 0.5, places=2)

    def test_pixels_of_a_multiplied_file_come_back(self):
        """Which Blender has divided, and cut off where they are not multiplied."""
        for colors, least, note in ((0.3, 0, False), (0.9, 0, True), (0.9, 1, True), (0.9, 200, True)):
            image = bpy.data.images.new("I", 16, 16, alpha=True)
            values = np.zeros((256, 4), np.float32)
            alpha = np.maximum(np.arange(256), least)
            values[:, 3] = alpha / 255
            values[:, :3] = np.floor(colors * (alpha if not note else np.full(256, 255)))[:, None] / 255
            image.pixels.foreach_set(values.ravel())
            path = f"{self.path}-{least}-{note}.tga"
            image.filepath_raw, image.file_format = path, "TARGA"
            image.save()
            bpy.data.images.remove(image)
            image = bpy.data.images.load(path)
            self.addCleanup(bpy.data.images.remove, image)
            image.alpha_mode = "PREMUL"
            found = export_image(Picture(image)).pixels.reshape(256, 4)
            stored = np.rint(255 * values).astype(np.uint8)
            self.assertEqual(np.array_equal(found, stored), not note)
            self.assertEqual("Premultiplied" in str(Picture(image).deviations()), note)

    def test_alpha_of_files(self):
        def tiff(order, big, extra, samples):
            pack = lambda kinds, *values: struct.pack(order + kinds, *values)  # noqa: E731
            offset, entry = ("Q", "HHQHHI") if big else ("I", "HHIHH")
            start = pack("HHHQ", 43, 8, 0, 16) if big else pack("HI", 42, 8)
            entries = [(277, 3, 1, samples, 0), *([(338, 3, 1, extra, 0)] if extra is not None else [])]
            body = b"".join(pack(entry, *each, *([0] if big else [])) for each in entries)
            count = pack("Q" if big else "H", len(entries))
            return (b"II" if order == "<" else b"MM") + start + count + body + pack(offset, 0)

        footer = struct.pack("<II", 100, 0) + b"TRUEVISION-XFILE.\0"
        for content, expected in (
            *(
                (tiff(order, big, extra, samples), (extra == 2, samples == 2))
                for order in "<>"
                for big in (False, True)
                for extra in (None, 0, 1, 2)
                for samples in (2, 4)
            ),
            (bytes(1000) + footer, (True, False)),
            (bytes(100) + bytes(494) + bytes([4]) + footer, (False, False)),
            (b"\x76\x2f\x31\x01", (False, False)),
            (b"II", (True, False)),  # cut off
            (b"", (True, False)),
        ):
            with open(self.path, "wb") as file:
                file.write(content)
            found = file_alpha(self.path)
            self.assertEqual((found.is_straight, found.is_of_grey), expected, content[:64])

    def test_alpha_as_cycles_takes_it(self):
        image, _ = self.file("PNG")
        user = SimpleNamespace(frame_start=1, frame_offset=0, frame_duration=1, use_cyclic=False)
        for mode, color_space, alphas in (
            ("STRAIGHT", "sRGB", (("multiplied", False), ("multiplied", True))),
            ("CHANNEL_PACKED", "sRGB", (("kept", False), ("kept", False))),
            ("NONE", "sRGB", (("ignored", False), ("ignored", False))),
            ("NONE", "Non-Color", (("ignored", False), ("ignored", False))),
            ("STRAIGHT", "Non-Color", (("kept", False), ("kept", False))),
        ):
            image.alpha_mode, image.colorspace_settings.name = mode, color_space
            shown = [picture_of(image, shows_alpha, user, 1) for shows_alpha in (False, True)]
            found = tuple((picture.alpha, picture.divided) for picture in shown)
            self.assertEqual(found, alphas, (mode, color_space))
        image.alpha_mode, image.colorspace_settings.name = "STRAIGHT", "sRGB"
        multiplied = Picture(image, "multiplied")
        self.assertEqual(multiplied.export().alpha, "multiplies")


class World(unittest.TestCase):
    def test_missing_image_of_the_sky_is_named_and_magenta(self):
        world = bpy.data.worlds.new("W")
        self.addCleanup(lambda: bpy.data.worlds.remove(world))
        world.use_nodes = True
        node = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
        world.node_tree.links.new(node.outputs[0], world.node_tree.nodes["Background"].inputs["Color"])
        node.image = bpy.data.images.new("Sky", 1, 1)
        self.addCleanup(lambda: bpy.data.images.remove(bpy.data.images["Sky"]))
        node.image.source, node.image.filepath = "FILE", "/nowhere/sky.exr"
        context = ExportContext(export_image)
        self.assertEqual([sky.radiance for sky in export_worlds(world, context)], [(1, 0, 1)])
        self.assertIn("/nowhere/sky.exr", context.notes[0])
