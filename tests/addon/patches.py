# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader trees that a patch of a picture shows, for test_patches.py.

Each builder is given a `Nodes` of an empty tree and returns the socket whose colour, or the shader, that the patch shows."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np

RGB = (0.9, 0.2, 0.05)  # no two ways to make a grey of it agree


class Nodes:
    """Makes nodes: nodes("Gamma", colour, 2.2, name=...) sets the inputs that are in use, in order, to values or links."""

    def __init__(self, tree: Any) -> None:
        self.tree = tree

    def __call__(self, kind: str, *inputs: Any, **settings: Any) -> Any:
        node = self.tree.nodes.new(kind if kind.startswith("Node") else f"ShaderNode{kind}")
        for name, value in settings.items():
            setattr(node, name, value)
        for socket, value in zip([s for s in node.inputs if s.enabled], inputs):
            self.feed(socket, value)
        return node

    def feed(self, socket: Any, value: Any) -> None:
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        elif value is not None:
            socket.default_value = (*value, 1) if socket.type == "RGBA" and len(value) == 3 else value

    def rgb(self, *color: float) -> Any:
        node = self("RGB")
        node.outputs[0].default_value = (*color, 1)
        return node.outputs[0]

    def number(self, value: float) -> Any:
        node = self("Value")
        node.outputs[0].default_value = value
        return node.outputs[0]

    def vector(self, *value: float) -> Any:
        return self("CombineXYZ", *value).outputs[0]

    def lifted(self, socket: Any) -> Any:
        """5 + a tenth of a number: negative ones, too, can be seen."""
        return self("Math", socket, 0.1, 5.0, operation="MULTIPLY_ADD").outputs[0]

    def lifted_color(self, socket: Any) -> Any:
        return self("VectorMath", socket, (0.1, 0.1, 0.1), (5, 5, 5), operation="MULTIPLY_ADD").outputs[0]

    def group(self, sockets: dict[str, tuple[str, str]], build: Callable[[Nodes, Any, Any], None]) -> Any:
        """A group node; `sockets`: name -> (INPUT or OUTPUT, type). `build` gets the inside and its two ends."""
        tree = bpy.data.node_groups.new("Group", "ShaderNodeTree")
        for name, (in_out, kind) in sockets.items():
            if hasattr(tree, "interface"):
                tree.interface.new_socket(name, in_out=in_out, socket_type=kind)
            else:
                (tree.inputs if in_out == "INPUT" else tree.outputs).new(kind, name)
        inside = Nodes(tree)
        build(inside, inside("NodeGroupInput"), inside("NodeGroupOutput"))
        node = self("Group")
        node.node_tree = tree
        return node


def out(node: Any, index: int = 0) -> Any:
    return [s for s in node.outputs if s.enabled][index]


def muted(node: Any) -> Any:
    node.mute = True
    return node


def mute_link(socket: Any) -> None:
    socket.links[0].is_muted = True


# ---- trees: what is muted, hidden, grouped --------------------------------------------------------------------------


def trees() -> Iterator[tuple[str, Callable[[Nodes], Any]]]:
    own = (0.3, 0.6, 0.1)

    def emission(n: Nodes, color: Any) -> Any:
        node = n("Emission", own, 1.0)
        n.feed(node.inputs["Color"], color)
        return out(node)

    yield "muted math", lambda n: out(muted(n("Math", n.rgb(*RGB), 0.5)))
    yield "muted gamma", lambda n: out(muted(n("Gamma", n.rgb(*RGB), 3.0)))
    yield "muted gamma, not linked", lambda n: emission(n, out(muted(n("Gamma", RGB, 3.0))))
    yield "muted without a way", lambda n: emission(n, out(muted(n("RGB"))))
    yield "muted mix", lambda n: out(muted(n("MixRGB", 0.3, n.rgb(*RGB), n.rgb(0, 1, 0))))
    yield "muted separate", lambda n: out(muted(n("SeparateXYZ", n.rgb(*RGB))), 1)
    yield (
        "muted shader mix",
        lambda n: out(muted(n("MixShader", 0.3, out(n("Emission", RGB)), out(n("Emission", (0, 1, 0)))))),
    )
    yield "muted emission", lambda n: out(n("AddShader", out(muted(n("Emission", RGB))), out(n("Emission", own))))
    yield "muted ramp", lambda n: emission(n, out(muted(n("ValToRGB", n.number(0.3)))))

    def link_muted(n: Nodes) -> Any:
        node = n("Emission", own, 1.0)
        n.feed(node.inputs["Color"], n.rgb(*RGB))
        mute_link(node.inputs["Color"])
        return out(node)

    yield "muted link", link_muted

    def reroute(n: Nodes) -> Any:
        return emission(n, out(n("NodeReroute")))

    yield "reroute of nothing", reroute

    def reroute_typed(n: Nodes) -> Any:
        first, second = n("NodeReroute"), n("NodeReroute")
        n.feed(first.inputs[0], n.rgb(*RGB))
        n.feed(second.inputs[0], out(first))
        return emission(n, out(second))

    yield "reroutes", reroute_typed

    def strength_of_reroute(n: Nodes) -> Any:
        node = n("Emission", own, 2.0)
        n.feed(node.inputs["Strength"], out(n("NodeReroute")))
        return out(node)

    yield "reroute of nothing as a number", strength_of_reroute

    def unavailable(n: Nodes) -> Any:
        node = n("Mix", data_type="RGBA")
        for socket in node.inputs:
            if socket.enabled and socket.type == "RGBA":
                socket.default_value = (*RGB, 1)
        result = emission(n, out(node))
        node.data_type = "FLOAT"
        return result

    yield "link from a socket that is not available", unavailable

    def hidden(n: Nodes) -> Any:
        node = n("SeparateXYZ", n.vector(*RGB))
        result = emission(n, out(node, 1))
        node.outputs[1].hide = True
        return result

    yield "link from a hidden socket", hidden

    def grouped(kind_in: str, kind_out: str, through: bool = True) -> Callable[[Nodes], Any]:
        def build(n: Nodes) -> Any:
            def inside(g: Nodes, given: Any, result: Any) -> None:
                if through:
                    g.feed(result.inputs[0], given.outputs[0])

            node = n.group({"In": ("INPUT", kind_in), "Out": ("OUTPUT", kind_out)}, inside)
            n.feed(node.inputs[0], n.rgb(*RGB))
            return emission(n, out(node))

        return build

    yield "group colour", grouped("NodeSocketColor", "NodeSocketColor")
    yield "group number in", grouped("NodeSocketFloat", "NodeSocketColor")
    yield "group number out", grouped("NodeSocketColor", "NodeSocketFloat")
    yield "group vector", grouped("NodeSocketVector", "NodeSocketColor")
    yield "group vector to number", grouped("NodeSocketVector", "NodeSocketFloat")
    yield "group of nothing", grouped("NodeSocketColor", "NodeSocketColor", through=False)

    def group_own(n: Nodes) -> Any:
        def inside(g: Nodes, given: Any, result: Any) -> None:
            g.feed(result.inputs[0], given.outputs[0])

        node = n.group({"In": ("INPUT", "NodeSocketColor"), "Out": ("OUTPUT", "NodeSocketColor")}, inside)
        node.inputs[0].default_value = (*RGB, 1)
        return emission(n, out(node))

    yield "group with its own value", group_own

    def group_end(n: Nodes) -> Any:
        def inside(g: Nodes, given: Any, result: Any) -> None:
            result.inputs[0].default_value = (*RGB, 1)

        return emission(n, out(n.group({"Out": ("OUTPUT", "NodeSocketColor")}, inside)))

    yield "group whose end has a value", group_end

    def group_no_end(n: Nodes) -> Any:
        def inside(g: Nodes, given: Any, result: Any) -> None:
            g.tree.nodes.remove(result)

        return emission(n, out(n.group({"Out": ("OUTPUT", "NodeSocketColor")}, inside)))

    yield "group without an end", group_no_end

    def group_muted(n: Nodes) -> Any:
        def inside(g: Nodes, given: Any, result: Any) -> None:
            g.feed(result.inputs[0], g.rgb(0, 1, 0))

        node = n.group({"In": ("INPUT", "NodeSocketColor"), "Out": ("OUTPUT", "NodeSocketColor")}, inside)
        n.feed(node.inputs[0], n.rgb(*RGB))
        return emission(n, out(muted(node)))

    yield "muted group", group_muted

    def output_inside(n: Nodes) -> Any:
        def inside(g: Nodes, given: Any, result: Any) -> None:
            g.feed(g("OutputMaterial").inputs["Surface"], out(g("Emission", RGB)))
            g.feed(result.inputs[0], out(g("Emission", (0, 1, 0))))

        return out(n.group({"Out": ("OUTPUT", "NodeSocketShader")}, inside))

    yield "output inside a group", output_inside

    yield "colour to number", lambda n: out(n("Math", n.rgb(*RGB), 0.0, operation="ADD"))
    yield "vector to number", lambda n: out(n("Math", n.vector(*RGB), 0.0, operation="ADD"))
    yield "vector to colour", lambda n: n.vector(*RGB)
    yield "vector to surface", lambda n: n.vector(*RGB)
    yield "colour as a factor", lambda n: out(n("MixRGB", n.rgb(*RGB), (1, 1, 1), (0, 0, 0)))


# ---- functions of numbers and colours -------------------------------------------------------------------------------

OPERANDS = ((0.7, 0.3, 0.2), (-1.4, 2.0, 0.5), (2.6, -1.3, 0.7), (-0.6, -0.4, 0.1))


def enum(kind: str, name: str) -> list[str]:
    node = bpy.data.node_groups.new("Enum", "ShaderNodeTree").nodes.new(f"ShaderNode{kind}")
    return [item.identifier for item in node.bl_rna.properties[name].enum_items]


def functions() -> Iterator[tuple[str, Callable[[Nodes], Any]]]:
    for operation in enum("Math", "operation"):
        for i, operands in enumerate(OPERANDS):
            yield (
                f"math {operation} {i}",
                lambda n, op=operation, x=operands: n.lifted(out(n("Math", *x, operation=op))),
            )
    yield "math clamped", lambda n: out(n("Math", 0.7, 0.6, operation="ADD", use_clamp=True))
    a, b = (0.8, 0.3, 0.1), (0.2, 0.6, 0.9)
    for blend in enum("MixRGB", "blend_type"):
        yield f"mix {blend}", lambda n, x=blend: out(n("MixRGB", 0.4, a, b, blend_type=x))
        for i, (first, second) in enumerate(
            [((0.8, -0.3, 0.1), (-0.2, 0, 0.3)), ((0, 1.5, -0.5), (1.2, 0, 0.5)), ((0.8, 0.3, 0.1), (0, 0, 0))]
        ):
            yield (
                f"mix {blend} of extremes {i}",
                lambda n, x=blend, y=first, z=second: n.lifted_color(
                    out(n("MixRGB", 0.4, n.vector(*y), n.vector(*z), blend_type=x))
                ),
            )
    for blend in ("MIX", "DODGE", "VALUE", "LINEAR_LIGHT"):

        def mix(n: Nodes, blend: str = blend) -> Any:
            node = n("Mix", data_type="RGBA", blend_type=blend)
            for socket, value in zip([s for s in node.inputs if s.enabled], (0.4, a, b)):
                n.feed(socket, value)
            return out(node)

        yield f"new mix {blend}", mix

    def mix_float(n: Nodes) -> Any:
        return out(n("Mix", 1.4, 0.2, 0.8, data_type="FLOAT"))

    yield "mix of numbers", mix_float

    def mix_vector(mode: str) -> Callable[[Nodes], Any]:
        def build(n: Nodes) -> Any:
            node = n("Mix", data_type="VECTOR", factor_mode=mode)
            for socket, value in zip(
                [s for s in node.inputs if s.enabled], (0.4 if mode == "UNIFORM" else (0.1, 0.5, 0.9), a, b)
            ):
                n.feed(socket, value)
            return out(node)

        return build

    yield "mix of vectors", mix_vector("UNIFORM")
    yield "mix of vectors by a vector", mix_vector("NON_UNIFORM")
    yield "gamma", lambda n: out(n("Gamma", RGB, 2.2))
    yield "gamma of negative", lambda n: n.lifted(out(n("Gamma", (-0.5, -0.5, -0.5), 2.0)))
    yield "gamma 0", lambda n: out(n("Gamma", (0.5, 0.1, 0.2), 0.0))
    yield "invert", lambda n: out(n("Invert", 0.7, RGB))
    yield "bright contrast", lambda n: out(n("BrightContrast", RGB, 0.2, 0.6))
    yield "hue saturation value", lambda n: out(n("HueSaturation", 0.3, 1.4, 0.8, 0.7, RGB))
    yield "hue of grey", lambda n: out(n("HueSaturation", 0.3, 1.4, 0.8, 0.7, (0.4, 0.4, 0.4)))
    yield "black and white", lambda n: out(n("RGBToBW", RGB))
    for mode in ("RGB", "HSV", "HSL"):
        for i in range(3):
            yield f"separate {mode} {i}", lambda n, m=mode, j=i: out(n("SeparateColor", RGB, mode=m), j)
        yield f"combine {mode}", lambda n, m=mode: out(n("CombineColor", 0.6, 0.7, 0.4, mode=m))
    yield "separate XYZ", lambda n: out(n("SeparateXYZ", RGB), 1)
    yield "combine XYZ", lambda n: out(n("CombineXYZ", *RGB))
    yield "clamp", lambda n: out(n("Clamp", 0.9, 0.1, 0.6))
    yield "clamp of a range", lambda n: out(n("Clamp", 0.9, 0.6, 0.1, clamp_type="RANGE"))
    for kind in ("LINEAR", "STEPPED", "SMOOTHSTEP", "SMOOTHERSTEP"):
        yield (
            f"map range {kind}",
            lambda n, k=kind: out(n("MapRange", 0.35, 0.1, 0.8, 0.2, 0.9, 4.0, interpolation_type=k)),
        )
    yield "map range beyond", lambda n: out(n("MapRange", 1.5, 0.1, 0.8, 0.2, 0.9, clamp=True))
    yield "map range free", lambda n: out(n("MapRange", 1.5, 0.1, 0.8, 0.2, 0.9, clamp=False))

    def ramp(position: float, interpolation: str, index: int = 0) -> Callable[[Nodes], Any]:
        def build(n: Nodes) -> Any:
            node = n("ValToRGB", position)
            node.color_ramp.interpolation = interpolation
            node.color_ramp.elements[0].color = (0.1, 0.2, 0.9, 0.3)
            node.color_ramp.elements[1].color = (0.8, 0.3, 0.2, 0.7)
            node.color_ramp.elements.new(0.41).color = (0, 1, 0.5, 1)
            return out(node, index)

        return build

    for interpolation in ("LINEAR", "CONSTANT", "EASE", "B_SPLINE"):
        yield f"ramp {interpolation}", ramp(0.23, interpolation)
    yield "ramp alpha", ramp(0.23, "LINEAR", 1)

    def curve(kind: str, *inputs: Any) -> Callable[[Nodes], Any]:
        def build(n: Nodes) -> Any:
            node = n(kind, *inputs)
            for c in node.mapping.curves:
                c.points.new(0.4, 0.7)
            node.mapping.update()
            return out(node)

        return build

    yield "RGB curve", curve("RGBCurve", 0.8, RGB)
    yield "float curve", curve("FloatCurve", 0.8, 0.2)
    zero, u, v, w = (0, 0, 0), (0.7, -0.3, 1.4), (-0.2, 0.6, 0.5), (0.1, 0.5, -0.3)
    for operation in enum("VectorMath", "operation"):
        for name, operands in (("", (u, v, w)), (" by zero", (u, zero, zero)), (" of zero", (zero, v, w))):
            if (operation, name) == ("POWER", " of zero") or (
                operation in {"REFLECT", "REFRACT"} and name == " by zero" and bpy.app.version < (4, 0)
            ):
                continue  # not finite there, and drawn as black

            def vector_math(n: Nodes, operation: str = operation, operands: Any = operands) -> Any:
                node = n("VectorMath", operation=operation)
                for socket, value in zip([s for s in node.inputs if s.enabled], operands):
                    n.feed(socket, 1.3 if socket.type == "VALUE" else value)
                result = out(node)
                if result.type == "VALUE":
                    return n.lifted(result)
                return n.lifted_color(result)

            yield f"vector math {operation}{name}", vector_math
    for kelvin in (500, 1000, 1500, 2700, 4000, 6500, 9000, 15000):
        yield f"blackbody {kelvin}", lambda n, k=kelvin: out(n("Blackbody", float(k)))
    for nanometre in (350, 400, 450, 500, 550, 600, 650, 700):
        yield f"wavelength {nanometre}", lambda n, w=nanometre: out(n("Wavelength", float(w)))
    yield "fresnel", lambda n: out(n("Fresnel", 1.45))
    yield "layer weight", lambda n: out(n("LayerWeight", 0.5))
    yield "layer weight facing", lambda n: out(n("LayerWeight", 0.5), 1)
    yield "light falloff", lambda n: out(n("LightFalloff", 3.0))
    yield "camera ray", lambda n: n("LightPath").outputs["Is Camera Ray"]
    yield "shadow ray", lambda n: n("LightPath").outputs["Is Shadow Ray"]


# ---- images ---------------------------------------------------------------------------------------------------------

TEXELS = np.array([[(230, 40, 20), (30, 200, 90)], [(10, 60, 240), (250, 220, 180)]], np.uint8)
ALPHA = np.array([[64, 255], [128, 0]], np.uint8)


def write_png(path: Path, pixels: np.ndarray) -> None:
    """`pixels`: (height, width, channels) uint8 or uint16, rows from the bottom."""
    height, width, channels = pixels.shape
    raw = b"".join(b"\0" + row.astype(pixels.dtype.newbyteorder(">")).tobytes() for row in pixels[::-1])
    header = struct.pack(">2I5B", width, height, 8 * pixels.itemsize, {1: 0, 2: 4, 3: 2, 4: 6}[channels], 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(raw)), (b"IEND", b""))
    body = (struct.pack(">I", len(data)) + k + data + struct.pack(">I", zlib.crc32(k + data)) for k, data in chunks)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(body))


def make_images(folder: Path) -> dict[str, Any]:
    """Files and images without one, by name."""
    straight = np.concatenate([TEXELS, ALPHA[..., None]], axis=-1)
    made = {}
    files = {"rgb": TEXELS, "rgba": straight, "grey alpha": straight[..., 2:], "deep": TEXELS.astype(np.uint16) * 257}
    files["deep alpha"] = straight.astype(np.uint16) * 257
    for name, pixels in files.items():
        write_png(folder / f"{name}.png", pixels)
        made[name] = bpy.data.images.load(str(folder / f"{name}.png"))
    made["packed"] = bpy.data.images.load(str(folder / "rgba.png"), check_existing=False)
    made["packed"].pack()
    linear = bpy.data.images.new("float", 2, 2, alpha=True, float_buffer=True)
    linear.colorspace_settings.name = "Non-Color"
    values = straight.astype(np.float32) / 255 * (2, 2, 2, 1)
    values[1, 0, :3] = -0.7
    linear.pixels.foreach_set(values.astype(np.float32).ravel())
    made["generated float"] = linear
    linear.file_format, linear.filepath_raw = "OPEN_EXR", str(folder / "float.exr")
    linear.save()
    made["exr"] = bpy.data.images.load(str(folder / "float.exr"), check_existing=False)
    byte = bpy.data.images.new("byte", 2, 2, alpha=True)
    byte.pixels.foreach_set((straight.astype(np.float32) / 255).ravel())
    made["generated"] = byte
    write_png(folder / "tile.1001.png", TEXELS)
    made["udim"] = bpy.data.images.load(str(folder / "tile.1001.png"), check_existing=False)
    made["udim"].source, made["udim"].filepath = "TILED", str(folder / "tile.<UDIM>.png")
    for frame in range(1, 6):
        write_png(folder / f"frame_{frame:03}.png", np.roll(TEXELS, frame, axis=-1) // frame)
    made["sequence"] = bpy.data.images.load(str(folder / "frame_001.png"))
    made["sequence"].source = "SEQUENCE"
    return made


def image_patches(folder: Path) -> Iterator[tuple[str, Callable[[Nodes], Any]]]:
    image = make_images(folder)

    def texture(
        n: Nodes, name: str, location: Any = (0, 0, 0), scale: Any = (1, 1, 1), kind: str = "POINT", **settings: Any
    ) -> Any:
        node = n("TexImage", image=image[name], **settings)
        mapping = n("Mapping", vector_type=kind)
        n.feed(mapping.inputs["Vector"], n("TexCoord").outputs["UV"])
        for key, value in (("Location", location), ("Scale", scale), ("Rotation", (0, 0, 0.4))):
            socket = mapping.inputs.get(key)
            if socket is not None and socket.enabled and (key != "Rotation" or kind != "POINT"):
                n.feed(socket, value)
        n.feed(node.inputs["Vector"], mapping.outputs[0])
        return node

    wide = {"location": (-0.5, -0.75, 0), "scale": (2, 2, 1)}
    for name in image:
        yield f"image {name}", lambda n, x=name: out(texture(n, x))
        yield f"alpha {name}", lambda n, x=name: out(texture(n, x), 1)

        def both(n: Nodes, name: str = name) -> Any:
            node = texture(n, name)
            return out(n("MixRGB", out(node, 1), (0, 0, 1), out(node)))

        yield f"colour and alpha {name}", both
    for interpolation in ("Closest", "Cubic", "Smart"):
        yield f"{interpolation}", lambda n, x=interpolation: out(texture(n, "rgb", interpolation=x))
    extensions = [item.identifier for item in bpy.types.ShaderNodeTexImage.bl_rna.properties["extension"].enum_items]
    for extension in extensions:
        for interpolation in ("Closest", "Linear", "Cubic"):
            yield (
                f"{extension} {interpolation}",
                lambda n, x=extension, y=interpolation: out(texture(n, "rgb", **wide, extension=x, interpolation=y)),
            )
    for kind in ("POINT", "TEXTURE", "VECTOR", "NORMAL"):
        yield (
            f"mapping {kind}",
            lambda n, x=kind: out(texture(n, "rgb", (0.2, 0.1, 0.3), (1.5, 0.8, 2), x, interpolation="Closest")),
        )

    def own_mapping(kind: str) -> Callable[[Nodes], Any]:
        def build(n: Nodes) -> Any:
            node = texture(n, "rgb", interpolation="Closest")
            mapping = node.texture_mapping
            mapping.vector_type, mapping.translation, mapping.scale = kind, (0.2, 0.1, 0.3), (1.5, 0.8, 2)
            mapping.rotation = (0, 0, 0.4)
            return out(node)

        return build

    for kind in ("POINT", "TEXTURE", "VECTOR", "NORMAL"):
        yield f"own mapping {kind}", own_mapping(kind)

    def swapped(n: Nodes) -> Any:
        node = texture(n, "rgb", interpolation="Closest")
        node.texture_mapping.mapping_x, node.texture_mapping.mapping_y = "Y", "X"
        return out(node)

    yield "own mapping of axes", swapped

    def limited(n: Nodes) -> Any:
        node = texture(n, "rgb", interpolation="Closest")
        mapping = node.texture_mapping
        mapping.use_min, mapping.use_max, mapping.min, mapping.max = True, True, (0.6, 0.1, 0), (0.9, 0.3, 1)
        return out(node)

    yield "own mapping with limits", limited

    def own_colours(n: Nodes) -> Any:
        node = texture(n, "rgb")
        node.color_mapping.brightness, node.color_mapping.contrast = 0.5, 1.5
        node.color_mapping.blend_factor, node.color_mapping.blend_color = 0.5, (0, 1, 0)
        return out(node)

    yield "own colours", own_colours

    def alpha_mode(name: str, mode: str, index: int, other: bool) -> Callable[[Nodes], Any]:
        def build(n: Nodes) -> Any:
            node = texture(n, name)
            node.image = node.image.copy()
            node.image.alpha_mode = mode
            return out(n("MixRGB", out(node, 1), (0, 0, 1), out(node))) if other else out(node, index)

        return build

    for mode in ("STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE"):
        for name in ("rgba", "exr", "deep alpha"):
            yield f"{mode} {name} colour", alpha_mode(name, mode, 0, False)
            yield f"{mode} {name} alpha", alpha_mode(name, mode, 1, False)
            yield f"{mode} {name} both", alpha_mode(name, mode, 0, True)

    def data(name: str, space: str) -> Callable[[Nodes], Any]:
        def build(n: Nodes) -> Any:
            node = texture(n, name)
            node.image = node.image.copy()
            node.image.colorspace_settings.name = space
            return out(node)

        return build

    for name in ("rgba", "exr", "deep alpha"):
        yield f"Non-Color {name}", data(name, "Non-Color")
        yield f"sRGB {name}", data(name, "sRGB")

    def behind(n: Nodes, *swap: bool) -> Any:
        node = out(texture(n, "rgb"))
        return out(n("MixRGB", 0.3, (1, 1, 1) if swap else node, node if swap else (1, 1, 1)))

    yield "mixed with white", lambda n: behind(n)
    yield "white mixed with it", lambda n: behind(n, True)
    yield "image's gamma", lambda n: out(n("Gamma", out(texture(n, "rgb")), 2.0))
    yield "image times a colour", lambda n: out(n("MixRGB", 1.0, out(texture(n, "rgb")), RGB, blend_type="MULTIPLY"))
    yield "image of a ramp", lambda n: ramped(n, 0.3)
    yield "image of a ramp that differs between", lambda n: ramped(n, 0.32)

    def ramped(n: Nodes, position: float) -> Any:
        node = n("ValToRGB", out(texture(n, "rgb", interpolation="Closest")))
        node.color_ramp.interpolation = "CONSTANT"
        node.color_ramp.elements.new(position).color = (0.2, 0.9, 0.4, 1)
        return out(node)

    def sequence(frame_start: int, offset: int, duration: int, cyclic: bool) -> Callable[[Nodes], Any]:
        def build(n: Nodes) -> Any:
            node = texture(n, "sequence", interpolation="Closest")
            user = node.image_user
            user.frame_start, user.frame_offset, user.frame_duration = frame_start, offset, duration
            user.use_cyclic, user.use_auto_refresh = cyclic, True
            return out(node)

        return build

    for i, settings in enumerate(
        ((1, 0, 5, False), (1, 2, 3, False), (2, 0, 3, True), (-7, 0, 3, True), (5, 0, 9, False))
    ):
        yield f"sequence {i}", sequence(*settings)
