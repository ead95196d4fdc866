// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/geometry_node.h"

#include <algorithm>
#include <utility>

#include "base/stage_timer.h"

namespace granita {
namespace {

/// What nobody reads once radiance is there and settled.
void drop_shading_state(Grid& grid) {
    for (std::vector<Vec3f>* values : {&grid.p, &grid.normal, &grid.geometric_normal, &grid.dp_du,
                                       &grid.dp_dv, &grid.ray_offset})
        std::vector<Vec3f>().swap(*values);
    std::vector<Vec3f>().swap(grid.rise);
    std::vector<CornerBlend>().swap(grid.normal_corners);
    grid.knot_normals.reset();
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

std::uint64_t SharedGrid::bytes() const {
    return m_grid->bytes() + (m_grid->told ? m_grid->told->bytes() : 0);
}

void SharedGrid::count_bytes() {
    m_statistics.remove_grid_bytes(m_bytes);
    m_bytes = bytes();
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

const SharedGrid::Place& SharedGrid::place(Statistics& statistics) {
    m_has_place.call([&] {
        ensure_shading_state(statistics);
        for (std::size_t i = 0; i < m_grid->point_count(); ++i) {
            m_place.box.add(m_grid->shading_p()[i]);
            m_place.step = std::max(
                {m_place.step, glm::length(m_grid->dp_du[i]), glm::length(m_grid->dp_dv[i])});
        }
    });
    return m_place;
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

void SharedGrid::ensure_told(const ShadingSystem& shading, Statistics& statistics) {
    m_told.call([&] {
        if (shading.opacity_varies(m_grid->material)) ensure_opacity(shading, statistics);
        if (!shading.leaves_to_samples(*m_grid)) ensure_shading_state(statistics);
        const StageTimer timer(statistics, Stage::Shade);
        const Stopwatch watch;
        m_begun = shading.begin_radiance(*m_grid);
        // Grids around may ask once the state is dropped of which it is told.
        if (shading.shares_light() && !shading.leaves_to_samples(*m_grid)) place(statistics);
        if (m_grid->told) count_bytes();
        statistics.objects().add_seconds(m_grid->instance, watch.seconds());
    });
}

void SharedGrid::ensure_radiance(const ShadingSystem& shading, Statistics& statistics,
                                 const std::function<HiddenGrids()>& around, bool stays) {
    m_radiance.call([&] {
        ensure_told(shading, statistics);
        ToldLights told;
        if (m_grid->told)
            for (const auto& other : around()) {
                if (!place(statistics).is_within(m_grid->told->reach(), other->place(statistics)))
                    continue;
                other->ensure_told(shading, statistics);
                if (other->grid().told) told.push_back(other->grid().told);
            }
        const StageTimer timer(statistics, Stage::Shade);
        const Stopwatch watch;
        const bool is_shaded = m_grid->light_fraction > 0.0f && m_grid->told_around == told;
        // What an end that is cut short leaves of it is no beginning: who tries again begins anew.
        auto begun = std::exchange(m_begun, nullptr);
        if (!begun && !is_shaded && !shading.leaves_to_samples(*m_grid)) {
            drop_radiance();
            begun = shading.begin_radiance(*m_grid, true);
        }
        if (begun) shading.end_radiance(*m_grid, *begun, told);
        m_grid->told_around = stays ? std::move(told) : ToldLights();
        statistics.objects().add_seconds(m_grid->instance, watch.seconds());
        const bool is_read = !m_grid->unsettled.empty() && !shading.leaves_to_samples(*m_grid);
        if (!stays && !is_read) drop_shading_state(*m_grid);
        count_bytes();
    });
}

void SharedGrid::drop_radiance() {
    m_grid->light_fraction = 0.0f;
    m_grid->sharpness = 0.0f;
    m_grid->broken_radiance = false;
    m_grid->radiance.clear();
    m_grid->found = {};
    m_grid->found_alone.reset();
    m_grid->told_around.clear();
    m_grid->unsettled.clear();
    m_grid->channels.clear();
}

void SharedGrid::forget_radiance() {
    m_told.reset();
    m_radiance.reset();
    m_begun.reset();
    drop_radiance();
    m_grid->told.reset();
    m_grid->told_share = 0.0f;
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

GeometryNode::GeometryNode(std::unique_ptr<Primitive> primitive, const Rect& buckets)
    : m_buckets(buckets),
      m_knot_boxes(primitive->knot_boxes()),
      m_primitive(std::move(primitive)) {}

const GeometryNode::Content& GeometryNode::expand(const BucketLayout& layout, BucketEnds& ends,
                                                  Statistics& statistics) {
    if (m_expanded.load(std::memory_order_acquire)) return m_content;
    const std::lock_guard lock(m_mutex);
    if (m_expanded.load(std::memory_order_relaxed)) return m_content;
    Content made;
    if (m_primitive->diceable()) {
        made.grid = dice_counted(*m_primitive, statistics);
    } else {
        for (auto& child : split_counted(*m_primitive, statistics)) {
            const RasterBounds bounds = child->bounds();
            const Rect buckets = layout.range(bounds).intersect(m_buckets);
            if (buckets.empty() || ends.all_ended(buckets)) continue;
            made.children.push_back(
                {buckets, bounds, std::make_shared<GeometryNode>(std::move(child), buckets)});
        }
    }
    m_content = std::move(made);
    m_primitive.reset();
    m_expanded.store(true, std::memory_order_release);
    ends.keep(shared_from_this());
    return m_content;
}

}  // namespace granita
