// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/patch_edge.h"

#include <algorithm>

#include "dice/edge_rate.h"
#include "dice/opened_mesh.h"

namespace granita {
namespace {

/// Parameter on the whole edge of a place in a node's own direction; exact.
double on_edge(const PatchEdge& side, double place) {
    return (side.index + place) / static_cast<double>(std::uint32_t{1} << side.depth);
}

}  // namespace

void EdgeWalker::edge_point(const PatchEdge& side, double t, EdgePoint& out) const {
    if (!side.line) {
        m_mesh.edge_point(side.edge, t, out);
        return;
    }
    const Line& line = *side.line;
    if (t > 0.0 && t < 1.0) {
        m_mesh.surface_point(m_patch, line.uv0 * (1.0 - t) + line.uv1 * t, out);
        return;
    }
    const std::ptrdiff_t first = t > 0.0 ? m_mesh.knot_count() : 0;
    std::copy_n(line.p.begin() + first, m_mesh.knot_count(), out.p);
}

SurfacePlace EdgeWalker::edge_place(const PatchEdge& side, double t) const {
    if (!side.line) return m_mesh.edge_place(side.edge, t);
    const Line& line = *side.line;
    if (t > 0.0 && t < 1.0) return {nullptr, line.uv0 * (1.0 - t) + line.uv1 * t};
    return line.place[t > 0.0 ? 1 : 0];
}

void EdgeWalker::point(const PatchEdge& side, double at, EdgePoint& out) const {
    const double t = on_edge(side, side.reversed ? 1.0 - at : at);
    edge_point(side, t, out);
    if (m_mesh.displaced()) out.place = edge_place(side, t);
}

void EdgeWalker::classify(PatchEdge& side) const {
    EdgePoint start, middle, end;
    edge_point(side, on_edge(side, 0.0), start);
    edge_point(side, on_edge(side, 1.0), end);
    const EdgeRate& rate = m_mesh.rate();
    if (!side.line && m_mesh.straight_edges() &&
        rate.stays_whole(start.p, end.p, m_mesh.knot_count())) {
        side.levels = 0;
        return;
    }
    edge_point(side, on_edge(side, 0.5), middle);
    side.levels = static_cast<std::int8_t>(
        rate.levels(start.p, middle.p, end.p, m_mesh.knot_count(), side.budget, side.most_outside));
}

PatchEdge EdgeWalker::half(const PatchEdge& side, int half) const {
    PatchEdge child = side;
    child.index = 2 * side.index + static_cast<unsigned>(side.reversed ? 1 - half : half);
    child.depth = static_cast<std::uint8_t>(side.depth + 1);
    child.budget = static_cast<std::uint8_t>(side.budget > 0 ? side.budget - 1 : 0);
    if (side.levels == EdgeRate::kAdaptive)
        classify(child);
    else
        child.levels = static_cast<std::int8_t>(side.levels > 0 ? side.levels - 1 : 0);
    return child;
}

int EdgeWalker::depth(const PatchEdge& side, int cap) const {
    if (side.levels >= 0) return std::min<int>(side.levels, cap + 1);
    if (cap <= 0) return 1;
    const int first = depth(half(side, 0), cap - 1);
    if (first >= cap) return cap + 1;
    return 1 + std::max(first, depth(half(side, 1), cap - 1));
}

void EdgeWalker::leaf_ends(const PatchEdge& side, int first, int steps,
                           std::vector<int>& ends) const {
    if (!side.refined()) {
        ends.push_back(first + steps);
        return;
    }
    leaf_ends(half(side, 0), first, steps / 2, ends);
    leaf_ends(half(side, 1), first + steps / 2, steps / 2, ends);
}

PatchEdge EdgeWalker::draw(const Vec2d& uv0, const Vec2d& uv1, const EdgePoint& start,
                           const EdgePoint& end, int budget, float most_outside) const {
    auto line = std::make_shared<Line>();
    line->uv0 = uv0;
    line->uv1 = uv1;
    const int knots = m_mesh.knot_count();
    line->p.assign(start.p, start.p + knots);
    line->p.insert(line->p.end(), end.p, end.p + knots);
    line->place[0] = start.place;
    line->place[1] = end.place;
    PatchEdge side;
    side.line = std::move(line);
    side.most_outside = most_outside;
    side.budget = static_cast<std::uint8_t>(budget);
    classify(side);
    return side;
}

}  // namespace granita
