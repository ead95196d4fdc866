// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/curve_batch.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "dice/opened_mesh.h"
#include "dice/raster_bound.h"

namespace granita {
namespace {

/// Curves further apart than this, pixels, are split from each other: buckets beside them should
/// not meet them.
constexpr float kRegion = 32.0f;
/// Micropolygons across a ribbon: it is flat, and what its normal does is known well before this.
constexpr int kMostAcross = 32;

/// How far out a tube's normals are taken for a ribbon of so many micropolygons across.  Colours go
/// linearly between vertices: with normals at their true places a tube's edges would be too dark.
/// Drawn in so far, the mean is right for any cubic; 1 / sqrt(3) with one micropolygon are Gauss's
/// places.
double drawn_in(int across) {
    return 1.0 / std::sqrt(1.0 + 2.0 / (static_cast<double>(across) * across));
}

}  // namespace

CurveBatch::CurveBatch(const OpenedElements& elements, std::size_t batch)
    : m_elements(&elements), m_batch(batch), m_count(elements.shared().batch(batch).size()) {
    if (m_count == 1) m_hi = end_of(curve(0));
}

std::unique_ptr<CurveBatch> CurveBatch::open(std::shared_ptr<const OpenedElements> elements,
                                             std::size_t batch) {
    auto opened = std::make_unique<CurveBatch>(*elements, batch);
    opened->m_owner = std::move(elements);
    opened->measure();
    return opened;
}

double CurveBatch::end_of(std::uint32_t curve) const {
    return static_cast<double>(m_elements->shared().point_count(curve) - 1);
}

RasterBounds CurveBatch::bounds() const {
    Bounds3f box;
    CurveControl control;
    for (std::size_t i = m_first; i < m_first + m_count; ++i) {
        const double lo = m_count == 1 ? m_lo : 0.0, hi = m_count == 1 ? m_hi : end_of(curve(i));
        control.gather(*m_elements, curve(i), lo, hi);
        box.add(control.swept_box(lo, hi));
    }
    if (box.empty()) return {};
    const Vec3f largest = glm::max(glm::abs(box.lo), glm::abs(box.hi));
    box.grow(1e-6f * std::max({largest.x, largest.y, largest.z}));  // rounding of positions
    return raster_bound(m_elements->view().projection, box);
}

GridKey CurveBatch::key() const {
    return {m_elements->instance().key, static_cast<std::uint32_t>(m_batch), m_path};
}

void CurveBatch::measure() {
    const int most = m_elements->grid_size();
    if (m_across == 0) {
        // Of whole curves, so that all parts of one agree.
        CurveControl control;
        double width = 0.0;
        for (std::size_t i = m_first; i < m_first + m_count; ++i) {
            control.gather(*m_elements, curve(i), 0.0, end_of(curve(i)));
            width = std::max(width, control.width_pixels());
        }
        m_across = 1;
        while (m_across < std::min(kMostAcross, most / 2) &&
               width > M_SQRT2 * m_elements->rate().rate() * m_across)
            m_across *= 2;
        // A row between curves shrinks without area only where it has no vertex inside.
        if (m_count > 1 && m_across > 1) {
            m_across = 0;
            return;
        }
    }
    if (m_count > 1) {
        const RasterBounds b = bounds();
        if (b.visible && !(b.x1 - b.x0 <= kRegion && b.y1 - b.y0 <= kRegion)) {
            m_across = 0;
            return;
        }
    }
    m_diceable = find_rows(static_cast<std::size_t>(most / m_across));
    if (!m_diceable && m_count > 1) m_across = 0;
}

/// False: more than `most` steps.
bool CurveBatch::find_rows(std::size_t most) {
    CurveControl control;
    std::vector<double> ends;
    for (std::size_t i = m_first; i < m_first + m_count; ++i) {
        const std::uint32_t c = curve(i);
        const double lo = m_count == 1 ? m_lo : 0.0, hi = m_count == 1 ? m_hi : end_of(c);
        control.gather(*m_elements, c, lo, hi);
        if (i > m_first) {
            const Row last = m_rows.back();
            m_rows.push_back({last.curve, last.t, true});
            m_rows.push_back({c, lo, true});
        }
        m_rows.push_back({c, lo, false});
        ends.clear();
        control.steps(lo, hi, most, ends);
        for (const double end : ends) m_rows.push_back({c, end, false});
        if (m_rows.size() - 1 > most) {
            m_rows = {};
            return false;
        }
    }
    return true;
}

std::vector<std::unique_ptr<Primitive>> CurveBatch::split() const {
    std::vector<std::unique_ptr<Primitive>> children;
    const std::size_t half = m_count / 2;
    const double middle = curve_middle(m_lo, m_hi);
    for (unsigned number = 0; number < 2; ++number) {
        auto child = std::make_unique<CurveBatch>(*m_elements, m_batch);
        child->m_owner = m_owner;
        child->m_path = 2 * m_path + number;
        child->m_across = m_across;
        child->m_first = m_first;
        child->m_count = m_count;
        child->m_lo = m_lo;
        child->m_hi = m_hi;
        if (m_count > 1) {
            child->m_first += number == 0 ? 0 : half;
            child->m_count = number == 0 ? half : m_count - half;
            child->m_lo = 0.0;
            child->m_hi = child->m_count == 1 ? end_of(curve(child->m_first)) : 0.0;
        } else {
            (number == 0 ? child->m_hi : child->m_lo) = middle;
        }
        child->measure();
        children.push_back(std::move(child));
    }
    return children;
}

std::unique_ptr<Grid> CurveBatch::dice() const {
    const int n_v = static_cast<int>(m_rows.size()) - 1;
    auto grid = m_elements->make_grid(m_batch, m_path, m_across, n_v);
    std::vector<ElementPlace> places;
    places.reserve(m_rows.size());
    CurveControl control;
    for (int j = 0; j <= n_v; ++j) {
        const Row& row = m_rows[static_cast<std::size_t>(j)];
        if (j == 0 || row.curve != m_rows[static_cast<std::size_t>(j) - 1].curve)
            control.gather(*m_elements, row.curve, m_count == 1 ? m_lo : 0.0,
                           m_count == 1 ? m_hi : end_of(row.curve));
        fill_row(*grid, j, row, control);
        places.push_back(control.place(row.t));
    }
    m_elements->finish(*grid, places);
    return grid;
}

void CurveBatch::fill_row(Grid& grid, int j, const Row& row, const CurveControl& control) const {
    const Knots& knots = m_elements->knots();
    const std::size_t count = static_cast<std::size_t>(grid.vertex_count());
    const std::size_t first = static_cast<std::size_t>(j * (grid.n_u + 1));
    Vec3d side(0.0), facing(0.0);
    for (int k = 0; k < knots.count; ++k) {
        const RibbonRow ribbon = control.row(k, row.t);
        for (int i = 0; i <= grid.n_u; ++i) {
            const double u = row.shrunk ? -1.0 : 2.0 * i / grid.n_u - 1.0;
            grid.positions[static_cast<std::size_t>(k) * count + first +
                           static_cast<std::size_t>(i)] = Vec3f(ribbon.center + ribbon.across * u);
        }
        const double weight = k == knots.frame_knot       ? 1.0 - knots.frame_fraction
                              : k == knots.frame_knot + 1 ? knots.frame_fraction
                                                          : 0.0;
        side += ribbon.side * weight;
        facing += ribbon.facing * weight;
    }
    const Vec3d front = unit_or(facing, Vec3d(0.0, 0.0, -1.0));
    for (int i = 0; i <= grid.n_u; ++i) {
        const double u = 2.0 * i / grid.n_u - 1.0;
        const double sine = u * drawn_in(grid.n_u);
        const Vec3d normal = side * sine + front * std::sqrt(std::max(1.0 - sine * sine, 0.0));
        const std::size_t v = first + static_cast<std::size_t>(i);
        grid.normal[v] = Vec3f(unit_or(normal, front));
        grid.geometric_normal[v] = Vec3f(front);
    }
}

}  // namespace granita
