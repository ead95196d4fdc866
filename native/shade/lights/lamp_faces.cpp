// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/lamp_faces.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <unordered_map>

#include "math/luminance.h"
#include "math/sampling.h"
#include "shade/rays/ray_triangles.h"

namespace granita {
namespace {

/// Lamps of a frame: some 600 bytes each while the tree is made of them.
constexpr std::size_t kMostFaces = std::size_t{1} << 19;
/// Places at which faces whose light varies are asked for it: of all, and of one triangle.
constexpr std::size_t kPlaces = std::size_t{1} << 20, kFewestPlaces = 8, kMostPlaces = 256;
/// Of more such triangles every so many of a material are asked; others send what these do.
constexpr std::size_t kMostAsked = std::size_t{1} << 20;
/// Places that are asked at once.
constexpr std::size_t kBatch = 4096;
/// Of a material's mean, for which each of its faces counts beside what it was found to send: some
/// of that is missed.
constexpr float kMissed = 0.1f;

/// Largest at any time; 0 where it is no number.
float area_of(const MovingTriangle& triangle) {
    float largest = 0.0f;
    triangle.at_knots([&largest](const TriangleLight& at) {
        if (std::isfinite(at.area())) largest = std::max(largest, at.area());
    });
    return largest;
}

}  // namespace

/// Goes over all triangles in one order, again and again: to learn what each sends, and to make
/// lamps.  Two halves of a quad, which rays do not tell apart, are one face.
class LampFaces::Collector {
  public:
    Collector(const Scene& scene, const RayScene& rays, const RayMaterials& materials,
              const LightPatterns& patterns, Report& report, const Progress& progress)
        : m_scene(scene),
          m_rays(rays),
          m_materials(materials),
          m_patterns(patterns),
          m_report(report),
          m_progress(progress) {}

    void collect(LampFaces& found) {
        for (std::uint32_t i = 0; i < m_scene.instances.size(); ++i)
            if (m_materials.shines(m_scene.instances[i])) find(i);
        if (m_instances.empty()) return;
        measure();
        choose();
        make(found);
    }

  private:
    struct Triangle {
        std::uint32_t instance;  ///< in Scene::instances
        std::int32_t material;
        bool is_uneven;
        std::size_t face;
        MovingTriangle shape;
    };
    struct Face {
        float power = 0.0f, area = 0.0f;  ///< mean of the channels' radiance times square metres
        std::size_t triangles = 0;
    };
    /// Of a material whose light varies.
    struct Uneven {
        std::shared_ptr<const LightPattern> pattern;
        double power = 0.0, area = 0.0;
        std::size_t seen = 0;  ///< triangles that a visit has come by
        std::vector<LightSample> asked;
        std::vector<PatternSample> samples;
        std::vector<std::size_t> faces;  ///< [samples]

        float mean() const { return area > 0.0 ? static_cast<float>(power / area) : 0.0f; }
        float missed() const { return kMissed * mean(); }
    };

    void find(std::uint32_t index) {
        const Instance& instance = m_scene.instances[index];
        const GeometryData& geometry = m_scene.geometry_of(instance);
        auto matrices = std::make_shared<std::vector<Mat4d>>(m_rays.transforms(index));
        if (matrices->empty()) return;  // no ray meets it
        if (geometry.kind == GeometryKind::Mesh)
            m_instances.emplace_back(index, std::move(matrices));
        else if (m_scene.options.bounces.most == 0)
            m_report.warn(geometry.name,
                          "shines, but is no mesh: it is seen, but lights nothing without bounces");
    }

    /// Those of materials that shine.
    void visit(const std::function<void(Triangle&)>& visitor) const {
        RayTarget last;
        std::size_t faces = 0, triangles = 0;
        for (const auto& [index, matrices] : m_instances) {
            m_progress.check();
            const Instance& instance = m_scene.instances[index];
            const auto one = [&, index = index, matrices = matrices](const RayTriangle& from) {
                if (++triangles % kBatch == 0) m_progress.check();
                const std::int32_t material = instance.material(from.slot);
                const auto emitted = m_materials.emitted(material);
                if (emitted == Vec3f(0.0f)) return;
                if (!(from.target == last)) ++faces;
                last = from.target;
                Triangle triangle{index,
                                  material,
                                  !emitted,
                                  faces - 1,
                                  {{from.corners.begin(), from.corners.end()},
                                   matrices,
                                   emitted.value_or(Vec3f(0.0f)),
                                   from.target}};
                visitor(triangle);
            };
            m_rays.triangles(index, one);
        }
    }

    void measure() {
        std::size_t uneven = 0;
        visit([&uneven](const Triangle& triangle) { uneven += triangle.is_uneven ? 1 : 0; });
        const std::size_t every = uneven / kMostAsked + 1;
        m_places = static_cast<std::uint32_t>(
            std::clamp(kPlaces / std::max<std::size_t>(uneven, 1), kFewestPlaces, kMostPlaces));
        visit([this, every](const Triangle& triangle) {
            if (triangle.face == m_faces.size()) m_faces.emplace_back();
            Face& face = m_faces.back();
            const float area = area_of(triangle.shape);
            face.area += area;
            face.power += area * mean_size(triangle.shape.radiance);
            ++face.triangles;
            if (triangle.is_uneven && m_uneven[triangle.material].seen++ % every == 0)
                ask(triangle);
        });
        for (auto& [material, of] : m_uneven) {
            deliver(of);
            of.seen = 0;
        }
        if (every == 1) return;
        visit([this, every](const Triangle& triangle) {
            if (!triangle.is_uneven) return;
            Uneven& of = m_uneven[triangle.material];
            if (of.seen++ % every != 0)
                m_faces[triangle.face].power += area_of(triangle.shape) * of.mean();
        });
    }

    /// From all around before it and behind it in turns, textures filtered so far that nothing lies
    /// between.
    void ask(const Triangle& triangle) {
        const float time = m_scene.options.frame_time;
        const TriangleLight::Corners corners = triangle.shape.placed(time);
        const Vec3f a = corners[1] - corners[0], b = corners[2] - corners[0];
        const Vec3f across = glm::cross(a, b);
        const float doubled = glm::length(across);
        if (!(doubled > 0.0f) || !std::isfinite(doubled)) return;
        Uneven& uneven = m_uneven[triangle.material];
        if (!uneven.pattern) uneven.pattern = m_patterns.of_surface(triangle.material, m_rays);
        const float size = std::sqrt(doubled);
        const SobolPoints places(triangle.face), ways(mix_bits(triangle.face + 1));
        const Basis axes(across / doubled);
        for (std::uint32_t i = 0; i < m_places; ++i) {
            const Vec2f u = places(i);
            const float root = std::sqrt(u.x);
            const Vec3f at = corners[0] + root * ((1.0f - u.y) * a + u.y * b);
            const Vec3f way = axes.to_world(sample_cosine_hemisphere(ways(i)));
            const Vec3f out = i % 2 == 0 ? way : -way;
            uneven.asked.push_back({-out, size, Vec3f(0.0f), 1.0f});
            uneven.samples.push_back({nullptr, at + size * out, nullptr, time,
                                      triangle.shape.target,
                                      size / std::sqrt(static_cast<float>(m_places))});
            uneven.faces.push_back(triangle.face);
        }
        if (uneven.faces.size() >= kBatch) deliver(uneven);
    }

    void deliver(Uneven& uneven) {
        m_progress.check();
        if (uneven.samples.empty()) return;
        for (std::size_t i = 0; i < uneven.faces.size(); ++i)
            uneven.samples[i].sample = &uneven.asked[i];
        uneven.pattern->color(uneven.samples);
        for (std::size_t i = 0; i < uneven.faces.size(); ++i) {
            const LightSample& asked = uneven.asked[i];
            const float area =
                0.5f * asked.distance * asked.distance / static_cast<float>(m_places);
            const float power = area * mean_size(asked.radiance);
            m_faces[uneven.faces[i]].power += power;
            uneven.power += static_cast<double>(power);
            uneven.area += static_cast<double>(area);
        }
        uneven.asked.clear();
        uneven.samples.clear();
        uneven.faces.clear();
    }

    /// The least power of a face that may be lamps, and how many triangles may have just that.
    void choose() {
        std::vector<float> powers;
        for (const Face& face : m_faces)
            if (face.power > 0.0f) powers.insert(powers.end(), face.triangles, face.power);
        if (powers.size() <= kMostFaces) return;
        const auto end = powers.begin() + static_cast<std::ptrdiff_t>(kMostFaces);
        std::ranges::nth_element(powers, end - 1, std::greater<>());
        m_least = *(end - 1);
        m_room = static_cast<std::size_t>(std::count(powers.begin(), end, m_least));
    }

    bool takes(const Face& face) {
        if (!(face.power > 0.0f) || face.power < m_least) return false;
        if (m_least == 0.0f || face.power > m_least) return true;
        if (m_room < face.triangles) return false;
        m_room -= face.triangles;
        return true;
    }

    void make(LampFaces& found) {
        found.m_instances.assign(m_scene.instances.size(), Holds::None);
        for (const auto& [index, matrices] : m_instances) found.m_instances[index] = Holds::All;
        std::unordered_map<std::uint32_t, double> lost, all;  ///< power by instance
        std::size_t decided = 0;
        bool taken = false;
        visit([&](Triangle& triangle) {
            const Face& face = m_faces[triangle.face];
            if (triangle.face == decided) {
                ++decided;
                taken = takes(face);
                if (!taken) found.leave_out(triangle.instance, triangle.shape.target);
                all[triangle.instance] += static_cast<double>(face.power);
                if (!taken) lost[triangle.instance] += static_cast<double>(face.power);
            }
            if (!taken || !(area_of(triangle.shape) > 0.0f)) return;
            std::shared_ptr<const LightPattern> pattern;
            if (triangle.is_uneven) {
                const Uneven& uneven = m_uneven[triangle.material];
                pattern = uneven.pattern;
                triangle.shape.radiance = Vec3f(face.power / face.area + uneven.missed());
            }
            found.m_lamps.emplace_back(std::move(triangle.shape),
                                       m_scene.instances[triangle.instance], std::move(pattern));
        });
        for (const auto& [index, matrices] : m_instances) {
            if (!(lost[index] > 0.0)) continue;
            found.m_instances[index] = Holds::Some;
            name(index, lost[index] / all[index]);
        }
    }

    void name(std::uint32_t index, double lost) const {
        const std::string percent = std::to_string(std::lround(std::ceil(100.0 * lost)));
        const bool bounces = m_scene.options.bounces.most > 0;
        m_report.warn(m_scene.geometry_of(m_scene.instances[index]).name,
                      "shines with more faces than may be lamps: " + percent + " % of its light " +
                          (bounces ? "is found by chance, which is noisier"
                                   : "is seen, but lights nothing without bounces"));
    }

    const Scene& m_scene;
    const RayScene& m_rays;
    const RayMaterials& m_materials;
    const LightPatterns& m_patterns;
    Report& m_report;
    const Progress& m_progress;
    /// Those that shine, and where they are.
    std::vector<std::pair<std::uint32_t, std::shared_ptr<const std::vector<Mat4d>>>> m_instances;
    std::vector<Face> m_faces;
    std::map<std::int32_t, Uneven> m_uneven;  ///< by material
    std::uint32_t m_places = 0;               ///< in which each triangle is asked
    float m_least = 0.0f;
    std::size_t m_room = 0;
};

LampFaces::LampFaces(const Scene& scene, const RayScene& rays, const RayMaterials& materials,
                     const LightPatterns& patterns, Report& report, const Progress& progress) {
    Collector(scene, rays, materials, patterns, report, progress).collect(*this);
}

void LampFaces::leave_out(std::uint32_t instance, const RayTarget& target) {
    std::vector<std::vector<bool>>& out = m_left_out[instance];
    if (out.size() <= target.geometry) out.resize(target.geometry + 1);
    std::vector<bool>& of = out[target.geometry];
    if (of.size() <= target.primitive) of.resize(target.primitive + 1);
    of[target.primitive] = true;
}

bool LampFaces::hold(const RayHit& hit) const {
    if (empty() || m_instances[hit.instance] == Holds::None) return false;
    const auto found = m_left_out.find(hit.instance);
    if (found == m_left_out.end() || hit.target.geometry >= found->second.size()) return true;
    const std::vector<bool>& of = found->second[hit.target.geometry];
    return hit.target.primitive >= of.size() || !of[hit.target.primitive];
}

}  // namespace granita
