// SPDX-License-Identifier: GPL-3.0-or-later
// The build functions of all nodes, one file a node or a family; node_registry.cpp names them.
#pragma once

#include "shade/programs/surface_builder.h"

namespace granita {

// closures
void build_emission(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_background(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_diffuse(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_glossy(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_metallic(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_subsurface(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_translucent(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_sheen(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_velvet(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_holdout(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_toon(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_hair(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_principled_hair(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_glass(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_refraction(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_transparent(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_mix_shader(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_add_shader(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_principled(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_volume_absorption(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_volume_scatter(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_volume_coefficients(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);
void build_principled_volume(NodeBuilder&, SurfaceBuilder&, const FloatSource& weight);

// values
void build_image_texture(NodeBuilder&);
void build_environment_texture(NodeBuilder&);
void build_uv_map(NodeBuilder&);
void build_texture_coordinate(NodeBuilder&);
void build_geometry(NodeBuilder&);
void build_mapping(NodeBuilder&);
void build_mix_rgb(NodeBuilder&);
void build_mix(NodeBuilder&);
void build_math(NodeBuilder&);
void build_vector_math(NodeBuilder&);
void build_map_range(NodeBuilder&);
void build_clamp(NodeBuilder&);
void build_color_ramp(NodeBuilder&);
void build_rgb_curves(NodeBuilder&);
void build_normal_map(NodeBuilder&);
void build_bump(NodeBuilder&);
void build_displacement(NodeBuilder&);
void build_vector_displacement(NodeBuilder&);
void build_attribute(NodeBuilder&);
void build_color_attribute(NodeBuilder&);
void build_value(NodeBuilder&);
void build_scene_time(NodeBuilder&);
void build_integer_math(NodeBuilder&);
void build_boolean_math(NodeBuilder&);
void build_vector_component(NodeBuilder&);
void build_rgb(NodeBuilder&);
void build_separate_color(NodeBuilder&);
void build_combine_color(NodeBuilder&);
void build_separate_xyz(NodeBuilder&);
void build_combine_xyz(NodeBuilder&);
void build_gamma(NodeBuilder&);
void build_invert(NodeBuilder&);
void build_bright_contrast(NodeBuilder&);
void build_hue_saturation(NodeBuilder&);
void build_rgb_to_bw(NodeBuilder&);
void build_fresnel(NodeBuilder&);
void build_layer_weight(NodeBuilder&);
void build_light_path(NodeBuilder&);
void build_light_falloff(NodeBuilder&);
void build_ambient_occlusion(NodeBuilder&);
void build_wireframe(NodeBuilder&);
void build_particle_info(NodeBuilder&);
void build_gabor_texture(NodeBuilder&);
void build_object_info(NodeBuilder&);
void build_hair_info(NodeBuilder&);
void build_point_info(NodeBuilder&);
void build_camera_data(NodeBuilder&);
void build_checker(NodeBuilder&);
void build_gradient(NodeBuilder&);
void build_sky_texture(NodeBuilder&);
void build_noise_texture(NodeBuilder&);
void build_musgrave_texture(NodeBuilder&);
void build_white_noise_texture(NodeBuilder&);
void build_voronoi_texture(NodeBuilder&);
void build_wave_texture(NodeBuilder&);
void build_magic_texture(NodeBuilder&);
void build_brick_texture(NodeBuilder&);
void build_ies_texture(NodeBuilder&);
void build_flat_texture(NodeBuilder&);
void build_vector_curves(NodeBuilder&);
void build_float_curve(NodeBuilder&);
void build_vector_rotate(NodeBuilder&);
void build_vector_transform(NodeBuilder&);
void build_normal(NodeBuilder&);
void build_tangent(NodeBuilder&);
void build_blackbody(NodeBuilder&);
void build_wavelength(NodeBuilder&);
void build_unbevelled(NodeBuilder&);

/// By a number, linear between the entries of the property `spectrum` (rgb), which lie evenly from
/// `low` to `high`.
VectorSource spectrum_color(NodeBuilder&, const char* input);
/// The shading normal bent by a displacement at the point and beside it along u and v.
VectorSource bumped_by_displacement(NodeBuilder&, const VectorSource& here,
                                    const VectorSource& next_u, const VectorSource& next_v);

}  // namespace granita
