// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

#include "base/parallel.h"

namespace granita {

/// Sorts by `<`.  What is neither less nor greater may change places, as in std::sort.
template <class T>
void parallel_sort(std::vector<T>& values) {
    constexpr std::size_t kRun = 1 << 14;
    const auto at = [&](std::size_t i) {
        return values.begin() + static_cast<std::ptrdiff_t>(std::min(i, values.size()));
    };
    const auto runs = [&](std::size_t length) { return (values.size() + length - 1) / length; };
    parallel_for(runs(kRun), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) std::sort(at(i * kRun), at((i + 1) * kRun));
    });
    for (std::size_t length = kRun; length < values.size(); length *= 2)
        parallel_for(runs(2 * length), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                std::inplace_merge(at(2 * i * length), at((2 * i + 1) * length),
                                   at((2 * i + 2) * length));
        });
}

}  // namespace granita
