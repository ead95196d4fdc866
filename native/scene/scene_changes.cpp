// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/scene_changes.h"

#include <algorithm>

namespace granita {
namespace {

bool same_film(const Options& a, const Options& b) {
    return a.pixel_filter == b.pixel_filter && a.filter_width == b.filter_width &&
           a.film_transparent == b.film_transparent;
}

bool same_light_samples(const Options& a, const Options& b) {
    return a.light_samples == b.light_samples && a.bounces == b.bounces;
}

bool same_passes(const Options& a, const Options& b) {
    return same_channels(a, b) && a.depth_pass == b.depth_pass &&
           a.pass_alpha_threshold == b.pass_alpha_threshold;
}

/// `options`, but for what other groups than Rest name, which is that of `other`.
Options with_groups_of(Options options, const Options& other) {
    // The number of passes of REGULAR samples goes by the filter.
    if (options.sampling != Sampling::Regular) {
        options.pixel_filter = other.pixel_filter;
        options.filter_width = other.filter_width;
    }
    options.film_transparent = other.film_transparent;
    options.light_samples = other.light_samples;
    options.bounces = other.bounces;
    options.passes = other.passes;
    options.aovs = other.aovs;
    options.mist = other.mist;
    options.depth_pass = other.depth_pass;
    options.pass_alpha_threshold = other.pass_alpha_threshold;
    return options;
}

/// Whether there is a lens is of Rest, and so is all of one that moves.
bool has_still_lens(const Camera& camera) {
    return camera.projection.has_lens() && !camera.lens.moves();
}

Camera with_groups_of(Camera camera, const Camera& other) {
    if (!has_still_lens(camera) || !has_still_lens(other)) return camera;
    camera.projection.lens_radius = other.projection.lens_radius;
    camera.projection.lens_ratio = other.projection.lens_ratio;
    camera.projection.focus = other.projection.focus;
    camera.blades = other.blades;
    camera.blade_rotation = other.blade_rotation;
    return camera;
}

Instance with_groups_of(Instance instance, const Instance& other) {
    instance.visible_diffuse = other.visible_diffuse;
    instance.visible_glossy = other.visible_glossy;
    instance.visible_transmission = other.visible_transmission;
    instance.visible_volume = other.visible_volume;
    instance.casts_shadow = other.casts_shadow;
    instance.receives = other.receives;
    instance.blocks = other.blocks;
    instance.receiver_set = other.receiver_set;
    instance.blocker_set = other.blocker_set;
    return instance;
}

part::Set changes_of(const std::vector<Instance>& before, const std::vector<Instance>& now) {
    if (before.size() != now.size()) return part::kRest;
    part::Set found = 0;
    for (std::size_t i = 0; i < now.size(); ++i) {
        if (before[i] == now[i]) continue;
        found |= with_groups_of(before[i], now[i]) == now[i] ? part::kRays : part::kRest;
    }
    return found;
}

}  // namespace

bool same_channels(const Options& a, const Options& b) {
    return a.passes == b.passes && a.aovs == b.aovs && a.mist == b.mist;
}

SceneChanges::SceneChanges(const Scene& before, const Scene& now)
    : materials(now.materials.size(), false) {
    const auto note = [this](bool is_same, part::Set what) { parts |= is_same ? 0 : what; };
    note(same_film(before.options, now.options), part::kFilm);
    note(same_light_samples(before.options, now.options), part::kLightSamples);
    note(same_passes(before.options, now.options), part::kPasses);
    note(with_groups_of(before.options, now.options) == now.options, part::kRest);
    const bool same_camera = before.camera == now.camera;
    note(same_camera, part::kLens);
    // A lens decides which points are seen, and these get more ways (shade/seen_points.h).
    note(same_camera || now.options.bounces.most == 0, part::kLightSamples);
    note(with_groups_of(before.camera, now.camera) == now.camera, part::kRest);
    note(before.lights == now.lights && before.world == now.world, part::kLights);
    note(before.receives_in_volumes == now.receives_in_volumes, part::kRays);
    note(before.instance_values == now.instance_values, part::kRest);
    parts |= changes_of(before.instances, now.instances);
    note(before.geometries.size() == now.geometries.size(), part::kRest);
    for (std::size_t g = 0; g < std::min(before.geometries.size(), now.geometries.size()); ++g)
        note(&before.geometries[g] == &now.geometries[g], part::kRest);
    note(before.materials.size() == now.materials.size(), part::kRest);
    for (std::size_t m = 0; m < std::min(before.materials.size(), now.materials.size()); ++m) {
        materials[m] = before.materials[m] != now.materials[m];
        note(!materials[m], part::kMaterials);
        note(before.materials[m].holdout == now.materials[m].holdout, part::kRest);
    }
    if (before.images == now.images && before.working_space == now.working_space) return;
    // Of an image it is not known here who shows it: the world may.
    parts |= part::kMaterials | part::kLights;
    materials.assign(materials.size(), true);
}

}  // namespace granita
