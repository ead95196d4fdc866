// SPDX-License-Identifier: GPL-3.0-or-later
// Places where media scatter light, as points that DirectLight lights: their lobes are phase
// functions, one for each kind in the frame, so that sequences do not depend on what else is in a
// batch.  Of several at a place, as where volumes overlap, one is taken by chance.
#pragma once

#include <set>

#include "shade/bsdf/lobe.h"
#include "shade/rays/ray.h"
#include "shade/volumes/scatter_sampler.h"

namespace granita {

class ScatterPoints {
  public:
    /// After `depth` surfaces and places like these.  `light_samples`: Options::light_samples;
    /// `kinds`: Volumes::phase_kinds().
    ScatterPoints(std::uint32_t depth, int light_samples, const std::set<PhaseKind>& kinds);

    /// `place_in_sequence`: in the sample sequences of the frame; `u` in [0, 1).
    void add(const Ray& ray, const ScatterPlace& at, std::uint32_t place_in_sequence, float u);
    /// Once all are added.
    void finish();

    const ShadingPoints& points() const { return m_points; }
    const SurfaceClosure& closure() const { return m_closure; }

  private:
    ShadingPoints m_points;
    SurfaceClosure m_closure;
};

/// In [0, 1)^4, for a way after `depth` surfaces; `seed`: Options::seed.
Vec4f scatter_numbers(std::uint32_t seed, std::uint32_t depth, std::uint32_t place_in_sequence);

}  // namespace granita
