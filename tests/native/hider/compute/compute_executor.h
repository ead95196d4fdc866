// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "hider/compute/compute_hider.h"

namespace granita::test {

/// One context for the whole program.
inline gl::GlThread& compute_thread() {
    static gl::GlThread thread({.debug = true});
    return thread;
}

/// The compute executor as the others are made.
inline std::unique_ptr<Hider> make_device_hider(const HiderFrame& frame, const Rect& tiles,
                                                const Rect& pixels) {
    static ComputeDevice device(compute_thread());
    return make_compute_hider(device, frame, tiles, pixels);
}

/// With limits so small that every scene is split: lists, buffers of samples and of fragments.  For
/// at most 19 samples a pixel.
inline std::unique_ptr<Hider> make_small_device_hider(const HiderFrame& frame, const Rect& tiles,
                                                      const Rect& pixels) {
    static ComputeDevice device(compute_thread(), {.buffer_bytes = 100000, .entries = 400});
    return make_compute_hider(device, frame, tiles, pixels);
}

}  // namespace granita::test
