// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/volumes/media_filler.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/knot_time.h"
#include "shade/rays/hit_attributes.h"

namespace granita {
namespace {

/// Of one ray through one part of a thing, as Cycles has it.
constexpr float kMostSteps = 1024.0f;
/// And what short ways take.
constexpr float kLeastSteps = 8.0f;
/// Steps of ways without an end are at least so much of what lies before them, and so many, that
/// reach so far, metres, from where on all is alike.
constexpr float kGrowth = 0.1f, kFar = 1e6f;
constexpr std::size_t kUnendingSteps = 128;
/// Of those as many are asked at a time, until less than this comes through.
constexpr std::size_t kRound = 32;
constexpr float kNothing = 1e-6f;
static_assert(kUnendingSteps % kRound == 0);
constexpr float kGolden = 0.618034f;
/// Places that a program is run over at once.
constexpr std::size_t kBatch = 4096;

/// Reads a program's values; of a homogeneous one without a run.
class Values {
  public:
    explicit Values(const Run* run) : m_run(run) {}
    template <class T>
    T operator()(const Source<T>& source, std::size_t i) const {
        return source.is_constant() ? source.constant : m_run->read(source)[i];
    }

  private:
    const Run* m_run;
};

Vec3f positive(const Vec3f& v) {
    return is_finite(v) ? glm::max(v, Vec3f(0.0f)) : Vec3f(0.0f);
}

void add_values(const VolumeProgram& program, const Values& values, std::size_t i,
                std::uint64_t receives, MediumPiece& piece) {
    piece.extinction += positive(values(program.sources.absorption, i));
    piece.emission += positive(values(program.emission, i));
    for (const PhaseSource& phase : program.sources.phases) {
        const Vec3f scattering = positive(values(phase.scattering, i));
        if (scattering == Vec3f(0.0f)) continue;
        piece.extinction += scattering;
        piece.scattering += scattering;
        piece.phases.push_back(
            {phase.kind, {values(phase.first, i), values(phase.second, i)}, scattering, receives});
    }
}

}  // namespace

void MediaFiller::add_ray(const Ray& ray, float shift, std::span<const FilledSpan> spans) {
    m_ends.clear();
    for (const FilledSpan& span : spans) {
        m_ends.push_back(span.begin);
        m_ends.push_back(span.end);
    }
    std::ranges::sort(m_ends);
    for (std::size_t i = 0; i + 1 < m_ends.size(); ++i) {
        if (!(m_ends[i] < m_ends[i + 1])) continue;
        m_there.clear();
        for (const FilledSpan& span : spans)
            if (span.begin <= m_ends[i] && m_ends[i + 1] <= span.end) m_there.push_back(span);
        if (!m_there.empty()) add_pieces(ray, shift, m_ends[i], m_ends[i + 1], m_there);
    }
    m_media.end_ray();
}

std::uint64_t MediaFiller::receives(std::uint32_t instance) const {
    return instance == FilledThings::kWorld ? m_scene.receives_in_volumes
                                            : m_scene.instances[instance].receives;
}

/// Of a part in which the same things are there all along.
void MediaFiller::add_pieces(const Ray& ray, float shift, float begin, float end,
                             std::span<const FilledSpan> there) {
    float step = end - begin, count = 1.0f;
    for (const FilledSpan& span : there)
        if (!span.program->is_homogeneous()) {
            step = std::min(step, m_things.steps.at(span.instance));
            count = kLeastSteps;
        }
    if (step < end - begin || count > 1.0f) {
        count = std::clamp(std::ceil((end - begin) / step), count, kMostSteps);
        if (std::isfinite(end)) step = (end - begin) / count;
    }
    const bool grows = count > 1.0f && !std::isfinite(end);
    const std::size_t steps = grows ? kUnendingSteps : static_cast<std::size_t>(count);
    const std::size_t first = m_media.pieces.size();
    const float growth =
        grows ? std::max(kGrowth, std::pow(kFar / step, 1.0f / kUnendingSteps) - 1.0f) : 0.0f;
    float from = begin;
    for (std::size_t k = 0; k < steps; ++k) {
        MediumPiece& piece = m_media.pieces.emplace_back();
        piece.begin = from;
        piece.end = k + 1 == steps ? end
                    : grows        ? from + std::max(step, growth * from)
                                   : begin + static_cast<float>(k + 1) * step;
        from = piece.end;
        if (!grows || k < kRound) ask(first + k, k, ray, shift, there);
    }
    if (grows)
        m_unending.push_back({m_media.ray_count(), first, kRound, ray, shift,
                              std::vector<FilledSpan>(there.begin(), there.end())});
}

/// Of a piece that is one of a part's steps.
void MediaFiller::ask(std::size_t piece, std::size_t step, const Ray& ray, float shift,
                      std::span<const FilledSpan> there) {
    const float begin = m_media.pieces[piece].begin, end = m_media.pieces[piece].end;
    // Of steps that are all shifted alike, the sum is as much in doubt as one.
    const float own = shift + kGolden * static_cast<float>(step);
    const float part = own - std::floor(own);
    const float at = begin + (std::isfinite(end) ? part * (end - begin) : 0.0f);
    for (const FilledSpan& span : there) {
        if (span.program->is_homogeneous()) {
            add_values(*span.program, Values(nullptr), 0, receives(span.instance),
                       m_media.pieces[piece]);
            continue;
        }
        Asked& asked = m_asked[{span.instance, span.material, ray.type}];
        asked.program = span.program;
        asked.places.push_back({piece, ray.start + ray.direction * at, ray.direction, ray.time});
    }
}

void MediaFiller::fill() {
    ask_all();
    while (!m_unending.empty()) {
        for (Unending& way : m_unending) go_on(way);
        std::erase_if(m_unending, [](const Unending& way) { return way.asked == kUnendingSteps; });
        ask_all();
    }
}

/// Asks further where light comes through what is known, else ends the ray there.
void MediaFiller::go_on(Unending& way) {
    const std::size_t last = way.first + way.asked - 1;
    for (std::size_t i = last + 1 - kRound; i <= last; ++i) {
        const MediumPiece& piece = m_media.pieces[i];
        way.transmittance *= passed(piece, piece.end - piece.begin);
    }
    if (largest(way.transmittance) < kNothing) {
        MediumPiece& dark = m_media.pieces[last + 1];
        dark.end = std::numeric_limits<float>::infinity();
        dark.extinction = Vec3f(1.0f);
        m_media.end_with(way.ray, last + 1);
        way.asked = kUnendingSteps;
        return;
    }
    for (std::size_t k = way.asked; k < way.asked + kRound; ++k)
        ask(way.first + k, k, way.along, way.shift, way.there);
    way.asked += kRound;
}

void MediaFiller::ask_all() {
    for (const auto& [key, asked] : m_asked) {
        const std::span<const Place> places(asked.places);
        for (std::size_t first = 0; first < places.size(); first += kBatch)
            fill(std::get<0>(key), *asked.program,
                 places.subspan(first, std::min(kBatch, places.size() - first)));
    }
    m_asked.clear();
}

void MediaFiller::fill(std::uint32_t instance, const VolumeProgram& program,
                       std::span<const Place> places) {
    ShadingPoints points;
    points.count = places.size();
    points.dp_du.assign(places.size(), Vec3f(0.0f));
    points.dp_dv.assign(places.size(), Vec3f(0.0f));
    points.backfacing.assign(places.size(), 0);
    HitAttributes attributes;
    attributes.resize(program.requests, places.size());
    ShadingInput input;
    input.points = &points;
    input.attributes = &attributes.grid();
    const bool in_world = instance == FilledThings::kWorld;
    const Instance* const thing = in_world ? nullptr : &m_scene.instances[instance];
    const bool moves = thing && thing->world_from_object.size() > 1;
    Mat4d world_from_object(1.0);
    if (thing) world_from_object = matrix_at(thing->world_from_object, m_scene.options.frame_time);
    Mat4d object_from_world = glm::inverse(world_from_object);
    input.instance = thing;
    if (thing) input.axes = ObjectAxes(world_from_object);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const Place& place = places[i];
        const Vec3d world = m_things.origin + Vec3d(place.p);
        points.p.push_back(in_world ? Vec3f(world) : place.p);
        for (auto* back : {&points.view, &points.normal, &points.geometric_normal})
            back->push_back(-place.direction);
        points.times.push_back(place.time);
        if (in_world) continue;
        if (moves) {
            world_from_object = matrix_at(thing->world_from_object, place.time);
            object_from_world = glm::inverse(world_from_object);
            input.axes_at_times.emplace_back(world_from_object);
        }
        const Vec3f p(transform_point(object_from_world, world));
        for (std::size_t k = 0; k < program.requests.size(); ++k) {
            const AttributeSource source = program.requests[k].source;
            if (!is_position(source)) continue;
            const Vec3f value = source == AttributeSource::Generated
                                    ? m_things.spaces.at(instance).generated(p)
                                    : p;
            std::copy_n(&value.x, 3, attributes.values(k) + 3 * i);
        }
    }
    Run run = program.program.prepare(input, places.size());
    program.program.execute(run);
    for (std::size_t i = 0; i < places.size(); ++i)
        add_values(program, Values(&run), i, receives(instance), m_media.pieces[places[i].piece]);
}

}  // namespace granita
