// SPDX-License-Identifier: GPL-3.0-or-later
// How finely an edge is diced: a binary tree over the edge, decided from the edge alone, so that
// neighbours agree without asking each other (Fisher et al. 2009, "DiagSplit", section 3).
//
// A piece of an edge is bisected at its parametric middle while
//   its projected length exceeds sqrt(2) * target, so that lengths end in
//   (target / sqrt(2), sqrt(2) * target], or
//   its middle lies more than kSag pixels, or kBend of its length, off its chord and it is longer
//   than kShortest pixels.
// Lengths are the largest over all knots at which the piece may be seen (visible_interval.h).
// target is the dicing rate inside the frame and grows by an eighth of a pixel for each pixel that
// the piece's swept bound lies outside of it.
//
// What is blurred needs less (the motion and focus factors of RenderMan).  Motion blurs along its
// way alone: of a piece that goes L pixels, that part of its length which lies along counts max(1,
// motion_factor L / 16) times less.  A lens blurs everything: target and sag grow max(1,
// focus_factor D / 16) times, D the smallest diameter of the piece's circle of confusion.  With a
// factor of 1 (L: of what a row of a rolling shutter sees) vertices are a sixteenth of the blur
// apart, and of shading detail that they miss (waves shorter than an eighth of the blur) no more
// than 1 / (8 pi) = 4 % would have been seen.
//
// What displacement moves does not stay as it lies: of a plain that is seen edge-on it makes hills.
// Its pieces are as long as if they faced the eye (RenderMan's "rasterorient" 0), or hills had the
// detail of what lay there before.
//
// Near the eye plane raster lengths have no limit, and behind it they mean nothing.  What the frame
// does not show, or only in part, is therefore measured from the eye as well: it is bisected while
// it is longer than half its distance, so that sizes grade evenly around the camera and the work is
// a constant for each doubling of the distance; and outside the frame its raster length counts for
// no more than its angle.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "dice/knots.h"
#include "dice/view.h"
#include "dice/visible_interval.h"

namespace granita {

class EdgeRate {
  public:
    /// `longer`: times the dicing rate of the view; `displaced`: so is what is diced.
    explicit EdgeRate(const View& view, double longer = 1.0, bool displaced = false);

    /// A piece stays whole, has a uniform tree of so many levels below it, or is adaptive: bisected
    /// once, its halves looked at anew.
    static constexpr int kAdaptive = -1;

    /// `start`, `middle`, `end` [knots] camera space, in the edge's own direction.  At most
    /// `budget` levels.  The piece counts as no farther outside the frame than `most_outside`
    /// pixels.
    int levels(const Vec3f* start, const Vec3f* middle, const Vec3f* end, int knots, int budget,
               double most_outside = std::numeric_limits<double>::infinity()) const;
    /// The same for a straight piece that is probably short enough: true where levels() is 0.
    bool stays_whole(const Vec3f* start, const Vec3f* end, int knots) const;
    /// levels() of a straight piece that lies in the frame, before the near plane, at every knot
    /// (in_frame()), by its length alone and in single precision; kUnsure where rounding could
    /// change the answer.  A third of the time.
    int sure_levels(const Vec3f* start, const Vec3f* end, int knots) const;
    static constexpr int kUnsure = -2;
    /// What counts of a straight piece in single precision, length2(), is below this where
    /// levels() of it is surely 0.
    float sure_length() const {
        // Displaced, a piece that recedes counts for a little more by its halves than as a whole.
        return static_cast<float>((m_displaced ? 0.99 : 0.999) * M_SQRT2 * m_rate);
    }
    /// Whether what lies in these boxes, [knots] in camera space, does so.
    bool in_frame(std::span<const Bounds3f> boxes) const;
    /// The dicing rate, pixels; never 0.
    double rate() const { return m_rate; }
    /// Distance of shaded points, pixels: the dicing rate, or coarser.
    double shading_rate() const { return m_shading_rate; }
    /// How many levels finer what displacement makes rough may be: as many as samples tell.
    int most_rough_levels() const { return m_most_rough; }
    /// Pixels of a piece if it faced the eye.
    double facing_length(const Vec3f& a, const Vec3f& b) const {
        const double depth = m_projection.perspective ? std::max(0.5 * (a.z + b.z), m_near) : 1.0;
        return std::max(m_projection.scale.x, m_projection.scale.y) / depth *
               glm::length(Vec3d(b - a));
    }
    /// Whether a point, [knots], lies within the frame at the frame time and is not so blurred that
    /// there are fewer vertices around it.
    bool shows_sharp(const Vec3f* p, int knots, int frame) const;
    /// Pixels from the frame to a swept bound; 0 where they overlap.
    double outside(const RasterBounds& bounds) const;
    bool inside(const RasterBounds& bounds) const;

    /// The square of what counts of a straight piece's length, which is `there` in the raster.
    float length2(const Vec2f& there, const Vec3f& a, const Vec3f& b) const {
        return glm::dot(there, there) + static_cast<float>(unseen2(Vec2d(there), a, b));
    }

    /// How many times more vertices there would be around a moving point, were it not for its blur.
    double spared(const Vec3f* p, int knots) const;

  private:
    struct Swept;
    /// How much coarser a piece is diced along its motion, and all over.
    struct Blur {
        Vec2d direction{0.0};
        double along = 1.0, all = 1.0;
        /// Of a piece in the raster.
        double length(const Vec2d& piece) const {
            return glm::length(piece -
                               direction * (glm::dot(piece, direction) * (1.0 - 1.0 / along)));
        }
    };
    Blur blur(const Vec3f* start, const Vec3f* middle, const Vec3f* end, int knots) const;
    /// What moves from one place to another; false where it comes through the near plane.
    bool add_motion(Blur& blur, const Vec3f& first, const Vec3f& last) const;
    /// `depths(knot)`: camera-space z of its places.
    template <class Depths>
    void add_lens(Blur& blur, int knots, Depths depths) const;
    /// Adds the piece's raster box and returns it as seen in the raster at one knot.
    Vec2d add(Swept& swept, const Vec3f& a, const Vec3f& b) const;
    /// Adds a place, not behind the near plane; returns it.
    Vec2d add_place(Swept& swept, const Vec3d& p) const;
    /// As seen in the raster, before the near plane.
    Vec2f piece(const Vec3f& a, const Vec3f& b) const {
        const float u = m_projection.perspective ? 1.0f / a.z : 1.0f;
        const float v = m_projection.perspective ? 1.0f / b.z : 1.0f;
        return Vec2f(m_projection.scale) * (Vec2f(b) * v - Vec2f(a) * u);
    }
    /// The square of what counts of a piece but is not seen in the raster, where it is `there`.
    double unseen2(const Vec2d& there, const Vec3f& a, const Vec3f& b) const {
        if (!m_displaced) return 0.0;
        const double facing = facing_length(a, b);
        return std::max(facing * facing - glm::dot(there, there), 0.0);
    }
    /// What counts of a piece's length, which is `seen` of it.
    double length(double seen, const Vec2d& there, const Vec3f& a, const Vec3f& b) const {
        return m_displaced ? std::sqrt(seen * seen + unseen2(there, a, b)) : seen;
    }
    /// Pixels from the frame to the box.
    double outside(const Swept& swept) const;
    /// Length over distance from the eye, the largest over the knots.
    double angle(const Vec3f* start, const Vec3f* middle, const Vec3f* end, int knots) const;

    Projection m_projection;
    double m_rate, m_shading_rate, m_width, m_height;
    double m_motion_factor, m_focus_factor;
    bool m_displaced;
    int m_most_rough;
    double m_near;
    float m_rounding;  ///< of a length in single precision, pixels
    VisibleInterval m_seen;
};

}  // namespace granita
