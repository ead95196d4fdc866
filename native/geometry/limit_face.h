// SPDX-License-Identifier: GPL-3.0-or-later
// The limit surface of one face of a subdivision cage, with its control points gathered, for a
// number of values (columns) a point at once: all motion knots share one set of weights.
//
// (u, v) are OpenSubdiv's own of the face: a quad's [0,1]^2, an n-gon's sub-faces as its
// Parameterization lays them out.
#pragma once

#include <opensubdiv/bfr/surface.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/subdivision_topology.h"
#include "math/vec.h"

namespace granita {

class LimitFace {
  public:
    /// One array of 3D points a set, each [V]; columns 3 s .. 3 s + 2 are set s.  False where the
    /// face has no limit surface.
    bool gather(const SubdivisionTopology& topology, int face,
                std::span<const Vec3f* const> point_sets);

    /// `p`, `du`, `dv` [columns].
    void evaluate(const Vec2d& uv, double* p) const;
    void evaluate(const Vec2d& uv, double* p, double* du, double* dv) const;
    /// A polynomial patch: bounded by its Bezier points.
    bool is_regular() const { return m_surface.IsRegular(); }
    std::span<const double> control_points() const {
        return {m_points.data(), static_cast<std::size_t>(m_surface.GetNumControlPoints()) *
                                     static_cast<std::size_t>(m_columns)};
    }
    int columns() const { return m_columns; }

    /// A UV map of the same face, [2] columns.
    bool gather_uv(const SubdivisionTopology& topology, int face, int channel);

  private:
    using Surface = OpenSubdiv::Bfr::Surface<double>;
    void prepare();

    Surface m_surface;
    int m_columns = 0;
    std::vector<double> m_points;  ///< [patch points][columns]
};

/// Places on a face in OpenSubdiv's (u, v).
class FaceCoordinates {
  public:
    FaceCoordinates(const SubdivisionTopology& topology, int face);
    Vec2d vertex(int corner) const;
    Vec2d edge(int local, double t) const;  ///< t runs as the face does
    /// `uv` in [0,1]^2 of a sub-face (of the face where it has none).
    Vec2d sub_face(int sub, const Vec2d& uv) const;
    /// Of OpenSubdiv's (u, v) by a sub-face's.
    double sub_face_scale() const { return m_parameterization.HasSubFaces() ? 0.5 : 1.0; }

  private:
    OpenSubdiv::Bfr::Parameterization m_parameterization;
};

}  // namespace granita
