// SPDX-License-Identifier: GPL-3.0-or-later
// Small faces of one material as one grid of separate micropolygons (Grid::disjoint), each the
// micropolygon that its patch would be.  The two triangles of a bent quad are shaded as two faces.
//
// What is lit is left to samples, which ask for the triangles that they see (Grid::triangles).
// Else: neighbours are gathered into clusters of about the shading rate's area, each shaded once
// and of one colour all over.  A cluster's point is the mean of its faces by the area that is seen
// of them, and so are its normal and what does not ask for derivatives; what does (textures) is
// looked up at the face in its middle, with the footprint of the cluster.  A colour so moves by
// half the shading rate at most; faces of a cluster differ by no more than 8 degrees.
#pragma once

#include <memory>
#include <span>

#include "dice/opened_mesh.h"

namespace granita {

class FaceBatch : public Primitive {
  public:
    /// `faces`: patches of the mesh, which keeps them; `boxes` [knots]: theirs, likewise.
    FaceBatch(std::shared_ptr<const OpenedMesh> mesh, std::span<const std::uint32_t> faces,
              std::span<const Bounds3f> boxes);

    RasterBounds bounds() const override;
    std::vector<Bounds3f> knot_boxes() const override;
    GridKey key() const override;
    bool diceable() const override { return true; }
    std::vector<std::unique_ptr<Primitive>> split() const override { return {}; }
    std::unique_ptr<Grid> dice() const override;

  protected:
    std::size_t face_count() const { return m_faces.size(); }
    std::span<const Bounds3f> boxes() const { return m_boxes; }
    const BasePatch& patch(std::size_t i) const { return m_mesh->shared().patches()[m_faces[i]]; }
    /// Room for `micropolygons` at every knot; what all of them have in common.
    std::unique_ptr<Grid> make_grid(std::size_t micropolygons) const;

    std::shared_ptr<const OpenedMesh> m_mesh;

  private:
    struct Face;
    struct Cluster;
    void fill_shading_state(Grid& grid) const;
    Grid triangles(const Grid& grid, std::span<const GridPlace> wanted) const;
    Face face(const Grid& grid, std::size_t i, const BasePatch& part) const;
    std::vector<Cluster> clusters(Grid& grid, const std::vector<Face>& faces) const;
    static void find_center(Cluster& cluster, const std::vector<Face>& faces);
    /// `vertices`: the grid's, at the frame time.
    void add_point(Grid& grid, const std::vector<Face>& faces, const Cluster& cluster,
                   const std::vector<Vec3f>& vertices) const;
    float bulge(const std::vector<Face>& faces, const Cluster& cluster) const;
    void fill_attributes(Grid& grid, const std::vector<Face>& faces,
                         const std::vector<Cluster>& clusters) const;

    std::span<const std::uint32_t> m_faces;
    std::span<const Bounds3f> m_boxes;
};

}  // namespace granita
