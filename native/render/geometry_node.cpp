// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/geometry_node.h"

#include "base/stage_timer.h"

namespace granita {
namespace {

/// What nobody reads once radiance is there and settled.
void drop_shading_state(Grid& grid) {
    for (std::vector<Vec3f>* values : {&grid.p, &grid.normal, &grid.geometric_normal, &grid.dp_du,
                                       &grid.dp_dv, &grid.ray_offset})
        std::vector<Vec3f>().swap(*values);
    std::vector<Vec4f>().swap(grid.rise);
    std::vector<GridAttribute>().swap(grid.attributes);
    std::vector<std::uint32_t>().swap(grid.shading_positions.faces);
}

}  // namespace

SharedGrid::SharedGrid(std::unique_ptr<Grid> grid, Statistics& statistics)
    : m_grid(std::move(grid)), m_statistics(statistics) {
    count_bytes();
}

SharedGrid::~SharedGrid() {
    m_statistics.remove_grid_bytes(m_bytes + (m_sweep ? m_sweep->bytes() : 0));
}

void SharedGrid::count_bytes() {
    m_statistics.remove_grid_bytes(m_bytes);
    m_bytes = m_grid->bytes();
    m_statistics.add_grid_bytes(m_bytes);
}

void SharedGrid::ensure_shading_state(Statistics& statistics) {
    m_has_state.call([&] {
        if (!m_grid->shading_state) return;
        const StageTimer timer(statistics, Stage::Dice);
        const Stopwatch watch;
        m_grid->shading_state(*m_grid);
        statistics.objects().add_seconds(m_grid->instance, watch.seconds());
        m_grid->shading_state = {};
        count_bytes();
    });
}

const GridSweep& SharedGrid::sweep(const Projection& projection, const LensShape& lens) {
    m_has_sweep.call([&] {
        m_sweep.emplace(*m_grid, projection, lens);
        m_statistics.add(Counter::GridsSwept);
        m_statistics.add_grid_bytes(m_sweep->bytes());
    });
    return *m_sweep;
}

void SharedGrid::ensure_opacity(const ShadingSystem& shading, Statistics& statistics) {
    m_opacity.call([&] {
        ensure_shading_state(statistics);
        const StageTimer timer(statistics, Stage::Shade);
        const Stopwatch watch;
        shading.shade_opacity(*m_grid);
        statistics.objects().add_seconds(m_grid->instance, watch.seconds());
    });
}

void SharedGrid::ensure_radiance(const ShadingSystem& shading, Statistics& statistics, bool stays) {
    m_radiance.call([&] {
        if (!shading.leaves_to_samples(*m_grid)) ensure_shading_state(statistics);
        const StageTimer timer(statistics, Stage::Shade);
        const Stopwatch watch;
        shading.shade_radiance(*m_grid);
        statistics.objects().add_seconds(m_grid->instance, watch.seconds());
        if (!stays && m_grid->unsettled.empty()) drop_shading_state(*m_grid);
        count_bytes();
    });
}

void SharedGrid::forget_radiance() {
    m_radiance.reset();
    m_grid->light_share = 0.0f;
    m_grid->broken_radiance = false;
    m_grid->radiance.clear();
    m_grid->found = {};
    m_grid->found_alone.reset();
    m_grid->unsettled.clear();
    m_grid->channels.clear();
}

std::shared_ptr<SharedGrid> dice_counted(const Primitive& primitive, Statistics& statistics) {
    const StageTimer timer(statistics, Stage::Dice);
    const Stopwatch watch;
    auto grid = primitive.dice();
    if (!grid) return nullptr;
    statistics.objects().add_seconds(grid->instance, watch.seconds());
    statistics.objects().add_micropolygons(grid->instance,
                                           static_cast<std::uint64_t>(grid->micropolygon_count()));
    statistics.add(Counter::GridsDiced);
    statistics.add(Counter::PointsDiced, static_cast<std::uint64_t>(grid->vertex_count()));
    return std::make_shared<SharedGrid>(std::move(grid), statistics);
}

std::vector<std::unique_ptr<Primitive>> split_counted(const Primitive& primitive,
                                                      Statistics& statistics) {
    const StageTimer timer(statistics, Stage::Split);
    statistics.add(Counter::PrimitivesSplit);
    return primitive.split();
}

GeometryNode::GeometryNode(std::unique_ptr<Primitive> primitive, const RasterBounds& bounds,
                           const BucketLayout& layout, const GeometryNode* parent)
    : m_bounds(bounds),
      m_buckets(layout.range(bounds)),
      m_layout_width(layout.buckets().width()),
      m_layout_x0(layout.buckets().x0),
      m_layout_y0(layout.buckets().y0),
      m_knot_boxes(primitive->knot_boxes()),
      m_primitive(std::move(primitive)) {
    if (parent) m_buckets = m_buckets.intersect(parent->m_buckets);
    if (m_buckets.empty()) {
        m_buckets = {};
        return;
    }
    m_released.assign(static_cast<std::size_t>(m_buckets.width()) * m_buckets.height(), false);
    m_left = m_released.size();
    if (!parent) return;
    // Buckets that were done with the parent before it was split will never come here.
    for (int y = m_buckets.y0; y < m_buckets.y1; ++y)
        for (int x = m_buckets.x0; x < m_buckets.x1; ++x) {
            const int bucket = layout.index(x, y);
            if (parent->m_released[parent->bit(bucket)]) {
                m_released[bit(bucket)] = true;
                --m_left;
            }
        }
}

std::size_t GeometryNode::bit(int bucket) const {
    const int x = m_layout_x0 + bucket % m_layout_width, y = m_layout_y0 + bucket / m_layout_width;
    return static_cast<std::size_t>((y - m_buckets.y0) * m_buckets.width() + x - m_buckets.x0);
}

GeometryNode::Content GeometryNode::expand(const BucketLayout& layout, Statistics& statistics) {
    const std::lock_guard lock(m_mutex);
    if (!m_expanded) {
        if (m_primitive->diceable()) {
            m_content.grid = dice_counted(*m_primitive, statistics);
        } else {
            for (auto& child : split_counted(*m_primitive, statistics)) {
                const RasterBounds bounds = child->bounds();
                auto node = std::make_shared<GeometryNode>(std::move(child), bounds, layout, this);
                if (node->m_left > 0) m_content.children.push_back(std::move(node));
            }
        }
        m_primitive.reset();
        m_expanded = true;
    }
    return m_content;
}

void GeometryNode::release(int bucket) {
    Content freed;  // destroyed outside the lock
    std::vector<std::shared_ptr<GeometryNode>> children;
    {
        const std::lock_guard lock(m_mutex);
        const int x = m_layout_x0 + bucket % m_layout_width;
        const int y = m_layout_y0 + bucket / m_layout_width;
        if (x < m_buckets.x0 || x >= m_buckets.x1 || y < m_buckets.y0 || y >= m_buckets.y1) return;
        if (m_released[bit(bucket)]) return;
        m_released[bit(bucket)] = true;
        children = m_content.children;
        if (--m_left == 0) {
            freed = std::move(m_content);
            m_content = {};
            m_primitive.reset();
            m_expanded = true;
        }
    }
    for (const auto& child : children) child->release(bucket);
}

}  // namespace granita
