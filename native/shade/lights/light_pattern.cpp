// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/light_pattern.h"

#include <algorithm>
#include <cmath>

#include "math/luminance.h"
#include "math/normalize_or.h"

namespace granita {
namespace {

/// Half a degree and less: as fine as photometric files are measured.
constexpr int kRows = 361, kColumns = 720;

class PatternedLight : public LightSource {
  public:
    PatternedLight(std::unique_ptr<LightSource> source, std::shared_ptr<const LightPattern> pattern,
                   const Mat3d& axes)
        : m_source(std::move(source)), m_pattern(std::move(pattern)) {
        // Directions turn with the lamp, whatever its scale.
        for (int i = 0; i < 3; ++i) {
            Vec3f axis(0.0f);
            axis[i] = 1.0f;
            m_world_from_light[i] = normalize_or(Vec3f(axes[i]), axis);
        }
    }

    bool is_hard() const override { return m_source->is_hard(); }
    void sample_all(const Vec3f& p, std::span<const Vec2f> u,
                    std::span<LightSample> samples) const override {
        m_source->sample_all(p, u, samples);
        m_pattern->color(samples, m_world_from_light);
    }
    bool intersect(const Vec3f& p, const Vec3f& direction, LightSample& sample) const override {
        if (!m_source->intersect(p, direction, sample)) return false;
        m_pattern->color({&sample, 1}, m_world_from_light);
        return true;
    }
    bool bound(Vec3f& center, float& radius) const override {
        return m_source->bound(center, radius);
    }
    LightEmission emission() const override {
        LightEmission out = m_source->emission();
        out.intensity *= m_pattern->largest();
        return out;
    }

  private:
    std::unique_ptr<LightSource> m_source;
    std::shared_ptr<const LightPattern> m_pattern;
    Mat3f m_world_from_light{1.0f};
};

}  // namespace

float largest_finite(std::vector<Vec3f>& values) {
    float largest = 0.0f;
    for (Vec3f& value : values) {
        if (!is_finite(value)) value = Vec3f(0.0f);
        largest = std::max(largest, mean_size(value));
    }
    return largest;
}

std::vector<Vec3f> DirectionTable::directions() {
    std::vector<Vec3f> found;
    found.reserve(static_cast<std::size_t>(kRows) * kColumns);
    for (int row = 0; row < kRows; ++row) {
        const float off = kPi * static_cast<float>(row) / (kRows - 1);
        for (int column = 0; column < kColumns; ++column) {
            const float turn = 2.0f * kPi * static_cast<float>(column) / kColumns;
            found.emplace_back(std::sin(off) * std::cos(turn), std::sin(off) * std::sin(turn),
                               -std::cos(off));
        }
    }
    return found;
}

DirectionTable::DirectionTable(std::vector<Vec3f> values)
    : m_values(std::move(values)), m_largest(largest_finite(m_values)) {}

void DirectionTable::color(std::span<LightSample> samples, const Mat3f& world_from_light) const {
    for (LightSample& sample : samples)
        if (sample.pdf > 0.0f) sample.radiance *= at(-sample.direction * world_from_light);
}

Vec3f DirectionTable::at(const Vec3f& direction) const {
    const float off = std::acos(std::clamp(-direction.z, -1.0f, 1.0f));
    const float turn = std::atan2(direction.y, direction.x) / (2.0f * kPi);
    const float y = off / kPi * (kRows - 1), x = (turn - std::floor(turn)) * kColumns;
    const int y0 = std::min(static_cast<int>(y), kRows - 2);
    const int x0 = static_cast<int>(x) % kColumns, x1 = (x0 + 1) % kColumns;
    const auto value = [&](int row, int column) {
        return m_values[static_cast<std::size_t>(row * kColumns + column)];
    };
    const float along = x - std::floor(x), down = y - static_cast<float>(y0);
    return glm::mix(glm::mix(value(y0, x0), value(y0, x1), along),
                    glm::mix(value(y0 + 1, x0), value(y0 + 1, x1), along), down);
}

std::unique_ptr<LightSource> with_pattern(std::unique_ptr<LightSource> source,
                                          std::shared_ptr<const LightPattern> pattern,
                                          const Mat3d& axes) {
    return std::make_unique<PatternedLight>(std::move(source), std::move(pattern), axes);
}

}  // namespace granita
