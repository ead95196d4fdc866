// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>

#include "scene/options.h"
#include "shade/lights/lobe_ray.h"

namespace granita {

/// Light's way from a point of a grid backwards, over the surfaces it has met so far.
struct BouncedPath {
    LobeRay next;   ///< its weight: of the whole way; its point: of the grid
    int depth = 1;  ///< surfaces that send it on, the grid's among them
    int diffuse = 0, glossy = 0, transmission = 0;  ///< of these, by how
    bool was_diffuse = false;  ///< one of them sent it on from a diffuse lobe, to either side
    int volume = 0;            ///< of these, places in media that scatter
    /// As LobeRay's, of the lobes of the grid's own point.
    Vec3f diffuse_part{0.0f}, transmitted{0.0f};
    /// What sent it from there.
    enum class Kind { Diffuse, Glossy, Mirrored } kind = Kind::Diffuse;
    /// As how many of its point's light samples it counted when no chance had chosen it yet: those
    /// of a point's ways after as many meetings sum up to all of them at most.
    float sure_part = 0.0f;
    /// The most ways that it may become where what it meets sends light on by chance; and of how
    /// many it is one there, which weigh alike: the first takes what no chance chooses for all.
    int splits = 1, copies = 1;
    bool is_first = true;
    /// How likely it is one of its point's ways where it and others were followed: Cycles takes one
    /// by chance, and clamps what that brings for all.
    float chance = 1.0f;
    /// Weight of what its ray meets, 0 where chance has ended it; what it finds of the world is in
    /// no such doubt.
    float met_weight = 1.0f;
    int passed = 0;          ///< surfaces that let it through
    float least_pdf = 0.0f;  ///< of its directions: how few ways go like it
    float width = 0.0f;      ///< of the beam where the ray starts, metres
    float spread = 0.0f;     ///< by which it grows, metres a metre
    float length = 0.0f;     ///< that it went since it was last reflected
    float seen = 0.0f;       ///< from the camera to where the ray starts, along it, metres

    /// As a lobe of the grid's point sends it.
    static BouncedPath leaving(const LobeRay& ray);
    /// As a lobe sends it on from a place `distance` metres ahead, by `weight` of its light.
    BouncedPath sent(const LobeRay& way, const Vec3f& weight, float distance) const;
    /// As a surface `distance` metres ahead lets it pass straight on, from behind itself.
    BouncedPath passing(const Vec3f& start, const Vec3f& weight, float distance) const;
    /// Counts what has sent it, a place in a medium or a lobe (Ray::type).
    void count_bounce(bool is_scattered);

    /// Becomes the first of as many ways, alike but for their places, as it counts light samples.
    void split() {
        const float ways = std::ceil(sure_part);
        copies = static_cast<int>(ways);
        next.weight /= ways;
        next.share /= ways;
        next.place *= static_cast<std::uint32_t>(splits);
    }
    /// Is one way again: for all of those, or for itself.
    void leave_copies(bool for_all) {
        if (for_all) {
            next.weight *= static_cast<float>(copies);
            next.share *= static_cast<float>(copies);
        }
        copies = 1;
        is_first = true;
    }

    WayCounts counts() const { return {depth, diffuse, glossy, transmission, passed}; }

    /// Its weight, were it its point's only one.
    Vec3f throughput() const { return next.weight / next.share; }

    /// What it brings of `light`, held to a clamp as Cycles does: each contribution by itself, as
    /// bright as chance had made it (BouncedPath::chance).  0 where that is not finite.
    /// @param clamp of the sum of the channels; 0: none.
    /// @param whole how many times as much chance would bring, as seldom.
    Vec3f held(float clamp, const Vec3f& light, float whole = 1.0f) const {
        const Vec3f brought = next.weight * light;
        if (!is_finite(brought)) return Vec3f(0.0f);
        const float sum = (brought.x + brought.y + brought.z) * whole / next.share;
        const float most = clamp * chance;
        return most > 0.0f && sum > most ? brought * (most / sum) : brought;
    }

    /// Whether it came no further than the limits, each by as many `more`.
    bool is_within(const Bounces& limits, int more) const {
        return depth <= limits.most + more && diffuse <= limits.diffuse + more &&
               glossy <= limits.glossy + more && transmission <= limits.transmission + more &&
               volume <= limits.volume + more;
    }
    /// Whether lamps light what it meets.
    bool is_lit(const Bounces& limits) const {
        return is_within(limits, 0) && !is_occlusion(limits);
    }
    /// Whether what it meets only hides the world.  Passing through things does not count, and
    /// being mirrored once, as in Cycles.
    bool is_occlusion(const Bounces& limits) const {
        const int counted = depth - transmission - (glossy > 0 ? 1 : 0);
        return limits.occluded_from > 0 && counted >= limits.occluded_from;
    }
};

}  // namespace granita
