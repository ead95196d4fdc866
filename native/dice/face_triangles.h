// SPDX-License-Identifier: GPL-3.0-or-later
// Triangles of small faces that samples see, as a grid of their own: of a hundred faces of a pixel
// few are seen, and only of these has shading to know anything.
#pragma once

#include <span>

#include "dice/grid.h"
#include "dice/opened_mesh.h"

namespace granita {

/// A triangle of a micropolygon that is a patch.
struct FaceTriangle {
    GridTriangle of;
    BasePatch patch;  ///< a half of a pair of triangles
};

/// As Grid::triangles has them, of a batch of small faces.
Grid face_triangles(const OpenedMesh& mesh, const Grid& batch,
                    std::span<const FaceTriangle> wanted);

}  // namespace granita
