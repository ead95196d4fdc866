// SPDX-License-Identifier: GPL-3.0-or-later
// Curves as ribbons that face the eye at every knot, many to a primitive.
//
// A primitive is a run of neighbouring curves, or a part of one.  Its grid is a ladder: u runs
// across, v along; from one curve to the next lead rows that have shrunk to a point, so that the
// micropolygons between have no area and the hider leaves them out.
//
// Ribbons are flat, their shading normals those of a tube: what Cycles calls rounded ribbons.
#pragma once

#include <memory>
#include <vector>

#include "dice/curve_control.h"

namespace granita {

class CurveBatch final : public Primitive {
  public:
    /// Whole batch; bounds alone may be asked of it.
    CurveBatch(const OpenedElements& elements, std::size_t batch);
    static std::unique_ptr<CurveBatch> open(std::shared_ptr<const OpenedElements> elements,
                                            std::size_t batch);

    RasterBounds bounds() const override;
    GridKey key() const override;
    bool diceable() const override { return m_diceable; }
    std::vector<std::unique_ptr<Primitive>> split() const override;
    std::unique_ptr<Grid> dice() const override;

  private:
    struct Row {
        std::uint32_t curve = 0;
        double t = 0.0;
        bool shrunk = false;  ///< to its left end
    };

    void measure();
    bool find_rows(std::size_t most);
    std::uint32_t curve(std::size_t i) const { return m_elements->shared().batch(m_batch)[i]; }
    double end_of(std::uint32_t curve) const;
    void fill_row(Grid& grid, int j, const Row& row, const CurveControl& control) const;

    const OpenedElements* m_elements;
    std::shared_ptr<const OpenedElements> m_owner;  ///< keeps m_elements
    std::size_t m_batch;
    std::uint64_t m_path = 1;
    std::size_t m_first = 0, m_count = 0;  ///< curves of the batch
    double m_lo = 0.0, m_hi = 0.0;         ///< of a single curve
    int m_across = 0;                      ///< micropolygons across; 0 = not yet known
    bool m_diceable = false;
    std::vector<Row> m_rows;  ///< of what can be diced
};

}  // namespace granita
