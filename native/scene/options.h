// SPDX-License-Identifier: GPL-3.0-or-later
// The settings of a frame (docs/scene_snapshot.md, `options`: names are API).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "math/bounds.h"

namespace granita {

enum class Sampling { Independent, Interleaved, Regular };
enum class Device { Auto, Cpu, Gpu };
/// Reference: brute force in double (tests).  Simd: the CPU default.  Raster: the paper's, OpenGL.
/// Compute: the loops of Simd in compute shaders.
enum class Executor { Auto, Reference, Simd, Raster, Compute };
enum class FilterKind {
    Box,
    Tent,
    Gaussian,
    BlackmanHarris,
    Mitchell,
    CatmullRom,
    Lanczos,
    Bspline
};

/// A material's own output, written by AOV Output nodes of that name.
struct Aov {
    std::string name;
    bool is_color = true;  ///< else one number
    bool operator==(const Aov&) const = default;
};

/// Blender's mist: ((distance to the camera - start) / depth) to the power of exponent, in [0, 1].
struct Mist {
    float start = 5.0f, depth = 25.0f, exponent = 2.0f;
    bool operator==(const Mist&) const = default;
};

/// How far light is followed from surface to surface, as Cycles' Light Paths.
struct Bounces {
    int most = 0;  ///< 0: surfaces are lit by lamps and the world alone
    int diffuse = 4, glossy = 4, transmission = 12;  ///< of these, by what reflects
    int volume = 0;                                  ///< of these, in media, beside the first
    int transparent = 8;  ///< surfaces passed through unbent, which are no bounces
    /// Whether glossy lobes send on what reaches diffuse ones: mirrored, and through them.
    bool reflective_caustics = true, refractive_caustics = true;
    float filter_glossy = 1.0f;  ///< how much blurrier they are for ways that few take; 0 = none
    float clamp = 10.0f;  ///< most that a path brings, red, green and blue summed; 0 = no end
    /// As Cycles' Fast GI, Replace: from this one on what bounces is the world's light, as far as
    /// nothing within `occlusion_distance` metres hides it; 0 = never.
    int occluded_from = 0;
    float occlusion_distance = 10.0f;
    float occlusion_factor = 1.0f;  ///< how much of the world's light then
    /// As Fast GI, Add: what diffuse lobes reflect as well of white light of this radiance, as far
    /// as nothing within that distance hides it.
    float occlusion_added = 0.0f;
    /// Whether rays that leave a surface bring more than what shines where they end.
    bool goes_on() const {
        const bool any_kind = diffuse > 0 || glossy > 0 || transmission > 0 || volume > 0;
        return most > 0 && (any_kind || occluded_from > 0 || occlusion_added > 0.0f);
    }
    bool operator==(const Bounces&) const = default;
};

struct Options {
    int width = 0, height = 0;  ///< full frame, pixels
    Rect crop;                  ///< what is rendered, inside the frame
    int frame = 0;
    int samples = 64;
    /// Error of displayed colour (film/tile_noise.h) below which a tile takes no more samples; 0 =
    /// every pixel takes `samples`.
    float noise_threshold = 0.0f;
    int min_samples = 16;  ///< that every pixel takes at least, where noise_threshold is above 0
    Sampling sampling = Sampling::Independent;
    int time_samples = 0;
    FilterKind pixel_filter = FilterKind::BlackmanHarris;
    float filter_width = 1.5f;
    float dicing_rate = 1.0f, shading_rate = 0.0f;
    /// How much coarser what moves or is out of focus is diced (dice/edge_rate.h); 0 = no coarser.
    float motion_factor = 1.0f, focus_factor = 1.0f;
    int grid_size = 256;
    int bucket_size = 64;
    /// Transparent grids after which samples are looked through for saturation; that the raster
    /// executor peels together.
    int z_batch_size = 26;
    float opacity_threshold = 0.996f;
    /// MiB of transparent samples' lists, in all threads together: buckets that want more of it are
    /// rendered in parts.
    int list_memory = 1024;
    /// MiB that the process may hold, Blender's included, before the frame is given up; 0 = no end.
    /// Textures and lists of samples have a quarter of it each.
    int memory = 0;
    std::uint32_t seed =
        0;  ///< of the sample table, the frame already mixed in where animate_seed is on
    int light_samples = 16;  ///< shadow rays a light and shading point, for lights with a size
    Bounces bounces;
    /// Bend of displayed colour between neighbouring shading points (shade/unsettled.h) from which
    /// on samples are shaded by themselves, for 64 samples a pixel; in proportion to samples^-1/2.
    float shading_threshold = 0.06f;
    bool refine_samples = true;  ///< false: none are shaded by themselves
    Device device = Device::Auto;
    Executor executor = Executor::Auto;  ///< overrides device; tests and benches
    int threads = 0;                     ///< 0 = all
    bool film_transparent = false;
    bool depth_pass = false;
    std::vector<std::string> passes;  ///< names of scene/channels.h
    std::vector<Aov> aovs;
    /// Passes of the first surface pass through those whose mean opacity is less.
    float pass_alpha_threshold = 0.0f;
    Mist mist;
    float frame_time =
        0.5f;  ///< shutter time of Blender's frame: 0, 1/2 or 1; shading happens there
    std::vector<float> shutter_curve;  ///< opening over t in [0, 1], equidistant; empty = box
    /// Rolling shutter, top row first: the part of the shutter in which one row is exposed, 0 to 1.
    /// Negative = all rows at once.
    float rolling_shutter = -1.0f;

    /// Part of the shutter in which one row is exposed.
    float row_exposure() const { return rolling_shutter >= 0.0f ? rolling_shutter : 1.0f; }
    bool operator==(const Options&) const = default;
};

}  // namespace granita
