// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/sky_table.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/parallel.h"
#include "math/sampling.h"
#include "shade/nodes/multiple_scattering.h"
#include "shade/nodes/single_scattering.h"

namespace granita {
namespace {

constexpr int kRows = 128;  ///< from the horizon to the zenith
constexpr int kColumns = 256;
constexpr float kQuarter = 0.5f * kPi;

/// Below the horizon the light of single scattering fades within 24 degrees.
float fade(float down) {
    const float left = std::clamp(1.0f - 2.5f * down, 0.0f, 1.0f);
    return left * left * left;
}

}  // namespace

SkyTable::SkyTable(SkyModel model, const Atmosphere& air)
    : m_model(model), m_rows_below(model == SkyModel::Nishita ? 0 : kRows) {
    m_texels.resize(static_cast<std::size_t>(m_rows_below + kRows) * kColumns);
    if (model == SkyModel::MultipleScattering)
        fill(MultipleScattering(air));
    else
        fill(SingleScattering(air));
}

/// Texels stand for their middles in multiple scattering, else for a corner; Nishita's rows go half
/// a step beyond the zenith.
template <class Scattering>
void SkyTable::fill(const Scattering& scattering) {
    const bool multiple = m_model == SkyModel::MultipleScattering;
    const float middle = multiple ? 0.5f : 0.0f;
    const float top = kQuarter * (m_model == SkyModel::Nishita ? 1.0f + 0.5f / kRows : 1.0f);
    const auto texel = [&](int row, int column) -> Vec3f& {
        return m_texels[static_cast<std::size_t>((m_rows_below + row) * kColumns + column)];
    };
    const int first = multiple ? -m_rows_below : 0;
    parallel_for(
        static_cast<std::size_t>(kRows - first), 1, [&](std::size_t begin, std::size_t end) {
            for (int row = first + static_cast<int>(begin); row < first + static_cast<int>(end);
                 ++row) {
                const float part = (static_cast<float>(row) + middle) / kRows;
                const float elevation = top * part * std::abs(part);
                for (int column = 0; column < kColumns; ++column) {
                    const float azimuth =
                        kPi - kPi * (static_cast<float>(column) + middle) / kColumns;
                    texel(row, column) = scattering.sky({std::cos(elevation) * std::cos(azimuth),
                                                         std::cos(elevation) * std::sin(azimuth),
                                                         std::sin(elevation)});
                }
            }
        });
    for (int row = -m_rows_below; row < first; ++row) {
        const float part = static_cast<float>(row) / kRows;
        for (int column = 0; column < kColumns; ++column)
            texel(row, column) = fade(std::sin(kQuarter * part * part)) * texel(0, column);
    }
}

Vec3f SkyTable::look_up(float elevation, float azimuth) const {
    if (m_model == SkyModel::Nishita && elevation < 0.0f)
        return fade(-std::sin(elevation)) * look_up(0.0f, azimuth);
    const float away = 1.0f - std::abs(std::remainder(azimuth, 2.0f * kPi)) / kPi;  // 1 = the sun's
    const float height = std::copysign(std::sqrt(std::abs(elevation) / kQuarter), elevation);
    const float x = away * kColumns - 0.5f, y = height * kRows - 0.5f;
    const float x0 = std::floor(x), y0 = std::floor(y);
    const auto at = [&](float column, float row) {
        const int c = std::clamp(static_cast<int>(column), 0, kColumns - 1);
        const int r = std::clamp(static_cast<int>(row), -m_rows_below, kRows - 1) + m_rows_below;
        return m_texels[static_cast<std::size_t>(r * kColumns + c)];
    };
    const Vec3f below = glm::mix(at(x0, y0), at(x0 + 1.0f, y0), x - x0);
    const Vec3f above = glm::mix(at(x0, y0 + 1.0f), at(x0 + 1.0f, y0 + 1.0f), x - x0);
    return glm::mix(below, above, y - y0);
}

std::shared_ptr<const SkyTable> sky_table(SkyModel model, const Atmosphere& air) {
    struct Kept {
        SkyModel model;
        Atmosphere air;
        std::shared_ptr<const SkyTable> table;
    };
    constexpr std::size_t kMost = 4;  // of .8 MB; a frame has a world
    static std::mutex mutex;
    static std::vector<Kept> kept;
    {
        const std::lock_guard lock(mutex);
        for (const Kept& one : kept)
            if (one.model == model && one.air == air) return one.table;
    }
    auto table = std::make_shared<const SkyTable>(model, air);
    const std::lock_guard lock(mutex);
    if (kept.size() == kMost) kept.erase(kept.begin());
    kept.push_back({model, air, table});
    return table;
}

}  // namespace granita
