// SPDX-License-Identifier: GPL-3.0-or-later
// Marks the grids of the micropolygons that samples see, in the pass that they belong to.  One
// invocation a sample; z is the layer.
#include "raster/marks.glsl"

layout(local_size_x = RASTER_GROUP, local_size_y = RASTER_GROUP) in;
layout(binding = 0) uniform usampler2DArray names;
layout(std430, binding = RASTER_GRIDS) readonly buffer VertexGrids { uint vertex_grids[]; };
layout(binding = 1) uniform sampler2DArray peeled_depth;
layout(location = RASTER_TEXELS) uniform ivec4 texels;  // corner and size
layout(location = RASTER_HIDE_SATURATED) uniform bool hide_saturated;

void main() {
    if (any(greaterThanEqual(ivec2(gl_GlobalInvocationID.xy), texels.zw))) return;
    const ivec3 at = ivec3(gl_GlobalInvocationID) + ivec3(texels.xy, 0);
    const uint name = texelFetch(names, at, 0).r;
    if (name == 0u) return;
    // Behind a saturated sample nothing is seen (raster/composite.comp).
    if (hide_saturated && texelFetch(peeled_depth, at, 0).r < 0.0) return;
    mark(vertex_grids[name - 1u], uint(at.z));
}
