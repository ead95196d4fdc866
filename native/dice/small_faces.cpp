// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/small_faces.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel_sort.h"
#include "dice/lattice_stencil.h"
#include "dice/opened_mesh.h"
#include "dice/screen_points.h"
#include "math/morton.h"

namespace granita {
namespace {

/// Batches are no wider than this, pixels: buckets beside them should not meet them.
constexpr float kRegion = 32.0f;
/// Places on screen and in depth are told apart to this part of a pixel.
constexpr float kStepsAPixel = 4.0f;
/// How many times longer than a micropolygon's side a displaced one may be: what is shaded as one
/// point should not show that.
constexpr double kStretch = 1.5;

/// Farthest over nearest depth of a small face's corners: one that is deeper may take any number of
/// micropolygons once it is diced.
constexpr float kDeepest = 64.0f;

/// Faces that are looked at in a piece of a loop.
constexpr std::size_t kGrain = 1 << 12;

/// Places in OpenedMesh::points().
struct Corners {
    std::size_t v[4];
    int count;
};

Corners corners_of(const OpenedMesh& mesh, const BasePatch& patch) {
    Corners corners{};
    for (int i = 0; i < 4; ++i) corners.v[i] = mesh.place_of(patch.corner[i]);
    corners.count = patch.kind == PatchKind::Triangle ? 3 : 4;
    return corners;
}

/// log2 of the micropolygons along u and v, by the sides' lengths.
struct Levels {
    static constexpr std::uint8_t kTooMany = 255;
    std::uint8_t u = 0, v = 0;
    /// By displacement: one micropolygon as to its sides, but too long to be shaded as one point.
    bool stretched = false;
    bool whole() const { return u + v == 0 && !stretched; }
    bool small() const { return u != kTooMany; }
    int micropolygons() const { return 1 << (u + v); }
};
constexpr Levels kLarge{Levels::kTooMany, Levels::kTooMany};

/// Points of a coarser shading rate lie on lattices, each a grid of its own.
bool shares_points(const OpenedMesh& mesh) {
    return mesh.rate().shading_rate() <= mesh.rate().rate();
}

int most_levels(const OpenedMesh& mesh) {
    // Only straight edges have their points from tables.
    if (!mesh.straight_edges()) return 0;
    if (!shares_points(mesh)) return 0;
    int most = LatticeStencil::kMostLevels;
    while (1 << 2 * most > mesh.view().scene->options.grid_size && most > 0) --most;
    return most;
}

/// [patches of the part] what the sides need at any knot; kLarge: more than a small face may, or
/// some do not meet the frame.
std::vector<Levels> find_levels(const OpenedMesh& mesh, ScreenPoints& screen) {
    const MeshPart& part = mesh.part();
    const auto patch = [&](std::size_t p) -> const BasePatch& {
        return mesh.shared().patches()[part.patch(p)];
    };
    const float longest = mesh.rate().sure_length();
    const int most = most_levels(mesh);
    float limit2[LatticeStencil::kMostLevels + 1];  // of each level
    for (int i = 0; i <= most; ++i) limit2[i] = std::ldexp(longest * longest, 2 * i);
    std::vector<Vec2f> length2(part.patch_count(),
                               Vec2f(0.0f));  // of the longer side along u, along v
    const Projection& projection = mesh.view().projection;
    const auto is_deep = [&](std::span<const Vec3f> points, const Corners& c) {
        if (!projection.perspective) return false;
        auto [near, far] = std::pair(INFINITY, 0.0f);
        for (int i = 0; i < c.count; ++i) {
            near = std::min(near, points[c.v[i]].z);
            far = std::max(far, points[c.v[i]].z);
        }
        return far > kDeepest * std::max(near, static_cast<float>(projection.near_clip));
    };
    const auto is_small = [&](const Vec2f& l) { return std::max(l.x, l.y) <= limit2[most]; };
    std::atomic<std::size_t> left = part.patch_count();
    for (int k = 0; k < mesh.knot_count() && left > 0; ++k) {
        const std::span<const Vec3f> points = mesh.points(k);
        screen.project(points);
        const auto measure = [&](std::size_t p) {
            if (!is_small(length2[p])) return std::size_t{0};
            const Corners c = corners_of(mesh, patch(p));
            float side2[4] = {};
            for (int i = 0; i < c.count; ++i) {
                const std::size_t a = c.v[i], b = c.v[i + 1 < c.count ? i + 1 : 0];
                side2[i] = mesh.rate().length2(screen[b] - screen[a], points[a], points[b]);
            }
            length2[p] = glm::max(
                length2[p], Vec2f(std::max(side2[0], side2[2]), std::max(side2[1], side2[3])));
            // What is not a number is not small.
            if (!(side2[0] + side2[1] + side2[2] + side2[3] < INFINITY) || is_deep(points, c))
                length2[p] = Vec2f(INFINITY);
            return is_small(length2[p]) ? std::size_t{0} : std::size_t{1};
        };
        parallel_for(part.patch_count(), kGrain, [&](std::size_t begin, std::size_t end) {
            std::size_t large = 0;
            for (std::size_t p = begin; p < end; ++p) large += measure(p);
            left -= large;
        });
    }
    std::vector<Levels> levels(part.patch_count(), kLarge);
    const auto find = [&](std::size_t p) {
        if (!is_small(length2[p])) return;
        const Corners c = corners_of(mesh, patch(p));
        bool met = true;
        for (int i = 0; i < c.count; ++i)
            met &= screen.met_frame(c.v[i]) || screen.met_frame(c.v[i + 1 < c.count ? i + 1 : 0]);
        if (!met || !mesh.may_be_small(patch(p))) return;
        levels[p] = {};
        while (length2[p].x > limit2[levels[p].u]) ++levels[p].u;
        while (length2[p].y > limit2[levels[p].v]) ++levels[p].v;
    };
    parallel_for(left > 0 ? part.patch_count() : 0, kGrain,
                 [&](std::size_t begin, std::size_t end) {
                     for (std::size_t p = begin; p < end; ++p) find(p);
                 });
    return levels;
}

/// The offsets of the vertices of small faces, by which some are stretched.
VertexOffsets displace(const OpenedMesh& mesh, std::vector<Levels>& levels) {
    const MeshPart& part = mesh.part();
    std::vector<bool> wanted(part.vertex_count(), false);
    for (std::size_t p = 0; p < levels.size(); ++p)
        for (const std::uint32_t corner : mesh.shared().patches()[part.patch(p)].corner)
            if (levels[p].small()) wanted[mesh.place_of(corner)] = true;
    VertexOffsets offsets(mesh, wanted);
    const auto longest = static_cast<float>(kStretch * M_SQRT2 * mesh.rate().rate());
    ScreenPoints screen(mesh);
    for (int k = 0; k < mesh.knot_count(); ++k) {
        screen.project(offsets.points(mesh, k));
        const auto look = [&](Levels& at, float length) {
            at.stretched |= length > longest;
            if (!(length < INFINITY) || (at.stretched && !shares_points(mesh))) at = kLarge;
        };
        parallel_for(levels.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t p = begin; p < end; ++p) {
                if (!levels[p].small()) continue;
                const Corners c = corners_of(mesh, mesh.shared().patches()[part.patch(p)]);
                for (int i = 0; i < c.count; ++i)
                    look(levels[p],
                         glm::distance(screen[c.v[i]], screen[c.v[i + 1 < c.count ? i + 1 : 0]]));
            }
        });
    }
    return offsets;
}

/// A small face among its neighbours.
struct Member {
    std::uint32_t patch = 0;
    Levels levels = {};
    Vec3f place{0.0f};  ///< x, y, depth in pixels
    std::int32_t material = -1;
    bool back = false;
    bool bent = false;
    /// Both triangles of a bent quad are lattices of as many as it would be.
    int micropolygons() const { return levels.micropolygons() * (bent && !levels.whole() ? 2 : 1); }
    bool goes_with(const Member& other) const {
        return material == other.material && back == other.back &&
               levels.whole() == other.levels.whole();
    }
};

/// All but what of the patch is known.
void find_place(Member& member, const OpenedMesh& mesh, const ScreenPoints& screen,
                std::span<const Vec3f> points) {
    const BasePatch& patch = mesh.shared().patches()[member.patch];
    const Corners c = corners_of(mesh, patch);
    const Vec2f at = 0.5f * (screen[c.v[0]] + screen[c.v[2]]);
    const Vec3f a = points[c.v[2]] - points[c.v[0]], b = points[c.v[3]] - points[c.v[1]];
    const Vec3f middle = 0.5f * (points[c.v[0]] + points[c.v[2]]);
    const Vec3f view = mesh.view().projection.perspective ? middle : Vec3f(0.0f, 0.0f, 1.0f);
    member.place = Vec3f(at, screen.depth(middle.z));
    member.material = mesh.material(patch.face);
    member.bent = patch.bent;
    member.back = glm::dot(glm::cross(a, b), view) > 0.0f;
}

}  // namespace

SmallFaces::SmallFaces(const OpenedMesh& mesh) {
    ScreenPoints screen(mesh);
    std::vector<Levels> levels = find_levels(mesh, screen);
    const auto is_small = [](const Levels& l) { return l.small(); };
    if (mesh.displaced() && std::ranges::any_of(levels, is_small))
        m_offsets = displace(mesh, levels);
    const auto count = static_cast<std::size_t>(std::ranges::count_if(levels, is_small));
    if (count == 0) m_offsets = {};
    std::span<const Vec3f> at_frame = mesh.points(mesh.knots().frame_knot);
    std::vector<Vec3f> displaced;
    if (mesh.displaced() && count > 0) {
        displaced = m_offsets.points(mesh, mesh.knots().frame_knot);
        at_frame = displaced;
    }
    if (count > 0) screen.project(at_frame);
    m_others.reserve(levels.size() - count);
    std::vector<Member> members(count);
    std::size_t member = 0;
    for (std::uint32_t p = 0; p < levels.size(); ++p)
        if (!levels[p].small())
            m_others.push_back(mesh.part().patch(p));
        else
            members[member++] = {.patch = mesh.part().patch(p), .levels = levels[p]};
    if (members.empty()) return;
    parallel_for(count, kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) find_place(members[i], mesh, screen, at_frame);
    });
    Vec3f lowest(INFINITY);
    for (const Member& m : members) lowest = glm::min(lowest, m.place);
    // By material, side seen, size and place; numbers of members are a third of what would be moved
    // with them.
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order(count);
    parallel_for(count, kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Member& m = members[i];
            const auto group = (static_cast<std::uint64_t>(m.material + 1) << 2 | (m.back ? 2 : 0) |
                                (m.levels.whole() ? 0 : 1)) &
                               0x3ff;
            order[i] = {group << 54 | morton_code((m.place - lowest) * kStepsAPixel, 18),
                        static_cast<std::uint32_t>(i)};
        }
    });
    parallel_sort(order);
    const int most = std::max(mesh.view().scene->options.grid_size, 1);
    m_order.reserve(members.size());
    Bounds3f region;
    int micropolygons = 0;           // of the last batch
    std::vector<bool> has_lattices;  // [batches]
    const Member* last = nullptr;
    for (const auto& [code, number] : order) {
        const Member& m = members[number];
        Bounds3f wider = region;
        wider.add(m.place);
        const Vec3f size = wider.hi - wider.lo;
        micropolygons += m.micropolygons();
        if (!last || micropolygons > most || !m.goes_with(*last) || largest(size) > kRegion) {
            m_batches.push_back(static_cast<std::uint32_t>(m_order.size()));
            m_whole.push_back(m.levels.whole());
            has_lattices.push_back(false);
            micropolygons = m.micropolygons();
            wider = {};
            wider.add(m.place);
        }
        // The halves of a bent quad have a point between them where that is long enough.
        has_lattices.back() = has_lattices.back() || m.micropolygons() > 1;
        region = wider;
        last = &m;
        m_order.push_back(m.patch);
    }
    m_batches.push_back(static_cast<std::uint32_t>(m_order.size()));
    const auto knots = static_cast<std::size_t>(mesh.knot_count());
    m_boxes.resize(batch_count() * knots);
    parallel_for(m_boxes.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const int knot = static_cast<int>(i % knots);
            Bounds3f& box = m_boxes[i];
            const auto add_corners = [&](auto point) {
                for (const std::uint32_t face : batch(i / knots))
                    for (const std::uint32_t corner : mesh.shared().patches()[face].corner)
                        box.add(point(mesh.place_of(corner)));
                box.grow_relative(1e-6f);  // of what lies between the corners
            };
            const auto still = [&](std::size_t v) { return mesh.points(knot)[v]; };
            if (mesh.displaced() && has_lattices[i / knots]) {
                // Points of a lattice go elsewhere than its corners do.
                add_corners(still);
                box.grow(mesh.displacement_reach());
            } else if (mesh.displaced()) {
                add_corners([&](std::size_t v) { return m_offsets.point(mesh, knot, v); });
            } else {
                add_corners(still);
            }
        }
    });
}

}  // namespace granita
