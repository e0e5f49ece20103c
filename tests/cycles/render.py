# SPDX-License-Identifier: GPL-3.0-or-later
"""Run by Blender: renders scenes with several seeds by WardMIS and by Cycles, for run.py.

blender --background --factory-startup --addons wardmis --python render.py -- FOLDER FIRST_SEED PART PARTS [PATTERN]
takes each scene of this part whose name has PATTERN in it (=NAME: this one), and of which FOLDER/NAME.json does not say yet how it
went. It writes FOLDER/NAME-ENGINE-SEED.exr, and FOLDER/NAME.json when all is rendered."""

from __future__ import annotations

import json
import sys
import traceback
import zlib
from pathlib import Path
from typing import Any

import bpy

sys.path[:0] = [str(Path(__file__).resolve().parent)]

import scenes  # noqa: E402
from stage import SCENES, Scene  # noqa: E402
from wardmis import compat, passes  # noqa: E402

SEEDS = 5
# where Cycles' sequences go on as well distributed as they begin: it puts the very first sample into the middle of the pixel
LATER_SAMPLES = 8192


def set_up(entry: Scene) -> None:
    """An empty scene in which both engines render the same integral, by no rule that trades bias for less noise."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    scene = bpy.context.scene
    render, cycles, wardmis = scene.render, scene.cycles, scene.wardmis
    render.resolution_x, render.resolution_y, render.resolution_percentage = 64, 48, 100
    render.threads_mode, render.threads = "FIXED", 1  # several processes share the machine
    scene.view_settings.view_transform = "Standard"
    render.use_compositing = render.use_sequencer = False
    assign(render.image_settings, media_type="IMAGE", file_format="OPEN_EXR", color_mode="RGBA", color_depth="32")
    cycles.device, cycles.use_adaptive_sampling, cycles.use_denoising = "CPU", False, False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.light_sampling_threshold = cycles.blur_glossy = 0
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = entry.bounces
    cycles.sampling_pattern = "SOBOL" if bpy.app.version < (4, 0) else "TABULATED_SOBOL"
    wardmis.samples = entry.samples
    wardmis.integrator, wardmis.max_depth = "path" if entry.bounces else "direct", entry.bounces + 1
    for owner, name, value in compat.cycles_samples(cycles, 0 if entry.passes else LATER_SAMPLES, entry.samples):
        setattr(owner, name, value)  # passes of data are those of the very first sample
    if entry.passes:
        assign(render.image_settings, media_type="MULTI_LAYER_IMAGE", file_format="OPEN_EXR_MULTILAYER")
        for flag, group in passes.BLENDERS.items():
            setattr(scene.view_layers[0], flag, group in entry.passes)


def assign(owner: Any, **settings: Any) -> None:
    """Those that this Blender has, in order."""
    for name, value in settings.items():
        if hasattr(owner, name):
            setattr(owner, name, value)


def make(entry: Scene) -> None:
    set_up(entry)
    entry.build()
    for (
        world
    ) in bpy.data.worlds:  # Cycles draws its map of an image sky as large as 2048 pixels, at a second for each render
        if world.cycles.sampling_method == "AUTOMATIC":
            world.cycles.sampling_method, world.cycles.sample_map_resolution = "MANUAL", 256


def render_scene(entry: Scene, folder: Path, first_seed: int) -> None:
    make(entry)
    scene = bpy.context.scene
    for engine in ("WARDMIS", "CYCLES"):
        scene.render.engine = engine
        for seed in range(first_seed, first_seed + SEEDS):
            scene.wardmis.seed = scene.cycles.seed = seed
            path = folder / f"{entry.name}-{engine.lower()}-{seed}.exr"
            scene.render.use_file_extension, scene.render.filepath = False, str(path)
            bpy.ops.render.render(write_still=True)
            if not path.exists():
                raise RuntimeError(f"{engine} rendered no image")


def chosen(entry: Scene, pattern: str) -> bool:
    """By a part of the name, or the whole one after '='; 'all': each; '': a sample."""
    if pattern in {"", "all"}:
        return pattern == "all" or not entry.seldom
    return entry.name == pattern[1:] if pattern.startswith("=") else pattern in entry.name


def check_seldom() -> None:
    """That what topics name as SELDOM is there."""
    for topic, module in vars(scenes).items():
        for name in getattr(module, "SELDOM", ()):
            assert f"{topic}-{name}" in SCENES, f"{topic} has no scene {name}, which its SELDOM names"


def main() -> None:
    check_seldom()
    folder, first_seed, part, parts, *pattern = sys.argv[sys.argv.index("--") + 1 :]
    wanted = [s for s in SCENES.values() if chosen(s, *pattern or [""])]
    version = bpy.app.version[:2]
    wanted = [s for s in wanted if version >= s.since and version != s.without]
    wanted = wanted[int(part) :: int(parts)]
    (Path(folder) / f"part-{part}.json").write_text(json.dumps([s.name for s in wanted]))
    for entry in wanted:
        outcome = Path(folder) / f"{entry.name}.json"
        if outcome.exists():
            continue
        error = ""
        try:
            # of its own for each scene: with one seed the same block would deviate in all of them
            render_scene(entry, Path(folder), int(first_seed) + zlib.crc32(entry.name.encode()) % (1 << 30))
        except Exception as exception:
            traceback.print_exc()
            error = str(exception).strip() or repr(exception)
        limits = {name: getattr(entry, name) for name in ("within", "why", "block", "noise")}
        limits["passes"] = [p.name for p in passes.PASSES if p.group in entry.passes] or ["Combined"]
        outcome.write_text(json.dumps({**limits, "error": error}))


if __name__ == "__main__":
    main()
