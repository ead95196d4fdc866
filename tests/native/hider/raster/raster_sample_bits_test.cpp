// SPDX-License-Identifier: GPL-3.0-or-later
// SampleTable in GLSL against C++, bit by bit.
#include <gtest/gtest.h>

#include <bit>

#include "gl/buffer.h"
#include "gl/gl_check.h"
#include "gl/program.h"
#include "gl/shader_source.h"
#include "hider/samples/sample_table.h"
#include "raster_scene.h"

namespace granita::raster_test {
namespace {

// One invocation a sample of a tile writes x, y, t, u, v as bits.
constexpr char kKernel[] = R"(
layout(local_size_x = 64) in;
layout(std430, binding = 0) writeonly buffer Table { uint table[]; };
layout(location = 0) uniform ivec2 tile;
layout(location = 1) uniform uint samples;
layout(location = 2) uniform uint seed;
layout(location = 3) uniform uint lattice;  // side; 0 = INDEPENDENT
layout(location = 4) uniform bool rotated;

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= 256u * samples) return;
    const uint p = i / samples, s = i % samples;
    const ivec2 in_tile = ivec2(p % 16u, p / 16u);
    const ivec2 pixel = tile * 16 + in_tile;
    float values[5];
    if (lattice == 0u) {
        for (uint d = 0u; d < 5u; ++d) values[d] = independent_sample(pixel, s, samples, seed, d);
    } else {
        const uint cells = regular_cells(lattice, rotated);
        const vec2 place = regular_place(s, lattice, rotated);
        const vec3 pass = regular_pass(s, cells, samples / cells);
        values = float[5](place.x, place.y, pass.x, pass.y, pass.z);
    }
    values[0] += float(in_tile.x);
    values[1] += float(in_tile.y);
    for (uint d = 0u; d < 5u; ++d) table[i * 5u + d] = floatBitsToUint(values[d]);
}
)";

/// [256 * samples][5] as the kernel writes it.
std::vector<std::uint32_t> table_on_device(const SampleTable& table, Vec2i tile) {
    return gl_thread().run([&] {
        const gl::Program program(
            "sample table",
            {{GL_COMPUTE_SHADER, gl::shader_source("shared/sample_table.glsl") + kKernel}});
        const auto samples = static_cast<GLuint>(table.samples());
        const gl::Buffer buffer(std::size_t{256} * samples * 5 * sizeof(std::uint32_t), nullptr);
        program.use();
        buffer.bind_storage(0);
        glUniform2i(0, tile.x, tile.y);
        glUniform1ui(1, samples);
        glUniform1ui(2, table.seed());
        const bool regular = table.sampling() == Sampling::Regular;
        glUniform1ui(3, regular ? static_cast<GLuint>(table.lattice().side) : 0);
        glUniform1i(4, table.lattice().rotated);
        glDispatchCompute((256 * samples + 63) / 64, 1, 1);
        gl::check("filling a sample table");
        return buffer.read<std::uint32_t>();
    });
}

struct TableCase {
    Sampling sampling;
    int samples;
    std::uint32_t seed;
    Vec2i tile;
};

class SampleTableBits : public testing::TestWithParam<TableCase> {};

TEST_P(SampleTableBits, are_the_same_in_glsl) {
    const TableCase& c = GetParam();
    Options options;
    options.sampling = c.sampling;
    options.samples = c.samples;
    options.seed = c.seed;
    options.time_samples = 12;
    Camera camera;
    camera.projection.lens_radius = 0.1;
    camera.blades = 5;
    const SampleTable table(options, camera);
    TileSamples expected;
    table.fill_tile(c.tile, {.time = true, .lens = true}, expected);

    std::vector<std::uint32_t> device = table_on_device(table, c.tile);
    ASSERT_EQ(device.size(), 5 * expected.x.size());
    // The lens is mapped by the CPU for every device.
    std::vector<float> u, v;
    for (std::size_t i = 0; i < expected.x.size(); ++i) {
        u.push_back(std::bit_cast<float>(device[5 * i + 3]));
        v.push_back(std::bit_cast<float>(device[5 * i + 4]));
    }
    table.lens().map(u.data(), v.data(), u.size());

    std::size_t different[5] = {};
    for (std::size_t i = 0; i < expected.x.size(); ++i) {
        different[0] += device[5 * i] != std::bit_cast<std::uint32_t>(expected.x[i]);
        different[1] += device[5 * i + 1] != std::bit_cast<std::uint32_t>(expected.y[i]);
        different[2] += device[5 * i + 2] != std::bit_cast<std::uint32_t>(expected.t[i]);
        different[3] += u[i] != expected.u[i];
        different[4] += v[i] != expected.v[i];
    }
    for (int d = 0; d < 5; ++d) EXPECT_EQ(different[d], 0u) << "dimension " << d;
}

INSTANTIATE_TEST_SUITE_P(Tables, SampleTableBits,
                         testing::Values(TableCase{Sampling::Independent, 1, 0, {0, 0}},
                                         TableCase{Sampling::Independent, 64, 1, {0, 0}},
                                         TableCase{Sampling::Independent, 23, 0xfffffffeu, {-1, 7}},
                                         TableCase{Sampling::Independent, 300, 12345, {1027, -9}},
                                         TableCase{Sampling::Regular, 1, 0, {0, 0}},
                                         TableCase{Sampling::Regular, 9, 5, {-4, 2}},
                                         TableCase{Sampling::Regular, 64, 5, {3, 1000}}));

}  // namespace
}  // namespace granita::raster_test
