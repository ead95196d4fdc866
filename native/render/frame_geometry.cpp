// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/frame_geometry.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/stage_timer.h"
#include "dice/raster_bound.h"

namespace granita {
namespace {

/// Things that are looked at in a piece of a loop.
constexpr std::size_t kGrain = 256;

bool is_single(const Rect& range) {
    return range.width() == 1 && range.height() == 1;
}

/// Whether the camera sees surfaces of it.
bool is_drawn(const Scene& scene, const Instance& instance) {
    const auto draws = [&](std::int32_t material) {
        return material < 0 ||
               !scene.materials[static_cast<std::size_t>(material)].graph.has_only_volume();
    };
    return instance.visible_camera &&
           (instance.materials.empty() || std::ranges::any_of(instance.materials, draws));
}

}  // namespace

FrameGeometry::FrameGeometry(const View& view, const BucketLayout& layout, Report& report,
                             Report& said, bool revisited)
    : m_view(view),
      m_layout(layout),
      m_report(report),
      m_said(said),
      m_revisited(revisited),
      m_states(view.scene->instances.size()),
      m_ends(layout) {
    const StageTimer timer(*view.statistics, Stage::Open);
    std::vector<Rect> ranges(m_states.size());
    parallel_for(m_states.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (!is_drawn(*view.scene, view.scene->instances[i])) continue;
            State& state = m_states[i];
            std::vector<Bounds3f> boxes = instance_boxes(view, i);
            state.bounds = raster_bound_of(view.projection, boxes);
            state.buckets = ranges[i] = layout.range(state.bounds);
            state.buckets_left = ranges[i].width() * ranges[i].height();
            if (!ranges[i].empty() && boxes.size() > 1) state.boxes = std::move(boxes);
        }
    });
    m_instances = HierarchicalGrid(layout.buckets(), ranges);
}

FrameGeometry::Opened* FrameGeometry::open(std::uint32_t instance) {
    State& state = m_states[instance];
    state.once.call([&] {
        state.opened = make_opened(instance);
        state.is_open = true;
    });
    return state.opened.get();
}

std::unique_ptr<FrameGeometry::Opened> FrameGeometry::make_opened(std::uint32_t instance) const {
    const StageTimer timer(*m_view.statistics, Stage::Open);
    auto opened = std::make_unique<Opened>();
    const auto shared = static_cast<std::size_t>(m_view.scene->instances[instance].geometry);
    m_view.geometries->say(*m_view.scene, shared, m_report);
    opened->geometry = open_instance(m_view, instance, m_said);
    const Rect& area = m_states[instance].buckets;
    const std::size_t count = opened->geometry->primitive_count();
    opened->bounds.resize(count);
    opened->nodes.resize(count);
    std::vector<Rect> ranges(count);
    parallel_for(count, kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t face = begin; face < end; ++face) {
            opened->bounds[face] = opened->geometry->bounds(face);
            ranges[face] = m_layout.range(opened->bounds[face]).intersect(area);
        }
    });
    opened->faces = HierarchicalGrid(area, ranges);
    return opened;
}

GeometryNode* FrameGeometry::node(Opened& opened, std::uint32_t primitive) {
    const Rect buckets = m_layout.range(opened.bounds[primitive]);
    if (!m_revisited && is_single(buckets)) return nullptr;
    const std::lock_guard lock(opened.mutex);
    auto& node = opened.nodes[primitive];
    if (!node) {
        m_view.statistics->add(Counter::PrimitivesOpened);
        node = std::make_shared<GeometryNode>(opened.geometry->primitive(primitive), buckets);
    }
    return node.get();
}

void FrameGeometry::release(int bucket) {
    m_ends.end(bucket);
    for_each_instance(bucket, [&](std::uint32_t instance) {
        State& state = m_states[instance];
        if (--state.buckets_left == 0) state.opened.reset();
    });
}

}  // namespace granita
