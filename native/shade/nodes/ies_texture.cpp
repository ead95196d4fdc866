// SPDX-License-Identifier: GPL-3.0-or-later
// IES Texture: how strong a luminaire is in a direction, from a table over two angles
// (addon/export/shading/ies.py), interpolated with cubics as in Cycles.
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "math/normalize_or.h"
#include "math/sampling.h"
#include "shade/nodes/coordinates.h"
#include "shade/nodes/lamp_coordinates.h"
#include "shade/nodes/nodes.h"

namespace granita {
namespace {

/// What Cycles shows of a file that it cannot read.
constexpr float kUnread = 100.0f;
constexpr float kClose = 1e-7f;

/// Catmull and Rom's, between b (0) and c (1).
float cubic(float a, float b, float c, float d, float x) {
    return b +
           0.5f * x *
               (c - a + x * (2.0f * a - 5.0f * b + 4.0f * c - d + x * (d + 3.0f * (b - c) - a)));
}

/// The segment of ascending angles that holds one, and where in it; false outside of them.
bool find(const std::vector<float>& angles, float angle, std::size_t& at, float& fraction) {
    if (!(angle >= angles.front()) || angle >= angles.back()) return false;
    const auto end = std::lower_bound(angles.begin() + 1, angles.end(), angle);
    at = static_cast<std::size_t>(end - angles.begin()) - 1;
    fraction = (angle - angles[at]) / (angles[at + 1] - angles[at]);
    return true;
}

/// What a cubic takes for values beyond a table that does not go all around.
enum class Beyond {
    Mirrored,  ///< as before Blender 4: it always does; below straight down the other side's
    Nothing,   ///< as in Blender 4
    Nearest,   ///< since Blender 5
};

class Luminaire {
  public:
    Luminaire(std::vector<float> around, std::vector<float> up, std::vector<float> intensity,
              Beyond beyond)
        : m_around(std::move(around)),
          m_up(std::move(up)),
          m_intensity(std::move(intensity)),
          m_beyond(beyond) {}

    bool is_there() const {
        return m_around.size() > 1 && m_up.size() > 1 &&
               m_intensity.size() == m_around.size() * m_up.size();
    }

    /// @param direction unit, away from it.
    float at(const Vec3f& direction) const {
        const float up = std::acos(std::clamp(-direction.z, -1.0f, 1.0f));
        const float around = std::atan2(direction.x, direction.y) + kPi;
        std::size_t row = 0, column = 0;
        float along = 0.0f, above = 0.0f;
        if (!find(m_around, around, row, along) || !find(m_up, up, column, above)) return 0.0f;
        const auto value = [&](std::size_t r) { return in_row(r, column, above); };
        const std::size_t last = m_around.size() - 1;
        const float here = value(row);
        // All around the last row is the first again.
        const bool closed = m_beyond == Beyond::Mirrored ||
                            (m_around.front() < kClose && m_around.back() > 2.0f * kPi - kClose);
        // Cycles goes on with the same value on both sides.
        const float outside = m_beyond == Beyond::Nearest ? here : 0.0f;
        const float before = row > 0 ? value(row - 1) : closed ? value(last - 1) : outside;
        const float after = row + 2 <= last ? value(row + 2) : closed ? value(1) : outside;
        return std::max(cubic(before, here, value(row + 1), after, along), 0.0f);
    }

  private:
    /// Over the poles it goes on as it came.
    float in_row(std::size_t row, std::size_t column, float fraction) const {
        const std::size_t last = m_up.size() - 1;
        const float* v = m_intensity.data() + row * m_up.size();
        const bool old = m_beyond == Beyond::Mirrored, near = m_beyond == Beyond::Nearest;
        float before = near ? v[column] : 0.0f, after = near || old ? v[column + 1] : 0.0f;
        if (column > 0)
            before = v[column - 1];
        else if (old || m_up.front() < kClose)
            before = v[1];
        if (column + 2 <= last)
            after = v[column + 2];
        else if (!old && m_up.back() > kPi - kClose)
            after = v[last - 1];
        return cubic(before, v[column], v[column + 1], after, fraction);
    }

    std::vector<float> m_around, m_up;  ///< radians
    std::vector<float> m_intensity;     ///< [around][up]
    Beyond m_beyond;
};

/// Towards who looks, in the object's axes.
VectorSource object_view(NodeBuilder& b) {
    if (b.lamp()) return lamp_view(b);
    if (b.is_world()) return object_normal(b);
    return b.geometry<Vec3f>([](const ShadingInput& in, std::size_t i) {
        return glm::transpose(in.axes_at(i).world_from_object) * in.points->view[i];
    });
}

}  // namespace

void build_ies_texture(NodeBuilder& b) {
    const Beyond beyond = !b.since(4, 0)  ? Beyond::Mirrored
                          : b.since(5, 0) ? Beyond::Nearest
                                          : Beyond::Nothing;
    const auto luminaire = std::make_shared<const Luminaire>(b.table("around"), b.table("up"),
                                                             b.table("intensity"), beyond);
    const FloatSource strength = b.number("Strength", 1.0f);
    if (!luminaire->is_there()) {
        b.warn("has no photometric file that can be read");
        b.output("Fac", b.map<float>([](float s) { return kUnread * s; }, strength));
        return;
    }
    const VectorSource direction = b.linked("Vector") ? b.vector("Vector") : object_view(b);
    b.output("Fac", b.map<float>(
                        [luminaire](float s, const Vec3f& d) {
                            return s * luminaire->at(normalize_or(d, Vec3f(0.0f)));
                        },
                        strength, direction));
}

}  // namespace granita
