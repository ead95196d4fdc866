// SPDX-License-Identifier: GPL-3.0-or-later
// What the instances of a geometry share, built when the first of them asks.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "base/once.h"
#include "base/report.h"
#include "geometry/persistent_geometry.h"
#include "math/bounds.h"
#include "scene/scene.h"

namespace granita {

/// Thread-safe; one a frame, over a store that may outlive it.
class GeometryCache {
  public:
    explicit GeometryCache(
        std::shared_ptr<PersistentGeometry> kept = std::make_shared<PersistentGeometry>())
        : m_kept(std::move(kept)) {}

    /// As of GeometryParts.  What there was to say of a geometry is said once a frame.
    std::shared_ptr<const std::vector<Bounds3f>> boxes(const Scene& scene, std::size_t geometry);
    std::shared_ptr<const SharedGeometry> shared(const Scene& scene, std::size_t geometry,
                                                 Report& report);
    std::shared_ptr<const SharedElements> elements(const Scene& scene, std::size_t geometry,
                                                   Report& report);
    float largest_radius(const Scene& scene, std::size_t geometry);
    /// What there is to say of a geometry, which is built where no earlier frame has.
    void say(const Scene& scene, std::size_t geometry, Report& report);

  private:
    struct Entry {
        std::shared_ptr<GeometryParts> parts;
        Once said;

        void say(Report& report) {
            said.call([&] { report.add(parts->said()); });
        }
    };
    Entry& entry(const Scene& scene, std::size_t geometry);

    std::shared_ptr<PersistentGeometry> m_kept;
    std::mutex m_mutex;
    std::map<std::size_t, Entry> m_entries;
};

}  // namespace granita
