# SPDX-License-Identifier: GPL-3.0-or-later
"""Instructions of the renderer's own code for a path, which do not scatter as times do, and are to grow by no more than a twentieth.

What is committed was counted with the compiler and for the instruction set that it names; others make other code, whose
instructions are counted and told.
Where a change is meant to cost more, or costs less, `WARDMIS_RECORD=1 ./dev test end_to_end test_instructions` writes the new figures."""

import json
import os
import re
import subprocess
from pathlib import Path

from blender import ROOT
from command import BINARY, CommandTest

COMMITTED = ROOT / "tests" / "golden" / "instructions.json"
RESOLUTION, SAMPLES = (24, 16), 8
CASES = {
    "veach": ("veach", "path"),
    "veach, direct": ("veach", "direct"),
    "teapot": ("teapot", "path"),
    "studio": ("studio", "path"),
}


def compiler():
    cache = (Path(BINARY).parent / "compile_commands.json").read_text()
    path = json.loads(cache)[0]["command"].split()
    name = next(word for word in path if Path(word).name not in ("ccache", "sccache"))
    return subprocess.run([name, "--version"], capture_output=True, text=True, check=True).stdout.splitlines()[0]


def of_object(path, name):
    """Of a file of callgrind's, the instructions that the object's functions take themselves."""
    names, current, total, call = {}, "", 0, False
    for line in path.read_text().splitlines():
        key, _, rest = line.partition("=")
        if key in ("ob", "cob"):  # of a function, and of one that it calls; the first of each number has the name
            number, _, text = rest.partition(" ")
            known = names.setdefault(number, text)
            current = known if key == "ob" else current
        elif line.startswith("calls="):
            call = True  # the next line has what the called ones take
        elif re.match(r"[\d+*-]", line):
            if not call and Path(current).name == name:
                total += int(line.split()[-1])
            call = False
    return total


class Instructions(CommandTest):
    scenes = ("veach", "teapot", "studio")

    def counted(self, scene, integrator):
        file = self.folder / "callgrind.out"
        command = ["valgrind", "--tool=callgrind", "--toggle-collect=void wardmis::renderTile<*"]
        command += [f"--callgrind-out-file={file}", BINARY, "render", self.scene(scene), "-o", self.out, "--threads", 1]
        command += ["--allocation", "equal", "--integrator", integrator, "--progress", "none", "--spp", SAMPLES]
        command += ["--resolution", "{}x{}".format(*RESOLUTION)]
        done = subprocess.run([*map(str, command)], capture_output=True, text=True, timeout=300, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return of_object(file, Path(BINARY).name) / (SAMPLES * RESOLUTION[0] * RESOLUTION[1])

    def test_a_path_takes_no_more(self):
        found = {name: round(self.counted(*case)) for name, case in CASES.items()}
        stats = self.folder / "stats.json"
        self.render("--spp", "1", "--stats", stats)
        document = {"compiler": compiler(), "isa": json.loads(stats.read_text())["isa"], "instructions": found}
        print(json.dumps(document), end=" ", flush=True)
        if os.environ.get("WARDMIS_RECORD"):
            COMMITTED.write_text(json.dumps(document, indent=1) + "\n")
        committed = json.loads(COMMITTED.read_text())
        self.assertEqual(set(committed["instructions"]), set(CASES))
        for name, count in found.items():
            self.assertGreater(count, 100, name)
            if all(committed[key] == document[key] for key in ("compiler", "isa")):
                self.assertLess(count, 1.05 * committed["instructions"][name], name)
