// SPDX-License-Identifier: GPL-3.0-or-later
// Hair Info (Curves Info since Blender 3.5), Point Info and Particle Info: facts about the curve or
// point that is shaded, or the particle that an instance stands for; zeros on anything else.
#include <cmath>
#include <cstdint>

#include "geometry/element_values.h"
#include "scene/knot_time.h"
#include "shade/nodes/instance_value.h"
#include "shade/nodes/nodes.h"

namespace granita {
namespace {

FloatSource element_number(NodeBuilder& b, AttributeSource source) {
    return b.attribute_component({source, "", 1}, 0);
}

}  // namespace

void build_hair_info(NodeBuilder& b) {
    if (b.is_world()) return;
    const FloatSource is_hair = is_of_kind(b, GeometryKind::Curves);
    const auto output = [&](const char* name, AttributeSource source, float scale = 1.0f) {
        b.output(name, b.map<float>([scale](float x, float hair) { return scale * x * hair; },
                                    element_number(b, source), is_hair));
    };
    b.output("Is Strand", is_hair);
    output("Intercept", AttributeSource::CurveIntercept);
    output("Length", AttributeSource::CurveLength);
    output("Thickness", AttributeSource::ElementRadius, 2.0f);
    output("Random", AttributeSource::ElementRandom);
    const VectorSource along = b.geometry<Vec3f>(
        [](const ShadingInput& in, std::size_t i) { return in.points->dp_du[i]; });
    b.output_vector("Tangent Normal", b.map<Vec3f>(
                                          [](const Vec3f& view, const Vec3f& u, float hair) {
                                              const float length2 = glm::dot(u, u);
                                              if (hair == 0.0f || !(length2 > 0.0f))
                                                  return Vec3f(0.0f);
                                              const Vec3f across =
                                                  view - u * (glm::dot(u, view) / length2);
                                              const float length = glm::length(across);
                                              return length > 0.0f ? across / length : Vec3f(0.0f);
                                          },
                                          b.view(), along, is_hair));
}

void build_point_info(NodeBuilder& b) {
    if (b.is_world()) return;
    const Scene& scene = b.scene();
    const VectorSource center = b.attribute({AttributeSource::ObjectPosition, "", 3});
    const FloatSource size = element_number(b, AttributeSource::ElementRadius);
    const VectorSource place = b.new_source<Vec3f>();
    const FloatSource radius = b.new_source<float>();
    b.add_step(
        [=, &scene](Run& run) {
            const Instance& instance = *run.input().instance;
            const Mat4d world_from_object =
                matrix_at(instance.world_from_object, scene.options.frame_time);
            const auto stretch = static_cast<float>(
                glm::length(Vec3d(world_from_object * glm::dvec4(1.0, 1.0, 1.0, 0.0))) /
                std::sqrt(3.0));
            const bool is_point = scene.geometry_of(instance).kind == GeometryKind::Points;
            const auto p = run.read(center);
            const auto r = run.read(size);
            Vec3f* places = run.write(place);
            float* radii = run.write(radius);
            for (std::size_t i = 0; i < run.count(); ++i) {
                places[i] =
                    is_point ? Vec3f(transform_point(world_from_object, Vec3d(p[i]))) : Vec3f(0.0f);
                radii[i] = is_point ? stretch * r[i] : 0.0f;
            }
        },
        {center.slot, size.slot}, {place.slot, radius.slot});
    b.output_vector("Position", place);
    b.output("Radius", radius);
    b.output("Random", b.map<float>([](float x, float point) { return x * point; },
                                    element_number(b, AttributeSource::ElementRandom),
                                    is_of_kind(b, GeometryKind::Points)));
}

void build_particle_info(NodeBuilder& b) {
    const InstanceValue particle = instance_value(b, "PARTICLE");
    const FloatSource index = b.map<float>([](const Vec3f& v) { return v.x; }, particle.color);
    b.output("Index", index);
    b.output("Random",
             b.map<float>([](float i) { return random_of_index(static_cast<std::uint32_t>(i)); },
                          index));
    b.output("Age", b.map<float>([](const Vec3f& v) { return v.y; }, particle.color));
    b.output("Lifetime", b.map<float>([](const Vec3f& v) { return v.z; }, particle.color));
    b.output("Size", particle.alpha);
    b.output_vector("Location", instance_value(b, "PARTICLE LOCATION").color);
    b.output_vector("Velocity", instance_value(b, "PARTICLE VELOCITY").color);
    b.output_vector("Angular Velocity", instance_value(b, "PARTICLE ANGULAR VELOCITY").color);
}

}  // namespace granita
