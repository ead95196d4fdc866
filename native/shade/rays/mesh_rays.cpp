// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/rays/mesh_rays.h"

#include <algorithm>
#include <array>
#include <exception>

#include "shade/rays/build_shape.h"
#include "shade/rays/ray_heights.h"
#include "shade/rays/ray_mesh.h"
#include "shade/rays/set_ray.h"

namespace granita {
namespace {

/// Of a triangle's height: what is met nearer to an edge than this may lie beyond it for samples,
/// whose coordinates are rounded otherwise.
constexpr float kClose = 1e-3f;
/// Of a mesh's extent: by as much rays in its space are rounded, and more.
constexpr float kRounding = 1e-6f;

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

}  // namespace

struct MeshRays::Passing {
    RTCIntersectContext embree;  // first: Embree hands a pointer to it back
    const MeshRays* rays = nullptr;
    std::vector<Hit>* hits = nullptr;
    std::exception_ptr failure;
};

MeshRays::MeshRays(std::shared_ptr<const KeptRayShape> shape, const SharedGeometry& shared,
                   std::function<bool(std::uint32_t face)> lets_through)
    : m_shape(std::move(shape)),
      m_shared(shared),
      m_lets_through(std::move(lets_through)),
      m_extent(std::max(largest_coordinate(shared.frame_box().lo),
                        largest_coordinate(shared.frame_box().hi))) {}

void MeshRays::meet(const Ray& ray, std::vector<std::uint32_t>& patches, Work& work) const {
    work.hits.clear();
    work.beside.clear();
    trace(ray, work.hits);
    for (const Hit& hit : work.hits) add_beside(ray, hit, work.beside);
    for (const Ray& other : work.beside) trace(other, work.hits);
    for (const Hit& hit : work.hits) {
        const auto patch = static_cast<std::uint32_t>(hit.patch - m_shared.patches().data());
        if (patches.empty() || patches.back() != patch) patches.push_back(patch);
    }
}

/// Called for each triangle that a ray may meet; those that let light through are noted and passed.
void MeshRays::note_passing(const RTCFilterFunctionNArguments* arguments) {
    if (arguments->valid[0] != -1) return;
    auto* const passing = reinterpret_cast<Passing*>(arguments->context);
    if (passing->failure) return;
    try {
        const auto* const at = reinterpret_cast<const RTCHit*>(arguments->hit);
        RayHit hit;
        passing->rays->m_shape->shape->locate(at->geomID, at->primID, at->u, at->v, hit);
        if (!passing->rays->m_lets_through(hit.patch->face)) return;
        passing->hits->push_back({hit.patch, hit.uv});
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
    rtcIntersect1(m_shape->built.get(), &passing.embree, &traced);
    if (passing.failure) std::rethrow_exception(passing.failure);
    if (traced.hit.geomID == RTC_INVALID_GEOMETRY_ID) return;
    RayHit hit;
    m_shape->shape->locate(traced.hit.geomID, traced.hit.primID, traced.hit.u, traced.hit.v, hit);
    hits.push_back({hit.patch, hit.uv});
}

/// Parallel rays beyond the edges that a hit lies close to.
void MeshRays::add_beside(const Ray& ray, const Hit& hit, std::vector<Ray>& rays) const {
    const Place place = place_on(*hit.patch, hit.uv);
    std::array<Vec3f, 3> p;
    for (std::size_t i = 0; i < 3; ++i)
        p[i] = m_shared.frame_points()[static_cast<std::size_t>(
            m_shared.data().corner_verts[place.corners[i]])];
    const float area2 = glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
    for (int i = 0; i < 3; ++i) {
        if (i == place.crease) continue;
        const Vec3f &a = p[static_cast<std::size_t>((i + 1) % 3)],
                    &b = p[static_cast<std::size_t>((i + 2) % 3)];
        // The corner's height over the edge is area2 / |b - a|.
        const float close =
            std::min(kClose + kRounding * m_extent * glm::distance(a, b) / area2, 0.5f);
        if (!(place.weights[i] < close)) continue;
        rays.push_back(ray);
        rays.back().start += 2.0f * close * (0.5f * (a + b) - p[static_cast<std::size_t>(i)]);
    }
}

MeshRayStore::MeshRayStore(const Scene& scene, std::shared_ptr<KeptRays> kept,
                           const Progress& progress)
    : m_scene(scene), m_progress(progress), m_kept(std::move(kept)) {}

std::shared_ptr<const KeptRayShape> MeshRayStore::shape(
    std::size_t geometry, const std::shared_ptr<const SharedGeometry>& shared, bool goes_on) {
    Entry* entry;
    {
        const std::lock_guard lock(m_mutex);
        entry = &m_entries[{geometry, goes_on}];
        if (!m_kept) m_kept = std::make_shared<KeptRays>();
    }
    entry->once.call([&] {
        const RayKey key{m_scene.geometries.share(geometry),
                         m_scene.options.frame_time,
                         goes_on ? kGoesOn : kStops,
                         {}};
        entry->shape = goes_on ? m_kept->find(key) : m_kept->find_mesh(key.data.get());
        if (entry->shape) return;
        auto made = std::make_shared<KeptRayShape>();
        made->key = key;
        made->shape = std::make_unique<RayMesh>(shared);
        build_shape(*made, m_kept->device(), {.of_rays = goes_on}, m_progress);
        m_kept->add(made);
        entry->shape = std::move(made);
    });
    return entry->shape;
}

}  // namespace granita
