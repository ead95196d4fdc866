// SPDX-License-Identifier: GPL-3.0-or-later
// What the samples of a picture have seen, for the next picture: where an edit changes nothing that
// hiding reads (scene/scene_changes.h), its samples see the same, and shading and compositing alone
// are done again.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <vector>

#include "base/report.h"
#include "dice/view.h"
#include "geometry/attribute_request.h"
#include "hider/hider.h"
#include "render/geometry_node.h"
#include "render/sample_levels.h"
#include "scene/scene_changes.h"
#include "shade/shading_system.h"

namespace granita {

/// Belongs to one job at a time, whose threads fill it bucket by bucket.
class PersistentVisibility {
  public:
    struct Bucket {
        std::unique_ptr<Hider> hider;  ///< finished, without samples
        HiddenGrids grids;             ///< of its pool; nullptr where no sample sees it
        std::vector<bool> seen;        ///< [grids]
        /// [grids] all_neighbours(); empty where light is not shared.
        std::vector<HiddenGrids> around;

        /// visit(SharedGrid&) for all, some more than once.
        template <class Visit>
        void for_each_grid(Visit visit) const {
            for (const auto& grid : grids)
                if (grid) visit(*grid);
            for (const HiddenGrids& beside : around)
                for (const auto& grid : beside) visit(*grid);
        }
    };

    /// `statistics`: in which the grids' memory is counted; `levels`: whose samples they are.
    PersistentVisibility(std::shared_ptr<const Scene> scene, std::shared_ptr<const View> view,
                         std::shared_ptr<Statistics> statistics, const ShadingSystem& shading,
                         const Rect& sample_pixels, int buckets,
                         std::shared_ptr<const SampleLevels> levels);
    ~PersistentVisibility();

    /// Whether it is of a picture of the same pixels and samples: what it is looked up by.
    bool is_of_size(const Scene& scene) const;
    /// Whether a picture of the scene now sees the same.
    bool serves(const Scene& now, const SceneChanges& changes, const ShadingSystem& shading,
                const Rect& sample_pixels) const;
    /// It is the scene's from now on.  What was shaded stays where nothing of it changed.
    void renew(std::shared_ptr<const Scene> scene, const SceneChanges& changes,
               const ShadingSystem& shading);
    /// Whether displacement in a picture of the scene moves everything as it did here.
    bool displaces_alike(const Scene& now, const SceneChanges& changes) const;
    /// nullptr where nothing is displaced.
    const std::shared_ptr<PersistentOffsets>& offsets() const { return m_offsets; }
    /// Its grids for a picture that may see others, or nullptr where these are not under the same
    /// light.  It must outlive them.
    std::shared_ptr<const ShadedGrids> shaded_grids(const SceneChanges& changes) const;
    /// Nothing but shaded_grids() is wanted any more.
    void forget_samples();

    /// nullptr where it is not kept.
    const Bucket* bucket(int index) const {
        return m_buckets[static_cast<std::size_t>(index)].get();
    }
    /// Thread-safe for different buckets.  Past `kMostBytes` all are given up.
    void keep(int index, Bucket bucket);
    /// All buckets are done.  What grids have begun reads the picture's shading, and ends with it.
    void end_picture();
    /// Of a picture that cannot be kept.
    void give_up() { m_given_up = true; }
    bool is_whole() const;

    /// What there was to say while it was made, but of geometries themselves.
    Report& said() { return m_said; }
    /// These were opened for it.
    void set_opened(std::vector<std::size_t> geometries) { m_opened = std::move(geometries); }
    /// Says again all that was said.
    void say(GeometryCache& geometries, Report& report) const;

    const Scene& scene() const { return *m_scene; }
    std::uint64_t bytes() const { return m_bytes; }

    static constexpr std::uint64_t kMostBytes = 512ULL << 20;

  private:
    /// What hiding, and other surfaces, know of a material.
    struct Traits {
        bool opacity_varies, opacity_asks_rays, reaches_others;
    };
    static std::vector<Traits> traits_of(const Scene& scene, const ShadingSystem& shading);

    std::shared_ptr<const Scene> m_scene;
    /// By which its grids were diced: what makes their triangles (Grid::triangles) reads them
    /// still.
    std::shared_ptr<const Scene> m_diced_scene;
    std::shared_ptr<const View> m_view;
    std::vector<std::filesystem::file_time_type> m_image_times;
    std::vector<Traits> m_traits;                           ///< [materials]
    std::vector<std::vector<AttributeRequest>> m_requests;  ///< [materials + 1]
    Options m_channels;  ///< of grids that hold some: they stay while none are asked for
    std::shared_ptr<PersistentOffsets> m_offsets;
    bool m_shares_light;  ///< grids know those around them
    Rect m_sample_pixels;
    std::shared_ptr<Statistics> m_statistics;
    std::shared_ptr<const SampleLevels> m_levels;
    Report m_said;
    std::vector<std::size_t> m_opened;  ///< geometries
    std::atomic<bool> m_given_up{false};
    std::atomic<std::uint64_t> m_bytes{0};
    std::vector<std::unique_ptr<Bucket>> m_buckets;
};

}  // namespace granita
