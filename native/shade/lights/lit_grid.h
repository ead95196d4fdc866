// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "math/luminance.h"
#include "shade/bsdf/reflection.h"
#include "shade/lights/environment_samples.h"
#include "shade/lights/lamp_sight.h"
#include "shade/lights/light_source.h"
#include "shade/lights/lit_point.h"
#include "shade/lights/lobe_ray.h"
#include "shade/lights/part_rays.h"

namespace granita {

class Lamp;

/// A lamp that a sample of a lobe has met.
struct MetLamp {
    const LitPoint* point;
    const Lamp* lamp;
    LitPlace place;
    LightSample sample;
    BsdfValue weight;  ///< of the sample's radiance, were nothing between
    RayType ray;       ///< that the lobe sends there
    float sign;        ///< as LitGrid::sign
    float whole;  ///< how many times as much a sample of all lobes, taken by chance, would have
    Vec3f through{0.0f};  ///< of the light, what passes what is between
};

/// What a grid's points share while they are lit.
struct LitGrid {
    std::vector<Vec3f>& radiance;
    ReflectionParts* parts = nullptr;  ///< nullptr = not asked for
    /// By the world's density, by lobes, by mirrors.
    EnvironmentSamples blurred{}, met{}, through{}, sharp{};
    std::vector<Vec2f> lamp_points{};         ///< of the lamp and point at hand
    std::vector<LightSample> lamp_samples{};  ///< there
    std::vector<MetLamp> met_lamps{};         ///< whose nodes are still to be asked
    std::uint64_t seed = 0;
    bool by_lobe = false;     ///< as WorldEvaluator::by_lobe
    std::size_t columns = 0;  ///< as ShadingPoints::columns
    bool alone = false;       ///< points tell nothing of each other: of tubes and whole faces too
    bool placed = false;      ///< points go by places in the frame's sequences, as samples do
    std::vector<SobolPoints> sequences = {};  ///< [dimensions] as far as they were asked for
    std::uint64_t receives = ~0ULL;           ///< Instance::receives
    int depth = 0;           ///< surfaces, and places in media, between it and the camera
    bool in_medium = false;  ///< its lobes are phase functions
    std::uint64_t shadow_rays = 0, occlusion_rays = 0;
    std::uint64_t lamps_chosen = 0, light_nodes = 0;
    /// [points] the luminance of a point's even samples less that of its odd ones: as much as its
    /// sum is in doubt.  nullptr: not asked for.
    std::vector<float>* balance = nullptr;
    LeavingRays* leaving = nullptr;  ///< to other surfaces; nullptr: not asked for
    LampSight* sight = nullptr;      ///< of the lamp at hand; nullptr: not asked for

    /// The types of ray that its lobes send, but for sharp ones, to a point's own side of the
    /// surface or through it.
    const PartRays& blurred_rays(bool goes_through) const {
        return in_medium ? kScattered : goes_through ? kBlurredThrough : kBlurred;
    }

    /// Of sample `s` of `count` which the point takes alike; one alone is in no doubt.
    static float sign(int s, int count) { return count < 2 ? 0.0f : s % 2 == 0 ? 1.0f : -1.0f; }
    void add(std::size_t point, const Vec3f& light, float sign) {
        radiance[point] += light;
        if (balance) (*balance)[point] += sign * luminance(light);
    }
    /// Of a lamp that a lobe has met; `whole`: as MetLamp's.
    void add_met(std::size_t point, const Vec3f& light, float sign, float whole) {
        if (!tells_met()) return add(point, light, sign);
        leaving->met.push_back({static_cast<std::uint32_t>(point), light, whole});
    }

    /// A sequence that the grid shares, from its sample `first` on.
    SobolPoints sequence(std::size_t dimension, std::uint32_t first) {
        while (sequences.size() <= dimension) {
            const std::uint64_t own = seed + 0x9e3779b97f4a7c15ULL * (sequences.size() + 1);
            sequences.emplace_back(own);
            if (placed) sequences.back() = sequences.back().shuffled(mix_bits(own));
        }
        return sequences[dimension].from(first);
    }
    /// A point's `count` samples of it.  Each point takes as many as it uses: if all left out the
    /// ends of equal runs, all would miss the same strata.
    SobolPoints sequence(const LitPoint& point, std::size_t dimension, int count) {
        return sequence(dimension, point.place * static_cast<std::uint32_t>(count));
    }
    /// In [0, 1), of a place in a lobe's sequence.
    float chance(std::uint32_t place, std::size_t lobe) const {
        const std::uint64_t at = static_cast<std::uint64_t>(lobe) << 32 | place;
        return unit_float(mix_bits(mix_bits(at) + seed));
    }
    /// Light of a lamp: `value` reflected without shadow.
    void add_lamp(std::size_t point, const BsdfValue& value, const Vec3f& shadow) {
        if (!parts) return;
        parts->diffuse[point] += value.diffuse * shadow;
        parts->glossy[point] += value.glossy * shadow;
        parts->transmission[point] += value.transmission * shadow;
        parts->arriving[point] += total(value) * shadow;
        parts->unblocked[point] += total(value);
    }
    /// Asks the world later; `weight` is 0 where nothing can be seen of it.
    void look(EnvironmentSamples& samples, std::size_t point, const Vec3f& direction,
              const BsdfValue& weight, float sign) {
        if (total(weight) == Vec3f(0.0f)) return;
        samples.add(point, direction, total(weight), sign);
        if (parts || by_lobe) samples.parts.push_back(weight);
    }
    /// Light of the world, reflected.
    void reflect_world(std::size_t point, const BsdfValue& value, float sign) {
        add(point, total(value), sign);
        add_world(point, value);
    }
    bool wants_ways_alone() const { return leaving && !leaving->only.empty(); }
    bool wants(std::size_t point) const { return !wants_ways_alone() || leaving->only[point]; }
    bool tells_met() const { return leaving && leaving->tells_met; }
    bool carries_world() const { return leaving && leaving->carries_world(); }
    bool takes_world() const { return leaving && leaving->takes_world; }
    bool shares_world() const { return takes_world() && leaving->diffuse; }
    /// Expected samples a solid angle around `wo` of the point's lobes that are sampled.
    float lobe_density(const LitPoint& point, const Vec3f& wo) const {
        return samples_diffuse() ? point.all_density(wo) : point.meeting_density(wo);
    }
    bool samples_diffuse() const { return !takes_world() || leaving->diffuse; }
    /// Of that the passes alone.
    void add_world(std::size_t point, const BsdfValue& value) {
        if (!parts) return;
        parts->diffuse[point] += value.diffuse;
        parts->glossy[point] += value.glossy;
        parts->transmission[point] += value.transmission;
    }
};

}  // namespace granita
