// SPDX-License-Identifier: GPL-3.0-or-later
// Marks the grids of the opaque micropolygons that samples see.  One invocation a sample; z is the
// layer.
#include "shared/raster_layout.h"

layout(local_size_x = RASTER_GROUP, local_size_y = RASTER_GROUP) in;
layout(binding = 0) uniform usampler2DArray names;
layout(std430, binding = RASTER_SEEN) buffer Seen { uint seen[]; };
layout(std430, binding = RASTER_GRIDS) readonly buffer VertexGrids { uint vertex_grids[]; };
layout(location = RASTER_TEXELS) uniform ivec4 texels;  // corner and size

void main() {
    if (any(greaterThanEqual(ivec2(gl_GlobalInvocationID.xy), texels.zw))) return;
    const ivec3 at = ivec3(gl_GlobalInvocationID) + ivec3(texels.xy, 0);
    const uint name = texelFetch(names, at, 0).r;
    if (name != 0u) seen[vertex_grids[name - 1u]] = 1u;
}
