// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes that have many more faces than the frame has samples on them: each sample's ray, at its
// own time and from its own point of the lens, tells which faces are opened at all.  What opens,
// dices and hides them then is what does all others, so that a picture is the same either way.
#pragma once

#include <memory>

#include "dice/sampled_faces.h"
#include "dice/view.h"
#include "render/sample_levels.h"
#include "shade/rays/mesh_rays.h"
#include "shade/shading_system.h"

namespace granita {

class FacesOfSamples final : public SampledFaces {
  public:
    /// `view`, whose own this may be, `shading` and `progress` must live while instances are
    /// opened; `rays`: where meshes that rays meet are looked for and left.
    FacesOfSamples(const View& view, std::shared_ptr<const SampleLevels> levels,
                   const ShadingSystem& shading, std::shared_ptr<PersistentRays> rays,
                   const Progress& progress);

    std::optional<std::vector<std::uint32_t>> of(
        std::size_t instance, const std::shared_ptr<const SharedGeometry>& shared,
        const Knots& knots) const override;

  private:
    struct Mesh;
    bool lets_through(const Instance& instance) const;
    /// Whether rays are fewer than what they spare.
    bool pays(double rays, const SharedGeometry& shared, const Instance& instance,
              bool goes_on) const;
    std::optional<std::vector<std::uint32_t>> met(const Mesh& mesh, const Rect& pixels) const;
    void look(const Mesh& mesh, const SampleTable& table, Vec2i tile, const Rect& pixels,
              std::vector<std::uint32_t>& patches, MeshRays::Work& work) const;

    const View& m_view;
    std::shared_ptr<const SampleLevels> m_levels;
    const ShadingSystem& m_shading;
    const Progress& m_progress;
    mutable MeshRayStore m_rays;
    std::vector<std::uint32_t> m_instances;  ///< [geometries] that the camera may see
    std::uint64_t m_number;                  ///< of all that there were
};

}  // namespace granita
