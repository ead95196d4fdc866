// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/curve_batch.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "dice/opened_mesh.h"
#include "dice/triangle_grid.h"
#include "math/normalize_or.h"

namespace granita {
namespace {

/// Micropolygons across a ribbon: it is flat, and what its normal does is known well before this.
constexpr int kMostAcross = 32;

/// Ribbons up to this may be shaded by the samples that see them, each with the normal of its
/// place.
constexpr int kMostOfSamples = 8;

/// How far out a tube's normals are taken for a ribbon of so many micropolygons across.  Colours go
/// linearly between vertices: with normals at their true places a tube's edges would be too dark.
/// Drawn in so far, the mean is right for any cubic; 1 / sqrt(3) with one micropolygon are Gauss's
/// places.
double drawn_in(int across) {
    return 1.0 / std::sqrt(1.0 + 2.0 / (static_cast<double>(across) * across));
}

/// Pixels; below, no two rows of a ribbon are told apart.
constexpr double kThin = 0.5;

/// Parts that curves are cut into together.
constexpr float kMostPieces = 64.0f;

/// Two rows of a thin ribbon, one micropolygon across, have the four places of Chebyshev's equal
/// weights between them: light from the front comes out 1 % too bright instead of 4, from the side
/// 2 % too dark instead of 15 % too bright.  A row has one far and one near, so that rows are alike
/// from the front.
double place_across(bool left, bool odd) {
    constexpr double kNear = 0.187592, kFar = 0.794654;
    return left ? (odd ? -kNear : -kFar) : (odd ? kFar : kNear);
}

}  // namespace

CurveBatch::CurveBatch(const OpenedElements& elements, std::size_t batch)
    : ElementBatch(elements, batch) {}

std::unique_ptr<CurveBatch> CurveBatch::open(std::shared_ptr<const OpenedElements> elements,
                                             std::size_t batch) {
    auto opened = std::make_unique<CurveBatch>(*elements, batch);
    opened->own(std::move(elements));
    return opened;
}

double CurveBatch::end_of(std::uint32_t curve) const {
    return static_cast<double>(m_elements->shared().point_count(curve) - 1);
}

/// Of the part that is this batch's.
CurveBatch::Measures CurveBatch::measures(std::uint32_t curve) const {
    static thread_local CurveControl control;  // kept for its memory
    const double lo = start(), hi = end(curve);
    control.gather(*m_elements, curve, lo, hi);
    Measures measures;
    measures.first = measures.last = measures.box = control.box(0, lo, hi);
    for (int k = 1; k < m_elements->knot_count(); ++k) {
        measures.last = control.box(k, lo, hi);
        measures.box.add(measures.last);
    }
    measures.width = control.width_pixels();
    return measures;
}

RasterBounds CurveBatch::bounds() const {
    Bounds3f box;
    for (std::size_t i = 0; i < m_count; ++i)
        box.add(m_measures ? measured(i).box : measures(element(m_first + i)).box);
    return raster_bounds(box);
}

RasterBounds CurveBatch::still_bounds() const {
    Bounds3f first, last;
    for (std::size_t i = 0; i < m_count; ++i) {
        first.add(measured(i).first);
        last.add(measured(i).last);
    }
    return ElementBatch::still_bounds(first, last);
}

void CurveBatch::measure() {
    if (!m_measures) measure_curves();
    const bool is_narrow = find_across();
    const RasterBounds still = still_bounds();
    if (is_narrow && scattered(still)) {
        m_runs = runs_of(still);
    } else if (is_narrow) {
        if (!m_has_ends) find_ends();
        m_diceable = find_rows(static_cast<std::size_t>(m_elements->grid_size() / m_across));
    }
    if (m_diceable || m_count == 1 || is_part()) return;
    m_pieces = is_narrow ? pieces_along(still) : 1;
    if (m_pieces == 1) m_across = 0;
}

void CurveBatch::measure_curves() {
    auto all = std::make_shared<std::vector<Measures>>();
    all->reserve(m_count);
    for (std::size_t i = 0; i < m_count; ++i) all->push_back(measures(element(m_first + i)));
    m_measures = std::move(all);
    m_first_measured = m_first;
}

void CurveBatch::find_ends() {
    static thread_local CurveControl control;  // kept for its memory
    auto all = std::make_shared<std::vector<Measures>>();
    all->reserve(m_count);
    for (std::size_t i = 0; i < m_count; ++i) {
        const std::uint32_t curve = element(m_first + i);
        const double lo = start(), hi = end(curve);
        control.gather(*m_elements, curve, lo, hi);
        std::vector<double>& ends = all->emplace_back(measured(i)).ends;
        control.steps(lo, hi, static_cast<std::size_t>(m_elements->grid_size()), ends);
    }
    m_measures = std::move(all);
    m_first_measured = m_first;
    m_has_ends = true;
}

/// Into how many parts these curves are cut together, a power of two: so that parts are as long as
/// curves of one grid may lie apart.
///
/// Halves of long curves that lie side by side stay as long: cut down to single curves, each of
/// them was visited by every bucket along its way.
unsigned CurveBatch::pieces_along(const RasterBounds& all) const {
    const std::uint32_t first = element(m_first);
    float length = 0.0f;
    for (std::size_t i = 0; i < m_count; ++i) {
        if (end_of(element(m_first + i)) != end_of(first)) return 1;
        const RasterBounds b = ElementBatch::still_bounds(measured(i).first, measured(i).last);
        if (!b.visible || !std::isfinite(b.x1 - b.x0 + b.y1 - b.y0)) return 1;
        length += std::max(b.x1 - b.x0, b.y1 - b.y0);
    }
    length /= static_cast<float>(m_count);
    if (!(2.0f * length >= std::max(all.x1 - all.x0, all.y1 - all.y0))) return 1;
    return std::bit_ceil(
        static_cast<unsigned>(std::ceil(std::clamp(length / kRegion, 1.0f, kMostPieces))));
}

std::vector<std::unique_ptr<Primitive>> CurveBatch::split() const {
    if (m_pieces == 1) return ElementBatch::split();
    // At points of the curves where there are enough, which are cheaper places.
    const double last = end_of(element(m_first)), pieces = m_pieces;
    const auto place = [&](unsigned i) {
        const double t = last * i / pieces;
        return last >= pieces ? std::round(t) : t;
    };
    std::vector<std::unique_ptr<Primitive>> parts;
    for (unsigned i = 0; i < m_pieces; ++i) {
        auto part = copy_of_run();
        part->m_path = m_path * m_pieces + i;
        part->m_lo = place(i);
        part->m_hi = place(i + 1);
        part->forget_measures();
        part->measure();
        parts.push_back(std::move(part));
    }
    return parts;
}

/// Of whole curves, so that all parts of one agree: it is known before one is split.  False: they
/// cannot share a grid.
bool CurveBatch::find_across() {
    if (m_across > 0) return true;
    double width = 0.0;
    for (std::size_t i = 0; i < m_count; ++i) width = std::max(width, measured(i).width);
    m_thin = width <= kThin;
    m_across = 1;
    while (m_across < std::min(kMostAcross, m_elements->grid_size() / 2) &&
           width > M_SQRT2 * m_elements->rate().rate() * m_across)
        m_across *= 2;
    // A row between curves shrinks without area only where it has no vertex inside.
    return m_count == 1 || m_across == 1;
}

/// False: more than `most` steps.
bool CurveBatch::find_rows(std::size_t most) {
    std::size_t steps = 3 * (m_count - 1);  // from each curve to the next
    for (std::size_t i = 0; i < m_count; ++i) steps += measured(i).ends.size();
    if (steps > most) return false;
    m_rows.reserve(steps + 1);
    for (std::size_t i = 0; i < m_count; ++i) {
        const std::uint32_t c = element(m_first + i);
        const double lo = start();
        if (i > 0) {
            const Row last = m_rows.back();
            m_rows.push_back({last.curve, last.t, true});
            m_rows.push_back({c, lo, true});
        }
        m_rows.push_back({c, lo, false});
        for (const double end : measured(i).ends) m_rows.push_back({c, end, false});
    }
    return true;
}

std::unique_ptr<ElementBatch> CurveBatch::child() const {
    return copy_of_run();
}

std::unique_ptr<CurveBatch> CurveBatch::copy_of_run() const {
    auto child = std::make_unique<CurveBatch>(*m_elements, m_batch);
    child->m_owner = m_owner;
    child->m_first = m_first;
    child->m_count = m_count;
    child->m_across = m_across;
    child->m_thin = m_thin;
    child->m_lo = m_lo;
    child->m_hi = m_hi;
    child->m_measures = m_measures;
    child->m_first_measured = m_first_measured;
    child->m_has_ends = m_has_ends;
    return child;
}

void CurveBatch::halve(unsigned number) {
    const double last = end(element(m_first));
    (number == 0 ? m_hi : m_lo) = curve_middle(m_lo, last);
    forget_measures();
}

template <class Visit>
void CurveBatch::for_each_row(Visit visit) const {
    CurveControl control;
    for (std::size_t j = 0; j < m_rows.size(); ++j) {
        const Row& row = m_rows[j];
        if (j == 0 || row.curve != m_rows[j - 1].curve)
            control.gather(*m_elements, row.curve, start(), end(row.curve));
        visit(static_cast<int>(j), row, control);
    }
}

std::unique_ptr<Grid> CurveBatch::dice() const {
    auto grid =
        m_elements->make_grid(m_batch, m_path, static_cast<int>(m_rows.size()) - 1, m_across);
    for_each_row([&](int j, const Row& row, const CurveControl& control) {
        place_row(*grid, j, row, control);
    });
    const auto kept = finish(*grid);
    if (m_across <= kMostOfSamples)
        grid->triangles = [batch = kept](const Grid& of, std::span<const GridPlace> wanted) {
            return static_cast<const CurveBatch&>(*batch).triangles(of, wanted);
        };
    return grid;
}

/// Each is a tube, on which a place has the normal of how far out it lies.
Grid CurveBatch::triangles(const Grid& from, std::span<const GridPlace> wanted) const {
    Grid grid =
        triangle_grid(from, m_elements->knots(), wanted.size(),
                      [&](std::size_t i) -> const GridTriangle& { return wanted[i].triangle; });
    std::vector<Vec3f> normals, fronts, along, across, offsets;
    std::vector<ElementPlace> places, steps;
    CurveControl control;
    std::uint32_t gathered = ~0u;
    for (const GridPlace& place : wanted) {
        // Corners 0 and 1 lie on the left, the others on the right.
        const float* w = place.weight;
        const bool second = place.triangle.second;
        const double ahead = second ? w[1] : w[1] + w[2];
        const auto steps_along = static_cast<std::uint32_t>(m_rows.size() - 1);
        const std::uint32_t strip = place.triangle.micropolygon / steps_along;
        const std::uint32_t step = place.triangle.micropolygon % steps_along;
        const Row &row = m_rows[step], &next = m_rows[step + 1];
        if (gathered != row.curve) control.gather(*m_elements, row.curve, start(), end(row.curve));
        gathered = row.curve;
        const double t = row.t + ahead * (next.t - row.t);
        const Side side = side_at(control, t);
        // Where a ribbon tapers, the triangle with the wide end holds more of its own side.
        const Grid::Corners c = from.corners(static_cast<int>(place.triangle.micropolygon));
        const double at_row = glm::distance(from.positions[c.v0], from.positions[c.v3]);
        const double at_next = glm::distance(from.positions[c.v1], from.positions[c.v2]);
        const double width = std::max(at_row + ahead * (at_next - at_row), 1e-30);
        const double from_edge = 2.0 * (second ? w[0] * at_row : w[2] * at_next) / width;
        const double in_strip = second ? 2.0 - from_edge : from_edge;  // 0 to 2
        const double u = (2.0 * strip + in_strip) / m_across - 1.0;
        normals.push_back(Vec3f(side.normal_at(u)));
        fronts.push_back(Vec3f(side.front));
        offsets.push_back(Vec3f(side.rise * std::sqrt(std::max(1.0 - u * u, 0.0))));
        across.push_back(Vec3f(2.0 * side.half / static_cast<double>(m_across)));
        const std::size_t i = normals.size() - 1, n = wanted.size();
        const std::vector<Vec3f>& p = grid.shading_p();
        // As long as the step; its edges lean where the ribbon tapers.
        const Vec3f step_along = p[i + n] - p[second ? i + 3 * n : i];
        const Vec3d way = normalize_or(side.along, Vec3d(0.0));
        along.push_back(Vec3f(way) * glm::length(step_along));
        places.push_back(control.place(t));
        steps.push_back(control.place(next.t));
    }
    repeat_runs(normals, grid.normal);
    repeat_runs(fronts, grid.geometric_normal);
    repeat_runs(along, grid.dp_du);
    repeat_runs(across, grid.dp_dv);
    repeat_runs(offsets, grid.ray_offset);
    // They are no whole faces.
    grid.shading_positions.faces.assign(4 * wanted.size(), grid.key.face);
    m_elements->fill_attributes(grid, places, steps);
    return grid;
}

std::shared_ptr<const ElementBatch> CurveBatch::copy() const {
    auto copy = std::make_shared<CurveBatch>(*this);
    copy->forget_measures();
    return copy;
}

void CurveBatch::fill_shading_state(Grid& grid) const {
    m_elements->begin_shading(grid);
    std::vector<ElementPlace> shading_positions;
    shading_positions.reserve(m_rows.size());
    for_each_row([&](int j, const Row& row, const CurveControl& control) {
        shade_row(grid, j, row, control);
        shading_positions.push_back(control.place(row.t));
    });
    m_elements->finish_shading(grid, shading_positions);
}

void CurveBatch::place_row(Grid& grid, int j, const Row& row, const CurveControl& control) const {
    const auto count = static_cast<std::size_t>(grid.vertex_count());
    for (int k = 0; k < m_elements->knot_count(); ++k) {
        const RibbonRow ribbon = control.row(k, row.t, false);
        Vec3f* to = &grid.positions[static_cast<std::size_t>(k) * count];
        for (int i = 0; i <= m_across; ++i) {
            const double u = row.shrunk ? -1.0 : 2.0 * i / m_across - 1.0;
            to[vertex(grid, i, j)] = Vec3f(ribbon.center + ribbon.across * u);
        }
    }
}

/// What a curve is like at the frame time.
CurveBatch::Side CurveBatch::side_at(const CurveControl& control, double t) const {
    Side at;
    Vec3d facing(0.0);
    for (int k = 0; k < m_elements->knot_count(); ++k) {
        const double weight = m_elements->frame_weight(k);
        if (weight == 0.0) continue;
        const RibbonRow ribbon = control.row(k, t, true);
        at.side += ribbon.side * weight;
        facing += ribbon.facing * weight;
        at.half += ribbon.across * weight;
        at.rise += ribbon.rise * weight;
        at.along += ribbon.along * weight;
    }
    at.front = normalize_or(facing, Vec3d(0.0, 0.0, -1.0));
    return at;
}

Vec3d CurveBatch::Side::normal_at(double sine) const {
    return normalize_or(side * sine + front * std::sqrt(std::max(1.0 - sine * sine, 0.0)), front);
}

void CurveBatch::shade_row(Grid& grid, int j, const Row& row, const CurveControl& control) const {
    const Side at = side_at(control, row.t);
    const double drawn = drawn_in(m_across);
    for (int i = 0; i <= m_across; ++i) {
        const double u = 2.0 * i / m_across - 1.0;
        const double sine = m_thin ? place_across(i == 0, (j + row.curve) % 2 == 1) : u * drawn;
        const Vec3d normal = at.normal_at(sine);
        const std::size_t v = vertex(grid, i, j);
        grid.normal[v] = Vec3f(normal);
        grid.geometric_normal[v] = Vec3f(at.front);
        // On the tube, as far as normals are drawn in: by it and the normal rays know where the
        // axis is (LitPlace::start_around).
        const Vec3d out = at.half * sine + at.rise * std::sqrt(std::max(1.0 - sine * sine, 0.0));
        grid.ray_offset[v] = Vec3f(out * drawn - at.half * (row.shrunk ? -1.0 : u));
    }
}

}  // namespace granita
