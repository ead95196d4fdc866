// SPDX-License-Identifier: GPL-3.0-or-later
// Geometries as Embree has built them: a store that may outlive a picture.
#pragma once

#include <embree3/rtcore.h>

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <tuple>
#include <type_traits>
#include <vector>

#include "base/once.h"
#include "scene/geometry_list.h"
#include "shade/rays/ray_detail.h"
#include "shade/rays/ray_shape.h"

namespace granita {

struct RtcReleaser {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
template <class T>
using RtcHandle = std::unique_ptr<std::remove_pointer_t<T>, RtcReleaser>;

/// What a built geometry depends on.
struct RayKey {
    std::shared_ptr<const GeometryData> data;
    float frame_time = 0.0f;
    std::uint8_t use = 0;   ///< by instances, of RayScene
    std::vector<Eye> eyes;  ///< of what is subdivided or displaced: how finely
    std::shared_ptr<const void> displacement = nullptr;  ///< Displacement::identity()
    std::size_t displaced_as = 0;                        ///< the instance whose offsets it has
    bool operator==(const RayKey&) const = default;
};

struct PersistentRayShape {
    RayKey key;
    std::unique_ptr<RayShape> shape;
    RtcHandle<RTCScene> built;
    std::vector<RayPart> parts;  ///< by Embree's id in `built`, which owns them
    bool is_coarsened = false;
};

/// Thread-safe.  Owns the device that all in it belong to.  Of each geometry, displaced as an
/// instance is or not, there are the two that were asked for last, as a view has a coarse picture
/// and a whole one: an orbit around a subdivision surface makes another one for each place.
class PersistentRays {
  public:
    /// Starts Embree when first asked for; throws Error where it does not start.
    RTCDevice device();
    /// nullptr where it is not there.
    std::shared_ptr<const PersistentRayShape> find(const RayKey& key);
    /// Of what is not displaced, whatever its instances use it for; nullptr where there is none.
    std::shared_ptr<const PersistentRayShape> find_mesh(const GeometryData* data, float frame_time);
    void add(std::shared_ptr<const PersistentRayShape> made);
    /// Forgets what is made of others.
    void keep_only(const GeometryList& geometries);
    /// How many were added.
    std::uint64_t made() const { return m_made; }
    /// Of Embree, whatever it was made for.
    std::size_t embree_bytes() const;

  private:
    static constexpr std::size_t kMostOfOne = 2;
    using Of = std::tuple<const GeometryData*, bool, std::size_t>;
    using Shapes = std::vector<std::shared_ptr<const PersistentRayShape>>;  ///< latest first
    static Of of(const RayKey& key) {
        return {key.data.get(), key.displacement != nullptr, key.displaced_as};
    }

    std::atomic<long long> m_bytes{0};
    Once m_started;
    RtcHandle<RTCDevice> m_device;
    std::mutex m_mutex;
    std::map<Of, Shapes> m_shapes;
    std::atomic<std::uint64_t> m_made{0};
};

}  // namespace granita
