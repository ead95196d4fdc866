// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/geometry_cache.h"

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
        const GeometryData& data = scene.geometries[geometry];
        auto boxes = std::make_shared<std::vector<Bounds3f>>(static_cast<std::size_t>(data.knots));
        const std::size_t n = data.vertex_count();
        for (std::size_t i = 0; i < data.points.size(); ++i)
            if (is_finite(data.points[i])) (*boxes)[i / n].add(data.points[i]);
        found.boxes = std::move(boxes);
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

}  // namespace granita
