// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/lamp_rounds.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "math/displayed.h"
#include "math/luminance.h"

namespace granita {
namespace {

template <class T>
void add(const std::vector<T>& light, const std::vector<float>& times, std::vector<T>& sum) {
    for (std::size_t i = 0; i < light.size(); ++i) sum[i] += light[i] * times[i];
}

/// The square of how far what is displayed is in doubt, by the fourth power: of those few points
/// that lie in a penumbra a quarter of the samples would be seen.
double doubt_of(const LampRound& round, const std::vector<float>& level) {
    double sum = 0.0;
    for (std::size_t i = 0; i < level.size(); ++i) {
        if (round.times[i] == 1.0f) continue;  // no other samples
        const float doubt = std::abs(round.balance[i]) * round.times[i];
        const double shown = displayed(level[i] + doubt) - displayed(level[i]);
        sum += shown * shown * shown * shown;
    }
    return std::sqrt(sum / static_cast<double>(level.size()));
}

}  // namespace

LampRound::LampRound(std::uint32_t lamp, const LitGrid& grid, bool is_told)
    : radiance(grid.radiance.size(), Vec3f(0.0f)),
      balance(radiance.size(), 0.0f),
      times(radiance.size(), 1.0f),
      sight(lamp),
      sight_is_told(is_told) {
    if (grid.parts) parts.resize(radiance.size());
}

void LampRound::swap(LitGrid& grid) {
    radiance.swap(grid.radiance);
    if (grid.parts) std::swap(parts, *grid.parts);
}

void LampRound::add_to(LitGrid& grid) const {
    add(radiance, times, grid.radiance);
    if (grid.balance) add(balance, times, *grid.balance);
    if (!grid.parts) return;
    add(parts.diffuse, times, grid.parts->diffuse);
    add(parts.glossy, times, grid.parts->glossy);
    add(parts.transmission, times, grid.parts->transmission);
    add(parts.arriving, times, grid.parts->arriving);
    add(parts.unblocked, times, grid.parts->unblocked);
}

void choose_to_go_on(std::vector<LampRound>& rounds, float unseen) {
    if (rounds.empty()) return;
    std::vector<float> level(rounds.front().radiance.size(), 0.0f);
    for (const LampRound& round : rounds)
        for (std::size_t i = 0; i < level.size(); ++i)
            level[i] += luminance(round.radiance[i]) * round.times[i];
    std::vector<double> doubts;
    for (const LampRound& round : rounds) doubts.push_back(doubt_of(round, level));
    std::vector<std::size_t> order(rounds.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t r) { return doubts[r]; });
    double left = 0.0;
    for (const std::size_t r : order) {
        left += doubts[r];
        rounds[r].goes_on = left > static_cast<double>(unseen) * unseen;
    }
}

}  // namespace granita
