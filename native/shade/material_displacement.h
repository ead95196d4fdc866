// SPDX-License-Identifier: GPL-3.0-or-later
// Displacement by the materials' programs, run over many places at once.
//
// A program reads textures over a pixel of the camera, wherever the place may be: so an offset
// depends on the place alone, and neither grids' borders nor what rays meet can be told from it.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "base/report.h"
#include "geometry/displacement.h"
#include "geometry/geometry_cache.h"
#include "shade/nodes/node_compiler.h"

namespace granita {

/// Shared by pictures whose offsets are the same: their largest, by instance.
struct PersistentOffsets {
    std::mutex mutex;
    std::map<std::size_t, float> bounds;
};

class MaterialDisplacement final : public Displacement {
  public:
    /// `programs` [materials]: those that move their surfaces; `kept`: of a picture whose offsets
    /// are the same, or nullptr.  All must outlive this.
    MaterialDisplacement(const Scene& scene,
                         std::vector<std::optional<DisplacementProgram>> programs,
                         std::shared_ptr<GeometryCache> geometries, Report& report,
                         std::shared_ptr<PersistentOffsets> kept);
    ~MaterialDisplacement() override;

    /// Whether any instance is displaced at all.
    bool any() const;
    /// Whether there was something to say of an offset.
    bool has_said() const { return m_has_said; }
    const std::shared_ptr<PersistentOffsets>& kept() const { return m_kept; }
    std::shared_ptr<const void> identity() const override { return m_kept; }
    bool displaces(std::size_t instance) const override;
    float bound(std::size_t instance) const override;
    std::size_t same_as(std::size_t instance) const override;
    void find(std::size_t instance, const SharedGeometry& geometry,
              std::span<const SurfacePlace> places, bool derivatives, Offsets& out) const override;
    void find_beside(std::size_t instance, const SharedGeometry& geometry,
                     std::span<const SurfacePlace> places, Offsets& out) const override;

  private:
    struct Target;
    const DisplacementProgram* program_of(const Instance& instance, const SharedGeometry& geometry,
                                          std::uint32_t face) const;
    const DisplacementProgram* program(std::int32_t material) const;
    /// find(), but for what its bound cuts off.
    void run(std::size_t instance, const SharedGeometry& geometry,
             std::span<const SurfacePlace> places, bool derivatives, Offsets& out) const;
    float kept_bound(std::size_t instance) const;
    float find_bound(std::size_t instance) const;
    float sampled_bound(std::size_t instance, const SharedGeometry& geometry) const;

    const Scene& m_scene;
    std::vector<std::optional<DisplacementProgram>> m_programs;
    std::shared_ptr<GeometryCache> m_geometries;
    Report& m_report;
    std::shared_ptr<PersistentOffsets> m_kept;
    mutable std::atomic<bool> m_has_said{false};
    std::vector<std::unique_ptr<Target>> m_targets;  ///< [instances]; nullptr: not displaced
};

}  // namespace granita
