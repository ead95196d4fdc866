// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/compute/compute_tiles.h"

#include <bit>
#include <cmath>
#include <span>
#include <string>

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
constexpr std::size_t kFragmentBytes = sizeof(DeviceFragment);
static_assert(kFragmentBytes == 12);
constexpr std::uint32_t kSkip = ~std::uint32_t{0};

struct GridOrder {
    std::uint32_t base, key[4];
};

struct Seen {
    float key;
    SurfaceId id;
};

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
      m_seen(m_stride * sizeof(Seen), nullptr) {
    const std::uint32_t nothing[2] = {std::bit_cast<std::uint32_t>(-INFINITY), kNoSurface};
    glClearNamedBufferData(m_seen.name(), GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT, nothing);
    upload_samples(false);
}

void ComputeTiles::upload_samples(bool time) {
    const Projection& projection = m_frame.projection;
    const Vec2f lens(projection.lens_radius * projection.scale);
    std::vector<float> values;
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
    m_samples = gl::Buffer::of(values);
    m_has_time = time;
}

// The whole pool each time: ties with surfaces of earlier batches need their grids.
void ComputeTiles::upload_grids() {
    const GridPool& pool = m_bucket.pool();
    std::vector<GridOrder> order;
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
    m_grids = gl::Buffer::of(order);
}

void ComputeTiles::hide(const ComputeBatch& batch) {
    const ComputeBatch::Lists lists = batch.lists();
    if (batch.moving() && !m_has_time) upload_samples(true);
    upload_grids();
    m_entries = gl::Buffer::of(lists.entries);
    m_vertices = gl::Buffer::of(batch.vertices());
    const bool lens = m_frame.projection.has_lens();
    if (!lists.opaque.empty())
        dispatch(m_device.hide({COMPUTE_PASS_OPAQUE, batch.moving(), lens}), lists.opaque);
    if (!lists.transparent.empty()) hide_transparent(lists.transparent, batch.moving());
}

void ComputeTiles::count_dispatch() const {
    if (m_frame.statistics) m_frame.statistics->add(Counter::GlDispatches);
}

void ComputeTiles::dispatch(const gl::Program& program, const std::vector<ComputeBlock>& blocks) {
    const gl::Buffer block_buffer = gl::Buffer::of(blocks);
    const Projection& projection = m_frame.projection;
    const DepthRange range = depth_range(projection);
    program.use();
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
    glUniform1ui(COMPUTE_GRID_COUNT, static_cast<GLuint>(m_bucket.pool().size()));
    glUniform1i(COMPUTE_PERSPECTIVE, range.perspective);
    glUniform2f(COMPUTE_KEY_RANGE, range.key_far, range.key_near);
    const auto groups =
        static_cast<GLuint>((16 * m_samples_a_pixel + COMPUTE_GROUP_SIZE - 1) / COMPUTE_GROUP_SIZE);
    glDispatchCompute(static_cast<GLuint>(blocks.size()), groups, 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    gl::check("hiding micropolygons");
    count_dispatch();
}

// Two passes, so that nothing can overflow: the first counts, the second fills as many parts as the
// limits ask for.
void ComputeTiles::hide_transparent(const std::vector<ComputeBlock>& blocks, bool moving) {
    const std::size_t cells = std::size_t{16} * m_samples_a_pixel;  // of a block
    const std::size_t limit = m_device.limits().buffer_bytes / kFragmentBytes;
    const gl::Buffer count_buffer(blocks.size() * cells * sizeof(std::uint32_t), nullptr);
    count_buffer.bind_storage(COMPUTE_COUNTS);
    dispatch(m_device.hide({COMPUTE_PASS_COUNT, moving, m_frame.projection.has_lens()}), blocks);
    const auto counts = count_buffer.read<std::uint32_t>();

    std::size_t begin = 0, total = 0;
    for (std::size_t cell = 0; cell < counts.size(); ++cell) {
        if (total + counts[cell] > limit && total > 0) {
            fill(blocks, counts, begin, cell, static_cast<std::uint32_t>(total), moving);
            begin = cell;
            total = 0;
        }
        total += counts[cell];
    }
    if (total > 0)
        fill(blocks, counts, begin, counts.size(), static_cast<std::uint32_t>(total), moving);
}

void ComputeTiles::fill(const std::vector<ComputeBlock>& blocks,
                        const std::vector<std::uint32_t>& counts, std::size_t begin,
                        std::size_t end, std::uint32_t total, bool moving) {
    std::vector<std::uint32_t> places(counts.size(), kSkip);
    std::uint32_t next = 0;
    for (std::size_t cell = begin; cell < end; ++cell) {
        if (counts[cell] > 0) places[cell] = next;
        next += counts[cell];
    }
    const gl::Buffer place_buffer = gl::Buffer::of(places);
    const gl::Buffer fragment_buffer(total * kFragmentBytes, nullptr);
    place_buffer.bind_storage(COMPUTE_COUNTS);
    fragment_buffer.bind_storage(COMPUTE_OUTPUT);
    dispatch(m_device.hide({COMPUTE_PASS_FILL, moving, m_frame.projection.has_lens()}), blocks);

    const auto fragments = fragment_buffer.read<DeviceFragment>();
    auto from = fragments.begin();
    const std::size_t cells = std::size_t{16} * m_samples_a_pixel;
    for (std::size_t cell = begin; cell < end; ++cell) {
        TileStore& store = m_bucket.store(m_first + blocks[cell / cells].tile);
        FragmentLists& lists = store.lists;
        lists.prepare(store.key.size(), m_bucket.list_memory());
        for (const auto end_of_cell = from + counts[cell]; from != end_of_cell; ++from)
            lists.add(from->sample, {from->key, from->id, 0.0f, 0.0f, false});
    }
    if (m_frame.statistics) m_frame.statistics->add(Counter::FragmentsStored, total);
}

std::vector<float> ComputeTiles::farthest() {
    std::vector<ComputeBlock> blocks;
    for (std::uint32_t tile = 0; tile < m_count; ++tile) {
        const Rect pixels = m_bucket.local_pixels(m_first + tile);
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
    const gl::Buffer block_buffer = gl::Buffer::of(blocks);
    const gl::Buffer out(blocks.size() * sizeof(float), nullptr);
    m_device.farthest().use();
    block_buffer.bind_storage(COMPUTE_BLOCKS);
    m_seen.bind_storage(COMPUTE_SEEN);
    out.bind_storage(COMPUTE_OUTPUT);
    glUniform1ui(COMPUTE_SAMPLES_A_PIXEL, m_samples_a_pixel);
    glUniform1ui(COMPUTE_BLOCK_COUNT, static_cast<GLuint>(blocks.size()));
    glDispatchCompute(
        static_cast<GLuint>((blocks.size() + COMPUTE_GROUP_SIZE - 1) / COMPUTE_GROUP_SIZE), 1, 1);
    gl::check("finding the farthest keys");
    count_dispatch();
    return out.read<float>();
}

void ComputeTiles::read_back(std::size_t tile) {
    const std::size_t samples = kPixels * m_samples_a_pixel;
    const auto seen = m_seen.read<Seen>((tile - m_first) * samples, samples);
    TileStore& store = m_bucket.store(tile);
    for (std::size_t i = 0; i < samples; ++i) {
        store.key[i] = seen[i].key;
        store.id[i] = seen[i].id;
    }
}

void ComputeTiles::write_back(std::size_t tile) {
    const TileStore& store = m_bucket.store(tile);
    std::vector<Seen> seen(store.key.size());
    for (std::size_t i = 0; i < seen.size(); ++i) seen[i] = {store.key[i], store.id[i]};
    m_seen.write((tile - m_first) * seen.size(), seen);
}

}  // namespace granita
