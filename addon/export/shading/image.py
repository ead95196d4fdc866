# SPDX-License-Identifier: GPL-3.0-or-later
"""Images that nodes show, as records of docs/scene_snapshot.md: a file wherever there is one (the native
texture cache reads it in tiles), pixels for what exists in memory alone."""

import hashlib
from contextlib import contextmanager
from pathlib import Path

import bpy
import numpy as np

from ..base.regular_file import is_no_file, open_regular_file
from .color_space import is_data
from .working_space import scene_from_rec709

# What files begin with that Blender reads and Granita's readers do not: JPEG 2000, DPX, Cineon, SGI, Photoshop, DDS.
_BLENDERS_OWN = (
    b"\0\0\0\x0cjP  \r\n\x87\n",
    b"\xff\x4f\xff\x51",
    b"SDPX",
    b"XPDS",
    b"\x80\x2a\x5f\xd7",
    b"\xd7\x5f\x2a\x80",
    b"\x01\xda",
    b"8BPS",
    b"DDS ",
)
# Pixels that are decoded at a time.
_STRIP = 1 << 14

# Files with the bytes of packed images, and pixels of generated ones, of the render job that is under way:
# {what an image shows: path or pixels}.
_of_this_job = {}
_painted = None  # PaintedPixels of the view that reads


def forget_images(*_):
    """A new render job begins: images may be other ones by now.  Within one, a packed image is another one when
    its packed file is, a generated one when its settings are."""
    _of_this_job.clear()


def image_name(image, image_user, images, report):
    """Adds an image to the records, once.

    Args:
        image: bpy Image.
        image_user: ImageUser of the node: which frame of a sequence.
        images: {name: record} to add to.
        report: called with (datablock, message).

    Returns:
        the record's name.
    """
    path = _sequence_path(image, image_user)
    name = _name(image) if path is None else _name_of_part(image, Path(path).name)
    if name not in images:
        images[name] = _record(image, name, path, report)
    return name


def image_tiles(image, images, report):
    """Adds the tiles of an image (UDIM) to the records, once.

    Returns:
        {number: the record's name}, the names that of the image, a slash and the number; {} where it has no
        tiles, or is in no file.
    """
    if image.source != "TILED" or not _is_in_a_file(image):
        return {}
    names = {tile.number: _name_of_part(image, tile.number) for tile in image.tiles}
    packed = {file.tile_number: file.packed_file for file in image.packed_files}
    for number, name in names.items():
        if name not in images:
            record = _empty_record(image, name)
            path = _packed_file(image, packed.get(number)) or _tile_path(image, number)
            images[name] = {**record, "path": path}
    return names


def _name_of_part(image, part):
    """Of a tile, or a picture of a sequence: no datablock's record is named so, whatever it is called."""
    return f"{image.name_full}/{part}"


def _name(image):
    return image.name_full if "/" not in image.name_full else _name_of_part(image, "")


def _sequence_path(image, image_user):
    """The file of the current frame; None where the image is no sequence."""
    if image.source != "SEQUENCE":
        return None
    return image.filepath_from_user(image_user=image_user)


def _empty_record(image, name):
    space = image.colorspace_settings.name
    if is_data(space):
        space = "Non-Color"
    return {"name": name, "path": "", "colorspace": space, "alpha_mode": _alpha_mode(image)}


def _alpha_mode(image):
    """Until 5.1 Cycles goes by the file, whether its image is said to be straight or premultiplied."""
    told = {} if bpy.app.version < (5, 1) else {"STRAIGHT": "UNASSOCIATED", "PREMUL": "ASSOCIATED"}
    return told.get(image.alpha_mode, image.alpha_mode)


def _record(image, name, path, report):
    label = f"image '{image.name_full}'"
    record = _empty_record(image, name)
    if image.source == "MOVIE":
        file = bpy.path.abspath(image.filepath, library=image.library)
        if is_no_file(file):  # Blender would open a pipe, and wait
            return {**record, "path": file}
        report(label, "is a movie, of which one frame is shown throughout: use an image sequence")
    if path is not None:
        record["path"] = path
    elif _is_in_a_file(image):
        record["path"] = _packed_file(image, image.packed_file) or _file_path(image, label, report)
        if _is_for_blender(record["path"]) and (pixels := _pixels(image)) is not None:
            record["path"] = ""
            _hand_over(record, pixels, image)
    else:
        pixels = _generated_pixels(image)
        if pixels is None:
            report(label, f"its source {image.source} has no pixels: shown magenta")
            record["path"] = image.filepath or image.name_full
        else:
            _hand_over(record, pixels, image)
    return record


def _hand_over(record, pixels, image):
    if image.is_float and record["colorspace"] != "Non-Color":
        record["colorspace"] = "scene_linear"
    record["pixels" if image.is_float else "bytes"] = pixels


def _is_in_a_file(image):
    """Tiled images that were never saved have neither file nor bytes, and are not dirty."""
    if image.source not in ("FILE", "TILED") or image.is_dirty or _is_packed_float(image):
        return False
    return bool(image.filepath or image.packed_file)


def _file_path(image, label, report):
    if image.source == "TILED":
        tile = image.tiles[0].number if len(image.tiles) else 1001
        report(label, f"only its tile {tile} is shown")
        return _tile_path(image, tile)
    return bpy.path.abspath(image.filepath, library=image.library)


def _tile_path(image, tile):
    path = bpy.path.abspath(image.filepath, library=image.library)
    u, v = (tile - 1001) % 10 + 1, (tile - 1001) // 10 + 1
    return path.replace("<UDIM>", str(tile)).replace("<UVTILE>", f"u{u}_v{v}")


def _is_packed_float(image):
    """Of packed images Cycles takes what Blender has: of Radiance's format it makes .3 % more light than OpenImageIO
    does from a file, as it adds half a step to each mantissa, and what was packed since it was loaded is linear,
    whatever its colour space says."""
    return image.packed_file is not None and image.is_float


def _packed_file(image, packed):
    """Writes packed bytes where a file reader can open them; None where nothing is packed.

    Blender deletes its own temporary folder when it ends.  The name follows from the content: frames
    of an animation share the file.
    """
    if packed is None:
        return None
    # The bytes are copied by looking at them: once a job.
    key = (image.as_pointer(), packed.as_pointer(), packed.size, image.filepath)
    path = _of_this_job.get(key)
    if path is None:
        data = packed.data
        if not data:
            return None
        suffix = Path(image.filepath).suffix or f".{image.file_format.lower()}"
        digest = hashlib.sha1(data).hexdigest()
        path = Path(bpy.app.tempdir or "/tmp") / f"granita-{digest}{suffix}"
        if not path.exists():
            path.write_bytes(data)
        _of_this_job[key] = path
    return str(path)


def _is_for_blender(path):
    try:
        with open_regular_file(path, "rb") as file:
            return file.read(12).startswith(_BLENDERS_OWN)
    except OSError:
        return False


class PaintedPixels:
    """What was painted or set by a script, as a 3D view has read it: an edit of something else changes none of it.

    Attributes:
        was_taken: whether the last reading took what an earlier one had read.
    """

    def __init__(self):
        self._pixels = {}
        self.was_taken = False

    def forget(self):
        self._pixels.clear()

    @contextmanager
    def in_use(self):
        """Readings take what is known, and leave what they read."""
        global _painted
        self.was_taken = False
        before, _painted = _painted, self
        try:
            yield
        finally:
            _painted = before

    def of(self, image):
        key = image.name_full, *_given_as(image)
        if key in self._pixels:
            self.was_taken = True
        else:
            self._pixels[key] = _pixels(image)
        return self._pixels[key]


def _given_as(image):
    """What `_pixels` goes by, beside what the image shows.  Floats are scene-linear."""
    space, alpha = image.colorspace_settings.name, _alpha_mode(image)
    return space, alpha, image.is_float, *image.size, scene_from_rec709().tobytes()


def _generated_pixels(image):
    """What was painted or set by a script is read each time, but by views: nothing tells of its changes."""
    if image.source != "GENERATED" or image.is_dirty:
        return _pixels(image) if _painted is None else _painted.of(image)
    settings = image.generated_type, *image.generated_color
    key = (image.as_pointer(), *settings, *_given_as(image))
    if key not in _of_this_job:
        _of_this_job[key] = _pixels(image)
    return _of_this_job[key]


def _pixels(image):
    """float32 [h, w, 4], lower left first, scene-linear, alpha associated, or uint8 in the image's colour space: a
    quarter of the memory, and nothing is decoded to be encoded again.  None where Blender has none.
    """
    width, height = image.size
    if width == 0 or height == 0:
        return None
    count = image.channels
    pixels = np.empty((height, width, count), dtype=np.float32)
    image.pixels.foreach_get(pixels.reshape(-1))
    if count != 4:
        pixels = _with_four_channels(pixels)
    alpha_mode = _alpha_mode(image)
    associates = not is_data(image.colorspace_settings.name) and alpha_mode not in (
        "CHANNEL_PACKED",
        "NONE",
        "ASSOCIATED",
    )
    if image.is_float:  # multiplied already, but where straight is what they are said to be
        if associates and alpha_mode == "UNASSOCIATED":
            pixels[..., :3] *= pixels[..., 3:]
        return pixels
    return _bytes(pixels, associates)


def _with_four_channels(values):
    count = values.shape[2]
    pixels = np.ones((*values.shape[:2], 4), dtype=np.float32)
    pixels[..., :3] = values if count == 3 else values[..., :1]
    if count == 2:
        pixels[..., 3] = values[..., 1]
    return pixels


def _strips(pixels):
    """Rows that stay in the processor's cache: an artist waits for what is done to them at each frame."""
    rows = max(1, _STRIP // pixels.shape[1])
    return (slice(begin, begin + rows) for begin in range(0, len(pixels), rows))


def _bytes(pixels, associates):
    """The bytes that Blender's numbers were, alpha straight there."""
    found = np.empty(pixels.shape, dtype=np.uint8)
    for rows in _strips(pixels):
        strip = pixels[rows] * np.float32(255)
        if associates:
            # Whole bytes, cut off, as in Cycles.
            strip[..., :3] *= pixels[rows, :, 3:]
            strip += np.array([1e-3, 1e-3, 1e-3, 0.5], dtype=np.float32)
        else:
            strip += np.float32(0.5)
        found[rows] = strip
    return found
