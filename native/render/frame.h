// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that the buckets of one frame share; built once, then only read.
#pragma once

#include <memory>
#include <optional>

#include "base/progress.h"
#include "film/film.h"
#include "hider/hider.h"
#include "hider/raster/raster_hider.h"
#include "render/choose_executor.h"
#include "render/frame_geometry.h"
#include "render/persistent_visibility.h"
#include "render/sample_levels.h"
#include "shade/shading_system.h"

namespace granita {

/// What a frame takes over from pictures before it.
struct PersistentPicture {
    PersistentShading shading;
    std::unique_ptr<PersistentVisibility> visibility;  ///< of one of its size, or nullptr
    bool is_kept = false;                              ///< whether a later picture wants its own
};

struct Frame {
    /// Scene and statistics are shared with what is kept.
    Frame(const std::shared_ptr<const Scene>& scene, const std::shared_ptr<Statistics>& statistics,
          Report& report, const Progress& progress, ExecutorChoice choice,
          PersistentPicture kept = {});
    /// Once all buckets are done: what this leaves to a later picture, or nullptr.
    std::unique_ptr<PersistentVisibility> take_visibility();

    const Scene& scene;
    Statistics& statistics;
    Report& report;
    const Progress& progress;
    std::unique_ptr<PersistentVisibility> before;  ///< whose grids lend their radiance, or nullptr
    std::optional<SceneChanges> changes;           ///< since `before`
    ShadingSystem shading;
    std::shared_ptr<View> shared_view;
    const View& view;
    std::shared_ptr<const SampleLevels> shared_levels;
    const SampleLevels& levels;
    Vec3f constant_background{0.0f};
    bool has_catchers = false;  ///< of shadows
    ExecutorChoice choice;
    std::unique_ptr<RasterHider> raster;  ///< only where it was chosen
    Film film;
    BucketLayout layout;
    bool sees_anew = true;  ///< else visibility is that of an earlier picture
    std::unique_ptr<PersistentVisibility> visibility;  ///< what is kept of this frame, or nullptr
    HiderFrame hider;                                  ///< with all samples
    FrameGeometry geometry;

    const LensShape& lens() const { return levels.all().lens(); }
    /// Where what there is to say of what samples see is noted.
    Report& said() { return visibility && sees_anew ? visibility->said() : report; }
};

}  // namespace granita
