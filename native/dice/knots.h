// SPDX-License-Identifier: GPL-3.0-or-later
// The motion knots of an instance as the camera sees it: its own transform's, its geometry's and
// the camera's knots brought to one equidistant set (decision 8).
#pragma once

#include <cstddef>
#include <vector>

#include "math/vec.h"
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

/// All knots are the same.
bool is_static(const std::vector<Mat4d>& matrices);

/// `geometry_static`: all knots of the geometry hold the same points.
Knots combine_knots(const Scene& scene, const Instance& instance, const GeometryData& geometry,
                    bool geometry_static);

/// Where a time in [0, 1] falls among equidistant knots.
struct KnotTime {
    std::size_t knot = 0;
    double fraction = 0.0;  ///< of the segment from `knot` on; 0 exactly at a knot
};
/// Time step / steps: exact at knots.
KnotTime knot_time(int step, int steps, int knots);
KnotTime knot_time(double time, int knots);

}  // namespace granita
