// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/geometry_cache.h"

#include <algorithm>
#include <cmath>

#include "geometry/shared_elements.h"
#include "geometry/shared_geometry.h"

namespace granita {

GeometryCache::Entry& GeometryCache::entry(std::size_t geometry) {
    const std::lock_guard<std::mutex> lock(m_mutex);
    return m_entries[geometry];  // a map's entries stay where they are
}

std::shared_ptr<const std::vector<Bounds3f>> GeometryCache::boxes(const Scene& scene,
                                                                  std::size_t geometry) {
    Entry& found = entry(geometry);
    std::call_once(found.boxes_once, [&] {
        found.boxes =
            std::make_shared<std::vector<Bounds3f>>(element_boxes(scene.geometries[geometry]));
    });
    return found.boxes;
}

std::shared_ptr<const SharedGeometry> GeometryCache::shared(const Scene& scene,
                                                            std::size_t geometry, Report& report) {
    Entry& found = entry(geometry);
    std::call_once(found.shared_once, [&] {
        found.shared = std::make_shared<SharedGeometry>(scene.geometries[geometry],
                                                        scene.options.frame_time, report);
    });
    return found.shared;
}

std::shared_ptr<const SharedElements> GeometryCache::elements(const Scene& scene,
                                                              std::size_t geometry,
                                                              Report& report) {
    Entry& found = entry(geometry);
    std::call_once(found.elements_once, [&] {
        found.elements = std::make_shared<SharedElements>(scene.geometries[geometry],
                                                          scene.options.frame_time, report);
    });
    return found.elements;
}

float GeometryCache::largest_radius(const Scene& scene, std::size_t geometry) {
    Entry& found = entry(geometry);
    std::call_once(found.radius_once, [&] {
        for (const float radius : scene.geometries[geometry].radius)
            if (std::isfinite(radius))
                found.largest_radius = std::max(found.largest_radius, radius);
    });
    return found.largest_radius;
}

}  // namespace granita
