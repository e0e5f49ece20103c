# SPDX-License-Identifier: GPL-3.0-or-later
"""Background renders through Blender and this checkout's add-on: the same code as the click on Render."""

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import exr

ROOT = Path(__file__).resolve().parent.parent


class RenderFailed(Exception):
    """Blender ended badly; the message has the end of what it said."""


@dataclass
class Rendered:
    path: Path
    exr: exr.Exr
    statistics: dict[str, Any]  # of the renderer, docs/command.md; empty for Cycles
    seconds: float  # that the engine itself says it rendered


def run(*arguments: str | Path) -> str:
    """Blender in the background, in the clean environment that ./dev has made; returns what it printed."""
    if "WARDMIS_BINARY" not in os.environ:
        raise RenderFailed("start this through ./dev, which sets up Blender's environment")
    command = [os.environ["BLENDER"], "--background", "--addons", "wardmis", *map(str, arguments)]
    done = subprocess.run(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, stdin=subprocess.DEVNULL
    )
    if done.returncode != 0:
        end = "\n".join(done.stdout.splitlines()[-12:])
        raise RenderFailed(f"'{' '.join(command)}' ended with exit code {done.returncode}:\n{end}")
    return done.stdout


def render(blend: Path, out: Path, settings: dict[str, Any]) -> Rendered:
    """Renders `blend` with other `settings` than its own (blend/render_with.py) to the multi-layer EXR `out`."""
    out.parent.mkdir(parents=True, exist_ok=True)
    out.unlink(missing_ok=True)
    pairs = [f"{name}={value}" for name, value in settings.items()]
    said = run(blend, "--python-exit-code", "1", "--python", ROOT / "blend" / "render_with.py", "--", out, *pairs)
    if not out.exists():
        raise RenderFailed(f"Blender wrote no image {out}; it said:\n{said}")
    return rendered(out)


def exported(name: str, folder: Path) -> Path:
    """A scene of blend/bench_scenes.py as a file for the command, made unless it is there."""
    glb = folder / f"{name}.glb"
    if not glb.exists():
        print(f"bench: {name}", file=sys.stderr, flush=True)
        blend = folder / f"{name}.blend"
        run("--python-exit-code", "1", "--python", ROOT / "blend" / "bench_scenes.py", "--", folder, name)
        script = ROOT / "blend" / "export_scene.py"
        run(blend, "--python-exit-code", "1", "--python", script, "--", glb)
        blend.unlink()
    return glb


def rendered(path: Path) -> Rendered:
    """An image that render() has made, with what the engine said about it."""
    image = exr.read(path)
    statistics: dict[str, Any] = {}
    seconds = 0.0
    for name, value in image.attributes.items():
        if name.startswith("wardmis.") and name.endswith(".statistics"):
            statistics = json.loads(str(value))
            seconds = statistics["seconds"]["pilot"] + statistics["seconds"]["render"]
        elif name.startswith("cycles.") and name.endswith(".render_time"):
            seconds = clock_seconds(str(value))
    return Rendered(path, image, statistics, seconds)


def clock_seconds(text: str) -> float:
    """'01:02.50', as Cycles writes it (with hours in front where there are any)."""
    seconds = 0.0
    for part in text.split(":"):
        seconds = seconds * 60 + float(part)
    return seconds
