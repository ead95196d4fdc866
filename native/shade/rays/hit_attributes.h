// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "dice/grid.h"
#include "geometry/attribute_request.h"
#include "shade/rays/ray_hit.h"

namespace granita {

/// What a material asks for at points that rays meet, as a grid with these as vertices holds it.
class HitAttributes {
  public:
    /// Makes room for `n` points, all 0; derivatives where a request wants them.
    void resize(const std::vector<AttributeRequest>& requests, std::size_t n);
    /// Fills point `i`.
    /// @param steps of the grid along u and v of a patch: what derivatives are multiplied by;
    /// without them these stay 0, as they do on curves and points.
    void fill(std::size_t i, const RayHit& hit, const std::vector<AttributeRequest>& requests,
              const std::optional<Vec2f>& steps = std::nullopt);

    const std::vector<GridAttribute>& grid() const { return m_attributes; }
    /// [points][width] of a request.
    float* values(std::size_t request) { return m_attributes[request].values.data(); }

  private:
    std::vector<GridAttribute> m_attributes;
    std::vector<float> m_values, m_du, m_dv;  ///< of the point and request at hand
};

}  // namespace granita
