// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "scene/geometry_data.h"

namespace granita {

/// Of a mesh of which some faces bound a volume and others do not: by face, the number by which
/// `volume_of` knows what the faces that hang together with it bound, -1 where none does.
/// `volume_of`: by face, -1 = nothing.  Where they bound several, the first face's counts.  Faces
/// hang together by edges of two: a wall within a tank is a piece of its own.
std::vector<std::int32_t> enclosed_volumes(
    const GeometryData& mesh, const std::function<std::int32_t(std::size_t)>& volume_of);

}  // namespace granita
