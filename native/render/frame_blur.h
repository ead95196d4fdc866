// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/report.h"
#include "dice/view.h"
#include "film/filter.h"
#include "hider/pass_count.h"

namespace granita {

/// The longest path of a vertex across the screen, and the largest circle of confusion, of what the
/// frame can see.  Between knots motion is straight in camera space.
FrameBlur frame_blur(const View& view);

/// Passes of REGULAR sampling where Options::time_samples leaves them to the renderer: so many that
/// ramps of moving edges ripple no more than 2 %.  Warns where the frame would want more.
int automatic_passes(const View& view, const PixelFilter& filter, Report& report);

}  // namespace granita
