// SPDX-License-Identifier: GPL-3.0-or-later
// Is a sample inside a micropolygon, and how deep: native/hider/micropolygon.h and
// corner_arithmetic.inl in GLSL, operation by operation; the reasons are there.
//
// `precise` forbids fused operations: a fused edge is not antisymmetric, and tilings would leak.
// Coverage needs no division.  Doubles only decide samples on an edge or over a fold.
//
// A corner is vec4(x, y, w, z).
#include "shared/compute_layout.h"

layout(location = COMPUTE_PERSPECTIVE) uniform bool perspective;
layout(location = COMPUTE_KEY_RANGE) uniform vec2 key_range;  // far, near

const uint kTriangleA = 1u, kTriangleB = 2u, kTransparent = 4u;

vec4 at_time(vec4 begin, vec4 end, float t) {
    precise const vec4 delta = end - begin;
    precise const vec4 corner = begin + t * delta;
    return corner;
}

vec2 offset_pinhole(vec4 c, vec2 sample_xy) {
    precise const vec2 d = c.xy - sample_xy * c.z;
    return d;
}

/// `lens`: u, v, 1 / focus distance.
vec2 offset_lens(vec4 c, vec2 sample_xy, vec3 lens) {
    precise const float shear = c.w * lens.z - 1.0;
    precise const vec2 d = (c.xy + lens.xy * shear) - sample_xy * c.z;
    return d;
}

float edge(vec2 a, vec2 b) {
    precise const float e = a.x * b.y - a.y * b.x;
    return e;
}

/// a b - c d of floats: their products are exact in double, so the sign is.
double product_difference(double a, double b, double c, double d) {
    precise const double difference = a * b - c * d;
    return difference;
}

struct Side {
    double edge;
    int side;
};

int side_of(double x) { return int(x > 0.0lf) - int(x < 0.0lf); }

Side side(dvec2 a, double wa, dvec2 b, double wb) {
    const double e = product_difference(a.x, b.y, a.y, b.x);
    if (e != 0.0lf) return Side(e, side_of(e));
    const double along_x = product_difference(a.y, wb, wa, b.y);
    if (along_x != 0.0lf) return Side(e, side_of(along_x));
    return Side(e, side_of(product_difference(wa, b.x, a.x, wb)));
}

void hit_triangle(Side e01, Side e12, Side e20, vec3 z, inout bool hit, inout float key) {
    if (e01.side == 0 || e01.side != e12.side || e01.side != e20.side) return;
    precise const double sum = e12.edge + e20.edge + e01.edge;
    if (sum == 0.0lf) return;
    precise const double b1 = e20.edge / sum, b2 = e01.edge / sum;
    const dvec3 zz = dvec3(z);
    precise const double z_hit = zz.x + b1 * (zz.y - zz.x) + b2 * (zz.z - zz.x);
    const double z_in =
        clamp(z_hit, min(min(zz.x, zz.y), zz.z), max(max(zz.x, zz.y), zz.z));
    const float k = float(perspective ? 1.0lf / z_in : -z_in);
    if (!(k >= key_range.x && k <= key_range.y)) return;
    if (!hit || k > key) key = k;
    hit = true;
}

/// Both triangles exactly; of a folded micropolygon the nearer one.
bool hit_exactly(vec4 c[4], vec2 d[4], uint kind, out float key) {
    bool hit = false;
    key = 0.0;
    const Side e02 = side(d[0], c[0].z, d[2], c[2].z);
    if ((kind & kTriangleA) != 0u)
        hit_triangle(side(d[0], c[0].z, d[1], c[1].z), side(d[1], c[1].z, d[2], c[2].z),
                     Side(-e02.edge, -e02.side), vec3(c[0].w, c[1].w, c[2].w), hit, key);
    if ((kind & kTriangleB) != 0u)
        hit_triangle(e02, side(d[2], c[2].z, d[3], c[3].z), side(d[3], c[3].z, d[0], c[0].z),
                     vec3(c[0].w, c[2].w, c[3].w), hit, key);
    return hit;
}

/// One sign, zeros allowed; `strict`: without zeros.
bool inside(vec3 e, out bool strict) {
    const float least = min(min(e.x, e.y), e.z), most = max(max(e.x, e.y), e.z);
    strict = least > 0.0 || most < 0.0;
    return least >= 0.0 || most <= 0.0;
}

bool hit_micropolygon(vec4 c[4], vec2 d[4], uint kind, out float key) {
    key = 0.0;
    const float e01 = edge(d[0], d[1]), e12 = edge(d[1], d[2]), e02 = edge(d[0], d[2]);
    const float e23 = edge(d[2], d[3]), e30 = edge(d[3], d[0]);
    bool strict_a = false, strict_b = false;
    const bool in_a = (kind & kTriangleA) != 0u && inside(vec3(e01, e12, -e02), strict_a);
    const bool in_b = (kind & kTriangleB) != 0u && inside(vec3(e02, e23, e30), strict_b);
    if (!in_a && !in_b) return false;
    // Strictly inside one triangle and outside the other; the rest is on an edge or over a fold.
    if (!(in_a ? strict_a && !in_b : strict_b)) return hit_exactly(c, d, kind, key);

    const vec3 weight = in_a ? vec3(e12, -e02, e01) : vec3(e23, e30, e02);
    const float z1 = in_a ? c[1].w : c[2].w, z2 = in_a ? c[2].w : c[3].w, z0 = c[0].w;
    precise const float share = 1.0 / (weight.x + weight.y + weight.z);
    precise const float z = z0 + weight.y * share * (z1 - z0) + weight.z * share * (z2 - z0);
    const float z_in = min(max(z, min(z0, min(z1, z2))), max(z0, max(z1, z2)));
    key = perspective ? 1.0 / z_in : -z_in;
    return key >= key_range.x && key <= key_range.y;
}
