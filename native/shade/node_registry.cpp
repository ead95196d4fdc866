// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/node_registry.h"

#include <map>

#include "shade/nodes/nodes.h"

namespace granita {

namespace {

std::map<std::string, NodeKind> all_kinds() {
    const auto value = [](void (*build)(NodeBuilder&)) {
        return NodeKind{build, nullptr, nullptr};
    };
    const auto closure = [](auto* build) { return NodeKind{nullptr, build, nullptr}; };
    const auto like_glossy = NodeKind{nullptr, build_glossy, "Glossy BSDF"};
    const auto like_diffuse = NodeKind{nullptr, build_diffuse, "Diffuse BSDF"};
    return {
        {"ShaderNodeEmission", closure(build_emission)},
        {"ShaderNodeBackground", closure(build_background)},
        {"ShaderNodeBsdfDiffuse", closure(build_diffuse)},
        {"ShaderNodeBsdfGlossy", closure(build_glossy)},
        {"ShaderNodeBsdfTransparent", closure(build_transparent)},
        {"ShaderNodeMixShader", closure(build_mix_shader)},
        {"ShaderNodeAddShader", closure(build_add_shader)},

        {"ShaderNodeValue", value(build_value)},
        {"ShaderNodeRGB", value(build_rgb)},

        {"ShaderNodeBsdfGlass", like_glossy},
        {"ShaderNodeBsdfRefraction", like_glossy},
        {"ShaderNodeBsdfAnisotropic", like_glossy},
        {"ShaderNodeBsdfMetallic", like_glossy},
        {"ShaderNodeSubsurfaceScattering", like_diffuse},
        {"ShaderNodeBsdfHair", like_diffuse},
        {"ShaderNodeBsdfHairPrincipled", like_diffuse},
        {"ShaderNodeBsdfSheen", like_diffuse},
        {"ShaderNodeBsdfVelvet", like_diffuse},
        {"ShaderNodeBsdfToon", like_diffuse},
        {"ShaderNodeBsdfTranslucent", like_diffuse},
        {"ShaderNodeEeveeSpecular", like_diffuse},
    };
}

}  // namespace

const NodeKind* find_node_kind(const std::string& type) {
    static const std::map<std::string, NodeKind> kKinds = all_kinds();
    const auto found = kKinds.find(type);
    return found == kKinds.end() ? nullptr : &found->second;
}

}  // namespace granita
