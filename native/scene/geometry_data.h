// SPDX-License-Identifier: GPL-3.0-or-later
// Geometry as Python hands it over: validated plain data, object space, shared by its instances.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "math/vec.h"

namespace granita {

enum class Domain { Point, Face, Corner };  // Face: a curve or a point, where it is no mesh
enum class AttributeKind { Generic, Uv, Color };

struct Attribute {
    std::string name;
    Domain domain = Domain::Point;
    AttributeKind kind = AttributeKind::Generic;
    int width = 1;              ///< floats an element, 1 to 4
    std::vector<float> values;  ///< [elements of the domain][width]
    bool encoded = false;       ///< colours as sRGB's numbers, which is what lies between them too
};

enum class SubdivisionScheme { CatmullClark, Simple };
enum class SubdivisionBoundary { EdgeAndCorner, EdgeOnly };
/// Blender's uv_smooth choices, which are OpenSubdiv's face-varying interpolation options.
enum class SubdivisionUv {
    None,
    PreserveCorners,
    PreserveCornersAndJunctions,
    PreserveCornersJunctionsAndConcave,
    PreserveBoundaries,
    All
};

struct Subdivision {
    SubdivisionScheme scheme = SubdivisionScheme::CatmullClark;
    SubdivisionBoundary boundary = SubdivisionBoundary::EdgeOnly;
    SubdivisionUv uv = SubdivisionUv::PreserveBoundaries;
    std::vector<std::int32_t> crease_verts;  ///< [2 E] vertex pairs of creased edges
    std::vector<float> crease_values;        ///< [E] OpenSubdiv sharpness, >= 10 = infinitely sharp
    std::vector<float> vertex_creases;       ///< [V] or empty
};

enum class GeometryKind {
    Mesh,    ///< polygons, or the cage of a subdivision surface
    Curves,  ///< hair: Catmull-Rom curves through their points, with a radius
    Points,  ///< a cloud of spheres
};

/// A mesh, a set of curves or a cloud of points.  Faces, corners and what belongs to them are a
/// mesh's alone.
struct GeometryData {
    std::string name;  ///< Blender's, for messages: "mesh 'Cube'"
    GeometryKind kind = GeometryKind::Mesh;
    int knots = 1;
    std::vector<Vec3f> points;    ///< [knots][V] object space, metres
    std::vector<Vec3f> adjacent;  ///< [2][V] of the frame before and the one after, or empty
    /// [V] Blender's Generated coordinates of a mesh, or of hairs, each at its root.  Empty: the
    /// box of the points stands in.
    std::vector<Vec3f> generated;
    std::size_t vertex_count() const { return points.size() / static_cast<std::size_t>(knots); }
    std::vector<std::int32_t> face_sizes;    ///< [F] corners a face, >= 3
    std::vector<std::int32_t> corner_verts;  ///< [C]
    /// [T][3] Blender's triangles of the faces of more than four corners, n - 2 a face, face by
    /// face: corner numbers within the face.  Empty: triangulated here.
    std::vector<std::int32_t> ngon_triangles;
    /// Quads are cut as by Blender before 4.1 (triangulate_quad()).
    bool quads_by_normal = false;
    std::vector<std::int32_t> curve_sizes;     ///< [C] points a curve; they follow each other
    std::vector<float> radius;                 ///< [1 or knots][V] metres, of curves and points
    std::vector<std::int32_t> material_index;  ///< [elements] slot of the instance; empty = all 0
    std::vector<std::uint8_t> smooth;          ///< [F]; empty = all flat
    std::vector<Vec3f>
        corner_normals;  ///< [C] at the frame time, unit, object space; empty = from smooth
    std::vector<Attribute> attributes;
    bool is_subdivision = false;
    Subdivision subdivision;

    std::size_t face_count() const { return face_sizes.size(); }
    /// Faces, curves or points: what Domain::Face counts.
    std::size_t element_count() const {
        return kind == GeometryKind::Mesh     ? face_sizes.size()
               : kind == GeometryKind::Curves ? curve_sizes.size()
                                              : vertex_count();
    }
    std::int32_t slot(std::size_t element) const {
        return material_index.empty() ? 0 : material_index[element];
    }
    const Attribute* find_attribute(const std::string& attribute_name) const;
    /// The UV map that is active for render (first of kind Uv); nullptr when there is none.
    const Attribute* default_uv() const;
    const Attribute* default_color() const;
};

/// Whether two are equal in every byte: one may stand for the other.
bool is_same(const GeometryData& a, const GeometryData& b);

}  // namespace granita
