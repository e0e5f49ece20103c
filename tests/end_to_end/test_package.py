# SPDX-License-Identifier: GPL-3.0-or-later
"""The packaged add-on works by itself: its renderer with its own libraries, and Blender after installing the zip."""

import os
import re
import subprocess
import tempfile
import unittest
import zipfile
from pathlib import Path

import exr
import package
import tomllib
from blender import ROOT

# Installs the zip as a user would, renders the default scene small, and says where the renderer was found.
INSTALL_AND_RENDER = """
import bpy, sys
zip, out = sys.argv[-2:]
bpy.ops.preferences.addon_install(filepath=zip)
bpy.ops.preferences.addon_enable(module="wardmis")
from wardmis.preferences import renderer_path
print("RENDERER", renderer_path())
scene = bpy.context.scene
scene.render.engine = "WARDMIS"
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 64, 48, 100
scene.wardmis.samples = 8
scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
scene.render.filepath = out
bpy.ops.render.render(write_still=True)
"""


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name)
        cls.zip = package.package(Path(os.environ["WARDMIS_BINARY"]), cls.folder)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def test_what_lies_in_it(self):
        with zipfile.ZipFile(self.zip) as archive:
            names = set(archive.namelist())
        self.assertEqual({name.split("/")[0] for name in names}, {"wardmis"})
        for name in ("__init__.py", "blender_manifest.toml", "LICENSE", "bin/wardmis"):
            self.assertIn(f"wardmis/{name}", names)
        for name in names:
            self.assertIsNone(re.search(r"__pycache__|\.pyc$|lib(c|m)\.so|ld-linux", name), name)

    def test_the_manifest_keeps_the_limits_of_blenders_extensions(self):
        manifest = tomllib.loads((ROOT / "addon" / "wardmis" / "blender_manifest.toml").read_text())
        for text in (manifest["tagline"], *manifest["permissions"].values()):
            self.assertRegex(text, r"^[^\n]{1,63}[^.\n]$")  # 64 characters at most, no full stop

    def test_the_renderer_finds_its_own_libraries(self):
        with tempfile.TemporaryDirectory() as folder:
            with zipfile.ZipFile(self.zip) as archive:
                archive.extractall(folder)
            renderer = Path(folder) / "wardmis" / "bin" / "wardmis"
            renderer.chmod(0o755)
            said = subprocess.run(["ldd", renderer], env={"PATH": os.environ["PATH"]}, capture_output=True, text=True)
            for line in said.stdout.splitlines():
                name, _, place = line.strip().partition(" => ")
                if place and not package.GLIBC.match(name):
                    self.assertIn(str(renderer.parent / "lib"), place, line)
            version = subprocess.run([renderer, "--version"], env={}, capture_output=True, text=True)
            self.assertEqual((version.returncode, version.stderr), (0, ""))
            self.assertIn(package.version(), version.stdout)

    def test_the_documentation_is_inside(self):
        with zipfile.ZipFile(self.zip) as archive:
            names = set(archive.namelist())
        for name in ("README.html", "docs/command.html", "docs/images/teapot.png"):
            self.assertIn(f"wardmis/documentation/{name}", names)

    def test_blender_renders_after_installing_it(self):
        with tempfile.TemporaryDirectory() as folder:
            user = {f"BLENDER_USER_{name}": folder for name in ("SCRIPTS", "CONFIG", "DATAFILES", "EXTENSIONS")}
            environment = {name: value for name, value in os.environ.items() if name != "WARDMIS_BINARY"} | user
            out = Path(folder) / "cube.exr"
            command = [os.environ["BLENDER"], "--background", "--factory-startup", "--python-exit-code", "1"]
            command += ["--python-expr", INSTALL_AND_RENDER, "--", str(self.zip), str(out)]
            done = subprocess.run(command, env=environment, capture_output=True, text=True, stdin=subprocess.DEVNULL)
            self.assertEqual(done.returncode, 0, done.stdout[-2000:] + done.stderr[-2000:])
            self.assertIn(f"RENDERER {folder}/addons/wardmis/bin/wardmis", done.stdout)
            combined = exr.read(out).passes["Combined"]
        self.assertEqual(combined.shape, (48, 64, 4))
        self.assertGreater(combined[24, 32, :3].min(), 0)

    def test_versions_that_differ_are_refused(self):
        self.assertRegex(package.version(), r"^\d+\.\d+\.\d+$")
        self.assertIn(f"VERSION {package.version()} ", (ROOT / "CMakeLists.txt").read_text())


if __name__ == "__main__":
    unittest.main()
