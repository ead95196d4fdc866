// SPDX-License-Identifier: GPL-3.0-or-later
// Part of a curve in camera space at every knot: what bounding and dicing ask of it.
//
// Places along a curve are numbers in [0, segments]; whole ones are its points.
#pragma once

#include <cstdint>
#include <vector>

#include "dice/opened_elements.h"
#include "geometry/catmull_rom.h"
#include "math/bounds.h"

namespace granita {

/// A ribbon's cross-section at a knot.
struct RibbonRow {
    Vec3d center{0.0};
    Vec3d across{0.0};  ///< from the centre to the ribbon's edge
    Vec3d along{0.0};   ///< the axis's way, of any length
    Vec3d facing{0.0};  ///< unit, the ribbon's normal, towards the eye
    /// The tube's normal at the edge, as long as that of `facing` at the centre: a unit, but where
    /// its scale is uneven.
    Vec3d side{0.0};
    Vec3d rise{0.0};  ///< from the centre to where the tube comes nearest to the eye
};

class CurveControl {
  public:
    /// What [lo, hi] needs of a curve.
    void gather(const OpenedElements& elements, std::uint32_t curve, double lo, double hi);

    int segments() const { return m_segments; }
    ElementPoint at(int knot, double t) const;
    /// `with_facing`: shading asks for it, places do not.
    RibbonRow row(int knot, double t, bool with_facing) const;
    ElementPlace place(double t) const;
    /// Of the curve's part [lo, hi] at a knot, its width included.
    Bounds3f box(int knot, double lo, double hi) const;
    /// Of its points, the largest width at any knot, pixels.
    double width_pixels() const { return m_width; }
    /// Appends the ends of the steps that dice [lo, hi], until there are more than `most`.
    void steps(double lo, double hi, std::size_t most, std::vector<double>& ends) const;

  private:
    struct Span {
        const ElementPoint* p[4];
        double t;
        ElementPoint at(const CatmullRom& basis) const;
        Vec3d tangent(const CatmullRom& basis) const;
    };
    Span span(int knot, double t) const;
    Vec3d tangent(int knot, double t) const;
    /// The curve's direction where it has no tangent; zero where all its points are one.
    Vec3d arrival(int knot, double t) const;
    /// Pixels from lo to hi as seen at a knot: over the curve's points, and straight.
    struct Way {
        double along, straight;
    };
    Way way(int knot, double lo, double hi) const;

    const OpenedElements* m_elements = nullptr;
    std::uint32_t m_curve = 0;
    double m_width = 0.0;
    int m_segments = 0, m_first = 0, m_count = 0;
    std::vector<ElementPoint> m_points;  ///< [knots][m_count]
};

/// Levels of bisection inside a segment: 2^-25 of it is less than anything that can be seen.
inline constexpr int kMostCurveLevels = 25;

/// Where a part of a curve is cut: at a point while it holds one inside, then in the middle.
double curve_middle(double lo, double hi);

}  // namespace granita
