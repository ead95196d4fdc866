// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/build_shape.h"

#include <new>

#include "base/error.h"
#include "base/stage_timer.h"

namespace granita {

void check_embree(RTCDevice device, const std::string& what, const Progress& progress) {
    progress.check();
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_NONE) return;
    if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    throw SceneError(what, "Embree failed with error " + std::to_string(error));
}

bool embree_goes_on(void* progress, double) {
    return !static_cast<const Progress*>(progress)->cancelled();
}

void build_shape(PersistentRayShape& made, RTCDevice device, const RayFilters& filters,
                 const Progress& progress) {
    const std::string what = made.key.data->name + " of " + made.shape->size();
    made.built.reset(rtcNewScene(device));
    RTCScene built = made.built.get();
    rtcSetSceneFlags(built, filters.of_rays
                                ? RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION
                                : RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(built, RTC_BUILD_QUALITY_MEDIUM);
    rtcSetSceneProgressMonitorFunction(built, embree_goes_on, const_cast<Progress*>(&progress));
    made.parts = made.shape->hand_over(device);
    for (const RayPart& part : made.parts) {
        RTCGeometry handed = part.geometry;
        rtcSetGeometryOccludedFilterFunction(handed, filters.occluded);
        rtcSetGeometryIntersectFilterFunction(handed, filters.intersected);
        rtcCommitGeometry(handed);
        rtcAttachGeometry(built, handed);
        rtcReleaseGeometry(handed);
    }
    {
        const ForeignThreads embree;
        rtcCommitScene(built);
    }
    check_embree(device, what, progress);
    // Embree keeps the pointer, and the geometry may outlive the frame.
    rtcSetSceneProgressMonitorFunction(built, nullptr, nullptr);
}

}  // namespace granita
