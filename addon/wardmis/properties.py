# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a render, `scene.wardmis`. Their values are those of the command `wardmis render` (docs/command.md)."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty

from . import light_paths
from .layout import redraw

# Each with its condition: when it is good, when it is not
ALLOCATIONS = (
    (
        "equal",
        "Equal",
        "The same number of samples for every technique (Lopez Garces and Kong, Definition 7). Safe, and nothing is measured",
    ),
    (
        "variance",
        "Variance",
        "In proportion to each technique's variance (Lopez Garces and Kong, Definition 8). In theory it has just the noise "
        "of Equal; a pilot cannot measure it that well, and where highlights are very narrow it can have twice the error",
    ),
    (
        "standard-deviation",
        "Standard Deviation",
        "In proportion to each technique's standard deviation. In theory never noisier than Equal, and seldom much better",
    ),
    (
        "second-moment",
        "Second Moment",
        "The less, the larger a technique's second moment (Lopez Garces and Kong, Definition 9). Good for glossy surfaces "
        "under lights of some size, with the Split integrand. No guarantee: it can be noisier than Equal, much so with Joint",
    ),
    (
        "inverse-variance",
        "Inverse Variance",
        "The less, the larger the variance of a technique alone. As Second Moment, and with no guarantee either",
    ),
    (
        "equalised",
        "Equalised",
        "Towards equal second moments of all techniques. Cautious, but with no guarantee: it can be noisier than Equal",
    ),
    (
        "representativity",
        "Representativity",
        "By each technique's share of the light. Cautious, but with no guarantee: it can be noisier than Equal",
    ),
    (
        "albedo",
        "Albedo",
        "Half to the light, half to the lobes by their albedo, as PBRT and Cycles do. Good under small lights, often "
        "noisier than Equal under large ones",
    ),
    (
        "auto",
        "Automatic",
        "A small pilot measures, and what it shows to be surely better is taken, its time counted; else Equal, and always "
        "below 16 samples or with weights other than Balance. Good for any scene",
    ),
)

PIXELS = (
    ("auto", "Automatic", "By Error where the allocation is Automatic, too, else Even"),
    ("even", "Even", "As many samples in each pixel, as a comparison of allocations wants it"),
    (
        "by-error",
        "By Error",
        "A quarter of the samples at most is shared evenly and measured; the others go where they bring most, in the time of "
        "as many for each pixel",
    ),
)

WEIGHTS = (
    (
        "auto",
        "Automatic",
        "The weights that go with the allocation: Nonbalance for Variance and Standard Deviation, Balance for all others. "
        "Others are for study",
    ),
    (
        "balance",
        "Balance",
        "By each technique's density times its number of samples, as Veach and Guibas have it: never far from the best",
    ),
    (
        "nonbalance",
        "Nonbalance",
        "By each technique's density alone, however many samples it has (Lopez Garces and Kong, Equation 14)",
    ),
    (
        "power",
        "Power",
        "As Balance, but squared, as Veach and Guibas have it, too: helps where one technique is far better than the others",
    ),
    ("cutoff", "Cutoff", "As Balance, without the techniques whose density is below a tenth of the largest"),
    ("maximum", "Maximum", "The technique with the largest density alone. For study"),
    (
        "variance-aware",
        "Variance-Aware",
        "Of the integrator Bidirectional alone: as Balance, but ways to make a path count more where they scatter less, as "
        "Grittmann and others have it",
    ),
)
INTEGRANDS = (
    (
        "split",
        "Split",
        "Gloss and diffuse reflection are estimated apart and share the samples of the light, as Lopez Garces and Kong do",
    ),
    (
        "joint",
        "Joint",
        "Gloss and diffuse reflection are estimated as one, by all techniques. Second Moment can be very noisy so",
    ),
)
INTEGRATORS = (
    ("path", "Path", "All light, also that which comes by way of other surfaces, up to Max Depth of them"),
    (
        "bidirectional",
        "Bidirectional",
        "The same, by paths from the lights, too: for light that comes through a door ajar or out of frosted glass. With the "
        "allocation Automatic only where they pay",
    ),
    ("direct", "Direct", "Only light that comes straight from lamps, the sky and glowing surfaces: faster, and darker"),
)
BOUNCES = (
    ("own", "Own", "The limits given here; by default all light of paths of up to the given depth"),
    (
        "cycles",
        "As Cycles",
        "The limits that Cycles has in this scene, in its Light Paths panel: what it leaves out is left out here",
    ),
)
FILMS = (
    ("cycles", "As Cycles", "What Cycles has in this scene, in its Film panel, so that both are equally bright"),
    ("own", "Own", "The settings given here"),
)
STOPS = (
    ("samples", "Samples", "Stop after a number of samples in each pixel, however long they take"),
    (
        "seconds",
        "Seconds",
        "Stop after a time, however many samples that are; it includes what the allocation measures first",
    ),
    (
        "target_error",
        "Error",
        "Stop as soon as the image, as far as its own samples tell, is surely as good as is asked for",
    ),
)
SAMPLERS = (
    ("sobol", "Sobol", "Sobol's points, scrambled as Owen has it, cover a pixel most evenly: the least noise"),
    (
        "stratified",
        "Stratified",
        "One random point in each cell of a grid: more noise than Sobol, less than Independent",
    ),
    (
        "independent",
        "Independent",
        "Points that know nothing of each other: the most noise, and what theory assumes. For study",
    ),
)
FILTERS = (
    ("blackman-harris", "Blackman-Harris", "Smooth edges: the default of Cycles"),
    ("gaussian", "Gaussian", "Smooth edges, a little softer"),
    ("box", "Box", "Each sample counts for its own pixel alone: the sharpest, with jagged edges at high contrast"),
)


def _draw_anew(_self: Any, _context: Any) -> None:
    """A change that the results of a comparison tell of in another editor, whether what they recommend is in use."""
    redraw()


class WARDMIS_PG_scene(bpy.types.PropertyGroup):
    allocation: EnumProperty(
        name="Allocation",
        description="Who gets how many of the samples where a ray meets a surface: the lobe (about the mirrored "
        "direction), the cosine (all directions) or the light (towards lamps and the sky). It changes the noise, "
        "never the brightness",
        items=ALLOCATIONS,
        default="auto",
        update=_draw_anew,
    )
    pixels: EnumProperty(
        name="Pixels",
        description="Which pixels get how many of the samples. It changes the noise, never the brightness",
        items=PIXELS,
        default="auto",
        update=_draw_anew,
    )
    weights: EnumProperty(
        name="Weights",
        description="How samples of several techniques are combined that could have found the same light. It changes "
        "the noise, never the brightness",
        items=WEIGHTS,
        default="auto",
        update=_draw_anew,
    )
    integrand: EnumProperty(
        name="Integrand",
        description="Whether gloss and diffuse reflection are sampled apart. It changes the noise, never the brightness",
        items=INTEGRANDS,
        default="split",
        update=_draw_anew,
    )
    integrator: EnumProperty(
        name="Integrator",
        description="Which of the light is rendered",
        items=INTEGRATORS,
        default="path",
        update=_draw_anew,
    )
    light_paths: FloatProperty(
        name="Light Paths",
        description="Paths from the lights for each sample of a pixel; the allocation Automatic chooses for itself",
        default=1.0,
        min=0.0,
        soft_max=8.0,
        max=64.0,
        update=_draw_anew,
    )
    connections: IntProperty(
        name="Connections",
        description="With places that paths from the lights reach, of the first surface that the camera sees; the allocation "
        "Automatic chooses for itself",
        default=1,
        min=0,
        max=64,
        update=_draw_anew,
    )
    later_connections: IntProperty(
        name="Later Connections",
        description="The same of each surface that the camera's paths meet later",
        default=1,
        min=0,
        max=64,
        update=_draw_anew,
    )
    light_tracing: BoolProperty(
        name="Light Tracing",
        description="Paths from the lights are traced to the camera by themselves, too, as caustics want it",
        default=True,
        update=_draw_anew,
    )
    stop_by: EnumProperty(name="Stop by", description="What ends the render", items=STOPS, default="samples")
    samples: IntProperty(
        name="Samples",
        description="Samples in each pixel. Four times as many halve the noise",
        default=64,
        min=1,
        soft_max=4096,
        max=1 << 24,
    )
    seconds: FloatProperty(
        name="Seconds",
        description="Time for each view layer and frame",
        default=60.0,
        min=0.1,
        soft_max=3600.0,
        max=1e7,
        precision=1,
    )
    target_error: FloatProperty(
        name="Error",
        description="Mean squared error over the squared brightness of the image's pixels, without the worst 0.1 % of them. "
        "0.01 is a draft with 10 % noise, 0.001 has 3 %, 0.0001 has 1 %",
        default=0.001,
        min=1e-9,
        soft_min=1e-5,
        soft_max=0.1,
        max=1e3,
        precision=5,
    )
    max_samples: IntProperty(
        name="Max Samples",
        description="Samples in each pixel after which the render stops at the latest",
        default=4096,
        min=8,
        soft_max=65536,
        max=1 << 24,
    )
    samples_per_hit: IntProperty(
        name="Samples per Hit",
        description="Directions in which a sample of the camera looks for light where it first meets a surface; the "
        "allocation shares them among the techniques. More take longer and have less noise",
        default=6,
        min=1,
        max=256,
        update=_draw_anew,
    )
    pilot_samples: IntProperty(
        name="Pilot Samples",
        description="Samples in each pixel that are shared equally and measured; the allocation of all others follows from "
        "them. More make its choice surer, and leave fewer to profit from it. Automatic takes them for every fourth pixel "
        "alone and beside the image's, at most a sixteenth of these",
        default=4,
        min=1,
        soft_max=64,
        max=1 << 20,
        update=_draw_anew,
    )
    min_fraction: FloatProperty(
        name="Least Share",
        description="The least that any technique gets of the samples, as a fraction. More is safer where light is "
        "rare and bright, less lets the allocation go further",
        default=0.1,
        min=0.001,
        max=0.5,
        precision=3,
        subtype="FACTOR",
        update=_draw_anew,
    )
    max_depth: IntProperty(
        name="Max Depth",
        description="How many surfaces light may meet on its way to the camera; 1 is direct light alone",
        default=8,
        min=1,
        soft_max=64,
        max=1024,
        update=_draw_anew,
    )
    bounces: EnumProperty(
        name="Bounces",
        description="How far light is followed. Cycles' own default of 4 diffuse bounces darkens bright interiors",
        items=BOUNCES,
        default="own",
    )
    max_diffuse: IntProperty(
        name="Max Diffuse",
        description="Diffuse bounces of a path, as in Cycles: how often it may go on from a diffuse reflection",
        default=light_paths.LONGEST,
        min=0,
        soft_max=64,
        max=light_paths.LONGEST,
    )
    max_glossy: IntProperty(
        name="Max Glossy",
        description="Glossy bounces of a path, as in Cycles: how often it may go on from a glossy reflection",
        default=light_paths.LONGEST,
        min=0,
        soft_max=64,
        max=light_paths.LONGEST,
    )
    max_transmission: IntProperty(
        name="Max Transmission",
        description="Transmission bounces of a path, as in Cycles: how often it may go on through glass and other "
        "surfaces that scatter light to behind",
        default=light_paths.LONGEST,
        min=0,
        soft_max=64,
        max=light_paths.LONGEST,
    )
    max_transparent: IntProperty(
        name="Max Transparent",
        description="How many transparent surfaces a path may pass straight, as in Cycles. The next one is opaque",
        default=light_paths.TRANSPARENT,
        min=0,
        soft_max=64,
        max=light_paths.LONGEST,
    )
    sampler: EnumProperty(
        name="Sampler",
        description="How random numbers are spread over a pixel: the more evenly, the less noise",
        items=SAMPLERS,
        default="sobol",
        update=_draw_anew,
    )
    seed: IntProperty(name="Seed", description="Another seed gives the same image with other noise", default=0, min=0)
    use_animated_seed: BoolProperty(
        name="Animated Seed",
        description="Another seed in each frame, so that the noise does not stand still in an animation; as Cycles derives it",
        default=False,
    )
    film: EnumProperty(
        name="Film", description="Whose exposure and pixel filter the film has", items=FILMS, default="cycles"
    )
    filter_type: EnumProperty(
        name="Filter",
        description="How the samples near a pixel are weighed into it, as Cycles' Pixel Filter",
        items=FILTERS,
        default="blackman-harris",
    )
    filter_width: FloatProperty(
        name="Width",
        description="Width of the pixel filter in pixels, as in Cycles: more is smoother, less is sharper",
        default=1.5,
        min=0.01,
        max=10.0,
        subtype="PIXEL",
    )
    film_exposure: FloatProperty(
        name="Exposure", description="Multiplies the light that the film receives", default=1.0, min=0.0, soft_max=10.0
    )


def register() -> None:
    bpy.utils.register_class(WARDMIS_PG_scene)
    bpy.types.Scene.wardmis = PointerProperty(type=WARDMIS_PG_scene)


def unregister() -> None:
    del bpy.types.Scene.wardmis
    bpy.utils.unregister_class(WARDMIS_PG_scene)
