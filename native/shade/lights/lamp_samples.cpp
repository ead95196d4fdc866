// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/lamp_samples.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "math/sampling.h"
#include "shade/lights/power_heuristic.h"
#include "shade/lights/shadow_queue.h"

namespace granita {
namespace {

/// Radians from a lamp's middle to its rim: what is larger hardly casts a shadow that is finer than
/// micropolygons (bars of .2 pixels lack a hundredth of theirs).
constexpr float kSmall = 0.02f;

/// In their order, lamp by lamp.  What rays meet is lit in small batches: of many faces a count of
/// each lamp's would cost more than what they give.
std::vector<LampTurn> by_lamp(std::size_t lamp_count, std::vector<LampTurn> turns) {
    if (turns.size() < lamp_count) {
        std::ranges::stable_sort(turns, {}, &LampTurn::lamp);
        return turns;
    }
    std::vector<std::uint32_t> begin(lamp_count + 1, 0);
    for (const LampTurn& turn : turns) ++begin[turn.lamp + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<LampTurn> sorted(turns.size());
    for (const LampTurn& turn : turns) sorted[begin[turn.lamp]++] = turn;
    return sorted;
}

/// Sends what lamps give to points, lamp by lamp.  What a lamp's nodes colour waits for more of its
/// kind: they are asked about many samples at once.
class LampSender {
  public:
    using Answer = ShadowAgreement::Answer;
    /// Of a point's samples: those that tell of the others, or these.
    enum class Which { All, First, Others };

    LampSender(const LampSet& set, LitGrid& grid)
        : m_set(set), m_grid(grid), m_shadows(set.rays.get(), grid) {}

    /// In samples of that dimension.
    void sample(const LitPoint& point, const LampTurn& turn, std::size_t dimension) {
        sample(point, turn, dimension, Which::All, m_set.samples_of(point, m_set.lamps[turn.lamp]));
    }
    /// All points by one.
    void light(const std::vector<LitPoint>& points, std::size_t lamp, std::size_t first,
               LampSight* sight, const Progress& progress);
    /// All of a lamp's; before the next.
    void deliver() {
        color();
        m_shadows.deliver();
    }

  private:
    struct Uncolored {
        const LitPoint* point;
        const Lamp* lamp;
        LitPlace place;
        LightSample sample;
        float density, sign;
        Answer answer;
    };
    static constexpr std::size_t kEnough = 256;
    static constexpr int kFirst = 4;

    void color();
    /// `density`: of such samples, a solid angle; `sign`: as LitGrid::sign.
    void send(const LitPoint& point, const Lamp& lamp, const LitPlace& place,
              const LightSample& sample, float density, float sign, Answer answer);
    /// Whether a part of the rays to a lamp may tell of all.
    bool tells_shadows(const std::vector<LitPoint>& points, const Lamp& lamp) const {
        const auto has_others = [](const LitPoint& point) {
            return first_of(point.sample_count) < point.sample_count;
        };
        return m_set.rays && lamp.casts_shadow() && !m_grid.placed && !m_grid.alone &&
               (!lamp.is_hard() || m_set.varies) && std::ranges::any_of(points, has_others);
    }
    /// `wanted`: LampSet::samples_of().
    void sample(const LitPoint& point, const LampTurn& turn, std::size_t dimension, Which which,
                int wanted);
    /// Fills m_taken.
    void take(const LitPoint& point, const LampTurn& turn, int count, Which which);
    /// Of so many samples.
    static int first_of(int count) {
        return count < 2 * kFirst ? count : std::max(count / 4, kFirst);
    }

    const LampSet& m_set;
    LitGrid& m_grid;
    ShadowQueue m_shadows;
    std::optional<ShadowAgreement> m_agreement;  ///< of the lamp at hand
    std::vector<int> m_wanted;                   ///< [points] of the lamp at hand
    std::vector<int> m_taken;                    ///< of the samples of the point at hand
    std::vector<Uncolored> m_uncolored;
    std::vector<PatternSample> m_patterned;
};

void LampSender::sample(const LitPoint& point, const LampTurn& turn, std::size_t dimension,
                        Which which, int wanted) {
    const Lamp& lamp = m_set.lamps[turn.lamp];
    if (!m_uncolored.empty() && m_uncolored.front().lamp->pattern() != lamp.pattern()) color();
    const int count = std::min(wanted, turn.rate.samples);
    take(point, turn, count, which);
    if (m_taken.empty()) return;
    const Answer answer = which == Which::Others ? m_agreement->answer(point.index) : Answer::None;
    if (answer == Answer::Closed && !m_grid.parts && !m_grid.sight) return;
    // One sample of many tells all where nothing varies along its ray; one of one is any time's.
    const bool timed =
        (m_set.changes(lamp) || point.paths.moves()) && (wanted > 1 || point.sample_count == 1);
    const SobolPoints sequence = m_grid.sequence(point, dimension, count);
    std::vector<Vec2f>& points = m_grid.lamp_points;
    std::vector<LightSample>& samples = m_grid.lamp_samples;
    points.clear();
    for (const int s : m_taken) points.push_back(sequence(static_cast<std::uint32_t>(s)));
    samples.resize(points.size());
    if (!timed && !lamp.exists(point.at_frame.time)) return;
    const bool stays = !timed || !(lamp.varies() || point.paths.moves());
    if (stays) lamp.sample_all(point.at_frame.time, point.at_frame.p, points, samples);
    for (std::size_t index = 0; index < m_taken.size(); ++index) {
        const int s = m_taken[index];
        LitPlace moved;
        const LitPlace& place = timed ? moved : point.at_frame;
        if (timed) {
            moved = m_set.place_at(point, sequence.third(static_cast<std::uint32_t>(s)));
            if (!lamp.exists(place.time)) continue;
            if (!stays) lamp.sample(place.time, place.p, points[index], samples[index]);
        }
        const LightSample& sample = samples[index];
        if (!(sample.pdf > 0.0f)) continue;
        const float density = static_cast<float>(count) * sample.pdf * turn.rate.mean;
        const float sign = turn.sign != 0.0f ? turn.sign : LitGrid::sign(s, count);
        if (lamp.pattern())
            m_uncolored.push_back({&point, &lamp, place, sample, density, sign, answer});
        else
            send(point, lamp, place, sample, density, sign, answer);
    }
    if (m_uncolored.size() >= kEnough) color();
}

/// A point's first samples are one of the runs of its sequence, each all over the lamp where counts
/// are powers of two: if all points took the same run, a part of the lamp would be seen by none.
void LampSender::take(const LitPoint& point, const LampTurn& turn, int count, Which which) {
    m_taken.clear();
    const int first = first_of(count);
    const auto runs = static_cast<std::uint64_t>(count / std::max(first, 1));
    const int begin =
        runs < 2 ? 0
                 : first * static_cast<int>(
                               mix_bits(m_grid.seed + turn.lamp + mix_bits(point.place)) % runs);
    for (int s = 0; s < count; ++s) {
        const bool is_first = s >= begin && s < begin + first;
        if (which == Which::All || is_first == (which == Which::First)) m_taken.push_back(s);
    }
}

void LampSender::light(const std::vector<LitPoint>& points, std::size_t lamp, std::size_t first,
                       LampSight* sight, const Progress& progress) {
    m_grid.sight = sight;
    m_wanted.resize(points.size());
    const auto light = [&](Which which) {
        for (std::size_t k = 0; k < points.size(); ++k) {
            progress.check();
            const LitPoint& point = points[k];
            const LampTurn turn{0, static_cast<std::uint32_t>(lamp), {1.0f, point.sample_count}};
            if (which != Which::Others) m_wanted[k] = m_set.samples_of(point, m_set.lamps[lamp]);
            sample(point, turn, first + lamp, which, m_wanted[k]);
        }
        deliver();
    };
    if (tells_shadows(points, m_set.lamps[lamp])) {
        m_agreement.emplace(m_grid.radiance.size(), m_grid.columns);
        m_shadows.tell(&*m_agreement);
        light(Which::First);
        m_shadows.tell(nullptr);
        m_agreement->share();
        light(Which::Others);
    } else {
        light(Which::All);
    }
    m_grid.sight = nullptr;
}

void LampSender::color() {
    if (m_uncolored.empty()) return;
    m_patterned.clear();
    for (Uncolored& one : m_uncolored)
        m_patterned.push_back(one.lamp->patterned(one.place.time, one.place.p, one.sample));
    m_uncolored.front().lamp->pattern()->color(m_patterned);
    for (const Uncolored& one : m_uncolored)
        send(*one.point, *one.lamp, one.place, one.sample, one.density, one.sign, one.answer);
    m_uncolored.clear();
}

void LampSender::send(const LitPoint& point, const Lamp& lamp, const LitPlace& place,
                      const LightSample& sample, float density, float sign, Answer answer) {
    const BsdfValue bsdf = lamp.apply(point.bsdf.evaluate(sample.direction), m_grid.in_medium);
    const Vec3f value = total(bsdf) * sample.radiance;
    if (value == Vec3f(0.0f) || LampSet::is_beneath(lamp, point, place, sample.direction)) return;
    if (!lamp.is_hard() && lamp.meets_lobes(m_grid.depth))
        density = power_density(density, point.meeting_density(sample.direction));
    if (m_grid.sight && !lamp.is_hard() && sample.pdf * kPi * kSmall * kSmall < 1.0f)
        m_grid.sight->is_wide();
    const Vec3f radiance = sample.radiance / density;
    if (answer != Answer::None)
        m_shadows.take(point.index, value / density, m_grid.parts ? bsdf * radiance : BsdfValue(),
                       sign, Vec3f(answer == Answer::Open ? 1.0f : 0.0f));
    else if (m_set.rays && lamp.casts_shadow())
        m_shadows.send(point.index, value / density, bsdf, radiance, sign,
                       m_set.ray_to(point, place, lamp, sample, RayType::Shadow));
    else
        m_shadows.send(point.index, value / density, bsdf, radiance, sign);
}

}  // namespace

void light_by_all(const LampSet& set, LitGrid& grid, const std::vector<LitPoint>& points,
                  std::size_t first, const Progress& progress, std::vector<LampSight>* sights) {
    LampSender sender(set, grid);
    const std::size_t end = set.chooses_of_few(grid) ? set.always : set.everywhere;
    for (std::size_t l = 0; l < end; ++l) {
        const Lamp& lamp = set.lamps[l];
        if (!lamp.lights(grid.receives) || !lamp.is_asked(grid.depth)) continue;
        LampSight sight(static_cast<std::uint32_t>(l));
        const bool is_told = sights && set.rays && lamp.casts_shadow();
        sender.light(points, l, first, is_told ? &sight : nullptr, progress);
        if (sight.is_told()) sights->push_back(std::move(sight));
    }
}

std::vector<LampSight> see_again(const LampSet& set, LitGrid& grid,
                                 const std::vector<LitPoint>& points,
                                 std::span<const LampSight> lamps, std::size_t first,
                                 const Progress& progress) {
    LampSender sender(set, grid);
    std::vector<LampSight> sights;
    for (const LampSight& of : lamps)
        sender.light(points, of.lamp, first, &sights.emplace_back(of.lamp), progress);
    return sights;
}

void light_by_chosen(const LampSet& set, LitGrid& grid, const std::vector<LitPoint>& points,
                     std::vector<LampTurn> turns, std::size_t first, const Progress& progress) {
    LampSender sender(set, grid);
    for (const LampTurn& turn : by_lamp(set.lamps.size(), std::move(turns))) {
        progress.check();
        const Lamp& lamp = set.lamps[turn.lamp];
        if (!lamp.lights(grid.receives) || !lamp.is_asked(grid.depth)) continue;
        sender.sample(points[turn.point], turn, first + turn.lamp % kChosenDimensions);
    }
    sender.deliver();
}

}  // namespace granita
