// SPDX-License-Identifier: GPL-3.0-or-later
// Faces of a few pixels as one grid of separate micropolygons (Grid::disjoint): the micropolygons
// that their patches dice into, with the same vertices, shaded at the same points.  A sphere whose
// faces are 3 pixels wide so takes a tenth of the grids, and what a grid costs by itself (a node,
// bounds in time, projection and sorting in each tile) is paid a tenth as often.
#pragma once

#include "dice/face_batch.h"
#include "dice/lattice_stencil.h"

namespace granita {

class PatchBatch final : public FaceBatch {
  public:
    using FaceBatch::FaceBatch;
    std::unique_ptr<Grid> dice() const override;

  private:
    /// A face that is a lattice by its sides alone.
    struct Lattice {
        BasePatch patch;
        std::uint32_t stencil;
    };
    /// A part of another one, as its patch diced it.
    struct Piece {
        std::uint32_t face;
        std::shared_ptr<const Grid> grid;
    };
    /// All of the batch, in the order in which the grid has it: lattices, then pieces.
    struct Parts {
        std::vector<Lattice> lattices;
        std::vector<Piece> pieces;
        /// [vertices of the lattices] of what is displaced.
        std::vector<Vec3f> offsets;
    };
    Parts find_parts() const;
    bool find_stencil(const BasePatch& patch, std::uint32_t& stencil) const;
    int levels(std::uint32_t a, std::uint32_t b, const BasePatch& face) const;
    void dice_face(const BasePatch& patch, std::vector<Piece>& pieces) const;
    std::vector<Bounds3f> still_boxes() const;
    SurfacePlace owner_place(const BasePatch& patch, const LatticeStencil& stencil,
                             std::size_t vertex) const;
    void find_offsets(Parts& parts) const;
    Offsets offsets_with_slopes(const Parts& parts) const;
    void place(Grid& grid, const Parts& parts) const;
    RasterBounds corner_bounds() const;
    void count_spared(const Grid& grid, const Parts& parts) const;
    void fill_shading_state(Grid& grid, const Parts& parts) const;
    /// `first`: of its vertices among those of all lattices.
    void add_points(const Lattice& lattice, const Offsets& offsets, std::size_t first,
                    Grid& grid) const;
    void fill_attributes(Grid& grid, const Parts& parts, const Offsets& offsets) const;
};

}  // namespace granita
