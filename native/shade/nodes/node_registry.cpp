// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/nodes/node_registry.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <string_view>

#include "shade/nodes/nodes.h"

namespace granita {

namespace {

std::map<std::string, NodeKind> all_kinds() {
    const auto value = [](void (*build)(NodeBuilder&)) {
        return NodeKind{build, nullptr, nullptr};
    };
    const auto pattern = [](void (*build)(NodeBuilder&)) {
        return NodeKind{build, nullptr, nullptr, true};
    };
    const auto closure = [](auto* build) { return NodeKind{nullptr, build, nullptr}; };
    const auto flat = NodeKind{build_flat_texture, nullptr, "a flat grey, its mean"};
    const auto like_diffuse = NodeKind{nullptr, build_diffuse, "Diffuse BSDF"};
    return {
        {"ShaderNodeEmission", closure(build_emission)},
        {"ShaderNodeBackground", closure(build_background)},
        {"ShaderNodeBsdfPrincipled", closure(build_principled)},
        {"ShaderNodeBsdfDiffuse", closure(build_diffuse)},
        {"ShaderNodeBsdfGlossy", closure(build_glossy)},
        {"ShaderNodeBsdfAnisotropic", closure(build_glossy)},
        {"ShaderNodeBsdfMetallic", closure(build_metallic)},
        {"ShaderNodeSubsurfaceScattering", closure(build_subsurface)},
        {"ShaderNodeBsdfTranslucent", closure(build_translucent)},
        {"ShaderNodeBsdfSheen", closure(build_sheen)},
        {"ShaderNodeBsdfVelvet", closure(build_velvet)},
        {"ShaderNodeBsdfToon", closure(build_toon)},
        {"ShaderNodeBsdfHair", closure(build_hair)},
        {"ShaderNodeBsdfHairPrincipled", closure(build_principled_hair)},
        {"ShaderNodeBsdfGlass", closure(build_glass)},
        {"ShaderNodeBsdfRefraction", closure(build_refraction)},
        {"ShaderNodeBsdfTransparent", closure(build_transparent)},
        {"ShaderNodeHoldout", closure(build_holdout)},
        {"ShaderNodeMixShader", closure(build_mix_shader)},
        {"ShaderNodeAddShader", closure(build_add_shader)},

        {"ShaderNodeVolumeAbsorption", closure(build_volume_absorption)},
        {"ShaderNodeVolumeScatter", closure(build_volume_scatter)},
        {"ShaderNodeVolumeCoefficients", closure(build_volume_coefficients)},
        {"ShaderNodeVolumePrincipled", closure(build_principled_volume)},

        {"ShaderNodeValue", value(build_value)},
        {"ShaderNodeRGB", value(build_rgb)},
        {"ShaderNodeTexImage", value(build_image_texture)},
        {"ShaderNodeTexEnvironment", value(build_environment_texture)},
        {"ShaderNodeUVMap", value(build_uv_map)},
        {"ShaderNodeTexCoord", value(build_texture_coordinate)},
        {"ShaderNodeNewGeometry", value(build_geometry)},
        {"ShaderNodeMapping", value(build_mapping)},
        {"ShaderNodeMixRGB", value(build_mix_rgb)},
        {"ShaderNodeMix", value(build_mix)},
        {"ShaderNodeMath", pattern(build_math)},
        {"FunctionNodeIntegerMath", pattern(build_integer_math)},
        {"FunctionNodeBooleanMath", pattern(build_boolean_math)},
        {"FunctionNodeGetVectorComponent", value(build_vector_component)},
        {"GeometryNodeInputSceneTime", value(build_scene_time)},
        {"ShaderNodeVectorMath", pattern(build_vector_math)},
        {"ShaderNodeMapRange", pattern(build_map_range)},
        {"ShaderNodeClamp", value(build_clamp)},
        {"ShaderNodeValToRGB", pattern(build_color_ramp)},
        {"ShaderNodeRGBCurve", value(build_rgb_curves)},
        {"ShaderNodeNormalMap", value(build_normal_map)},
        {"ShaderNodeBump", value(build_bump)},
        {"ShaderNodeDisplacement", value(build_displacement)},
        {"ShaderNodeVectorDisplacement", value(build_vector_displacement)},
        {"ShaderNodeAttribute", value(build_attribute)},
        {"ShaderNodeVertexColor", value(build_color_attribute)},
        {"ShaderNodeSeparateColor", value(build_separate_color)},
        {"ShaderNodeCombineColor", value(build_combine_color)},
        {"ShaderNodeSeparateRGB", value(build_separate_color)},
        {"ShaderNodeCombineRGB", value(build_combine_color)},
        {"ShaderNodeSeparateHSV", value(build_separate_color)},
        {"ShaderNodeCombineHSV", value(build_combine_color)},
        {"ShaderNodeSeparateXYZ", value(build_separate_xyz)},
        {"ShaderNodeCombineXYZ", value(build_combine_xyz)},
        {"ShaderNodeGamma", value(build_gamma)},
        {"ShaderNodeInvert", value(build_invert)},
        {"ShaderNodeBrightContrast", value(build_bright_contrast)},
        {"ShaderNodeHueSaturation", value(build_hue_saturation)},
        {"ShaderNodeRGBToBW", value(build_rgb_to_bw)},
        {"ShaderNodeFresnel", value(build_fresnel)},
        {"ShaderNodeLayerWeight", value(build_layer_weight)},
        {"ShaderNodeLightPath", value(build_light_path)},
        {"ShaderNodeObjectInfo", value(build_object_info)},
        {"ShaderNodeHairInfo", value(build_hair_info)},
        {"ShaderNodePointInfo", value(build_point_info)},
        {"ShaderNodeLightFalloff", value(build_light_falloff)},
        {"ShaderNodeAmbientOcclusion", value(build_ambient_occlusion)},
        {"ShaderNodeWireframe", value(build_wireframe)},
        {"ShaderNodeParticleInfo", value(build_particle_info)},
        {"ShaderNodeCameraData", value(build_camera_data)},
        {"ShaderNodeTexChecker", pattern(build_checker)},
        {"ShaderNodeTexGradient", value(build_gradient)},
        {"ShaderNodeTexNoise", pattern(build_noise_texture)},
        {"ShaderNodeTexMusgrave", pattern(build_musgrave_texture)},
        {"ShaderNodeTexVoronoi", pattern(build_voronoi_texture)},
        {"ShaderNodeTexWave", pattern(build_wave_texture)},
        {"ShaderNodeTexMagic", pattern(build_magic_texture)},
        {"ShaderNodeTexBrick", pattern(build_brick_texture)},
        {"ShaderNodeTexGabor", pattern(build_gabor_texture)},
        {"ShaderNodeTexWhiteNoise", pattern(build_white_noise_texture)},
        {"ShaderNodeTexSky", value(build_sky_texture)},
        {"ShaderNodeTexIES", value(build_ies_texture)},
        {"ShaderNodeVectorCurve", value(build_vector_curves)},
        {"ShaderNodeFloatCurve", value(build_float_curve)},
        {"ShaderNodeVectorRotate", value(build_vector_rotate)},
        {"ShaderNodeVectorTransform", value(build_vector_transform)},
        {"ShaderNodeNormal", value(build_normal)},
        {"ShaderNodeTangent", value(build_tangent)},
        {"ShaderNodeBlackbody", value(build_blackbody)},
        {"ShaderNodeWavelength", value(build_wavelength)},

        {"ShaderNodeBevel", NodeKind{build_unbevelled, nullptr, "its normal, unbevelled"}},

        {"ShaderNodeTexPointDensity", flat},

        {"ShaderNodeEeveeSpecular", like_diffuse},
    };
}

}  // namespace

const NodeKind* find_node_kind(const std::string& type) {
    static const std::map<std::string, NodeKind> kKinds = all_kinds();
    const auto found = kKinds.find(type);
    return found == kKinds.end() ? nullptr : &found->second;
}

bool makes_pattern(const NodeKind& kind, const Node& node) {
    static constexpr std::string_view kJumping[] = {
        "LESS_THAN", "GREATER_THAN", "COMPARE", "SIGN",     "ROUND",   "FLOOR",
        "CEIL",      "TRUNC",        "FRACT",   "FRACTION", "MODULO",  "WRAP",
        "SNAP",      "PINGPONG",     "SINE",    "COSINE",   "TANGENT", "FLOORED_MODULO"};
    if (!kind.is_pattern) return false;
    if (node.type == "ShaderNodeValToRGB") return node.text("interpolation") == "CONSTANT";
    if (node.type == "ShaderNodeMapRange") return node.text("interpolation_type") == "STEPPED";
    const std::string operation = node.text("operation");
    return operation.empty() || std::ranges::find(kJumping, operation) != std::end(kJumping);
}

}  // namespace granita
