// SPDX-License-Identifier: GPL-3.0-or-later
// Which executor renders the frame, and what to call it.
#pragma once

#include <string>

#include "scene/options.h"

namespace granita {

/// Never Auto.  An explicit Options::executor wins over the device.
Executor choose_executor(const Options& options);
/// For statistics and the artist, e.g. "CPU (simd)".
std::string executor_name(Executor executor);

}  // namespace granita
