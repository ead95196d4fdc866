// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/simd_kernel.h"

#include <algorithm>
#include <cmath>

#include "hider/micropolygon_class.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hider/simd_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace granita {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "hider/corner_arithmetic.inl"

using Tag = hn::ScalableTag<float>;
using IdTag = hn::ScalableTag<std::uint32_t>;
using V = hn::Vec<Tag>;
using M = hn::Mask<Tag>;
constexpr Tag kTag;
constexpr IdTag kIdTag;
constexpr hn::RebindToSigned<IdTag> kIndexTag;
inline std::size_t lane_count() {
    return hn::Lanes(kTag);
}
HWY_INLINE V set(float x) {
    return hn::Set(kTag, x);
}

/// Calls visit(lane) for every lane of the mask.
template <class Visit>
HWY_INLINE void for_each_lane(M mask, Visit visit) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(kTag, mask, bytes);
    std::uint32_t bits = bytes[0] | (bytes[1] << 8);
    for (; bits != 0; bits &= bits - 1) visit(static_cast<std::size_t>(__builtin_ctz(bits)));
}

/// Pixels of the tile, inclusive.
struct PixelRange {
    int x0, x1, y0, y1;
    bool empty() const { return x0 > x1 || y0 > y1; }
};

/// Kept from grid to grid.
inline std::vector<std::uint32_t>& candidate_buffer() {
    thread_local std::vector<std::uint32_t> buffer;
    return buffer;
}

class Kernel {
  public:
    Kernel(const SimdGrid& grid, const SimdTile& tile, std::vector<Fragment>& fragments,
           SimdCounts& counts)
        : m_grid(grid),
          m_tile(tile),
          m_fragments(fragments),
          m_counts(counts),
          m_candidates(candidate_buffer()) {
        m_candidates.resize(static_cast<std::size_t>(tile.samples) * 256 + kLanePadding);
    }

    template <bool kLens>
    void run() {
        for (int m = 0; m < m_grid.n_u * m_grid.n_v; ++m) {
            if (m_grid.classes[m] == 0) continue;
            const int i = m % m_grid.n_u, j = m / m_grid.n_u, v0 = j * (m_grid.n_u + 1) + i;
            const int vertex[4] = {v0, v0 + 1, v0 + m_grid.n_u + 2, v0 + m_grid.n_u + 1};
            m_class = m_grid.classes[m];
            m_id = m_grid.base + static_cast<SurfaceId>(m);
            for (int segment = 0; segment < std::max(1, m_grid.segments); ++segment) {
                const PixelRange range = touched(vertex, segment);
                if (range.empty()) continue;
                if (m_grid.segments > 0)
                    hide_moving<kLens>(vertex, segment, range);
                else if (kLens && m_tile.sorted_by == SortedBy::Lens)
                    hide_defocused(vertex, range);
                else
                    hide_static<kLens>(vertex, range);
            }
        }
    }

  private:
    PixelRange touched(const int vertex[4], int segment) const {
        const std::size_t row = static_cast<std::size_t>(segment) * m_grid.vertices;
        const auto least = [&](const float* a) {
            a += row;
            return std::min(std::min(a[vertex[0]], a[vertex[1]]),
                            std::min(a[vertex[2]], a[vertex[3]]));
        };
        const auto most = [&](const float* a) {
            a += row;
            return std::max(std::max(a[vertex[0]], a[vertex[1]]),
                            std::max(a[vertex[2]], a[vertex[3]]));
        };
        // Clamped before the conversion, which overflows otherwise.
        const auto pixel = [](float x) {
            return static_cast<int>(std::floor(std::min(std::max(x, -1.0f), 32.0f)));
        };
        const Rect& p = m_tile.pixels;
        return {std::max(p.x0, pixel(least(m_grid.x_lo))),
                std::min(p.x1 - 1, pixel(most(m_grid.x_hi))),
                std::max(p.y0, pixel(least(m_grid.y_lo))),
                std::min(p.y1 - 1, pixel(most(m_grid.y_hi)))};
    }

    Corner<float> load(int vertex, int knot) const {
        const std::size_t i = static_cast<std::size_t>(knot) * m_grid.vertices + vertex;
        return {m_grid.x[i], m_grid.y[i], m_grid.w[i], m_grid.z[i]};
    }
    static HWY_INLINE Corner<V> broadcast(const Corner<float>& c) {
        return {set(c.x), set(c.y), set(c.w), set(c.z)};
    }

    template <bool kLens>
    HWY_INLINE Offset<V> offset(const Corner<V>& c, std::size_t i) const {
        const V x = hn::LoadU(kTag, m_tile.x + i), y = hn::LoadU(kTag, m_tile.y + i);
        if constexpr (kLens)
            return offset_lens(c, x, y, hn::LoadU(kTag, m_tile.u + i),
                               hn::LoadU(kTag, m_tile.v + i), set(m_grid.inverse_focus), set(1.0f));
        else
            return offset_pinhole(c, x, y);
    }

    /// The samples of a row of pixels follow each other in memory: one run a row.
    template <bool kLens>
    void hide_static(const int vertex[4], const PixelRange& range) {
        Corner<V> c[4];
        for (int k = 0; k < 4; ++k) c[k] = broadcast(load(vertex[k], 0));
        const auto n = static_cast<std::size_t>(m_tile.samples);
        const std::size_t count = static_cast<std::size_t>(range.x1 - range.x0 + 1) * n;
        for (int y = range.y0; y <= range.y1; ++y) {
            const std::size_t first = static_cast<std::size_t>(y * 16 + range.x0) * n;
            for (std::size_t i = 0; i < count; i += lane_count()) {
                Offset<V> d[4];
                for (int k = 0; k < 4; ++k) d[k] = offset<kLens>(c[k], first + i);
                V key = set(0.0f);
                const M hit = test(c, d, hn::FirstN(kTag, count - i), key);
                if (!hn::AllFalse(kTag, hit)) record(key, hit, first + i);
            }
        }
        m_counts.tests += count * static_cast<std::size_t>(range.y1 - range.y0 + 1);
    }

    /// Only the samples of the times at which the micropolygon can be over their pixel: bounds a
    /// column and a row of pixels, in homogeneous space (Laine et al. 2011; hider-research 5.3).
    template <bool kLens>
    void hide_moving(const int vertex[4], int segment, const PixelRange& range) {
        Corner<V> begin[4], delta[4];
        Bounded columns, rows;
        for (int k = 0; k < 4; ++k) {
            const Corner<float> a = load(vertex[k], segment), b = load(vertex[k], segment + 1);
            begin[k] = broadcast(a);
            delta[k] = broadcast({b.x - a.x, b.y - a.y, b.w - a.w, b.z - a.z});
            const float shear = std::max(shear_of(a), shear_of(b));
            columns.set_corner(k, a.x, b.x, a.w, b.w, m_grid.lens_x * shear);
            rows.set_corner(k, a.y, b.y, a.w, b.w, m_grid.lens_y * shear);
        }
        const float scale = static_cast<float>(m_tile.cells) / static_cast<float>(m_grid.segments);
        const V knots = set(static_cast<float>(m_grid.segments));
        const V start = set(static_cast<float>(segment));
        const V end =
            set(segment + 1 == m_grid.segments ? INFINITY : static_cast<float>(segment + 1));
        const auto test_at = [&](V t, M present, auto offset_at, V& key) HWY_ATTR {
            const V place = t * knots;
            const V local = place - start;
            const M active = hn::And(present, hn::And(hn::Ge(place, start), hn::Lt(place, end)));
            Corner<V> c[4];
            Offset<V> d[4];
            for (int k = 0; k < 4; ++k) {
                c[k] = at_time(begin[k], delta[k], local);
                d[k] = offset_at(c[k]);
            }
            return test(c, d, active, key);
        };
        collect(columns, rows, static_cast<float>(segment), scale, range,
                [&](std::size_t i, M present) HWY_ATTR {
                    V key = set(0.0f);
                    const M hit = test_at(
                        hn::LoadU(kTag, m_tile.t + i), present,
                        [&](const Corner<V>& c) HWY_ATTR { return offset<kLens>(c, i); }, key);
                    if (!hn::AllFalse(kTag, hit)) record(key, hit, i);
                });
        for (std::size_t i = 0; i < m_candidate_count; i += lane_count()) {
            V key = set(0.0f);
            const M hit = test_at(
                gather(m_tile.t, i), hn::FirstN(kTag, m_candidate_count - i),
                [&](const Corner<V>& c) HWY_ATTR { return gathered_offset<kLens>(c, i); }, key);
            if (!hn::AllFalse(kTag, hit)) record_scattered(key, hit, m_candidates.data() + i);
        }
    }

    /// Without motion the lens does to x what time does above: x + U s is linear in U.
    void hide_defocused(const int vertex[4], const PixelRange& range) {
        Corner<V> c[4];
        Bounded columns, rows;
        for (int k = 0; k < 4; ++k) {
            const Corner<float> a = load(vertex[k], 0);
            c[k] = broadcast(a);
            const float s = m_grid.lens_x * (a.z * m_grid.inverse_focus - 1.0f);
            columns.set_corner(k, a.x - s, a.x + s, a.w, a.w, 0.0f);
            rows.set_corner(k, a.y, a.y, a.w, a.w, m_grid.lens_y * shear_of(a));
        }
        collect(columns, rows, 0.0f, static_cast<float>(m_tile.cells), range,
                [&](std::size_t i, M present) HWY_ATTR {
                    Offset<V> d[4];
                    for (int k = 0; k < 4; ++k) d[k] = offset<true>(c[k], i);
                    V key = set(0.0f);
                    const M hit = test(c, d, present, key);
                    if (!hn::AllFalse(kTag, hit)) record(key, hit, i);
                });
        for (std::size_t i = 0; i < m_candidate_count; i += lane_count()) {
            Offset<V> d[4];
            for (int k = 0; k < 4; ++k) d[k] = gathered_offset<true>(c[k], i);
            V key = set(0.0f);
            const M hit = test(c, d, hn::FirstN(kTag, m_candidate_count - i), key);
            if (!hn::AllFalse(kTag, hit)) record_scattered(key, hit, m_candidates.data() + i);
        }
    }

    float shear_of(const Corner<float>& c) const {
        return std::fabs(c.z * m_grid.inverse_focus - 1.0f);
    }

    /// x w (or y w) and w of the corners at both ends of the sorted parameter.
    struct Bounded {
        float at0[4], at1[4], w0[4], w1[4], margin[4];
        void set_corner(int k, float p0, float p1, float w_begin, float w_end, float lens) {
            at0[k] = p0;
            at1[k] = p1;
            w0[k] = w_begin;
            w1[k] = w_end;
            // 1/256 pixel and a few ulp of far positions: more than rounding can move anything.
            margin[k] = lens + std::max(std::fabs(w_begin), std::fabs(w_end)) / 256 +
                        std::max(std::fabs(p0), std::fabs(p1)) * 0x1p-21f;
        }
    };

    /// Finds the samples whose cell is possible both for their column and for their row.  Runs of
    /// them that fill a good part of a vector go to `visit`, a vector at a time; the others are
    /// collected as candidates, since gathers cost about as much as the lanes they fill.
    template <class Visit>
    void collect(const Bounded& columns, const Bounded& rows, float start, float scale,
                 const PixelRange& range, Visit visit) {
        alignas(64) float column_from[32], column_to[32], row_from[32], row_to[32];
        bound_cells(columns, start, scale, range.x0, range.x1, column_from, column_to);
        bound_cells(rows, start, scale, range.y0, range.y1, row_from, row_to);
        alignas(64) float from[16], to[16];
        std::size_t count = 0;
        const int width = range.x1 - range.x0 + 1;
        for (int y = range.y0; y <= range.y1; ++y) {
            const V this_from = set(row_from[y - range.y0]), this_to = set(row_to[y - range.y0]);
            for (int i = 0; i < width; i += static_cast<int>(lane_count())) {
                const V cell0 = hn::Max(this_from, hn::LoadU(kTag, column_from + i));
                const V cell1 = hn::Min(this_to, hn::LoadU(kTag, column_to + i));
                const M possible = hn::And(hn::Le(cell0, cell1),
                                           hn::FirstN(kTag, static_cast<std::size_t>(width - i)));
                if (hn::AllFalse(kTag, possible)) continue;
                hn::StoreU(cell0, kTag, from);
                hn::StoreU(cell1, kTag, to);
                for_each_lane(possible, [&](std::size_t lane) HWY_ATTR {
                    const std::size_t pixel =
                        static_cast<std::size_t>(y * 16 + range.x0 + i) + lane;
                    const std::uint32_t* cells =
                        m_tile.cell_start + pixel * static_cast<std::size_t>(m_tile.cells + 1);
                    const auto first = static_cast<std::uint32_t>(pixel * m_tile.samples);
                    const std::uint32_t end = first + cells[static_cast<int>(to[lane]) + 1];
                    std::uint32_t s = first + cells[static_cast<int>(from[lane])];
                    m_counts.tests += end - s;
                    for (; (end - s) * 3 > lane_count();
                         s += std::min<std::uint32_t>(end - s, lane_count()))
                        visit(s, hn::FirstN(kTag, end - s));
                    for (; s < end; ++s) m_candidates[count++] = s;
                });
            }
        }
        std::fill_n(m_candidates.begin() + static_cast<std::ptrdiff_t>(count), kLanePadding, 0u);
        m_candidate_count = count;
    }

    /// For each column (or row) of pixels, in units of cells, when the micropolygon may be over it:
    /// some corner right of its left side and some corner left of its right side.  Both conditions
    /// are linear in the parameter for every corner, whatever the sign of w.
    void bound_cells(const Bounded& b, float start, float scale, int first, int last, float* from,
                     float* to) const {
        const V zero = set(0.0f), one = set(1.0f), never = set(INFINITY);
        const auto cells = static_cast<float>(m_tile.cells);
        // A parameter is exact to a few ulp of 1; widened by 2^-20 of its range.
        const V widen = set(cells * 0x1p-20f);
        const V lowest = zero, highest = set(std::nextafter(cells, 0.0f));  // its floor is a cell
        for (int i = 0; i <= last - first; i += static_cast<int>(lane_count())) {
            const V left = hn::Iota(kTag, static_cast<float>(first + i));
            const V right = left + one;
            V from_left = never, to_left = hn::Neg(never);
            V from_right = never, to_right = hn::Neg(never);
            for (int k = 0; k < 4; ++k) {
                const V at0 = set(b.at0[k]), at1 = set(b.at1[k]), margin = set(b.margin[k]);
                const V w0 = set(b.w0[k]), w1 = set(b.w1[k]);
                extend(at0 - left * w0 + margin, at1 - left * w1 + margin, from_left, to_left);
                extend(right * w0 - at0 + margin, right * w1 - at1 + margin, from_right, to_right);
            }
            // Empty stays empty: infinities survive the scaling.
            const V t0 = hn::Max(from_left, from_right), t1 = hn::Min(to_left, to_right);
            const V cell0 = (set(start) + t0) * set(scale) - widen;
            const V cell1 = (set(start) + t1) * set(scale) + widen;
            hn::StoreU(hn::Max(cell0, lowest), kTag, from + i);
            hn::StoreU(hn::Min(cell1, highest), kTag, to + i);
        }
    }

    HWY_INLINE V gather(const float* values, std::size_t candidate) const {
        const auto index =
            hn::BitCast(kIndexTag, hn::LoadU(kIdTag, m_candidates.data() + candidate));
        return hn::GatherIndex(kTag, values, index);
    }

    template <bool kLens>
    HWY_INLINE Offset<V> gathered_offset(const Corner<V>& c, std::size_t i) const {
        const V x = gather(m_tile.x, i), y = gather(m_tile.y, i);
        if constexpr (kLens)
            return offset_lens(c, x, y, gather(m_tile.u, i), gather(m_tile.v, i),
                               set(m_grid.inverse_focus), set(1.0f));
        else
            return offset_pinhole(c, x, y);
    }

    /// Grows [from, to] by the part of [0, 1] where the linear function with these end values is
    /// not negative.
    static HWY_INLINE void extend(V f0, V f1, V& from, V& to) {
        const V zero = set(0.0f), one = set(1.0f), never = set(INFINITY);
        const V root = f0 / (f0 - f1);
        const M in0 = hn::Ge(f0, zero), in1 = hn::Ge(f1, zero);
        from = hn::Min(from, hn::IfThenElse(in0, zero, hn::IfThenElse(in1, root, never)));
        to = hn::Max(to, hn::IfThenElse(in1, one, hn::IfThenElse(in0, root, hn::Neg(never))));
    }

    /// The active lanes that hit, and their keys.
    HWY_INLINE M test(const Corner<V> c[4], const Offset<V> d[4], M active, V& key) {
        const V zero = set(0.0f);
        const V e01 = edge(d[0], d[1]), e12 = edge(d[1], d[2]), e02 = edge(d[0], d[2]);
        const V e23 = edge(d[2], d[3]), e30 = edge(d[3], d[0]), e20 = hn::Neg(e02);
        M in_a = hn::MaskFromVec(zero), strict_a = in_a, in_b = in_a, strict_b = in_a;
        if (m_class & kTriangleA) inside(e01, e12, e20, in_a, strict_a);
        if (m_class & kTriangleB) inside(e02, e23, e30, in_b, strict_b);
        const M touched = hn::And(active, hn::Or(in_a, in_b));
        if (hn::AllFalse(kTag, touched)) return touched;

        // Strictly inside one triangle and outside the other; the rest is on an edge or where the
        // micropolygon is folded.
        const M clean =
            hn::And(touched, hn::Or(hn::AndNot(in_b, strict_a), hn::AndNot(in_a, strict_b)));
        const V first_weight = hn::IfThenElse(strict_a, e12, e23);
        const V second_weight = hn::IfThenElse(strict_a, e20, e30);
        const V third_weight = hn::IfThenElse(strict_a, e01, e02);
        const V second_z = hn::IfThenElse(strict_a, c[1].z, c[2].z);
        const V third_z = hn::IfThenElse(strict_a, c[2].z, c[3].z);
        const V share = set(1.0f) / (first_weight + second_weight + third_weight);
        const V z = c[0].z + second_weight * share * (second_z - c[0].z) +
                    third_weight * share * (third_z - c[0].z);
        const V z_in = hn::Min(hn::Max(z, hn::Min(c[0].z, hn::Min(second_z, third_z))),
                               hn::Max(c[0].z, hn::Max(second_z, third_z)));
        key = m_grid.range.perspective ? set(1.0f) / z_in : hn::Neg(z_in);
        M hit = hn::And(clean, hn::And(hn::Ge(key, set(m_grid.range.key_far)),
                                       hn::Le(key, set(m_grid.range.key_near))));
        const M unclear = hn::AndNot(clean, touched);
        if (!hn::AllFalse(kTag, unclear)) test_exactly(c, d, unclear, key, hit);
        return hit;
    }

    static HWY_INLINE void inside(V a, V b, V c, M& in, M& strict) {
        const V zero = set(0.0f);
        const V least = hn::Min(hn::Min(a, b), c), most = hn::Max(hn::Max(a, b), c);
        in = hn::Or(hn::Ge(least, zero), hn::Le(most, zero));
        strict = hn::Or(hn::Gt(least, zero), hn::Lt(most, zero));
    }

    HWY_NOINLINE void test_exactly(const Corner<V> c[4], const Offset<V> d[4], M unclear, V& key,
                                   M& hit) {
        alignas(64) float values[4][4][16], keys[16], hits[16];
        for (int k = 0; k < 4; ++k) {
            hn::StoreU(d[k].x, kTag, values[k][0]);
            hn::StoreU(d[k].y, kTag, values[k][1]);
            hn::StoreU(c[k].w, kTag, values[k][2]);
            hn::StoreU(c[k].z, kTag, values[k][3]);
        }
        hn::StoreU(key, kTag, keys);
        hn::StoreU(hn::IfThenElseZero(hit, set(1.0f)), kTag, hits);
        for_each_lane(unclear, [&](std::size_t lane) {
            granita::Corner<double> corner[4];
            granita::Offset<double> offset[4];
            for (int k = 0; k < 4; ++k) {
                offset[k] = {values[k][0][lane], values[k][1][lane]};
                corner[k] = {0.0, 0.0, values[k][2][lane], values[k][3][lane]};
            }
            const SurfaceHit exact = hit_micropolygon(corner, offset, m_class, m_grid.range);
            keys[lane] = exact.key;
            hits[lane] = exact.hit ? 1.0f : 0.0f;
        });
        key = hn::LoadU(kTag, keys);
        hit = hn::Gt(hn::LoadU(kTag, hits), set(0.0f));
    }

    HWY_INLINE void record(V key, M hit, std::size_t first) {
        m_counts.hits += hn::CountTrue(kTag, hit);
        const V stored = hn::LoadU(kTag, m_tile.key + first);
        const M nearer = hn::And(hit, hn::Gt(key, stored));
        const M equal = hn::And(hit, hn::Eq(key, stored));
        if (m_class & kTransparent) {
            record_fragments(key, hn::Or(nearer, equal), equal, first);
            return;
        }
        if (!hn::AllFalse(kTag, equal))
            for_each_lane(equal, [&](std::size_t lane) {
                SurfaceId& id = m_tile.id[first + lane];
                if (id != kNoSurface && m_grid.pool->before(m_id, id)) id = m_id;
            });
        if (hn::AllFalse(kTag, nearer)) return;
        m_counts.writes += hn::CountTrue(kTag, nearer);
        hn::BlendedStore(key, nearer, kTag, m_tile.key + first);
        hn::BlendedStore(hn::Set(kIdTag, m_id), hn::RebindMask(kIdTag, nearer), kIdTag,
                         m_tile.id + first);
    }

    HWY_INLINE void record_scattered(V key, M hit, const std::uint32_t* samples) {
        alignas(64) float keys[16];
        hn::StoreU(key, kTag, keys);
        m_counts.hits += hn::CountTrue(kTag, hit);
        for_each_lane(hit, [&](std::size_t lane) {
            const std::uint32_t i = samples[lane];
            const float stored = m_tile.key[i];
            if (!(keys[lane] > stored)) {
                const SurfaceId id = m_tile.id[i];
                if (keys[lane] < stored || id == kNoSurface || !m_grid.pool->before(m_id, id))
                    return;
            }
            if (m_class & kTransparent) {
                m_fragments.push_back({keys[lane], i, m_id});
                return;
            }
            m_tile.key[i] = keys[lane];
            m_tile.id[i] = m_id;
            ++m_counts.writes;
        });
    }

    HWY_NOINLINE void record_fragments(V key, M visible, M equal, std::size_t first) {
        alignas(64) float keys[16], ties[16];
        hn::StoreU(key, kTag, keys);
        hn::StoreU(hn::IfThenElseZero(equal, set(1.0f)), kTag, ties);
        for_each_lane(visible, [&](std::size_t lane) {
            const SurfaceId stored = m_tile.id[first + lane];
            if (ties[lane] > 0.0f && (stored == kNoSurface || !m_grid.pool->before(m_id, stored)))
                return;
            m_fragments.push_back({keys[lane], static_cast<std::uint32_t>(first + lane), m_id});
        });
    }

    const SimdGrid& m_grid;
    const SimdTile& m_tile;
    std::vector<Fragment>& m_fragments;
    SimdCounts& m_counts;
    std::uint8_t m_class = 0;
    SurfaceId m_id = 0;
    std::vector<std::uint32_t>& m_candidates;
    std::size_t m_candidate_count = 0;
};

void hide_grid(const SimdGrid& grid, const SimdTile& tile, std::vector<Fragment>& fragments,
               SimdCounts& counts) {
    Kernel kernel(grid, tile, fragments, counts);
    if (grid.lens_x > 0.0f)
        kernel.run<true>();
    else
        kernel.run<false>();
}

}  // namespace HWY_NAMESPACE
}  // namespace granita
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace granita {

HWY_EXPORT(hide_grid);

void hide_grid_in_tile(const SimdGrid& grid, const SimdTile& tile, std::vector<Fragment>& fragments,
                       SimdCounts& counts) {
    HWY_DYNAMIC_DISPATCH(hide_grid)(grid, tile, fragments, counts);
}

}  // namespace granita
#endif
