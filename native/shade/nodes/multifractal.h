// SPDX-License-Identifier: GPL-3.0-or-later
// Sums and products of gradient noise over octaves: Musgrave's, in Ebert, Musgrave, Peachey, Perlin
// and Worley, "Texturing and Modeling" (chapter 16), as Blender's Musgrave Texture and since 4.1
// its Noise Texture have them.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "shade/nodes/gradient_noise.h"

namespace granita {

enum class Multifractal { Fbm, Multiplied, HeteroTerrain, Hybrid, Ridged };

/// By Blender's identifier.
inline Multifractal multifractal_of(const std::string& type) {
    if (type == "MULTIFRACTAL") return Multifractal::Multiplied;
    if (type == "HETERO_TERRAIN") return Multifractal::HeteroTerrain;
    if (type == "HYBRID_MULTIFRACTAL") return Multifractal::Hybrid;
    if (type == "RIDGED_MULTIFRACTAL") return Multifractal::Ridged;
    return Multifractal::Fbm;
}

struct MultifractalOctaves {
    float count = 3.0f;  ///< a fraction fades the last one in; ridges have whole ones alone
    float gain_of_octave = 0.25f;  ///< amplitude relative to the octave before
    float lacunarity = 2.0f;       ///< frequency, likewise
    float offset = 0.0f;           ///< added to the noise: of terrains the sea level
    float gain = 1.0f;             ///< how much an octave's signal lets the next one through
};

/// Octave after octave: its noise and amplitude.
template <std::size_t N>
class OctaveWalk {
  public:
    OctaveWalk(const NoisePoint<N>& p, const MultifractalOctaves& octaves)
        : m_p(p), m_octaves(octaves) {}
    float noise() const {
        NoisePoint<N> q;
        for (std::size_t c = 0; c < N; ++c) q[c] = m_frequency * m_p[c];
        return signed_noise<N>(q);
    }
    float amplitude() const { return m_amplitude; }
    void advance() {
        m_amplitude *= m_octaves.gain_of_octave;
        m_frequency *= m_octaves.lacunarity;
    }

  private:
    const NoisePoint<N>& m_p;
    const MultifractalOctaves& m_octaves;
    float m_frequency = 1.0f, m_amplitude = 1.0f;
};

template <std::size_t N>
float multifractal(Multifractal type, const NoisePoint<N>& p, const MultifractalOctaves& octaves) {
    constexpr float kNothing = 0.001f;  // a weight below which hybrids end
    const float count = std::clamp(octaves.count, 0.0f, 16.0f);
    const int whole = static_cast<int>(count);
    const float fraction = count - static_cast<float>(whole);
    OctaveWalk<N> walk(p, octaves);
    switch (type) {
        case Multifractal::Fbm: {
            float value = 0.0f;
            for (int i = 0; i < whole; ++i, walk.advance())
                value += walk.noise() * walk.amplitude();
            if (fraction != 0.0f) value += fraction * walk.noise() * walk.amplitude();
            return value;
        }
        case Multifractal::Multiplied: {
            float value = 1.0f;
            for (int i = 0; i < whole; ++i, walk.advance())
                value *= walk.amplitude() * walk.noise() + 1.0f;
            if (fraction != 0.0f) value *= fraction * walk.amplitude() * walk.noise() + 1.0f;
            return value;
        }
        case Multifractal::HeteroTerrain: {
            float value = octaves.offset + walk.noise();
            walk.advance();
            const auto step = [&] {
                return (walk.noise() + octaves.offset) * walk.amplitude() * value;
            };
            for (int i = 1; i < whole; ++i, walk.advance()) value += step();
            if (fraction != 0.0f) value += fraction * step();
            return value;
        }
        case Multifractal::Hybrid: {
            float value = 0.0f, weight = 1.0f;
            const auto signal = [&] { return (walk.noise() + octaves.offset) * walk.amplitude(); };
            for (int i = 0; weight > kNothing && i < whole; ++i, walk.advance()) {
                weight = std::min(weight, 1.0f);
                const float s = signal();
                value += weight * s;
                weight *= octaves.gain * s;
            }
            if (fraction != 0.0f && weight > kNothing)
                value += fraction * std::min(weight, 1.0f) * signal();
            return value;
        }
        case Multifractal::Ridged: {
            const auto ridge = [&] {
                const float s = octaves.offset - std::abs(walk.noise());
                return s * s;
            };
            float signal = ridge(), value = signal;
            for (int i = 1; i < whole; ++i) {
                walk.advance();
                signal = ridge() * std::clamp(signal * octaves.gain, 0.0f, 1.0f);
                value += signal * walk.amplitude();
            }
            return value;
        }
    }
    return 0.0f;
}

}  // namespace granita
