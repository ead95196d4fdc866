// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace granita {

/// Of a sample's layers that only samples shade, one in the mean is shaded for all that are seen
/// through each other: systematic sampling by what is seen of each (Madow 1949).
class LayerChoice {
  public:
    /// @param start uniform in [0, 1), of the sample.
    explicit LayerChoice(float start = 0.0f) : m_sum(start) {}
    /// What the light of the next layer counts; 0: it is not taken.
    /// @param chance above 0, at most 1.
    float weight(float chance) {
        const float before = std::floor(m_sum);
        m_sum += chance;
        return std::floor(m_sum) > before ? 1.0f / chance : 0.0f;
    }

  private:
    float m_sum;
};

}  // namespace granita
