// SPDX-License-Identifier: GPL-3.0-or-later
// Vector Rotate, Vector Transform and Normal: directions and places turned from one frame to
// another.
#include <cmath>

#include "scene/knot_time.h"
#include "shade/nodes/nodes.h"
#include "shade/programs/shading_camera.h"

namespace granita {

namespace {

Vec3f unit(const Vec3f& v) {
    const float length = glm::length(v);
    return length > 0.0f ? v / length : Vec3f(0.0f);
}

/// Rodrigues: `v` turned about a unit axis.
Vec3f turned(const Vec3f& v, const Vec3f& axis, float angle) {
    const float c = std::cos(angle), s = std::sin(angle);
    return v * c + glm::cross(axis, v) * s + axis * (glm::dot(axis, v) * (1.0f - c));
}

/// Turned about x, then y, then z.
Vec3f turned_xyz(const Vec3f& v, const Vec3f& angles) {
    return turned(turned(turned(v, {1, 0, 0}, angles.x), {0, 1, 0}, angles.y), {0, 0, 1}, angles.z);
}

Vec3f turned_back_xyz(const Vec3f& v, const Vec3f& angles) {
    return turned(turned(turned(v, {0, 0, 1}, -angles.z), {0, 1, 0}, -angles.y), {1, 0, 0},
                  -angles.x);
}

/// Destination from source for the spaces of Vector Transform.
struct Spaces {
    std::string from, to;
    Mat4d camera_from_world;
    double time;
    bool lamps_have_one;  ///< in Cycles since Blender 4, until 4.5 for normals alone

    /// Of a point; the world has no space of its own.
    Mat4d world_from_object(const ShadingInput& in, std::size_t i) const {
        if (in.instance) return matrix_at(in.instance->world_from_object, time);
        if (!lamps_have_one || in.of_lamp.empty()) return Mat4d(1.0);
        const LightFrame& frame = *in.of_lamp[i].frame;
        Mat4d m(frame.axes);
        m[3] = glm::dvec4(Vec3d(frame.position) + Vec3d(glm::inverse(camera_from_world)[3]), 1.0);
        return m;
    }
    Mat4d matrix(const ShadingInput& in, std::size_t i) const {
        Mat4d m(1.0);
        if (from != "OBJECT" && to != "OBJECT")
            return from == "CAMERA" ? glm::inverse(camera_from_world) : camera_from_world;
        const Mat4d world_from_object = this->world_from_object(in, i);
        if (from == "OBJECT") m = world_from_object;
        if (from == "CAMERA") m = glm::inverse(camera_from_world);
        if (to == "OBJECT") m = glm::inverse(world_from_object) * m;
        if (to == "CAMERA") m = camera_from_world * m;
        return m;
    }
};

}  // namespace

void build_vector_rotate(NodeBuilder& b) {
    const std::string type = b.text("rotation_type", "AXIS_ANGLE");
    const bool invert = b.flag("invert");
    const VectorSource vector = b.vector("Vector"), centre = b.vector("Center");
    if (type == "EULER_XYZ") {
        b.output_vector("Vector",
                        b.map<Vec3f>(
                            [invert](const Vec3f& v, const Vec3f& c, const Vec3f& angles) {
                                return c + (invert ? turned_back_xyz(v - c, angles)
                                                   : turned_xyz(v - c, angles));
                            },
                            vector, centre, b.vector("Rotation")));
        return;
    }
    VectorSource axis{-1, Vec3f(0.0f, 0.0f, 1.0f)};
    if (type == "X_AXIS") axis.constant = {1.0f, 0.0f, 0.0f};
    if (type == "Y_AXIS") axis.constant = {0.0f, 1.0f, 0.0f};
    if (type == "AXIS_ANGLE") axis = b.vector("Axis");
    b.output_vector("Vector",
                    b.map<Vec3f>(
                        [invert](const Vec3f& v, const Vec3f& c, const Vec3f& about, float angle) {
                            const Vec3f way = unit(about);
                            // Cycles: nothing turns about no axis.
                            if (way == Vec3f(0.0f)) return v;
                            return c + turned(v - c, way, invert ? -angle : angle);
                        },
                        vector, centre, axis, b.number("Angle")));
}

void build_vector_transform(NodeBuilder& b) {
    const VectorSource vector = b.vector("Vector");
    const Spaces spaces{b.text("convert_from", "WORLD"), b.text("convert_to", "OBJECT"),
                        glm::inverse(ShadingCamera(b.scene()).world_from_camera),
                        b.scene().options.frame_time, b.since(4, 0)};
    const std::string type = b.text("vector_type", "VECTOR");
    if (spaces.from == spaces.to) {
        b.output_vector("Vector", vector);
        return;
    }
    // Cycles turned normals like any direction before Blender 4.
    const bool as_normals = type == "NORMAL" && b.since(4, 0);
    const VectorSource out = b.new_source<Vec3f>();
    b.add_step(
        [=](Run& run) {
            Mat3d linear(1.0);
            Vec3d offset(0.0);
            const auto find = [&](std::size_t i) {
                const Mat4d m = spaces.matrix(run.input(), i);
                linear = as_normals ? glm::transpose(glm::inverse(Mat3d(m))) : Mat3d(m);
                if (type == "POINT") offset = Vec3d(m[3]);
            };
            const bool one_frame = run.input().of_lamp.empty();
            if (one_frame) find(0);
            const auto vectors = run.read(vector);
            Vec3f* result = run.write(out);
            for (std::size_t i = 0; i < run.count(); ++i) {
                if (!one_frame) find(i);
                result[i] = Vec3f(linear * Vec3d(vectors[i]) + offset);
                if (type == "NORMAL") result[i] = unit(result[i]);
            }
        },
        {vector.slot}, {out.slot});
    b.output_vector("Vector", out);
}

void build_normal(NodeBuilder& b) {
    const std::vector<float> d = b.table("direction");
    const Vec3f direction = unit(d.size() == 3 ? Vec3f(d[0], d[1], d[2]) : Vec3f(0, 0, 1));
    b.output_vector("Normal", {-1, direction});
    b.output("Dot",
             b.map<float>([direction](const Vec3f& n) { return glm::dot(direction, unit(n)); },
                          b.vector("Normal")));
}

}  // namespace granita
