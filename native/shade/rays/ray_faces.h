// SPDX-License-Identifier: GPL-3.0-or-later
// What shapes made of a mesh's faces have in common: `Corners` corners a primitive.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "geometry/shared_geometry.h"
#include "shade/rays/ray_primitives.h"
#include "shade/rays/ray_shape.h"

namespace granita {

template <std::size_t Corners>
class RayFaces : public RayShape {
  public:
    std::vector<RayPart> hand_over(RTCDevice device) override {
        return m_primitives.hand_over(device);
    }
    int knots() const override { return m_primitives.knots; }
    float extent(std::uint32_t face) const override {
        return face < m_extents.size() ? m_extents[face] : 0.0f;
    }

  protected:
    explicit RayFaces(std::shared_ptr<const SharedGeometry> shared)
        : m_shared(std::move(shared)), m_extents(m_shared->data().face_count(), 0.0f) {
        m_primitives.knots = m_shared->surface_knots();
    }
    void locate_on(std::size_t patch, RayHit& hit) const {
        hit.geometry = m_shared.get();
        hit.patch = &m_shared->patches()[patch];
        hit.slot = m_shared->data().slot(hit.patch->face);
    }
    std::size_t bytes_of_faces() const { return m_primitives.bytes() + 4 * m_extents.size(); }

    std::shared_ptr<const SharedGeometry> m_shared;
    RayPrimitives<Corners> m_primitives;
    std::vector<float> m_extents;  ///< [F]
};

}  // namespace granita
