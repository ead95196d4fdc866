// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/geometry_cache.h"

namespace granita {

GeometryCache::Entry& GeometryCache::entry(const Scene& scene, std::size_t geometry) {
    const std::lock_guard<std::mutex> lock(m_mutex);
    Entry& found = m_entries[geometry];  // a map's entries stay where they are
    if (!found.parts)
        found.parts = m_kept->find(scene.geometries.share(geometry), scene.options.frame_time);
    return found;
}

std::shared_ptr<const std::vector<Bounds3f>> GeometryCache::boxes(const Scene& scene,
                                                                  std::size_t geometry) {
    return entry(scene, geometry).parts->boxes();
}

std::shared_ptr<const SharedGeometry> GeometryCache::shared(const Scene& scene,
                                                            std::size_t geometry, Report& report) {
    Entry& found = entry(scene, geometry);
    auto shared = found.parts->shared();
    found.say(report);
    return shared;
}

std::shared_ptr<const SharedElements> GeometryCache::elements(const Scene& scene,
                                                              std::size_t geometry,
                                                              Report& report) {
    Entry& found = entry(scene, geometry);
    auto elements = found.parts->elements();
    found.say(report);
    return elements;
}

void GeometryCache::say(const Scene& scene, std::size_t geometry, Report& report) {
    if (scene.geometries[geometry].kind == GeometryKind::Mesh)
        shared(scene, geometry, report);
    else
        elements(scene, geometry, report);
}

float GeometryCache::largest_radius(const Scene& scene, std::size_t geometry) {
    return entry(scene, geometry).parts->largest_radius();
}

}  // namespace granita
