// SPDX-License-Identifier: GPL-3.0-or-later
// Light that a surface sends on, by what sends it and where it comes from, for passes.  The total
// is summed by itself: it has the same bits whether the parts are asked for or not.
#pragma once

#include <vector>

#include "math/vec.h"

namespace granita {

/// Each [points]; premultiplied by opacity like the radiance they are parts of.
struct ReflectionParts {
    /// By lobe, of lamps and the world, and of other surfaces; their sum is the total.
    std::vector<Vec3f> diffuse, glossy, transmission;
    std::vector<Vec3f> diffuse_bounced, glossy_bounced, transmission_bounced;
    std::vector<Vec3f> diffuse_color, glossy_color, transmission_color;  ///< the lobes' albedo
                                                                         ///< towards the view
    std::vector<Vec3f> arriving, unblocked;  ///< of lamps, all lobes; with and without shadows

    void resize(std::size_t points) {
        for (auto* values : {&diffuse, &glossy, &transmission, &diffuse_bounced, &glossy_bounced,
                             &transmission_bounced, &diffuse_color, &glossy_color,
                             &transmission_color, &arriving, &unblocked})
            values->assign(points, Vec3f(0.0f));
    }
};

}  // namespace granita
