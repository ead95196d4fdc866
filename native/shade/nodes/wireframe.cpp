// SPDX-License-Identifier: GPL-3.0-or-later
// Wireframe: 1 along the edges of the triangles that are rendered, half of Size on either side.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "math/normalize_or.h"
#include "shade/nodes/nodes.h"
#include "shade/programs/shading_camera.h"

namespace granita {
namespace {

/// A corner of the patch, from the point, world axes.
VectorSource to_corner(NodeBuilder& b, AttributeSource corner) {
    const VectorSource in_object = b.attribute({corner, "", 3});
    const VectorSource out = b.new_source<Vec3f>();
    b.add_step(
        [=](Run& run) {
            const auto offset = run.read(in_object);
            Vec3f* result = run.write(out);
            for (std::size_t i = 0; i < run.count(); ++i)
                result[i] = run.input().axes_at(i).world_from_object * offset[i];
        },
        {in_object.slot}, {out.slot});
    return out;
}

/// Squared, of the origin to the line through two places; infinite where they are one.
float distance2_to_line(const Vec3f& a, const Vec3f& b) {
    const Vec3f edge = b - a, area = glm::cross(edge, a);
    const float length2 = glm::dot(edge, edge);
    return length2 > 0.0f ? glm::dot(area, area) / length2 : std::numeric_limits<float>::infinity();
}

/// Of the origin to the nearest edge of a triangle, or of that one of two which it is in.
float distance2_to_edges(const std::array<Vec3f, 4>& c) {
    const Vec3f diagonal = c[2] - c[0];
    const Vec3f normal = glm::cross(c[1] - c[0], diagonal) + glm::cross(diagonal, c[3] - c[0]);
    const bool in_first = c[2] == c[3] || glm::dot(glm::cross(diagonal, -c[0]), normal) <= 0.0f;
    const Vec3f& other = in_first ? c[1] : c[3];
    return std::min({distance2_to_line(c[0], other), distance2_to_line(other, c[2]),
                     distance2_to_line(c[2], c[0])});
}

/// Of the two triangles' area, what is nearer than `half` to their edges: what lies within is a
/// triangle like each, whose inscribed circle is smaller by that.
float covered_part(const std::array<Vec3f, 4>& c, float half) {
    float area = 0.0f, left = 0.0f;
    for (const auto& [a, b] : {std::pair(c[1], c[2]), std::pair(c[2], c[3])}) {
        const float twice = glm::length(glm::cross(a - c[0], b - c[0]));
        if (!(twice > 0.0f)) continue;
        const float around = glm::distance(c[0], a) + glm::distance(a, b) + glm::distance(b, c[0]);
        const float side = std::max(1.0f - half * around / twice, 0.0f);
        area += twice;
        left += twice * side * side;
    }
    return area > 0.0f ? 1.0f - left / area : 0.0f;
}

/// 1 where points stand for whole faces, which lines cover in part.
FloatSource whole_faces(NodeBuilder& b) {
    return b.geometry<float>(
        [](const ShadingInput& in, std::size_t) { return in.points->whole_faces ? 1.0f : 0.0f; });
}

/// What a pixel covers where the camera sees a surface, as Cycles reckons: a square about the
/// normal, its sides seen from the camera.
class SeenPixel {
  public:
    explicit SeenPixel(const Scene& scene)
        : m_camera_from_world(glm::transpose(Mat3f(ShadingCamera(scene).world_from_camera))),
          m_perspective(scene.camera.projection.perspective),
          m_step(1.0 / scene.camera.projection.scale) {}

    /// `way`: from the camera, unit; `distance`: along all of it.
    float width(const Vec3f& view, const Vec3f& normal, const Vec3f& way, float distance) const {
        const Vec3f u = glm::normalize(
            normal.x != normal.y || normal.x != normal.z
                ? glm::cross(Vec3f(1.0f), normal)
                : Vec3f(normal.z - normal.y, normal.x + normal.z, -normal.y - normal.x));
        const Vec3f v = glm::cross(normal, u);
        const auto seen = [&](const Vec3f& side) {
            return glm::length(side - glm::dot(side, view) * view);
        };
        return 0.5f * (seen(u) + seen(v)) * side(way, distance);
    }

  private:
    float side(const Vec3f& world_way, float distance) const {
        if (!m_perspective) return 0.5f * (m_step.x + m_step.y);
        const Vec3f way = m_camera_from_world * world_way;
        const auto turn = [&](int axis) {
            return m_step[axis] * std::abs(way.z) *
                   std::sqrt(std::max(1.0f - way[axis] * way[axis], 0.0f));
        };
        return 0.5f * (turn(0) + turn(1)) * distance;
    }

    Mat3f m_camera_from_world;
    bool m_perspective;
    Vec2f m_step;  ///< of a pixel: slope, or metres
};

FloatSource pixel_width(NodeBuilder& b) {
    return b.geometry<float>([pixel = SeenPixel(b.scene())](const ShadingInput& in, std::size_t i) {
        const ShadingPoints& points = *in.points;
        const Vec3f &view = points.view[i], &normal = points.geometric_normal[i];
        if (points.ray_lengths.empty())
            return pixel.width(view, normal, -view, glm::length(points.p[i]));
        // As in a mirror: on from where the ray started, which the camera sees.
        const float length = points.ray_lengths[i];
        const Vec3f start = points.p[i] + length * view;
        return pixel.width(view, normal, normalize_or(start, -view), glm::length(start) + length);
    });
}

/// Whether anything whose material the node is part of is one.
bool is_on_subdivision_surface(const NodeBuilder& b) {
    const Scene& scene = b.scene();
    const auto holds_node = [&](std::int32_t index) {
        if (index < 0) return false;
        const std::vector<Node>& nodes =
            scene.materials[static_cast<std::size_t>(index)].graph.nodes;
        return b.index() < nodes.size() && &nodes[b.index()] == &b.node();
    };
    return std::ranges::any_of(scene.instances, [&](const Instance& instance) {
        return scene.geometry_of(instance).is_subdivision &&
               std::ranges::any_of(instance.materials, holds_node);
    });
}

}  // namespace

void build_wireframe(NodeBuilder& b) {
    if (b.is_world()) {
        b.output("Fac", FloatSource{-1, 0.0f});
        return;
    }
    if (is_on_subdivision_surface(b)) b.warn("on subdivision surfaces it shows edges of the cage");
    const FloatSource size = b.number("Size", 0.01f);
    const FloatSource unit = b.flag("use_pixel_size") ? pixel_width(b) : FloatSource{-1, 1.0f};
    b.output("Fac",
             b.map<float>(
                 [](const Vec3f& c0, const Vec3f& c1, const Vec3f& c2, const Vec3f& c3, float size_,
                    float unit_, float whole) {
                     const float half = std::abs(0.5f * size_ * unit_);
                     if (whole != 0.0f) return covered_part({c0, c1, c2, c3}, half);
                     return distance2_to_edges({c0, c1, c2, c3}) < half * half ? 1.0f : 0.0f;
                 },
                 to_corner(b, AttributeSource::ToCorner0), to_corner(b, AttributeSource::ToCorner1),
                 to_corner(b, AttributeSource::ToCorner2), to_corner(b, AttributeSource::ToCorner3),
                 size, unit, whole_faces(b)));
}

}  // namespace granita
