// SPDX-License-Identifier: GPL-3.0-or-later
// Fresnel and Layer Weight: how much a surface turns its edge to the viewer.
#include "shade/bsdf/fresnel.h"

#include <algorithm>
#include <cmath>

#include "shade/nodes/nodes.h"

namespace granita {

void build_fresnel(NodeBuilder& b) {
    b.output("Fac", b.map<float>(
                        [](float ior, const Vec3f& n, const Vec3f& view, float back) {
                            const float eta = std::max(ior, 1e-5f);
                            return fresnel_dielectric(glm::dot(view, n),
                                                      back != 0.0f ? 1.0f / eta : eta);
                        },
                        b.number("IOR", 1.45f), b.normal_input(), b.view(), b.backfacing()));
}

void build_layer_weight(NodeBuilder& b) {
    const FloatSource blend = b.number("Blend", 0.5f);
    const VectorSource normal = b.normal_input(), view = b.view();
    b.output("Fresnel", b.map<float>(
                            [](float x, const Vec3f& n, const Vec3f& v, float back) {
                                const float eta = std::max(1.0f - x, 1e-5f);
                                return fresnel_dielectric(glm::dot(v, n),
                                                          back != 0.0f ? eta : 1.0f / eta);
                            },
                            blend, normal, view, b.backfacing()));
    b.output("Facing", b.map<float>(
                           [](float x, const Vec3f& n, const Vec3f& v) {
                               float facing = std::abs(glm::dot(v, n));
                               if (x != 0.5f) {
                                   const float t = std::clamp(x, 0.0f, 1.0f - 1e-5f);
                                   const float power = t < 0.5f ? 2.0f * t : 0.5f / (1.0f - t);
                                   facing = std::pow(facing, power);
                               }
                               return 1.0f - facing;
                           },
                           blend, normal, view));
}

}  // namespace granita
