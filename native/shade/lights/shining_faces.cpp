// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/shining_faces.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "shade/rays/ray_triangles.h"

namespace granita {
namespace {

/// Lamps of a frame: some 300 bytes each, with their part of the tree.
constexpr std::size_t kMostFaces = std::size_t{1} << 18;

/// Whether it has an area at some time.
bool is_seen(const MovingTriangle& triangle) {
    bool any = false;
    triangle.at_knots([&any](const TriangleLight& at) {
        any = any || (at.area() > 0.0f && std::isfinite(at.area()));
    });
    return any;
}

class Collector {
  public:
    Collector(const Scene& scene, const RayScene& rays, const RayMaterials& materials)
        : m_scene(scene), m_rays(rays), m_materials(materials) {
        m_found.instances.assign(scene.instances.size(), false);
    }

    void add(std::uint32_t index) {
        const Instance& instance = m_scene.instances[index];
        auto matrices = std::make_shared<std::vector<Mat4d>>(m_rays.transforms(index));
        if (matrices->empty() || m_scene.geometry_of(instance).kind != GeometryKind::Mesh) return;
        const std::size_t before = m_found.lamps.size();
        m_found.instances[index] = true;
        m_rays.triangles(index, [&](const RayTriangle& triangle) {
            const Vec3f radiance = m_materials.emitted(instance.material(triangle.slot));
            if (radiance == Vec3f(0.0f) || m_found.lamps.size() > kMostFaces) return;
            MovingTriangle moving{
                {triangle.corners.begin(), triangle.corners.end()}, matrices, radiance};
            if (is_seen(moving)) m_found.lamps.emplace_back(std::move(moving), instance);
        });
        if (m_found.lamps.size() <= kMostFaces) return;
        m_found.lamps.erase(m_found.lamps.begin() + static_cast<std::ptrdiff_t>(before),
                            m_found.lamps.end());
        m_found.instances[index] = false;
    }

    ShiningFaces take() { return std::move(m_found); }

  private:
    const Scene& m_scene;
    const RayScene& m_rays;
    const RayMaterials& m_materials;
    ShiningFaces m_found;
};

}  // namespace

ShiningFaces shining_faces(const Scene& scene, const RayScene& rays,
                           const RayMaterials& materials) {
    Collector collector(scene, rays, materials);
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i)
        if (materials.shines(scene.instances[i])) collector.add(i);
    return collector.take();
}

}  // namespace granita
