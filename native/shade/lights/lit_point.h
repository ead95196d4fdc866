// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "math/sampling.h"
#include "scene/shutter_warp.h"
#include "shade/bsdf/bsdf.h"
#include "shade/lights/light_motion.h"
#include "shade/rays/ray_scene.h"

namespace granita {

/// A shaded point at one time of the shutter.
struct LitPlace {
    float time = 0.0f;
    Vec3f p{0.0f}, normal{0.0f};  ///< geometric normal
    Vec3f start{0.0f};            ///< of rays

    /// Of rays through the surface.
    Vec3f start_below() const { return 2.0f * p - start; }
    /// Of rays out of a tube whose surface has `outward` where others start: beside the place that
    /// is seen, just past the ribbon through the axis that faces the ray.  Farther on it would be
    /// beyond hairs that lie in this one.
    Vec3f start_around(const Vec3f& outward, const Vec3f& direction, float rounding) const {
        constexpr float kPast = 0.02f, kLeastCosine = 0.05f;
        const float radius =
            glm::dot(start - p, normal) / std::max(glm::dot(outward, normal), kLeastCosine);
        const Vec3f from_axis = p - start + radius * outward;
        const float behind = -glm::dot(from_axis, direction),
                    aside = glm::dot(from_axis, from_axis);
        const float front = glm::dot(normal, direction);
        const float turned = front * front + (aside > 0.0f ? behind * behind / aside : 0.0f);
        const float way = std::max(behind, 0.0f) / std::max(turned, kLeastCosine);
        return p + (way + std::max(kPast * radius, rounding)) * direction;
    }
};

/// A shaded point while it is lit.
struct LitPoint {
    std::size_t index;
    PointBsdf bsdf;
    const PointPaths& paths;
    RayOffset ray_offset;
    LitPlace at_frame;
    int sample_count = 1;       ///< of a soft light, of the world's image, of all lobes together
    std::uint32_t place;        ///< in the grid, along Morton's curve
    Vec2f exposed{0.0f, 1.0f};  ///< the part of the shutter's light that it is there for
    std::span<const float> visible_times;  ///< as ShadingPoints' own; empty: any time of those
    /// As ShadingPoints::rise; nullptr: normals are those of the surface.
    const Vec3f* rise = nullptr;
    float terminator_offset = 0.0f;
    float width = 0.0f;  ///< of what it stands for, metres
    bool round = false;  ///< on a tube, as ShadingPoints::round
    struct LobeSamples {
        int count = 0;            ///< 0 of sharp lobes; of others, where chance leaves them out
        float expected = 0.0f;    ///< mean of that; 0 of sharp lobes alone
        std::uint32_t first = 0;  ///< in the sequence of the lobe
    };
    std::vector<LobeSamples> samples;  ///< [lobes]

    bool is_through(const Vec3f& direction) const {
        return bsdf.transmits() && glm::dot(at_frame.normal, direction) < 0.0f;
    }
    /// Where it is over the shutter.
    Bounds3f reach() const {
        Bounds3f box = paths.reach(index);
        box.add(at_frame.p);
        return box;
    }
    /// One of the times that it is lit for, by a number in [0, 1).
    float time(const ShutterWarp& shutter, float uniform) const {
        if (visible_times.empty())
            return shutter.time(exposed.x + uniform * (exposed.y - exposed.x));
        return one_of(visible_times, uniform);
    }
    /// As lobes weigh, at least one of each; with a number in [0, 1) lobes that are due less than
    /// half a sample take one twice as often as they weigh, by systematic chance over all of them
    /// (Madow 1949).
    void share_samples(std::optional<float> uniform) {
        constexpr float kMore = 2.0f;
        /// Importances are a smooth surface's, which may vanish where a rough one's light does not.
        constexpr float kLeast = 0.125f;
        float at = uniform.value_or(0.0f);
        samples.resize(bsdf.lobe_count());
        for (std::size_t k = 0; k < samples.size(); ++k) {
            if (bsdf.is_sharp(k)) continue;
            LobeSamples& own = samples[k];
            const float due = bsdf.importance(k) * static_cast<float>(sample_count);
            own.count = std::max(1, static_cast<int>(std::lround(due)));
            own.expected = static_cast<float>(own.count);
            // Rough glass lets most of its light out where smooth glass would none.
            const bool is_glass = bsdf.part(k) == LightPart::Transmission;
            if (!uniform || is_glass || kMore * due >= 1.0f) continue;
            own.expected = std::max(kLeast, kMore * due);
            at += own.expected;
            own.count = at >= 1.0f ? 1 : 0;
            at -= static_cast<float>(own.count);
        }
    }
    /// Expected samples a solid angle around `wo` over the lobes that `which` accepts.
    template <class Which>
    float lobe_density(const Vec3f& wo, Which which) const {
        float sum = 0.0f;
        for (std::size_t k = 0; k < samples.size(); ++k)
            if (samples[k].expected > 0.0f && which(k))
                sum += samples[k].expected * bsdf.pdf(k, wo);
        return sum;
    }
    /// Lamps are met by samples of lobes that are not diffuse: over those, sampling the lamp is
    /// never much worse.
    bool meets_lamps(std::size_t lobe) const { return bsdf.part(lobe) != LightPart::Diffuse; }
    float meeting_density(const Vec3f& wo) const {
        return lobe_density(wo, [&](std::size_t k) { return meets_lamps(k); });
    }
    /// Of one sample that chance takes of all lobes and what passes straight through, a solid
    /// angle, over the lobes that `which` accepts and are not sharp.
    template <class Which>
    float chance_density(const Vec3f& wo, Which which) const {
        float sum = 0.0f;
        for (std::size_t k = 0; k < samples.size(); ++k)
            if (samples[k].expected > 0.0f && which(k)) sum += bsdf.chance(k, wo);
        return sum * bsdf.part_of_all();
    }
    float chance_density(const Vec3f& wo) const {
        return chance_density(wo, [](std::size_t) { return true; });
    }
    /// Of a sharp lobe.
    float chance(std::size_t lobe) const { return bsdf.importance(lobe) * bsdf.part_of_all(); }
    /// What a sample along `wo`, drawn from `lobe`, may count as, by a number in [0, 1): as often
    /// as chance had drawn it from each lobe: one is taken more often than chance would, and brings
    /// light that others reflect along it as well.
    LightPart counted_as(std::size_t lobe, const Vec3f& wo, float uniform) const {
        float left = uniform * chance_density(wo);
        for (std::size_t k = 0; k < samples.size(); ++k) {
            if (samples[k].expected == 0.0f) continue;
            const float own = bsdf.chance(k, wo) * bsdf.part_of_all();
            if (left < own) return bsdf.counted_as(k, wo, left / own);
            left -= own;
        }
        return bsdf.part(lobe);
    }
    /// Of lobes' samples, what is left of light that is also sampled by `pdf` where those samples
    /// are not taken: Cycles weighs as if they were, by squares of the densities.
    float left_to_lobes(const Vec3f& wo, float pdf) const {
        const float own = chance_density(wo);
        return own > 0.0f ? own * own / (own * own + pdf * pdf) : 0.0f;
    }
    float all_density(const Vec3f& wo) const {
        return lobe_density(wo, [](std::size_t) { return true; });
    }
};

}  // namespace granita
