// SPDX-License-Identifier: GPL-3.0-or-later
// What the instances of a geometry share, built when the first of them asks.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "base/report.h"
#include "math/bounds.h"
#include "scene/scene.h"

namespace granita {

class SharedElements;
class SharedGeometry;

/// Thread-safe; one a frame.
class GeometryCache {
  public:
    /// Object-space boxes of the finite points, one a knot of the geometry.
    std::shared_ptr<const std::vector<Bounds3f>> boxes(const Scene& scene, std::size_t geometry);
    /// Of a mesh.
    std::shared_ptr<const SharedGeometry> shared(const Scene& scene, std::size_t geometry,
                                                 Report& report);
    /// Of curves and points.
    std::shared_ptr<const SharedElements> elements(const Scene& scene, std::size_t geometry,
                                                   Report& report);
    /// The largest radius of curves and points, metres; 0 for a mesh.
    float largest_radius(const Scene& scene, std::size_t geometry);

  private:
    struct Entry {
        std::once_flag boxes_once, shared_once, elements_once, radius_once;
        std::shared_ptr<const std::vector<Bounds3f>> boxes;
        std::shared_ptr<const SharedGeometry> shared;
        std::shared_ptr<const SharedElements> elements;
        float largest_radius = 0.0f;
    };
    Entry& entry(std::size_t geometry);

    std::mutex m_mutex;
    std::map<std::size_t, Entry> m_entries;
};

}  // namespace granita
