// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/samples/sample_order.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace granita {
namespace {

constexpr int kPixels = kTileSize * kTileSize;
/// Side of the bounding square of a micropolygon of one pixel, at some angle.
constexpr double kExtent = 1.3;
/// Strata of the lens are sorted; where something moves, those of time would do, which are not.
/// Sorting costs as much more as looking for what is seen with so many samples a pixel.
constexpr double kSorted = 16.0;
/// The hierarchical depth is by stratum: fewer hide little of what moves.
constexpr int kLeastStrata = 4;
/// A tile is at least a window of blocks wide.
constexpr int kLeastSideLog2 = -2, kMostSideLog2 = 2;

int samples_of_block(int side_log2, int samples) {
    return static_cast<int>(std::ceil(std::ldexp(samples, 2 * side_log2)));
}

/// Square blocks of a tile.
struct Blocks {
    const TileSamples& samples;
    int wide;

    std::size_t count() const { return static_cast<std::size_t>(wide) * wide; }
    std::uint32_t of(std::uint32_t sample) const {
        const float per_pixel = static_cast<float>(wide) / kTileSize;
        return static_cast<std::uint32_t>(static_cast<int>(samples.y[sample] * per_pixel) * wide +
                                          static_cast<int>(samples.x[sample] * per_pixel));
    }
};

template <class Visit>
void for_each_sample(const TileSamples& samples, const Rect& pixels, Visit visit) {
    for (int p = 0; p < kPixels; ++p) {
        const int x = p % kTileSize, y = p / kTileSize;
        if (x < pixels.x0 || x >= pixels.x1 || y < pixels.y0 || y >= pixels.y1) continue;
        const auto first = static_cast<std::uint32_t>(p * samples.samples);
        for (std::uint32_t s = 0; s < static_cast<std::uint32_t>(samples.samples); ++s)
            visit(first + s);
    }
}

/// Counting sort of slots[0, count) by cells of `value`, which lies in [lo, hi]; stable.
template <class Value>
void sort_by_cells(std::uint32_t* slots, std::size_t count, int cells, float lo, float hi,
                   std::vector<std::uint32_t>& scratch, Value value) {
    const float scale = static_cast<float>(cells) / (hi - lo);
    const auto cell = [&](std::uint32_t sample) {
        return std::clamp(static_cast<int>((value(sample) - lo) * scale), 0, cells - 1);
    };
    std::vector<std::uint32_t> start(static_cast<std::size_t>(cells) + 1, 0);
    for (std::size_t i = 0; i < count; ++i) ++start[cell(slots[i]) + 1];
    for (int c = 0; c < cells; ++c) start[c + 1] += start[c];
    scratch.assign(slots, slots + count);
    for (const std::uint32_t sample : scratch) slots[start[cell(sample)]++] = sample;
}

/// Calls visit(first, count) for each of `parts` equal shares of `count` slots.
template <class Visit>
void for_each_share(std::size_t count, int parts, Visit visit) {
    for (int part = 0; part < parts; ++part) {
        const std::size_t first = count * part / parts;
        visit(first, count * (part + 1) / parts - first);
    }
}

}  // namespace

float OrderShape::side() const {
    return std::ldexp(1.0f, side_log2);
}

double order_cost(const OrderShape& shape, int samples, const Sweep& sweep) {
    const double side = shape.side();
    const int count = samples_of_block(shape.side_log2, samples);
    const auto blocks = [&](int axis, int lens_strata) {
        const double reach = sweep.motion[axis] / shape.times + sweep.lens[axis] / lens_strata;
        return std::min((reach + kExtent) / side + 1, kTileSize / side);
    };
    const double x = blocks(0, shape.us), y = blocks(1, shape.vs);
    if (!shape.stratified) return std::ceil(static_cast<double>(count) / kPacket) * x * y;
    // Windows of four by four blocks, and what a stratum costs by itself.
    const auto windows = [](double n) { return std::max(1.0, (n + 2.5) / 4); };
    const bool sorted = shape.us * shape.vs > 1 && sweep.motion != Vec2f(0.0f);
    return count * (0.5 + windows(x) * windows(y)) * (sorted ? 1.0 + kSorted / samples : 1.0);
}

OrderShape best_order(int samples, const Sweep& sweep) {
    OrderShape best;
    double least = INFINITY;
    const auto is_zero = [](const Vec2f& v) { return v.x == 0.0f && v.y == 0.0f; };
    const bool moves = !is_zero(sweep.motion), lens = !is_zero(sweep.lens);
    for (int side = kLeastSideLog2; side <= kMostSideLog2; ++side) {
        // Parts of a pixel hold equally many samples only if these divide.
        if (side < 0 && samples % (1 << (-2 * side)) != 0) continue;
        const int count = samples_of_block(side, samples);
        if (!sweep.still() && count < kLeastStrata) continue;
        for (int times = 1; times <= (moves ? count : 1); times *= 2)
            for (int us = 1; us * times <= (lens ? count : times); us *= 2)
                for (int vs = us; vs <= 2 * us && vs * us * times <= count; vs *= 2) {
                    if (!lens && vs > 1) continue;
                    const OrderShape shape{moves || lens, side, times, us, vs};
                    const double cost = order_cost(shape, samples, sweep);
                    if (cost < least) {
                        least = cost;
                        best = shape;
                    }
                }
    }
    return best;
}

void SampleOrder::arrange(const TileSamples& samples, const Rect& pixels, const OrderShape& shape) {
    m_shape = shape;
    m_is_table = take_table(samples, pixels);
    if (m_is_table) return;
    distribute(samples, pixels);
    // Samples that are not a net may crowd in a part of a pixel; then blocks are whole pixels.
    const int expected = samples_of_block(m_shape.side_log2, samples.samples);
    if (m_shape.side_log2 < 0 && m_strata >= expected + kPacket) {
        m_shape.side_log2 = 0;
        distribute(samples, pixels);
    }
    m_slots = m_table_index.size();
    number_packets();
}

bool SampleOrder::take_table(const TileSamples& samples, const Rect& pixels) {
    const bool whole = pixels.width() == kTileSize && pixels.height() == kTileSize;
    if (m_shape.stratified || !whole || samples.samples % kPacket != 0 || m_shape.side_log2 > 0 ||
        -m_shape.side_log2 > samples.square_digits)
        return false;
    m_blocks_wide = kTileSize << -m_shape.side_log2;
    m_strata = samples.samples >> (-2 * m_shape.side_log2);
    m_slots = samples.x.size();
    m_table_index.clear();
    const Blocks blocks{samples, m_blocks_wide};
    const std::size_t packets = static_cast<std::size_t>(m_strata) / kPacket;
    m_packets.resize(blocks.count() * packets);
    m_scratch.assign(blocks.count(), 0);
    for (std::uint32_t p = 0; p < m_packets.size(); ++p) {
        const std::uint32_t block = blocks.of(p * kPacket);
        m_packets[block * packets + m_scratch[block]++] = p;
    }
    return true;
}

void SampleOrder::number_packets() {
    m_packets.resize(m_shape.stratified ? 0 : m_slots / kPacket);
    std::iota(m_packets.begin(), m_packets.end(), 0u);
}

void SampleOrder::distribute(const TileSamples& samples, const Rect& pixels) {
    m_blocks_wide = static_cast<int>(std::ldexp(kTileSize, -m_shape.side_log2));
    if (place_net(samples, pixels)) return;
    const Blocks blocks{samples, m_blocks_wide};
    std::vector<std::uint32_t> count(blocks.count(), 0);
    for_each_sample(samples, pixels, [&](std::uint32_t i) { ++count[blocks.of(i)]; });
    const std::uint32_t most = *std::max_element(count.begin(), count.end());
    m_strata = static_cast<int>(std::max(most, 1u));
    if (!m_shape.stratified) m_strata = (m_strata + kPacket - 1) / kPacket * kPacket;
    const auto stride = static_cast<std::size_t>(m_strata);
    m_table_index.assign(blocks.count() * stride, kNone);
    std::vector<std::uint32_t> filled(blocks.count(), 0);
    for_each_sample(samples, pixels, [&](std::uint32_t i) {
        const std::uint32_t block = blocks.of(i);
        m_table_index[block * stride + filled[block]++] = i;
    });
    if (!m_shape.stratified) return;
    for (std::size_t block = 0; block < blocks.count(); ++block)
        sort_block(samples, m_table_index.data() + block * stride, count[block]);
    m_scratch.assign(stride * stratum_stride(), kNone);
    for (std::size_t block = 0; block < blocks.count(); ++block)
        for (std::size_t stratum = 0; stratum < stride; ++stratum)
            m_scratch[stratum * stratum_stride() + block] = m_table_index[block * stride + stratum];
    std::swap(m_table_index, m_scratch);
}

bool SampleOrder::place_net(const TileSamples& samples, const Rect& pixels) {
    const int expected = samples_of_block(m_shape.side_log2, samples.samples);
    const bool by_time = !samples.t.empty() && m_shape.times == expected;
    if (m_shape.stratified ? !by_time : expected % kPacket != 0) return false;
    m_strata = expected;
    const Blocks blocks{samples, m_blocks_wide};
    const std::size_t count = blocks.count(), stride = stratum_stride();
    m_table_index.assign((m_shape.stratified ? stratum_stride() : count) * expected, kNone);
    m_scratch.assign(m_shape.stratified ? 0 : count, 0);
    bool fits = true;
    for_each_sample(samples, pixels, [&](std::uint32_t i) {
        const std::size_t block = blocks.of(i);
        if (m_shape.stratified) {
            const int stratum = static_cast<int>(samples.t[i] * static_cast<float>(expected));
            std::uint32_t& slot = m_table_index[std::min(stratum, expected - 1) * stride + block];
            fits = fits && slot == kNone;
            slot = i;
        } else {
            std::uint32_t& filled = m_scratch[block];
            if (filled == static_cast<std::uint32_t>(expected)) fits = false;
            if (fits) m_table_index[block * expected + filled++] = i;
        }
    });
    return fits;
}

void SampleOrder::sort_block(const TileSamples& samples, std::uint32_t* slots, std::size_t count) {
    // Four cells a stratum: enough for nets, whose strata are whole cells, and nearly for others.
    const auto sort = [&](std::size_t first, std::size_t n, int parts, float lo,
                          const std::vector<float>& values) {
        if (parts > 1)
            sort_by_cells(slots + first, n, 4 * parts, lo, 1.0f, m_scratch,
                          [&](std::uint32_t i) { return values[i]; });
    };
    sort(0, count, m_shape.times, 0.0f, samples.t);
    if (m_shape.us * m_shape.vs == 1) return;
    for_each_share(count, m_shape.times, [&](std::size_t first, std::size_t n) {
        sort(first, n, m_shape.us, -1.0f, samples.u);
        for_each_share(n, m_shape.us, [&](std::size_t from, std::size_t some) {
            sort(first + from, some, m_shape.vs, -1.0f, samples.v);
        });
    });
}

}  // namespace granita
