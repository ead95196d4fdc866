// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/light_split.h"

#include <algorithm>
#include <array>

namespace granita {
namespace {

constexpr int kBins = 12;

Vec3f center_of(const LightBound& lamp) {
    return 0.5f * (lamp.box.lo + lamp.box.hi);
}

/// Which bin of an axis a lamp's center is in.
struct Bins {
    int axis;
    float from, scale;

    int operator()(const LightBound& lamp) const {
        const float at = (center_of(lamp)[axis] - from) * scale;
        return std::clamp(static_cast<int>(at), 0, kBins - 1);
    }
};

class Splitter {
  public:
    Splitter(const std::vector<LightBound>& lamps, const LightGroup& group)
        : m_lamps(lamps), m_group(group) {
        for (const std::uint32_t* lamp = group.first; lamp != group.last; ++lamp)
            m_centers.add(center_of(lamps[*lamp]));
        for (int axis = 0; axis < 3; ++axis) try_axis(axis);
    }

    /// Where the second part begins, once the lamps are sorted into their parts.
    std::uint32_t* split() const {
        if (m_first_bin == 0)  // all in one place
            return m_group.first + (m_group.last - m_group.first) / 2;
        return std::stable_partition(m_group.first, m_group.last, [this](std::uint32_t lamp) {
            return m_bins(m_lamps[lamp]) < m_first_bin;
        });
    }

  private:
    void try_axis(int axis) {
        const Vec3f size = m_centers.hi - m_centers.lo;
        const float longest = largest(size);
        if (!(size[axis] > 0.0f)) return;
        const Bins bins{axis, m_centers.lo[axis], static_cast<float>(kBins) / size[axis]};
        std::array<LightBound, kBins> of_bin;
        std::array<bool, kBins> any{};
        for (const std::uint32_t* lamp = m_group.first; lamp != m_group.last; ++lamp) {
            const int bin = bins(m_lamps[*lamp]);
            of_bin[bin].add(m_lamps[*lamp]);
            any[bin] = true;
        }
        std::array<float, kBins> above{};  // cost of the bins from this on
        LightBound sum;
        for (int bin = kBins - 1; bin > 0; --bin) {
            if (any[bin]) sum.add(of_bin[bin]);
            above[bin] = sum.cost();
        }
        sum = {};
        for (int bin = 1; bin < kBins; ++bin) {
            if (any[bin - 1]) sum.add(of_bin[bin - 1]);
            // The first and the last bin hold a lamp: neither part is empty.
            const float cost = (sum.cost() + above[bin]) * longest / size[axis];
            if (m_first_bin != 0 && !(cost < m_cost)) continue;
            m_cost = cost;
            m_first_bin = bin;
            m_bins = bins;
        }
    }

    const std::vector<LightBound>& m_lamps;
    const LightGroup& m_group;
    Bounds3f m_centers;
    Bins m_bins{0, 0.0f, 0.0f};
    int m_first_bin = 0;  ///< of the second part; 0: none found
    float m_cost = 0.0f;
};

LightGroup group_of(const std::vector<LightBound>& lamps, std::uint32_t* first,
                    std::uint32_t* last) {
    LightGroup group{first, last, {}};
    for (const std::uint32_t* lamp = first; lamp != last; ++lamp) group.bound.add(lamps[*lamp]);
    return group;
}

}  // namespace

std::vector<LightGroup> split_lights(const std::vector<LightBound>& lamps, std::uint32_t* first,
                                     std::uint32_t* last, std::size_t most) {
    std::vector<LightGroup> groups{group_of(lamps, first, last)};
    const bool fits = static_cast<std::size_t>(last - first) <= most;
    while (groups.size() < most) {
        auto worst = groups.end();
        float worst_cost = -1.0f;
        for (auto group = groups.begin(); group != groups.end(); ++group) {
            const float cost = group->bound.cost();
            const auto count = static_cast<std::size_t>(group->last - group->first);
            if (count < 2 || (!fits && count <= most) || !(cost > worst_cost)) continue;
            worst = group;
            worst_cost = cost;
        }
        if (worst == groups.end()) break;
        std::uint32_t* const middle = Splitter(lamps, *worst).split();
        const LightGroup after = group_of(lamps, middle, worst->last);
        *worst = group_of(lamps, worst->first, middle);
        groups.insert(worst + 1, after);
    }
    return groups;
}

}  // namespace granita
