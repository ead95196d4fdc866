// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/volumes/medium.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace granita {
namespace {

/// Of light that is emitted all along `length`, the part that reaches the piece's near end, metres.
float reaching(float extinction, float length) {
    const float depth = extinction * length;
    if (extinction > 0.0f && depth > 1e-4f) return -std::expm1(-depth) / extinction;
    return std::isfinite(length) ? length * (1.0f - 0.5f * depth) : 0.0f;
}

}  // namespace

Vec3f passed(const MediumPiece& piece, float length) {
    Vec3f left(1.0f);
    for (int c = 0; c < 3; ++c)
        if (piece.extinction[c] > 0.0f) left[c] = std::exp(-piece.extinction[c] * length);
    return left;
}

float first_light(std::span<const MediumPiece> pieces) {
    for (const MediumPiece& piece : pieces)
        if (piece.emission != Vec3f(0.0f) || piece.scattering != Vec3f(0.0f))
            return piece.begin > 0.0f ? piece.begin : piece.end;
    return std::numeric_limits<float>::infinity();
}

Vec3f MediumWalk::advance(float distance) {
    Vec3f emitted(0.0f);
    while (!m_rest.empty() && m_rest.front().begin < distance) {
        const MediumPiece& piece = m_rest.front();
        const float begin = std::max(piece.begin, m_at), end = std::min(piece.end, distance);
        if (end > begin) {
            const float length = end - begin;
            for (int c = 0; c < 3; ++c)
                if (piece.emission[c] != 0.0f)
                    emitted[c] += m_transmittance[c] * piece.emission[c] *
                                  reaching(piece.extinction[c], length);
            m_transmittance *= passed(piece, length);
        }
        if (piece.end > distance) break;
        m_rest = m_rest.subspan(1);
    }
    m_at = std::max(m_at, distance);
    return emitted;
}

}  // namespace granita
