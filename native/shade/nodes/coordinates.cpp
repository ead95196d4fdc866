// SPDX-License-Identifier: GPL-3.0-or-later
// Where a point is: UV Map, Texture Coordinate, Geometry and Camera Data.
#include "shade/nodes/coordinates.h"

#include <algorithm>
#include <cmath>

#include "geometry/random_per_island.h"
#include "math/normalize_or.h"
#include "shade/nodes/anisotropy.h"
#include "shade/nodes/instance_value.h"
#include "shade/nodes/lamp_coordinates.h"
#include "shade/nodes/nodes.h"
#include "shade/programs/shading_camera.h"

namespace granita {

namespace {

/// The camera of the frame as a lambda may hold it.
struct FrameCamera {
    Mat3f camera_from_world;
    Vec3f position;
    Projection projection;
    Vec2f resolution;

    explicit FrameCamera(const Scene& scene)
        : projection(scene.camera.projection),
          resolution(static_cast<float>(scene.options.width),
                     static_cast<float>(scene.options.height)) {
        const ShadingCamera camera(scene);
        camera_from_world = glm::transpose(Mat3f(camera.world_from_camera));
        position = Vec3f(camera.world_from_camera[3]);
    }

    /// Place in the frame, [0,1]^2 from its lower left corner.
    Vec3f window(const Vec3f& p_camera) const {
        const Vec3f h = projection.homogeneous(p_camera, Vec2d(0.0));
        return {h.x / h.z / resolution.x, h.y / h.z / resolution.y, 0.0f};
    }
};

VectorSource geometric_normal(NodeBuilder& b) {
    return b.geometry<Vec3f>(
        [](const ShadingInput& in, std::size_t i) { return in.points->geometric_normal[i]; });
}

/// Of a world.  Parallel rays of the camera all see it in one direction, and have places of their
/// own; to others a direction is a place beside the world's origin, as in Cycles.
VectorSource parallel_window(NodeBuilder& b, const FrameCamera& camera) {
    return b.geometry<Vec3f>([camera](const ShadingInput& in, std::size_t i) {
        if (in.rasters.empty())
            return camera.window(camera.camera_from_world * (in.points->p[i] - camera.position));
        return Vec3f(in.rasters[i] / camera.resolution, 0.0f);
    });
}

AttributeRequest uv_request(const std::string& name) {
    const AttributeSource source =
        name.empty() ? AttributeSource::DefaultUv : AttributeSource::Named;
    return {source, name, 2, false};
}

}  // namespace

VectorSource position_at(NodeBuilder& b, Shift shift) {
    const VectorSource out = b.new_source<Vec3f>();
    b.add_step(
        [=, width = b.bump_width()](Run& run) {
            const ShadingPoints& points = *run.input().points;
            Vec3f* result = run.write(out);
            std::copy_n(points.p.begin(), run.count(), result);
            const std::vector<Vec3f>& steps = shift == Shift::V ? points.dp_dv : points.dp_du;
            if (shift == Shift::None || steps.empty()) return;
            for (std::size_t i = 0; i < run.count(); ++i)
                result[i] += run.step_scale(width, shift, i) * steps[i];
        },
        {}, {out.slot});
    return out;
}

VectorSource world_position_at(NodeBuilder& b, Shift shift) {
    const VectorSource p = position_at(b, shift);
    if (!b.has_surface()) return p;
    return b.map<Vec3f>([eye = FrameCamera(b.scene()).position](const Vec3f& q) { return q + eye; },
                        p);
}

VectorSource object_normal(NodeBuilder& b) {
    if (b.lamp()) return lamp_normal(b);
    // A world faces who looks at it.
    if (b.is_world())
        return b.map<Vec3f>([](const Vec3f& d) { return -d; }, position_at(b, Shift::None));
    // Bent where the material displaces by a bump, as in Cycles; Bump nodes do not count.
    const VectorSource normal = b.shading_normal(), out = b.new_source<Vec3f>();
    b.add_step(
        [=](Run& run) {
            const auto n = run.read(normal);
            Vec3f* result = run.write(out);
            for (std::size_t i = 0; i < run.count(); ++i)
                result[i] = run.input().axes_at(i).object_normal_of(n[i]);
        },
        {normal.slot}, {out.slot});
    return out;
}

VectorSource generated_at(NodeBuilder& b, Shift shift) {
    if (b.lamp()) return lamp_position(b);
    if (b.is_world()) return position_at(b, shift);
    return b.attribute_at({AttributeSource::Generated, "", 3, false}, shift);
}

VectorSource uv_at(NodeBuilder& b, const std::string& name, Shift shift) {
    if (b.lamp() && name.empty()) return lamp_uv(b);
    return b.attribute_at(uv_request(name), shift);
}

VectorSource uv_beside(NodeBuilder& b, const std::string& name, Shift shift) {
    if (b.lamp() && name.empty()) return lamp_uv(b);
    return b.attribute_beside(uv_request(name), shift);
}

void build_uv_map(NodeBuilder& b) {
    b.output_vector("UV", b.flag("from_instancer") ? instance_value(b, "INSTANCER UV").color
                                                   : uv_at(b, b.text("uv_map"), b.shift()));
}

void build_texture_coordinate(NodeBuilder& b) {
    const FrameCamera camera(b.scene());
    const VectorSource position = position_at(b, b.shift());
    const bool on_instancer = b.flag("from_instancer") && !b.is_world();
    b.output_vector("Generated", on_instancer ? instance_value(b, "INSTANCER GENERATED").color
                                              : generated_at(b, b.shift()));
    b.output_vector(
        "UV", on_instancer ? instance_value(b, "INSTANCER UV").color : uv_at(b, "", b.shift()));
    b.output_vector("Normal", object_normal(b));
    b.output_vector("Object", b.lamp() ? lamp_position(b)
                              : b.is_world()
                                  ? position
                                  : b.attribute({AttributeSource::ObjectPosition, "", 3, false}));
    const std::vector<float> other = b.table("object_from_world");
    if (other.size() == 16) {
        // Row-major, of the object that the node names.
        b.output_vector("Object", b.map<Vec3f>(
                                      [other, camera](const Vec3f& p) {
                                          const Vec3f q = p + camera.position;
                                          Vec3f out;
                                          for (int r = 0; r < 3; ++r)
                                              out[r] = other[4 * r] * q.x + other[4 * r + 1] * q.y +
                                                       other[4 * r + 2] * q.z + other[4 * r + 3];
                                          return out;
                                      },
                                      position));
    }
    // Until lamps became objects Cycles took their places for such in the sky.
    const bool in_sky = b.lamp() && !is_object(b);
    const VectorSource in_camera = in_sky ? world_position_at(b, b.shift()) : position;
    const auto turn = [camera](const Vec3f& p) { return camera.camera_from_world * p; };
    const auto window = [camera](const Vec3f& p) { return camera.window(p); };
    b.output_vector("Camera", b.map<Vec3f>(turn, in_camera));
    const bool is_parallel = !camera.projection.perspective;
    b.output_vector(
        "Window",
        is_parallel && !b.has_surface()
            ? parallel_window(b, camera)
            : b.map<Vec3f>(window, b.map<Vec3f>(turn, is_parallel ? position : in_camera)));
    b.output_vector("Reflection", in_sky ? b.view()
                                  : !b.has_surface()
                                      ? object_normal(b)
                                      : b.map<Vec3f>(
                                            [](const Vec3f& n, const Vec3f& view) {
                                                return 2.0f * glm::dot(n, view) * n - view;
                                            },
                                            b.shading_normal(), b.view()));
}

void build_geometry(NodeBuilder& b) {
    const VectorSource p = world_position_at(b, b.shift());
    b.output_vector("Position", p);
    if (b.is_read("Parametric") && !b.lamp())
        b.warn("its output 'Parametric' is not evaluated: 0 everywhere");
    if (!b.has_surface()) {
        if (b.is_read("Pointiness")) b.warn("its output 'Pointiness' is not evaluated: 0");
        b.output_vector("Incoming", b.map<Vec3f>([](const Vec3f& d) { return -d; }, p));
        b.output_vector("Normal", b.map<Vec3f>([](const Vec3f& d) { return -d; }, p));
        b.output("Backfacing", FloatSource{-1, 0.0f});
        return;
    }
    b.output_vector("Normal", b.shading_normal());
    b.output_vector("True Normal", b.lamp() ? b.shading_normal() : geometric_normal(b));
    b.output_vector("Incoming", b.view());
    b.output("Backfacing", b.backfacing());
    // A lamp's is no number: Cycles divides by the length of a derivative that it has not.
    b.output_vector("Tangent",
                    b.lamp() ? VectorSource{-1, Vec3f(std::nanf(""))} : default_tangent(b));
    b.output_vector("Parametric", b.lamp() ? lamp_parameters(b) : VectorSource{});
    // The exporter finds it, of whole meshes.
    b.output("Pointiness", b.attribute_component({AttributeSource::Named, ".pointiness", 1}, 0));
    b.output("Random Per Island",
             b.attribute_component({AttributeSource::Named, kIslandAttribute, 1}, 0));
}

void build_camera_data(NodeBuilder& b) {
    const FrameCamera camera(b.scene());
    const VectorSource p =
        b.map<Vec3f>([camera](const Vec3f& q) { return camera.camera_from_world * q; },
                     position_at(b, b.shift()));
    b.output_vector("View Vector",
                    b.map<Vec3f>([](const Vec3f& q) { return normalize_or(q, q); }, p));
    b.output("View Z Depth", b.map<float>([](const Vec3f& q) { return q.z; }, p));
    b.output("View Distance", b.map<float>([](const Vec3f& q) { return glm::length(q); }, p));
}

}  // namespace granita
