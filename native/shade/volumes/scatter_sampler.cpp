// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/volumes/scatter_sampler.h"

#include <algorithm>
#include <cmath>

#include "math/sampling.h"

namespace granita {
namespace {

/// How often a place goes by lamps.
constexpr float kByLamps = 0.5f;

float mean(const Vec3f& v) {
    return (v.x + v.y + v.z) * (1.0f / 3.0f);
}

/// Along `length` of a piece, of light that passed `before`: what is scattered and gets out.
Vec3f scattered_in(const MediumPiece& piece, const Vec3f& before, float length) {
    const Vec3f left = passed(piece, length);
    Vec3f sum(0.0f);
    for (int c = 0; c < 3; ++c)
        if (piece.scattering[c] > 0.0f)
            sum[c] = before[c] * piece.scattering[c] / piece.extinction[c] * (1.0f - left[c]);
    return sum;
}

}  // namespace

ScatterSampler::ScatterSampler(const Ray& ray, std::span<const MediumPiece> pieces,
                               std::span<const LightAnchor> anchors)
    : m_pieces(pieces) {
    Vec3f before(1.0f);
    float begin = 0.0f, end = 0.0f;
    for (const MediumPiece& piece : pieces) {
        m_before.push_back(before);
        const float scattered = mean(scattered_in(piece, before, piece.end - piece.begin));
        if (scattered > 0.0f && m_total == 0.0f) begin = piece.begin;
        if (scattered > 0.0f) end = piece.end;
        m_total += scattered;
        m_until.push_back(m_total);
        before *= passed(piece, piece.end - piece.begin);
    }
    if (!(m_total > 0.0f)) return;
    float sum = 0.0f;
    for (const LightAnchor& anchor : anchors) {
        const Vec3f to = anchor.center - ray.start;
        const float nearest = glm::dot(to, ray.direction);
        const float away = std::max(glm::length(to - nearest * ray.direction), 1e-4f);
        const float beside = nearest - std::clamp(nearest, begin, end);
        const float chance = anchor.intensity / (away * away + beside * beside + anchor.near2);
        const Angles angles{chance, nearest, away, std::atan((begin - nearest) / away),
                            std::atan((end - nearest) / away)};
        if (!(chance > 0.0f) || !(angles.last > angles.first)) continue;
        m_angles.push_back(angles);
        sum += chance;
    }
    for (Angles& angles : m_angles) angles.chance *= kByLamps / sum;
}

std::size_t ScatterSampler::piece_at(float distance) const {
    const auto found = std::ranges::upper_bound(m_pieces, distance, {}, &MediumPiece::begin);
    return found == m_pieces.begin() ? 0 : static_cast<std::size_t>(found - m_pieces.begin()) - 1;
}

/// A piece by what it scatters, a channel likewise, and then the exponential within both.
float ScatterSampler::sample_distance(float u, float v) const {
    const float target = u * m_total;
    const auto i = std::min(
        static_cast<std::size_t>(std::ranges::upper_bound(m_until, target) - m_until.begin()),
        m_pieces.size() - 1);
    const MediumPiece& piece = m_pieces[i];
    const float length = piece.end - piece.begin;
    const Vec3f parts = scattered_in(piece, m_before[i], length) * (1.0f / 3.0f);
    float rest = target - (i == 0 ? 0.0f : m_until[i - 1]);
    int channel = 0;
    while (channel < 2 && rest >= parts[channel]) rest -= parts[channel++];
    const float extinction = piece.extinction[channel];
    const float gone = -std::expm1(-extinction * length);
    return piece.begin + std::min(-std::log1p(-v * gone) / extinction, length);
}

float ScatterSampler::density(float distance, const Vec3f& scattered) const {
    float sum = (m_angles.empty() ? 1.0f : 1.0f - kByLamps) * mean(scattered) / m_total;
    for (const Angles& a : m_angles) {
        const float along = distance - a.nearest;
        sum += a.chance * a.away / ((a.last - a.first) * (a.away * a.away + along * along));
    }
    return sum;
}

bool ScatterSampler::sample(const Vec3f& u, ScatterPlace& place) const {
    if (!(m_total > 0.0f)) return false;
    float choice = m_angles.empty() ? 1.0f : u.z;
    if (choice < kByLamps) {
        const Angles* taken = &m_angles.back();
        for (const Angles& a : m_angles) {
            if (choice < a.chance) {
                taken = &a;
                break;
            }
            choice -= a.chance;
        }
        const float angle = taken->first + u.y * (taken->last - taken->first);
        place.distance = taken->nearest + taken->away * std::tan(angle);
    } else {
        place.distance = sample_distance(u.x, u.y);
    }
    const std::size_t i = piece_at(place.distance);
    place.piece = &m_pieces[i];
    const float inside = place.distance - place.piece->begin;
    if (!(inside >= 0.0f && place.distance <= place.piece->end)) return false;
    const Vec3f reaching = m_before[i] * passed(*place.piece, inside);
    const float pdf = density(place.distance, place.piece->scattering * reaching);
    place.weight = reaching / pdf;
    return pdf > 0.0f && is_finite(place.weight) && place.piece->scattering != Vec3f(0.0f);
}

}  // namespace granita
