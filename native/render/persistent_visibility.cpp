// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/persistent_visibility.h"

#include <algorithm>
#include <unordered_set>

#include "base/parallel.h"
#include "scene/channels.h"
#include "shade/material_displacement.h"

namespace granita {
namespace {

/// Of image files, which may be written anew under their names.
std::vector<std::filesystem::file_time_type> image_times(const Scene& scene) {
    std::vector<std::filesystem::file_time_type> times;
    for (const Image& image : scene.images) {
        std::error_code missing;
        times.push_back(image.path.empty() ? std::filesystem::file_time_type{}
                                           : std::filesystem::last_write_time(image.path, missing));
    }
    return times;
}

template <class T>
std::uint64_t bytes_of(const std::vector<T>& values) {
    return values.size() * sizeof(T);
}

std::uint64_t bytes_of(const PersistentVisibility::Bucket& bucket) {
    std::uint64_t bytes = 0;
    for (const TileStore& store : bucket.hider->finish())
        bytes += bytes_of(store.key) + bytes_of(store.id) + store.lists.total() * sizeof(Fragment);
    for (const auto& grid : bucket.grids)
        if (grid) bytes += grid->bytes();
    return bytes;
}

}  // namespace

PersistentVisibility::PersistentVisibility(std::shared_ptr<const Scene> scene,
                                           std::shared_ptr<const View> view,
                                           std::shared_ptr<Statistics> statistics,
                                           const ShadingSystem& shading, const Rect& sample_pixels,
                                           int buckets, std::shared_ptr<const SampleLevels> levels)
    : m_scene(std::move(scene)),
      m_diced_scene(m_scene),
      m_view(std::move(view)),
      m_image_times(image_times(*m_scene)),
      m_traits(traits_of(*m_scene, shading)),
      m_requests(shading.requests()),
      m_channels(m_scene->options),
      m_offsets(shading.displacement() ? shading.displacement()->kept() : nullptr),
      m_shares_light(shading.shares_light()),
      m_sample_pixels(sample_pixels),
      m_statistics(std::move(statistics)),
      m_levels(std::move(levels)),
      m_buckets(static_cast<std::size_t>(buckets)) {}

PersistentVisibility::~PersistentVisibility() = default;

std::vector<PersistentVisibility::Traits> PersistentVisibility::traits_of(
    const Scene& scene, const ShadingSystem& shading) {
    std::vector<Traits> traits;
    for (std::size_t m = 0; m < scene.materials.size(); ++m) {
        const auto material = static_cast<int>(m);
        traits.push_back({shading.opacity_varies(material), shading.opacity_asks_rays(material),
                          shading.reaches_others(material)});
    }
    return traits;
}

bool PersistentVisibility::is_of_size(const Scene& scene) const {
    const Options &a = m_scene->options, &b = scene.options;
    return a.width == b.width && a.height == b.height && a.crop == b.crop && a.samples == b.samples;
}

bool PersistentVisibility::displaces_alike(const Scene& now, const SceneChanges& changes) const {
    if ((changes.parts & part::kRest) != 0 || image_times(*m_scene) != m_image_times) return false;
    for (std::size_t m = 0; m < now.materials.size(); ++m)
        if (changes.materials[m] &&
            (m_scene->materials[m].graph.moves_surface() || now.materials[m].graph.moves_surface()))
            return false;
    return true;
}

bool PersistentVisibility::serves(const Scene& now, const SceneChanges& changes,
                                  const ShadingSystem& shading, const Rect& sample_pixels) const {
    if ((changes.parts & part::kReadByHiding) != 0 || sample_pixels != m_sample_pixels)
        return false;
    if (!displaces_alike(now, changes) || m_requests != shading.requests()) return false;
    if (shading.has_light() && !m_view->has_light) return false;
    // What is displaced is diced as finely as light shows it.
    const bool is_darker = m_view->has_light && !shading.has_light();
    if (is_darker && shading.displacement() && shading.displacement()->any()) return false;
    if (shading.shares_light() && !m_shares_light) return false;
    const bool has_lists = std::ranges::any_of(m_traits, &Traits::opacity_varies);
    if (has_lists && (changes.parts & part::kPasses) != 0) return false;
    const bool asks_rays = std::ranges::any_of(m_traits, &Traits::opacity_asks_rays);
    if (asks_rays && (changes.parts & part::kReadByOpacityRays) != 0) return false;
    for (std::size_t m = 0; m < m_traits.size(); ++m) {
        if (!changes.materials[m]) continue;
        const auto material = static_cast<int>(m);
        if (m_traits[m].opacity_varies || shading.opacity_varies(material)) return false;
    }
    return true;
}

void PersistentVisibility::renew(std::shared_ptr<const Scene> scene, const SceneChanges& changes,
                                 const ShadingSystem& shading) {
    // What shaded_grids() lends stays: a grid that forgot would take from itself.
    bool all = (changes.parts & part::kReadByShading & ~part::kMaterials & ~part::kPasses) != 0;
    for (std::size_t m = 0; m < m_traits.size(); ++m)
        all |= changes.materials[m] &&
               (scene->options.bounces.most > 0 || m_traits[m].reaches_others ||
                shading.reaches_others(static_cast<int>(m)));
    const bool wants_channels = !ChannelSet(scene->options).empty();
    all |= wants_channels && !same_channels(m_channels, scene->options);
    for (const auto& bucket : m_buckets)
        bucket->for_each_grid([&](SharedGrid& shared) {
            const Grid& grid = shared.grid();
            const bool is_other =
                grid.material >= 0 && changes.materials[static_cast<std::size_t>(grid.material)];
            const bool lacks_channels = wants_channels && grid.channels.empty();
            const bool was_found = grid.light_fraction > 0.0f || grid.told;
            if (all || is_other || lacks_channels || grid.broken_radiance || !was_found)
                shared.forget_radiance();
        });
    m_traits = traits_of(*scene, shading);
    if (wants_channels) m_channels = scene->options;
    m_scene = std::move(scene);
}

std::shared_ptr<const ShadedGrids> PersistentVisibility::shaded_grids(
    const SceneChanges& changes) const {
    if ((changes.parts & part::kReadByShading) != 0 || image_times(*m_scene) != m_image_times)
        return nullptr;
    auto grids = std::make_shared<ShadedGrids>();
    for (const auto& bucket : m_buckets)
        bucket->for_each_grid([&](SharedGrid& shared) { grids->add(shared.grid()); });
    return grids;
}

void PersistentVisibility::forget_samples() {
    for (const auto& bucket : m_buckets) bucket->hider.reset();
}

void PersistentVisibility::keep(int index, Bucket bucket) {
    if (m_given_up) return;
    for (std::size_t slot = 0; slot < bucket.seen.size(); ++slot) {
        if (bucket.grids[slot]->grid().broken_opacity) give_up();  // which is to be said again
        if (!bucket.seen[slot]) bucket.grids[slot].reset();
    }
    bucket.hider->drop_samples();
    m_bytes += bytes_of(bucket);
    if (m_bytes > kMostBytes) give_up();
    m_buckets[static_cast<std::size_t>(index)] = std::make_unique<Bucket>(std::move(bucket));
}

void PersistentVisibility::end_picture() {
    // Of those that only tell others; while buckets were rendered other threads might tell.
    std::unordered_set<const SharedGrid*> counted;
    std::unordered_set<SharedGrid*> asking;
    for (const auto& bucket : m_buckets) {
        if (!bucket) continue;
        for (const auto& grid : bucket->grids) counted.insert(grid.get());
        bucket->for_each_grid([&](SharedGrid& grid) {
            grid.drop_begun();
            if (grid.asks_picture()) asking.insert(&grid);
        });
    }
    if (m_given_up) return;
    const std::vector<SharedGrid*> asked(asking.begin(), asking.end());
    parallel_for(asked.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) asked[i]->ensure_shading_state(*m_statistics);
    });
    for (const auto& bucket : m_buckets) {
        if (!bucket) continue;
        bucket->for_each_grid([&](SharedGrid& grid) {
            if (counted.insert(&grid).second) m_bytes += grid.bytes();
        });
    }
    if (m_bytes > kMostBytes) give_up();
}

bool PersistentVisibility::is_whole() const {
    return !m_given_up &&
           std::ranges::all_of(m_buckets, [](const auto& b) { return b != nullptr; });
}

void PersistentVisibility::say(GeometryCache& geometries, Report& report) const {
    report.add(m_said);
    for (const std::size_t geometry : m_opened) geometries.say(*m_scene, geometry, report);
}

}  // namespace granita
