// SPDX-License-Identifier: GPL-3.0-or-later
// The motion knots of an instance as the camera sees it: its own transform's, its geometry's and
// the camera's knots brought to one equidistant set (decision 8).
#pragma once

#include <vector>

#include "math/vec.h"
#include "scene/knot_time.h"
#include "scene/scene.h"

namespace granita {

/// Enough for 128 segments, the most that Blender can ask of a moving thing.
inline constexpr int kMaxKnots = 129;

struct Knots {
    int count = 1;
    /// More segments would have been needed to hold every knot exactly: what moves at knots left
    /// out is approximated.
    bool capped = false;
    /// [count] camera from object, composed in double (decision 9).
    std::vector<Mat4d> camera_from_object;
    /// At the frame time, where shading happens.
    Mat4d frame_camera_from_object{1.0};
    /// The frame time lies at knot `frame_knot` plus this part of the next segment.
    int frame_knot = 0;
    double frame_fraction = 0.0;
    bool finite = true;  ///< every matrix is
};

/// `geometry_static`: all knots of the geometry hold the same points.
Knots combine_knots(const Scene& scene, const Instance& instance, const GeometryData& geometry,
                    bool geometry_static);

}  // namespace granita
