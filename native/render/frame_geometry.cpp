// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/frame_geometry.h"

#include "dice/raster_bound.h"

namespace granita {
namespace {

template <class Visit>
void for_each_bucket(const Rect& range, const BucketLayout& layout, Visit visit) {
    for (int y = range.y0; y < range.y1; ++y)
        for (int x = range.x0; x < range.x1; ++x) visit(layout.index(x, y));
}

bool is_single(const Rect& range) {
    return range.width() == 1 && range.height() == 1;
}

}  // namespace

FrameGeometry::FrameGeometry(const View& view, const BucketLayout& layout, Report& report)
    : m_view(view),
      m_layout(layout),
      m_report(report),
      m_states(view.scene->instances.size()),
      m_buckets(static_cast<std::size_t>(layout.count())),
      m_finished(static_cast<std::size_t>(layout.count())) {
    for (std::uint32_t i = 0; i < m_states.size(); ++i) {
        if (!view.scene->instances[i].visible_camera) continue;
        std::vector<Bounds3f> boxes = instance_boxes(view, i);
        m_states[i].bounds = raster_bound_of(view.projection, boxes);
        const Rect range = layout.range(m_states[i].bounds);
        if (range.empty()) continue;
        if (boxes.size() > 1) m_states[i].boxes = std::move(boxes);
        m_states[i].buckets_left = range.width() * range.height();
        for_each_bucket(range, layout, [&](int bucket) { m_buckets[bucket].push_back(i); });
    }
}

std::shared_ptr<FrameGeometry::Opened> FrameGeometry::open(std::uint32_t instance) {
    State& state = m_states[instance];
    const std::lock_guard lock(state.mutex);
    if (!state.opened) state.opened = make_opened(instance);
    return state.opened;
}

std::shared_ptr<FrameGeometry::Opened> FrameGeometry::make_opened(std::uint32_t instance) {
    const StageTimer timer(*m_view.statistics, Stage::Open);
    auto opened = std::make_shared<Opened>();
    opened->geometry = open_instance(m_view, instance, m_report);
    opened->buckets = m_layout.range(m_states[instance].bounds);
    const std::size_t count = opened->geometry->primitive_count();
    const Rect& area = opened->buckets;
    opened->first.assign(static_cast<std::size_t>(area.width() * area.height()) + 1, 0);
    opened->bounds.resize(count);
    opened->nodes.resize(count);

    // Counting sort of faces by bucket; `cell` is a bucket's place in the instance's own rectangle.
    const auto for_each_cell = [&](std::size_t face, auto visit) {
        const Rect range = m_layout.range(opened->bounds[face]).intersect(area);
        for (int y = range.y0; y < range.y1; ++y)
            for (int x = range.x0; x < range.x1; ++x)
                visit(static_cast<std::size_t>((y - area.y0) * area.width() + x - area.x0));
    };
    for (std::size_t face = 0; face < count; ++face) {
        opened->bounds[face] = opened->geometry->bounds(face);
        for_each_cell(face, [&](std::size_t cell) { ++opened->first[cell + 1]; });
    }
    for (std::size_t cell = 1; cell < opened->first.size(); ++cell)
        opened->first[cell] += opened->first[cell - 1];
    opened->faces.resize(opened->first.back());
    std::vector<std::uint32_t> next(opened->first.begin(), opened->first.end() - 1);
    for (std::size_t face = 0; face < count; ++face)
        for_each_cell(face, [&](std::size_t cell) {
            opened->faces[next[cell]++] = static_cast<std::uint32_t>(face);
        });
    return opened;
}

std::span<const std::uint32_t> FrameGeometry::faces(const Opened& opened, int bucket) const {
    const Rect& all = m_layout.buckets();
    const int x = all.x0 + bucket % all.width() - opened.buckets.x0;
    const int y = all.y0 + bucket / all.width() - opened.buckets.y0;
    const auto cell = static_cast<std::size_t>(y * opened.buckets.width() + x);
    return {opened.faces.data() + opened.first[cell], opened.first[cell + 1] - opened.first[cell]};
}

std::shared_ptr<GeometryNode> FrameGeometry::node(Opened& opened, std::uint32_t primitive) {
    if (is_single(m_layout.range(opened.bounds[primitive]))) return nullptr;
    const std::lock_guard lock(opened.mutex);
    auto& node = opened.nodes[primitive];
    if (!node) {
        m_view.statistics->add(Counter::PrimitivesOpened);
        node = std::make_shared<GeometryNode>(opened.geometry->primitive(primitive),
                                              opened.bounds[primitive], m_layout, nullptr);
        // Buckets that finished before it was made will never ask for it.
        for_each_bucket(m_layout.range(opened.bounds[primitive]), m_layout, [&](int bucket) {
            if (m_finished[bucket].load()) node->release(bucket);
        });
    }
    return node;
}

void FrameGeometry::release(int bucket) {
    // First the flag, then the nodes that exist: a node made in between starts with the flag (see
    // node()).
    m_finished[bucket].store(true);
    for (const std::uint32_t instance : m_buckets[bucket]) {
        State& state = m_states[instance];
        std::shared_ptr<Opened> opened;
        {
            const std::lock_guard lock(state.mutex);
            opened = state.opened;
        }
        if (opened) {
            std::vector<std::shared_ptr<GeometryNode>> nodes;
            {
                const std::lock_guard lock(opened->mutex);
                for (const std::uint32_t face : faces(*opened, bucket))
                    if (opened->nodes[face]) nodes.push_back(opened->nodes[face]);
            }
            for (const auto& node : nodes) node->release(bucket);
        }
        if (--state.buckets_left == 0) {
            const std::lock_guard lock(state.mutex);
            state.opened.reset();
        }
    }
}

}  // namespace granita
