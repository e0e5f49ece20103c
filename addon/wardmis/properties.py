# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a render, `scene.wardmis`. Their values are those of the command `wardmis render` (docs/command.md)."""

from __future__ import annotations

import bpy
from bpy.props import EnumProperty, FloatProperty, IntProperty, PointerProperty

ALLOCATIONS = (
    ("equal", "Equal", "The same number of samples for every technique (Definition 7)"),
    ("variance", "Variance", "In proportion to each technique's variance, from a pilot (Definition 8)"),
    (
        "standard-deviation",
        "Standard Deviation",
        "In proportion to each technique's standard deviation, from a pilot: provably no worse than Equal",
    ),
    ("second-moment", "Second Moment", "By each technique's second moment, from a pilot (Definition 9)"),
    ("inverse-variance", "Inverse Variance", "By the variance that each technique would have alone, from a pilot"),
    ("equalised", "Equalised", "Towards equal second moments of all techniques, from a pilot"),
    ("representativity", "Representativity", "By each technique's share of the light, from a pilot"),
    ("albedo", "Albedo", "Half to the light, half to the lobes by their albedo, as PBRT and Cycles do"),
    ("auto", "Automatic", "Least predicted variance over the samples of a pilot; Equal where the gain is not certain"),
)
# They measure with a pilot; the others need none
ALLOCATIONS_WITH_PILOT = {name for name, *_ in ALLOCATIONS} - {"equal", "albedo"}

WEIGHTS = (
    (
        "auto",
        "Automatic",
        "The weights that belong to the allocation: nonbalance for Variance and Standard Deviation, else balance",
    ),
    ("balance", "Balance", "Balance heuristic: each technique's density times its share of the samples"),
    ("nonbalance", "Nonbalance", "Each technique's density alone, whatever its share of the samples (Equation 14)"),
    ("power", "Power", "Power heuristic with exponent 2"),
    ("cutoff", "Cutoff", "Balance among the techniques whose density is at least a tenth of the largest"),
    ("maximum", "Maximum", "The technique with the largest density counts alone"),
)
INTEGRANDS = (
    ("split", "Split", "Specular and diffuse reflection are two integrals that share the light samples"),
    ("joint", "Joint", "One integral of the whole reflection, sampled by all techniques"),
)
INTEGRATORS = (
    ("path", "Path", "All light, through paths of up to the given depth"),
    ("direct", "Direct", "Direct light only"),
)
STOPS = (
    ("samples", "Samples", "Stop after a number of camera samples per pixel"),
    ("seconds", "Seconds", "Stop after a time; the pilot is part of it"),
)
SAMPLERS = (
    ("sobol", "Sobol", "Owen-scrambled Sobol points: least noise"),
    ("stratified", "Stratified", "One random point in each stratum"),
    ("independent", "Independent", "Independent random points, as the theory assumes"),
)
FILTERS = (
    ("blackman-harris", "Blackman-Harris", "Smooth, as Cycles does by default"),
    ("gaussian", "Gaussian", "Smooth"),
    ("box", "Box", "The mean of the pixel's area"),
)


class WARDMIS_PG_scene(bpy.types.PropertyGroup):
    allocation: EnumProperty(
        name="Allocation",
        description="How the samples at a hit are shared between the techniques: lobe, cosine and light",
        items=ALLOCATIONS,
        default="second-moment",
    )
    weights: EnumProperty(
        name="Weights", description="How the techniques' samples are weighted", items=WEIGHTS, default="auto"
    )
    integrand: EnumProperty(
        name="Integrand", description="What the techniques estimate together", items=INTEGRANDS, default="split"
    )
    integrator: EnumProperty(
        name="Integrator", description="Which light is rendered", items=INTEGRATORS, default="path"
    )
    stop_by: EnumProperty(name="Stop by", description="What ends the render", items=STOPS, default="samples")
    samples: IntProperty(
        name="Samples", description="Camera samples per pixel", default=64, min=1, soft_max=4096, max=1 << 24
    )
    seconds: FloatProperty(
        name="Seconds",
        description="Time for the render of one view layer and frame, pilot included",
        default=60.0,
        min=0.1,
        soft_max=3600.0,
        max=1e7,
        precision=1,
    )
    samples_per_hit: IntProperty(
        name="Samples per Hit",
        description="Samples that the techniques share at the first hit of a camera sample",
        default=3,
        min=1,
        max=256,
    )
    pilot_samples: IntProperty(
        name="Pilot Samples",
        description="Camera samples per pixel, out of all, that measure the moments for the allocation",
        default=4,
        min=1,
        soft_max=64,
        max=1 << 20,
    )
    min_fraction: FloatProperty(
        name="Least Share",
        description="No technique gets less than this share of the samples",
        default=0.1,
        min=0.001,
        max=0.5,
        precision=3,
        subtype="FACTOR",
    )
    max_depth: IntProperty(
        name="Max Depth",
        description="Surface hits of a path; 1 is direct light",
        default=8,
        min=1,
        soft_max=64,
        max=1024,
    )
    sampler: EnumProperty(
        name="Sampler", description="Where the random numbers come from", items=SAMPLERS, default="sobol"
    )
    seed: IntProperty(name="Seed", description="The image depends on it, and never on the threads", default=0, min=0)
    filter_type: EnumProperty(name="Filter", description="Pixel filter", items=FILTERS, default="blackman-harris")
    filter_width: FloatProperty(
        name="Width",
        description="Width of the pixel filter, in pixels, as in Cycles",
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
