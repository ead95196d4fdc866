// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/resolve/surface_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hider/resolve/surface_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace granita {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "hider/corner_arithmetic.inl"
#include "hider/packet_vectors.inl"
#include "hider/simd/sample_packet.inl"
#include "hider/simd/triangle_pair.inl"

template <bool kLens>
HWY_INLINE Offset<V> offset_from(const Corner<V>& c, const Samples& at) {
    if constexpr (kLens)
        return offset_lens(c, at.x, at.y, at.u, at.v, at.inverse_focus, set(1.0f));
    else
        return offset_pinhole(c, at.x, at.y);
}

template <bool kLens>
HWY_INLINE Offset<V> offset_of(const SurfaceRecord& surface, int k, const Samples& at, V local) {
    const auto broadcast = [](const granita::Corner<float>& c) HWY_ATTR {
        return Corner<V>{set(c.x), set(c.y), set(c.w), set(c.z)};
    };
    Corner<V> c = broadcast(surface.begin[k]);
    if (surface.segments > 0) c = at_time(c, broadcast(surface.delta[k]), local);
    return offset_from<kLens>(c, at);
}

HWY_INLINE void blend(V value, M mask, float* to) {
    hn::BlendedStore(value, mask, kTag, to);
}

/// As SurfacePoint does it.
HWY_INLINE V color_of(const SurfaceRecord& surface, int channel, const PairWeights& weight,
                      M in_first) {
    const auto corner = [&](int k) HWY_ATTR { return set(surface.radiance[k][channel]); };
    const V first = corner(0);
    const V second = hn::IfThenElse(in_first, corner(1), corner(2));
    const V third = hn::IfThenElse(in_first, corner(2), corner(3));
    return first + weight.second * (second - first) + weight.third * (third - first);
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
                    blend(color_of(surface, channel, w, a.strict), mask, out.color[channel] + part);
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

/// Corner k at the time of each lane, between its knots.
struct KnotLanes {
    KnotLanes(const SurfaceRecord& surface, const SurfaceKnots& surface_knots, V time)
        : knots(surface_knots), moves(surface.segments > 0), local(set(0.0f)) {
        if (!moves) return;
        const V scaled = time * set(static_cast<float>(surface.segments));
        // Lanes of another group must not read beyond the knots.
        const auto segment = hn::Clamp(hn::ConvertTo(kIntTag, scaled),
                                       hn::Set(kIntTag, knots.first), hn::Set(kIntTag, knots.last));
        local = scaled - hn::ConvertTo(kTag, segment);
        place = hn::ShiftLeft<2>(hn::Sub(segment, hn::Set(kIntTag, knots.first)));
    }

    template <bool kLens>
    HWY_INLINE Corner<V> corner(int k) const {
        if (knots.first == knots.last) {
            const auto all = [&](const std::vector<float>& v, int knot) HWY_ATTR {
                return set(v[4 * static_cast<std::size_t>(knot) + static_cast<std::size_t>(k)]);
            };
            return between<kLens>(all);
        }
        const auto gathered = [&](const std::vector<float>& v, int knot) HWY_ATTR {
            return hn::GatherIndex(kTag, v.data() + 4 * knot + k, place);
        };
        return between<kLens>(gathered);
    }

  private:
    template <bool kLens, class At>
    HWY_INLINE Corner<V> between(At at) const {
        const auto all = [&](int knot) HWY_ATTR {
            return Corner<V>{at(knots.x, knot), at(knots.y, knot), at(knots.w, knot),
                             kLens ? at(knots.z, knot) : set(0.0f)};
        };
        const Corner<V> begin = all(0);
        if (!moves) return begin;
        const Corner<V> end = all(1);
        return at_time(
            begin, Corner<V>{end.x - begin.x, end.y - begin.y, end.w - begin.w, end.z - begin.z},
            local);
    }

    const SurfaceKnots& knots;
    bool moves;
    V local;
    hn::Vec<IntTag> place = hn::Zero(kIntTag);
};

template <bool kLens>
void color(const SurfaceInterpolator& surfaces, const TileSamples& sorted, std::size_t begin,
           const SurfaceRecord& surface, const SurfaceKnots& knots,
           std::span<const std::int32_t> group, SampleColors& colors,
           std::span<std::uint8_t> done) {
    const V zero = set(0.0f);
    const auto width = static_cast<std::size_t>(lane_count());
    for (std::size_t first = 0; first < group.size(); first += width) {
        const std::size_t count = std::min(width, group.size() - first);
        const std::size_t at = begin + first;
        const auto load = [&](const std::vector<float>& values)
                              HWY_ATTR { return hn::LoadU(kTag, values.data() + at); };
        Samples sample{load(sorted.x), load(sorted.y), zero, zero, zero, zero};
        if (surface.segments > 0) sample.t = load(sorted.t);
        if constexpr (kLens) {
            sample.u = load(sorted.u) * set(surfaces.lens().x);
            sample.v = load(sorted.v) * set(surfaces.lens().y);
            sample.inverse_focus = sorted.inverse_focus.empty() ? set(surfaces.inverse_focus())
                                                                : load(sorted.inverse_focus);
        }
        const KnotLanes lanes(surface, knots, sample.t);
        const PairEdges e = edges_of(offset_from<kLens>(lanes.corner<kLens>(0), sample),
                                     offset_from<kLens>(lanes.corner<kLens>(1), sample),
                                     offset_from<kLens>(lanes.corner<kLens>(2), sample),
                                     offset_from<kLens>(lanes.corner<kLens>(3), sample));
        const Side a = first_side(e), b = second_side(e);
        const PairWeights w = weights_of(e, a.strict);
        alignas(64) float out[3][kPacket];
        for (int channel = 0; channel < 3; ++channel)
            hn::Store(color_of(surface, channel, w, a.strict) + zero, kTag, out[channel]);
        for_each_bit(bits_of(is_clean(a, b)) & ((1u << count) - 1u), [&](int lane) {
            const auto s = static_cast<std::size_t>(group[first + static_cast<std::size_t>(lane)]);
            colors.red[s] = out[0][lane];
            colors.green[s] = out[1][lane];
            colors.blue[s] = out[2][lane];
            colors.alpha[s] = 1.0f;
            done[s] = 1;
        });
    }
}

void color_any(const SurfaceInterpolator& surfaces, const TileSamples& sorted, std::size_t begin,
               const SurfaceRecord& surface, const SurfaceKnots& knots,
               std::span<const std::int32_t> group, SampleColors& colors,
               std::span<std::uint8_t> done) {
    sorted.u.empty() ? color<false>(surfaces, sorted, begin, surface, knots, group, colors, done)
                     : color<true>(surfaces, sorted, begin, surface, knots, group, colors, done);
}

}  // namespace HWY_NAMESPACE
}  // namespace granita
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace granita {

HWY_EXPORT(locate_any);
HWY_EXPORT(color_any);

void locate_lanes(SurfaceInterpolator& surfaces, const TileSamples& samples, std::uint32_t first,
                  const SurfaceId* ids, SurfaceRun& out) {
    HWY_DYNAMIC_DISPATCH(locate_any)(surfaces, samples, first, ids, out);
}

void color_group(const SurfaceInterpolator& surfaces, const TileSamples& sorted, std::size_t begin,
                 const SurfaceRecord& surface, const SurfaceKnots& knots,
                 std::span<const std::int32_t> group, SampleColors& colors,
                 std::span<std::uint8_t> done) {
    HWY_DYNAMIC_DISPATCH(color_any)(surfaces, sorted, begin, surface, knots, group, colors, done);
}

}  // namespace granita
#endif
