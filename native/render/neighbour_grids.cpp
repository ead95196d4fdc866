// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/neighbour_grids.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/parallel.h"
#include "render/box_cells.h"
#include "shade/bounces/neighbours.h"

namespace granita {
namespace {

/// Grids around one, seen or not, of more the nearest: around a lattice of full size lie 8, around
/// one of 4 x 4 points 48.  Where each face of half a pixel is a grid, or strips meet at a pole, a
/// thousand would tell little that those do not.
constexpr std::size_t kMost = 64;

struct Near {
    float distance2;
    GridKey key;
    const std::shared_ptr<SharedGrid>* grid;

    bool operator<(const Near& other) const {
        return std::tie(distance2, key) < std::tie(other.distance2, other.key);
    }
};

Vec3f middle(const Bounds3f& box) {
    return 0.5f * (box.lo + box.hi);
}

/// The largest of what is least, and the least of what is largest.
RasterBounds common(const RasterBounds& a, const RasterBounds& b) {
    RasterBounds both = a;
    both.x0 = std::max(a.x0, b.x0);
    both.y0 = std::max(a.y0, b.y0);
    both.x1 = std::min(a.x1, b.x1);
    both.y1 = std::min(a.y1, b.y1);
    return both;
}

/// Whether all buckets that see `own` find what lies there.
bool is_beside(const RasterBounds& b, const RasterBounds& own, float margin) {
    return b.visible && b.x0 - margin <= own.x0 && b.x1 + margin >= own.x1 &&
           b.y0 - margin <= own.y0 && b.y1 + margin >= own.y1;
}

}  // namespace

struct NeighbourGrids::List {
    /// Of the grids that may ask: the bounds that are easiest to lie beside, and materials.
    RasterBounds asks;
    std::vector<int> materials;
    SharedOnce made;
    std::vector<Listed> listed;
    BoxCells cells;  ///< of their places

    void add_asking(const Grid& grid) {
        const RasterBounds& b = grid.bounds;
        asks = materials.empty() ? b : common(asks, b);
        if (std::ranges::find(materials, grid.material) == materials.end())
            materials.push_back(grid.material);
    }
};

/// Lists those of one instance.
class NeighbourGrids::Maker {
  public:
    Maker(Frame& frame, int bucket, List& list)
        : m_frame(frame),
          m_bucket(bucket),
          m_at(frame.layout.place(bucket)),
          m_margin(static_cast<float>(neighbour_margin(frame.scene.options))),
          m_list(list) {}

    void run(std::uint32_t instance) {
        FrameGeometry& geometry = m_frame.geometry;
        FrameGeometry::Opened& opened = *geometry.open(instance);
        geometry.for_each_face(opened, m_bucket, [&](std::uint32_t face) {
            const RasterBounds& bounds = opened.bounds[face];
            if (is_beside(bounds, m_list.asks, m_margin))
                visit(*geometry.node(opened, face), bounds);
        });
        parallel_for(m_list.listed.size(), 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) place(m_list.listed[i]);
        });
        std::erase_if(m_list.listed, [](const Listed& one) { return !one.grid; });
        std::vector<Bounds3f> boxes;
        for (const Listed& one : m_list.listed) boxes.push_back(one.place.box);
        m_list.cells = BoxCells(boxes);
    }

  private:
    void visit(GeometryNode& node, const RasterBounds& bounds) {
        m_frame.progress.check();
        const GeometryNode::Content& content =
            node.expand(m_frame.layout, m_frame.geometry.ends(), m_frame.statistics);
        for (const GeometryNode::Child& child : content.children)
            if (child.buckets.holds(m_at.x, m_at.y) &&
                is_beside(child.bounds, m_list.asks, m_margin))
                visit(*child.node, common(bounds, child.bounds));
        const auto& grid = content.grid;
        if (grid &&
            std::ranges::find(m_list.materials, grid->grid().material) != m_list.materials.end())
            m_list.listed.push_back({grid, bounds, {}});
    }

    /// Drops those that tell nothing.
    void place(Listed& one) {
        const Grid& grid = one.grid->grid();
        const ShadingSystem& shading = m_frame.shading;
        // Which small faces are left to samples goes by opacity, whoever has asked for that so far.
        if (grid.triangles && shading.opacity_varies(grid.material))
            one.grid->ensure_opacity(shading, m_frame.statistics);
        // Those have no place once their state is dropped.
        if (!shading.leaves_to_samples(grid)) one.place = one.grid->place(m_frame.statistics);
        const Bounds3f& box = one.place.box;
        if (box.empty() || !is_finite(box.lo) || !is_finite(box.hi)) one.grid.reset();
    }

    Frame& m_frame;
    const int m_bucket;
    const Vec2i m_at;
    const float m_margin;
    List& m_list;
};

int neighbour_margin(const Options& options) {
    const float side = std::sqrt(static_cast<float>(options.grid_size)) * options.dicing_rate;
    return static_cast<int>(std::ceil(2.0f * side));
}

NeighbourGrids::NeighbourGrids(Frame& frame, int bucket, const HiddenGrids& grids,
                               const std::vector<bool>& seen)
    : m_frame(frame), m_bucket(bucket) {
    if (!frame.shading.shares_light()) return;
    for (std::size_t slot = 0; slot < grids.size(); ++slot) {
        if (!seen[slot]) continue;
        const Grid& grid = grids[slot]->grid();
        std::unique_ptr<List>& list = m_lists[grid.instance];
        if (!list) list = std::make_unique<List>();
        list->add_asking(grid);
    }
}

NeighbourGrids::~NeighbourGrids() = default;

HiddenGrids NeighbourGrids::of(SharedGrid& grid) {
    const Grid& own = grid.grid();
    const auto found_list = m_lists.find(own.instance);
    if (found_list == m_lists.end()) return {};
    List& list = *found_list->second;
    list.made.call([&] { Maker(m_frame, m_bucket, list).run(own.instance); });
    const SharedGrid::Place& place = grid.place(m_frame.statistics);
    const float reach = static_cast<float>(kNeighbourReach) * place.step;
    const float margin = static_cast<float>(neighbour_margin(m_frame.scene.options));
    std::vector<Near> near;
    const auto find = [&](float within) {
        Bounds3f around = place.box;
        around.grow(within);
        near.clear();
        list.cells.each_near(around, [&](std::uint32_t index) {
            const Listed& one = list.listed[index];
            if (!place.is_within(within, one.place) || !is_beside(one.bounds, own.bounds, margin))
                return;
            const Grid& other = one.grid->grid();
            if (other.key == own.key || other.material != own.material) return;
            const Vec3f way = middle(one.place.box) - middle(place.box);
            near.push_back({glm::dot(way, way), other.key, &one.grid});
        });
    };
    // Not all of what lies within reach, where enough of it is nearer: spikes reach far.
    for (float part = 1.0f / 64.0f; part <= 1.0f && near.size() < kMost; part *= 4.0f)
        find(part * reach);
    if (near.size() > kMost) {
        std::nth_element(near.begin(), near.begin() + kMost, near.end());
        near.resize(kMost);
    }
    std::ranges::sort(near, {}, &Near::key);
    HiddenGrids found;
    for (const Near& one : near) found.push_back(*one.grid);
    return found;
}

std::vector<HiddenGrids> all_neighbours(Frame& frame, int bucket, const HiddenGrids& grids,
                                        const std::vector<bool>& seen) {
    std::vector<HiddenGrids> around;
    if (!frame.shading.shares_light()) return around;
    around.resize(grids.size());
    NeighbourGrids neighbours(frame, bucket, grids, seen);
    parallel_for(grids.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t slot = begin; slot < end; ++slot) {
            frame.progress.check();
            if (seen[slot] && !frame.shading.leaves_to_samples(grids[slot]->grid()))
                around[slot] = neighbours.of(*grids[slot]);
        }
    });
    return around;
}

}  // namespace granita
