// SPDX-License-Identifier: GPL-3.0-or-later
// The front half of the paper's listing (9.3.3) for one bucket:
//
//   for every object from front to back:
//       if its bound passes the occlusion test:
//           if it is too big to dice: split it and re-insert the pieces
//           else: dice it; if the grid passes the occlusion test: hide it
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "hider/time_slabs.h"
#include "render/frame.h"

namespace granita {

/// Whether nothing inside the bounds can still be seen in the bucket during that part of the
/// shutter.
using Occlusion = std::function<bool(const TimeSlab&)>;

/// Calls `hide` with every grid of the bucket that reaches these pixels and is not yet occluded,
/// roughly from front to back. The order follows depth keys, then keys of identity: the same in
/// every run.
void visit_geometry(Frame& frame, int bucket, const Rect& reach, const Occlusion& occlusion,
                    const std::function<void(std::shared_ptr<SharedGrid>)>& hide);

}  // namespace granita
