// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/choose_executor.h"

namespace granita {

Executor choose_executor(const Options& options) {
    if (options.executor != Executor::Auto) return options.executor;
    return Executor::Simd;
}

std::string executor_name(Executor executor) {
    switch (executor) {
        case Executor::Reference:
            return "CPU (reference)";
        case Executor::Raster:
            return "GPU (raster)";
        default:
            return "CPU (simd)";
    }
}

}  // namespace granita
