// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/shining_faces.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

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
    Collector(const Scene& scene, const RayScene& rays, const RayMaterials& materials,
              Report& report)
        : m_scene(scene), m_rays(rays), m_materials(materials), m_report(report) {
        m_found.instances.assign(scene.instances.size(), false);
    }

    void add(std::uint32_t index) {
        const Instance& instance = m_scene.instances[index];
        const GeometryData& geometry = m_scene.geometry_of(instance);
        auto matrices = std::make_shared<std::vector<Mat4d>>(m_rays.transforms(index));
        if (matrices->empty()) return;  // no ray meets it
        if (geometry.kind != GeometryKind::Mesh)
            return leave_out(geometry, "shines, but is no mesh");
        const std::size_t before = m_found.lamps.size();
        if (before == kMostFaces) return leave_out(geometry, kTooMany);
        bool fits = true;
        m_rays.triangles(index, [&](const RayTriangle& triangle) {
            const Vec3f radiance = m_materials.emitted(instance.material(triangle.slot));
            if (!fits || radiance == Vec3f(0.0f)) return;
            MovingTriangle moving{{triangle.corners.begin(), triangle.corners.end()},
                                  matrices,
                                  radiance,
                                  triangle.target};
            if (!is_seen(moving)) return;
            fits = m_found.lamps.size() < kMostFaces;
            if (fits) m_found.lamps.emplace_back(std::move(moving), instance);
        });
        m_found.instances[index] = fits;
        if (fits) return;
        m_found.lamps.erase(m_found.lamps.begin() + static_cast<std::ptrdiff_t>(before),
                            m_found.lamps.end());
        leave_out(geometry, kTooMany);
    }

    ShiningFaces take() { return std::move(m_found); }

  private:
    static constexpr const char* kTooMany = "shines with more faces than may be lamps";

    void leave_out(const GeometryData& geometry, const std::string& why) {
        if (m_scene.options.bounces.most > 0) return;
        m_report.warn(geometry.name, why + ": it is seen, but lights nothing without bounces");
    }

    const Scene& m_scene;
    const RayScene& m_rays;
    const RayMaterials& m_materials;
    Report& m_report;
    ShiningFaces m_found;
};

}  // namespace

ShiningFaces shining_faces(const Scene& scene, const RayScene& rays, const RayMaterials& materials,
                           Report& report, const Progress& progress) {
    Collector collector(scene, rays, materials, report);
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
        if (!materials.shines(scene.instances[i])) continue;
        progress.check();
        collector.add(i);
    }
    return collector.take();
}

}  // namespace granita
