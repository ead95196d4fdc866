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
        m_ends.clear();
    }
    void end_ray() { m_ends.push_back(pieces.size()); }
    std::span<const MediumPiece> of(std::size_t ray) const {
        const std::size_t begin = ray == 0 ? 0 : m_ends[ray - 1];
        return {pieces.data() + begin, m_ends[ray] - begin};
    }

    std::vector<MediumPiece> pieces;

  private:
    std::vector<std::size_t> m_ends;
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
