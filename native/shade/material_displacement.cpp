// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/material_displacement.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <mutex>
#include <utility>

#include "base/object_pool.h"
#include "base/once.h"
#include "base/parallel.h"
#include "geometry/surface_evaluator.h"
#include "geometry/surface_frames.h"
#include "math/largest_stretch.h"
#include "math/normalize_or.h"
#include "scene/knot_time.h"
#include "shade/programs/shading_camera.h"

namespace granita {
namespace {

/// Of the largest offset that samples find: how far others may go where nodes do not tell.
constexpr float kMargin = 2.0f;
/// Places that are sampled for it, at least, and along a patch's side at most.
constexpr std::size_t kSamples = 1 << 16;
constexpr int kMostAlongSide = 256;
/// Patches in a piece of that loop.
constexpr std::size_t kGrain = 64;
/// Places that a program runs over: their memory stays in the second cache.
constexpr std::size_t kMostAtOnce = 1024;
/// Of a patch: a place and the two beside it stay within it.
constexpr double kLargestStep = 0.5;
/// Pixels: slopes are not of what is smaller, however fine micropolygons are.
constexpr double kFinest = 1.0 / 16.0;
/// Of the coordinates: smaller differences drown in the rounding of single precision.
constexpr double kLeastDifference = 2e-5;

}  // namespace

/// An instance that is displaced.
struct MaterialDisplacement::Target {
    std::size_t same_as = 0;
    Mat4d shading_from_object{1.0};  ///< at the frame time; origin at the camera
    ObjectAxes axes;
    Mat3d object_from_world{1.0};
    // The camera in object space: a pixel is as large as `angle` at each metre from `eye`, plus
    // `least`.
    Vec3d eye{0.0};
    double angle = 0.0, least = 0.0;
    /// Pixels from one to the other of two points whose difference is a slope: a micropolygon's
    /// side.  Detail that the micropolygons do not have should not be seen in normals either: they
    /// would look away from the eye here and there, where the surface itself is hidden.
    double difference = 1.0;
    mutable Once bound_once;
    mutable float bound = 0.0f;
};

/// Places as points that a program runs over.
class MaterialDisplacement::Batch {
  public:
    Batch(const Target& target, const Instance& instance, const SharedGeometry& geometry)
        : m_target(target),
          m_instance(instance),
          m_geometry(geometry),
          m_memory(ObjectPool<Memory>::take()) {}
    ~Batch() { ObjectPool<Memory>::give(std::move(m_memory)); }
    Batch(const Batch&) = delete;
    Batch& operator=(const Batch&) = delete;

    /// Those of `places` go to `out` from `first` on, which has room for them.
    void run(const DisplacementProgram& program, std::span<const SurfacePlace> places,
             bool derivatives, std::size_t first, Offsets& out) {
        const std::size_t n = places.size();
        m_places.assign(places.begin(), places.end());
        find_uv();
        find_frames_from(0, m_frames);
        m_steps.resize(n);
        for (std::size_t i = 0; i < n; ++i) m_steps[i] = step_at(i);
        if (derivatives) add_neighbours(n);
        resize_points();
        fill_points(m_frames, 0);
        if (derivatives) fill_points(m_beside, n);
        fill_attributes(program.requests);
        ShadingInput input;
        input.points = &m_points;
        input.attributes = &m_attributes;
        input.instance = &m_instance;
        input.axes = m_target.axes;
        Run run = program.program.prepare(input, m_places.size(), std::move(m_memory.slots));
        program.program.execute(run);
        const auto offsets = run.read(program.offset);
        const auto in_object = [&](std::size_t i) {
            return Vec3f(m_target.object_from_world * Vec3d(offsets[i]));
        };
        for (std::size_t i = 0; i < n; ++i) out.offset[first + i] = in_object(i);
        for (std::size_t i = 0; derivatives && i < n; ++i) {
            const Vec3f& here = out.offset[first + i];
            const auto slope = [&](std::size_t beside, const Beside& at) {
                if (at.way == 0.0) return Vec3f(0.0f);
                const Vec3f one = in_object(beside + i), other = in_object(beside + n + i);
                const Vec3f rise = at.is_between ? one - other : 4.0f * one - other - 3.0f * here;
                return rise / static_cast<float>(at.way);
            };
            out.by_u[first + i] = slope(n, m_beside_u[i]);
            out.by_v[first + i] = slope(3 * n, m_beside_v[i]);
        }
        m_memory.slots = run.take_memory();
    }

  private:
    /// Along u or v, two points from which a slope is found: on either side, or, where a patch of a
    /// subdivision surface ends, one farther inside than the other.
    struct Beside {
        double one = 0.0, other = 0.0;  ///< from the place
        double way = 0.0;               ///< 0: there is no slope
        bool is_between = true;         ///< the place lies between them
    };

    /// Used again by the next batch.
    struct Memory {
        std::vector<SurfacePlace> places;
        std::vector<Vec2d> uv, steps;
        std::vector<Beside> beside_u, beside_v;
        SurfaceFrames frames, beside;
        ShadingPoints points;
        std::vector<GridAttribute> attributes;
        GridAttribute of_patch;
        std::vector<float> slots;
    };

    void find_uv() {
        m_uv.clear();
        for (const SurfacePlace& place : m_places) m_uv.push_back(place.uv);
    }

    /// Of the places from `begin` on.
    void find_frames_from(std::size_t begin, SurfaceFrames& out) {
        out.clear();
        for_each_patch(std::span(m_places).subspan(begin),
                       [&](const BasePatch& patch, std::size_t first, std::size_t count) {
                           add_frames(m_geometry, patch,
                                      std::span(m_uv).subspan(begin + first, count),
                                      m_geometry.frame(), out);
                       });
    }

    double pixel_at(std::size_t i) const {
        return m_target.angle * glm::distance(m_frames.p[i], m_target.eye) + m_target.least;
    }

    /// A pixel, in (u, v); towards the inside of the patch where a step leads out of it.
    Vec2d step_at(std::size_t i) const {
        const double pixel = pixel_at(i);
        const auto along = [&](const Vec3d& s, double at) {
            const double length = glm::length(s);
            if (!(length > 0.0)) return 0.0;
            const double step = std::min(pixel / length, kLargestStep);
            return m_geometry.subdivision() && at + step > 1.0 ? -step : step;
        };
        return {along(m_frames.su[i], m_uv[i].x), along(m_frames.sv[i], m_uv[i].y)};
    }

    /// Of a pixel's step: across the points whose difference is a slope.
    double difference_at(std::size_t i) const {
        const Vec3d& p = m_frames.p[i];
        const double pixel = pixel_at(i);
        const double least =
            kLeastDifference * std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        const double most = std::max(m_target.difference, 1.0);
        return pixel > 0.0 ? std::clamp(least / pixel, m_target.difference, most) : most;
    }

    /// The two points beside a place in the order in which they are added.
    Beside beside(double at, double step, double difference) const {
        const double way = std::min(difference * std::abs(step), kLargestStep);
        const bool inside = at - 0.5 * way >= 0.0 && at + 0.5 * way <= 1.0;
        if (inside || !m_geometry.subdivision()) return {0.5 * way, -0.5 * way, way, true};
        const double turned = at > 0.5 ? -way : way;
        return {0.5 * turned, turned, turned, false};
    }

    void add_neighbours(std::size_t n) {
        m_beside_u.clear();
        m_beside_v.clear();
        m_places.resize(5 * n);
        for (std::size_t i = 0; i < n; ++i) {
            const auto& [patch, uv] = m_places[i];
            const double difference = difference_at(i);
            const Beside& u = m_beside_u.emplace_back(beside(uv.x, m_steps[i].x, difference));
            const Beside& v = m_beside_v.emplace_back(beside(uv.y, m_steps[i].y, difference));
            m_places[n + i] = {patch, uv + Vec2d(u.one, 0.0)};
            m_places[2 * n + i] = {patch, uv + Vec2d(u.other, 0.0)};
            m_places[3 * n + i] = {patch, uv + Vec2d(0.0, v.one)};
            m_places[4 * n + i] = {patch, uv + Vec2d(0.0, v.other)};
        }
        find_uv();
        m_steps.resize(5 * n);
        for (std::size_t i = n; i < 5 * n; ++i) m_steps[i] = m_steps[i % n];
        find_frames_from(n, m_beside);
    }

    void resize_points() {
        const std::size_t n = m_places.size();
        m_points.count = n;
        for (auto* values : {&m_points.p, &m_points.normal, &m_points.geometric_normal,
                             &m_points.view, &m_points.dp_du, &m_points.dp_dv})
            values->resize(n);
        m_points.backfacing.assign(n, 0);
    }

    /// What is seen straight from above, from point `first` on.
    void fill_points(const SurfaceFrames& frames, std::size_t first) {
        const Mat3f turn(m_target.shading_from_object);
        const Mat3f turn_normal = m_target.axes.world_normal_from_object();
        for (std::size_t k = 0, i = first; k < frames.p.size(); ++k, ++i) {
            const Vec3f flat(frames.geometric_normal[k]);
            const Vec3f geometric = normalize_or(turn_normal * flat, flat);
            m_points.p[i] = Vec3f(transform_point(m_target.shading_from_object, frames.p[k]));
            m_points.geometric_normal[i] = geometric;
            m_points.normal[i] = normalize_or(turn_normal * Vec3f(frames.normal[k]), geometric);
            m_points.view[i] = geometric;
            m_points.dp_du[i] = turn * Vec3f(frames.su[k] * m_steps[i].x);
            m_points.dp_dv[i] = turn * Vec3f(frames.sv[k] * m_steps[i].y);
        }
    }

    void fill_attributes(const std::vector<AttributeRequest>& requests) {
        m_attributes.resize(requests.size());
        for (std::size_t k = 0; k < requests.size(); ++k) {
            GridAttribute& to = m_attributes[k];
            to.attribute = static_cast<int>(k);
            to.width = requests[k].width;
            find_attribute(requests[k], to);
            const auto width = static_cast<std::size_t>(to.width);
            for (std::size_t i = 0; i < to.values.size(); ++i) {
                to.du[i] *= static_cast<float>(m_steps[i / width].x);
                to.dv[i] *= static_cast<float>(m_steps[i / width].y);
            }
        }
    }

    void find_attribute(const AttributeRequest& request, GridAttribute& to) {
        for (auto* values : {&to.values, &to.du, &to.dv}) values->clear();
        GridAttribute& part = m_memory.of_patch;
        const auto append = [](const std::vector<float>& from, std::vector<float>& values) {
            values.insert(values.end(), from.begin(), from.end());
        };
        for_each_patch(m_places, [&](const BasePatch& patch, std::size_t first, std::size_t count) {
            m_geometry.surface().attribute(patch, request, std::span(m_uv).subspan(first, count),
                                           part.values, part.du, part.dv);
            append(part.values, to.values);
            append(part.du, to.du);
            append(part.dv, to.dv);
        });
    }

    const Target& m_target;
    const Instance& m_instance;
    const SharedGeometry& m_geometry;
    Memory m_memory;
    /// [places], and where slopes are asked for, of those beside them along u and along v.
    std::vector<SurfacePlace>& m_places = m_memory.places;
    std::vector<Vec2d>&m_uv = m_memory.uv, &m_steps = m_memory.steps;
    std::vector<Beside>&m_beside_u = m_memory.beside_u, &m_beside_v = m_memory.beside_v;
    SurfaceFrames &m_frames = m_memory.frames, &m_beside = m_memory.beside;
    ShadingPoints& m_points = m_memory.points;
    std::vector<GridAttribute>& m_attributes = m_memory.attributes;
};

MaterialDisplacement::MaterialDisplacement(const Scene& scene,
                                           std::vector<std::optional<DisplacementProgram>> programs,
                                           std::shared_ptr<GeometryCache> geometries,
                                           Report& report, std::shared_ptr<KeptOffsets> kept)
    : m_scene(scene),
      m_programs(std::move(programs)),
      m_geometries(std::move(geometries)),
      m_report(report),
      m_kept(kept ? std::move(kept) : std::make_shared<KeptOffsets>()),
      m_targets(scene.instances.size()) {
    if (std::ranges::none_of(m_programs, [](const auto& p) { return p.has_value(); })) return;
    const Options& options = scene.options;
    const Projection& projection = scene.camera.projection;
    const Mat4d world_from_camera = ShadingCamera(scene).world_from_camera;
    const double pixel = 1.0 / std::max(std::abs(projection.scale.x), std::abs(projection.scale.y));
    std::map<std::pair<int, std::vector<std::int32_t>>, std::size_t> first_of;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        bool moves = false, alone = false;
        for (const std::int32_t material : instance.materials)
            if (const DisplacementProgram* p = program(material)) {
                moves = true;
                alone |= p->depends_on_instance;
            }
        if (!moves) continue;
        if (scene.geometry_of(instance).kind != GeometryKind::Mesh) {
            report.warn(instance.name, "displacement has no effect on curves and points");
            continue;
        }
        const Mat4d world_from_object = matrix_at(instance.world_from_object, options.frame_time);
        const Mat3d inverse = glm::inverse(Mat3d(world_from_object));
        if (!is_finite(Vec3f(inverse[0])) || !is_finite(Vec3f(inverse[1])) ||
            !is_finite(Vec3f(inverse[2]))) {
            report.warn(instance.name, "is scaled to nothing along an axis and is not displaced");
            continue;
        }
        auto target = std::make_unique<Target>();
        target->same_as =
            alone ? i
                  : first_of.try_emplace({instance.geometry, instance.materials}, i).first->second;
        target->shading_from_object = world_from_object;
        target->shading_from_object[3] -= glm::dvec4(Vec3d(world_from_camera[3]), 0.0);
        target->axes = ObjectAxes(world_from_object);
        target->difference = std::max<double>(options.dicing_rate, kFinest);
        target->object_from_world = inverse;
        const double scale = largest_stretch(world_from_object);
        target->eye = inverse * (Vec3d(world_from_camera[3]) - Vec3d(world_from_object[3]));
        // A pixel across the largest stretch.
        if (projection.perspective)
            target->angle = pixel;
        else
            target->least = pixel / scale;
        m_targets[i] = std::move(target);
    }
}

MaterialDisplacement::~MaterialDisplacement() = default;

bool MaterialDisplacement::any() const {
    return std::ranges::any_of(m_targets, [](const auto& target) { return target != nullptr; });
}

bool MaterialDisplacement::displaces(std::size_t instance) const {
    return m_targets[instance] != nullptr;
}

std::size_t MaterialDisplacement::same_as(std::size_t instance) const {
    return m_targets[instance] ? m_targets[instance]->same_as : instance;
}

const DisplacementProgram* MaterialDisplacement::program(std::int32_t material) const {
    if (material < 0) return nullptr;
    const auto& program = m_programs[static_cast<std::size_t>(material)];
    return program ? &*program : nullptr;
}

const DisplacementProgram* MaterialDisplacement::program_of(const Instance& instance,
                                                            const SharedGeometry& geometry,
                                                            std::uint32_t face) const {
    return program(instance.material(geometry.data().slot(face)));
}

void MaterialDisplacement::run(std::size_t index, const SharedGeometry& geometry,
                               std::span<const SurfacePlace> places, bool derivatives,
                               Offsets& out) const {
    const std::size_t n = places.size();
    out.offset.assign(n, Vec3f(0.0f));
    out.by_u.assign(derivatives ? n : 0, Vec3f(0.0f));
    out.by_v.assign(derivatives ? n : 0, Vec3f(0.0f));
    const Instance& instance = m_scene.instances[index];
    Batch batch(*m_targets[index], instance, geometry);
    const auto program_at = [&](std::size_t i) {
        return program_of(instance, geometry, places[i].patch->face);
    };
    for (std::size_t first = 0, end = 0; first < n; first = end) {
        const DisplacementProgram* const program = program_at(first);
        while (end < n && end - first < kMostAtOnce && program_at(end) == program) ++end;
        if (program)
            batch.run(*program, places.subspan(first, end - first), derivatives, first, out);
    }
}

void MaterialDisplacement::find(std::size_t index, const SharedGeometry& geometry,
                                std::span<const SurfacePlace> places, bool derivatives,
                                Offsets& out) const {
    run(index, geometry, places, derivatives, out);
    const std::size_t n = places.size();
    const Instance& instance = m_scene.instances[index];
    const float most = bound(index);
    std::size_t broken = 0, beyond = 0;
    for (std::size_t i = 0; i < n; ++i) {
        Vec3f& offset = out.offset[i];
        const float length = glm::length(offset);
        const bool slopes = !derivatives || (is_finite(out.by_u[i]) && is_finite(out.by_v[i]));
        if (std::isfinite(length) && length <= most && slopes) continue;
        if (derivatives) out.by_u[i] = out.by_v[i] = Vec3f(0.0f);
        if (!std::isfinite(length)) {
            offset = Vec3f(0.0f);
            ++broken;
        } else if (length > most) {
            offset *= most / length;
            ++beyond;
        }
    }
    if (broken + beyond > 0) m_has_said = true;
    if (broken)
        m_report.warn(instance.name, "its displacement is no number at some points", broken);
    if (beyond)
        m_report.warn(instance.name,
                      "is displaced farther at some points than was found beforehand: it is cut "
                      "off there",
                      beyond);
}

float MaterialDisplacement::bound(std::size_t instance) const {
    const std::size_t source = m_targets[instance]->same_as;
    const Target& target = *m_targets[source];
    target.bound_once.call([&] { target.bound = kept_bound(source); });
    return target.bound;
}

float MaterialDisplacement::kept_bound(std::size_t index) const {
    {
        const std::lock_guard lock(m_kept->mutex);
        const auto known = m_kept->bounds.find(index);
        if (known != m_kept->bounds.end()) return known->second;
    }
    const float found = find_bound(index);
    const std::lock_guard lock(m_kept->mutex);
    return m_kept->bounds.emplace(index, found).first->second;
}

float MaterialDisplacement::find_bound(std::size_t index) const {
    const Instance& instance = m_scene.instances[index];
    const float stretch = static_cast<float>(largest_stretch(m_targets[index]->object_from_world));
    float told = 0.0f;
    for (const std::int32_t material : instance.materials)
        if (const DisplacementProgram* p = program(material))
            told = std::max(told, p->longest * (p->longest_in_world ? stretch : 1.0f));
    if (std::isfinite(told)) return told * (1.0f + 1e-4f);
    Report said_by_others;
    const auto geometry =
        m_geometries->shared(m_scene, static_cast<std::size_t>(instance.geometry), said_by_others);
    return kMargin * sampled_bound(index, *geometry);
}

float MaterialDisplacement::sampled_bound(std::size_t index, const SharedGeometry& geometry) const {
    const std::vector<BasePatch>& patches = geometry.patches();
    int side = 1;
    while (side < kMostAlongSide &&
           patches.size() * static_cast<std::size_t>(side * side) < kSamples)
        side *= 2;
    std::vector<float> most(patches.size(), 0.0f);
    parallel_for(patches.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        std::vector<SurfacePlace> places;
        Offsets offsets;
        const auto measure = [&](std::size_t k) {
            run(index, geometry, places, false, offsets);
            for (const Vec3f& offset : offsets.offset)
                if (is_finite(offset)) most[k] = std::max(most[k], glm::length(offset));
            places.clear();
        };
        for (std::size_t k = begin; k < end; ++k) {
            for (int j = 0; j <= side; ++j)
                for (int i = 0; i <= side; ++i)
                    if (patches[k].kind != PatchKind::Triangle || i + j <= side)
                        places.push_back({&patches[k], Vec2d(i, j) / static_cast<double>(side)});
            if (places.size() >= kMostAtOnce) measure(k);
        }
        measure(begin);
    });
    return most.empty() ? 0.0f : std::ranges::max(most);
}

}  // namespace granita
