# SPDX-License-Identifier: GPL-3.0-or-later
"""Procedural textures."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ... import compat
from ..mapping import own_mapping
from ..tree import NodeUse
from .builder import Value
from .reader import Reader


def coordinates(use: NodeUse, p: Reader, implicit: str = "generated") -> Value:
    """What a texture node looks at, by its own Mapping."""
    return p.mapped(_vector(use, p, lambda: p.place(implicit)), own_mapping(use.node.texture_mapping))


def _vector(use: NodeUse, p: Reader, implicit: Callable[[], Value] | None = None) -> Value:
    given = use.has("Vector") and use.node.inputs["Vector"].enabled
    return p.read(use, "Vector", implicit) if given else (0.0, 0.0, 0.0)


def _numbers(use: NodeUse, p: Reader, **defaults: float) -> list[Value]:
    """Inputs by name, with _ for a space; those that are not in use have Cycles' own value."""
    return [p.optional(use, name.replace("_", " "), default) for name, default in defaults.items()]


def _dimensions(name: str) -> int:
    return int(name[0])


def _fractal(name: str) -> str:
    return {"RIDGED_MULTIFRACTAL": "ridged-multifractal", "FBM": "fbm"}.get(name, name.lower().replace("_", "-"))


def _noise(use: NodeUse, output: Any, p: Reader) -> Value:
    node = use.node
    numbers = _numbers(
        use, p, W=0.0, Scale=1.0, Detail=2.0, Roughness=0.5, Lacunarity=2.0, Offset=0.0, Gain=1.0, Distortion=0.0
    )
    return p(
        "noise-color" if output.name == "Color" else "noise",
        coordinates(use, p),
        *numbers,
        dimensions=_dimensions(node.noise_dimensions),
        type=_fractal(getattr(node, "noise_type", "FBM")),
        normalize=getattr(node, "normalize", True),
        version=compat.CYCLES,
    )


def _musgrave(use: NodeUse, _output: Any, p: Reader) -> Value:
    numbers = _numbers(use, p, W=0.0, Scale=1.0, Detail=2.0, Dimension=2.0, Lacunarity=2.0, Offset=0.0, Gain=1.0)
    node = use.node
    return p(
        "musgrave",
        coordinates(use, p),
        *numbers,
        dimensions=_dimensions(node.musgrave_dimensions),
        type=_fractal(node.musgrave_type),
    )


def _voronoi(use: NodeUse, output: Any, p: Reader) -> Value:
    node = use.node
    numbers = _numbers(
        use,
        p,
        W=0.0,
        Scale=5.0,
        Detail=0.0,
        Roughness=0.5,
        Lacunarity=2.0,
        Smoothness=5.0,
        Exponent=0.5,
        Randomness=1.0,
    )
    return p(
        f"voronoi-{output.name.lower()}",
        coordinates(use, p),
        *numbers,
        dimensions=_dimensions(node.voronoi_dimensions),
        feature=node.feature.lower().replace("_", "-"),
        metric=node.distance.lower(),
        normalize=getattr(node, "normalize", False),
        version=compat.CYCLES,
    )


def _gabor(use: NodeUse, output: Any, p: Reader) -> Value:
    dimensions = _dimensions(use.node.gabor_type)
    sockets = {socket.identifier: i for i, socket in enumerate(use.node.inputs)}
    flat = p.read(use, sockets["Orientation 2D"]) if dimensions == 2 else 0.0
    solid = p.read(use, sockets["Orientation 3D"]) if dimensions == 3 else (0.0, 0.0, 0.0)
    numbers = _numbers(use, p, Scale=5.0, Frequency=2.0, Anisotropy=1.0)
    return p(f"gabor-{output.name.lower()}", coordinates(use, p), *numbers, flat, solid, dimensions=dimensions)


def _wave(use: NodeUse, _output: Any, p: Reader) -> Value:
    node = use.node
    bands = node.wave_type == "BANDS"
    axis = (node.bands_direction if bands else node.rings_direction).lower()
    numbers = _numbers(
        use, p, Scale=5.0, Distortion=0.0, Detail=2.0, Detail_Scale=0.0, Detail_Roughness=0.5, Phase_Offset=0.0
    )
    return p(
        "wave",
        coordinates(use, p),
        *numbers,
        shape="bands" if bands else "rings",
        axis=axis if axis in {"x", "y", "z"} else "all",
        profile={"SIN": "sine", "SAW": "saw", "TRI": "triangle"}[node.wave_profile],
        version=compat.CYCLES,
    )


def _magic(use: NodeUse, output: Any, p: Reader) -> Value:
    numbers = _numbers(use, p, Scale=5.0, Distortion=1.0)
    color = p("magic", coordinates(use, p), *numbers, depth=use.node.turbulence_depth, version=compat.MAGIC)
    return color if output.name == "Color" else p("mean", color)


def _checker(use: NodeUse, output: Any, p: Reader) -> Value:
    first = p("checker", coordinates(use, p), p.read(use, "Scale"))
    return p("mix", first, p.read(use, "Color2"), p.read(use, "Color1")) if output.name == "Color" else first


def _gradient(use: NodeUse, _output: Any, p: Reader) -> Value:
    kind = use.node.gradient_type
    name = {"QUADRATIC_SPHERE": "quadratic-sphere"}.get(kind, kind.lower())
    return p("gradient", coordinates(use, p), type=name)


def _white_noise(use: NodeUse, output: Any, p: Reader) -> Value:
    vector = _vector(use, p)
    name = "white-noise-color" if output.name == "Color" else "white-noise"
    return p(name, vector, p.optional(use, "W"), dimensions=_dimensions(use.node.noise_dimensions))


def _brick(use: NodeUse, output: Any, p: Reader) -> Value:
    node = use.node
    vector = coordinates(use, p)
    colors = [p.read(use, name) for name in ("Color1", "Color2", "Mortar")]
    names = ("Scale", "Mortar Size", "Mortar Smooth", "Bias", "Brick Width", "Row Height")
    numbers = [p.read(use, name) for name in names]
    is_color = output.name == "Color"
    return p(
        "brick" if is_color else "brick-factor",
        vector,
        *(colors if is_color else ()),
        *numbers,
        offset=node.offset,
        offsetFrequency=node.offset_frequency,
        squash=node.squash,
        squashFrequency=node.squash_frequency,
        version=compat.BRICK,
    )


NODES = {
    "TexNoise": _noise,
    "TexMusgrave": _musgrave,
    "TexVoronoi": _voronoi,
    "TexGabor": _gabor,
    "TexWave": _wave,
    "TexMagic": _magic,
    "TexChecker": _checker,
    "TexGradient": _gradient,
    "TexWhiteNoise": _white_noise,
    "TexBrick": _brick,
}
