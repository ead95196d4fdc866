// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bounces/hit_points.h"

#include <algorithm>

#include "geometry/curve_section.h"
#include "geometry/smooth_rise.h"
#include "geometry/surface_frames.h"
#include "math/normalize_or.h"

namespace granita {

namespace {

/// What was scattered in media starts as a line, in which no bump would show.
float beam_width(const MetPath& met) {
    constexpr float kLeast = 1e-4f;  // of the way
    return std::max(met.width, kLeast * met.hit->distance);
}

}  // namespace

void HitPoints::resize(std::size_t n, const std::vector<AttributeRequest>& requests) {
    ShadingPoints& p = m_points;
    p = {};
    p.count = n;
    for (auto* values : {&p.p, &p.normal, &p.geometric_normal, &p.view}) values->resize(n);
    p.dp_du.assign(n, Vec3f(0.0f));
    p.dp_dv.assign(n, Vec3f(0.0f));
    for (auto* values : {&p.times, &p.ray_lengths, &p.seen_from}) values->resize(n);
    p.backfacing.resize(n);
    p.places.resize(n);
    m_attributes.resize(requests, n);
}

void HitPoints::fill_mesh(std::size_t i, const MetPath& met, bool displaced,
                          const std::vector<AttributeRequest>& requests) {
    static thread_local SurfaceFrames surface;
    const float width = beam_width(met);
    const RayHit& hit = *met.hit;
    const RayFrame& frame = *met.frame;
    const std::span<const Vec2d> uv(&hit.uv, 1);
    find_frames(*hit.geometry, *hit.patch, uv, hit.geometry->at(met.time), surface);
    const float side = m_points.backfacing[i] ? -1.0f : 1.0f;
    if (!displaced && !fill_smooth(i, met))
        m_points.normal[i] = side * Vec3f(normalize_or(frame.world_from_normal * surface.normal[0],
                                                       Vec3d(hit.normal)));
    const auto step = [&](const Vec3d& derivative, Vec3f& out) {
        const Vec3f along = frame.world_from_object * Vec3f(derivative);
        const float length = glm::length(along);
        const float steps = length > width ? width / length : 1.0f;  // no further than the patch
        out = along * steps;
        return steps;
    };
    const float step_u = step(surface.su[0], m_points.dp_du[i]);
    const float step_v = step(surface.sv[0], m_points.dp_dv[i]);
    m_attributes.fill(i, hit, requests, Vec2f(step_u, step_v));
}

/// As FrameFace and OpenedMesh::rise(), in the world, where corners' normals are blended: uneven
/// scale bends them.
bool HitPoints::fill_smooth(std::size_t i, const MetPath& met) {
    SmoothFace face;
    const SharedGeometry& geometry = *met.hit->geometry;
    if (!find_smooth_face(geometry, *met.hit->patch, geometry.at(met.time), face)) return false;
    for (int k = 0; k < 4; ++k) {
        face.p[k] = Mat3d(met.frame->world_from_object) * face.p[k];
        face.normal[k] =
            normalize_or(met.frame->world_from_normal * face.normal[k], Vec3d(met.hit->normal));
    }
    const CornerWeights weights(met.hit->patch->kind, met.hit->uv);
    m_points.rise[i] = smooth_rise(face.p, face.normal, weights, !m_points.backfacing[i]);
    const Vec3d normal = blend(face.normal, weights.w);
    const float side = m_points.backfacing[i] ? -1.0f : 1.0f;
    m_points.normal[i] = side * Vec3f(normalize_or(normal, Vec3d(met.hit->normal)));
    return true;
}

/// As CurveBatch::shade_row(), facing the ray.
void HitPoints::fill_ribbon(std::size_t i, const MetPath& met) {
    const RayHit& hit = *met.hit;
    const Mat3d world_from_object(met.frame->world_from_object);
    const Vec3d direction(hit.direction);
    const CurveSection at = curve_section(*hit.elements, hit.place, met.time);
    const Vec3d flat = normalize_or(
        glm::cross(Mat3d(met.frame->object_from_world) * direction, at.along), Vec3d(0.0));
    const Vec3d edge = world_from_object * (flat * at.radius);
    const Vec3d along = world_from_object * at.along;
    const double radius = glm::length(edge), length = glm::length(along);
    if (!(radius > 0.0 && length > 0.0)) return;  // seen along, or nothing: as it is
    const Vec3d side = edge / radius;
    Vec3d front = normalize_or(glm::cross(along, side), -direction);
    if (glm::dot(front, direction) > 0.0) front = -front;
    const double sine = std::clamp(hit.uv.y, -1.0, 1.0);
    const double cosine = std::sqrt(1.0 - sine * sine);
    // Uneven scale makes an ellipse of the tube (RibbonRow::side, rise).
    const Vec3d through = glm::cross(glm::normalize(at.along), flat);
    const Mat3d& world_from_normal = met.frame->world_from_normal;
    const Vec3d aside = world_from_normal * flat / glm::length(world_from_normal * through);
    m_points.normal[i] = Vec3f(normalize_or(aside * sine + front * cosine, front));
    m_points.geometric_normal[i] = Vec3f(front);
    Vec3d rise = world_from_object * (through * at.radius);
    if (glm::dot(rise, front) < 0.0) rise = -rise;
    m_points.ray_offset[i] = Vec3f(rise * cosine);
    const double width = beam_width(met);
    m_points.dp_du[i] = Vec3f(along * std::min(width / length, 1.0));
    m_points.dp_dv[i] = Vec3f(side * std::min(width, 2.0 * radius));
}

void HitPoints::fill(std::span<const MetPath> met, const std::vector<AttributeRequest>& requests,
                     std::uint32_t depth) {
    resize(met.size(), requests);
    const RayHit& first = *met.front().hit;
    const Instance& instance = m_scene.instances[first.instance];
    m_points.depth = depth;
    m_points.share = 1.0f / static_cast<float>(std::max(m_scene.options.light_samples, 1));
    if (!first.elements) m_points.faces.resize(met.size());
    m_points.round = first.elements && first.elements->data().kind == GeometryKind::Curves;
    if (m_points.round) m_points.ray_offset.assign(met.size(), Vec3f(0.0f));
    const bool displaced = m_rays.is_displaced({instance.key});
    m_points.terminator_offset = instance.terminator_offset;
    (m_camera.perspective ? m_points.pixel_slope : m_points.pixel_width) = m_camera.pixel;
    if (!first.elements && !displaced) m_points.rise.assign(met.size(), Vec3f(0.0f));
    m_input = {};
    m_input.points = &m_points;
    m_input.attributes = &m_attributes.grid();
    m_input.instance = &instance;
    m_input.rays = &m_rays;
    m_input.key = {instance.key};
    m_input.progress = m_progress;
    const bool still = first.frame != nullptr;
    if (still) {
        m_input.axes.world_from_object = first.frame->world_from_object;
        m_input.axes.object_from_world = first.frame->object_from_world;
    } else {
        m_input.axes =
            ObjectAxes(matrix_at(instance.world_from_object, m_scene.options.frame_time));
    }
    for (std::size_t i = 0; i < met.size(); ++i) {
        const RayHit& hit = *met[i].hit;
        const bool back = glm::dot(hit.normal, hit.direction) > 0.0f;
        m_points.p[i] = hit.p;
        m_points.normal[i] = m_points.geometric_normal[i] = back ? -hit.normal : hit.normal;
        m_points.view[i] = -hit.direction;
        m_points.backfacing[i] = back;
        m_points.times[i] = met[i].time;
        m_points.places[i] = met[i].place;
        m_points.ray_lengths[i] = met[i].length;
        m_points.seen_from[i] = met[i].seen;
        if (const BouncedPath* path = met[i].path) m_points.counts.push_back(path->counts());
        if (!still) {
            ObjectAxes& axes = m_input.axes_at_times.emplace_back();
            axes.world_from_object = met[i].frame->world_from_object;
            axes.object_from_world = met[i].frame->object_from_world;
        }
        if (hit.elements) {
            m_attributes.fill(i, hit, requests);
            if (m_points.round) fill_ribbon(i, met[i]);
            continue;
        }
        m_points.faces[i] = hit.patch->face;
        fill_mesh(i, met[i], displaced, requests);
    }
}

}  // namespace granita
