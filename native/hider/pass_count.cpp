// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/pass_count.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace granita {

double strobing_ripple(const FilterFactor& filter, double radius, double step) {
    constexpr int kPlaces = 256;
    double least = INFINITY, most = -INFINITY;
    for (int i = 0; i < kPlaces; ++i) {
        // Between the copies that touch the ends of a box, where they neither abut nor overlap.
        const double x = step * (i + 0.5) / kPlaces;
        double sum = 0.0;
        for (double j = std::ceil((x - radius) / step); j * step <= x + radius; ++j)
            sum += filter(static_cast<float>(x - j * step));
        least = std::min(least, step * sum);
        most = std::max(most, step * sum);
    }
    return 0.5 * (most - least);
}

double longest_step(const FilterFactor& filter, double radius, double ripple) {
    constexpr double kFirst = 1.0 / 32;
    double step = kFirst;
    while (step < 4.0 * radius && strobing_ripple(filter, radius, step) <= ripple) step *= 1.01;
    return std::max(kFirst, step / 1.01);
}

double passes_wanted(const FrameBlur& blur, double step) {
    const double along = std::ceil(blur.motion / step);
    const double over = std::ceil(std::numbers::pi * blur.lens * blur.lens / (step * step));
    return std::fmax(std::fmax(along, over), 1.0);
}

int pass_count(const FrameBlur& blur, double step) {
    return static_cast<int>(std::fmin(passes_wanted(blur, step), kMostPasses));
}

}  // namespace granita
