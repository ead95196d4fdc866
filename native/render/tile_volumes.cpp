// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/tile_volumes.h"

#include <algorithm>
#include <limits>

#include "render/camera_rays.h"
#include "render/sample_place.h"
#include "shade/programs/shading_camera.h"

namespace granita {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Samples that are looked along at once.
constexpr std::size_t kBatch = 1024;

SampleVolume volume_of(const SeenMedium& medium) {
    return {medium.transmittance, medium.emitted, medium.direct, medium.indirect};
}

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

/// What volumes keep of a tile.
std::uint64_t bytes_of(const TileStore& store, bool has_channels) {
    const std::uint64_t layer = sizeof(LayerLook) + sizeof(std::uint32_t),
                        channels = sizeof(SampleVolume) + sizeof(SurfacePoint);
    return store.key.size() * (sizeof(SampleVolume) + sizeof(std::uint32_t)) +
           store.lists.total() * (layer + (has_channels ? channels : 0));
}

}  // namespace

bool volumes_fit(const Frame& frame, const std::vector<TileStore>& stores) {
    if (!frame.shading.volumes()) return true;
    std::uint64_t lists = 0, most = 0;
    for (const TileStore& store : stores) {
        lists += store.lists.total() * sizeof(Fragment);
        most = std::max(most, bytes_of(store, !frame.film.channels().empty()));
    }
    return lists + most <= frame.hider.list_bytes;
}

TileVolumes::TileVolumes(Frame& frame, const SampleTable& table, const TileStore& store,
                         const GridPool& pool, const RefinedSamples& already,
                         const std::function<bool(SurfaceId)>& shows)
    : refined(already) {
    const Scene& scene = frame.scene;
    const bool has_channels = !frame.film.channels().empty();
    // The hider may have met no motion and no lens in this tile; what fills things has both.
    TileSamples looks;
    table.fill_tile(store.tile, table.needs(), looks);
    const CameraRays rays(scene.camera, store, looks);
    const float frame_time = scene.options.frame_time;
    const Vec3d origin(ShadingCamera(scene).world_from_camera[3]);
    const FragmentLists& lists = store.lists;
    const std::size_t count = store.id.size();
    refined.reserve_layers(lists.total(), has_channels);
    samples.reserve(count, has_channels ? lists.total() : 0);
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
            const bool ends = store.id[s] != kNoSurface && !(shows && shows(store.id[s]));
            depths.push_back(ends ? from.distance(depth_of(store.key[s])) : kInfinity);
            seen.push_back({from.ray,
                            place_of(store.tile, static_cast<std::uint32_t>(s), looks.samples),
                            static_cast<std::uint32_t>(depths.size())});
        }
        media.assign(depths.size(), {});
        frame.shading.volumes()->see(seen, depths, media);
        for (std::size_t s = first, next = 0; s < end; ++s, ++next) {
            if (const std::uint32_t slot = slot_of[s]; slot != ~0u)
                for (std::uint32_t k = 0; k < lists.counts()[slot]; ++k, ++next) {
                    const Fragment fragment = lists.at(slot, k);
                    const SurfacePoint at = point_of(fragment, pool);
                    const SampleVolume before = volume_of(media[next]);
                    if (has_channels) samples.add(before);
                    const LayerLook look = look_behind(at, refined.look(slot, k), before);
                    refined.change_layer(lists, slot, k, look, has_channels ? &at : nullptr);
                }
            samples.add(volume_of(media[next]));
            samples.end_sample();
        }
    }
    frame.statistics.note_list_bytes(lists.total() * sizeof(Fragment) + samples.bytes() +
                                     refined.bytes_of_layers());
}

}  // namespace granita
