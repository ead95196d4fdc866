// SPDX-License-Identifier: GPL-3.0-or-later
// Normalized diffusion (Burley 2015; Christensen and Burley 2015, "Approximate Reflectance Profiles
// for Efficient Subsurface Scattering"): R(r) = (e^(-r/d) + e^(-r/3d)) / (8 pi d r), whose integral
// over the plane is 1.  In the radius, 2 pi r R is a quarter of an exponential of mean d and three
// of one of mean 3d, which is how it is sampled.
#pragma once

#include <algorithm>
#include <cmath>

#include "math/sampling.h"
#include "math/vec.h"

namespace granita {

class BurleyProfile {
  public:
    /// `d` [channels] metres; a channel of 0 has none.
    explicit BurleyProfile(const Vec3f& d) : m_d(d) {
        for (int c = 0; c < 3; ++c) m_channels += d[c] > 0.0f ? 1.0f : 0.0f;
    }
    /// 2 pi r R(r): per metre of radius, by channel.
    Vec3f value(float r) const {
        Vec3f value(0.0f);
        for (int c = 0; c < 3; ++c)
            if (m_d[c] > 0.0f) value[c] = radial(m_d[c], r);
        return value;
    }
    /// Of sample(), per metre.
    float density(float r) const {
        const Vec3f all = value(r);
        return (all.x + all.y + all.z) / m_channels;
    }
    struct Distance {
        float r;      ///< metres
        float reach;  ///< where its channel is cut off, with less than .4 % of it outside
    };
    /// Of any channel alike; `u` in [0, 1).
    Distance sample(float u) const {
        u *= m_channels;
        int c = 0;
        while (!(m_d[c] > 0.0f) || u >= 1.0f) u -= m_d[c++] > 0.0f ? 1.0f : 0.0f;
        const float whole = 1.0f - std::exp(-kCut / 3.0f),
                    narrow = 0.25f * (1.0f - std::exp(-kCut));
        const float share = narrow / (narrow + 0.75f * whole);
        const float mean = u < share
                               ? -std::log(1.0f - u / share * (4.0f * narrow))
                               : -3.0f * std::log(1.0f - (u - share) / (1.0f - share) * whole);
        return {m_d[c] * mean, m_d[c] * kCut};
    }

  private:
    static constexpr float kCut = 16.0f;
    static float radial(float d, float r) {
        if (r >= kCut * d) return 0.0f;
        const float kept = 1.0f - 0.25f * std::exp(-kCut) - 0.75f * std::exp(-kCut / 3.0f);
        return (std::exp(-r / d) + std::exp(-r / (3.0f * d))) / (4.0f * d * kept);
    }

    Vec3f m_d;
    float m_channels = 0.0f;
};

}  // namespace granita
