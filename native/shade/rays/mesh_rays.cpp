// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/mesh_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>

#include "math/sampling.h"
#include "scene/knot_time.h"
#include "shade/rays/build_shape.h"
#include "shade/rays/ray_mesh.h"
#include "shade/rays/set_ray.h"

namespace granita {
namespace {

/// Of a triangle's height: where rounding is more, what lies beside it may be passed over.
constexpr float kUnsure = 0.1f;
/// Beyond it there is no side of a triangle any more.
constexpr float kMostOfHeight = 0.5f;

/// RayKey::use of shapes that are built here: that of any other is odd.
constexpr std::uint8_t kStops = 0, kGoesOn = 2;

/// A triangle of a patch and a place on it.
struct Place {
    std::array<std::uint32_t, 3> corners;
    Vec3d weights;
    int crease = -1;  ///< the corner whose opposite edge is within the patch
};

Place place_on(const BasePatch& patch, const Vec2d& uv) {
    const auto& c = patch.corner;
    if (patch.kind == PatchKind::Triangle)
        return {{c[0], c[1], c[2]}, {1.0 - uv.x - uv.y, uv.x, uv.y}};
    if (uv.x > uv.y) return {{c[0], c[1], c[2]}, {1.0 - uv.x, uv.x - uv.y, uv.y}, 1};
    return {{c[0], c[2], c[3]}, {1.0 - uv.y, uv.x, uv.y - uv.x}, 2};
}

/// Parallel rays around one that starts at `at`, `radius` roundings away.
void add_around(const Ray& ray, const Vec3f& at, float radius, const Rounding& rounding,
                std::vector<Ray>& rays) {
    constexpr int kAround = 8;
    const Basis basis(glm::normalize(rounding.to_measured * ray.direction));
    const Mat3f back = glm::inverse(rounding.to_measured);
    for (int step = 0; step < kAround; ++step) {
        const float angle = (static_cast<float>(step) + 0.5f) * 2.0f * kPi / kAround;
        const Vec3f aside = std::cos(angle) * basis.x + std::sin(angle) * basis.y;
        rays.push_back(ray);
        rays.back().start = at + radius * rounding.distance * (back * aside);
    }
}

}  // namespace

struct MeshRays::Passing {
    RTCIntersectContext embree;  // first: Embree hands a pointer to it back
    const MeshRays* rays = nullptr;
    std::vector<Hit>* hits = nullptr;
    std::exception_ptr failure;
};

MeshRays::MeshRays(MeetableMesh mesh, const SharedGeometry& shared,
                   std::function<bool(std::uint32_t face)> lets_through)
    : m_mesh(std::move(mesh)), m_shared(shared), m_lets_through(std::move(lets_through)) {}

void MeshRays::meet(const Ray& ray, const Rounding& rounding, std::vector<std::uint32_t>& patches,
                    Work& work) const {
    work.hits.clear();
    work.beside.clear();
    trace(ray, work.hits);
    for (const Hit& hit : work.hits) add_beside(ray, hit, rounding, work);
    for (const Ray& other : work.beside) trace(other, work.hits);
    for (const Hit& hit : work.hits) {
        if (patches.empty() || patches.back() != hit.patch) patches.push_back(hit.patch);
        if (m_mesh.coincident->empty()) continue;
        const auto others = m_mesh.coincident->of(hit.patch);
        patches.insert(patches.end(), others.begin(), others.end());
    }
}

/// Its shape may have been made with another SharedGeometry of the same mesh.
MeshRays::Hit MeshRays::located(const RTCHit& at) const {
    RayHit hit;
    m_mesh.shape->shape->locate(at.geomID, at.primID, at.u, at.v, hit);
    return {m_shared.first_patch(hit.patch->face) + hit.patch->sub, *hit.patch, hit.uv};
}

/// Called for each triangle that a ray may meet; those that let light through are noted and passed.
void MeshRays::note_passing(const RTCFilterFunctionNArguments* arguments) {
    if (arguments->valid[0] != -1) return;
    auto* const passing = reinterpret_cast<Passing*>(arguments->context);
    if (passing->failure) return;
    try {
        const Hit hit = passing->rays->located(*reinterpret_cast<const RTCHit*>(arguments->hit));
        if (!passing->rays->m_lets_through(hit.at.face)) return;
        passing->hits->push_back(hit);
        arguments->valid[0] = 0;
    } catch (...) {
        passing->failure = std::current_exception();  // thrown on after Embree's frames are left
    }
}

void MeshRays::trace(const Ray& ray, std::vector<Hit>& hits) const {
    if (!ray.is_traceable()) return;
    Passing passing{};
    rtcInitIntersectContext(&passing.embree);
    passing.rays = this;
    passing.hits = &hits;
    if (m_lets_through) passing.embree.filter = note_passing;
    RTCRayHit traced{};
    set_ray(traced.ray, ray);
    traced.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(m_mesh.shape->built.get(), &passing.embree, &traced);
    if (passing.failure) std::rethrow_exception(passing.failure);
    if (traced.hit.geomID != RTC_INVALID_GEOMETRY_ID) hits.push_back(located(traced.hit));
}

/// As Embree goes from knot to knot.
Vec3f MeshRays::point_at(std::size_t vertex, float time) const {
    if (m_shared.is_static()) return m_shared.frame_points()[vertex];
    const KnotTime t = knot_time(double{time}, m_shared.surface_knots());
    const Vec3f from = m_shared.knot_points(static_cast<int>(t.knot))[vertex];
    if (t.fraction == 0.0) return from;
    const Vec3f to = m_shared.knot_points(static_cast<int>(t.knot) + 1)[vertex];
    return from + (to - from) * static_cast<float>(t.fraction);
}

/// Parallel rays beyond the edges that a hit lies close to, and around a corner.
void MeshRays::add_beside(const Ray& ray, const Hit& hit, const Rounding& rounding,
                          Work& work) const {
    const Place place = place_on(hit.at, hit.uv);
    // As the ray sees it: what is rounded moves across the ray.
    const Vec3f way = glm::normalize(rounding.to_measured * ray.direction);
    const auto across = [&](const Vec3f& v) {
        const Vec3f m = rounding.to_measured * v;
        return m - way * glm::dot(way, m);
    };
    std::array<Vec3f, 3> p, measured;
    for (std::size_t i = 0; i < 3; ++i) {
        p[i] = point_at(static_cast<std::size_t>(m_shared.data().corner_verts[place.corners[i]]),
                        ray.time);
        measured[i] = across(p[i]);
    }
    const float area2 =
        glm::length(glm::cross(measured[1] - measured[0], measured[2] - measured[0]));
    bool is_close[3];
    float least_height = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
        // The corner's height over the opposite edge.
        const float height = area2 / glm::distance(measured[j], measured[k]);
        least_height = std::min(least_height, height);
        const float share = std::min(rounding.distance / height, kMostOfHeight);
        is_close[i] = place.weights[static_cast<int>(i)] < share || !(height > 0.0f);
        if (is_close[i] && static_cast<int>(i) != place.crease) {
            work.beside.push_back(ray);
            work.beside.back().start += 2.0f * share * (0.5f * (p[j] + p[k]) - p[i]);
        }
    }
    ++work.met;
    if (!(rounding.distance < kUnsure * least_height)) {
        ++work.unsure;
        for (const float radius : {0.5f, 1.0f, 2.0f})
            add_around(ray, ray.start, radius, rounding, work.beside);
    }
    for (std::size_t i = 0; i < 3; ++i) {
        if (!is_close[(i + 1) % 3] || !is_close[(i + 2) % 3]) continue;
        const Vec3f& d = ray.direction;
        const Vec3f at = p[i] - d * (glm::dot(p[i] - ray.start, d) / glm::dot(d, d));
        add_around(ray, at, 2.0f, rounding, work.beside);
    }
}

RayKey MeshRayStore::key(std::size_t geometry, bool goes_on) const {
    return {m_scene.geometries.share(geometry),
            m_scene.options.frame_time,
            goes_on ? kGoesOn : kStops,
            {}};
}

/// Embree asks to be told that rays bring filters.
std::shared_ptr<const PersistentRayShape> MeshRayStore::find(std::size_t geometry,
                                                             bool goes_on) const {
    const RayKey asked = key(geometry, goes_on);
    return goes_on ? m_kept->find(asked) : m_kept->find_mesh(asked.data.get(), asked.frame_time);
}

MeshRayStore::MeshRayStore(const Scene& scene, std::shared_ptr<PersistentRays> kept,
                           const Progress& progress)
    : m_scene(scene),
      m_progress(progress),
      m_kept(kept ? std::move(kept) : std::make_shared<PersistentRays>()) {
    for (const bool goes_on : {false, true})
        for (std::size_t geometry = 0; geometry < scene.geometries.size(); ++geometry)
            m_was_there[goes_on].push_back(find(geometry, goes_on) != nullptr);
}

/// Seen from anywhere a face shows half of its area, a convex body a quarter of its surface
/// (Cauchy 1841).
double MeshRayStore::layers(std::size_t geometry, const SharedGeometry& shared) {
    const std::lock_guard lock(m_mutex);
    const auto [known, is_new] = m_layers.try_emplace(geometry, 0.0);
    if (!is_new) return known->second;
    double area2 = 0.0;
    for (const BasePatch& patch : shared.patches()) {
        Vec3f p[4];
        for (int i = 0; i < 4; ++i)
            p[i] = shared.frame_points()[static_cast<std::size_t>(
                shared.data().corner_verts[patch.corner[i]])];
        area2 += glm::length(glm::cross(p[2] - p[0], p[3] - p[1]));
    }
    const Vec3f e = shared.frame_box().hi - shared.frame_box().lo;
    const double surface = 2.0 * (e.x * e.y + e.y * e.z + e.z * e.x);
    known->second = area2 / surface;
    return known->second;
}

MeetableMesh MeshRayStore::mesh(std::size_t geometry,
                                const std::shared_ptr<const SharedGeometry>& shared, bool goes_on) {
    Entry* entry;
    {
        const std::lock_guard lock(m_mutex);
        entry = &m_entries[{geometry, goes_on}];
    }
    entry->once.call([&] {
        entry->mesh.coincident = std::make_shared<CoincidentPatches>(*shared);
        entry->mesh.shape = find(geometry, goes_on);
        if (entry->mesh.shape) return;
        auto made = std::make_shared<PersistentRayShape>();
        made->key = key(geometry, goes_on);
        made->shape = std::make_unique<RayMesh>(shared);
        build_shape(*made, m_kept->device(), {.of_rays = goes_on}, m_progress);
        m_kept->add(made);
        entry->mesh.shape = std::move(made);
    });
    return entry->mesh;
}

}  // namespace granita
