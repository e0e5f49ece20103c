#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Stands in for the command `wardmis` in the add-on's tests: follows docs/command.md, renders nothing, and fails as it is told.

WARDMIS_FAKE says how (see MODES); WARDMIS_FAKE_LOG names a file that receives a JSON line of process id and arguments.
It writes the passes that --passes names. Every pixel of pass number k (from 0) is k + x / width + 10 y / height, x and y of the full frame, so that a test can tell what went where.
"""

import argparse
import json
import os
import signal
import struct
import sys
import threading
import time
from pathlib import Path

import fake_converge
from fake_files import say, write_exr

MODES = {
    "good": "renders",
    "slow": "renders for a minute",
    "crash": "dies of a segmentation fault after the first preview",
    "hang": "says nothing more after its start, and ignores SIGTERM",
    "exit3": "fails with a message",
    "silent": "fails without a message",
    "garbage": "prints no JSON, and makes no image",
    "nothing": "says that it is done, and makes no image",
    "wrong-size": "makes an image of the wrong size",
    "odd-event": "tells of its progress in a way of its own",
    "many-lobes": "has five techniques",
}
PASSES = {
    "Combined": "RGBA",
    "Depth": "Z",
    "Normal": "XYZ",
    "Albedo": "RGB",
    "Variance": "RGB",
    "Allocation Lobe": "X",
    "Allocation Cosine": "X",
    "Allocation Light": "X",
}


def main():
    if sys.argv[1:] == ["--version"]:
        print("wardmis 0.0.0 (fake)")
        return 0
    mode = os.environ.get("WARDMIS_FAKE", "good")
    assert mode in MODES, f"WARDMIS_FAKE is {mode}; it can be {', '.join(MODES)}"
    converges = sys.argv[1:2] == ["converge"]
    options = fake_converge.parse() if converges else parse()
    if "WARDMIS_FAKE_LOG" in os.environ:
        with open(os.environ["WARDMIS_FAKE_LOG"], "a") as log:
            log.write(json.dumps({"pid": os.getpid(), "arguments": sys.argv[1:]}) + "\n")
    if options.watch_stdin:
        threading.Thread(target=stop_when_input_ends, daemon=True).start()
    if converges:
        signal.signal(signal.SIGINT, lambda *_: os._exit(130))
    scene = read_scene(options.scene)
    film = scene["extensions"]["WARDMIS_scene"]["film"]
    if mode == "exit3":
        say(event="error", code=3, message="bufferViews[0]: lies beyond the file; export the scene again")
        print("wardmis: error: bufferViews[0]: lies beyond the file; export the scene again", file=sys.stderr)
        return 3
    if mode == "silent":
        return 4
    if mode == "garbage":
        sys.stdout.buffer.write(b"\xff\xfe garbage\n[1, 2]\n" * 1000)
        return 0
    if converges:
        return fake_converge.converge(options, film, mode)
    render(options, film, mode)
    return 0


def parse():
    parser = argparse.ArgumentParser()
    parser.add_argument("verb", choices=["render"])
    parser.add_argument("scene")
    parser.add_argument("-o", dest="output", required=True)
    parser.add_argument("--preview")
    parser.add_argument("--layer", default="ViewLayer")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--watch-stdin", action="store_true")
    parser.add_argument("--uncompressed", action="store_true")
    parser.add_argument("--passes", type=lambda names: names.split(","), default=[name.lower() for name in PASSES])
    options = "allocation pixels weights integrand integrator time target-error samples-per-hit pilot-spp min-fraction light-paths connections later-connections light-tracing max-depth max-diffuse max-glossy max-transmission max-transparent sampler seed threads progress"
    for option in options.split():
        parser.add_argument("--" + option)
    return parser.parse_args()


def stop_when_input_ends():
    while os.read(0, 1024):  # not sys.stdin, whose lock would disturb the end of this program
        pass
    if sys.argv[1] == "converge":
        os._exit(130)
    os.kill(os.getpid(), signal.SIGKILL)


def read_scene(path):
    data = Path(path).read_bytes()
    magic, version, size, length, kind = struct.unpack_from("<4sIIII", data)
    assert (magic, version, size, kind) == (b"glTF", 2, len(data), 0x4E4F534A)
    return json.loads(data[20 : 20 + length])


def render(options, film, mode):
    x0, y0, x1, y1 = film["border"]
    width, height = x1 - x0, y1 - y0
    known = dict(PASSES)
    if mode == "many-lobes":
        del known["Allocation Lobe"]
        known |= {f"Allocation {name}": "X" for name in ("Glass", "Glossy", "Lobe 3")}
    chosen = {name: channels for name, channels in known.items() if name.split()[0].lower() in options.passes}
    passes = [{"name": name, "channels": channels} for name, channels in chosen.items()]
    say(
        event="start",
        version="0.0.0",
        width=width,
        height=height,
        spp=options.spp,
        passes=passes,
        left_out=[],
        notes=[],
    )
    if mode == "hang":
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        time.sleep(600)
    if mode == "odd-event":
        say(event="progress", percent=50)
    steps = 600 if mode == "slow" else 2
    for step in range(1, steps + 1):
        time.sleep(0.1 if mode == "slow" else 0.01)
        say(
            event="progress",
            phase="render",
            samples=step,
            of=steps,
            fraction=step / steps,
            seconds=0.1 * step,
            left=0.1 * (steps - step),
        )
        if options.preview and step == 1:
            write_exr(options.preview, options.layer, chosen, film)
            say(event="preview", path=options.preview, samples=step)
    if mode == "crash":
        os.kill(os.getpid(), signal.SIGSEGV)
    say(event="warning", message="this renderer is a fake")
    if mode == "wrong-size":
        film = {**film, "border": [x0, y0, x1 + 1, y1 + 1]}
    if mode != "nothing":
        write_exr(options.output, options.layer, chosen, film)
    say(event="done", path=options.output, seconds=0.1, samples=options.spp, stats={"samples_per_pixel": options.spp})


if __name__ == "__main__":
    sys.exit(main())
