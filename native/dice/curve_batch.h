// SPDX-License-Identifier: GPL-3.0-or-later
// Curves as ribbons that face the eye at every knot, many to a primitive.
//
// A primitive is a run of neighbouring curves, or the same part of each.  Its grid is a ladder
// lying down: u runs along; from one curve to the next lead rows that have shrunk to a point, so
// that the micropolygons between have no area and the hider leaves them out.
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
    std::vector<std::unique_ptr<Primitive>> split() const override;

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

    /// A curve's, or of the part of one.
    struct Measures {
        Bounds3f box, first, last;  ///< swept; at the first and the last knot
        double width = 0.0;         ///< pixels, the largest
        std::vector<double> ends;   ///< of the steps that dice it; more than a grid holds: too many
    };
    /// Without ends.
    Measures measures(std::uint32_t curve) const;
    const Measures& measured(std::size_t i) const {
        return (*m_measures)[m_first - m_first_measured + i];
    }
    void measure_curves();
    void find_ends();
    void forget_measures() {
        m_measures.reset();
        m_has_ends = false;
    }
    RasterBounds still_bounds() const;
    bool find_across();
    /// @param all still_bounds()
    unsigned pieces_along(const RasterBounds& all) const;
    std::unique_ptr<CurveBatch> copy_of_run() const;
    bool find_rows(std::size_t most);
    double end_of(std::uint32_t curve) const;
    bool is_part() const { return m_lo > 0.0 || m_hi > 0.0; }
    double start() const { return m_lo; }
    double end(std::uint32_t curve) const { return m_hi > 0.0 ? m_hi : end_of(curve); }
    /// visit(j, row, the curve's control points) for every row.
    template <class Visit>
    void for_each_row(Visit visit) const;
    void place_row(Grid& grid, int j, const Row& row, const CurveControl& control) const;
    void shade_row(Grid& grid, int j, const Row& row, const CurveControl& control) const;
    /// Camera space, as RibbonRow; `front` is unit, `half` leads from the axis to the edge.
    struct Side {
        Vec3d side{0.0}, front{0.0}, half{0.0}, rise{0.0}, along{0.0};
        /// Of a tube, so far out to the edge.
        Vec3d normal_at(double sine) const;
    };
    Side side_at(const CurveControl& control, double t) const;
    Grid triangles(const Grid& from, std::span<const GridPlace> wanted) const;

    /// Of the curves of the batch that this one was split from, or of their parts.
    std::shared_ptr<const std::vector<Measures>> m_measures;
    std::size_t m_first_measured = 0;
    bool m_has_ends = false;        ///< `m_measures`
    double m_lo = 0.0, m_hi = 0.0;  ///< of each curve; m_hi 0: to its end
    unsigned m_pieces = 1;          ///< along the curves, of what cannot be diced
    int m_across = 0;               ///< micropolygons across; 0 = not yet known
    bool m_thin = false;            ///< its rows share places of normals
    std::vector<Row> m_rows;        ///< of what can be diced
};

}  // namespace granita
