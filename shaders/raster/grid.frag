// SPDX-License-Identifier: GPL-3.0-or-later
// What a sample sees: premultiplied radiance, or the micropolygon.  Defines as in grid.vert.
#include "shared/raster_layout.h"

#if !PERSPECTIVE
// Orthographic depth keeps the precision of float z over any clip range only as a reciprocal.
layout(location = RASTER_NEAR) uniform float near_clip;
in float z_camera;
#endif

#if WITH_RADIANCE
in vec4 radiance_here;
layout(location = 0) out vec4 seen;
#else
flat in uint corner;
layout(location = 0) out uint seen;
#endif

void main() {
#if !PERSPECTIVE
    if (z_camera < near_clip) discard;
    gl_FragDepth = near_clip / z_camera;
#endif
#if WITH_RADIANCE
    seen = radiance_here;
#else
    seen = corner + 1u;  // 0 is nothing
#endif
}
