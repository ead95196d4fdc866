// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/open_instance.h"

#include <algorithm>

#include "base/crash_report.h"
#include "dice/knots.h"
#include "dice/opened_elements.h"
#include "dice/opened_polygons.h"
#include "dice/opened_subdivision.h"
#include "dice/raster_bound.h"
#include "geometry/geometry_cache.h"
#include "geometry/shared_elements.h"
#include "geometry/shared_geometry.h"
#include "math/largest_stretch.h"

namespace granita {
namespace {

/// A box that holds a geometry's points at a time between its knots.
Bounds3f box_at(const std::vector<Bounds3f>& boxes, const KnotTime& t) {
    Bounds3f box = boxes[t.knot];
    if (t.fraction > 0.0) box.add(boxes[t.knot + 1]);
    return box;
}

void add_transformed(Bounds3f& sum, const Mat4d& m, const Bounds3f& box) {
    if (box.empty()) return;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3d p(corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                      corner & 4 ? box.hi.z : box.lo.z);
        sum.add(Vec3f(transform_point(m, p)));
    }
}

/// Of a radius: how far a curve's may swing beyond its points' (corners of a small point's outline
/// reach a little further than 1.25).
constexpr float kWidest = 1.26f;

/// What is displaced is opened as a whole, and what deforms and is carried at a time: between knots
/// rays would meet it elsewhere than samples do.
MeshPart opened_part(const View& view, std::size_t instance,
                     const std::shared_ptr<const SharedGeometry>& shared, const Knots& knots) {
    const bool displaced = view.displacement && view.displacement->displaces(instance);
    const bool goes_alike = shared->is_static() || is_static(knots.camera_from_object);
    if (view.sampled_faces && goes_alike && !displaced)
        if (auto met = view.sampled_faces->of(instance, shared, knots))
            return MeshPart(*shared, std::move(*met));
    return MeshPart(*shared);
}

class Nothing final : public OpenedInstance {
  public:
    std::size_t primitive_count() const override { return 0; }
    RasterBounds bounds(std::size_t) const override { return {}; }
    std::unique_ptr<Primitive> primitive(std::size_t) const override { return nullptr; }
    std::uint64_t bytes() const override { return sizeof(*this); }
};

}  // namespace

std::vector<Bounds3f> instance_boxes(const View& view, std::size_t index) {
    const Instance& instance = view.scene->instances[index];
    const std::size_t geometry = static_cast<std::size_t>(instance.geometry);
    const GeometryData& data = view.scene->geometries[geometry];
    if (instance.lifespan.is_empty()) return {};
    const auto boxes = view.geometries->boxes(*view.scene, geometry);
    const Knots knots = combine_knots(*view.scene, instance, data, data.knots == 1);
    if (!knots.finite) return {};
    const float radius = view.geometries->largest_radius(*view.scene, geometry);
    const bool displaced = view.displacement && view.displacement->displaces(index);
    const float moved = displaced ? view.displacement->bound(index) : 0.0f;
    std::vector<Bounds3f> out(static_cast<std::size_t>(knots.count));
    for (int k = 0; k < knots.count; ++k) {
        const Mat4d& m = knots.camera_from_object[static_cast<std::size_t>(k)];
        Bounds3f& box = out[static_cast<std::size_t>(k)];
        add_transformed(box, m, box_at(*boxes, knot_time(k, knots.count - 1, data.knots)));
        if (box.empty()) continue;
        if (radius > 0.0f) box.grow(kWidest * radius * static_cast<float>(uniform_scale(m)));
        box.grow_relative(4e-6f);
        box.grow(moved * static_cast<float>(largest_stretch(m)));
    }
    return out;
}

RasterBounds instance_bounds(const View& view, std::size_t index) {
    return raster_bound_of(view.projection, instance_boxes(view, index));
}

std::shared_ptr<const OpenedInstance> open_instance(const View& view, std::size_t index,
                                                    Report& report) {
    const Instance& instance = view.scene->instances[index];
    const CrashScope scope("opens", instance.name);
    const std::size_t geometry = static_cast<std::size_t>(instance.geometry);
    const GeometryData& data = view.scene->geometries[geometry];
    const bool is_mesh = data.kind == GeometryKind::Mesh;
    std::shared_ptr<const SharedGeometry> shared;
    std::shared_ptr<const SharedElements> elements;
    if (is_mesh)
        shared = view.geometries->shared(*view.scene, geometry, report);
    else
        elements = view.geometries->elements(*view.scene, geometry, report);
    Knots knots = combine_knots(*view.scene, instance, data,
                                is_mesh ? shared->is_static() : elements->is_static());
    if (!knots.finite) {
        report.warn(instance.name, "has a transform that is not finite and is left out");
        return std::make_shared<Nothing>();
    }
    if (knots.capped)
        report.warn(instance.name,
                    "its motion knots and its camera's have too few in common: the motion is "
                    "approximated by " +
                        std::to_string(kMaxKnots - 1) + " segments");
    if (!is_mesh)
        return std::make_shared<OpenedElements>(view, index, std::move(elements), std::move(knots),
                                                report);
    if (shared->patches().empty()) return std::make_shared<Nothing>();
    if (shared->subdivision())
        return std::make_shared<OpenedSubdivision>(view, index, std::move(shared), std::move(knots),
                                                   report);
    MeshPart part = opened_part(view, index, shared, knots);
    return std::make_shared<OpenedPolygons>(view, index, std::move(shared), std::move(part),
                                            std::move(knots), report);
}

}  // namespace granita
