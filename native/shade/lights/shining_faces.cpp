// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/shining_faces.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "shade/rays/ray_triangles.h"

namespace granita {
namespace {

/// Lamps of a frame: some 600 bytes each while the tree is made of them.
constexpr std::size_t kMostFaces = std::size_t{1} << 19;

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

ShiningFaces shining_faces(const Scene& scene, const RayScene& rays, const RayMaterials& materials,
                           Report& report) {
    Collector collector(scene, rays, materials);
    std::vector<std::uint32_t> shining;
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i)
        if (materials.shines(scene.instances[i])) shining.push_back(i);
    for (const std::uint32_t i : shining) collector.add(i);
    ShiningFaces found = collector.take();
    for (const std::uint32_t i : shining) {
        if (found.instances[i] || scene.options.bounces.most > 0) continue;
        const bool is_mesh = scene.geometry_of(scene.instances[i]).kind == GeometryKind::Mesh;
        report.warn(scene.instances[i].name,
                    is_mesh ? "shines with more faces than are lamps: it is seen, but lights "
                              "nothing without bounces"
                            : "shines, but is no mesh: it is seen, but lights nothing without "
                              "bounces");
    }
    return found;
}

}  // namespace granita
