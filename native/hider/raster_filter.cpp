// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/raster_filter.h"

#include <cmath>
#include <cstdio>
#include <numeric>

#include "base/check.h"

namespace granita {

int RasterFilter::apron() const {
    if (!factor.empty()) return static_cast<int>(std::ceil(radius - 0.5));
    const int last = first + static_cast<int>(weights.size()) - 1;
    const int below = first < 0 ? (-first + lattice - 1) / lattice : 0;
    const int above = last >= lattice ? last / lattice : 0;
    return below > above ? below : above;
}

RasterFilter make_raster_filter(int lattice, double radius,
                                const std::function<double(double)>& factor) {
    GRANITA_CHECK_GE(lattice, 1);
    GRANITA_CHECK(std::isfinite(radius) && radius > 0.0);
    RasterFilter filter;
    filter.lattice = lattice;
    // Sub-sample k lies (k + 1/2) / lattice - 1/2 from the centre.
    const int first = static_cast<int>(std::floor((0.5 - radius) * lattice - 0.5));
    const int last = lattice - 1 - first;
    for (int k = first; k <= last; ++k) filter.weights.push_back(factor((k + 0.5) / lattice - 0.5));
    filter.first = first;
    // A symmetric filter loses as much at either end.
    while (filter.weights.size() > 1 && filter.weights.front() == 0.0) {
        filter.weights.erase(filter.weights.begin());
        ++filter.first;
    }
    while (filter.weights.size() > 1 && filter.weights.back() == 0.0) filter.weights.pop_back();

    const double sum = std::accumulate(filter.weights.begin(), filter.weights.end(), 0.0);
    if (sum == 0.0) {
        // A filter narrower than the lattice's step falls between the sub-samples: the pixel is
        // then the mean of the sub-samples nearest to its centre.
        filter.first = (lattice - 1) / 2;
        filter.weights.assign(lattice % 2 == 0 ? 2 : 1, lattice % 2 == 0 ? 0.5 : 1.0);
        return filter;
    }
    GRANITA_CHECK(sum > 0.0);
    for (double& weight : filter.weights) weight /= sum;
    return filter;
}

RasterFilter make_gathering_filter(int lattice, double radius, bool is_box,
                                   const std::function<double(double)>& factor) {
    GRANITA_CHECK_GE(lattice, 1);
    GRANITA_CHECK(std::isfinite(radius) && radius > 0.0);
    constexpr int kSteps = 1024;
    RasterFilter filter;
    filter.lattice = lattice;
    filter.radius = radius;
    filter.is_box = is_box;
    for (int i = 0; i <= kSteps; ++i) filter.factor.push_back(factor(radius * i / kSteps));
    return filter;
}

std::string list_source(const std::vector<double>& values) {
    std::string source;
    for (const double weight : values) {
        char number[32];
        // Nine digits make a float exact.
        std::snprintf(number, sizeof number, "%.8e",
                      static_cast<double>(static_cast<float>(weight)));
        if (!source.empty()) source += ", ";
        source += number;
    }
    return source;
}

}  // namespace granita
