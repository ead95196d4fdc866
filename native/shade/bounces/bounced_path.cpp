// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/bounces/bounced_path.h"

#include <algorithm>

namespace granita {

BouncedPath BouncedPath::leaving(const LobeRay& ray) {
    const RayType type = ray.ray.type;
    const Kind kind = is_diffuse(type) ? Kind::Diffuse
                      : is_sharp(type) ? Kind::Mirrored
                                       : Kind::Glossy;
    return {.next = ray,
            .diffuse_part = ray.diffuse,
            .transmitted = ray.transmitted,
            .kind = kind,
            .sure_part = ray.counts_as,
            .splits = ray.samples,
            .least_pdf = ray.pdf,
            .width = ray.width,
            .spread = ray.spread,
            .seen = glm::length(ray.ray.start)};
}

BouncedPath BouncedPath::sent(const LobeRay& way, const Vec3f& weight, float distance) const {
    BouncedPath on = *this;
    on.width += spread * distance;
    on.seen += distance;
    on.next = way;
    on.next.weight = next.weight * weight;
    on.next.share = next.share;
    on.next.point = next.point;
    on.next.place = next.place;
    on.spread = std::max(spread, way.spread);
    on.least_pdf = std::min(least_pdf, way.pdf);
    on.length = 0.0f;
    ++on.depth;
    return on;
}

BouncedPath BouncedPath::passing(const Vec3f& start, const Vec3f& weight, float distance) const {
    BouncedPath on = *this;
    on.width += spread * distance;
    on.seen += distance;
    on.length += distance;
    on.next.weight *= weight;
    on.next.ray.start = start;
    ++on.passed;
    return on;
}

void BouncedPath::count_bounce(bool is_scattered) {
    const RayType type = next.ray.type;
    was_diffuse |= is_diffuse(type);
    ++(is_scattered               ? volume
       : type == RayType::Diffuse ? diffuse
       : goes_through(type)       ? transmission
                                  : glossy);
    if (kind == Kind::Mirrored && !is_sharp(type)) kind = Kind::Glossy;
}

}  // namespace granita
