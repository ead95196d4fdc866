# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a picture's file has its end: Blender says "Saved" of OpenEXR files that a full disk cut off.

The formats: https://openexr.com/en/latest/OpenEXRFileLayout.html, https://www.w3.org/TR/png/
"""

import errno
import os
import struct

# What file systems answer that cannot flush at all, as some of FUSE: nothing is lost by it.
_CANNOT_FLUSH = {errno.EINVAL, errno.ENOSYS, errno.EOPNOTSUPP, errno.ENOTSUP}

_OPENEXR = b"v/1\x01"
_PNG = b"\x89PNG\r\n\x1a\n"
_PNG_END = b"IEND\xae\x42\x60\x82"
_JPEG = b"\xff\xd8\xff"
_JPEG_END = b"\xff\xd9"
# Lines of a chunk by the number of the compression: none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB.
_LINES = (1, 1, 1, 16, 32, 16, 32, 32, 32, 256)
_TILES_OR_DEEP = 0x0A
_PARTS = 0x10


def is_whole(path):
    """False where the file is cut off; of formats that are not known here, where nothing is there.  Raises OSError."""
    size = os.path.getsize(path)
    with open(path, "rb") as file:
        start = file.read(8)
        if start.startswith(_OPENEXR):
            return _openexr_is_whole(file, size)
        if start == _PNG:
            return _ends_in(file, size, _PNG_END)
        if start.startswith(_JPEG):
            return _ends_in(file, size, _JPEG_END)
    return size > 8  # no picture is smaller


def flush(file):
    """Onto the disk, where its file system can.  Raises OSError where the bytes did not get there.

    File systems of networks tell of a full disk, a spent quota or a broken line when they are asked for that alone.
    """
    file.flush()
    try:
        os.fsync(file.fileno())
    except OSError as error:
        if error.errno not in _CANNOT_FLUSH:
            raise


def fault(path):
    """What is wrong with a file that was just written, in words; empty where it is whole and on the disk.

    An end that was seen may be in this machine's memory only.  Raises OSError where the file cannot be looked at.
    """
    with open(path, "rb") as file:
        try:
            flush(file)
        except OSError as error:
            return error.strerror
    return "" if is_whole(path) else "the disk may be full"


def _ends_in(file, size, end):
    file.seek(max(size - len(end), 0))
    return file.read() == end


def _openexr_is_whole(file, size):
    """Each chunk has a place, and the last of them lies within the file."""
    try:
        file.seek(5)
        kind = file.read(1)[0]
        if kind & _TILES_OR_DEEP:
            return True  # Blender writes none
        file.seek(8)
        places = _places(file, bool(kind & _PARTS))
        # A chunk of a file with parts begins with its part's number.
        file.seek(max(places) + (4 if kind & _PARTS else 0))
        _, length = struct.unpack("<ii", file.read(8))
        return min(places) > 0 and file.tell() + length <= size
    except (struct.error, IndexError, KeyError):
        return False


def _places(file, has_parts):
    """Where the chunks of all parts begin."""
    counts = [_chunks(_header(file))]
    while has_parts and (header := _header(file)):
        counts.append(_chunks(header))
    return struct.unpack(f"<{sum(counts)}Q", file.read(8 * sum(counts)))


def _chunks(header):
    _, first, _, last = struct.unpack("<4i", header["dataWindow"])
    lines = _LINES[header["compression"][0]]
    return (last - first + lines) // lines


def _header(file):
    """{name: bytes} of the attributes."""
    found = {}
    while name := _string(file):
        _string(file)  # its type
        (length,) = struct.unpack("<i", file.read(4))
        found[name] = file.read(length)
    return found


def _string(file):
    text = bytearray()
    while (byte := file.read(1)[0]) != 0:
        text.append(byte)
    return text.decode(errors="replace")
