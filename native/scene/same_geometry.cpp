// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstring>
#include <type_traits>

#include "scene/geometry_data.h"

namespace granita {
namespace {

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
    static_assert(std::is_trivially_copyable_v<T>);
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool is_same(const Attribute& a, const Attribute& b) {
    return a.name == b.name && a.domain == b.domain && a.kind == b.kind && a.width == b.width &&
           a.encoded == b.encoded && same_bytes(a.values, b.values);
}

bool is_same(const Subdivision& a, const Subdivision& b) {
    return a.scheme == b.scheme && a.boundary == b.boundary && a.uv == b.uv &&
           same_bytes(a.crease_verts, b.crease_verts) &&
           same_bytes(a.crease_values, b.crease_values) &&
           same_bytes(a.vertex_creases, b.vertex_creases);
}

}  // namespace

bool is_same(const GeometryData& a, const GeometryData& b) {
    return a.name == b.name && a.kind == b.kind && a.knots == b.knots &&
           a.is_subdivision == b.is_subdivision && same_bytes(a.points, b.points) &&
           same_bytes(a.adjacent, b.adjacent) && same_bytes(a.generated, b.generated) &&
           same_bytes(a.face_sizes, b.face_sizes) && same_bytes(a.corner_verts, b.corner_verts) &&
           same_bytes(a.ngon_triangles, b.ngon_triangles) &&
           a.quads_by_normal == b.quads_by_normal && same_bytes(a.curve_sizes, b.curve_sizes) &&
           same_bytes(a.radius, b.radius) && same_bytes(a.material_index, b.material_index) &&
           same_bytes(a.smooth, b.smooth) && same_bytes(a.corner_normals, b.corner_normals) &&
           std::ranges::equal(a.attributes, b.attributes,
                              [](const auto& x, const auto& y) { return is_same(x, y); }) &&
           is_same(a.subdivision, b.subdivision);
}

}  // namespace granita
