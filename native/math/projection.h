// SPDX-License-Identifier: GPL-3.0-or-later
// Camera space -> raster space, perspective and orthographic, with a thin lens; the one place that
// knows the formula.  Camera space: x right, y up, z forward, metres.  Raster: pixels, origin lower
// left.
//
// A camera-space point P = (x, y, z) is seen from lens point L = (lx, ly) (metres, in the lens
// plane) at
//   perspective   X = cx + sx * (x + lx * (z / focus - 1)) / z
//   orthographic  X = cx + sx * (x + lx * (z / focus - 1))
// (thin lens: Potmesil and Chakravarty 1981; lens_radius and focus may move:
// scene/lens_knots.h).  Both are kept homogeneous, h = (X*w, Y*w, w) with w = z or w = 1, which is
// linear in P: motion interpolates h and nothing is ever divided before coverage.
#pragma once

#include <algorithm>
#include <cmath>

#include "math/vec.h"

namespace granita {

struct Projection {
    bool perspective = true;
    Vec2d scale{1.0};   ///< sx, sy: pixels per unit slope (perspective) or per metre (orthographic)
    Vec2d center{0.0};  ///< cx, cy: where the optical axis meets the raster, pixels
    double near_clip = 0.01, far_clip = 1000.0;  ///< camera-space z, metres
    double lens_radius = 0.0;                    ///< metres, its longer half axis; 0 = pinhole
    double lens_ratio = 1.0;                     ///< of its height to its width (anamorphic)
    double focus = 10.0;                         ///< camera-space z of the sharp plane, metres
    // Within the shutter the lens may close and focus farther away (Camera::lens): the two above
    // are then the widest and the nearest, and these, metres, the way from there.
    double lens_closing = 0.0, focus_travel = 0.0;
    bool operator==(const Projection&) const = default;

    bool has_lens() const { return lens_radius > 0.0; }
    /// Half axes of the lens, of lens_radius: neither is beyond 1, which all bounds rely on.
    Vec2d lens_extent() const {
        return {std::min(1.0, 1.0 / lens_ratio), std::min(1.0, lens_ratio)};
    }
    double farthest_focus() const { return focus + focus_travel; }
    /// Farthest that the lens shifts what lies at depth z, at any time: metres in h's units.
    double lens_reach(double z) const {
        if (!has_lens()) return 0.0;
        // |z / focus - 1| is convex in 1 / focus.
        const double near = std::abs(z / focus - 1.0);
        return lens_radius *
               (focus_travel > 0.0 ? std::max(near, std::abs(z / farthest_focus() - 1.0)) : near);
    }

    /// Homogeneous raster coordinates relative to `origin` (pixels), subtracted in double and
    /// rounded once (decision 2): a tile's own coordinates keep sub-pixel bits at pixel 16,000.
    Vec3f homogeneous(const Vec3f& p, const Vec2d& origin) const {
        const double w = perspective ? static_cast<double>(p.z) : 1.0;
        return {static_cast<float>(scale.x * p.x + (center.x - origin.x) * w),
                static_cast<float>(scale.y * p.y + (center.y - origin.y) * w),
                static_cast<float>(w)};
    }

    /// Larger is nearer: 1/z in perspective, -z in orthographic; affine in raster space over a
    /// plane.
    float depth_key(float z) const { return perspective ? 1.0f / z : -z; }
    float depth_from_key(float key) const { return perspective ? 1.0f / key : -key; }
};

}  // namespace granita
