// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "geometry/displacement.h"
#include "shade/nodes/node_compiler.h"

namespace granita {

/// Where an instance that is displaced is at the frame time.
struct DisplacedInstance {
    Mat4d shading_from_object{1.0};  ///< origin at the camera
    ObjectAxes axes;
    Mat3d object_from_world{1.0};
    // The camera in object space: a pixel is as large as `angle` at each metre from `eye`, plus
    // `least`.
    Vec3d eye{0.0};
    double angle = 0.0, least = 0.0;
    /// Pixels from one to the other of two points whose difference is a slope: a micropolygon's
    /// side.  Detail that the micropolygons do not have should not be seen in normals either: they
    /// would look away from the eye here and there, where the surface itself is hidden.
    double difference = 1.0;
};

/// Runs a material's program over places on any patches.  Offsets go to `out` from `first` on,
/// which has room for them.
void run_displacement(const DisplacementProgram& program, const DisplacedInstance& at,
                      const Instance& instance, const SharedGeometry& geometry,
                      std::span<const SurfacePlace> places, bool derivatives, std::size_t first,
                      Offsets& out);

}  // namespace granita
