// SPDX-License-Identifier: GPL-3.0-or-later
// The surface itself at places of a patch, object space: where displacement starts from.
#pragma once

#include <span>
#include <vector>

#include "geometry/shared_geometry.h"

namespace granita {

/// At n places at a time.  Derivatives by u and v of the patch.
struct SurfaceFrames {
    std::vector<Vec3d> p, su, sv;
    std::vector<Vec3d> normal;            ///< unit, shading, outward as modelled
    std::vector<Vec3d> geometric_normal;  ///< unit

    void clear() {
        for (auto* values : {&p, &su, &sv, &normal, &geometric_normal}) values->clear();
    }
};

/// `time`: among the geometry's knots.
void find_frames(const SharedGeometry& geometry, const BasePatch& patch, std::span<const Vec2d> uv,
                 const KnotTime& time, SurfaceFrames& out);
/// After those that are there already.
void add_frames(const SharedGeometry& geometry, const BasePatch& patch, std::span<const Vec2d> uv,
                const KnotTime& time, SurfaceFrames& out);

/// Where shading normals are not the face's own.
struct SmoothFace {
    Vec3d p[4], normal[4];  ///< of the corners at a time, object space; normals unit
};

/// False: the face has no normals but its own.  Of polygons; not of what is subdivided.
bool find_smooth_face(const SharedGeometry& geometry, const BasePatch& patch, const KnotTime& time,
                      SmoothFace& out);

/// [surface_knots()][n]
void find_positions(const SharedGeometry& geometry, const BasePatch& patch,
                    std::span<const Vec2d> uv, std::vector<Vec3f>& out);

}  // namespace granita
