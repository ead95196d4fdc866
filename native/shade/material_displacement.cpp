// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/material_displacement.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <mutex>
#include <utility>

#include "base/once.h"
#include "base/parallel.h"
#include "math/largest_stretch.h"
#include "scene/knot_time.h"
#include "shade/displacement_run.h"
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
/// Points that a program runs over, or so: their memory stays in the second cache.
constexpr std::size_t kMostAtOnce = 1024;
/// Of each place where slopes are asked for.
constexpr std::size_t kPointsForSlopes = 5;
/// Pixels: slopes are not of what is smaller, however fine micropolygons are.
constexpr double kFinest = 1.0 / 16.0;

}  // namespace

/// An instance that is displaced.
struct MaterialDisplacement::Target {
    std::size_t same_as = 0;
    DisplacedInstance at;
    mutable Once bound_once;
    mutable float bound = 0.0f;
};

MaterialDisplacement::MaterialDisplacement(const Scene& scene,
                                           std::vector<std::optional<DisplacementProgram>> programs,
                                           std::shared_ptr<GeometryCache> geometries,
                                           Report& report, std::shared_ptr<PersistentOffsets> kept)
    : m_scene(scene),
      m_programs(std::move(programs)),
      m_geometries(std::move(geometries)),
      m_report(report),
      m_kept(kept ? std::move(kept) : std::make_shared<PersistentOffsets>()),
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
        target->at.shading_from_object = world_from_object;
        target->at.shading_from_object[3] -= glm::dvec4(Vec3d(world_from_camera[3]), 0.0);
        target->at.axes = ObjectAxes(world_from_object);
        target->at.difference = std::max<double>(options.dicing_rate, kFinest);
        target->at.object_from_world = inverse;
        const double scale = largest_stretch(world_from_object);
        target->at.eye = inverse * (Vec3d(world_from_camera[3]) - Vec3d(world_from_object[3]));
        // A pixel across the largest stretch.
        if (projection.perspective)
            target->at.angle = pixel;
        else
            target->at.least = pixel / scale;
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
    const auto program_at = [&](std::size_t i) {
        return program_of(instance, geometry, places[i].patch->face);
    };
    const std::size_t most = derivatives ? kMostAtOnce / kPointsForSlopes : kMostAtOnce;
    for (std::size_t first = 0, end = 0; first < n; first = end) {
        const DisplacementProgram* const program = program_at(first);
        while (end < n && end - first < most && program_at(end) == program) ++end;
        if (program)
            run_displacement(*program, m_targets[index]->at, instance, geometry,
                             places.subspan(first, end - first), derivatives, first, out);
    }
}

void MaterialDisplacement::find_beside(std::size_t index, const SharedGeometry& geometry,
                                       std::span<const SurfacePlace> places, Offsets& out) const {
    run(index, geometry, places, false, out);
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
    const float stretch =
        static_cast<float>(largest_stretch(m_targets[index]->at.object_from_world));
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
