// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/subsurface/probe.h"

#include <array>

namespace granita {
namespace {

/// Surfaces that one probe may meet.
constexpr int kMostHits = 16;
constexpr std::array kShares{0.5f, 0.25f, 0.25f};

}  // namespace

void probe(const RayScene& rays, const RayScene::Body& body, const BurleyProfile& profile,
           const Vec3f& p, const Vec3f& normal, float rounding, Vec2f u, std::vector<Probed>& out) {
    out.clear();
    const Basis frame(normal);
    const std::array axes{frame.n, frame.x, frame.y};
    std::size_t axis = 0;
    while (axis < 2 && u.y >= kShares[axis]) u.y -= kShares[axis++];
    const float phi = 2.0f * kPi * u.y / kShares[axis];
    const auto [r, reach] = profile.sample(u.x);
    const Vec3f &x = axes[(axis + 1) % 3], &y = axes[(axis + 2) % 3];
    const Vec3f direction = -axes[axis], foot = p + r * (std::cos(phi) * x + std::sin(phi) * y);
    // Along the probe, from its foot.
    float along = -std::sqrt(std::max(0.0f, reach * reach - r * r)) - rounding;
    const float end = -along;
    RayScene::Met met;
    const RayHit& hit = met.hit;
    for (int k = 0; k < kMostHits && along < end; ++k) {
        const Ray ray{foot + along * direction, direction, end - along, body.time};
        if (!rays.nearest(body, ray, met)) return;
        along += hit.distance;
        std::array<float, 3> found;
        float squares = 0.0f;
        for (std::size_t a = 0; a < 3; ++a) {
            found[a] = kShares[a] * std::abs(glm::dot(axes[a], hit.normal));
            squares += found[a] * found[a];
        }
        const float height = std::abs(along) < rounding ? 0.0f : along;
        const Vec3f weight =
            profile.value(std::hypot(r, height)) * (found[axis] / (squares * profile.density(r)));
        if (is_finite(weight)) out.push_back({met, weight});
        along += 2.0f * rounding + 4.0f * RayOffset::kRounding * reach;
    }
}

}  // namespace granita
