// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/patch_edge.h"

#include <algorithm>
#include <cmath>

#include "dice/edge_rate.h"
#include "dice/lattice_stencil.h"
#include "dice/opened_mesh.h"

namespace granita {
namespace {

/// Parameter on the whole edge of a place in a node's own direction; exact.
double on_edge(const PatchEdge& side, double place) {
    return (side.index + place) / static_cast<double>(std::uint32_t{1} << side.depth);
}

/// Places of an edge at which roughness is looked for, and of its length the largest step from one.
constexpr int kProbes = 6;
constexpr double kProbeStep = 1.0 / 16.0;
/// Sag over length of a micropolygon's side that is rough.
constexpr double kRoughBend = 0.02;
/// Levels of a base edge from which it may be diced more finely for that.
constexpr int kLeastRough = LatticeStencil::kMostLevels + 1;

}  // namespace

void set_triangle_sides(const PatchEdge* around, int base, PatchEdge* sides) {
    sides[0] = around[base];
    sides[1] = around[(base + 1) % 3];
    sides[2] = PatchEdge{};
    sides[2].collapsed = true;
    sides[3] = around[(base + 2) % 3];
    sides[3].reversed = !sides[3].reversed;
}

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
    int found = levels(side);
    // Faces of a few micropolygons have their vertices from tables (dice/small_faces.h).
    const bool may_be_rough = found < 0 || side.line || side.depth + found >= kLeastRough;
    if (may_be_rough && m_mesh.rate().most_rough_levels() > 0) {
        if (side.rough < 0) side.rough = static_cast<std::int8_t>(rough_levels(side));
        if (found >= 0) found = std::min(found + side.rough, static_cast<int>(side.budget));
    }
    side.levels = static_cast<std::int8_t>(found);
}

int EdgeWalker::levels(const PatchEdge& side) const {
    EdgePoint start, middle, end;
    edge_point(side, on_edge(side, 0.0), start);
    edge_point(side, on_edge(side, 1.0), end);
    const EdgeRate& rate = m_mesh.rate();
    if (!side.line && m_mesh.straight_edges() &&
        rate.stays_whole(start.p, end.p, m_mesh.knot_count()))
        return 0;
    edge_point(side, on_edge(side, 0.5), middle);
    return rate.levels(start.p, middle.p, end.p, m_mesh.knot_count(), side.budget,
                       side.most_outside);
}

/// By how far displacement bends single micropolygons along the whole edge, where the frame shows
/// it sharp.
int EdgeWalker::rough_levels(const PatchEdge& side) const {
    const EdgeRate& rate = m_mesh.rate();
    const int frame = m_mesh.knots().frame_knot;
    std::vector<SurfacePlace> places;
    std::vector<double> lengths;
    EdgePoint before, after;
    for (int i = 0; i < kProbes; ++i) {
        const double t = (i + 0.5) / kProbes;
        edge_point(side, t - kProbeStep, before);
        edge_point(side, t + kProbeStep, after);
        const Vec3f &a = before.p[frame], &b = after.p[frame];
        const double pixels = rate.facing_length(a, b);
        if (!(pixels > 0.0) || !rate.shows_sharp(before.p, m_mesh.knot_count(), frame)) continue;
        const double half = kProbeStep * std::min(1.0, rate.rate() / pixels);
        lengths.push_back(glm::distance(a, b) * half / kProbeStep);
        for (const double at : {t - half, t, t + half}) {
            places.push_back(edge_place(side, at));
            if (!places.back().patch) places.back().patch = &m_patch;
        }
    }
    Offsets offsets;
    m_mesh.find_offsets(places, false, offsets);
    const Mat3f turn(m_mesh.knots().frame_camera_from_object);
    double sum = 0.0;
    for (std::size_t i = 0; i < lengths.size(); ++i) {
        const Vec3f* const at = &offsets.offset[3 * i];
        const double sag = glm::length(turn * (at[1] - 0.5f * (at[0] + at[2])));
        sum += sag * sag / (lengths[i] * lengths[i]);
    }
    double bend = lengths.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(lengths.size()));
    int levels = 0;
    for (; levels < rate.most_rough_levels() && bend > kRoughBend; ++levels) bend *= 0.5;
    return levels;
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
    // What stands for a surface is between sides that tell of roughness themselves.
    if (std::isfinite(most_outside)) side.rough = 0;
    side.budget = static_cast<std::uint8_t>(budget);
    classify(side);
    return side;
}

}  // namespace granita
