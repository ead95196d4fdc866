// SPDX-License-Identifier: GPL-3.0-or-later
// Curves and points for rays: ribbons that face the ray along Catmull-Rom curves, which shade as
// tubes do, and spheres.
#pragma once

#include <memory>
#include <vector>

#include "base/report.h"
#include "geometry/shared_elements.h"
#include "shade/rays/ray_shape.h"

namespace granita {

class RayElements final : public RayShape {
  public:
    /// `located`: locate() will be asked.
    RayElements(const GeometryData& data, float frame_time, bool located);

    std::vector<RayPart> hand_over(RTCDevice device) override;
    std::string size() const override;
    int knots() const override { return m_knots; }
    float extent(std::uint32_t) const override { return m_extent; }
    /// Rays start outside of their own element (Grid::ray_offset).
    float error(std::uint32_t) const override { return 0.0f; }
    void locate(std::uint32_t geometry, std::uint32_t primitive, float u, float v,
                RayHit& hit) const override;
    std::size_t bytes() const override;

  private:
    /// x, y, z and radius of a vertex at a knot, or at the frame time where it does not deform.
    void write(int knot, std::size_t vertex, float* out) const;
    void fill_curves(int knot, float* out) const;

    const GeometryData* m_data;
    Report m_report;  ///< what cannot be diced is reported by dicing, which reads the same data
    std::unique_ptr<SharedElements> m_shared;
    int m_knots = 1;
    float m_extent = 0.0f;
    /// [curves with segments] the curve and its first segment; empty for points.
    std::vector<std::uint32_t> m_curves, m_first_segment;
    std::uint32_t m_segments = 0;
};

}  // namespace granita
