// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/surface_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hider/surface_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace granita {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "hider/corner_arithmetic.inl"
#include "hider/packet_vectors.inl"
#include "hider/sample_packet.inl"
#include "hider/triangle_pair.inl"

template <bool kLens>
HWY_INLINE Offset<V> offset_of(const SurfaceRecord& surface, int k, const Samples& at, V local) {
    const auto broadcast = [](const granita::Corner<float>& c) HWY_ATTR {
        return Corner<V>{set(c.x), set(c.y), set(c.w), set(c.z)};
    };
    Corner<V> c = broadcast(surface.begin[k]);
    if (surface.segments > 0) c = at_time(c, broadcast(surface.delta[k]), local);
    if constexpr (kLens)
        return offset_lens(c, at.x, at.y, at.u, at.v, at.inverse_focus, set(1.0f));
    else
        return offset_pinhole(c, at.x, at.y);
}

HWY_INLINE void blend(V value, M mask, float* to) {
    hn::BlendedStore(value, mask, kTag, to);
}

/// As SurfacePoint does it.
HWY_INLINE void blend_color(const SurfaceRecord& surface, int channel, const PairWeights& weight,
                            M in_first, M mask, float* to) {
    const auto corner = [&](int k) HWY_ATTR { return set(surface.radiance[k][channel]); };
    const V first = corner(0);
    const V second = hn::IfThenElse(in_first, corner(1), corner(2));
    const V third = hn::IfThenElse(in_first, corner(2), corner(3));
    blend(first + weight.second * (second - first) + weight.third * (third - first), mask, to);
}

template <bool kLens>
void locate(SurfaceInterpolator& surfaces, const TileSamples& samples, std::uint32_t first,
            const SurfaceId* ids, SurfaceRun& out) {
    const V zero = set(0.0f);
    const bool moving = !samples.t.empty();
    for (int part = 0; part < SurfaceRun::kCount; part += lane_count()) {
        const std::uint32_t at = first + static_cast<std::uint32_t>(part);
        Samples sample{hn::LoadU(kTag, &samples.x[at]),
                       hn::LoadU(kTag, &samples.y[at]),
                       zero,
                       zero,
                       zero,
                       zero};
        if (moving) sample.t = hn::LoadU(kTag, &samples.t[at]);
        if constexpr (kLens) {
            sample.u = hn::LoadU(kTag, &samples.u[at]) * set(surfaces.lens().x);
            sample.v = hn::LoadU(kTag, &samples.v[at]) * set(surfaces.lens().y);
            sample.inverse_focus = samples.inverse_focus.empty()
                                       ? set(surfaces.inverse_focus())
                                       : hn::LoadU(kTag, &samples.inverse_focus[at]);
        }
        const auto id = hn::LoadU(kIdTag, ids + part);
        std::uint32_t pending =
            bits_of(hn::RebindMask(kTag, hn::Ne(id, hn::Set(kIdTag, kNoSurface))));
        out.seen |= pending << part;
        while (pending != 0) {
            const int lane = __builtin_ctz(pending);
            const SurfaceRecord& colors = surfaces.load_colors(ids[part + lane]);
            if (colors.constant && !out.wants_points) {
                const M all = hn::RebindMask(kTag, hn::Eq(id, hn::Set(kIdTag, colors.id)));
                const std::uint32_t these = bits_of(all);
                pending &= ~these;
                out.plain |= these << part;
                out.colored |= these << part;
                for (int channel = 0; channel < 3; ++channel)
                    blend(set(colors.radiance[0][channel]), all, out.color[channel] + part);
                continue;
            }
            const SurfaceRecord& surface =
                surfaces.load(colors.id, moving ? samples.t[at + lane] : 0.0f);
            M mask = hn::RebindMask(kTag, hn::Eq(id, hn::Set(kIdTag, surface.id)));
            V local = zero;
            if (surface.segments > 0) {
                const V time = sample.t * set(static_cast<float>(surface.segments));
                local = time - set(static_cast<float>(surface.segment));
                const auto segment =
                    hn::Min(hn::ConvertTo(kIntTag, time), hn::Set(kIntTag, surface.segments - 1));
                mask = hn::And(
                    mask, hn::RebindMask(kTag, hn::Eq(segment, hn::Set(kIntTag, surface.segment))));
            }
            const std::uint32_t these = bits_of(mask);
            pending &= ~these;
            const PairEdges e = edges_of(offset_of<kLens>(surface, 0, sample, local),
                                         offset_of<kLens>(surface, 1, sample, local),
                                         offset_of<kLens>(surface, 2, sample, local),
                                         offset_of<kLens>(surface, 3, sample, local));
            const Side a = first_side(e), b = second_side(e);
            const PairWeights w = weights_of(e, a.strict);
            out.plain |= (bits_of(is_clean(a, b)) & these) << part;
            out.colored |= (surface.colored ? these : 0u) << part;
            if (surface.colored)
                for (int channel = 0; channel < 3; ++channel)
                    blend_color(surface, channel, w, a.strict, mask, out.color[channel] + part);
            if (!out.wants_points) continue;
            const V weight[3] = {set(1.0f) - w.second - w.third, w.second, w.third};
            for (int k = 0; k < 3; ++k) blend(weight[k], mask, out.weight[k] + part);
            out.second |= (these & ~bits_of(a.strict)) << part;
            for (std::uint32_t rest = these; rest != 0; rest &= rest - 1)
                out.corners[part + __builtin_ctz(rest)] = surface.corners;
        }
    }
}

void locate_any(SurfaceInterpolator& surfaces, const TileSamples& samples, std::uint32_t first,
                const SurfaceId* ids, SurfaceRun& out) {
    samples.u.empty() ? locate<false>(surfaces, samples, first, ids, out)
                      : locate<true>(surfaces, samples, first, ids, out);
}

}  // namespace HWY_NAMESPACE
}  // namespace granita
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace granita {

HWY_EXPORT(locate_any);

void locate_lanes(SurfaceInterpolator& surfaces, const TileSamples& samples, std::uint32_t first,
                  const SurfaceId* ids, SurfaceRun& out) {
    HWY_DYNAMIC_DISPATCH(locate_any)(surfaces, samples, first, ids, out);
}

}  // namespace granita
#endif
