// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/raster_hider.h"

#include <cmath>
#include <limits>
#include <optional>

#include "base/check.h"
#include "gl/gl_check.h"
#include "gl/query.h"
#include "gl/shader_source.h"
#include "hider/raster_geometry.h"
#include "hider/raster_target.h"
#include "shaders/shared/raster_layout.h"

namespace granita {
namespace {

gl::Program grid_program(const Projection& projection, bool with_radiance) {
    const gl::Defines defines{{"PERSPECTIVE", projection.perspective ? "1" : "0"},
                              {"WITH_RADIANCE", with_radiance ? "1" : "0"}};
    return gl::Program("grids",
                       {{GL_VERTEX_SHADER, gl::shader_source("raster/grid.vert", defines)},
                        {GL_FRAGMENT_SHADER, gl::shader_source("raster/grid.frag", defines)}});
}

}  // namespace

// What all buckets share on the device; touched on the thread that owns OpenGL.
struct RasterHider::Device {
    RasterTarget target;
    gl::Program radiance, surfaces;

    Device(const RasterFrame& frame, int max_texture_size)
        : target(frame.filter, max_texture_size),
          radiance(grid_program(frame.projection, true)),
          surfaces(grid_program(frame.projection, false)) {}
};

class RasterHider::Bucket : public RasterBucket {
  public:
    Bucket(RasterHider& hider, const Rect& pixels, const std::vector<const Grid*>& grids)
        : m_thread(hider.m_thread),
          m_frame(hider.m_frame),
          m_device(*hider.m_device),
          m_pixels(pixels),
          m_geometry(grids) {
        add(Counter::Micropolygons, m_geometry.micropolygons());
        add(Counter::MicropolygonsDropped, m_geometry.dropped());
        m_thread.run([&] {
            // Whole or not at all: what is made here must not end on another thread.
            Buffers buffers;
            buffers.positions = gl::Buffer::of(m_geometry.positions());
            buffers.indices = gl::Buffer::of(m_geometry.indices());
            buffers.array.set_floats(RASTER_POSITION, buffers.positions, 3);
            buffers.array.set_indices(buffers.indices);
            m_buffers = std::move(buffers);
        });
    }
    ~Bucket() override {
        m_thread.run([&] { m_buffers.reset(); });
    }

    std::vector<std::uint64_t> count_visible() override {
        return m_thread.run([&] { return count_visible_here(); });
    }
    RasterImage render() override {
        return m_thread.run([&] { return render_here(); });
    }
    RasterSurfaces surfaces() override {
        return m_thread.run([&] { return surfaces_here(); });
    }

  private:
    using Range = RasterGeometry::Range;
    struct Buffers {
        gl::Buffer positions, indices, radiance;
        gl::VertexArray array;
    };

    void add(Counter counter, std::uint64_t n) const {
        if (m_frame.statistics != nullptr) m_frame.statistics->add(counter, n);
    }
    // Depth is near / z: the far clip is a depth that the target starts with.
    float farthest() const {
        return static_cast<float>(m_frame.projection.near_clip / m_frame.projection.far_clip);
    }
    float key_of_depth(float depth) const {
        const auto near_clip = static_cast<float>(m_frame.projection.near_clip);
        return m_frame.projection.perspective ? depth / near_clip : -(near_clip / depth);
    }

    static bool reaches(const Grid& grid, const RasterCell& cell) {
        const RasterBounds& b = grid.bounds;
        const Rect& s = cell.samples;
        return b.visible && b.x1 >= static_cast<float>(s.x0) && b.x0 <= static_cast<float>(s.x1) &&
               b.y1 >= static_cast<float>(s.y0) && b.y0 <= static_cast<float>(s.y1);
    }

    void use(const gl::Program& program, const RasterCell& cell) const {
        const Projection& p = m_frame.projection;
        const Vec2d per_pixel(2.0 / m_device.target.pixel_size());
        const Vec2d scale = p.scale * per_pixel;
        const Vec2d center = (p.center - Vec2d(cell.corner)) * per_pixel - Vec2d(1.0);
        program.use();
        glUniform2d(RASTER_CLIP_SCALE, scale.x, scale.y);
        glUniform2d(RASTER_CLIP_CENTER, center.x, center.y);
        glUniform1f(RASTER_NEAR, static_cast<float>(p.near_clip));
        m_buffers->array.bind();
    }

    static const void* offset(const Range& range) {
        return reinterpret_cast<const void*>(static_cast<std::uintptr_t>(range.first_index) *
                                             sizeof(std::uint32_t));
    }

    // One pass over the bucket's grids in the order of the pool, which is how ties are decided.
    // The result counts the primitives; it is read late, so that nobody waits.
    gl::Query draw(const RasterCell& cell) const {
        std::vector<GLsizei> counts;
        std::vector<const void*> offsets;
        for (const Range& range : m_geometry.ranges())
            if (reaches(*range.grid, cell)) {
                counts.push_back(static_cast<GLsizei>(range.index_count));
                offsets.push_back(offset(range));
            }
        gl::Query primitives(GL_PRIMITIVES_GENERATED);
        primitives.begin();
        glMultiDrawElements(GL_TRIANGLES, counts.data(), GL_UNSIGNED_INT, offsets.data(),
                            static_cast<GLsizei>(counts.size()));
        primitives.end();
        gl::check("drawing grids");
        add(Counter::GlPasses, 1);
        return primitives;
    }

    gl::Query draw_surfaces(const RasterCell& cell) {
        m_device.target.begin_surfaces(cell, farthest());
        use(m_device.surfaces, cell);
        return draw(cell);
    }

    std::vector<std::uint64_t> count_visible_here() {
        std::vector<std::uint64_t> counts(m_geometry.ranges().size(), 0);
        for (const RasterCell& cell : m_device.target.cells(m_pixels)) {
            const gl::Query primitives = draw_surfaces(cell);
            // The same program finds the same depths: a grid's own samples pass, and no others.
            glDepthFunc(GL_EQUAL);
            glDepthMask(GL_FALSE);
            glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
            std::vector<std::pair<std::uint32_t, gl::Query>> queries;
            for (const Range& range : m_geometry.ranges()) {
                if (!reaches(*range.grid, cell)) continue;
                queries.emplace_back(range.input, gl::Query(GL_SAMPLES_PASSED));
                queries.back().second.begin();
                glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(range.index_count),
                               GL_UNSIGNED_INT, offset(range));
                queries.back().second.end();
            }
            gl::check("counting visible samples");
            for (const auto& [input, query] : queries) counts[input] += query.result();
            add(Counter::GlPasses, 1);
            add(Counter::GlPrimitives, primitives.result());
        }
        m_visible = counts;
        return counts;
    }

    void upload_radiance() {
        for (const Range& range : m_geometry.ranges()) {
            const bool unseen = m_visible && (*m_visible)[range.input] == 0;
            if (unseen || range.grid->holdout) continue;
            GRANITA_CHECK_EQ(range.grid->radiance.size(),
                             static_cast<std::size_t>(range.grid->vertex_count()));
        }
        m_buffers->radiance = gl::Buffer::of(m_geometry.radiance());
        m_buffers->array.set_floats(RASTER_RADIANCE, m_buffers->radiance, 4);
    }

    RasterImage render_here() {
        upload_radiance();
        RasterImage image{m_pixels, {}};
        image.combined.resize(static_cast<std::size_t>(m_pixels.width()) * m_pixels.height());
        for (const RasterCell& cell : m_device.target.cells(m_pixels)) {
            m_device.target.begin_radiance(cell, m_frame.background, farthest());
            use(m_device.radiance, cell);
            const gl::Query primitives = draw(cell);
            copy(m_device.target.resolve(cell), cell.pixels, 1, image.combined);
            add(Counter::SamplesTotal, static_cast<std::uint64_t>(cell.texels.width) *
                                           static_cast<std::uint64_t>(cell.texels.height));
            add(Counter::GlPrimitives, primitives.result());
        }
        return image;
    }

    RasterSurfaces surfaces_here() {
        const int lattice = m_frame.filter.lattice;
        const std::size_t count =
            static_cast<std::size_t>(m_pixels.width()) * m_pixels.height() * lattice * lattice;
        std::vector<std::uint32_t> names(count);
        std::vector<float> depths(count);
        for (const RasterCell& cell : m_device.target.cells(m_pixels)) {
            const gl::Query primitives = draw_surfaces(cell);
            copy(m_device.target.read_surfaces(cell), cell.pixels, lattice, names);
            copy(m_device.target.read_depth(cell), cell.pixels, lattice, depths);
            add(Counter::GlPrimitives, primitives.result());
        }
        RasterSurfaces result{m_pixels, lattice, {}, {}};
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

    // Rows of a cell into the bucket's image; `scale` values a pixel and axis.
    template <class T>
    void copy(const std::vector<T>& from, const Rect& cell, int scale, std::vector<T>& to) const {
        const std::ptrdiff_t width = static_cast<std::ptrdiff_t>(cell.width()) * scale;
        const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(m_pixels.width()) * scale;
        for (int row = 0; row < cell.height() * scale; ++row)
            std::copy_n(from.begin() + row * width, width,
                        to.begin() + ((cell.y0 - m_pixels.y0) * scale + row) * stride +
                            (cell.x0 - m_pixels.x0) * scale);
    }

    gl::GlThread& m_thread;
    const RasterFrame& m_frame;
    Device& m_device;
    Rect m_pixels;
    RasterGeometry m_geometry;
    std::optional<Buffers> m_buffers;
    std::optional<std::vector<std::uint64_t>> m_visible;
};

RasterHider::RasterHider(gl::GlThread& thread, const RasterFrame& frame)
    : m_thread(thread), m_frame(frame) {
    GRANITA_CHECK(!frame.projection.has_lens());
    GRANITA_CHECK(frame.projection.near_clip > 0.0);
    m_device =
        thread.run([&] { return std::make_unique<Device>(frame, thread.info().max_texture_size); });
}

RasterHider::~RasterHider() {
    m_thread.run([&] { m_device.reset(); });
}

Rect RasterHider::sample_pixels(const Rect& pixels) const {
    const int apron = m_frame.filter.apron();
    return {pixels.x0 - apron, pixels.y0 - apron, pixels.x1 + apron, pixels.y1 + apron};
}

std::unique_ptr<RasterBucket> RasterHider::open(const Rect& pixels,
                                                const std::vector<const Grid*>& grids) {
    for (const Grid* grid : grids) GRANITA_CHECK(can_draw(*grid));
    return std::make_unique<Bucket>(*this, pixels, grids);
}

}  // namespace granita
