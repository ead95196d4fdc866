// SPDX-License-Identifier: GPL-3.0-or-later
// Curves or a point cloud as the camera sees them.  A primitive is a batch of neighbours
// (geometry/shared_elements.h); points are taken to camera space where they are needed, so that a
// million moving hairs cost no more memory than their snapshot.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "dice/edge_rate.h"
#include "dice/knots.h"
#include "dice/primitive.h"
#include "dice/view.h"
#include "geometry/element_values.h"
#include "geometry/shared_elements.h"

namespace granita {

/// Metres that a radius of 1 takes after a transform: a sphere's of the same volume.
double uniform_scale(const Mat4d& m);

/// A transform that makes circles ellipses.
struct UnevenScale {
    bool is_uneven = false;
    double largest = 1.0;  ///< no length grows more than so
    Mat3d camera_from_object{1.0}, object_from_camera{1.0};

    explicit UnevenScale(const Mat4d& m);
};

/// Camera space, metres.
struct ElementPoint {
    Vec3d p{0.0};
    double radius = 0.0;
};

class OpenedElements final : public OpenedInstance,
                             public std::enable_shared_from_this<OpenedElements> {
  public:
    OpenedElements(const View& view, std::size_t instance,
                   std::shared_ptr<const SharedElements> shared, Knots knots, Report& report);

    std::size_t primitive_count() const override { return m_shared->batch_count(); }
    RasterBounds bounds(std::size_t primitive) const override;
    std::unique_ptr<Primitive> primitive(std::size_t primitive) const override;
    std::uint64_t bytes() const override { return sizeof(*this); }

    ElementPoint point(int knot, std::size_t vertex) const;
    /// From the eye to `p`, of any length: the way along which it is seen.
    Vec3d view_direction(const Vec3d& p) const {
        return view().projection.perspective ? p : Vec3d(0.0, 0.0, 1.0);
    }
    /// Pixels that a length across the view takes at `p`; near the eye those at the near clip.
    double pixels(const Vec3d& p, double length) const;

    const View& view() const { return *m_view; }
    const Instance& instance() const { return *m_instance; }
    const SharedElements& shared() const { return *m_shared; }
    int knot_count() const { return m_knots.count; }
    const Knots& knots() const { return m_knots; }
    const EdgeRate& rate() const { return m_rate; }
    /// Along a curve of this largest width, pixels.  The dicing rate means areas: what is narrow
    /// has long micropolygons.
    const EdgeRate& rate_along(double width) const;
    Report& report() const { return *m_report; }
    int grid_size() const;
    /// Of curves alone: their radii are those of the largest scale where it is uneven.
    const UnevenScale& uneven_scale(int knot) const {
        return m_uneven[static_cast<std::size_t>(knot)];
    }

    /// A grid of this instance for a batch: its identity, material and size; every vertex at every
    /// knot at the origin.  u runs along the elements, one after the other, so that the hider finds
    /// long rows.
    std::unique_ptr<Grid> make_grid(std::size_t batch, std::uint64_t path, int along,
                                    int across) const;
    /// Shading positions, and room for normals and offsets of rays.
    void begin_shading(Grid& grid) const;
    /// Once these are set: share, derivatives and attributes.  `places` [n_u + 1]; those of one
    /// element follow each other.
    void finish_shading(Grid& grid, std::span<const ElementPlace> places) const;
    /// Of a grid of triangles, one for each of `places`; `next` [places]: to which their
    /// derivatives lead.
    void fill_attributes(Grid& grid, std::span<const ElementPlace> places,
                         std::span<const ElementPlace> next) const;
    /// How much a knot counts at the frame time.
    double frame_weight(int knot) const {
        return knot == m_knots.frame_knot       ? 1.0 - m_knots.frame_fraction
               : knot == m_knots.frame_knot + 1 ? m_knots.frame_fraction
                                                : 0.0;
    }

  private:
    int material(std::size_t batch) const;
    void finish_derivatives(Grid& grid, std::span<const ElementPlace> places) const;
    /// [places][request.width]
    std::vector<float> values_at(const AttributeRequest& request,
                                 std::span<const ElementPlace> places) const;
    void finish_attributes(Grid& grid, std::span<const ElementPlace> places) const;

    const View* m_view;
    const Instance* m_instance;
    std::size_t m_instance_index;
    std::shared_ptr<const SharedElements> m_shared;
    Knots m_knots;
    Report* m_report;
    EdgeRate m_rate;
    EdgeRate m_long_rates[2];           ///< twice, four times
    std::vector<KnotTime> m_times;      ///< [knots] among the geometry's own
    std::vector<double> m_scales;       ///< [knots] metres of camera space in one of object space
    std::vector<UnevenScale> m_uneven;  ///< [knots]
};

}  // namespace granita
