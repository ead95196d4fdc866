// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/raster/raster_filter.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/check.h"

namespace granita {

int RasterFilter::margin() const {
    if (!factor.empty()) return static_cast<int>(std::ceil(radius - 0.5));
    if (!taps.empty()) return tap_pixels;
    const int side = lattice.side;
    const int last = first + static_cast<int>(weights.size()) - 1;
    const int below = first < 0 ? (-first + side - 1) / side : 0;
    const int above = last >= side ? last / side : 0;
    return below > above ? below : above;
}

namespace {

RasterFilter make_taps(RegularLattice lattice, double radius,
                       const std::function<double(double)>& factor) {
    RasterFilter filter;
    filter.lattice = lattice;
    const int reach = static_cast<int>(std::ceil(radius - 0.5));
    std::vector<double> weights;
    for (int y = -reach; y <= reach; ++y)
        for (int x = -reach; x <= reach; ++x)
            for (int cell = 0; cell < lattice.cells(); ++cell) {
                const Vec2d place = Vec2d(lattice.place(cell)) + Vec2d(x, y) - 0.5;
                const double weight = factor(place.x) * factor(place.y);
                if (weight == 0.0) continue;
                weights.push_back(weight);
                filter.taps.push_back({lattice.first_texel({x, y}) + lattice.texel(cell)});
                filter.tap_pixels = std::max({filter.tap_pixels, std::abs(x), std::abs(y)});
            }
    if (weights.empty()) {
        // Narrower than the lattice's step: the pixel is the sample nearest to its centre.
        weights.push_back(1.0);
        filter.taps.push_back({lattice.texel(lattice.center_cell())});
    }
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    for (std::size_t i = 0; i < weights.size(); ++i)
        filter.taps[i].weight = static_cast<float>(weights[i] / sum);
    return filter;
}

}  // namespace

RasterFilter make_raster_filter(RegularLattice lattice, double radius,
                                const std::function<double(double)>& factor) {
    GRANITA_CHECK_GE(lattice.side, 1);
    GRANITA_CHECK(std::isfinite(radius) && radius > 0.0);
    if (lattice.rotated) return make_taps(lattice, radius, factor);
    RasterFilter filter;
    filter.lattice = lattice;
    const int side = lattice.side;
    // Sub-sample k lies (k + 1/2) / side - 1/2 from the centre.
    const int first = static_cast<int>(std::floor((0.5 - radius) * side - 0.5));
    const int last = side - 1 - first;
    for (int k = first; k <= last; ++k) filter.weights.push_back(factor((k + 0.5) / side - 0.5));
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
        filter.first = (side - 1) / 2;
        filter.weights.assign(side % 2 == 0 ? 2 : 1, side % 2 == 0 ? 0.5 : 1.0);
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
    for (int i = 0; i <= kSteps; ++i)
        filter.factor.push_back(static_cast<float>(factor(radius * i / kSteps)));
    return filter;
}

}  // namespace granita
