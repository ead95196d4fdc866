// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/seen_points.h"

#include <algorithm>
#include <cmath>

#include "math/luminance.h"
#include "math/sampling.h"
#include "shade/lights/grid_samples.h"

namespace granita {
namespace {

/// Part of what is seen that lies beside what is hidden, in grass and hair.  Where less does
/// the noise along the edge of a shape before a smooth wall would show, and little be spared.
constexpr float kThicket = 0.33f;
/// Light that passes what lies before a point, so that it is seen.
constexpr float kLeastSeen = 0.02f;
/// At a point that something moving may hide for a part of the shutter.
constexpr int kEyeRays = 8;

class EyeRays {
  public:
    EyeRays(const ShadingPoints& points, const PointPaths& paths, const GridKey& key,
            const RayScene& rays, const Scene& scene, const MovingEye& eye,
            const ShutterWarp* shutter)
        : m_points(points),
          m_paths(paths),
          m_rays(rays),
          m_scene(scene),
          m_eye(eye),
          m_shutter(shutter),
          m_offset(rays.ray_offset(key)),
          m_key(key),
          m_at_frame(eye.place(scene.options.frame_time)),
          m_opens(eye.place(0.0f)),
          m_closes(eye.place(1.0f)),
          // Edits of the lens keep what is shaded without bounces (scene/scene_changes.cpp).
          m_sees_lens(scene.camera.projection.has_lens() && scene.camera.projection.perspective &&
                      scene.options.bounces.most > 0),
          m_sequence(mix_bits(grid_seed(key, scene.options.seed))),
          m_lens(mix_bits(mix_bits(grid_seed(key, scene.options.seed)))) {}

    struct EyeRay {
        Ray ray;
        bool is_behind;  ///< it sees the side that is turned away at the frame time
    };
    /// From the point to the eye, at one of kEyeRays times that are spread over its life.
    EyeRay from(std::size_t i, int number) {
        const std::uint32_t place = place_in_sequence(m_points, i);
        const float frame_time = m_scene.options.frame_time;
        const float time = m_shutter ? this->time(m_sequence(place).x, number) : frame_time;
        const Mat4d at = m_shutter ? m_eye.place(time) : m_at_frame;
        Vec3f p = m_points.p[i], normal = m_points.geometric_normal[i];
        if (m_paths.moves()) {
            const PointPaths::Place there = m_paths.at(i, time);
            p = there.start;
            normal = there.normal;
        } else if (!m_points.ray_offset.empty()) {
            p += m_points.ray_offset[i];
        }
        if (!m_points.faces.empty())
            m_offset = m_rays.ray_offset({m_key.instance, m_points.faces[i]});
        const Projection& projection = m_scene.camera.projection;
        const Mat3f axes{Mat3d(at)};
        Vec3f eye(at[3]);
        if (m_sees_lens)
            eye += axes * Vec3f(Vec2f(projection.lens_radius * projection.lens_extent()) *
                                    sample_disc(m_lens(place)),
                                0.0f);
        // Of what the surface turns to the eye of that time.
        const Vec3f ahead = axes[2];
        Vec3f way = projection.perspective ? eye - p : -ahead;
        const bool is_below = glm::dot(way, normal) < 0.0f;
        if (is_below) normal = -normal;
        const Vec3f start = m_offset(p, normal);
        if (projection.perspective) way = eye - start;
        const float length = glm::length(way);
        const float depth = glm::dot(start - Vec3f(at[3]), ahead);
        const float clear = 1.0f - static_cast<float>(projection.near_clip) / depth;
        Ray ray{start, way / length, projection.perspective ? length * clear : depth, time};
        ray.type = RayType::Camera;
        return {ray, is_below != is_below_at_frame(i)};
    }

    /// Whether its next rays may find something else before it, or another side of it.
    bool may_vary(std::size_t i, const Ray& ray) const {
        return m_paths.moves() || m_rays.varies(ray.start, ray.direction, ray.distance) ||
               is_behind_for(i, m_opens) || is_behind_for(i, m_closes);
    }

  private:
    /// Ways tell of normals otherwise than surfaces do: about silhouettes they may not agree.
    bool is_below_at_frame(std::size_t i) const {
        return m_paths.moves() &&
               glm::dot(m_paths.at(i, m_scene.options.frame_time).normal, m_points.view[i]) < 0.0f;
    }

    /// Of a point that stands, from an eye of another time.
    bool is_behind_for(std::size_t i, const Mat4d& eye) const {
        const Vec3f way =
            m_scene.camera.projection.perspective ? Vec3f(eye[3]) - m_points.p[i] : -Vec3f(eye[2]);
        return glm::dot(way, m_points.geometric_normal[i]) < 0.0f;
    }

    float time(float uniform, int number) const {
        const float turned = uniform + static_cast<float>(number) / kEyeRays;
        const Vec2f exposed = m_shutter->exposed(m_paths.lifespan());
        return m_shutter->time(exposed.x + (turned - std::floor(turned)) * (exposed.y - exposed.x));
    }

    const ShadingPoints& m_points;
    const PointPaths& m_paths;
    const RayScene& m_rays;
    const Scene& m_scene;
    const MovingEye& m_eye;
    const ShutterWarp* m_shutter;
    RayOffset m_offset;
    GridKey m_key;
    Mat4d m_at_frame, m_opens, m_closes;
    bool m_sees_lens;
    SobolPoints m_sequence, m_lens;
};

/// Of what is marked of a lattice, what has nothing beside it that is not.
std::vector<std::uint8_t> off_edges(const std::vector<std::uint8_t>& marked, std::size_t columns) {
    if (columns == 0) return marked;
    const auto shrunk = [](const std::vector<std::uint8_t>& from, std::size_t step,
                           std::size_t row) {
        std::vector<std::uint8_t> to = from;
        for (std::size_t i = 0; i + step < from.size(); ++i) {
            if (step == 1 && i % row == row - 1) continue;
            to[i] &= from[i + step];
            to[i + step] &= from[i];
        }
        return to;
    };
    return shrunk(shrunk(marked, 1, columns), columns, columns);
}

/// [eye_rays] whether enough light comes through.
std::vector<std::uint8_t> are_clear(const RayScene& rays,
                                    const std::vector<EyeRays::EyeRay>& eye_rays) {
    std::vector<Ray> asked;
    asked.reserve(eye_rays.size());
    for (const EyeRays::EyeRay& one : eye_rays) asked.push_back(one.ray);
    std::vector<Vec3f> left(asked.size());
    rays.transmittances(asked, left);
    std::vector<std::uint8_t> clear(asked.size());
    for (std::size_t i = 0; i < asked.size(); ++i) clear[i] = luminance(left[i]) > kLeastSeen;
    return clear;
}

/// At points before which something moves: those that are seen for a part of the shutter are lit as
/// they are then.  Light of the rest is that of places inside of things, which went into the mean.
/// Returns the points whose other side is seen more often.
std::vector<std::size_t> trace_again(ShadingPoints& points, EyeRays& eye_rays, const RayScene& rays,
                                     const std::vector<EyeRays::EyeRay>& first,
                                     std::vector<std::uint8_t>& seen) {
    std::vector<std::size_t> doubtful, turned;
    std::vector<EyeRays::EyeRay> asked;
    for (std::size_t i = 0; i < points.count; ++i) {
        if (!eye_rays.may_vary(i, first[i].ray)) continue;
        doubtful.push_back(i);
        for (int number = 1; number < kEyeRays; ++number) asked.push_back(eye_rays.from(i, number));
    }
    const std::vector<std::uint8_t> clear = are_clear(rays, asked);
    for (std::size_t k = 0; k < doubtful.size(); ++k) {
        const std::size_t i = doubtful[k];
        std::vector<float> times;
        int behind = 0;
        const auto see = [&](const EyeRays::EyeRay& one) {
            times.push_back(one.ray.time);
            behind += one.is_behind;
        };
        if (seen[i]) see(first[i]);
        for (std::size_t at = k * (kEyeRays - 1); at < (k + 1) * (kEyeRays - 1); ++at)
            if (clear[at]) see(asked[at]);
        seen[i] = !times.empty();
        if (2 * behind > static_cast<int>(times.size())) turned.push_back(i);
        if (times.empty() || times.size() == kEyeRays) continue;
        points.visible_times.resize(points.count);
        points.visible_times[i] = std::move(times);
    }
    return turned;
}

}  // namespace

std::vector<std::size_t> look_at(ShadingPoints& points, const PointPaths& paths, const GridKey& key,
                                 const RayScene& rays, const Scene& scene, const MovingEye& eye,
                                 const ShutterWarp* shutter, float edge) {
    EyeRays eye_rays(points, paths, key, rays, scene, eye, shutter);
    std::vector<EyeRays::EyeRay> asked;
    asked.reserve(points.count);
    for (std::size_t i = 0; i < points.count; ++i) asked.push_back(eye_rays.from(i, 0));
    std::vector<std::uint8_t> seen = are_clear(rays, asked);
    std::vector<std::size_t> turned;
    if (shutter) turned = trace_again(points, eye_rays, rays, asked, seen);
    if (std::ranges::count(seen, 0) == 0) return turned;
    const std::vector<std::uint8_t> inside = off_edges(seen, points.columns);
    const auto all_seen = static_cast<float>(std::ranges::count(seen, 1));
    points.thicket =
        all_seen - static_cast<float>(std::ranges::count(inside, 1)) > kThicket * all_seen;
    constexpr float kUnseenShare = ShadingPoints::kUnseenShare;
    edge = points.thicket ? std::max(kUnseenShare, edge) : 1.0f;
    std::vector<std::uint8_t> hidden(points.count);
    std::ranges::transform(seen, hidden.begin(), [](std::uint8_t is_seen) { return !is_seen; });
    const std::vector<std::uint8_t> far = off_edges(hidden, points.columns);
    points.shares.resize(points.count);
    for (std::size_t i = 0; i < points.count; ++i)
        points.shares[i] = inside[i] ? 1.0f : far[i] ? kUnseenShare : edge;
    points.seen = std::move(seen);
    return turned;
}

}  // namespace granita
