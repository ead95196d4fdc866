// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/raster/raster_hider.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>

#include "base/check.h"
#include "gl/gl_check.h"
#include "gl/query.h"
#include "hider/raster/raster_device.h"
#include "hider/raster/raster_geometry.h"
#include "shaders/shared/raster_layout.h"

namespace granita {

class RasterHider::Bucket : public RasterBucket {
  public:
    Bucket(RasterHider& hider, const Rect& pixels, std::span<const GridSweep* const> sweeps)
        : m_thread(hider.m_thread),
          m_frame(hider.m_frame),
          m_device(*hider.m_device),
          m_pixels(pixels),
          m_geometry(sweeps),
          m_opaque(all(m_geometry.opaque())),
          m_transparent(all(m_geometry.transparent())) {
        add(Counter::Micropolygons, m_geometry.micropolygons());
        report_dropped();
        const std::vector<Vec4f> opacity =
            m_transparent.empty() ? std::vector<Vec4f>{} : m_geometry.opacity();
        m_thread.run([&] { upload(opacity); });
    }
    ~Bucket() override {
        m_thread.run([&] {
            m_buffers.reset();
            m_marks = {};
            m_cells.clear();
        });
    }

    // In two jobs each: between them the device works for other buckets.
    std::vector<bool> find_seen() override {
        m_thread.run([&] { mark_seen(); });
        m_thread.run([&] { m_marks.wait(); });
        return seen_grids();
    }
    RasterImage render(const RasterBackground& background) override {
        const std::vector<Vec4f> radiance = m_geometry.radiance(m_seen);
        m_thread.run([&] { draw(radiance, background); });
        m_thread.run([&] {
            if (!m_cells.empty()) m_cells.back().image.wait();
        });
        return image();
    }
    std::vector<float> center_keys() override {
        return m_thread.run([&] { return center_keys_here(); });
    }
    RasterSurfaces surfaces(int pass) override {
        return m_thread.run([&] { return surfaces_here(pass); });
    }

  private:
    using Range = RasterGeometry::Range;
    using Ranges = std::vector<std::uint32_t>;
    struct Cell {
        Rect pixels;
        gl::Readback image;
    };

    static Ranges all(const std::vector<Range>& ranges) {
        Ranges indices(ranges.size());
        std::iota(indices.begin(), indices.end(), 0u);
        return indices;
    }

    void add(Counter counter, std::uint64_t n) const {
        if (m_frame.statistics != nullptr) m_frame.statistics->add(counter, n);
    }

    void report_dropped() const {
        for (const auto& [grid, micropolygons] : m_geometry.dropped()) {
            add(Counter::MicropolygonsDropped, micropolygons);
            if (m_frame.report != nullptr && m_frame.scene != nullptr)
                m_frame.report->warn(
                    "object '" + m_frame.scene->instances.at(grid->instance).name + "'",
                    "micropolygons with a vertex that is not finite were left out", micropolygons);
        }
    }

    void upload(const std::vector<Vec4f>& opacity) {
        // Whole or not at all: what is made here must not end on another thread.
        RasterBuffers buffers;
        buffers.positions = gl::Buffer::of(m_geometry.positions());
        buffers.grids = gl::Buffer::of(m_geometry.grid_places());
        buffers.vertex_grids = gl::Buffer::of(m_geometry.vertex_grids());
        buffers.indices = gl::Buffer::of(m_geometry.indices());
        buffers.array.set_uints(RASTER_GRID, buffers.vertex_grids);
        buffers.array.set_indices(buffers.indices);
        if (!m_transparent.empty()) {
            buffers.opacity = gl::Buffer::of(opacity);
            buffers.array.set_floats(RASTER_OPACITY, buffers.opacity, 4);
        }
        m_buffers = std::move(buffers);
    }

    /// The passes of a cell (paper, 9.3.5: clamped by motion and circle of confusion): one, where
    /// all would be the same.
    int pass_count(const RasterCell& cell, bool background_varies) const {
        const int passes = static_cast<int>(m_frame.passes.size());
        if (passes == 1 || background_varies) return passes;
        for (const auto* ranges : {&m_geometry.opaque(), &m_geometry.transparent()})
            for (const Range& range : *ranges)
                if ((range.knots > 1 || m_frame.projection.has_lens()) &&
                    RasterDevice::reaches(range.swept, cell))
                    return passes;
        return 1;
    }

    /// Calls `draw` with the passes of a cell, as many at once as the target has layers.
    template <class Draw>
    void for_passes(int passes, bool still, const Draw& draw) const {
        const int layers = m_device.target().layers();
        for (int first = 0; first < passes; first += layers)
            draw(RasterPasses{first, std::min(layers, passes - first), still});
    }

    void draw_opaque(RasterOutput output, const RasterCell& cell, const RasterPasses& passes) {
        m_device.draw(
            output, *m_buffers,
            m_device.commands(m_geometry, m_geometry.opaque(), m_opaque, cell, passes, m_seen),
            cell, passes);
    }

    std::vector<RasterDevice::Command> transparent_commands(const Ranges& among,
                                                            const RasterCell& cell,
                                                            const RasterPasses& passes) const {
        return m_device.commands(m_geometry, m_geometry.transparent(), among, cell, passes, m_seen);
    }

    int passes_of_frame() const { return static_cast<int>(m_frame.passes.size()); }

    void mark_seen() {
        const std::size_t words =
            m_geometry.inputs().size() * RasterSeen::words_for(passes_of_frame());
        const gl::Buffer marks = gl::Buffer::of(std::vector<std::uint32_t>(words, 0));
        const bool saturates = m_frame.cull_saturated && m_frame.opacity_threshold < 1.0f;
        for (const RasterCell& cell : m_device.target().cells(m_pixels)) {
            m_device.begin(cell);
            const std::vector<ZBatch> batches =
                saturates ? batches_of(cell) : std::vector<ZBatch>{};
            for_passes(pass_count(cell, false), false, [&](const RasterPasses& passes) {
                m_device.target().begin_surfaces(cell, m_device.farthest());
                draw_opaque(RasterOutput::Surface, cell, passes);
                if (!batches.empty()) peel(batches, cell, passes, &marks);
                m_device.mark_names(m_device.target().surfaces(), !batches.empty(), cell, passes,
                                    *m_buffers, marks);
                if (saturates) return;
                const auto commands = transparent_commands(m_transparent, cell, passes);
                if (commands.empty()) return;
                m_device.begin_marks(cell, marks);
                m_device.draw(RasterOutput::Mark, *m_buffers, commands, cell, passes);
            });
        }
        m_marks = gl::Readback(marks, 0, marks.size());
    }

    std::vector<bool> seen_grids() {
        const auto words = m_marks.values<std::uint32_t>();
        m_seen = RasterSeen({words.begin(), words.end()}, passes_of_frame());
        std::vector<bool> seen(m_geometry.inputs().size());
        for (std::size_t i = 0; i < seen.size(); ++i) seen[m_geometry.inputs()[i]] = m_seen.ever(i);
        return seen;
    }

    std::vector<ZBatch> batches_of(const RasterCell& cell) const {
        Ranges among;
        for (const std::uint32_t i : m_transparent)
            if (RasterDevice::reaches(m_geometry.transparent()[i].swept, cell)) among.push_back(i);
        return z_batches(m_geometry, among, m_frame.projection.near_clip, m_device.farthest(),
                         m_frame.z_batch_size);
    }

    /// The transparent grids of a cell, batch by batch and layer by layer, until no sample finds
    /// another one (paper, listing 1).  `marks`: what of them samples see, or nullptr.
    void peel(const std::vector<ZBatch>& batches, const RasterCell& cell,
              const RasterPasses& passes, const gl::Buffer* marks = nullptr) {
        RasterPeel& peel = m_device.peel();
        peel.begin(cell);
        for (const ZBatch& batch : batches) {
            const auto commands = transparent_commands(batch.ranges, cell, passes);
            if (commands.empty()) continue;
            // The answer is read one layer late, while the device draws the next one.
            std::optional<gl::Query> last;
            for (;;) {
                peel.begin_layer(cell, batch.farther_than);
                gl::Query any(GL_ANY_SAMPLES_PASSED);
                for (const RasterOutput output : peel.outputs()) {
                    peel.begin_output(output, cell);
                    const bool finds = output == peel.outputs().front();
                    if (finds) any.begin();
                    m_device.draw(output, *m_buffers, commands, cell, passes);
                    if (finds) any.end();
                }
                peel.composite(cell, passes.count, m_frame.opacity_threshold);
                if (marks != nullptr)
                    m_device.mark_names(peel.names(), false, cell, passes, *m_buffers, *marks);
                if (last && last->result() == 0) break;
                last.emplace(std::move(any));
            }
        }
    }

    void draw(const std::vector<Vec4f>& radiance, const RasterBackground& background) {
        m_buffers->radiance = gl::Buffer::of(radiance);
        m_buffers->array.set_floats(RASTER_RADIANCE, m_buffers->radiance, 4);
        const gl::Buffer corners = gl::Buffer::of(background.corners);
        m_cells.clear();
        for (const RasterCell& cell : m_device.target().cells(m_pixels)) {
            m_device.begin(cell);
            const int count = pass_count(cell, background.passes > 1);
            const std::vector<ZBatch> batches = batches_of(cell);
            for_passes(count, pass_count(cell, false) == 1, [&](const RasterPasses& passes) {
                m_device.target().begin_radiance(cell, m_device.farthest());
                draw_opaque(RasterOutput::Radiance, cell, passes);
                if (!batches.empty()) peel(batches, cell, passes);
                m_device.accumulate(cell, passes, !batches.empty(), background, corners);
            });
            m_cells.push_back({cell.pixels, m_device.target().resolve(cell, m_device.samples())});
            add(Counter::SamplesTotal,
                static_cast<std::uint64_t>(cell.pixels.width()) *
                    static_cast<std::uint64_t>(cell.pixels.height()) *
                    static_cast<std::uint64_t>(m_frame.table ? m_frame.table->samples()
                                                             : lattice().cells() * count));
        }
    }

    RasterImage image() const {
        RasterImage image{m_pixels, {}};
        image.combined.resize(static_cast<std::size_t>(m_pixels.width()) * m_pixels.height());
        for (const Cell& cell : m_cells)
            copy(cell.image.values<Vec4f>(), cell.pixels, 1, image.combined);
        return image;
    }

    float key_of_depth(float depth) const {
        const auto near_clip = static_cast<float>(m_frame.projection.near_clip);
        return m_frame.projection.perspective ? depth / near_clip : -(near_clip / depth);
    }

    void draw_surfaces(const RasterCell& cell, const RasterPasses& passes) {
        m_device.begin(cell);
        m_device.target().begin_surfaces(cell, m_device.farthest());
        draw_opaque(RasterOutput::Surface, cell, passes);
        if (!m_transparent.empty())
            m_device.draw(RasterOutput::Surface, *m_buffers,
                          transparent_commands(m_transparent, cell, passes), cell, passes);
    }

    std::vector<float> center_keys_here() {
        std::vector<float> keys(static_cast<std::size_t>(m_pixels.width()) * m_pixels.height());
        for (const RasterCell& cell : m_device.target().cells(m_pixels)) {
            draw_surfaces(cell, {0, 1});
            auto depths = m_device.target().center_depths(cell, m_device.samples());
            for (float& depth : depths)
                depth =
                    depth > 0.0f ? key_of_depth(depth) : -std::numeric_limits<float>::infinity();
            copy<float>(depths, cell.pixels, 1, keys);
        }
        return keys;
    }

    RasterSurfaces surfaces_here(int pass) {
        const int cells = lattice().cells();
        const std::size_t count =
            static_cast<std::size_t>(m_pixels.width()) * m_pixels.height() * cells;
        std::vector<std::uint32_t> names(count);
        std::vector<float> depths(count);
        for (const RasterCell& cell : m_device.target().cells(m_pixels)) {
            draw_surfaces(cell, {pass, 1});
            copy<std::uint32_t>(m_device.target().read_surfaces(cell), cell.pixels, cells, names);
            copy<float>(m_device.target().read_depth(cell), cell.pixels, cells, depths);
        }
        RasterSurfaces result{m_pixels, {}, {}};
        result.surface.resize(count);
        result.key.resize(count, -std::numeric_limits<float>::infinity());
        for (std::size_t i = 0; i < count; ++i) {
            if (names[i] == 0) continue;
            const RasterGeometry::Place place = m_geometry.locate(names[i] - 1);
            result.surface[i] = {static_cast<std::int32_t>(place.input), place.micropolygon};
            result.key[i] = key_of_depth(depths[i]);
        }
        return result;
    }

    const RegularLattice& lattice() const { return m_frame.filter.lattice; }

    // Rows of a cell into the bucket's image; `values` a pixel.
    template <class T>
    void copy(std::span<const T> from, const Rect& cell, int values, std::vector<T>& to) const {
        const std::ptrdiff_t width = static_cast<std::ptrdiff_t>(cell.width()) * values;
        const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(m_pixels.width()) * values;
        for (int row = 0; row < cell.height(); ++row)
            std::copy_n(from.begin() + row * width, width,
                        to.begin() + (cell.y0 - m_pixels.y0 + row) * stride +
                            (cell.x0 - m_pixels.x0) * values);
    }

    gl::GlThread& m_thread;
    const RasterFrame& m_frame;
    RasterDevice& m_device;
    Rect m_pixels;
    RasterGeometry m_geometry;
    Ranges m_opaque, m_transparent;
    std::optional<RasterBuffers> m_buffers;
    gl::Readback m_marks;
    RasterSeen m_seen;
    std::vector<Cell> m_cells;  ///< of the last draw()
};

std::vector<RasterPass> raster_passes(const SampleTable& table, SampleNeeds needs,
                                      const Projection& projection) {
    // Any pixel's samples of one place on the lattice.
    TileSamples samples;
    table.fill_tile({0, 0}, needs, samples);
    const int cells = table.lattice().cells();
    std::vector<RasterPass> passes;
    for (int s = 0; s < table.samples(); s += cells) {
        RasterPass& pass = passes.emplace_back();
        if (!samples.t.empty()) pass.t = samples.t[s];
        if (samples.u.empty()) continue;
        pass.u = samples.u[s];
        pass.v = samples.v[s];
        pass.inverse_focus = samples.inverse_focus.empty()
                                 ? static_cast<float>(1.0 / projection.focus)
                                 : samples.inverse_focus[s];
    }
    return passes;
}

RasterHider::RasterHider(gl::GlThread& thread, const RasterFrame& frame)
    : m_thread(thread), m_frame(frame) {
    GRANITA_CHECK(!frame.passes.empty());
    GRANITA_CHECK(frame.projection.near_clip > 0.0);
    m_device = thread.run([&] { return std::make_unique<RasterDevice>(m_frame, thread.info()); });
}

RasterHider::~RasterHider() {
    m_thread.run([&] { m_device.reset(); });
}

Rect RasterHider::sample_pixels(const Rect& pixels) const {
    const int margin = m_frame.filter.margin();
    return {pixels.x0 - margin, pixels.y0 - margin, pixels.x1 + margin, pixels.y1 + margin};
}

std::unique_ptr<RasterBucket> RasterHider::open(const Rect& pixels,
                                                std::span<const GridSweep* const> sweeps) {
    return std::make_unique<Bucket>(*this, pixels, sweeps);
}

std::unique_ptr<RasterBucket> RasterHider::open(const Rect& pixels,
                                                const std::vector<const Grid*>& grids) {
    const LensShape lens(0, 0.0f, Vec2f(1.0f));
    std::vector<GridSweep> sweeps;
    sweeps.reserve(grids.size());
    std::vector<const GridSweep*> pointers;
    pointers.reserve(grids.size());
    for (const Grid* grid : grids)
        pointers.push_back(&sweeps.emplace_back(*grid, m_frame.projection, lens));
    return open(pixels, std::span<const GridSweep* const>(pointers));
}

}  // namespace granita
