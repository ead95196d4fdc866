// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "base/progress.h"
#include "shade/rays/persistent_rays.h"

namespace granita {

/// What looks at each hit on a geometry; nullptr: nothing does.
struct RayFilters {
    RTCFilterFunctionN occluded = nullptr, intersected = nullptr;
    bool of_rays = false;  ///< rays may bring one of their own
};

/// Makes PersistentRayShape::built and parts of its shape.
/// Throws Cancelled, std::bad_alloc, or SceneError naming the geometry that Embree could not take.
void build_shape(PersistentRayShape& made, RTCDevice device, const RayFilters& filters,
                 const Progress& progress);

/// Throws Cancelled, std::bad_alloc where the system gives no more, or SceneError naming `what`
/// where Embree has failed otherwise.
void check_embree(RTCDevice device, const std::string& what, const Progress& progress);

/// For rtcSetSceneProgressMonitorFunction, with a `const Progress*`.
bool embree_goes_on(void* progress, double);

}  // namespace granita
