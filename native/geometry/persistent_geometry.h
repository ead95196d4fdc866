// SPDX-License-Identifier: GPL-3.0-or-later
// What is made of a geometry at a frame time, whatever the camera; and a store of these that
// outlives a picture.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "base/once.h"
#include "base/report.h"
#include "math/bounds.h"
#include "scene/geometry_list.h"

namespace granita {

class SharedElements;
class SharedGeometry;

/// Thread-safe: each part is made when it is first asked for.
class GeometryParts {
  public:
    GeometryParts(std::shared_ptr<const GeometryData> data, float frame_time)
        : m_data(std::move(data)), m_frame_time(frame_time) {}

    /// Object-space boxes of the finite points, one a knot of the geometry.
    std::shared_ptr<const std::vector<Bounds3f>> boxes();
    /// Of a mesh.
    std::shared_ptr<const SharedGeometry> shared();
    /// Of curves and points.
    std::shared_ptr<const SharedElements> elements();
    /// The largest radius of curves and points, metres; 0 for a mesh.
    float largest_radius();
    /// What there was to say about shared() or elements().
    const Report& said() const { return m_said; }

  private:
    std::shared_ptr<const GeometryData> m_data;
    float m_frame_time;
    Report m_said;
    Once m_boxes_once, m_shared_once, m_elements_once, m_radius_once;
    std::shared_ptr<const std::vector<Bounds3f>> m_boxes;
    std::shared_ptr<const SharedGeometry> m_shared;
    std::shared_ptr<const SharedElements> m_elements;
    float m_largest_radius = 0.0f;
};

/// Thread-safe.
class PersistentGeometry {
  public:
    std::shared_ptr<GeometryParts> find(const std::shared_ptr<const GeometryData>& data,
                                        float frame_time);
    /// Forgets what is made of others.
    void keep_only(const GeometryList& geometries);
    /// How many were not there.
    std::uint64_t made() const { return m_made; }

  private:
    std::mutex m_mutex;
    std::map<std::pair<const GeometryData*, float>, std::shared_ptr<GeometryParts>> m_parts;
    std::atomic<std::uint64_t> m_made{0};
};

}  // namespace granita
