// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

namespace granita {

/// Albedo of the single-scattering GGX reflection without Fresnel: what is left of 1 is lost to
/// missing multiple scattering (Kulla and Conty 2017).  Tables over roughness (alpha = roughness^2)
/// and cosine, 32 a side and linear in between, as Cycles tabulates them.
class GgxAlbedo {
  public:
    /// Integrates the tables; a few tens of milliseconds.  Shared and made at first use.
    static const GgxAlbedo& shared();

    float directional(float roughness, float cos_wi) const;
    /// Cosine-weighted average over directions.
    float average(float roughness) const;

  private:
    GgxAlbedo();
    static constexpr int kSize = 32;
    std::array<std::array<float, kSize>, kSize> m_directional{};  ///< [roughness][cosine]
    std::array<float, kSize> m_average{};
};

}  // namespace granita
