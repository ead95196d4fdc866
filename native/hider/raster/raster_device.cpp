// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/raster/raster_device.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <string>

#include "base/error.h"
#include "gl/gl_check.h"
#include "gl/shader_source.h"
#include "hider/bucket_tiles.h"
#include "shaders/shared/compute_layout.h"
#include "shaders/shared/raster_layout.h"

namespace granita {
namespace {

const char* name_of(RasterOutput output) {
    constexpr const char* kNames[] = {"SURFACE",    "RADIANCE",       "LAYER",        "MARK",
                                      "LAYER_NAME", "LAYER_RADIANCE", "LAYER_OPACITY"};
    return kNames[static_cast<int>(output)];
}

int layers_wanted(const RasterFrame& frame, const gl::ContextInfo& info) {
    if (!info.layer_in_vertex_shader) return 1;
    return std::clamp(frame.most_layers, 1, static_cast<int>(frame.passes.size()));
}

gl::Program accumulate_program(const RasterFrame& frame, const RasterTarget& target) {
    gl::Defines defines = target.lattice_defines();
    defines.emplace_back("AT_SAMPLE", frame.table != nullptr ? "1" : "0");
    return gl::Program("passes",
                       {{GL_COMPUTE_SHADER, gl::shader_source("raster/accumulate.comp", defines)}});
}

std::vector<Vec4f> device_passes(const RasterFrame& frame) {
    const auto radius = static_cast<float>(frame.projection.lens_radius);
    std::vector<Vec4f> passes;
    for (const RasterPass& p : frame.passes)
        passes.emplace_back(p.t, p.u * radius, p.v * radius, p.inverse_focus);
    return passes;
}

}  // namespace

RasterDevice::RasterDevice(const RasterFrame& frame, const gl::ContextInfo& info)
    : m_frame(frame),
      m_target(frame.filter, layers_wanted(frame, info), info.max_texture_size),
      m_accumulate(accumulate_program(frame, m_target)),
      m_mark("seen grids", {{GL_COMPUTE_SHADER, gl::shader_source("raster/mark_seen.comp")}}),
      m_mark_target(&m_target.radiance(), nullptr),
      m_passes(gl::Buffer::of(device_passes(frame))) {
    if (frame.table != nullptr) m_samples.emplace(*frame.table, frame.needs, frame.projection);
    const int kBlocks = m_samples ? 4 : 3;
    if (info.vertex_storage_blocks < kBlocks)
        throw GlError("the device's vertex shaders read " +
                      std::to_string(info.vertex_storage_blocks) + " storage blocks, " +
                      std::to_string(kBlocks) + " are needed");
    std::vector<std::uint32_t> layers(static_cast<std::size_t>(m_target.layers()));
    std::iota(layers.begin(), layers.end(), 0u);
    m_layers = gl::Buffer::of(layers);
}

void RasterDevice::begin(const RasterCell& cell) {
    if (m_samples) m_samples->load(cell);
}

bool RasterDevice::reaches(const RasterBounds& b, const RasterCell& cell) {
    const Rect& s = cell.samples;
    return b.visible && b.x1 >= static_cast<float>(s.x0) && b.x0 <= static_cast<float>(s.x1) &&
           b.y1 >= static_cast<float>(s.y0) && b.y0 <= static_cast<float>(s.y1);
}

gl::Program RasterDevice::make_program(RasterOutput output) const {
    const std::string shaders = m_samples ? "raster/sample" : "raster/grid";
    gl::Defines defines{{"PERSPECTIVE", m_frame.projection.perspective ? "1" : "0"},
                        {"LAYERED", m_target.layers() > 1 ? "1" : "0"},
                        {"OUTPUT", name_of(output)}};
    if (m_samples) {
        defines.emplace_back("MOTION", m_samples->needs().time ? "1" : "0");
        defines.emplace_back("LENS", m_samples->needs().lens ? "1" : "0");
        defines.emplace_back("LIFESPANS", m_frame.lifespans ? "1" : "0");
    }
    return gl::Program("grids",
                       {{GL_VERTEX_SHADER, gl::shader_source(shaders + ".vert", defines)},
                        {GL_FRAGMENT_SHADER, gl::shader_source(shaders + ".frag", defines)}});
}

gl::Program& RasterDevice::program(RasterOutput output) {
    auto& program = m_programs[static_cast<int>(output)];
    if (!program) program.emplace(make_program(output));
    return *program;
}

RasterPeel& RasterDevice::peel() {
    if (!m_peel) m_peel.emplace(m_target, m_frame.most_targets);
    return *m_peel;
}

std::vector<RasterDevice::Command> RasterDevice::commands(
    const RasterGeometry& geometry, const std::vector<RasterGeometry::Range>& ranges,
    const std::vector<std::uint32_t>& among, const RasterCell& cell, const RasterPasses& passes,
    const RasterSeen& seen) const {
    std::vector<Command> commands;
    for (const std::uint32_t i : among) {
        const RasterGeometry::Range& range = ranges[i];
        if (!reaches(range.swept, cell)) continue;
        int first = 0, end = m_samples ? std::max(1, range.knots - 1) : passes.count;
        const auto touches = [&](int layer) {
            const int pass = m_samples ? 0 : passes.first + layer;
            if (!seen.in_pass(range.first_grid, range.end_grid, passes.still ? 0 : pass))
                return false;
            if (range.knots == 1 || m_samples) return true;
            const float t = m_frame.passes[pass].t;
            return range.lifespan.contains(t) &&
                   reaches(geometry.bounds_at(range, m_frame.projection, t), cell);
        };
        while (first < end && !touches(first)) ++first;
        while (end > first && !touches(end - 1)) --end;
        if (first == end) continue;
        const auto layer = static_cast<GLuint>(first), layers = static_cast<GLuint>(end - first);
        if (!commands.empty()) {
            Command& last = commands.back();
            if (last.first_index + last.count == range.first_index &&
                last.first_instance == layer && last.instances == layers) {
                last.count += range.index_count;
                continue;
            }
        }
        commands.push_back({range.index_count, layers, range.first_index, 0, layer});
    }
    return commands;
}

double RasterDevice::lattice_turn() const {
    const RegularLattice& lattice = m_target.lattice();
    return lattice.rotated ? 1.0 / lattice.side : 0.0;
}

void RasterDevice::set_cell(const RasterCell& cell) const {
    const Projection& p = m_frame.projection;
    const RegularLattice& lattice = m_target.lattice();
    const double texel = 2.0 / m_target.texel_size(), turn = lattice_turn();
    const double per_pixel = 2.0 * lattice.side / m_target.texel_size();
    // Where the corner's place, rotated, must be; half a texel as regular_lattice.h says.
    Vec2d corner = texel * Vec2d(m_target.origin()) - Vec2d(1.0);
    if (lattice.rotated && lattice.side % 2 == 1) corner.y += 0.5 * texel;
    corner = (corner - turn * Vec2d(corner.y, -corner.x)) / (1.0 + turn * turn);
    const Vec2d scale = p.scale * per_pixel;
    const Vec2d center = (p.center - Vec2d(cell.corner)) * per_pixel + corner;
    glUniform2d(RASTER_CLIP_SCALE, scale.x, scale.y);
    glUniform2d(RASTER_CLIP_CENTER, center.x, center.y);
    glUniform1f(RASTER_NEAR, static_cast<float>(p.near_clip));
}

void RasterDevice::draw(RasterOutput output, const RasterBuffers& buffers,
                        const std::vector<Command>& commands, const RasterCell& cell,
                        const RasterPasses& passes) {
    program(output).use();
    set_cell(cell);
    if (output == RasterOutput::Mark) set_marked(passes);
    buffers.positions.bind_storage(RASTER_POSITIONS);
    buffers.grids.bind_storage(RASTER_GRIDS);
    buffers.array.bind();
    if (m_samples)
        draw_samples(buffers, commands);
    else
        draw_passes(buffers, commands, passes);
    gl::check("drawing grids");
    if (m_frame.statistics == nullptr) return;
    std::uint64_t indices = 0;
    for (const Command& c : commands) indices += std::uint64_t{c.count} * c.instances;
    m_frame.statistics->add(Counter::GlPasses, 1);
    m_frame.statistics->add(Counter::GlPrimitives, (m_samples ? 2 : 1) * indices / 3);
}

void RasterDevice::draw_passes(const RasterBuffers& buffers, const std::vector<Command>& commands,
                               const RasterPasses& passes) const {
    glUniform1ui(RASTER_FIRST_PASS, static_cast<GLuint>(passes.first));
    glUniform1d(RASTER_LATTICE_TURN, lattice_turn());
    m_passes.bind_storage(RASTER_PASSES);
    buffers.array.set_uints(RASTER_LAYER, m_layers, true);
    const gl::Buffer indirect = gl::Buffer::of(commands);
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, indirect.name());
    glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, nullptr,
                                static_cast<GLsizei>(commands.size()), 0);
}

void RasterDevice::draw_samples(const RasterBuffers& buffers,
                                const std::vector<Command>& commands) const {
    const Projection& p = m_frame.projection;
    const DepthRange range = depth_range(p);
    const LensShape& lens = m_frame.table->lens();
    glUniform2f(RASTER_LENS_RADIUS, static_cast<float>(p.lens_radius * lens.extent().x),
                static_cast<float>(p.lens_radius * lens.extent().y));
    glUniform1f(RASTER_CELL_SIZE, static_cast<float>(m_target.pixel_size()));
    glUniform2d(RASTER_RASTER_SCALE, p.scale.x, p.scale.y);
    glUniform2d(RASTER_RASTER_CENTER, p.center.x, p.center.y);
    glUniform1i(COMPUTE_PERSPECTIVE, range.perspective);
    glUniform2f(COMPUTE_KEY_RANGE, range.key_far, range.key_near);
    if (p.has_lens()) glUniform2d(RASTER_INVERSE_FOCUS, 1.0 / p.focus, 1.0 / p.farthest_focus());
    m_samples->bind();
    buffers.indices.bind_storage(RASTER_TRIANGLES);
    buffers.vertex_grids.bind_storage(RASTER_VERTEX_GRIDS);
    // Before shading there is no radiance, and what peeling reads of it is not used.
    const bool shaded = buffers.radiance.name() != 0;
    (shaded ? buffers.radiance : buffers.opacity).bind_storage(RASTER_VERTEX_RADIANCE);
    buffers.opacity.bind_storage(RASTER_VERTEX_OPACITY);
    // Six vertices for the three indices of a triangle; an instance a segment of the motion.
    std::vector<std::array<GLuint, 4>> draws;
    draws.reserve(commands.size());
    for (const Command& c : commands)
        draws.push_back({2 * c.count, c.instances, 2 * c.first_index, 0});
    const gl::Buffer indirect = gl::Buffer::of(draws);
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, indirect.name());
    glMultiDrawArraysIndirect(GL_TRIANGLES, nullptr, static_cast<GLsizei>(draws.size()), 0);
}

void RasterDevice::accumulate(const RasterCell& cell, const RasterPasses& passes, bool peeled,
                              const RasterBackground& background, const gl::Buffer& corners) {
    const Rect& b = background.pixels;
    m_accumulate.use();
    if (m_samples) m_samples->bind();
    glUniform2i(RASTER_COUNT, passes.first, passes.count);
    glUniform2i(RASTER_CELL_PIXEL, cell.corner.x - b.x0, cell.corner.y - b.y0);
    glUniform3i(RASTER_BACKGROUND_SIZE, b.empty() ? 0 : b.width() + 1, b.height() + 1,
                background.passes);
    glUniform4fv(RASTER_BACKGROUND_CONSTANT, 1, &background.constant.x);
    glUniform2i(RASTER_FLAGS, peeled, m_frame.film_transparent);
    if (peeled) m_peel->bind_result();
    m_target.mean().bind_image(0, GL_READ_WRITE);
    m_target.radiance().bind_image(1, GL_READ_WRITE);
    if (!b.empty()) corners.bind_storage(RASTER_BACKGROUND);
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
    m_target.dispatch(cell, 1);
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
    gl::check("accumulating passes");
    m_target.emptied();
}

void RasterDevice::mark_names(const gl::Texture& names, bool but_saturated, const RasterCell& cell,
                              const RasterPasses& passes, const RasterBuffers& buffers,
                              const gl::Buffer& seen) const {
    m_mark.use();
    set_marked(passes);
    glUniform1i(RASTER_HIDE_SATURATED, but_saturated);
    if (but_saturated) m_peel->peeled_depth().bind(1);
    names.bind(0);
    buffers.vertex_grids.bind_storage(RASTER_GRIDS);
    seen.bind_storage(RASTER_SEEN);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    m_target.dispatch(cell, passes.count);
    gl::check("marking what is seen");
}

void RasterDevice::begin_marks(const RasterCell& cell, const gl::Buffer& seen) const {
    m_target.bind(m_mark_target, cell);
    glDisable(GL_DEPTH_TEST);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    m_target.depth().bind(RASTER_OPAQUE_DEPTH);
    seen.bind_storage(RASTER_SEEN);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void RasterDevice::set_marked(const RasterPasses& passes) const {
    glUniform2ui(
        RASTER_MARKED, static_cast<GLuint>(passes.first),
        static_cast<GLuint>(RasterSeen::words_for(static_cast<int>(m_frame.passes.size()))));
}

float RasterDevice::farthest() const {
    return static_cast<float>(m_frame.projection.near_clip / m_frame.projection.far_clip);
}

}  // namespace granita
