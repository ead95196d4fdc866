// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that the buckets of one frame share; built once, then only read.
#pragma once

#include <memory>

#include "base/progress.h"
#include "film/film.h"
#include "hider/hider.h"
#include "hider/raster/raster_hider.h"
#include "render/choose_executor.h"
#include "render/frame_geometry.h"
#include "render/sample_levels.h"
#include "shade/shading_system.h"

namespace granita {

struct Frame {
    Frame(const Scene& scene, Statistics& statistics, Report& report, const Progress& progress,
          ExecutorChoice choice, const KeptShading& kept = {});

    const Scene& scene;
    Statistics& statistics;
    Report& report;
    const Progress& progress;
    ShadingSystem shading;
    View view;
    SampleLevels levels;
    HiderFrame hider;  ///< with all samples
    Vec3f constant_background{0.0f};
    ExecutorChoice choice;
    std::unique_ptr<RasterHider> raster;  ///< only where it was chosen
    Film film;
    BucketLayout layout;
    FrameGeometry geometry;

    const LensShape& lens() const { return levels.all().lens(); }
};

}  // namespace granita
