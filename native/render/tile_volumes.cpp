// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/tile_volumes.h"

#include <algorithm>
#include <limits>

#include "render/camera_rays.h"
#include "render/sample_place.h"
#include "scene/knot_time.h"

namespace granita {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Samples that are looked along at once.
constexpr std::size_t kBatch = 1024;

/// A layer as it is seen without volumes, and behind one.
LayerLook look_behind(const SurfacePoint& at, const LayerLook* refined,
                      const SampleVolume& volume) {
    LayerLook look = refined
                         ? *refined
                         : look_of(at(at.grid->opacity),
                                   at.grid->radiance.empty() ? Vec3f(0.0f) : at(at.grid->radiance),
                                   at.grid->holdout);
    const Vec3f light = volume.light();
    for (int c = 0; c < 3; ++c)
        look.value[3 + c] = look.value[3 + c] * volume.transmittance[c] + light[c];
    return look;
}

}  // namespace

TileVolumes::TileVolumes(Frame& frame, const SampleTable& table, const TileStore& store,
                         const GridPool& pool, const RefinedSamples& already)
    : refined(already) {
    const Scene& scene = frame.scene;
    const bool has_channels = !frame.film.channels().empty();
    // The hider may have met no motion and no lens in this tile; what fills things has both.
    TileSamples looks;
    table.fill_tile(store.tile, table.needs(), looks);
    const CameraRays rays(scene.camera, store, looks);
    const float frame_time = scene.options.frame_time;
    const Vec3d origin(matrix_at(scene.camera.world_from_camera, frame_time)[3]);
    const FragmentLists& lists = store.lists;
    const std::size_t count = store.id.size();
    std::vector<std::uint32_t> slot_of(count, ~0u);
    for (std::uint32_t slot = 0; slot < lists.slots() && !lists.empty(); ++slot)
        if (lists.counts()[slot] > 0) slot_of[lists.sample(slot)] = slot;
    const auto depth_of = [&](float key) { return frame.view.projection.depth_from_key(key); };

    std::vector<ViewRay> seen;
    std::vector<float> depths;
    std::vector<SeenMedium> media;
    for (std::size_t first = 0; first < count; first += kBatch) {
        frame.progress.check();
        const std::size_t end = std::min(first + kBatch, count);
        seen.clear();
        depths.clear();
        for (std::size_t s = first; s < end; ++s) {
            const CameraRays::Seen from = rays.ray(s, origin, frame_time);
            if (const std::uint32_t slot = slot_of[s]; slot != ~0u)
                for (std::uint32_t k = 0; k < lists.counts()[slot]; ++k)
                    depths.push_back(from.distance(depth_of(lists.at(slot, k).key)));
            depths.push_back(store.id[s] == kNoSurface ? kInfinity
                                                       : from.distance(depth_of(store.key[s])));
            seen.push_back({from.ray,
                            place_of(store.tile, static_cast<std::uint32_t>(s), looks.samples),
                            static_cast<std::uint32_t>(depths.size())});
        }
        media.assign(depths.size(), {});
        frame.shading.volumes()->see(seen, depths, media);
        const auto add = [&](const SeenMedium& medium) {
            const SampleVolume volume{medium.transmittance, medium.emitted, medium.direct,
                                      medium.indirect};
            samples.add(volume);
            return volume;
        };
        for (std::size_t s = first, next = 0; s < end; ++s, ++next) {
            if (const std::uint32_t slot = slot_of[s]; slot != ~0u)
                for (std::uint32_t k = 0; k < lists.counts()[slot]; ++k, ++next) {
                    const Fragment fragment = lists.at(slot, k);
                    const SurfacePoint at = point_of(fragment, pool);
                    const LayerLook look = look_behind(at, refined.look(slot, k), add(media[next]));
                    refined.change_layer(lists, slot, k, look, has_channels ? &at : nullptr);
                }
            add(media[next]);
            samples.end_sample();
        }
    }
}

}  // namespace granita
