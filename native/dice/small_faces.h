// SPDX-License-Identifier: GPL-3.0-or-later
// Faces of a mesh that dice into few micropolygons each, and their batches: a million of
// them must not be a million grids (the paper names the cost of tiny grids in 9.4).
//
// Batches are made when an instance is opened, for the camera and from all of its faces: neighbours
// on screen and in depth that show the same side and have one material.  What shows its back is
// apart, so that it is culled and never shaded where the front hides it.  Faces of one micropolygon
// (FaceBatch) do not mix with larger ones (PatchBatch).
//
// Of what is displaced the vertices are displaced here: each once, not once for every face around
// it.  A face that this stretches to more than a point may stand for goes with the larger ones.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dice/vertex_offsets.h"
#include "math/bounds.h"

namespace granita {

class OpenedMesh;

class SmallFaces {
  public:
    /// Every face of a batch of whole ones has four sides (or three) that EdgeRate leaves whole;
    /// not every such face is in one.
    SmallFaces() = default;
    explicit SmallFaces(const OpenedMesh& mesh);

    std::size_t batch_count() const { return m_batches.empty() ? 0 : m_batches.size() - 1; }
    /// Patches of a batch, in all probability of at most Options::grid_size micropolygons;
    /// certainly where they are whole.
    std::span<const std::uint32_t> batch(std::size_t index) const {
        return {m_order.data() + m_batches[index], m_batches[index + 1] - m_batches[index]};
    }
    /// [knots] of a batch, camera space.
    std::span<const Bounds3f> boxes(std::size_t index) const {
        const std::size_t knots = m_boxes.size() / batch_count();
        return {m_boxes.data() + index * knots, knots};
    }
    bool is_whole(std::size_t index) const { return m_whole[index]; }
    /// Of their vertices.
    const VertexOffsets& offsets() const { return m_offsets; }
    /// Patches in no batch.
    std::span<const std::uint32_t> others() const { return m_others; }
    std::uint64_t bytes() const {
        return 4 * (m_order.size() + m_batches.size() + m_others.size()) +
               sizeof(Bounds3f) * m_boxes.size() + m_offsets.bytes();
    }

  private:
    VertexOffsets m_offsets;
    std::vector<std::uint32_t> m_order, m_batches, m_others;
    std::vector<bool> m_whole;      ///< [batches]
    std::vector<Bounds3f> m_boxes;  ///< [batches][knots]
};

}  // namespace granita
