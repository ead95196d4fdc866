// SPDX-License-Identifier: GPL-3.0-or-later
// Subsurface Scattering, and what of it Principled shares.  Blender 4 renamed the methods: what was
// Random Walk is Random Walk (Skin), and what took the radius as it is became Random Walk; ways
// into the medium are refracted since.  5.2 renamed that one Random Walk (Legacy), and its Random
// Walk takes the radius for the whole mean free path: not reduced, and not the reach of a profile.
#include "shade/nodes/subsurface.h"

#include <algorithm>

#include "shade/bsdf/scattering_medium.h"
#include "shade/nodes/nodes.h"
#include "shade/nodes/scalar_math.h"

namespace granita {

void set_subsurface_method(NodeBuilder& b, SubsurfaceSource& lobe, const char* property) {
    const std::string method = b.text(property, "RANDOM_WALK");
    const bool first = !b.since(4, 0);
    const bool skin = method == (first ? "RANDOM_WALK" : "RANDOM_WALK_SKIN");
    const bool whole = b.since(5, 2) && method == "RANDOM_WALK";
    lobe.walks = method != "BURLEY";
    lobe.after_diffuse = b.since(5, 0) && lobe.walks;
    lobe.is_bent = b.linked("Normal");
    if (!first && lobe.walks)
        lobe.entry = skin ? SubsurfaceEntry::Mixed : SubsurfaceEntry::Refracted;
    lobe.ior = b.map<float>([](float ior) { return std::clamp(ior, 1.01f, 3.8f); }, lobe.ior);
    const float least = b.since(5, 2) ? -0.99f : 0.0f, most = whole ? 0.99f : 0.9f;
    lobe.anisotropy =
        b.map<float>([=](float g) { return std::clamp(g, least, most); }, lobe.anisotropy);
    const float share = whole ? 1.0f : kMeanFreeShareOfReach;
    lobe.radius = b.map<Vec3f>(
        [=](const Vec3f& radius, const Vec3f& albedo, float ior, float g) {
            Vec3f path = glm::max(radius, Vec3f(0.0f));
            for (int c = 0; c < 3; ++c) path[c] *= skin ? mean_free_share(albedo[c], ior) : share;
            return whole || g < 0.0f ? path / (1.0f - g) : path;
        },
        lobe.radius, lobe.albedo, lobe.ior, lobe.anisotropy);
}

void build_subsurface(NodeBuilder& b, SurfaceBuilder& surface, const FloatSource& weight) {
    SubsurfaceSource lobe;
    lobe.albedo = b.map<Vec3f>([](const Vec3f& c) { return glm::max(c, Vec3f(0.0f)); },
                               b.color("Color", Vec3f(0.8f)));
    lobe.weight = scaled(b, lobe.albedo, weight);
    lobe.normal = b.specular_normal();
    lobe.radius = scaled(b, b.vector("Radius", Vec3f(1.0f, 0.2f, 0.1f)), b.number("Scale", 1.0f));
    // Cycles squares Principled's alone.
    lobe.alpha = b.map<float>(saturate, b.number("Roughness", 1.0f));
    lobe.ior = b.number("IOR", 1.4f);
    lobe.anisotropy = b.number("Anisotropy");
    set_subsurface_method(b, lobe, "falloff");
    surface.add_subsurface(lobe);
}

}  // namespace granita
