// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/displacement_run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/object_pool.h"
#include "geometry/surface_evaluator.h"
#include "geometry/surface_frames.h"
#include "math/normalize_or.h"

namespace granita {
namespace {

/// Of a patch: a place and those beside it stay within it.
constexpr double kLargestStep = 0.5;

/// Places as points that a program runs over.
class Batch {
  public:
    Batch(const DisplacedInstance& at, const Instance& instance, const SharedGeometry& geometry)
        : m_at(at),
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
        input.axes = m_at.axes;
        Run run = program.program.prepare(input, m_places.size(), std::move(m_memory.slots));
        program.program.execute(run);
        const auto offsets = run.read(program.offset);
        const auto in_object = [&](std::size_t i) {
            return Vec3f(m_at.object_from_world * Vec3d(offsets[i]));
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
        return m_at.angle * glm::distance(m_frames.p[i], m_at.eye) + m_at.least;
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
        const double most = std::max(m_at.difference, 1.0);
        return pixel > 0.0 ? std::clamp(least / pixel, m_at.difference, most) : most;
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
        const Mat3f turn(m_at.shading_from_object);
        const Mat3f turn_normal = m_at.axes.world_normal_from_object();
        for (std::size_t k = 0, i = first; k < frames.p.size(); ++k, ++i) {
            const Vec3f flat(frames.geometric_normal[k]);
            const Vec3f geometric = normalize_or(turn_normal * flat, flat);
            m_points.p[i] = Vec3f(transform_point(m_at.shading_from_object, frames.p[k]));
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

    const DisplacedInstance& m_at;
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

}  // namespace

void run_displacement(const DisplacementProgram& program, const DisplacedInstance& at,
                      const Instance& instance, const SharedGeometry& geometry,
                      std::span<const SurfacePlace> places, bool derivatives, std::size_t first,
                      Offsets& out) {
    Batch(at, instance, geometry).run(program, places, derivatives, first, out);
}

}  // namespace granita
