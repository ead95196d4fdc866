// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/element_batch.h"

#include <algorithm>

#include "dice/motion_bounds.h"
#include "dice/raster_bound.h"

namespace granita {
namespace {

/// Elements further apart than this, pixels, are split from each other.
constexpr float kRegion = 32.0f;

}  // namespace

GridKey ElementBatch::key() const {
    return {m_elements->instance().key, static_cast<std::uint32_t>(m_batch), m_path};
}

RasterBounds ElementBatch::raster_bounds(Bounds3f box) const {
    box.grow_relative(1e-6f);
    return raster_bound(m_elements->view().projection, box);
}

bool ElementBatch::scattered(const RasterBounds& b) const {
    return m_count > 1 && b.visible && !(b.x1 - b.x0 <= kRegion && b.y1 - b.y0 <= kRegion);
}

void ElementBatch::own(std::shared_ptr<const OpenedElements> elements) {
    m_owner = std::move(elements);
    measure();
}

std::shared_ptr<const ElementBatch> ElementBatch::finish(Grid& grid) const {
    motion_bounds(grid, m_elements->view().projection);
    std::shared_ptr<const ElementBatch> kept = copy();
    grid.shading_state = [kept](Grid& of) { kept->fill_shading_state(of); };
    return kept;
}

std::vector<std::unique_ptr<Primitive>> ElementBatch::split() const {
    std::vector<std::unique_ptr<Primitive>> children;
    for (unsigned number = 0; number < 2; ++number) {
        std::unique_ptr<ElementBatch> half = child();
        half->m_path = 2 * m_path + number;
        if (m_count > 1) {
            half->m_count = number == 0 ? m_count / 2 : m_count - m_count / 2;
            half->m_first += number == 0 ? 0 : m_count / 2;
        } else {
            half->halve(number);
        }
        half->measure();
        children.push_back(std::move(half));
    }
    return children;
}

}  // namespace granita
