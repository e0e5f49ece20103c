# SPDX-License-Identifier: GPL-3.0-or-later
"""What each operation takes and gives: n(umber) or v(ector), arguments > result."""

from __future__ import annotations

_TABLE = {
    ">v": "position normal true-normal object-normal incoming direction reflection tangent tangent-uv uv generated object camera window "
    "parametric attribute object-location object-color view-vector",
    ">n": "backfacing attribute-number attribute-alpha object-alpha object-index object-random material-index view-depth view-distance "
    "is-camera-ray is-shadow-ray is-diffuse-ray is-glossy-ray is-singular-ray is-reflection-ray is-transmission-ray ray-length ray-depth "
    "diffuse-depth glossy-depth transparent-depth transmission-depth",
    "n>v": "vector ramp blackbody wavelength",
    "v>n": "luminance mean x y z vector-length gradient image-alpha environment-alpha",
    "nnn>v": "combine",
    "nn>n": "add subtract multiply divide power logarithm minimum maximum less-than greater-than modulo floored-modulo snap ping-pong atan2 "
    "curve light-falloff-quadratic light-falloff-linear light-falloff-constant",
    "n>n": "sqrt inverse-sqrt absolute exponent sign round floor ceil truncate fraction sin cos tan asin acos atan sinh cosh tanh radians "
    "degrees ramp-alpha",
    "nnn>n": "multiply-add compare smooth-minimum smooth-maximum wrap clamp clamp-range mix-number",
    "nnnnn>n": "map-range map-range-smoothstep map-range-smootherstep",
    "nnnnnn>n": "map-range-stepped",
    "vv>v": "vector-add vector-subtract vector-multiply vector-divide vector-cross vector-project vector-reflect vector-snap vector-modulo "
    "vector-power vector-minimum vector-maximum image-box",
    "vvv>v": "vector-multiply-add vector-faceforward vector-wrap vector-rotate-euler mapping-vector mapping-normal mix-vector-each",
    "vvn>v": "vector-refract",
    "vv>n": "vector-dot vector-distance image-box-alpha",
    "vn>v": "vector-scale normal-map-tangent normal-map-object normal-map-world gamma white-noise-color",
    "v>v": "vector-normalize vector-round vector-floor vector-ceil vector-fraction vector-absolute vector-sign vector-sin vector-cos "
    "vector-tan vector-transform vector-displacement bend mapping rgb-to-hsv hsv-to-rgb rgb-to-hsl hsl-to-rgb image environment",
    "vvvvv>v": "vector-map-range vector-map-range-smoothstep vector-map-range-smootherstep",
    "vvvvvv>v": "vector-map-range-stepped",
    "nvv>v": "mix-vector mix mix-add mix-multiply mix-screen mix-overlay mix-subtract mix-divide mix-difference mix-exclusion mix-darken "
    "mix-lighten mix-dodge mix-burn mix-hue mix-saturation mix-value mix-color mix-soft-light mix-linear-light",
    "vvvn>v": "vector-rotate-axis",
    "vvvv>v": "mapping-point mapping-texture",
    "nnnnnv>v": "bump",
    "nnnvnnvvv>v": "below-layers",
    "nnnnv>v": "hue-saturation",
    "vnn>v": "bright-contrast magic",
    "nv>v": "invert curves",
    "nv>n": "fresnel layer-weight-fresnel layer-weight-facing",
    "vnnnnnnnn>n": "noise voronoi-distance voronoi-w voronoi-radius",
    "vnnnnnnnn>v": "noise-color voronoi-color voronoi-position",
    "vnnnnnnn>n": "musgrave",
    "vnnnnv>n": "gabor-value gabor-phase gabor-intensity",
    "vnnnnnn>n": "wave brick-factor",
    "vn>n": "checker white-noise",
    "vvvvnnnnnn>v": "brick",
}
_KINDS = {"n": "number", "v": "vector"}

# name -> (kinds of the arguments, kind of the result)
SIGNATURES: dict[str, tuple[tuple[str, ...], str]] = {
    name: (tuple(_KINDS[letter] for letter in signature.split(">")[0]), _KINDS[signature[-1]])
    for signature, names in _TABLE.items()
    for name in names.split()
}
