// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/persistent_geometry.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "geometry/shared_elements.h"
#include "geometry/shared_geometry.h"

namespace granita {

std::shared_ptr<const std::vector<Bounds3f>> GeometryParts::boxes() {
    m_boxes_once.call(
        [&] { m_boxes = std::make_shared<std::vector<Bounds3f>>(element_boxes(*m_data)); });
    return m_boxes;
}

std::shared_ptr<const SharedGeometry> GeometryParts::shared() {
    m_shared_once.call(
        [&] { m_shared = std::make_shared<SharedGeometry>(*m_data, m_frame_time, m_said); });
    return m_shared;
}

std::shared_ptr<const SharedElements> GeometryParts::elements() {
    m_elements_once.call(
        [&] { m_elements = std::make_shared<SharedElements>(*m_data, m_frame_time, m_said); });
    return m_elements;
}

float GeometryParts::largest_radius() {
    m_radius_once.call([&] {
        for (const float radius : m_data->radius)
            if (std::isfinite(radius)) m_largest_radius = std::max(m_largest_radius, radius);
    });
    return m_largest_radius;
}

std::shared_ptr<GeometryParts> PersistentGeometry::find(
    const std::shared_ptr<const GeometryData>& data, float frame_time) {
    const std::lock_guard lock(m_mutex);
    std::shared_ptr<GeometryParts>& parts = m_parts[{data.get(), frame_time}];
    if (!parts) {
        parts = std::make_shared<GeometryParts>(data, frame_time);
        ++m_made;
    }
    return parts;
}

void PersistentGeometry::keep_only(const GeometryList& geometries) {
    const std::set<const GeometryData*> there = geometries.members();
    const std::lock_guard lock(m_mutex);
    std::erase_if(m_parts, [&](const auto& entry) { return !there.contains(entry.first.first); });
}

}  // namespace granita
