// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/patch.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "dice/coarsen_shading.h"
#include "dice/lattice.h"
#include "dice/raster_bound.h"

namespace granita {
namespace {

/// Another base is taken where it promises so many times fewer micropolygons (of a plump triangle
/// all promise the same), and the longest side halved where even the best promises so many times
/// what the area needs.
constexpr double kFewer = 4.0;
constexpr double kThin = 3.0;

}  // namespace

std::vector<Bounds3f> patch_boxes(const OpenedMesh& mesh, const BasePatch& patch,
                                  const Vec2d* corner_uv) {
    std::vector<Bounds3f> boxes = mesh.boxes(patch, corner_uv);
    for (Bounds3f& box : boxes) {
        box.grow_relative(1e-6f);  // of positions
        box.grow(mesh.displacement_reach());
    }
    return boxes;
}

Patch::Patch(std::shared_ptr<const OpenedMesh> mesh, const BasePatch& patch)
    : m_mesh(std::move(mesh)), m_patch(patch) {}

std::unique_ptr<Patch> Patch::open(std::shared_ptr<const OpenedMesh> mesh, const BasePatch& patch) {
    std::unique_ptr<Patch> opened(new Patch(std::move(mesh), patch));
    const std::int32_t corners = opened->m_mesh->data().face_sizes[patch.face];
    const int bits =
        patch.whole_face ? 0 : static_cast<int>(std::bit_width(static_cast<unsigned>(corners)));
    opened->m_path = (std::uint64_t{1} << bits) | patch.sub;
    const int budget = std::min(kMostEdgeLevels, (62 - bits) / 2);
    opened->m_budget_u = opened->m_budget_v = budget;
    OpenedMesh::Start start = opened->m_mesh->start(patch, budget);
    std::copy_n(start.corner_uv, 4, opened->m_corner_uv);
    std::move(start.sides, start.sides + 4, opened->m_sides);
    if (!patch.bent) opened->measure();
    return opened;
}

int Patch::splittable(bool along_u) const {
    if ((along_u ? m_budget_u : m_budget_v) <= 0) return 0;
    const PatchEdge& low = m_sides[along_u ? kBottom : kLeft];
    const PatchEdge& high = m_sides[along_u ? kTop : kRight];
    if (low.refined() && (high.refined() || high.collapsed)) return 2;
    if (high.refined() && low.collapsed) return 2;
    return low.refined() || high.refined() ? 1 : 0;
}

void Patch::measure() {
    find_rates();
    if (m_diceable || m_patch.kind != PatchKind::Triangle) return;
    const Base best = best_base();
    if (best.side > 0) {
        turn(best.side);
        find_rates();
    }
    if (best.halved && splittable(true) == 2) m_split_u = true;
}

/// Lines of a triangle run from its base to its apex: of three corners that lie nearly in a line,
/// as boolean operations and the n-gons of buildings leave them, each as long as the whole, though
/// nothing lies between (of 940 pixels 281,000 micropolygons of no area).  So the base that has the
/// fewest of them is taken; where that is many more than there is room for, the longest side is,
/// and halved (Rivara 1984), until a half has a short base.  What fits into a grid is not halved
/// for.
Patch::Base Patch::best_base() const {
    const bool is_triangle = m_sides[kTop].collapsed && !m_sides[kBottom].collapsed &&
                             !m_sides[kRight].collapsed && !m_sides[kLeft].collapsed;
    if (!is_triangle) return {};
    const Projection& projection = m_mesh->view().projection;
    Vec2d corner[3];
    EdgePoint point;
    for (int i = 0; i < 3; ++i) {
        m_mesh->surface_point(m_patch, m_corner_uv[i], point);
        const Vec3d p(point.p[m_mesh->knots().frame_knot]);
        if (projection.perspective && !(p.z >= projection.near_clip)) return {};
        corner[i] = Vec2d(projection.scale) * Vec2d(p) / (projection.perspective ? p.z : 1.0);
    }
    double side[3], lattice[3];
    for (int i = 0; i < 3; ++i) side[i] = glm::distance(corner[i], corner[(i + 1) % 3]);
    for (int i = 0; i < 3; ++i)
        lattice[i] = side[i] * std::max(side[(i + 1) % 3], side[(i + 2) % 3]);
    const int longest = static_cast<int>(std::max_element(side, side + 3) - side);
    const int best = static_cast<int>(std::min_element(lattice, lattice + 3) - lattice);
    const Vec2d a = corner[1] - corner[0], b = corner[2] - corner[0];
    const double height = std::abs(a.x * b.y - a.y * b.x) / side[longest];
    const double grid_side =
        m_mesh->rate().rate() * std::sqrt(m_mesh->view().scene->options.grid_size);
    if (kThin * side[longest] * std::max(height, grid_side) < lattice[best]) return {longest, true};
    return {kFewer * lattice[best] < lattice[0] ? best : 0, false};
}

/// Side `base` of a triangle, bottom, right or left in turn, becomes its bottom.
void Patch::turn(int base) {
    PatchEdge around[3] = {m_sides[kBottom], m_sides[kRight], m_sides[kLeft]};
    around[2].reversed = !around[2].reversed;
    const Vec2d uv[3] = {m_corner_uv[0], m_corner_uv[1], m_corner_uv[2]};
    for (int i = 0; i < 4; ++i) m_corner_uv[i] = uv[(base + std::min(i, 2)) % 3];
    set_triangle_sides(around, base, m_sides);
    std::swap(m_budget_u, m_budget_v);
}

void Patch::find_rates() {
    const int grid_size = std::max(m_mesh->view().scene->options.grid_size, 1);
    const int most = static_cast<int>(std::bit_width(static_cast<unsigned>(grid_size))) - 1;
    const EdgeWalker walk(*m_mesh, m_patch);
    m_border.u = std::max(walk.depth(m_sides[kBottom], most), walk.depth(m_sides[kTop], most));
    m_border.v = std::max(walk.depth(m_sides[kLeft], most), walk.depth(m_sides[kRight], most));
    m_rates = m_border;
    if (m_border.u + m_border.v <= most) measure_inside(walk, most);
    const int u = splittable(true), v = splittable(false);
    m_diceable = m_rates.u + m_rates.v <= most || u + v == 0;
    if (m_diceable) {
        // Only the sides are owed their vertices.
        while (m_rates.u + m_rates.v > most && (m_rates.u > m_border.u || m_rates.v > m_border.v)) {
            if (m_rates.u > m_border.u && (m_rates.u >= m_rates.v || m_rates.v <= m_border.v))
                --m_rates.u;
            else
                --m_rates.v;
        }
        return;
    }
    // A side that has no vertex inside makes a fan of triangles: last choice.
    if (u != v)
        m_split_u = u > v;
    else if (m_rates.u != m_rates.v)
        m_split_u = m_rates.u > m_rates.v;
    else
        m_split_u = m_budget_u >= m_budget_v;
}

/// Between the sides a surface may need more than they do: where it is curved, and where they lie
/// outside the frame, and coarse for that, around or beside what the frame shows.  Its middle lines
/// stand for it, as near to the frame as the patch is.
void Patch::measure_inside(const EdgeWalker& walk, int most) {
    const bool curved = !m_mesh->straight_edges();
    if (!curved && m_border.u + m_border.v == 0) return;  // a pixel or two
    const RasterBounds around = bounds();
    const EdgeRate& rate = m_mesh->rate();
    if (!curved && rate.inside(around)) return;
    const auto outside = static_cast<float>(rate.outside(around));
    EdgePoint a, b;
    for (const bool along_u : {true, false}) {
        const Vec2d* c = m_corner_uv;
        const Vec2d start = 0.5 * (c[0] + (along_u ? c[3] : c[1]));
        const Vec2d end = 0.5 * (c[2] + (along_u ? c[1] : c[3]));
        m_mesh->surface_point(m_patch, start, a);
        m_mesh->surface_point(m_patch, end, b);
        const PatchEdge middle =
            walk.draw(start, end, a, b, along_u ? m_budget_u : m_budget_v, outside);
        int& levels = along_u ? m_rates.u : m_rates.v;
        levels = std::max(levels, walk.depth(middle, most));
    }
}

bool Patch::diceable() const {
    return m_diceable;
}

GridKey Patch::key() const {
    return {m_mesh->instance().key, m_patch.face, m_path};
}

RasterBounds Patch::bounds() const {
    return raster_bound_of(m_mesh->view().projection, patch_boxes(*m_mesh, m_patch, m_corner_uv));
}

std::vector<Bounds3f> Patch::knot_boxes() const {
    if (m_mesh->knot_count() == 1) return {};
    return patch_boxes(*m_mesh, m_patch, m_corner_uv);
}

Patch::Cut Patch::cut(int side, bool collapsed_before, int before, int after) const {
    const EdgeWalker walk(*m_mesh, m_patch);
    const PatchEdge& s = m_sides[side];
    Cut cut;
    if (s.refined()) {
        cut.uv = 0.5 * (m_corner_uv[before] + m_corner_uv[after]);
        walk.point(s, 0.5, cut.point);
        cut.halves[0] = walk.half(s, 0);
        cut.halves[1] = walk.half(s, 1);
        return cut;
    }
    // The corner away from a side that is a point already, or that child would have no area.
    const bool at_end = collapsed_before;
    cut.uv = m_corner_uv[at_end ? after : before];
    cut.halves[0] = cut.halves[1] = s;
    PatchEdge& point = cut.halves[at_end ? 1 : 0];
    point = PatchEdge{};
    point.collapsed = true;
    if (!s.collapsed) {
        walk.point(s, at_end ? 1.0 : 0.0, cut.point);
    } else {
        // A collapsed side is a point that its neighbours end in; those run from bottom to top and
        // from left to right.
        const bool first = side == kBottom || side == kLeft;
        walk.point(m_sides[side == kBottom || side == kTop ? kLeft : kBottom], first ? 0.0 : 1.0,
                   cut.point);
    }
    return cut;
}

std::vector<std::unique_ptr<Primitive>> Patch::split() const {
    if (m_patch.bent) {
        std::vector<std::unique_ptr<Primitive>> triangles;
        for (const int number : {0, 1}) triangles.push_back(open(m_mesh, m_patch.half(number)));
        return triangles;
    }
    const bool u = m_split_u;
    // Named for a split along u; along v, left and bottom, right and top change places.
    const bool point_before = m_sides[u ? kLeft : kBottom].collapsed;
    const Cut low = cut(u ? kBottom : kLeft, point_before, 0, u ? 1 : 3);
    const Cut high = cut(u ? kTop : kRight, point_before, u ? 3 : 1, 2);
    const EdgeWalker walk(*m_mesh, m_patch);
    const PatchEdge line =
        walk.draw(low.uv, high.uv, low.point, high.point, u ? m_budget_v : m_budget_u);

    std::vector<std::unique_ptr<Primitive>> children;
    for (int number = 0; number < 2; ++number) {
        std::unique_ptr<Patch> child(new Patch(m_mesh, m_patch));
        child->m_path = 2 * m_path + static_cast<unsigned>(number);
        child->m_budget_u = m_budget_u - (u ? 1 : 0);
        child->m_budget_v = m_budget_v - (u ? 0 : 1);
        std::copy_n(m_corner_uv, 4, child->m_corner_uv);
        std::copy_n(m_sides, 4, child->m_sides);
        child->m_sides[u ? kBottom : kLeft] = low.halves[number];
        child->m_sides[u ? kTop : kRight] = high.halves[number];
        if (number == 0) {
            child->m_corner_uv[u ? 1 : 3] = low.uv;
            child->m_corner_uv[2] = high.uv;
            child->m_sides[u ? kRight : kTop] = line;
        } else {
            child->m_corner_uv[0] = low.uv;
            child->m_corner_uv[u ? 3 : 1] = high.uv;
            child->m_sides[u ? kLeft : kBottom] = line;
        }
        child->measure();
        children.push_back(std::move(child));
    }
    return children;
}

std::unique_ptr<Grid> Patch::dice() const {
    auto grid = std::make_unique<Grid>();
    grid->key = key();
    grid->instance = static_cast<std::uint32_t>(m_mesh->instance_index());
    grid->material = m_mesh->material(m_patch.face);
    grid->holdout = m_mesh->holds_out(grid->material);
    grid->lifespan = m_mesh->instance().lifespan;
    dice_lattice(*m_mesh, m_patch, {m_corner_uv, m_sides, 1 << m_rates.u, 1 << m_rates.v}, *grid);
    const Projection& projection = m_mesh->view().projection;
    grid->bounds = raster_bound(projection, grid->positions);
    if (!grid->bounds.visible &&
        std::ranges::none_of(grid->positions, [](const Vec3f& p) { return is_finite(p); })) {
        m_mesh->report().warn(m_mesh->instance().name, "a grid without any finite vertex left out");
        return nullptr;
    }
    if (m_mesh->rate().shading_rate() > m_mesh->rate().rate())
        coarsen_shading(*grid, projection, m_mesh->rate().shading_rate());
    return grid;
}

}  // namespace granita
