// SPDX-License-Identifier: GPL-3.0-or-later
// Where on a ray its light is scattered: in proportion to what is scattered and reaches the start,
// or equi-angular about a lamp, whose light that follows (Kulla and Fajardo 2012, "Importance
// Sampling Techniques for Path Tracing in Participating Media"); one of them by chance, weighed by
// the density of all (Veach 1997, 9.2.4).
#pragma once

#include <span>
#include <vector>

#include "shade/lights/light_anchor.h"
#include "shade/rays/ray.h"
#include "shade/volumes/medium.h"

namespace granita {

struct ScatterPlace {
    float distance = 0.0f;
    const MediumPiece* piece = nullptr;
    Vec3f weight{0.0f};  ///< transmittance to the start over the density
};

class ScatterSampler {
  public:
    /// Of pieces along a ray, all of which must outlive this.
    ScatterSampler(const Ray& ray, std::span<const MediumPiece> pieces,
                   std::span<const LightAnchor> anchors);

    /// Light that is scattered all along the ray and reaches the start, of white light from all
    /// sides: mean of the channels.
    float scattered() const { return m_total; }
    /// u in [0, 1)^3; false where nothing is scattered at the place.
    bool sample(const Vec3f& u, ScatterPlace& place) const;

  private:
    /// About a lamp.
    struct Angles {
        float chance;         ///< of being taken
        float nearest, away;  ///< metres: along the ray where it is nearest, and how far then
        float first, last;    ///< radians, of the ends
    };
    float sample_distance(float u, float v) const;
    float density(float distance, const Vec3f& scattered) const;
    std::size_t piece_at(float distance) const;

    std::span<const MediumPiece> m_pieces;
    std::vector<Vec3f> m_before;   ///< [pieces] transmittance from their begin to the start
    std::vector<float> m_until;    ///< [pieces] of m_total, with this one
    std::vector<Angles> m_angles;  ///< of anchors
    float m_total = 0.0f;
};

}  // namespace granita
