// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/simd/stratum_bounds.h"

#include <algorithm>
#include <cmath>

#include "hider/samples/sample_order.h"

namespace granita {
namespace {

/// Values that are not numbers are left out.  In lanes, because the order of minima does not matter
/// but vectors do.
void bound(const std::vector<float>& values, std::size_t strata, std::size_t stride, float whole,
           std::vector<float>& lo, std::vector<float>& hi) {
    lo.assign(strata + kPacket, 0.0f);
    hi.assign(strata + kPacket, whole);
    if (values.empty()) return;
    for (std::size_t r = 0; r < strata; ++r) {
        float least[kPacket], most[kPacket];
        std::fill_n(least, kPacket, INFINITY);
        std::fill_n(most, kPacket, -INFINITY);
        const float* const of_stratum = &values[r * stride];
        for (std::size_t block = 0; block < stride; block += kPacket)
            for (int i = 0; i < kPacket; ++i) {
                const float value = of_stratum[block + i];
                least[i] = value < least[i] ? value : least[i];
                most[i] = value > most[i] ? value : most[i];
            }
        lo[r] = *std::min_element(least, least + kPacket);
        hi[r] = *std::max_element(most, most + kPacket);
    }
}

void find_slabs(std::size_t strata, StratumBounds& bounds) {
    for (int s = 0; s < StratumBounds::kSlabs; ++s) {
        const float t0 = static_cast<float>(s) / StratumBounds::kSlabs;
        const float t1 = static_cast<float>(s + 1) / StratumBounds::kSlabs;
        int first = 0, end = static_cast<int>(strata);
        while (first < end && bounds.t_hi[first] < t0) ++first;
        while (end > first && bounds.t_lo[end - 1] > t1) --end;
        bounds.first[s] = first;
        bounds.end[s] = end;
    }
}

}  // namespace

StratumBounds bound_strata(const SampleOrder& order, const std::vector<float>& t,
                           const std::vector<float>& u, const std::vector<float>& v,
                           const std::vector<float>& inverse_focus) {
    const auto strata = static_cast<std::size_t>(order.strata());
    const std::size_t stride = order.stratum_stride();
    StratumBounds out;
    bound(t, strata, stride, 1.0f, out.t_lo, out.t_hi);
    bound(u, strata, stride, 0.0f, out.u_lo, out.u_hi);
    bound(v, strata, stride, 0.0f, out.v_lo, out.v_hi);
    if (!inverse_focus.empty())
        bound(inverse_focus, strata, stride, 0.0f, out.focus_lo, out.focus_hi);
    find_slabs(strata, out);
    return out;
}

}  // namespace granita
