// SPDX-License-Identifier: GPL-3.0-or-later
// Which faces samples meet of a mesh that has many more: against each face tried with each sample,
// in double precision.
#include "render/faces_of_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>
#include <set>

#include "dice/open_instance.h"
#include "render/frame.h"
#include "render/shared_frame.h"

namespace granita {
namespace {

constexpr int kFaces = 8000;

/// Separate triangles and bent quads of a tenth of a pixel to a pixel, in a ball of four.
GeometryData crumbs(int knots) {
    GeometryData data;
    data.name = "mesh 'Crumbs'";
    std::mt19937 random(3);
    std::uniform_real_distribution<float> share(-1.0f, 1.0f);
    const auto point = [&](float size) {
        Vec3f p(2.0f);
        while (glm::dot(p, p) > 1.0f) p = {share(random), share(random), share(random)};
        return p * size;
    };
    for (int face = 0; face < kFaces; ++face) {
        const int sides = face % 2 ? 4 : 3;
        const Vec3f at = point(4.0f), u = point(0.3f), v = point(0.3f), bend = point(0.05f);
        const Vec3f corner[4] = {at, at + u, at + u + v + bend, at + v};
        for (int i = 0; i < sides; ++i) {
            data.corner_verts.push_back(static_cast<std::int32_t>(data.points.size()));
            data.points.push_back(corner[i]);
        }
        data.face_sizes.push_back(sides);
    }
    data.smooth.assign(kFaces, 0);
    const std::size_t count = data.points.size();
    data.knots = knots;
    for (int k = 1; k < knots; ++k)
        for (std::size_t i = 0; i < count; ++i) data.points.push_back(data.points[i] + point(0.5f));
    return data;
}

Mat4d placed(const Vec3d& at, double angle, const Vec3d& scale) {
    Mat4d m(1.0);
    m[0] = {scale.x * std::cos(angle), scale.x * std::sin(angle), 0.0, 0.0};
    m[1] = {-scale.y * std::sin(angle), scale.y * std::cos(angle), 0.0, 0.0};
    m[2].z = scale.z;
    m[3] = glm::dvec4(at, 1.0);
    return m;
}

struct Case {
    std::string name;
    bool perspective = false, moves = false, camera_moves = false, lens = false, deforms = false;
    bool transparent = false;
};

std::shared_ptr<Scene> make(const Case& of) {
    auto scene = make_scene(1);
    Options& o = scene->options;
    o.samples = 4;
    o.frame_time = 0.5f;
    o.passes.clear();
    scene->instances.clear();
    scene->geometries = {};
    scene->lights.clear();
    add(*scene, crumbs(of.deforms ? 2 : 1), of.transparent ? 1 : 0, Vec3d(0.0));
    scene->instances[0].world_from_object = {placed({24.0, 22.0, 60.0}, 0.4, {1.0, 1.2, 0.7})};
    if (of.moves)
        scene->instances[0].world_from_object.push_back(
            placed({26.0, 25.0, 63.0}, 0.9, {1.0, 1.0, 0.8}));
    // Others of them pay for the tree of the rays; the frame does not show them.
    for (int i = 0; i < 99; ++i) {
        Instance other = scene->instances[0];
        other.key += static_cast<std::uint32_t>(1 + i);
        other.world_from_object = {placed({9000.0, 0.0, 60.0}, 0.0, Vec3d(1.0))};
        scene->instances.push_back(other);
    }
    Projection& p = scene->camera.projection;
    if (of.perspective) {
        p.perspective = true;
        p.scale = Vec2d(50.0);
    }
    if (of.lens) {
        p.lens_radius = 1.5;
        p.focus = 61.0;
    }
    if (of.camera_moves) {
        Mat4d end(1.0);
        end[3] = {0.5, -1.0, 2.0, 1.0};
        scene->camera.world_from_camera.push_back(end);
    }
    return scene;
}

/// What a sample meets of a triangle: depth, or not at all; `close`: within rounding of its
/// outline.
struct Meeting {
    bool meets = false, close = false;
    double depth = 0.0;
};

Meeting meet(const Vec2d (&at)[3], const double (&inverse_w)[3], const double (&z)[3],
             const Vec2d& sample) {
    const auto area = [](const Vec2d& a, const Vec2d& b, const Vec2d& c) {
        return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    };
    const double whole = area(at[0], at[1], at[2]);
    double weight[3], sum = 0.0;
    Meeting out;
    double least = 1.0;
    for (int i = 0; i < 3; ++i) {
        weight[i] = area(at[(i + 1) % 3], at[(i + 2) % 3], sample) / whole;
        least = std::min(least, weight[i]);
    }
    for (int i = 0; i < 3; ++i) sum += weight[i] * inverse_w[i];
    out.meets = least > 0.0;
    out.close = std::abs(least) < 2e-4;
    for (int i = 0; i < 3; ++i) out.depth += weight[i] * inverse_w[i] / sum * z[i];
    return out;
}

/// The mesh at a sample's time, through its point of the lens.
struct Seen {
    std::vector<Vec2d> raster;  ///< [V] pixels
    std::vector<double> depth;  ///< [V]
};

/// Everything goes straight between knots in camera space.
Seen see(const GeometryData& data, const Knots& knots, const Projection& p, double t,
         const Vec2d& lens) {
    const int last = knots.count - 1;
    const int from = std::clamp(static_cast<int>(t * last), 0, std::max(last - 1, 0));
    const int to = std::min(from + 1, last);
    const double part = t * last - from;
    const std::size_t vertices = data.vertex_count();
    const auto place = [&](int knot, std::size_t v) {
        const std::size_t shift = data.knots > 1 ? static_cast<std::size_t>(knot) * vertices : 0;
        return transform_point(knots.camera_from_object[static_cast<std::size_t>(knot)],
                               Vec3d(data.points[v + shift]));
    };
    Seen seen;
    for (std::size_t v = 0; v < vertices; ++v) {
        const Vec3d at = place(from, v) * (1.0 - part) + place(to, v) * part;
        const Vec2d moved = Vec2d(at) + lens * (at.z / p.focus - 1.0);
        seen.raster.push_back(p.center + p.scale * (p.perspective ? moved / at.z : moved));
        seen.depth.push_back(at.z);
    }
    return seen;
}

/// Patches that a sample meets, the nearest first; nothing where it lies within rounding of an
/// outline: rays round that otherwise than this does.
std::optional<std::vector<std::uint32_t>> met_by(const Vec2d& sample, const Seen& seen,
                                                 const SharedGeometry& shared, bool perspective) {
    std::vector<std::pair<double, std::uint32_t>> met;
    for (std::uint32_t patch = 0; patch < shared.patches().size(); ++patch) {
        const BasePatch& b = shared.patches()[patch];
        for (int half = 0; half < (b.kind == PatchKind::Triangle ? 1 : 2); ++half) {
            Vec2d corner[3];
            double w[3], z[3];
            for (int i = 0; i < 3; ++i) {
                const auto v = static_cast<std::size_t>(
                    shared.data().corner_verts[b.corner[i == 0 ? 0 : i + half]]);
                corner[i] = seen.raster[v];
                z[i] = seen.depth[v];
                w[i] = perspective ? 1.0 / z[i] : 1.0;
            }
            const Meeting meeting = meet(corner, w, z, sample);
            if (meeting.close) return std::nullopt;
            if (meeting.meets) met.emplace_back(meeting.depth, patch);
        }
    }
    std::ranges::sort(met);
    std::vector<std::uint32_t> patches;
    for (const auto& [depth, patch] : met) patches.push_back(patch);
    return patches;
}

class FacesOfSamplesTest : public ::testing::TestWithParam<Case> {};

TEST_P(FacesOfSamplesTest, are_all_that_samples_see_and_few_others) {
    const Case of = GetParam();
    const auto scene = make(of);
    const auto statistics = std::make_shared<Statistics>(scene->instances.size());
    Report report;
    const Progress progress;
    ExecutorChoice choice;
    choice.executor = Executor::Simd;
    const Frame frame(scene, statistics, report, progress, std::move(choice));
    const auto shared = frame.view.geometries->shared(*scene, 0, report);
    const Knots knots =
        combine_knots(*scene, scene->instances[0], scene->geometries[0], shared->is_static());
    const auto found = frame.view.sampled_faces->of(0, shared, knots);
    ASSERT_TRUE(found.has_value());
    EXPECT_TRUE(std::ranges::is_sorted(*found));
    EXPECT_LT(found->size(), shared->patches().size() / 2);
    EXPECT_LT(statistics->get(Counter::RaysOpening), shared->patches().size());
    const std::set<std::uint32_t> there(found->begin(), found->end());

    const Projection& p = scene->camera.projection;
    const RasterBounds bounds = instance_bounds(frame.view, 0);
    TileSamples samples;
    int seen = 0, missed = 0, unsure = 0;
    const auto look = [&](const Vec2d& at, std::size_t s) {
        if (at.x < bounds.x0 || at.x > bounds.x1 || at.y < bounds.y0 || at.y > bounds.y1) return;
        const Vec2d lens =
            samples.u.empty() ? Vec2d(0.0) : p.lens_radius * Vec2d(samples.u[s], samples.v[s]);
        const double t = samples.t.empty() ? 0.0 : samples.t[s];
        auto met = met_by(at, see(shared->data(), knots, p, t, lens), *shared, p.perspective);
        if (!met) ++unsure;
        if (!met || met->empty()) return;
        const std::size_t count = of.transparent ? met->size() : 1;
        for (std::size_t i = 0; i < count; ++i) ++seen, missed += !there.contains((*met)[i]);
    };
    for (int y = 0; y < kSize / kTileSize; ++y)
        for (int x = 0; x < kSize / kTileSize; ++x) {
            frame.levels.all().fill_tile({x, y}, frame.levels.all().needs(), samples);
            for (std::size_t s = 0; s < samples.x.size(); ++s)
                look(Vec2d(x * kTileSize + samples.x[s], y * kTileSize + samples.y[s]), s);
        }
    EXPECT_GT(seen, 100) << "what the test looks at";
    EXPECT_EQ(missed, 0);
    EXPECT_LT(unsure, seen / 4);
}

INSTANTIATE_TEST_SUITE_P(
    Cases, FacesOfSamplesTest,
    ::testing::Values(
        Case{.name = "still"}, Case{.name = "perspective", .perspective = true},
        Case{.name = "moves_and_turns", .perspective = true, .moves = true},
        Case{.name = "camera_moves", .perspective = true, .moves = true, .camera_moves = true},
        Case{.name = "lens", .perspective = true, .lens = true},
        Case{.name = "lens_of_parallel_light", .lens = true},
        Case{.name = "all_of_it",
             .perspective = true,
             .moves = true,
             .camera_moves = true,
             .lens = true},
        Case{.name = "deforms", .perspective = true, .deforms = true},
        Case{.name = "transparent", .transparent = true},
        Case{.name = "transparent_in_motion",
             .perspective = true,
             .moves = true,
             .lens = true,
             .transparent = true}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace granita
