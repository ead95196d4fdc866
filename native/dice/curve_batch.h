// SPDX-License-Identifier: GPL-3.0-or-later
// Curves as ribbons that face the eye at every knot, many to a primitive.
//
// A primitive is a run of neighbouring curves, or a part of one.  Its grid is a ladder lying
// down: u runs along; from one curve to the next lead rows that have shrunk to a point, so that the
// micropolygons between have no area and the hider leaves them out.
//
// Ribbons are flat, their shading normals those of a tube: what Cycles calls rounded ribbons.
#pragma once

#include <memory>
#include <vector>

#include "dice/curve_control.h"
#include "dice/element_batch.h"

namespace granita {

class CurveBatch final : public ElementBatch {
  public:
    /// Whole batch; bounds alone may be asked of it.
    CurveBatch(const OpenedElements& elements, std::size_t batch);
    static std::unique_ptr<CurveBatch> open(std::shared_ptr<const OpenedElements> elements,
                                            std::size_t batch);

    RasterBounds bounds() const override;
    std::unique_ptr<Grid> dice() const override;

  protected:
    std::unique_ptr<ElementBatch> child() const override;
    void halve(unsigned number) override;
    void measure() override;
    std::shared_ptr<const ElementBatch> copy() const override;
    void fill_shading_state(Grid& grid) const override;

  private:
    struct Row {
        std::uint32_t curve = 0;
        double t = 0.0;
        bool shrunk = false;  ///< to its left end
    };

    /// [m_count] of this batch's curves, or of the part of one.
    using Controls = std::vector<CurveControl>;
    bool find_across(const Controls& controls);
    bool find_rows(const Controls& controls, std::size_t most);
    double end_of(std::uint32_t curve) const;
    double start() const { return m_count == 1 ? m_lo : 0.0; }
    double end(std::uint32_t curve) const {
        return m_count == 1 && m_hi > 0.0 ? m_hi : end_of(curve);
    }
    /// visit(j, row, the curve's control points) for every row.
    template <class Visit>
    void for_each_row(Visit visit) const;
    void place_row(Grid& grid, int j, const Row& row, const CurveControl& control) const;
    void shade_row(Grid& grid, int j, const Row& row, const CurveControl& control) const;

    double m_lo = 0.0, m_hi = 0.0;  ///< of a single curve; m_hi 0: to its end
    int m_across = 0;               ///< micropolygons across; 0 = not yet known
    bool m_thin = false;            ///< its rows share places of normals
    std::vector<Row> m_rows;        ///< of what can be diced
};

}  // namespace granita
