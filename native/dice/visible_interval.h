// SPDX-License-Identifier: GPL-3.0-or-later
// When within the shutter a piece of an edge can be seen.
//
// What passes the camera, or a camera that pans, takes pieces out of the frame and through the eye
// plane, where raster lengths have no limit.  A knot outside of the frame is no measure for what
// the frame shows; the moment on the way to its neighbour at which the piece comes in is.  (A pan
// by 90 degrees past nine squares was diced into 7 million points, and is now into 830.)
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "math/projection.h"
#include "math/vec.h"

namespace granita {

class VisibleInterval {
  public:
    /// A perspective projection's frame, pixels.
    VisibleInterval(const Projection& projection, double width, double height);

    /// visit(start, middle, end), camera space: at each knot at which the piece may be in the
    /// frame, and where it comes into the frame on the way from another knot to its neighbours.
    /// pass_by(start, middle, end): at the other knots.
    template <class Visit, class PassBy>
    void for_each(const Vec3f* start, const Vec3f* middle, const Vec3f* end, int knots, Visit visit,
                  PassBy pass_by) const {
        for (int k = 0; k < knots; ++k) {
            const Piece here = piece(start[k], middle[k], end[k]);
            if (is_in(here)) {
                visit(start[k], middle[k], end[k]);
                continue;
            }
            pass_by(start[k], middle[k], end[k]);
            // What comes out of the eye plane is large for a moment alone: its knots tell.
            if (is_outside(here, kNear)) continue;
            for (const int j : {k - 1, k + 1}) {
                if (j < 0 || j >= knots) continue;
                const double t = entry(here, piece(start[j], middle[j], end[j]));
                if (t > 1.0) continue;
                const auto at = [&](const Vec3f* p) { return glm::mix(p[k], p[j], t); };
                visit(at(start), at(middle), at(end));
            }
        }
    }

  private:
    /// Left, right, bottom, top and the near plane.
    static constexpr int kSides = 5, kNear = 4;
    using Distances = std::array<double, kSides>;  ///< 0 or more: inside; linear in the place
    using Piece = std::array<Distances, 3>;

    Distances distances(const Vec3f& p) const;
    Piece piece(const Vec3f& a, const Vec3f& b, const Vec3f& c) const {
        return {distances(a), distances(b), distances(c)};
    }
    static bool is_outside(const Piece& p, int side) {
        return std::max({p[0][side], p[1][side], p[2][side]}) < 0.0;
    }
    static bool is_in(const Piece& p);
    /// The part of the way from `here`, which is outside, to `there` after which the piece is
    /// outside of no side any more; infinite where it stays outside.
    static double entry(const Piece& here, const Piece& there);

    Projection m_projection;
    double m_width, m_height;
};

}  // namespace granita
