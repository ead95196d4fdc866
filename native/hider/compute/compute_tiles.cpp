// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/compute/compute_tiles.h"

#include <bit>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "base/error.h"
#include "gl/gl_check.h"
#include "shaders/shared/compute_layout.h"

namespace granita {
namespace {

constexpr std::size_t kPixels = kTileSize * kTileSize;
constexpr std::size_t kSampleBytes = 6 * sizeof(float);  ///< x, y, t, u, v, 1 / focus
/// As hide.comp writes it.
struct DeviceFragment {
    float key;
    std::uint32_t sample;
    SurfaceId id;
};
static_assert(sizeof(DeviceFragment) == 12);
constexpr std::uint32_t kSkip = ~std::uint32_t{0};

struct Seen {
    float key;
    SurfaceId id;
};

/// Of every block the pixels that count, for farthest.comp.
std::vector<ComputeBlock> blocks_of(const BucketTiles& bucket, std::size_t first,
                                    std::size_t count) {
    std::vector<ComputeBlock> blocks;
    for (std::uint32_t tile = 0; tile < count; ++tile) {
        const Rect pixels = bucket.local_pixels(first + tile);
        for (std::uint32_t block = 0; block < 16; ++block) {
            std::uint32_t counting = 0;
            for (std::uint32_t p = 0; p < 16; ++p) {
                const int x = static_cast<int>(block % 4 * 4 + p % 4);
                const int y = static_cast<int>(block / 4 * 4 + p / 4);
                if (x >= pixels.x0 && x < pixels.x1 && y >= pixels.y0 && y < pixels.y1)
                    counting |= 1u << p;
            }
            blocks.push_back({tile, block, counting, 0});
        }
    }
    return blocks;
}

}  // namespace

std::size_t ComputeTiles::capacity(int samples, const ComputeLimits& limits) {
    const std::size_t tiles =
        limits.buffer_bytes / (kPixels * static_cast<std::size_t>(samples) * kSampleBytes);
    if (tiles == 0)
        throw GlError("the compute executor cannot hold " + std::to_string(samples) +
                      " samples a pixel");
    // A dispatch takes 65,535 workgroups a dimension, and a tile has 16 blocks.
    return std::min<std::size_t>(tiles, 65535 / 16);
}

ComputeTiles::ComputeTiles(ComputeDevice& device, BucketTiles& bucket, const HiderFrame& frame,
                           std::size_t first, std::size_t count)
    : m_device(device),
      m_bucket(bucket),
      m_frame(frame),
      m_first(first),
      m_count(count),
      m_samples_a_pixel(static_cast<std::uint32_t>(bucket.samples(first).samples)),
      m_stride(static_cast<std::uint32_t>(count * kPixels) * m_samples_a_pixel),
      m_all_blocks(blocks_of(bucket, first, count)) {}

void ComputeTiles::stage_samples(bool time) {
    const Projection& projection = m_frame.projection;
    const Vec2f lens(projection.lens_radius * projection.scale);
    std::vector<float>& values = m_sample_values;
    values.clear();
    values.reserve(static_cast<std::size_t>(m_stride) * 6);
    const auto append = [&](std::vector<float> TileSamples::*dimension, float factor) {
        for (std::size_t i = m_first; i < m_first + m_count; ++i)
            for (const float x : m_bucket.samples(i).*dimension) values.push_back(x * factor);
    };
    append(&TileSamples::x, 1.0f);
    append(&TileSamples::y, 1.0f);
    if (projection.has_lens()) {
        append(&TileSamples::u, lens.x);
        append(&TileSamples::v, lens.y);
        append(&TileSamples::inverse_focus, 1.0f);
        values.resize(static_cast<std::size_t>(m_stride) * 5,
                      static_cast<float>(1.0 / projection.focus));
    }
    if (time) {
        for (std::size_t i = m_first; i < m_first + m_count; ++i) m_bucket.need_time(i);
        append(&TileSamples::t, 1.0f);
    }
    m_has_time = time;
}

// The whole pool each time: ties with surfaces of earlier batches need their grids.
void ComputeTiles::stage_grids() {
    const GridPool& pool = m_bucket.pool();
    std::vector<GridOrder>& order = m_grid_order;
    order.clear();
    order.reserve(pool.size());
    SurfaceId base = 0;
    for (std::uint32_t slot = 0; slot < pool.size(); ++slot) {
        const Grid& grid = pool.grid(slot);
        order.push_back(
            {base,
             {grid.key.instance, grid.key.face, static_cast<std::uint32_t>(grid.key.path >> 32),
              static_cast<std::uint32_t>(grid.key.path)}});
        base += static_cast<SurfaceId>(grid.micropolygon_count());
    }
    if (order.size() * sizeof(GridOrder) > m_device.limits().buffer_bytes)
        throw GlError("a bucket of " + std::to_string(order.size()) +
                      " grids is too big for the compute executor");
}

void ComputeTiles::stage(const ComputeBatch& batch) {
    if (m_batch == nullptr || (batch.moving() && !m_has_time)) stage_samples(batch.moving());
    stage_grids();
    m_lists = batch.lists();
    m_batch = &batch;
}

void ComputeTiles::upload() {
    if (m_seen.name() == 0) {
        m_seen = gl::Buffer(m_stride * sizeof(Seen), nullptr);
        const std::uint32_t nothing[2] = {std::bit_cast<std::uint32_t>(-INFINITY), kNoSurface};
        glClearNamedBufferData(m_seen.name(), GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT, nothing);
    }
    if (!m_sample_values.empty()) m_samples = gl::Buffer::of(std::exchange(m_sample_values, {}));
    m_grids = gl::Buffer::of(m_grid_order);
    m_entries = gl::Buffer::of(m_lists.entries);
    m_vertices = gl::Buffer::of(m_batch->vertices());
}

void ComputeTiles::hide() {
    upload();
    if (!m_lists.opaque.empty()) dispatch(COMPUTE_PASS_OPAQUE, m_lists.opaque);
    if (m_lists.transparent.empty()) return;
    const std::size_t samples = m_lists.transparent.size() * 16 * m_samples_a_pixel;
    m_count_buffer = gl::Buffer(samples * sizeof(std::uint32_t), nullptr);
    m_count_buffer.bind_storage(COMPUTE_COUNTS);
    dispatch(COMPUTE_PASS_COUNT, m_lists.transparent);
}

void ComputeTiles::count_dispatch() const {
    if (m_frame.statistics) m_frame.statistics->add(Counter::GlDispatches);
}

void ComputeTiles::dispatch(int pass, const std::vector<ComputeBlock>& blocks) const {
    const gl::Buffer block_buffer = gl::Buffer::of(blocks);
    const Projection& projection = m_frame.projection;
    const DepthRange range = depth_range(projection);
    m_device.hide({pass, m_batch->moving(), projection.has_lens()}).use();
    block_buffer.bind_storage(COMPUTE_BLOCKS);
    m_entries.bind_storage(COMPUTE_ENTRIES);
    m_vertices.bind_storage(COMPUTE_VERTICES);
    m_samples.bind_storage(COMPUTE_SAMPLES);
    m_seen.bind_storage(COMPUTE_SEEN);
    m_grids.bind_storage(COMPUTE_GRIDS);
    glUniform1ui(COMPUTE_SAMPLES_A_PIXEL, m_samples_a_pixel);
    glUniform1ui(COMPUTE_SAMPLE_STRIDE, m_stride);
    glUniform1ui(COMPUTE_LENS_AT, 2 * m_stride);
    glUniform1ui(COMPUTE_TIME_AT, (projection.has_lens() ? 5 : 2) * m_stride);
    glUniform1ui(COMPUTE_GRID_COUNT, static_cast<GLuint>(m_grid_order.size()));
    glUniform1i(COMPUTE_PERSPECTIVE, range.perspective);
    glUniform2f(COMPUTE_KEY_RANGE, range.key_far, range.key_near);
    const auto groups =
        static_cast<GLuint>((16 * m_samples_a_pixel + COMPUTE_GROUP_SIZE - 1) / COMPUTE_GROUP_SIZE);
    glDispatchCompute(static_cast<GLuint>(blocks.size()), groups, 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    gl::check("hiding micropolygons");
    count_dispatch();
}

std::optional<gl::Readback> ComputeTiles::counts() const {
    if (m_lists.transparent.empty()) return std::nullopt;
    return gl::Readback(m_count_buffer, 0, m_count_buffer.size());
}

// Two passes, so that nothing can overflow: the first counts, the second fills as many parts as the
// limits ask for.
std::vector<ComputeTiles::Part> ComputeTiles::parts(const gl::Readback& counts) {
    const auto values = counts.values<std::uint32_t>();
    m_counts.assign(values.begin(), values.end());
    const std::size_t limit = m_device.limits().buffer_bytes / sizeof(DeviceFragment);
    std::vector<Part> parts;
    for (std::size_t sample = 0; sample < m_counts.size(); ++sample) {
        if (m_counts[sample] == 0) continue;
        if (parts.empty() || parts.back().fragments + m_counts[sample] > limit)
            parts.push_back({sample, sample, std::vector(m_counts.size(), kSkip), 0});
        Part& part = parts.back();
        part.places[sample] = part.fragments;
        part.fragments += m_counts[sample];
        part.end = sample + 1;
    }
    return parts;
}

gl::Readback ComputeTiles::fill(const Part& part) const {
    const gl::Buffer places = gl::Buffer::of(part.places);
    const gl::Buffer fragments(part.fragments * sizeof(DeviceFragment), nullptr);
    places.bind_storage(COMPUTE_COUNTS);
    fragments.bind_storage(COMPUTE_OUTPUT);
    dispatch(COMPUTE_PASS_FILL, m_lists.transparent);
    if (m_frame.statistics) m_frame.statistics->add(Counter::FragmentsStored, part.fragments);
    return gl::Readback(fragments, 0, fragments.size());
}

void ComputeTiles::collect(const Part& part, const gl::Readback& fragments) {
    const std::size_t samples = std::size_t{16} * m_samples_a_pixel;  // of a block
    const auto values = fragments.values<DeviceFragment>();
    auto from = values.begin();
    for (std::size_t sample = part.begin; sample < part.end; ++sample) {
        TileStore& store = m_bucket.store(m_first + m_lists.transparent[sample / samples].tile);
        FragmentLists& lists = store.lists;
        lists.prepare(store.key.size(), m_bucket.list_memory());
        for (const auto end = from + m_counts[sample]; from != end; ++from)
            lists.add(from->sample, {from->key, from->id, 0.0f, 0.0f, false});
    }
}

gl::Readback ComputeTiles::farthest() const {
    const gl::Buffer block_buffer = gl::Buffer::of(m_all_blocks);
    const gl::Buffer out(m_all_blocks.size() * sizeof(float), nullptr);
    m_device.farthest().use();
    block_buffer.bind_storage(COMPUTE_BLOCKS);
    m_seen.bind_storage(COMPUTE_SEEN);
    out.bind_storage(COMPUTE_OUTPUT);
    glUniform1ui(COMPUTE_SAMPLES_A_PIXEL, m_samples_a_pixel);
    glUniform1ui(COMPUTE_BLOCK_COUNT, static_cast<GLuint>(m_all_blocks.size()));
    glDispatchCompute(
        static_cast<GLuint>((m_all_blocks.size() + COMPUTE_GROUP_SIZE - 1) / COMPUTE_GROUP_SIZE), 1,
        1);
    gl::check("finding the farthest keys");
    count_dispatch();
    return gl::Readback(out, 0, out.size());
}

gl::Readback ComputeTiles::seen(std::size_t first, std::size_t count) const {
    const std::size_t bytes = kPixels * m_samples_a_pixel * sizeof(Seen);
    return gl::Readback(m_seen, (first - m_first) * bytes, count * bytes);
}

void ComputeTiles::take(const gl::Readback& seen, std::size_t first) {
    const std::size_t samples = kPixels * m_samples_a_pixel;
    const std::span<const Seen> values = seen.values<Seen>();
    for (std::size_t i = 0; i < values.size(); ++i) {
        TileStore& store = m_bucket.store(first + i / samples);
        store.key[i % samples] = values[i].key;
        store.id[i % samples] = values[i].id;
    }
}

void ComputeTiles::write_back(std::size_t tile) const {
    const TileStore& store = m_bucket.store(tile);
    std::vector<Seen> seen(store.key.size());
    for (std::size_t i = 0; i < seen.size(); ++i) seen[i] = {store.key[i], store.id[i]};
    m_seen.write((tile - m_first) * seen.size(), seen);
}

}  // namespace granita
