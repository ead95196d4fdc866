// SPDX-License-Identifier: GPL-3.0-or-later
// Small scenes for the tests of lighting: the camera stands at the world's origin unless moved, so
// that shading space is world space.
#pragma once

#include <cmath>
#include <initializer_list>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "shade/bsdf/bsdf.h"
#include "shade/bsdf/bsdf_albedo.h"
#include "shade/bsdf/lobe.h"
#include "shade/lights/environment.h"

namespace granita {

/// A transform whose -z axis points along `direction` from `position`.
inline Mat4d aimed(const Vec3d& position, const Vec3d& direction) {
    const Vec3d z = -glm::normalize(direction);
    const Vec3d x =
        glm::normalize(glm::cross(std::abs(z.z) < 0.9 ? Vec3d(0, 0, 1) : Vec3d(0, 1, 0), z));
    Mat4d m(1.0);
    m[0] = glm::dvec4(x, 0.0);
    m[1] = glm::dvec4(glm::cross(z, x), 0.0);
    m[2] = glm::dvec4(z, 0.0);
    m[3] = glm::dvec4(position, 1.0);
    return m;
}

inline Mat4d at(const Vec3d& position) {
    Mat4d m(1.0);
    m[3] = glm::dvec4(position, 1.0);
    return m;
}

inline Light light_of(LightKind kind, float energy, const Mat4d& world_from_light) {
    Light light;
    light.name = "Lamp";
    light.kind = kind;
    light.energy = energy;
    light.world_from_light = {world_from_light};
    return light;
}

/// Quads given by their corners, four in a row.
inline GeometryData quads(const std::string& name, const std::vector<Vec3f>& corners) {
    GeometryData data;
    data.name = name;
    data.points = corners;
    for (std::size_t i = 0; i < corners.size(); ++i)
        data.corner_verts.push_back(static_cast<std::int32_t>(i));
    data.face_sizes.assign(corners.size() / 4, 4);
    return data;
}

inline Scene empty_scene() {
    Scene scene;
    scene.options.width = scene.options.height = 16;
    scene.camera.world_from_camera = {Mat4d(1.0)};
    return scene;
}

/// Adds a geometry and one instance of it; returns the instance's index.
inline std::size_t add_instance(Scene& scene, GeometryData data, const Mat4d& world_from_object) {
    Instance instance;
    instance.name = data.name;
    instance.geometry = static_cast<int>(scene.geometries.size());
    instance.world_from_object = {world_from_object};
    instance.key = static_cast<std::uint32_t>(scene.instances.size());
    scene.geometries.push_back(std::move(data));
    scene.instances.push_back(instance);
    return scene.instances.size() - 1;
}

/// Points of surfaces that face +z, seen from straight above.
inline ShadingPoints points_facing_up(const std::vector<Vec3f>& p) {
    ShadingPoints points;
    points.count = p.size();
    points.p = p;
    points.normal.assign(p.size(), Vec3f(0, 0, 1));
    points.geometric_normal = points.normal;
    points.view = points.normal;
    points.dp_du.assign(p.size(), Vec3f(0.01f, 0, 0));
    points.dp_dv.assign(p.size(), Vec3f(0, 0.01f, 0));
    points.backfacing.assign(p.size(), 0);
    return points;
}

inline SurfaceClosure closure_of(Lobe lobe) {
    SurfaceClosure closure;
    closure.lobes.push_back(std::move(lobe));
    return closure;
}

/// At the first point.
inline PointBsdf prepare(const Lobe& lobe, const ShadingPoints& points) {
    return PointBsdf(closure_of(lobe), points, 0, GgxAlbedo::shared());
}

inline Lobe lambert(const ShadingPoints& points, float albedo) {
    Lobe lobe;
    lobe.weight.assign(points.count, Vec3f(albedo));
    lobe.normal = points.normal;
    lobe.roughness.assign(points.count, 0.0f);
    return lobe;
}

inline Lobe glossy(const ShadingPoints& points, float roughness) {
    Lobe lobe = lambert(points, 1.0f);
    lobe.kind = LobeKind::Glossy;
    lobe.roughness.assign(points.count, roughness);
    return lobe;
}

/// `radiance`: of a direction, all types of rays alike.
template <class F>
WorldEvaluator world_of(F radiance) {
    return {
        [radiance](const std::vector<Vec3f>& directions, float, RayType, std::vector<Vec3f>& out) {
            out.clear();
            for (const Vec3f& direction : directions) out.push_back(radiance(direction));
        }};
}

inline WorldEvaluator constant_world(const Vec3f& radiance) {
    WorldEvaluator world = world_of([radiance](const Vec3f&) { return radiance; });
    world.is_constant = true;
    return world;
}

}  // namespace granita
