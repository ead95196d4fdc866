// SPDX-License-Identifier: GPL-3.0-or-later
// What batches of curves and of points share: a run of a batch's elements, which is split until it
// is narrow and dices into one grid, and a single element, which is then split by itself.
#pragma once

#include <memory>
#include <vector>

#include "dice/opened_elements.h"

namespace granita {

class ElementBatch : public Primitive {
  public:
    GridKey key() const override;
    bool diceable() const override { return m_diceable; }
    std::vector<std::unique_ptr<Primitive>> split() const override;

  protected:
    /// Bounds, and what makes the shading state, of a grid whose positions are set: a million hairs
    /// are diced for those; shading state, three times the bytes, is made of hairs that are seen.
    /// @return the copy() that makes it.
    std::shared_ptr<const ElementBatch> finish(Grid& grid) const;
    /// Whole batch.
    ElementBatch(const OpenedElements& elements, std::size_t batch)
        : m_elements(&elements), m_batch(batch), m_count(elements.shared().batch(batch).size()) {}

    /// The same in all, as a child yet to be cut.
    virtual std::unique_ptr<ElementBatch> child() const = 0;
    /// Half 0 or 1 of a single element.
    virtual void halve(unsigned number) = 0;
    /// Sets m_diceable, and m_runs where elements are scattered.
    virtual void measure() = 0;
    /// What can be diced, once more.
    virtual std::shared_ptr<const ElementBatch> copy() const = 0;
    virtual void fill_shading_state(Grid& grid) const = 0;

    std::uint32_t element(std::size_t i) const { return m_elements->shared().batch(m_batch)[i]; }
    /// Of a camera-space box, with the rounding of positions.
    RasterBounds raster_bounds(Bounds3f box) const;
    /// The wider one of what two boxes, at the first and the last knot, are bounded by in focus:
    /// what moves, or is out of focus, is met by as many buckets alone or together.
    RasterBounds still_bounds(const Bounds3f& first, const Bounds3f& last) const;
    /// Several elements, of these still bounds, that lie too far from each other for one grid:
    /// buckets beside them should not meet them.
    bool scattered(const RasterBounds& bounds) const;
    /// Of scattered elements, so many that a run of neighbours may not be: a power of two.
    unsigned runs_of(const RasterBounds& bounds) const;
    /// Of row j, which crosses the elements; `i` counts across.
    static std::size_t vertex(const Grid& grid, int i, int j) {
        return static_cast<std::size_t>(i) * (static_cast<std::size_t>(grid.n_u) + 1) +
               static_cast<std::size_t>(j);
    }
    /// Keeps the opened instance alive, and measures.
    void own(std::shared_ptr<const OpenedElements> elements);
    /// Elements further apart than this, pixels, are split from each other.
    static constexpr float kRegion = 48.0f;

    const OpenedElements* m_elements;
    std::shared_ptr<const OpenedElements> m_owner;  ///< keeps m_elements
    std::size_t m_batch;
    std::uint64_t m_path = 1;
    std::size_t m_first = 0, m_count = 0;  ///< elements of the batch
    bool m_diceable = false;
    unsigned m_runs = 2;  ///< that several elements are split into
};

}  // namespace granita
