// SPDX-License-Identifier: GPL-3.0-or-later
// What all instances of curves or of a point cloud share: which elements (curves, points) can be
// rendered, sorted by place, and their batches.
//
// A million hairs must not be a million primitives: neighbours in space are handed out together and
// split apart only where they are too far from each other or too finely diced for one grid.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/report.h"
#include "math/bounds.h"
#include "scene/geometry_data.h"

namespace granita {

class SharedElements {
  public:
    /// Reports what had to be left out by the geometry's name.
    SharedElements(const GeometryData& data, float frame_time, Report& report);

    const GeometryData& data() const { return *m_data; }
    /// All knots hold the same points and radii.
    bool is_static() const { return m_static; }
    std::size_t batch_count() const { return m_batches.size() - 1; }
    /// Elements of a batch: neighbours in space, of one material slot.
    std::span<const std::uint32_t> batch(std::size_t index) const {
        return {m_order.data() + m_batches[index], m_batches[index + 1] - m_batches[index]};
    }
    std::size_t first_point(std::uint32_t element) const {
        return m_first_point.empty() ? element : m_first_point[element];
    }
    std::size_t point_count(std::uint32_t element) const {
        return m_first_point.empty() ? 1 : m_first_point[element + 1] - m_first_point[element];
    }
    std::int32_t slot(std::uint32_t element) const { return m_data->slot(element); }
    /// The frame time among the geometry's knots.
    std::size_t frame_knot() const { return m_frame_knot; }
    double frame_fraction() const { return m_frame_fraction; }
    /// Object space, at the frame time.
    Vec3d frame_point(std::size_t vertex) const;
    double frame_radius(std::size_t vertex) const;
    /// Of the finite frame points.
    const Bounds3f& frame_box() const { return m_frame_box; }
    std::uint64_t bytes() const;

  private:
    void find_elements(Report& report);
    void sort_by_place();
    void make_batches();

    const GeometryData* m_data;
    bool m_static = true;
    std::size_t m_frame_knot = 0;
    double m_frame_fraction = 0.0;
    Bounds3f m_frame_box;
    std::vector<std::uint32_t> m_first_point;  ///< [curves + 1]; empty for points
    std::vector<std::uint32_t> m_order;        ///< elements that can be rendered, by place
    std::vector<std::uint32_t> m_batches;      ///< [batches + 1] into m_order
};

/// Object-space boxes of the finite points and of the curves through them, one a knot; radii are
/// not in them.
std::vector<Bounds3f> element_boxes(const GeometryData& data);

}  // namespace granita
