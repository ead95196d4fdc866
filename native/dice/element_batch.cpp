// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/element_batch.h"

#include <algorithm>
#include <bit>

#include "dice/motion_bounds.h"
#include "dice/raster_bound.h"

namespace granita {

GridKey ElementBatch::key() const {
    return {m_elements->instance().key, static_cast<std::uint32_t>(m_batch), m_path};
}

RasterBounds ElementBatch::raster_bounds(Bounds3f box) const {
    box.grow_relative(1e-6f);
    return raster_bound(m_elements->view().projection, box);
}

RasterBounds ElementBatch::still_bounds(const Bounds3f& first, const Bounds3f& last) const {
    Projection focused = m_elements->view().projection;
    focused.lens_radius = 0.0;
    const RasterBounds a = raster_bound(focused, first), b = raster_bound(focused, last);
    const auto extent = [](const RasterBounds& r) {
        return r.visible ? std::max(r.x1 - r.x0, r.y1 - r.y0) : -1.0f;
    };
    return extent(b) > extent(a) ? b : a;
}

bool ElementBatch::scattered(const RasterBounds& b) const {
    return m_count > 1 && b.visible && !(b.x1 - b.x0 <= kRegion && b.y1 - b.y0 <= kRegion);
}

unsigned ElementBatch::runs_of(const RasterBounds& b) const {
    const float area =
        std::max((b.x1 - b.x0) / kRegion, 1.0f) * std::max((b.y1 - b.y0) / kRegion, 1.0f);
    const auto most = static_cast<float>(std::bit_floor(m_count));
    return std::bit_floor(static_cast<unsigned>(std::clamp(area, 2.0f, most)));
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
    const unsigned parts = m_count > 1 ? m_runs : 2;
    for (unsigned number = 0; number < parts; ++number) {
        std::unique_ptr<ElementBatch> part = child();
        part->m_path = parts * m_path + number;
        if (m_count > 1) {
            const std::size_t first = number * m_count / parts;
            part->m_count = (number + 1) * m_count / parts - first;
            part->m_first += first;
        } else {
            part->halve(number);
        }
        part->measure();
        children.push_back(std::move(part));
    }
    return children;
}

}  // namespace granita
