// SPDX-License-Identifier: GPL-3.0-or-later
#include "dice/face_batch.h"

#include <algorithm>
#include <cmath>

#include "dice/face_triangles.h"
#include "dice/grid_attributes.h"
#include "dice/motion_bounds.h"
#include "dice/raster_bound.h"
#include "dice/visible_area.h"
#include "geometry/corner_values.h"
#include "geometry/limit_vertices.h"
#include "math/normalize_or.h"

namespace granita {
namespace {

/// Cosine of the largest angle between the normals of a cluster.
constexpr float kLeastCosine = 0.99f;
/// Of the shading rate: the longest side of a cluster's box.
constexpr float kLongest = 1.5f;

/// What a face's point has of its corners: a quad's are worth the same, be it cut as it may.
PatchKind mean_kind(PatchKind kind) {
    return kind == PatchKind::Triangle ? kind : PatchKind::Quad;
}

}  // namespace

/// At the frame time, in camera space.
struct FaceBatch::Face {
    std::size_t micropolygon = 0;
    BasePatch patch;
    int vertices[4] = {};  ///< of the grid; a triangle repeats its last
    Vec3f middle{0.0f}, normal{0.0f}, geometric_normal{0.0f}, su{0.0f}, sv{0.0f};
    Vec2f place{0.0f};  ///< of the middle, pixels
    float area = 0.0f;  ///< as seen, square pixels
    /// In a cluster: something is left for a face that is seen edge-on.
    float weight(float cluster_area) const { return area + 1e-6f * cluster_area; }
};

struct FaceBatch::Cluster {
    std::size_t first = 0, end = 0;  ///< faces
    std::size_t center = 0;          ///< the face in the middle: textures are looked up there
    float area = 0.0f;
    /// How much further its neighbours' points are than the next face's.
    float stretch(const std::vector<Face>& faces) const {
        return faces[center].area > 0.0f ? std::sqrt(area / faces[center].area) : 1.0f;
    }
};

FaceBatch::FaceBatch(std::shared_ptr<const OpenedMesh> mesh, std::span<const std::uint32_t> faces,
                     std::span<const Bounds3f> boxes)
    : m_mesh(std::move(mesh)), m_faces(faces), m_boxes(boxes) {}

RasterBounds FaceBatch::bounds() const {
    return raster_bound_of(m_mesh->view().projection, m_boxes);
}

std::vector<Bounds3f> FaceBatch::knot_boxes() const {
    if (m_boxes.size() == 1) return {};
    return {m_boxes.begin(), m_boxes.end()};
}

/// Bit 63 is never set in the path of a patch, and a patch is in one batch at most.
GridKey FaceBatch::key() const {
    return {m_mesh->instance().key, patch(0).face, std::uint64_t{1} << 63 | patch(0).sub};
}

std::unique_ptr<Grid> FaceBatch::make_grid(std::size_t micropolygons) const {
    auto grid = std::make_unique<Grid>();
    grid->key = key();
    grid->instance = static_cast<std::uint32_t>(m_mesh->instance_index());
    grid->material = m_mesh->material(patch(0).face);
    grid->holdout = m_mesh->holds_out(grid->material);
    grid->lifespan = m_mesh->instance().lifespan;
    grid->disjoint = true;
    grid->n_u = static_cast<int>(micropolygons);
    grid->n_v = 1;
    grid->knots = m_mesh->knot_count();
    grid->positions.resize(4 * micropolygons * static_cast<std::size_t>(grid->knots));
    return grid;
}

std::unique_ptr<Grid> FaceBatch::dice() const {
    const std::size_t count = m_faces.size();
    auto grid = make_grid(count);
    constexpr std::size_t kPlane[4] = {0, 1, 3, 2};
    for (int k = 0; k < grid->knots; ++k) {
        Vec3f* const to = &grid->positions[4 * count * static_cast<std::size_t>(k)];
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t c = 0; c < 4; ++c)
                to[kPlane[c] * count + i] = m_mesh->small_point(k, patch(i).corner[c]);
    }
    motion_bounds(*grid, m_mesh->view().projection);
    grid->shading_state = [batch = *this](Grid& of) { batch.fill_shading_state(of); };
    grid->triangles = [batch = *this](const Grid& of, std::span<const GridPlace> wanted) {
        return batch.triangles(of, wanted);
    };
    return grid;
}

Grid FaceBatch::triangles(const Grid& grid, std::span<const GridPlace> wanted) const {
    std::vector<FaceTriangle> of_faces;
    of_faces.reserve(wanted.size());
    for (const GridPlace& place : wanted) {
        const BasePatch& whole = patch(place.triangle.micropolygon);
        const bool is_pair = whole.kind == PatchKind::TrianglePair;
        of_faces.push_back({place.triangle, is_pair ? whole.half(place.triangle.second) : whole});
    }
    return face_triangles(*m_mesh, grid, of_faces);
}

void FaceBatch::fill_shading_state(Grid& grid) const {
    set_frame_positions(grid, m_mesh->knots());
    std::vector<Face> faces;
    faces.reserve(face_count());
    for (std::size_t i = 0; i < face_count(); ++i) {
        if (patch(i).bent) {
            faces.push_back(face(grid, i, patch(i).half(0)));
            faces.push_back(face(grid, i, patch(i).half(1)));
        } else {
            faces.push_back(face(grid, i, patch(i)));
        }
    }
    const std::vector<Cluster> points = clusters(grid, faces);
    const std::vector<Vec3f> vertices = grid.shading_p();
    grid.p.clear();
    for (const Cluster& cluster : points) add_point(grid, faces, cluster, vertices);
    double area = 0.0;
    for (const Cluster& cluster : points) area += cluster.area;
    set_point_share(grid, area, m_mesh->rate().rate());
    fill_attributes(grid, faces, points);
}

void FaceBatch::add_point(Grid& grid, const std::vector<Face>& faces, const Cluster& cluster,
                          const std::vector<Vec3f>& vertices) const {
    const Face& center = faces[cluster.center];
    Vec3f normal(0.0f), geometric_normal(0.0f), p(0.0f);
    float total = 0.0f;
    for (std::size_t i = cluster.first; i < cluster.end; ++i) {
        const float weight = faces[i].weight(cluster.area);
        normal += faces[i].normal * weight;
        geometric_normal += faces[i].geometric_normal * weight;
        p += faces[i].middle * weight;
        total += weight;
    }
    // The mean, or light would be taken from where the larger faces are: those that face the eye.
    p = total > 0.0f ? p / total : center.middle;
    const Vec3f outward(normalize_or(Vec3d(geometric_normal), Vec3d(center.geometric_normal)));
    grid.shading_positions.anchors.push_back(static_cast<std::uint32_t>(center.micropolygon));
    grid.p.push_back(p);
    grid.normal.push_back(Vec3f(normalize_or(Vec3d(normal), Vec3d(center.normal))));
    grid.geometric_normal.push_back(outward);
    grid.dp_du.push_back(center.su * cluster.stretch(faces));
    grid.dp_dv.push_back(center.sv * cluster.stretch(faces));
    // Rays start above all of the cluster, on the side that is seen.
    const Vec3f up = m_mesh->seen_side(p, outward);
    float height = 0.0f;
    for (std::size_t i = cluster.first; i < cluster.end; ++i)
        for (const int v : faces[i].vertices)
            height = std::max(height, glm::dot(vertices[static_cast<std::size_t>(v)] - p, up));
    if (m_mesh->shared().subdivision()) height += bulge(faces, cluster);
    grid.ray_offset.push_back(up * height);
    // Faces below a pixel show no faces where light ends.
    if (m_mesh->rises()) grid.rise.emplace_back(0.0f);
}

/// How far the limit surface may stand above the corners of a cluster's faces, camera space.
float FaceBatch::bulge(const std::vector<Face>& faces, const Cluster& cluster) const {
    const std::vector<float>& heights = m_mesh->shared().limit()->heights;
    float most = 0.0f;
    for (std::size_t i = cluster.first; i < cluster.end; ++i)
        most = std::max(most, heights[faces[i].patch.face]);
    return most * m_mesh->frame_scale();
}

FaceBatch::Face FaceBatch::face(const Grid& grid, std::size_t i, const BasePatch& part) const {
    const Grid::Corners c = grid.corners(static_cast<int>(i));
    // Of the vertices yet.
    const std::vector<Vec3f>& p = grid.shading_p();
    const bool triangle = part.kind == PatchKind::Triangle;
    const CornerWeights weights(mean_kind(part.kind), middle_of(part.kind));
    Face face;
    face.micropolygon = i;
    face.patch = part;
    // The second half of a quad leaves its second corner out, the first half its last.
    const bool second = patch(i).bent && part.sub == 1;
    face.vertices[0] = c.v0;
    face.vertices[1] = second ? c.v2 : c.v1;
    face.vertices[2] = second ? c.v3 : c.v2;
    face.vertices[3] = triangle ? face.vertices[2] : c.v3;
    Vec3f corner[4];
    for (int k = 0; k < 4; ++k) corner[k] = p[static_cast<std::size_t>(face.vertices[k])];
    // On both triangles of a quad, so that no ray's own surface lies above it.
    face.middle =
        triangle ? (corner[0] + corner[1] + corner[2]) / 3.0f : 0.5f * (corner[0] + corner[2]);
    const TangentFrame at = m_mesh->small_face(part).frame(weights);
    face.su = Vec3f(at.su);
    face.sv = Vec3f(at.sv);
    face.geometric_normal = Vec3f(at.geometric_normal);
    face.normal = Vec3f(at.normal);
    const Projection& projection = m_mesh->view().projection;
    const auto place = [&](const Vec3f& at) {
        return Vec2f(projection.scale) * Vec2f(at) / (projection.perspective ? at.z : 1.0f);
    };
    face.place = place(face.middle);
    const Vec2f a = place(corner[2]) - place(corner[0]), b = place(corner[3]) - place(corner[1]);
    face.area = 0.5f * std::abs(a.x * b.y - a.y * b.x);
    return face;
}

/// Neighbours follow each other in the batch.  Of faces that were opened because samples meet them
/// each has a point of its own: between them lie others, above what their mean would be, and which
/// they are must not tell where points lie.
std::vector<FaceBatch::Cluster> FaceBatch::clusters(Grid& grid,
                                                    const std::vector<Face>& faces) const {
    const auto rate = static_cast<float>(m_mesh->rate().shading_rate());
    const bool gather = m_mesh->part().is_whole();
    std::vector<Cluster> clusters;
    std::vector<std::uint32_t> point_of;  // [faces]
    Vec2f lo(0.0f), hi(0.0f);             // of the last cluster
    for (std::size_t i = 0; i < faces.size(); ++i) {
        const Face& face = faces[i];
        if (gather && !clusters.empty()) {
            Cluster& last = clusters.back();
            const Vec2f low = glm::min(lo, face.place), high = glm::max(hi, face.place);
            const Vec2f size = high - low;
            const Face& first = faces[last.first];
            if (last.area + face.area <= rate * rate &&
                std::max(size.x, size.y) <= kLongest * rate &&
                glm::dot(face.normal, first.normal) >= kLeastCosine &&
                glm::dot(face.geometric_normal, first.geometric_normal) >= kLeastCosine) {
                lo = low;
                hi = high;
                last.area += face.area;
                last.end = i + 1;
                point_of.push_back(static_cast<std::uint32_t>(clusters.size() - 1));
                continue;
            }
        }
        point_of.push_back(static_cast<std::uint32_t>(clusters.size()));
        clusters.push_back({i, i + 1, i, face.area});
        lo = hi = face.place;
    }
    for (Cluster& cluster : clusters) find_center(cluster, faces);
    // A bent quad is of two colours: its second half follows the first.  Corners 0, 1, 3 and 2.
    std::vector<std::uint32_t>& of_vertex = grid.shading_positions.point_of;
    const std::size_t count = face_count();
    of_vertex.resize(4 * count);
    for (std::size_t i = faces.size(); i-- > 0;)
        of_vertex[faces[i].micropolygon] = of_vertex[count + faces[i].micropolygon] = point_of[i];
    for (std::size_t i = 0; i < faces.size(); ++i)
        of_vertex[2 * count + faces[i].micropolygon] =
            of_vertex[3 * count + faces[i].micropolygon] = point_of[i];
    return clusters;
}

void FaceBatch::find_center(Cluster& cluster, const std::vector<Face>& faces) {
    Vec2f mean(0.0f);
    float total = 0.0f;
    for (std::size_t i = cluster.first; i < cluster.end; ++i) {
        mean += faces[i].place * faces[i].weight(cluster.area);
        total += faces[i].weight(cluster.area);
    }
    if (!(total > 0.0f)) return;
    mean /= total;
    const auto distance = [&](std::size_t i) { return glm::distance(faces[i].place, mean); };
    for (std::size_t i = cluster.first; i < cluster.end; ++i)
        if (distance(i) < distance(cluster.center)) cluster.center = i;
}

void FaceBatch::fill_attributes(Grid& grid, const std::vector<Face>& faces,
                                const std::vector<Cluster>& clusters) const {
    const auto fill = [&](const AttributeRequest& request, GridAttribute& out) {
        const auto width = static_cast<std::size_t>(out.width);
        const auto values_at = [&](std::size_t i, std::vector<float>& values,
                                   std::vector<float>& du, std::vector<float>& dv) {
            const BasePatch& part = faces[i].patch;
            const Vec2d uv = middle_of(part.kind);
            if (m_mesh->shared().subdivision())
                m_mesh->attribute(part, request, {&uv, 1}, values, du, dv);
            else
                interpolate(corner_values(m_mesh->shared(), part, request), mean_kind(part.kind),
                            {&uv, 1}, out.width, values, du, dv);
            m_mesh->displace(part, mean_kind(part.kind), request, {&uv, 1}, values, du, dv);
        };
        std::vector<float> values, du, dv, mean;
        for (const Cluster& cluster : clusters) {
            // A mean of faces that point this way and that would be the shape of none.
            if (request.derivatives || is_to_corner(request.source)) {
                values_at(cluster.center, values, du, dv);
                for (std::size_t c = 0; request.derivatives && c < width; ++c) {
                    out.du.push_back(du[c] * cluster.stretch(faces));
                    out.dv.push_back(dv[c] * cluster.stretch(faces));
                }
                out.values.insert(out.values.end(), values.begin(), values.end());
                continue;
            }
            mean.assign(width, 0.0f);
            float total = 0.0f;
            for (std::size_t i = cluster.first; i < cluster.end; ++i) {
                const float weight = faces[i].weight(cluster.area);
                values_at(i, values, du, dv);
                for (std::size_t c = 0; c < width; ++c) mean[c] += values[c] * weight;
                total += weight;
            }
            // A cluster that is seen edge-on has no area.
            if (!(total > 0.0f)) values_at(cluster.center, mean, du, dv), total = 1.0f;
            for (const float value : mean) out.values.push_back(value / total);
        }
    };
    make_attributes(grid, m_mesh->view().requests_of(grid.material), fill);
}

}  // namespace granita
