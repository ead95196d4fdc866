// SPDX-License-Identifier: GPL-3.0-or-later
// Counters and seconds by stage of one frame (stage_timer.h takes them).  One table names them all
// (statistics.cpp); the JSON of
// `--granita-stats` uses the same names.  Hot loops count locally and add once a grid or bucket.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/object_costs.h"

namespace granita {

enum class Counter {
    PrimitivesOpened,  ///< base faces whose primitive was made
    PrimitivesSplit,   ///< split() calls
    PrimitivesCulled,  ///< culled by bound: off screen or behind the hierarchical depth, counted a
                       ///< bucket
    PrimitivesCulledInTime,  ///< of these, what only its bounds in parts of the shutter ruled out
    GridsDiced,
    GridsCulled,         ///< diced grids that the hierarchical depth rejected, counted a bucket
    GridsSwept,          ///< sweeps made (hider/grid_sweep.h): one of each grid that was hidden
    GridsShaded,         ///< radiance run
    GridsShadedBefore,   ///< radiance taken from an equal grid of an earlier picture
    GridsOpacityShaded,  ///< opacity run before visibility
    PointsDiced,
    PointsSpared,  ///< about as many more without motion_factor and focus_factor
    PointsShaded,
    PointsRefined,         ///< of these, samples shaded by themselves
    Micropolygons,         ///< at the hider, counted once a bucket that tests them
    MicropolygonsDropped,  ///< non-finite, counted and reported
    SamplesTotal,          ///< of the picture's own pixels, without those around that filters reach
    TilesResampled,        ///< looks at a tile with more samples, as fewer left it in doubt
    SampleTestsStatic,     ///< point-in-micropolygon tests without motion or lens
    SampleTestsMoving,     ///< with motion, lens or both
    SampleHits,            ///< tests that covered the sample (before the depth comparison)
    FragmentsStored,       ///< transparent list entries
    BucketsMoving,         ///< buckets that met any motion or lens blur
    BucketsTransparent,
    BucketsSeenBefore,  ///< whose samples an earlier picture has found
    GlPrimitives,       ///< triangles drawn by the raster executor
    GlPasses,
    GlDispatches,  ///< of the compute executor
    RaysOpening,   ///< of samples, for the faces that they meet of what has many more
    RaysShadow,
    RaysOcclusion,
    RaysBounce,   ///< from surface to surface
    HitsShaded,   ///< of these, surfaces met
    LampsChosen,  ///< where there are many: lamps asked, summed over points
    LightNodes,   ///< of the light tree, whose children a point compared
    TextureLookups,
    LoopPiecesShared,  ///< pieces of a stage's loops that another thread than the loop's own ran
    kCount
};

enum class Stage { Open, Split, Dice, Hide, Shade, Resolve, Film, RayBuild, kCount };

/// Thread-safe, relaxed: totals are read after the frame.
class Statistics {
  public:
    /// `objects`: whose costs are told apart, by their index in Scene::instances.
    explicit Statistics(std::size_t objects = 0) : m_objects(objects) {}

    void add(Counter counter, std::uint64_t n = 1) {
        m_counters[static_cast<int>(counter)].fetch_add(n, std::memory_order_relaxed);
    }
    std::uint64_t get(Counter counter) const {
        return m_counters[static_cast<int>(counter)].load(std::memory_order_relaxed);
    }
    void add_seconds(Stage stage, double seconds);
    /// Of processors, summed over threads.
    double seconds(Stage stage) const;
    ObjectCosts& objects() { return m_objects; }
    const ObjectCosts& objects() const { return m_objects; }
    /// Bytes of grids that came into being; the most that lived at a time are peak_grid_bytes().
    void add_grid_bytes(std::uint64_t bytes);
    void remove_grid_bytes(std::uint64_t bytes) { m_grid_bytes.fetch_sub(bytes); }
    std::uint64_t grid_bytes() const { return m_grid_bytes.load(); }
    std::uint64_t peak_grid_bytes() const { return m_peak_grid_bytes.load(); }
    /// Bytes of the structure that rays trace, its triangles included.
    void peak_ray_bytes(std::uint64_t bytes) { m_peak_ray_bytes.store(bytes); }
    std::uint64_t peak_ray_bytes() const { return m_peak_ray_bytes.load(); }
    /// Bytes of a bucket's transparent lists, and what volumes keep of their layers; the most that
    /// any had are peak_list_bytes().
    void note_list_bytes(std::uint64_t bytes);
    std::uint64_t peak_list_bytes() const { return m_peak_list_bytes.load(); }
    /// Name and value of everything above, seconds as "seconds_<stage>".
    std::vector<std::pair<std::string, double>> list() const;

  private:
    std::array<std::atomic<std::uint64_t>, static_cast<int>(Counter::kCount)> m_counters{};
    std::array<std::atomic<std::uint64_t>, static_cast<int>(Stage::kCount)> m_nanoseconds{};
    ObjectCosts m_objects;
    std::atomic<std::uint64_t> m_grid_bytes{0}, m_peak_grid_bytes{0};
    std::atomic<std::uint64_t> m_peak_ray_bytes{0}, m_peak_list_bytes{0};
};

}  // namespace granita
