// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/resolve/surface_interpolator.h"

#include <algorithm>

#include "base/object_pool.h"
#include "hider/resolve/surface_kernel.h"

namespace granita {
namespace {

Corner<float> corner(const Projection& projection, const Vec3f& p, const Vec2d& origin) {
    const Vec3f h = projection.homogeneous(p, origin);
    return {h.x, h.y, h.z, p.z};
}

int segment_of(float time, int segments) {
    return std::min(static_cast<int>(time * static_cast<float>(segments)), segments - 1);
}

/// Weights of the triangle whose smallest weight is largest: the nearest guess for a sample that is
/// outside both by rounding.
SurfaceHit nearest_triangle(const Offset<double> d[4]) {
    SurfaceHit best;
    double best_least = -INFINITY;
    for (const bool second : {false, true}) {
        const int j = second ? 2 : 1, k = second ? 3 : 2;
        const double e[3] = {edge(d[j], d[k]), edge(d[k], d[0]), edge(d[0], d[j])};
        const double sum = e[0] + e[1] + e[2];
        if (sum == 0.0) continue;
        const double least = std::min({e[0] / sum, e[1] / sum, e[2] / sum});
        if (!(least > best_least)) continue;
        best_least = least;
        double w[3];
        for (int i = 0; i < 3; ++i) w[i] = std::max(0.0, e[i] / sum);
        const double total = w[0] + w[1] + w[2];
        best = {true, 0.0f, second, w[1] / total, w[2] / total};
    }
    return best;
}

/// Strictly inside one triangle and outside the other: the float arithmetic of locate_lanes
/// (triangle_pair.inl), with its bits.
bool plain_weights(const Offset<float> d[4], bool& second, float weight[3]) {
    const float e01 = edge(d[0], d[1]), e12 = edge(d[1], d[2]), e02 = edge(d[0], d[2]);
    const float e23 = edge(d[2], d[3]), e30 = edge(d[3], d[0]);
    const auto in = [](float a, float b, float c) {
        return (a >= 0.0f && b >= 0.0f && c >= 0.0f) || (a <= 0.0f && b <= 0.0f && c <= 0.0f);
    };
    const auto strict = [](float a, float b, float c) {
        return (a > 0.0f && b > 0.0f && c > 0.0f) || (a < 0.0f && b < 0.0f && c < 0.0f);
    };
    const bool in_first = strict(e01, e12, -e02) && !in(e02, e23, e30);
    second = strict(e02, e23, e30) && !in(e01, e12, -e02);
    if (!in_first && !second) return false;
    const float e[3] = {second ? e23 : e12, second ? e30 : -e02, second ? e02 : e01};
    const float share = 1.0f / (e[0] + e[1] + e[2]);
    weight[1] = e[1] * share;
    weight[2] = e[2] * share;
    weight[0] = 1.0f - weight[1] - weight[2];
    return true;
}

SurfacePoint point_of(const SurfaceCorners& corners, bool second, const float weight[3]) {
    SurfacePoint point;
    point.grid = corners.grid;
    point.vertex[0] = corners.vertex[0];
    point.vertex[1] = corners.vertex[second ? 2 : 1];
    point.vertex[2] = corners.vertex[second ? 3 : 2];
    std::copy_n(weight, 3, point.weight);
    return point;
}

}  // namespace

SurfacePoint point_of(const Fragment& fragment, const GridPool& pool) {
    const GridPool::Place place = pool.locate(fragment.id);
    const Grid::Corners c = place.grid->corners(place.micropolygon);
    // As in compositing, none is negative.
    const float b1 = fragment.b1();
    const float weight[3] = {std::max(0.0f, 1.0f - b1 - fragment.b2), b1, fragment.b2};
    return point_of(SurfaceCorners{place.grid, {c.v0, c.v1, c.v2, c.v3}}, fragment.second(),
                    weight);
}

SurfacePoint SurfaceRun::point(int lane) const {
    const float w[3] = {weight[0][lane], weight[1][lane], weight[2][lane]};
    return point_of(corners[lane], (second >> lane & 1u) != 0, w);
}

SurfaceInterpolator::SurfaceInterpolator(const Projection& projection, Vec2i tile,
                                         const TileSamples& samples, const GridPool& pool,
                                         bool shaded)
    : m_projection(projection),
      m_origin(tile * kTileSize),
      m_samples(samples),
      m_pool(pool),
      m_shaded(shaded),
      m_inverse_focus(static_cast<float>(1.0 / projection.focus)),
      m_lens(static_cast<float>(projection.lens_radius * projection.scale.x),
             static_cast<float>(projection.lens_radius * projection.scale.y)) {}

SurfaceInterpolator::~SurfaceInterpolator() {
    if (!m_cache.empty()) ObjectPool<std::vector<SurfaceRecord>>::give(std::move(m_cache));
}

void SurfaceInterpolator::open_cache() {
    m_cache = ObjectPool<std::vector<SurfaceRecord>>::take();
    m_cache.resize(kCached);
    for (SurfaceRecord& record : m_cache) record.id = kNoSurface;
}

SurfaceRecord& SurfaceInterpolator::load_colors(SurfaceId id) {
    if (m_cache.empty()) open_cache();
    SurfaceRecord& record = m_cache[id % kCached];
    if (record.id != id) fill_colors(id, record);
    return record;
}

void SurfaceInterpolator::fill_colors(SurfaceId id, SurfaceRecord& record) const {
    const GridPool::Place place = m_pool.locate(id);
    const Grid& grid = *place.grid;
    const Grid::Corners c = grid.corners(place.micropolygon);
    record.id = id;
    record.segment = -1;
    record.segments = grid.motion ? grid.knots - 1 : 0;
    record.corners = {&grid, {c.v0, c.v1, c.v2, c.v3}};
    record.colored = record.constant = m_shaded && !grid.holdout && !grid.radiance.empty();
    if (!record.colored) return;
    for (int i = 0; i < 4; ++i) {
        record.radiance[i] = grid.radiance[record.corners.vertex[i]];
        record.constant = record.constant && record.radiance[i] == record.radiance[0];
    }
}

const SurfaceRecord& SurfaceInterpolator::load(SurfaceId id, float time) {
    SurfaceRecord& record = load_colors(id);
    const int segment = record.segments > 0 ? segment_of(time, record.segments) : 0;
    if (record.segment != segment) load_corners(record, segment);
    return record;
}

void SurfaceInterpolator::load_corners(SurfaceRecord& record, int segment) const {
    record.segment = segment;
    const Grid& grid = *record.corners.grid;
    const Vec3f* const knot = grid.positions.data() + segment * grid.vertex_count();
    for (int i = 0; i < 4; ++i) {
        const int vertex = record.corners.vertex[i];
        const Corner<float> a = corner(m_projection, knot[vertex], m_origin);
        record.begin[i] = a;
        if (record.segments == 0) continue;
        const Corner<float> b = corner(m_projection, knot[grid.vertex_count() + vertex], m_origin);
        record.delta[i] = {b.x - a.x, b.y - a.y, b.w - a.w, b.z - a.z};
    }
}

void SurfaceInterpolator::load_knots(const SurfaceRecord& record, std::span<const float> times) {
    m_knots.first = m_knots.last = 0;
    if (record.segments > 1) {
        const auto [least, most] = std::ranges::minmax(times);
        m_knots.first = segment_of(least, record.segments);
        m_knots.last = segment_of(most, record.segments);
    }
    const Grid& grid = *record.corners.grid;
    const int count = m_knots.last - m_knots.first + (record.segments > 0 ? 2 : 1);
    for (auto* values : {&m_knots.x, &m_knots.y, &m_knots.w, &m_knots.z})
        values->resize(static_cast<std::size_t>(count) * 4);
    for (int k = 0; k < count; ++k) {
        const auto number = static_cast<std::size_t>(m_knots.first) + k;
        const Vec3f* const knot = grid.positions.data() + number * grid.vertex_count();
        for (int i = 0; i < 4; ++i) {
            const Corner<float> c = corner(m_projection, knot[record.corners.vertex[i]], m_origin);
            const auto at = static_cast<std::size_t>(k) * 4 + i;
            m_knots.x[at] = c.x;
            m_knots.y[at] = c.y;
            m_knots.w[at] = c.w;
            m_knots.z[at] = c.z;
        }
    }
}

void SurfaceInterpolator::color_groups(const SurfaceGroups& groups, SampleColors& colors,
                                       std::span<std::uint8_t> done) {
    const TileSamples& sorted = groups.sorted();
    SurfaceRecord surface;  // not of the cache: each is asked for once
    for (std::size_t g = 0; g < groups.size(); ++g) {
        fill_colors(groups.id(g), surface);
        if (!surface.colored) continue;
        const std::span<const std::int32_t> samples = groups.samples(g);
        if (!surface.constant) {
            load_knots(surface, sorted.t.empty()
                                    ? std::span<const float>()
                                    : std::span(sorted.t).subspan(groups.begin(g), samples.size()));
            color_group(*this, sorted, groups.begin(g), surface, m_knots, samples, colors, done);
            continue;
        }
        for (const std::int32_t sample : samples) {
            const auto s = static_cast<std::size_t>(sample);
            colors.red[s] = surface.radiance[0].x + 0.0f;
            colors.green[s] = surface.radiance[0].y + 0.0f;
            colors.blue[s] = surface.radiance[0].z + 0.0f;
            colors.alpha[s] = 1.0f;
            done[s] = 1;
        }
    }
}

SurfaceInterpolator::Seen SurfaceInterpolator::see(std::uint32_t sample, SurfaceId id) {
    const float time = m_samples.t.empty() ? 0.0f : m_samples.t[sample];
    const SurfaceRecord& surface = load(id, time);
    Seen seen;
    seen.surface = &surface;
    const float local =
        time * static_cast<float>(surface.segments) - static_cast<float>(surface.segment);
    const float x = m_samples.x[sample], y = m_samples.y[sample];
    const float focus =
        m_samples.inverse_focus.empty() ? m_inverse_focus : m_samples.inverse_focus[sample];
    for (int i = 0; i < 4; ++i) {
        Corner<float>& c = seen.corners[i];
        c = surface.segments > 0 ? at_time(surface.begin[i], surface.delta[i], local)
                                 : surface.begin[i];
        seen.offsets[i] = m_projection.has_lens()
                              ? offset_lens(c, x, y, m_samples.u[sample] * m_lens.x,
                                            m_samples.v[sample] * m_lens.y, focus, 1.0f)
                              : offset_pinhole(c, x, y);
    }
    return seen;
}

void SurfaceInterpolator::weigh(const Seen& seen, bool& second, float weight[3]) const {
    if (plain_weights(seen.offsets, second, weight)) return;
    Corner<double> corners[4];
    Offset<double> d[4];
    for (int i = 0; i < 4; ++i) {
        const Corner<float>& c = seen.corners[i];
        corners[i] = {c.x, c.y, c.w, c.z};
        d[i] = {seen.offsets[i].x, seen.offsets[i].y};
    }
    // The clip range is left out: the hider applied it.
    const DepthRange any{m_projection.perspective, -INFINITY, INFINITY};
    SurfaceHit hit = hit_micropolygon(corners, d, kTriangleA | kTriangleB, any);
    if (!hit.hit) hit = nearest_triangle(d);
    second = hit.second;
    weight[0] = static_cast<float>(1.0 - hit.b1 - hit.b2);
    weight[1] = static_cast<float>(hit.b1);
    weight[2] = static_cast<float>(hit.b2);
}

SurfacePoint SurfaceInterpolator::locate(std::uint32_t sample, SurfaceId id) {
    const Seen seen = see(sample, id);
    bool second = false;
    float weight[3];
    weigh(seen, second, weight);
    return point_of(seen.surface->corners, second, weight);
}

Fragment SurfaceInterpolator::fragment(std::uint32_t sample, SurfaceId id, float key) {
    bool second = false;
    float weight[3];
    weigh(see(sample, id), second, weight);
    return {key, id, weight[1], weight[2], second};
}

void SurfaceInterpolator::locate_run(std::uint32_t first, const SurfaceId* ids, bool points,
                                     SurfaceRun& out) {
    out.seen = out.plain = out.colored = out.second = 0;
    out.wants_points = points;
    locate_lanes(*this, m_samples, first, ids, out);
}

}  // namespace granita
