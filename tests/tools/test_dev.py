# SPDX-License-Identifier: GPL-3.0-or-later
"""./dev refuses what it does not understand, and hands paths on as they are meant."""

import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
VEACH = ROOT / "blend" / "veach.blend"


def dev(*arguments, folder=ROOT):
    command = [ROOT / "dev", *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=120)


class Usage(unittest.TestCase):
    def test_what_no_verb_takes_ends_with_2(self):
        for arguments in (
            ("frob",),
            ("lint", "--nope"),
            ("build", "nope"),
            ("build", "debug", "--nope"),
            ("package", "--nope"),
            ("clean", "--nope"),
            ("test", "nope"),
            ("test", "native", "A", "B"),
            ("export", str(VEACH)),
            ("export", str(VEACH), "--nope", "x.glb"),
        ):
            with self.subTest(arguments=arguments):
                done = dev(*arguments)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(next(a for a in reversed(arguments) if a != "x.glb"), done.stderr)


class Export(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def test_paths_from_where_it_is_called(self):
        done = dev("export", VEACH, "-o", "-x.glb", folder=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([p.name for p in self.folder.iterdir()], ["-x.glb"])

    def test_what_cannot_be_written_is_named_as_it_was_given(self):
        for out, says in (("none/x.glb", "does not exist"), (".", "is a folder"), ("/proc/x.glb", "cannot be written")):
            with self.subTest(out=out):
                done = dev("export", VEACH, "-o", out, folder=self.folder)
                self.assertEqual(done.returncode, 1)
                self.assertRegex(done.stderr.strip(), rf"^error: WardMIS: [^\n]*{says}[^\n]*$")
                self.assertNotIn(".tmp", done.stdout + done.stderr)
        self.assertEqual(list(self.folder.iterdir()), [])


if __name__ == "__main__":
    unittest.main()
