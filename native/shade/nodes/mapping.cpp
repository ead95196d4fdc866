// SPDX-License-Identifier: GPL-3.0-or-later
// Mapping: scale, rotate (XYZ Euler angles), translate; four meanings of the vector.
#include <cmath>

#include "shade/nodes/nodes.h"
#include "shade/nodes/scalar_math.h"

namespace granita {

namespace {

/// Rotation about x, then y, then z.
Mat3f rotation_from_euler(const Vec3f& angle) {
    const Vec3f c = glm::cos(angle), s = glm::sin(angle);
    return Mat3f(Vec3f(c.y * c.z, c.y * s.z, -s.y),
                 Vec3f(s.x * s.y * c.z - c.x * s.z, s.x * s.y * s.z + c.x * c.z, s.x * c.y),
                 Vec3f(c.x * s.y * c.z + s.x * s.z, c.x * s.y * s.z - s.x * c.z, c.x * c.y));
}

Vec3f quotient(const Vec3f& a, const Vec3f& b) {
    return {safe_divide(a.x, b.x), safe_divide(a.y, b.y), safe_divide(a.z, b.z)};
}

Vec3f unit(const Vec3f& v) {
    const float length = glm::length(v);
    return length != 0.0f ? v / length : v;
}

Vec3f map_point(const Vec3f& v, const Vec3f& location, const Vec3f& rotation, const Vec3f& scale) {
    return rotation_from_euler(rotation) * (v * scale) + location;
}
Vec3f map_texture(const Vec3f& v, const Vec3f& location, const Vec3f& rotation,
                  const Vec3f& scale) {
    return quotient(glm::transpose(rotation_from_euler(rotation)) * (v - location), scale);
}
Vec3f map_vector(const Vec3f& v, const Vec3f&, const Vec3f& rotation, const Vec3f& scale) {
    return rotation_from_euler(rotation) * (v * scale);
}
Vec3f map_normal(const Vec3f& v, const Vec3f&, const Vec3f& rotation, const Vec3f& scale) {
    return unit(rotation_from_euler(rotation) * quotient(v, scale));
}

}  // namespace

void build_mapping(NodeBuilder& b) {
    const std::string type = b.text("vector_type", "POINT");
    const auto function = type == "TEXTURE"  ? map_texture
                          : type == "VECTOR" ? map_vector
                          : type == "NORMAL" ? map_normal
                                             : map_point;
    b.output_vector("Vector", b.map<Vec3f>(function, b.vector("Vector"), b.vector("Location"),
                                           b.vector("Rotation"), b.vector("Scale", Vec3f(1.0f))));
}

}  // namespace granita
