# SPDX-License-Identifier: GPL-3.0-or-later
"""What parity.py compares: (node, case, largest relative difference, builder of a socket) for each output and setting."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import bpy
import numpy as np
from parity_rows import PIXELS
from patches import Nodes

EXACT, NOISY = 1e-4, 1e-3

Case = tuple[str, str, float, Callable[[Nodes], Any]]


class Inputs:
    """Numbers, vectors and colours that vary over a patch."""

    def __init__(self, n: Nodes, smooth: bool = False) -> None:
        """By steps from the middle of a pixel to the next, whose every bit is the same in both; smooth: as UVs are interpolated."""
        self.n = n
        parts = n("SeparateXYZ", n("TexCoord").outputs["UV"]).outputs[:2]
        if not smooth:
            below = [n("Math", part, 1 / PIXELS, operation="SNAP").outputs[0] for part in parts]
            parts = [n("Math", part, 0.5 / PIXELS, operation="ADD").outputs[0] for part in below]
        self.parts = parts

    def u(self, low: float, high: float, axis: int = 0) -> Any:
        return self.n("Math", self.parts[axis], high - low, low, operation="MULTIPLY_ADD").outputs[0]

    def v(self, low: float, high: float) -> Any:
        return self.u(low, high, 1)

    def vector(self, scale: float = 3.0) -> Any:
        low, high = -0.47 * scale, 0.53 * scale
        both = self.n("Math", self.u(low, high), self.v(0.31, -0.4), operation="ADD").outputs[0]
        return self.n("CombineXYZ", self.u(low, high), self.v(low, high), both).outputs[0]

    def direction(self) -> Any:
        return self.n("VectorMath", self.vector(), operation="NORMALIZE").outputs[0]

    def color(self) -> Any:
        return self.n("CombineColor", self.u(0.03, 0.97), self.v(0.05, 0.9), self.u(0.8, 0.1)).outputs[0]

    def wild(self) -> Any:
        return self.n("CombineXYZ", self.u(-0.5, 1.6), self.v(-0.4, 1.3), self.u(1.2, -0.3)).outputs[0]


def shown(node: Any, name: str | None = None) -> Any:
    outputs = [s for s in node.outputs if s.enabled and s.type != "SHADER"]
    return next(s for s in outputs if name is None or s.name == name)


def each(settings: str, kind: str) -> list[str]:
    """The values of an enumeration of this Blender's node."""
    return [item.identifier for item in getattr(bpy.types, f"ShaderNode{kind}").bl_rna.properties[settings].enum_items]


def has(kind: str) -> bool:
    return hasattr(bpy.types, f"ShaderNode{kind}")


def outputs_of(kind: str, **settings: Any) -> list[str]:
    tree = bpy.data.node_groups.new("Probe", "ShaderNodeTree")
    node = tree.nodes.new(f"ShaderNode{kind}")
    for name, value in settings.items():
        setattr(node, name, value)
    names = [s.name for s in node.outputs if s.enabled and s.type in {"VALUE", "INT", "RGBA", "VECTOR"}]
    bpy.data.node_groups.remove(tree)
    return names


def case(
    kind: str, build: Callable[[Nodes, Inputs, str], Any], within: float = EXACT, **settings: Any
) -> Iterator[Case]:
    """One for each output of the node that `build` makes and returns."""
    words = " ".join(str(v).lower() for v in settings.values())
    for name in outputs_of(kind, **settings):

        def make(n: Nodes, name: str = name) -> Any:
            node = build(n, Inputs(n), kind)
            for setting, value in settings.items():
                setattr(node, setting, value)
            return shown(node, name)

        yield kind, f"{kind} {words} {name}".replace("  ", " "), within, make


def fill(node: Any, n: Nodes, **inputs: Any) -> Any:
    """Inputs by name with _ for a space, as far as the node has them."""
    for key, value in inputs.items():
        for socket in node.inputs:
            if socket.name == key.replace("_", " "):
                n.feed(socket, value)
    return node


def cases() -> Iterator[Case]:
    yield from numbers()
    yield from vectors()
    yield from colors()
    yield from places()
    yield from patterns()
    yield from images()
    yield from skies()
    yield from normals()


def plain(kind: str, **inputs: Callable[[Inputs], Any]) -> Callable[[Nodes, Inputs, str], Any]:
    return lambda n, i, _kind: fill(n(kind), n, **{name: make(i) for name, make in inputs.items()})


def in_order(kind: str, *inputs: Callable[[Inputs], Any]) -> Callable[[Nodes, Inputs, str], Any]:
    def build(n: Nodes, i: Inputs, _kind: str) -> Any:
        node = n(kind)
        for socket, make in zip(node.inputs, inputs):
            n.feed(socket, make(i))
        return node

    return build


def numbers() -> Iterator[Case]:
    x, y, z = (lambda i: i.u(-2.1, 2.3)), (lambda i: i.v(-1.7, 1.9)), (lambda i: i.u(0.2, 0.9))
    for operation in each("operation", "Math"):
        yield from case("Math", in_order("Math", x, y, z), operation=operation)
    yield from case("Math", in_order("Math", x, y, z), operation="ADD", use_clamp=True)
    for kind, value in (("Value", -0.7), ("RGB", (0.3, 0.6, 0.9, 0.5))):

        def own(n: Nodes, _i: Inputs, kind: str, value: Any = value) -> Any:
            node = n(kind)
            node.outputs[0].default_value = value
            return node

        yield from case(kind, own)
    for kind in each("clamp_type", "Clamp"):
        yield from case("Clamp", in_order("Clamp", x, y, z), clamp_type=kind)
    ranges = (
        x,
        lambda i: i.v(-1.0, -0.5),
        lambda i: i.v(1.0, 1.5),
        lambda i: i.u(-1, 2),
        lambda i: i.v(3, 2),
        lambda i: i.u(3, 5),
    )
    for kind in each("interpolation_type", "MapRange"):
        for clamp in (False, True):
            yield from case("MapRange", in_order("MapRange", *ranges), interpolation_type=kind, clamp=clamp)

            def vector_range(n: Nodes, i: Inputs, _kind: str) -> Any:
                node = n("MapRange")
                values = (
                    i.vector(),
                    (-1.0, -0.7, -0.5),
                    (0.9, 1.1, 1.3),
                    (0.0, 1.0, 2.0),
                    (2.0, 0.5, 3.0),
                    (3.0, 4.0, 5.0),
                )
                for socket, value in zip([s for s in node.inputs if s.type == "VECTOR"], values):
                    n.feed(socket, value)
                return node

            yield from case("MapRange", vector_range, data_type="FLOAT_VECTOR", interpolation_type=kind, clamp=clamp)

    def float_curve(n: Nodes, i: Inputs, _kind: str) -> Any:
        node = n("FloatCurve")
        bend(node.mapping, 0)
        return fill(node, n, Factor=i.v(0, 1), Value=i.u(-0.4, 1.5))

    yield from case("FloatCurve", float_curve)


def bend(mapping: Any, index: int, y: float = 0.8) -> None:
    mapping.curves[index].points.new(0.3, y)
    mapping.update()


def vectors() -> Iterator[Case]:
    a, b, c = (lambda i: i.vector()), (lambda i: i.wild()), (lambda i: i.vector(1.0))
    for operation in each("operation", "VectorMath"):

        def math(n: Nodes, i: Inputs, _kind: str) -> Any:
            node = n("VectorMath")
            for socket, make in zip(
                node.inputs, (lambda i: i.vector(2.2), lambda i: i.wild(), c, lambda i: i.u(0.3, 1.6))
            ):
                n.feed(socket, make(i))
            return node

        yield from case("VectorMath", math, operation=operation)
    for kind in each("vector_type", "Mapping"):
        for label, linked in (("fixed", False), ("linked", True)):

            def mapping(n: Nodes, i: Inputs, _kind: str, linked: bool = linked) -> Any:
                rotation = i.vector(1.0) if linked else (0.3, -0.5, 0.8)
                scale = i.color() if linked else (1.3, 0.7, -0.6)
                location = i.wild() if linked else (0.2, -0.4, 0.1)
                return fill(n("Mapping"), n, Vector=i.vector(), Location=location, Rotation=rotation, Scale=scale)

            for node, name, within, make in case("Mapping", mapping, vector_type=kind):
                yield node, f"{name} {label}", within, make
    for kind in each("rotation_type", "VectorRotate"):
        for invert in (False, True):
            build = plain(
                "VectorRotate",
                Vector=a,
                Center=lambda i: (0.1, 0.2, -0.3),
                Axis=b,
                Angle=lambda i: i.v(-2, 2),
                Rotation=c,
            )
            yield from case("VectorRotate", build, rotation_type=kind, invert=invert)
    for kind in each("vector_type", "VectorTransform"):
        for before in each("convert_from", "VectorTransform"):
            for after in each("convert_to", "VectorTransform"):
                build = plain("VectorTransform", Vector=a)
                yield from case("VectorTransform", build, vector_type=kind, convert_from=before, convert_to=after)

    def curves(n: Nodes, i: Inputs, _kind: str) -> Any:
        node = n("VectorCurve")
        for k in range(3):
            bend(node.mapping, k, 0.6 + 0.1 * k)
        return fill(node, n, Fac=i.v(0, 1), Factor=i.v(0, 1), Vector=i.vector())

    yield from case("VectorCurve", curves)
    yield from case("Normal", plain("Normal", Normal=a))
    yield from case("SeparateXYZ", in_order("SeparateXYZ", a))
    yield from case(
        "CombineXYZ", in_order("CombineXYZ", lambda i: i.u(-1, 1), lambda i: i.v(-1, 1), lambda i: i.u(0, 3))
    )


def colors() -> Iterator[Case]:
    a, b = (lambda i: i.color()), (lambda i: i.n("Gamma", i.wild(), 1.0).outputs[0])
    t = lambda i: i.v(-0.2, 1.2)  # noqa: E731
    for blend in each("blend_type", "MixRGB"):
        for clamp in (False, True):
            yield from case("MixRGB", in_order("MixRGB", t, a, b), blend_type=blend, use_clamp=clamp)
            yield from case("MixRGB", in_order("MixRGB", t, b, a), blend_type=blend, use_clamp=clamp)

        def mix(n: Nodes, i: Inputs, _kind: str) -> Any:
            node = n("Mix")
            node.data_type = "RGBA"
            for socket, make in zip([s for s in node.inputs if s.enabled], (t, a, b)):
                n.feed(socket, make(i))
            return node

        yield from case("Mix", mix, data_type="RGBA", blend_type=blend, clamp_factor=False)

    def mix_numbers(n: Nodes, i: Inputs, _kind: str) -> Any:
        node = n("Mix")
        for socket in node.inputs:
            n.feed(socket, {"VALUE": i.u(-0.3, 1.4), "VECTOR": i.vector(), "RGBA": i.color()}.get(socket.type))
        return node

    for clamp in (False, True):
        yield from case("Mix", mix_numbers, data_type="FLOAT", clamp_factor=clamp)
        for mode in each("factor_mode", "Mix"):
            yield from case("Mix", mix_numbers, data_type="VECTOR", factor_mode=mode, clamp_factor=clamp)
    yield from case("Gamma", in_order("Gamma", b, lambda i: i.v(0.0, 3.0)))
    yield from case("Invert", in_order("Invert", t, a))
    yield from case("BrightContrast", in_order("BrightContrast", a, lambda i: i.u(-0.3, 0.5), lambda i: i.v(-1, 2)))
    hue = plain(
        "HueSaturation",
        Hue=lambda i: i.u(-0.3, 1.4),
        Saturation=lambda i: i.v(0, 2),
        Value=lambda i: i.u(0.2, 2),
        Fac=t,
        Factor=t,
        Color=a,
    )
    yield from case("HueSaturation", hue)
    yield from case("RGBToBW", in_order("RGBToBW", a))
    for kind in ("SeparateColor", "CombineColor"):
        for mode in each("mode", kind):
            values = (
                (a,) if kind == "SeparateColor" else (lambda i: i.u(0, 1), lambda i: i.v(0, 1), lambda i: i.v(0.9, 0.2))
            )
            yield from case(kind, in_order(kind, *values), mode=mode)
    for kind in ("SeparateRGB", "SeparateHSV"):
        if has(kind):
            yield from case(kind, in_order(kind, a))
    for kind in ("CombineRGB", "CombineHSV"):
        if has(kind):
            yield from case(kind, in_order(kind, lambda i: i.u(0, 1), lambda i: i.v(0, 1), lambda i: i.v(0.9, 0.2)))

    def curve(n: Nodes, i: Inputs, _kind: str) -> Any:
        node = n("RGBCurve")
        for k in range(4):
            bend(node.mapping, k, 0.5 + 0.1 * k)
        return fill(node, n, Fac=t(i), Factor=t(i), Color=a(i))

    yield from case("RGBCurve", curve)
    for interpolation in ("EASE", "CARDINAL", "LINEAR", "B_SPLINE", "CONSTANT"):

        def ramp(n: Nodes, i: Inputs, _kind: str, interpolation: str = interpolation) -> Any:
            node = n("ValToRGB", i.u(-0.2, 1.2))
            node.color_ramp.interpolation = interpolation
            node.color_ramp.elements.new(0.37).color = (0.9, 0.3, 0.1, 0.4)
            return node

        for node, name, within, make in case("ValToRGB", ramp):
            yield node, f"{name} {interpolation.lower()}", within, make
    body = in_order("Blackbody", lambda i: i.n("Math", i.u(600, 13000), i.v(0, 300)).outputs[0])
    yield from case("Blackbody", body, within=1e-3)  # Cycles has a fit to Planck's law, within 7e-4 of it
    yield from case("Wavelength", in_order("Wavelength", lambda i: i.u(370, 790)))


def places() -> Iterator[Case]:
    for kind in ("TexCoord", "NewGeometry", "CameraData", "ObjectInfo", "LightPath"):
        for node, name, within, make in case(kind, lambda n, _i, kind: n(kind)):
            if not name.endswith(("Pointiness", "Random Per Island", "Portal Depth", "Is Volume Scatter Ray")):
                yield node, name, within, make
    yield from case("UVMap", lambda n, _i, _k: n("UVMap", uv_map="Turned"))
    for direction, settings in (
        ("RADIAL", {"axis": "X"}),
        ("RADIAL", {"axis": "Y"}),
        ("RADIAL", {"axis": "Z"}),
        ("UV_MAP", {}),
    ):
        yield from case("Tangent", lambda n, _i, _k: n("Tangent"), direction_type=direction, **settings)
    for name in ("Paint", "Bytes", "Heat", "Flow", "Turned", "Nothing"):
        yield from case("Attribute", lambda n, _i, _k: n("Attribute"), attribute_name=name)
    yield from case("Attribute", lambda n, _i, _k: n("Attribute"), attribute_type="OBJECT", attribute_name="Warmth")
    for name in ("", "Paint"):
        yield from case("VertexColor", lambda n, _i, _k: n("VertexColor"), layer_name=name)
    yield from case("Fresnel", in_order("Fresnel", lambda i: i.u(0.6, 2.5)))
    yield from case("LayerWeight", in_order("LayerWeight", lambda i: i.u(0.05, 0.95)))
    yield from case("LightFalloff", in_order("LightFalloff", lambda i: i.u(0, 2), lambda i: i.v(0, 3)))


def steps(i: Inputs) -> Any:
    """A vector whose every bit is the same in both."""
    node = i.n("VectorMath", i.vector(16.0), (1.0, 1.0, 1.0), operation="SNAP")
    return node.outputs[0]


def patterns() -> Iterator[Case]:
    common: dict[str, Callable[[Inputs], Any]] = {
        "Vector": lambda i: i.vector(),
        "W": lambda i: i.v(0.2, 1.3),
        "Scale": lambda i: i.n("Math", i.u(2.1, 2.3), i.v(0, 0.1)).outputs[0],
    }
    noise = {
        **common,
        "Detail": lambda i: i.u(1.2, 3.8),
        "Roughness": lambda i: i.v(0.3, 0.7),
        "Lacunarity": lambda i: i.u(1.8, 2.3),
        "Offset": lambda i: i.u(0.1, 0.9),
        "Gain": lambda i: i.v(0.5, 1.5),
        "Distortion": lambda i: i.v(0, 0.8),
        "Dimension": lambda i: i.v(0.3, 1.5),
    }
    dimensions = ("1D", "2D", "3D", "4D")
    for d in dimensions:
        kinds = [{"noise_type": kind} for kind in each("noise_type", "TexNoise")] if bpy.app.version >= (4, 1) else [{}]
        for kind in kinds:
            for setting in [{"normalize": True}, {"normalize": False}] if bpy.app.version >= (4, 0) else [{}]:
                yield from case("TexNoise", plain("TexNoise", **noise), NOISY, noise_dimensions=d, **kind, **setting)
        if has("TexMusgrave"):
            for kind in each("musgrave_type", "TexMusgrave"):
                build = plain("TexMusgrave", **noise)
                yield from case("TexMusgrave", build, NOISY, musgrave_dimensions=d, musgrave_type=kind)
        voronoi = {
            **noise,
            "Smoothness": lambda i: i.u(0.1, 1),
            "Exponent": lambda i: i.u(0.5, 2.5),
            "Randomness": lambda i: i.v(0.4, 1),
        }
        for feature in each("feature", "TexVoronoi"):
            metrics = (
                each("distance", "TexVoronoi") if feature in {"F1", "F2", "SMOOTH_F1"} and d != "1D" else ["EUCLIDEAN"]
            )
            for metric in metrics:
                build = plain("TexVoronoi", **voronoi)
                yield from case("TexVoronoi", build, NOISY, voronoi_dimensions=d, feature=feature, distance=metric)
        if bpy.app.version >= (4, 0):
            yield from case("TexVoronoi", plain("TexVoronoi", **voronoi), NOISY, voronoi_dimensions=d, normalize=True)
        yield from case(
            "TexWhiteNoise",
            plain("TexWhiteNoise", Vector=steps, W=lambda i: i.n("Math", i.v(0, 8), 1.0, operation="SNAP").outputs[0]),
            NOISY,
            noise_dimensions=d,
        )
    wave = {
        **common,
        "Distortion": lambda i: i.v(0, 2),
        "Detail": lambda i: i.u(1, 3),
        "Detail_Scale": lambda i: i.u(0.8, 1.4),
        "Detail_Roughness": lambda i: i.v(0.3, 0.7),
        "Phase_Offset": lambda i: i.u(0, 1),
    }
    for kind, directions in (
        ("BANDS", each("bands_direction", "TexWave")),
        ("RINGS", each("rings_direction", "TexWave")),
    ):
        for direction in directions:
            for profile in each("wave_profile", "TexWave"):
                settings = {"wave_type": kind, f"{kind.lower()}_direction": direction, "wave_profile": profile}
                yield from case("TexWave", plain("TexWave", **wave), NOISY, **settings)
    for depth in (0, 2, 7):
        build = plain("TexMagic", **{**common, "Distortion": lambda i: i.u(0.2, 1.5)})
        yield from case("TexMagic", build, NOISY, turbulence_depth=depth)
    checker = plain("TexChecker", **common, Color1=lambda i: i.color(), Color2=lambda i: i.wild())
    yield from case("TexChecker", checker)
    for kind in each("gradient_type", "TexGradient"):
        yield from case("TexGradient", plain("TexGradient", Vector=lambda i: i.vector(1.5)), gradient_type=kind)
    brick = {
        **common,
        "Color1": lambda i: i.color(),
        "Color2": lambda i: (0.2, 0.7, 0.1),
        "Mortar": lambda i: (0.1, 0.1, 0.9),
        "Mortar_Size": lambda i: i.u(0.01, 0.2),
        "Mortar_Smooth": lambda i: i.v(0.1, 1),
        "Bias": lambda i: i.v(-0.5, 0.5),
    }
    for offset, frequency, squash in ((0.5, 2, 1.0), (0.3, 3, 1.7)):
        build = plain("TexBrick", **brick)
        yield from case(
            "TexBrick", build, offset=offset, offset_frequency=frequency, squash=squash, squash_frequency=frequency
        )
    if has("TexGabor"):
        for kind in each("gabor_type", "TexGabor"):
            gabor = plain("TexGabor", Vector=common["Vector"], Scale=common["Scale"], Anisotropy=lambda i: i.v(0.2, 1))
            yield from case("TexGabor", gabor, NOISY, gabor_type=kind)
    for kind in ("TexNoise", "TexChecker", "TexGradient", "TexWave", "TexVoronoi", "TexMagic", "TexBrick"):
        for node, name, within, make in case(kind, lambda n, _i, kind: n(kind), NOISY):  # of Generated coordinates
            yield node, f"{name} unlinked", within, make

    def own_mapping(n: Nodes, _i: Inputs, _kind: str) -> Any:
        node = n("TexGradient")
        mapping = node.texture_mapping
        mapping.translation, mapping.rotation, mapping.scale, mapping.mapping_x = (
            (0.1, 0.2, 0),
            (0.2, 0.1, 0.6),
            (1.5, 0.8, 1),
            "Y",
        )
        return node

    for kind in ("POINT", "TEXTURE", "VECTOR", "NORMAL"):

        def own(n: Nodes, i: Inputs, name: str, kind: str = kind) -> Any:
            node = own_mapping(n, i, name)
            node.texture_mapping.vector_type = kind
            return node

        for node, name, within, make in case("TexGradient", own):
            yield node, f"{name} own mapping {kind.lower()}", within, make


def picture(name: str, floats: bool) -> Any:
    if name in bpy.data.images:
        return bpy.data.images[name]
    y, x = np.mgrid[0:8, 0:8] / 8.0
    pixels = np.stack([0.1 + 0.8 * x, 0.2 + 0.7 * y, 0.9 - 0.6 * x * y, 0.3 + 0.6 * x], axis=-1).astype(np.float32)
    made = bpy.data.images.new(name, 8, 8, alpha=True, float_buffer=floats)
    made.pixels.foreach_set(pixels.ravel())
    made.pack()
    return made


def skies() -> Iterator[Case]:
    for kind in each("sky_type", "TexSky"):
        yield from case("TexSky", plain("TexSky", Vector=lambda i: i.direction()), NOISY, sky_type=kind)  # by a table


def images() -> Iterator[Case]:
    for interpolation in each("interpolation", "TexImage"):
        for extension in each("extension", "TexImage"):

            def image(n: Nodes, i: Inputs, kind: str) -> Any:
                return fill(n(kind, image=picture("Bytes", False)), n, Vector=i.vector(1.4))

            yield from case("TexImage", image, interpolation=interpolation, extension=extension)
    for projection in each("projection", "TexImage"):

        def projected(n: Nodes, i: Inputs, kind: str) -> Any:
            coordinates = n("TexCoord").outputs["Object"]
            node = fill(n(kind, image=picture("Floats", True)), n, Vector=coordinates)
            node.projection_blend = 0.4
            return node

        yield from case("TexImage", projected, projection=projection)
    for projection in each("projection", "TexEnvironment"):

        def sky(n: Nodes, i: Inputs, kind: str) -> Any:
            return fill(n(kind, image=picture("Floats", True)), n, Vector=i.vector())

        yield from case("TexEnvironment", sky, projection=projection)


def normals() -> Iterator[Case]:
    for space in each("space", "NormalMap"):
        build = plain("NormalMap", Strength=lambda i: i.v(0.2, 1.4), Color=lambda i: i.color())
        yield from case("NormalMap", build, space=space)

    def bump(n: Nodes, _i: Inputs, _kind: str) -> Any:
        i = Inputs(n, smooth=True)
        height = n("TexNoise", i.vector(), None, 1.5).outputs[0]
        return fill(n("Bump"), n, Strength=i.u(0.2, 1), Distance=i.v(0.2, 0.5), Height=height)

    for invert in (False, True):
        yield from case("Bump", bump, NOISY, invert=invert)
