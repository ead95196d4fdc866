// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/corner_values.h"

#include <algorithm>

#include "math/srgb.h"

namespace granita {
namespace {

using Value = std::array<double, 4>;

Value average(const Value& a, const Value& b) {
    Value sum;
    for (std::size_t i = 0; i < 4; ++i) sum[i] = 0.5 * (a[i] + b[i]);
    return sum;
}

/// One corner of the mesh.
Value value_at(const SharedGeometry& geometry, const AttributeRequest& request,
               const Attribute* attribute, std::uint32_t face, std::uint32_t corner) {
    Value value{};
    const std::size_t vertex = static_cast<std::size_t>(geometry.data().corner_verts[corner]);
    if (is_position(request.source)) {
        Vec3d p(geometry.points(request.source)[vertex]);
        if (in_box(geometry.data(), request.source)) p = generated(geometry.frame_box(), p);
        return {p.x, p.y, p.z, 1.0};
    }
    if (!attribute) return value;
    const std::size_t element = attribute->domain == Domain::Point  ? vertex
                                : attribute->domain == Domain::Face ? face
                                                                    : corner;
    const std::size_t width = static_cast<std::size_t>(attribute->width);
    for (std::size_t i = 0; i < width; ++i) value[i] = attribute->values[element * width + i];
    if (width == 1) value[1] = value[2] = value[0];
    if (width < 4) value[3] = 1.0;
    return value;
}

/// Of its normal or its tangent.
CornerValues frame_values(const SharedGeometry& geometry, const BasePatch& patch,
                          const AttributeRequest& request) {
    CornerValues values;
    if (geometry.subdivision()) return values;
    if (request.source == AttributeSource::CornerNormal) {
        const std::array<Vec3f, 4> normals = geometry.corner_normals(patch);
        for (std::size_t i = 0; i < 4; ++i)
            values.at[i] = {normals[i].x, normals[i].y, normals[i].z, 0.0};
        return values;
    }
    const std::array<Vec4f, 4> tangents = geometry.corner_tangents(patch, request.name);
    for (std::size_t i = 0; i < 4; ++i)
        values.at[i] = {tangents[i].x, tangents[i].y, tangents[i].z, tangents[i].w};
    return values;
}

/// From everywhere to one corner.
CornerValues values_to_corner(const SharedGeometry& geometry, const BasePatch& patch,
                              AttributeSource source) {
    const auto corner =
        static_cast<std::size_t>(source) - static_cast<std::size_t>(AttributeSource::ToCorner0);
    const CornerValues places =
        corner_values(geometry, patch, {AttributeSource::ObjectPosition, "", 3});
    CornerValues values;
    for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t c = 0; c < 3; ++c)
            values.at[k][c] = places.at[corner][c] - places.at[k][c];
    return values;
}

}  // namespace

CornerWeights::CornerWeights(PatchKind kind, const Vec2d& uv) {
    const double u = uv.x, v = uv.y;
    if (kind == PatchKind::Triangle) {
        w = {1.0 - u - v, u, v, 0.0};
        du = {-1.0, 1.0, 0.0, 0.0};
        dv = {-1.0, 0.0, 1.0, 0.0};
    } else if (kind == PatchKind::TrianglePair) {
        w = u > v ? std::array{1.0 - u, u - v, v, 0.0} : std::array{1.0 - v, 0.0, u, v - u};
        if (u > v) {
            du = {-1.0, 1.0, 0.0, 0.0};
            dv = {0.0, -1.0, 1.0, 0.0};
        } else if (u < v) {
            du = {0.0, 0.0, 1.0, -1.0};
            dv = {-1.0, 0.0, 0.0, 1.0};
        } else {
            // Their mean on the crease: the normal across it is the two triangles' by area.
            du = {-0.5, 0.5, 0.5, -0.5};
            dv = {-0.5, -0.5, 0.5, 0.5};
        }
    } else {
        w = {(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v};
        du = {v - 1.0, 1.0 - v, v, -v};
        dv = {u - 1.0, -u, u, 1.0 - u};
    }
}

const Attribute* find_attribute(const GeometryData& data, const AttributeRequest& request) {
    switch (request.source) {
        case AttributeSource::DefaultUv:
            return data.default_uv();
        case AttributeSource::DefaultColor:
            return data.default_color();
        case AttributeSource::Named:
            return data.find_attribute(request.name);
        default:
            return nullptr;
    }
}

CornerValues corner_values(const SharedGeometry& geometry, const BasePatch& patch,
                           const AttributeRequest& request) {
    if (request.source == AttributeSource::CornerNormal ||
        request.source == AttributeSource::Tangent)
        return frame_values(geometry, patch, request);
    if (is_to_corner(request.source)) return values_to_corner(geometry, patch, request.source);
    const Attribute* attribute = find_attribute(geometry.data(), request);
    const auto value = [&](std::uint32_t corner) {
        return value_at(geometry, request, attribute, patch.face, corner);
    };
    CornerValues values;
    values.encoded = attribute && attribute->encoded;
    if (patch.kind != PatchKind::SubFace) {
        for (std::size_t i = 0; i < 4; ++i) values.at[i] = value(patch.corner[i]);
        return values;
    }
    const std::uint32_t n = static_cast<std::uint32_t>(geometry.data().face_sizes[patch.face]);
    const std::uint32_t first = geometry.first_corner(patch.face);
    Value centre{};
    for (std::uint32_t i = 0; i < n; ++i) {
        const Value corner = value(first + i);
        for (std::size_t c = 0; c < 4; ++c) centre[c] += corner[c] / n;
    }
    const Value here = value(first + patch.sub);
    values.at = {here, average(here, value(first + (patch.sub + 1) % n)), centre,
                 average(here, value(first + (patch.sub + n - 1) % n))};
    return values;
}

bool in_box(const GeometryData& data, AttributeSource source) {
    return source == AttributeSource::Generated && data.generated.empty();
}

Vec3d generated(const Bounds3f& box, const Vec3d& p_object) {
    Vec3d g(0.5);
    for (int i = 0; i < 3; ++i) {
        const double lo = box.lo[i], hi = box.hi[i];
        if (hi > lo) g[i] = (p_object[i] - lo) / (hi - lo);
    }
    return g;
}

void interpolate(const CornerValues& corners, PatchKind kind, std::span<const Vec2d> uv, int width,
                 std::vector<float>& values, std::vector<float>& du, std::vector<float>& dv) {
    const std::size_t w = static_cast<std::size_t>(width);
    for (std::vector<float>* out : {&values, &du, &dv}) out->resize(uv.size() * w);
    for (std::size_t i = 0; i < uv.size(); ++i) {
        const CornerWeights weights(kind, uv[i]);
        for (std::size_t c = 0; c < w; ++c) {
            double value = 0.0, by_u = 0.0, by_v = 0.0;
            for (std::size_t k = 0; k < 4; ++k) {
                const double at = corners.at[k][std::min<std::size_t>(c, 3)];
                value += weights.w[k] * at;
                by_u += weights.du[k] * at;
                by_v += weights.dv[k] * at;
            }
            if (corners.encoded && c < 3) {
                const double slope = linear_from_srgb_slope(value);
                value = linear_from_srgb(static_cast<float>(value));
                by_u *= slope;
                by_v *= slope;
            }
            values[i * w + c] = static_cast<float>(value);
            du[i * w + c] = static_cast<float>(by_u);
            dv[i * w + c] = static_cast<float>(by_v);
        }
    }
}

}  // namespace granita
