// SPDX-License-Identifier: GPL-3.0-or-later
// What rays pass through: pieces in which coefficients are constant, which Beer and Lambert's law
// knows in closed form.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "math/vec.h"
#include "shade/bsdf/lobe.h"

namespace granita {

struct MediumPhase {
    PhaseKind kind = PhaseKind::HenyeyGreenstein;
    Vec2f form{0.0f};                ///< the two numbers of PhaseKind
    Vec3f scattering{0.0f};          ///< coefficient, 1 / metre
    std::uint64_t receives = ~0ULL;  ///< as Instance::receives, of what it fills
};

struct MediumPiece {
    float begin = 0.0f, end = 0.0f;  ///< metres along the ray; the end may be infinite
    Vec3f extinction{0.0f};          ///< coefficient, 1 / metre
    Vec3f scattering{0.0f};          ///< of that, over all phases
    Vec3f emission{0.0f};            ///< radiance a metre
    std::vector<MediumPhase> phases;
};

/// Pieces of many rays, ray after ray; between them there is nothing.
class RayMedia {
  public:
    void clear() {
        pieces.clear();
        m_rays.clear();
    }
    std::size_t ray_count() const { return m_rays.size(); }
    void end_ray() {
        const std::size_t begin = m_rays.empty() ? 0 : m_rays.back().begin + m_rays.back().made;
        const std::size_t count = pieces.size() - begin;
        m_rays.push_back({begin, count, count});
    }
    /// A ray's last pieces are left out, so that it ends with this one.
    void end_with(std::size_t ray, std::size_t piece) {
        m_rays[ray].count = piece + 1 - m_rays[ray].begin;
    }
    std::span<const MediumPiece> of(std::size_t ray) const {
        return {pieces.data() + m_rays[ray].begin, m_rays[ray].count};
    }

    std::vector<MediumPiece> pieces;

  private:
    struct RayPieces {
        std::size_t begin, made, count;
    };
    std::vector<RayPieces> m_rays;
};

/// Share of light that passes so many metres of a piece.
Vec3f passed(const MediumPiece& piece, float length);

/// Where a ray begins to pass what shines or scatters light, or, where that is at its start, where
/// it leaves it; infinite where there is nothing such, or no end.
float first_light(std::span<const MediumPiece> pieces);

/// Along a ray, from where it starts.
class MediumWalk {
  public:
    explicit MediumWalk(std::span<const MediumPiece> pieces) : m_rest(pieces) {}
    /// Goes on to `distance`; returns what is emitted on the way there and reaches the start.
    Vec3f advance(float distance);
    /// Of light that comes from where the walk has got to.
    const Vec3f& transmittance() const { return m_transmittance; }

  private:
    std::span<const MediumPiece> m_rest;
    float m_at = 0.0f;
    Vec3f m_transmittance{1.0f};
};

}  // namespace granita
