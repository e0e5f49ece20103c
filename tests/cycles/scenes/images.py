# SPDX-License-Identifier: GPL-3.0-or-later
"""Image textures: what is stored, how it is looked up, and what alpha does. Seen from above under a white sky: the image is the picture."""

import struct
from pathlib import Path

import bpy
import numpy as np
from stage import (
    add,
    ball,
    camera,
    checker,
    diffuse,
    face_on,
    feed,
    floor,
    gradient,
    image,
    lamp,
    material,
    painted,
    saved_image,
    scene,
    sheet,
    sky,
)
from wardmis import compat

SAMPLES = 16  # of next to no noise
SELDOM = {
    "alpha_exr_packed_in_all_modes",
    "alpha_mixed_by_nothing_and_clamped",
    "alpha_of_a_like_node",
    "alpha_of_an_unlike_node",
    "alpha_tga",
    "alpha_tga_packed",
    "alpha_tiff_16_bits",
    "alpha_tiff_16_bits_of_multiplied",
    "alpha_tiff_of_multiplied",
    "alpha_times_one",
    "alpha_times_zero",
    "alpha_to_another_renderer",
    "alpha_to_no_node",
    "packed_premultiplied_16_bits",
    "packed_premultiplied_alpha",
    "packed_straight_16_bits",
}
CORNERS = checker((0.9, 0.1, 0.1), (0.1, 0.8, 0.2), (0.1, 0.2, 0.9), (0.8, 0.8, 0.1))


def shows(picture, settings=None, output="Color", mapping=None, user=None):
    """A sheet with this image, seen from above. `user`: settings of which frame it is."""
    face_on()
    sheet(painted(lambda tree: texture(tree, picture, settings, mapping, user).outputs[output]))


def texture(tree, picture, settings=None, mapping=None, user=None):
    node = add(tree, "TexImage", {"image": picture, **(settings or {})})
    for name, value in (user or {}).items():
        setattr(node.image_user, name, value)
    vector = add(tree, "TexCoord").outputs["UV"]
    if mapping is not None:
        kind, inputs = mapping
        mapped = add(tree, "Mapping", {"vector_type": kind}, Vector=vector)
        for name, value in inputs.items():
            if name in mapped.inputs and mapped.inputs[name].enabled:
                feed(tree, mapped.inputs[name], value)
        vector = mapped.outputs[0]
    tree.links.new(vector, node.inputs["Vector"])
    return node


def with_alpha(value=0.25):
    """Alpha from 0 to 1 over the picture, and in its other half one number."""
    pixels = np.concatenate([gradient(), np.full((8, 8, 1), value)], axis=-1)
    pixels[:4, :, 3] = np.linspace(0, 1, 8)
    return pixels


@scene
def colors():
    shows(image("Colours", gradient()))


@scene
def floats():
    shows(image("Floats", 2 * gradient() - 0.3, floats=True))


@scene
def file_8_bits():
    shows(saved_image("eight", gradient()))


@scene
def file_16_bits():
    shows(saved_image("sixteen", gradient(), depth="16"))


@scene
def file_exr():
    shows(saved_image("half", 1.5 * gradient(), "exr"))


@scene
def non_color():
    picture = saved_image("raw", gradient())
    picture.colorspace_settings.name = "Non-Color"
    shows(picture)


@scene
def missing():
    """Magenta, there as here."""
    picture = bpy.data.images.new("gone", 4, 4)
    picture.source, picture.filepath = "FILE", "//no-such-file.png"
    shows(picture)


@scene
def missing_light():
    """Of a sky, a lamp and a surface, too: of no image, of a file that is not there, and clipped."""
    gone = bpy.data.images.new("gone", 4, 4)
    gone.source, gone.filepath = "FILE", "//no-such-file.png"
    tree = sky((1, 1, 1), 0.2)
    lost = add(tree, "TexEnvironment", {"image": gone})
    tree.links.new(lost.outputs[0], tree.nodes["Background"].inputs["Color"])
    for place, picture in ((-2, None), (2, gone)):
        light = lamp("AREA", (place, -2, 3), 60, size=1)
        light.data.use_nodes = True
        tree = light.data.node_tree
        lost = add(tree, "TexImage", {"image": picture})
        vector = add(tree, "TexCoord").outputs["Normal"]
        tree.links.new(vector, lost.inputs["Vector"])
        tree.links.new(lost.outputs[0], tree.nodes["Emission"].inputs["Color"])
    floor()
    of, tree, output = material()
    scaled = add(tree, "Mapping", Vector=add(tree, "TexCoord").outputs["Object"], Scale=(0.4, 0.4, 0.4))
    lost = add(tree, "TexImage", {"image": gone, "extension": "CLIP"}, Vector=scaled.outputs[0])
    light = add(tree, "Emission", Color=lost.outputs[0], Strength=2.0)
    tree.links.new(light.outputs[0], output.inputs["Surface"])
    ball(of)
    camera()


@scene
def missing_decal():
    """Clipped, it is magenta in its place alone, and its alpha shows what is below elsewhere."""
    picture = bpy.data.images.new("gone", 4, 4)
    picture.source, picture.filepath = "FILE", "//no-such-file.png"
    face_on()

    def build(tree):
        node = texture(
            tree, picture, {"extension": "CLIP"}, ("POINT", {"Location": (-0.5, -0.5, 0), "Scale": (2, 2, 1)})
        )
        return mixed(tree, node.outputs["Alpha"], (0.2, 0.6, 0.3, 1), node.outputs["Color"])

    sheet(painted(build))


@scene
def no_image():
    shows(None)


@scene
def linear():
    """Two pixels across: what lies between them shows in which space they are mixed."""
    shows(image("Corners", CORNERS))


@scene
def closest():
    shows(image("Corners", CORNERS), {"interpolation": "Closest"})


@scene
def cubic():
    shows(image("Corners", CORNERS), {"interpolation": "Cubic"})


@scene
def smart():
    shows(image("Corners", CORNERS), {"interpolation": "Smart"})


def alpha(mode, output="Color", suffix="png"):
    picture = saved_image(f"alpha-{mode}", with_alpha(), suffix)
    picture.alpha_mode = mode
    shows(picture, output=output)


@scene
def alpha_straight():
    alpha("STRAIGHT")


@scene
def alpha_premultiplied():
    alpha("PREMUL")


@scene
def alpha_channel_packed():
    alpha("CHANNEL_PACKED")


@scene
def alpha_none():
    alpha("NONE")


@scene
def alpha_exr():
    alpha("PREMUL", suffix="exr")


@scene
def alpha_exr_straight():
    alpha("STRAIGHT", suffix="exr")


@scene
def alpha_exr_packed():
    """Of a file within the Blender file, set to either mode."""
    face_on()
    for x, mode in ((-1, "STRAIGHT"), (1, "PREMUL")):
        picture = saved_image(f"packed-{mode}", with_alpha(), "exr")
        picture.alpha_mode = mode
        picture.pack()
        made = sheet(painted(lambda tree, picture=picture: texture(tree, picture).outputs["Color"]), size=0.95)
        made.location.x = x


@scene
def alpha_16_bits():
    """The same of integers, the left one within the Blender file."""
    face_on()
    for x, packed in ((-1, True), (1, False)):
        picture = saved_image(f"sixteen-{packed}", with_alpha(), depth="16")
        picture.alpha_mode = "STRAIGHT"
        if packed:
            picture.pack()
        made = sheet(painted(lambda tree, picture=picture: texture(tree, picture).outputs["Color"]), size=0.95)
        made.location.x = x


@scene
def alpha_floats():
    """Of pixels that are no file's, set to either mode."""
    face_on()
    for x, mode in ((-1, "STRAIGHT"), (1, "PREMUL")):
        picture = bpy.data.images.new(f"floats-{mode}", 8, 8, alpha=True, float_buffer=True)
        picture.pixels.foreach_set(with_alpha().astype(np.float32).ravel())
        picture.alpha_mode = mode
        made = sheet(painted(lambda tree, picture=picture: texture(tree, picture).outputs["Color"]), size=0.95)
        made.location.x = x


@scene
def alpha_exr_behind_nodes():
    """Which are given what alpha has made of the colours."""
    face_on()
    for x, mode in ((-1, "STRAIGHT"), (1, "PREMUL")):
        pixels = with_alpha()
        pixels[:4, :, 3] = np.linspace(0.1, 1, 8)  # Blender, which multiplies, knows no colours where alpha is 0
        picture = saved_image(f"behind-{mode}", pixels, "exr")
        picture.alpha_mode = mode

        def build(tree, picture=picture):
            color = texture(tree, picture, {"interpolation": "Closest"}).outputs["Color"]
            return add(tree, "Gamma", Color=color, Gamma=2.0).outputs[0]

        made = sheet(painted(build), size=0.95)
        made.location.x = x


@scene
def alpha_exr_used():
    """Where alpha is used, too."""
    face_on()
    for x, mode in ((-1, "STRAIGHT"), (1, "PREMUL")):
        picture = saved_image(f"used-{mode}", with_alpha(), "exr")
        picture.alpha_mode = mode

        def build(tree, picture=picture):
            node = texture(tree, picture, {"interpolation": "Closest"})
            return mixed(tree, node.outputs["Alpha"], (0.2, 0.2, 0.2, 1), node.outputs["Color"])

        made = sheet(painted(build), size=0.95)
        made.location.x = x


def tiff(name, rgba, bits, extra):
    """A file of the values as they are, whose alpha is 0: not said to be one, 1: said to have multiplied the colours, 2: not to have."""
    height, width, _ = rgba.shape
    values = np.rint(rgba[::-1] * (2**bits - 1)).astype(f"<u{bits // 8}").tobytes()
    after, entries = 8 + 2 + 12 * 10 + 4, []
    for tag, kind, number, value in (
        (256, 3, 1, width),
        (257, 3, 1, height),
        (258, 3, 4, after),  # bits of each channel
        (259, 3, 1, 1),  # not compressed
        (262, 3, 1, 2),  # RGB
        (273, 4, 1, after + 8),
        (277, 3, 1, 4),
        (278, 3, 1, height),
        (279, 4, 1, len(values)),
        (338, 3, 1, extra),
    ):
        entries.append(struct.pack("<HHII", tag, kind, number, value))
    path = Path(bpy.app.tempdir) / f"{name}.tif"
    directory = struct.pack("<2sHIH", b"II", 42, 8, len(entries)) + b"".join(entries) + struct.pack("<I", 0)
    path.write_bytes(directory + struct.pack("<4H", *[bits] * 4) + values)
    return bpy.data.images.load(str(path))


def in_all_modes(make):
    """Sheets of `make(mode)`, whose colours are multiplied by alpha: below with alpha used as well."""
    face_on()
    for x, mode in ((-1.3, "STRAIGHT"), (0, "PREMUL"), (1.3, "CHANNEL_PACKED")):
        picture = make(mode)
        picture.alpha_mode = mode
        for y in (0.7, -0.7):

            def build(tree, y=y, picture=picture):
                node = texture(tree, picture, {"interpolation": "Closest"})
                color, alpha = node.outputs["Color"], node.outputs["Alpha"]
                return color if y > 0 else mixed(tree, alpha, (0.2, 0.2, 0.2, 1), color)

            made = sheet(painted(build), size=0.6)
            made.location = x, y, 0


def multiplied():
    pixels = with_alpha()
    pixels[..., :3] *= pixels[..., 3:]
    return pixels


@scene
def alpha_tiff():
    in_all_modes(lambda mode: tiff(mode, multiplied(), 8, 2))


@scene
def alpha_tiff_of_multiplied():
    in_all_modes(lambda mode: tiff(mode, multiplied(), 8, 1))


@scene
def alpha_tiff_16_bits():
    in_all_modes(lambda mode: tiff(mode, multiplied(), 16, 2))


@scene
def alpha_tiff_16_bits_of_multiplied():
    in_all_modes(lambda mode: tiff(mode, multiplied(), 16, 1))


@scene
def alpha_tga():
    in_all_modes(lambda mode: saved_image(mode, multiplied(), "tga"))


@scene
def alpha_tga_packed():
    def make(mode):
        picture = saved_image(mode, multiplied(), "tga")
        picture.alpha_mode = mode
        picture.pack()
        return picture

    in_all_modes(make)


@scene
def alpha_exr_packed_in_all_modes():
    def make(mode):
        picture = saved_image(mode, multiplied(), "exr")
        picture.alpha_mode = mode
        picture.pack()
        return picture

    in_all_modes(make)


@scene
def alpha_none_used():
    """It is 1 then; beyond the image, which is clipped, it is 0."""
    face_on()
    picture = saved_image("none-used", with_alpha())
    picture.alpha_mode = "NONE"

    def build(tree):
        coordinates = add(tree, "Mapping", Vector=add(tree, "TexCoord").outputs["UV"], Scale=(1.5, 1, 1))
        node = texture(tree, picture, {"interpolation": "Closest", "extension": "CLIP"})
        tree.links.new(coordinates.outputs[0], node.inputs[0])
        return mixed(tree, node.outputs["Alpha"], (0.2, 0.2, 0.2, 1), node.outputs["Color"])

    sheet(painted(build))


@scene
def alpha_alone():
    alpha("STRAIGHT", output="Alpha")


@scene(within=0.06, why="nodes calculate with pixels, before these are filtered")
def alpha_with_color():
    """Where alpha is used, the colour is not multiplied by it."""
    face_on()
    picture = saved_image("both", with_alpha())

    def build(tree):
        node = texture(tree, picture)
        return add(
            tree,
            "MixRGB",
            {"blend_type": "MIX"},
            Fac=node.outputs["Alpha"],
            Color1=(0.2, 0.2, 0.2, 1),
            Color2=node.outputs["Color"],
        ).outputs[0]

    sheet(painted(build))


def extended(mode):
    shows(
        image("Corners", CORNERS),
        {"extension": mode},
        mapping=("POINT", {"Scale": (1.8, 1.8, 1), "Location": (-0.4, -0.3, 0)}),
    )


@scene
def repeat():
    extended("REPEAT")


@scene
def extend():
    extended("EXTEND")


@scene
def clip():
    extended("CLIP")


@scene(since=(4, 0))
def mirror():
    extended("MIRROR")


MAPPED = {"Location": (0.2, -0.1, 0.3), "Rotation": (0.1, 0.2, 0.7), "Scale": (1.5, 0.7, 2)}


@scene
def mapping_point():
    shows(image("Colours", gradient(4, 4)), mapping=("POINT", MAPPED))


@scene
def mapping_texture():
    shows(image("Colours", gradient(4, 4)), mapping=("TEXTURE", MAPPED))


@scene
def mapping_vector():
    shows(image("Colours", gradient(4, 4)), mapping=("VECTOR", MAPPED))


@scene
def mapping_normal():
    shows(image("Colours", gradient(4, 4)), mapping=("NORMAL", MAPPED))


@scene
def own_mapping():
    """Of the image node itself, which the interface hides: files of old have it."""
    face_on()

    def build(tree):
        node = texture(tree, image("Colours", gradient(4, 4)))
        node.texture_mapping.scale, node.texture_mapping.translation = (1.4, 0.6, 1), (0.2, 0.1, 0)
        node.texture_mapping.rotation = 0, 0, 0.5
        return node.outputs["Color"]

    sheet(painted(build))


@scene
def own_colors():
    face_on()

    def build(tree):
        node = texture(tree, image("Colours", gradient(4, 4)))
        node.color_mapping.brightness, node.color_mapping.contrast, node.color_mapping.saturation = 0.7, 1.4, 0.5
        return node.outputs["Color"]

    sheet(painted(build))


@scene
def active_map():
    """The map that is chosen for rendering, not the first one."""
    face_on()
    picture = image("Colours", gradient(4, 4))
    made = sheet(painted(lambda tree: texture(tree, picture).outputs["Color"]), maps=("UVMap", "Turned"))
    made.data.uv_layers["Turned"].active_render = True


@scene
def sequence():
    """The frame's own file."""
    for frame in (1, 2, 3):
        bpy.data.images.remove(saved_image(f"frame_{frame:04d}", gradient() * frame / 3))
    picture = bpy.data.images.load(f"{bpy.app.tempdir}/frame_0001.png")
    picture.source = "SEQUENCE"
    bpy.context.scene.frame_set(2)
    face_on()

    def build(tree):
        node = texture(tree, picture)
        node.image_user.frame_duration, node.image_user.frame_start, node.image_user.use_auto_refresh = 3, 1, True
        return node.outputs["Color"]

    sheet(painted(build))


@scene
def sequence_of_tga():
    """Files that the renderer does not read; Blender holds the pixels of another frame."""
    for frame in (1, 2, 3):
        bpy.data.images.remove(saved_image(f"tga_{frame:04d}", gradient() * frame / 3, "tga"))
    picture = bpy.data.images.load(f"{bpy.app.tempdir}/tga_0001.tga")
    picture.source = "SEQUENCE"
    shows(picture, user={"frame_duration": 3, "frame_offset": 1})


def filmed(name, pictures, **settings):
    """A movie without losses of these pictures, a frame each; in a scene of its own, by Blender's sequencer."""
    stage = bpy.context.scene
    film = bpy.data.scenes.new("Film")
    height, width = pictures[0].shape[:2]
    film.render.resolution_x, film.render.resolution_y, film.render.resolution_percentage = width, height, 100
    film.frame_start, film.frame_end, film.render.use_sequencer = 1, len(pictures), True
    film.view_settings.view_transform, film.render.engine = "Standard", "CYCLES"
    output, path = film.render.image_settings, f"{bpy.app.tempdir}/{name}.mkv"
    if hasattr(output, "media_type"):
        output.media_type = "VIDEO"
    output.file_format = "FFMPEG"
    film.render.ffmpeg.format, film.render.ffmpeg.codec = "MKV", "FFV1"
    for key, value in settings.items():
        setattr(output, key, value)
    film.render.use_file_extension, film.render.filepath = False, path
    editor = film.sequence_editor_create()
    strips = editor.strips if hasattr(editor, "strips") else editor.sequences
    for frame, pixels in enumerate(pictures, 1):
        still = saved_image(f"{name}-{frame}", pixels)
        strips.new_image(f"{frame}", bpy.path.abspath(still.filepath), channel=1, frame_start=frame)
        bpy.data.images.remove(still)
    bpy.ops.render.render(animation=True, scene=film.name)
    bpy.data.scenes.remove(film)
    bpy.context.window.scene = stage
    return bpy.data.images.load(path)


def steps(alpha=None):
    """Four pictures of 32 x 16 pixels."""
    pixels = np.repeat(np.repeat(gradient(), 2, axis=0), 4, axis=1)
    if alpha is not None:
        pixels = np.concatenate([pixels, np.full((16, 32, 1), alpha)], axis=-1)
    return [pixels * (0.4 + 0.2 * k) ** np.array([1, 2, 1, 1])[: pixels.shape[-1]] for k in range(4)]


@scene
def movie():
    """The second picture, of which Blender holds none: nobody has looked at the movie."""
    bpy.context.scene.frame_set(7)
    user = {"frame_start": 4, "frame_duration": 3, "frame_offset": -1, "use_auto_refresh": True}
    shows(filmed("film", steps()), user=user)


@scene
def movie_again_and_again():
    """The second picture, after five times three; the values are no colours."""
    bpy.context.scene.frame_set(17)
    picture = filmed("again", steps())
    picture.colorspace_settings.name = "Non-Color"
    shows(picture, user={"frame_duration": 3, "use_cyclic": True})


@scene
def movie_with_alpha():
    """The last picture, beyond which there is none."""
    bpy.context.scene.frame_set(9)
    shows(filmed("through", steps(0.5), color_mode="RGBA"), user={"frame_duration": 9})


@scene
def movie_as_a_sky():
    """Blender's user of an environment counts as that of an image does."""
    bpy.context.scene.frame_set(2)
    picture = filmed("sky", steps())
    face_on()
    tree = bpy.context.scene.world.node_tree
    node = add(tree, "TexEnvironment", {"image": picture})
    node.image_user.frame_duration = 4
    background = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeBackground")
    tree.links.new(node.outputs[0], background.inputs[0])
    sheet(diffuse())


@scene
def udim_of_one_tile():
    bpy.data.images.remove(saved_image("tile.1001", gradient()))
    picture = bpy.data.images.load(f"{bpy.app.tempdir}/tile.1001.png")
    picture.source = "TILED"
    shows(picture)


def tiled(*numbers):
    """An image of UDIM tiles of different colours."""
    made = [(n, saved_image(f"tiles.{n}", gradient(8, 8) * (0.3 + 0.2 * k))) for k, n in enumerate(numbers)]
    for _, each in made:
        bpy.data.images.remove(each)
    picture = bpy.data.images.load(f"{bpy.app.tempdir}/tiles.{numbers[0]}.png")
    picture.source, picture.filepath = "TILED", f"{bpy.app.tempdir}/tiles.<UDIM>.png"
    for number in numbers[1:]:
        picture.tiles.new(number)
    return picture


def over_tiles(picture):
    """UVs from -0.3 to 2.2: beside the tiles, too."""
    face_on()

    def build(tree):
        moved = add(
            tree, "Mapping", Vector=add(tree, "TexCoord").outputs["UV"], Location=(-0.3, -0.3, 0), Scale=(2.5, 2.5, 1)
        )
        node = texture(tree, picture)
        tree.links.new(moved.outputs[0], node.inputs[0])
        return node.outputs["Color"]

    sheet(painted(build))


@scene
def udim():
    over_tiles(tiled(1001, 1002, 1012))


@scene
def udim_packed():
    picture = tiled(1001, 1011, 1012)
    picture.pack()
    over_tiles(picture)


@scene
def generated():
    """Blender's own grid of colours."""
    picture = bpy.data.images.new("Grid", 32, 32)
    picture.source, picture.generated_type = "GENERATED", "COLOR_GRID"
    shows(picture)


@scene
def generated_plain():
    picture = bpy.data.images.new("Plain", 32, 32)
    picture.source, picture.generated_color = "GENERATED", (0.3, 0.5, 0.7, 1)
    shows(picture)


def mixed(tree, factor, first, second):
    return add(tree, "MixRGB", Fac=factor, Color1=first, Color2=second).outputs[0]


@scene
def mixes_either_way():
    """Two materials that mix one image with white, one this way and one that way round."""
    face_on()
    picture, white = image("Colours", gradient(4, 4)), (1, 1, 1, 1)
    for x, swapped in ((-1, False), (1, True)):

        def build(tree, swapped=swapped):
            color = texture(tree, picture).outputs["Color"]
            return mixed(tree, 0.3, white, color) if swapped else mixed(tree, 0.3, color, white)

        made = sheet(painted(build), size=0.95)
        made.location.x = x


@scene
def two_images():
    """Products and sums of two pictures with one set of coordinates."""
    face_on()
    first, second = image("One", gradient(4, 4)), image("Two", gradient(4, 4)[::-1])
    sheet(painted(lambda tree: mixed(tree, 0.4, texture(tree, first).outputs[0], texture(tree, second).outputs[0])))


def ramp(tree, value, stops):
    node = add(tree, "ValToRGB", Fac=value)
    elements = node.color_ramp.elements
    while len(elements) < len(stops):
        elements.new(0.5)
    for element, (position, color) in zip(elements, stops):
        element.position, element.color = position, (*color, 1)
    return node.outputs["Color"]


@scene
def ramps():
    """Two ramps that agree at every sixteenth of their length and differ between."""
    face_on()
    picture = image("Colours", gradient(16, 16))
    black, white = (0, 0, 0), (1, 1, 1)
    for x, color in ((-1, white), (1, (1, 0.3, 0))):
        stops = [(0.2, black), (0.4501, black), (0.46, color), (0.49, color), (0.4999, black), (0.8, (0.5, 0.5, 0.5))]

        def build(tree, stops=stops):
            return ramp(
                tree, add(tree, "SeparateColor", Color=texture(tree, picture).outputs["Color"]).outputs[0], stops
            )

        made = sheet(painted(build), size=0.95)
        made.location.x = x


@scene
def emissive():
    """An image that shines."""
    from stage import material

    face_on()
    made, tree, output = material()
    shader = add(tree, "Emission", Color=texture(tree, image("Colours", gradient(4, 4))).outputs["Color"], Strength=2.0)
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    sheet(made, divisions=8, size=1.2)
    ground = sheet(diffuse(), size=3)
    ground.location.z = -0.5


@scene
def without_uvs():
    """A mesh without a UV map shows the image's corner."""
    face_on()
    sheet(painted(lambda tree: texture(tree, image("Colours", gradient(4, 4))).outputs["Color"]), maps=())


@scene(within=0.2, why="nodes calculate with pixels, before these are filtered")
def calculated():
    """Magnified to the utmost; of what is linear in the colour it does not matter."""
    face_on()

    def build(tree):
        color = texture(tree, image("Colours", gradient(4, 4), floats=True)).outputs["Color"]
        return add(tree, "Gamma", Color=color, Gamma=3.0).outputs[0]

    sheet(painted(build))


def with_alpha_to(use, pixels=None, settings=None):
    """An image whose colour is shown, and whose alpha goes where `use(tree, node)` leads it; that may return another colour."""
    face_on()
    picture = saved_image("used", with_alpha() if pixels is None else pixels)

    def build(tree):
        node = texture(tree, picture, settings)
        return use(tree, node) or node.outputs["Color"]

    sheet(painted(build))


def mixed_in(**inputs):
    """Mixed with alpha so that Cycles finds that there is nothing to mix."""
    return lambda tree, node: add(
        tree,
        "MixRGB",
        {key: inputs[key] for key in ("blend_type", "use_clamp") if key in inputs},
        Color1=node.outputs["Color"],
        Color2=inputs.get("Color2", node.outputs["Alpha"]),
        Fac=inputs.get("Fac", node.outputs["Alpha"]),
    ).outputs[0]


@scene
def alpha_to_no_node():
    """A reroute that ends, and a node that nothing hangs on."""

    def use(tree, node):
        tree.links.new(node.outputs["Alpha"], tree.nodes.new("NodeReroute").inputs[0])
        add(tree, "Math", Value=node.outputs["Alpha"])

    with_alpha_to(use)


@scene
def alpha_to_another_renderer():
    def use(tree, node):
        output = add(tree, "OutputMaterial", {"target": "EEVEE"})
        shader = add(tree, "Emission", Strength=node.outputs["Alpha"])
        tree.links.new(shader.outputs[0], output.inputs["Surface"])

    with_alpha_to(use)


@scene
def alpha_out_of_a_group():
    """Whose alpha nobody takes."""
    face_on()
    picture = saved_image("grouped", with_alpha())

    def build(tree):
        group = bpy.data.node_groups.new("Group", "ShaderNodeTree")
        inner, end = texture(group, picture), None
        for name, kind in (("Color", "NodeSocketColor"), ("Alpha", "NodeSocketFloat")):
            compat.add_group_socket(group, name, kind, "OUTPUT")
        end = group.nodes.new("NodeGroupOutput")
        for name in ("Color", "Alpha"):
            group.links.new(inner.outputs[name], end.inputs[name])
        used = tree.nodes.new("ShaderNodeGroup")
        used.node_tree = group
        return used.outputs["Color"]

    sheet(painted(build))


@scene
def alpha_mixed_by_nothing():
    with_alpha_to(mixed_in(Fac=0.0))


@scene
def alpha_mixed_by_nothing_and_clamped():
    with_alpha_to(mixed_in(Fac=0.0, use_clamp=True))


@scene
def alpha_times_one():
    """The factor of a multiplication by one."""
    with_alpha_to(mixed_in(blend_type="MULTIPLY", Color2=(1, 1, 1, 1)))


@scene
def alpha_times_zero():
    """Two nodes that make nothing of it: what is left of it is a constant, by which the other mixes nothing."""

    def use(tree, node):
        none = add(tree, "Math", {"operation": "MULTIPLY"}, Value=node.outputs["Alpha"])
        sum_ = add(tree, "Math", {"operation": "ADD"}, Value=none.outputs[0])
        none.inputs[1].default_value = sum_.inputs[1].default_value = 0
        return mixed_in(Fac=sum_.outputs[0])(tree, node)

    with_alpha_to(use)


@scene
def alpha_of_a_muted_mix():
    def use(tree, node):
        mixed = mixed_in()(tree, node)
        mixed.node.mute = True
        return mixed

    with_alpha_to(use)


@scene
def alpha_of_a_shader_that_is_black():
    """Mixed with an emission of no strength, whose colour it is."""
    face_on()
    picture = saved_image("black", with_alpha())
    made, tree, output = material()
    node = texture(tree, picture)
    black = add(tree, "Emission", Color=node.outputs["Alpha"], Strength=0.0)
    shader = add(tree, "BsdfDiffuse", Color=node.outputs["Color"])
    total = tree.nodes.new("ShaderNodeAddShader")
    for i, part in enumerate((shader, black)):
        tree.links.new(part.outputs[0], total.inputs[i])
    tree.links.new(total.outputs[0], output.inputs["Surface"])
    sheet(made)


@scene(within=0.03, why="Cycles multiplies by alpha in 8 bits, and divides again")
def alpha_of_a_displacement():
    """There it is used, though nothing is moved."""
    pixels = with_alpha(0.5)
    pixels[:4, :, 3] = 1

    def use(tree, node):
        moved = add(tree, "Displacement", Height=node.outputs["Alpha"], Scale=0.0)
        output = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
        tree.links.new(moved.outputs[0], output.inputs["Displacement"])

    with_alpha_to(use, pixels, {"interpolation": "Closest"})


@scene(within=0.06, why="nodes calculate with pixels, before these are filtered")
def alpha_of_a_like_node():
    """Cycles makes one of two nodes that show the same: the alpha of one counts as that of the other."""
    face_on()
    picture = saved_image("alike", with_alpha())

    def build(tree):
        color, alpha = texture(tree, picture), add(tree, "TexImage", {"image": picture})
        inputs = {"Color1": (0.2, 0.2, 0.2, 1), "Color2": color.outputs["Color"]}
        return add(tree, "MixRGB", Fac=alpha.outputs["Alpha"], **inputs).outputs[0]

    sheet(painted(build))


@scene(within=0.06, why="nodes calculate with pixels, before these are filtered")
def alpha_of_an_unlike_node():
    face_on()
    picture = saved_image("unlike", with_alpha())

    def build(tree):
        color, alpha = texture(tree, picture), texture(tree, picture, {"interpolation": "Cubic"})
        inputs = {"Color1": (0.2, 0.2, 0.2, 1), "Color2": color.outputs["Color"]}
        return add(tree, "MixRGB", Fac=alpha.outputs["Alpha"], **inputs).outputs[0]

    sheet(painted(build))


def packed(mode, depth="8", settings=None, output="Color"):
    """A file that is packed, whose alpha Blender has taken as `mode` says: Cycles is given what Blender holds."""
    picture = saved_image(f"packed-{mode}-{depth}", with_alpha(), depth=depth)
    picture.alpha_mode = mode
    picture.pack()
    shows(picture, settings, output)


@scene
def packed_premultiplied():
    packed("PREMUL")


@scene
def packed_straight():
    packed("STRAIGHT")


@scene
def packed_premultiplied_16_bits():
    packed("PREMUL", "16")


@scene
def packed_straight_16_bits():
    packed("STRAIGHT", "16")


@scene
def packed_premultiplied_alpha():
    packed("PREMUL", output="Alpha")


@scene
def generated_premultiplied():
    """Of no file: nothing divides it."""
    picture = bpy.data.images.new("generated", 8, 8, alpha=True)
    picture.pixels.foreach_set(with_alpha().astype("f").ravel())
    picture.alpha_mode = "PREMUL"
    shows(picture)


def speckled(width, height):
    """Black and white texels, of which the fewer are white the further to the right they are: their means depend on the space."""
    shares = np.linspace(0.9, 0.1, width)
    return np.repeat((np.random.default_rng(3).random((height, width)) < shares)[..., None], 3, axis=-1) * 1.0


def simplified(picture, resolution=1.0, limit="128"):
    simplify, cycles = bpy.context.scene.render, bpy.context.scene.cycles
    simplify.use_simplify, cycles.texture_limit_render = True, limit
    if resolution != 1:
        cycles.texture_resolution_render = resolution
    shows(picture)


@scene
def size_limited():
    """To 75 by 65 texels; three columns are lost."""
    simplified(saved_image("speckled", speckled(303, 260)))


@scene(samples=32)
def size_limited_of_floats():
    """Where they are more than a number that no mean of 16 texels is: ties would be for rounding to decide."""
    simplified(None)
    picture = image("Speckled", speckled(303, 260), floats=True)

    def more(tree):
        made = add(tree, "Math", {"operation": "GREATER_THAN"}, Value=texture(tree, picture).outputs[0])
        made.inputs[1].default_value = 0.47
        return made.outputs[0]

    bpy.context.scene.objects["Sheet"].data.materials[0] = painted(more)


@scene
def size_limited_with_alpha():
    pixels = np.concatenate([speckled(303, 260), speckled(303, 260)[::-1, :, :1]], axis=-1)
    simplified(saved_image("speckled-alpha", pixels))


@scene(since=(5, 2))
def size_by_resolution():
    """A third of it is a quarter."""
    simplified(saved_image("speckled", speckled(303, 260)), 0.3, "OFF")
