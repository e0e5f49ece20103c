# SPDX-License-Identifier: GPL-3.0-or-later
"""What Cycles is told for a comparison, as changes of the scene's settings that are taken back afterwards."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from .. import compat
from ..light_paths import Bounces
from .overrides import Setting

FILTERS = {"box": "BOX", "gaussian": "GAUSSIAN", "blackman-harris": "BLACKMAN_HARRIS"}

# a number from which Cycles' sequences go on as well distributed as they begin: they are so in powers of two
LATER_SAMPLES = 8192


def frame(scene: Any, layer: Any, film: dict[str, Any], threads: int) -> Iterator[Setting]:
    """What makes both render the same pixels by the same filter on the same processor, into a file of Combined alone."""
    render, cycles = scene.render, scene.cycles
    yield render, "engine", "CYCLES"
    yield cycles, "device", "CPU"
    yield from samples(scene, 1, 0, as_is=True)  # these are set for each render
    yield cycles, "use_animated_seed", False
    yield cycles, "time_limit", 0.0
    yield layer, "samples", 0  # it would replace the scene's
    yield render, "threads_mode", "FIXED" if threads else "AUTO"
    if threads:
        yield render, "threads", threads
    yield cycles, "pixel_filter_type", FILTERS[film["filter"]["type"]]
    yield cycles, "filter_width", film["filter"]["width"]
    yield cycles, "film_exposure", film["exposure"]
    yield render, "use_crop_to_border", True  # as WardMIS does
    # what has been synchronised is not in a render's time, and kept data does not see that the samples are others
    yield render, "use_persistent_data", False
    # nothing that comes after the renderer
    yield render, "use_compositing", False
    yield render, "use_sequencer", False
    yield render, "use_freestyle", False
    # further passes would cost time, and WardMIS' are not all to be had
    for prop in layer.bl_rna.properties:
        if prop.identifier.startswith("use_pass_") and prop.type == "BOOLEAN":
            yield layer, prop.identifier, prop.identifier == "use_pass_combined"
    yield from compat.multilayer_exr(render.image_settings)


def samples(scene: Any, spp: int, seed: int, as_is: bool) -> Iterator[Setting]:
    """How many samples, of which sequence. Cycles puts the very first one of each pixel in its middle, whatever the pixel's filter;
    the others are where they belong."""
    yield scene.cycles, "seed", seed
    yield from compat.cycles_samples(scene.cycles, 0 if as_is else LATER_SAMPLES, spp)


def unbiased(scene: Any, bounces: Bounces) -> Iterator[Setting]:
    """Everything off by which Cycles' image, as its settings come, differs from the integral: it would pass for an error of the
    sampling, or hide it. Light paths as long as WardMIS'."""
    cycles = scene.cycles
    yield cycles, "use_adaptive_sampling", False
    yield cycles, "use_denoising", False
    yield cycles, "sample_clamp_direct", 0.0
    yield cycles, "sample_clamp_indirect", 0.0
    yield cycles, "blur_glossy", 0.0
    yield cycles, "light_sampling_threshold", 0.0
    yield cycles, "caustics_reflective", True
    yield cycles, "caustics_refractive", True
    yield cycles, "use_fast_gi", False
    yield cycles, "auto_scrambling_distance", False
    yield cycles, "scrambling_distance", 1.0
    yield cycles, "use_camera_cull", False
    yield cycles, "use_distance_cull", False
    yield cycles, "max_bounces", bounces.total
    for kind, limit in bounces.by_kind().items():
        yield cycles, f"{kind}_bounces", limit
    yield cycles, "transparent_max_bounces", bounces.transparent


def lacks_denoiser(scene: Any) -> bool:
    """Whether the scene is to be denoised by what this Blender was built without: Cycles then renders nothing at all. Debian's is one."""
    import _cycles  # type: ignore[import-not-found] # there where Cycles is

    cycles = scene.cycles
    return bool(cycles.use_denoising and cycles.denoiser != "OPTIX" and not _cycles.with_openimagedenoise)


def described(scene: Any) -> dict[str, Any]:
    """The settings in force, for the report, and to tell whether earlier renders were made with them."""
    names = (
        "max_bounces",
        "diffuse_bounces",
        "glossy_bounces",
        "transmission_bounces",
        "transparent_max_bounces",
        "sample_clamp_direct",
        "sample_clamp_indirect",
        "blur_glossy",
        "light_sampling_threshold",
        "use_adaptive_sampling",
        "adaptive_threshold",
        "use_denoising",
        "use_fast_gi",
        "caustics_reflective",
        "caustics_refractive",
        "sampling_pattern",
        "use_light_tree",
        "use_guiding",
        "pixel_filter_type",
        "filter_width",
        "film_exposure",
    )
    values = {name: getattr(scene.cycles, name) for name in names if hasattr(scene.cycles, name)}
    if not values["use_adaptive_sampling"]:
        del values["adaptive_threshold"]
    return {name: round(v, 6) if isinstance(v, float) else v for name, v in values.items()}
