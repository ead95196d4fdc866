// SPDX-License-Identifier: GPL-3.0-or-later
// The compute executor: the loops of the SIMD executor in compute shaders (shaders/compute).
//
//   ComputeDevice device(gl_thread);                       // once a frame
//   auto hider = make_compute_hider(device, frame, tiles, pixels);
//
// hide() collects micropolygons in the lists of the blocks of 4 x 4 pixels that they may touch; a
// full batch runs on the thread that owns OpenGL.  On the device each invocation owns one sample
// and walks through its block's list: no atomics, no interlock, no shared memory, no barrier.  What
// a sample sees is what the SIMD executor sees; depth keys may differ by 4 ulp (GLSL's division).
#pragma once

#include <memory>

#include "hider/compute/compute_device.h"
#include "hider/hider.h"

namespace granita {

/// Throws GlError where one tile's samples need more memory than the device's limits.
std::unique_ptr<Hider> make_compute_hider(ComputeDevice& device, const HiderFrame& frame,
                                          const Rect& tiles, const Rect& pixels);

}  // namespace granita
