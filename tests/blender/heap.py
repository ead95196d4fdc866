# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of the heap is in use."""

import ctypes


def heap_bytes():
    """Bytes that are allocated, exactly; None where Blender is not linked with jemalloc, as Debian's is."""
    try:
        mallctl = ctypes.CDLL(None).mallctl
    except AttributeError:
        return None
    epoch, allocated = ctypes.c_uint64(1), ctypes.c_size_t(0)
    size = ctypes.c_size_t(ctypes.sizeof(epoch))
    mallctl(b"epoch", ctypes.byref(epoch), ctypes.byref(size), ctypes.byref(epoch), size)
    size = ctypes.c_size_t(ctypes.sizeof(allocated))
    mallctl(b"stats.allocated", ctypes.byref(allocated), ctypes.byref(size), None, 0)
    return allocated.value
