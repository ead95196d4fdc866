// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/subdivision_topology.h"

#include <opensubdiv/far/error.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include <algorithm>

namespace granita {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

thread_local std::string far_message;

/// OpenSubdiv would print; the library never does.  The callbacks are the process's own, so they
/// are only ever set to these.
void silence_far() {
    static std::once_flag once;
    std::call_once(once, [] {
        Far::SetErrorCallback([](Far::ErrorType, const char* message) { far_message = message; });
        Far::SetWarningCallback([](const char* message) { far_message = message; });
    });
}

Sdc::Options::FVarLinearInterpolation uv_rule(SubdivisionUv uv) {
    switch (uv) {
        case SubdivisionUv::None:
            return Sdc::Options::FVAR_LINEAR_ALL;
        case SubdivisionUv::PreserveCorners:
            return Sdc::Options::FVAR_LINEAR_CORNERS_ONLY;
        case SubdivisionUv::PreserveCornersAndJunctions:
            return Sdc::Options::FVAR_LINEAR_CORNERS_PLUS1;
        case SubdivisionUv::PreserveCornersJunctionsAndConcave:
            return Sdc::Options::FVAR_LINEAR_CORNERS_PLUS2;
        case SubdivisionUv::PreserveBoundaries:
            return Sdc::Options::FVAR_LINEAR_BOUNDARIES;
        case SubdivisionUv::All:
            return Sdc::Options::FVAR_LINEAR_NONE;
    }
    return Sdc::Options::FVAR_LINEAR_BOUNDARIES;
}

Sdc::Options scheme_options(const Subdivision& subdivision) {
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(subdivision.boundary == SubdivisionBoundary::EdgeOnly
                                            ? Sdc::Options::VTX_BOUNDARY_EDGE_ONLY
                                            : Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
    options.SetFVarLinearInterpolation(uv_rule(subdivision.uv));
    return options;
}

/// Blender's STD_UV_CONNECT_LIMIT: UVs of one vertex that are nearer than this along u and v are
/// one.
constexpr float kUvConnectLimit = 1e-4f;

/// [C] -1 or 1: how a face turns in a UV map; what is mirrored is no neighbour of what is not.
std::vector<std::int8_t> uv_windings(const GeometryData& data, const std::vector<Vec2f>& uv) {
    std::vector<std::int8_t> windings;
    windings.reserve(uv.size());
    std::size_t first = 0;
    for (const std::int32_t size : data.face_sizes) {
        const auto n = static_cast<std::size_t>(size);
        float area = 0.0f;
        for (std::size_t i = 0; i < n; ++i) {
            const Vec2f &a = uv[first + i], &b = uv[first + (i + 1) % n];
            area += a.x * b.y - a.y * b.x;
        }
        windings.insert(windings.end(), n, area > 0.0f ? 1 : -1);
        first += n;
    }
    return windings;
}

/// [C] values of a UV map; each corner's among them.  Corners of one vertex whose UVs are within
/// the limit of the first of them share its value: that is where the map is continuous.
std::vector<int> weld_uvs(const GeometryData& data, const Attribute& attribute,
                          std::vector<float>& values) {
    const std::size_t width = static_cast<std::size_t>(attribute.width);
    std::vector<Vec2f> uv(data.corner_verts.size());
    for (std::size_t c = 0; c < uv.size(); ++c)
        uv[c] = {attribute.values[c * width], width > 1 ? attribute.values[c * width + 1] : 0.0f};
    const std::vector<std::int8_t> windings = uv_windings(data, uv);
    struct Link {
        std::size_t corner;  ///< that the others are compared with
        int value, older;
    };
    std::vector<int> head(data.vertex_count(), -1);
    std::vector<Link> links;
    std::vector<int> index(uv.size());
    // From the last to the first, as Blender goes: which is compared with which decides.
    for (std::size_t c = uv.size(); c-- > 0;) {
        int& newest = head[static_cast<std::size_t>(data.corner_verts[c])];
        int found = -1;  // the oldest that is near enough
        for (int link = newest; link >= 0; link = links[static_cast<std::size_t>(link)].older) {
            const std::size_t other = links[static_cast<std::size_t>(link)].corner;
            const Vec2f apart = glm::abs(uv[other] - uv[c]);
            if (apart.x < kUvConnectLimit && apart.y < kUvConnectLimit &&
                windings[other] == windings[c])
                found = link;
        }
        if (found < 0) {
            links.push_back({c, static_cast<int>(values.size() / 2), newest});
            found = newest = static_cast<int>(links.size()) - 1;
            values.insert(values.end(), {uv[c].x, uv[c].y});
        }
        index[c] = links[static_cast<std::size_t>(found)].value;
    }
    return index;
}

}  // namespace

std::unique_ptr<SubdivisionTopology> SubdivisionTopology::create(const GeometryData& data,
                                                                 std::string& why) {
    silence_far();
    far_message.clear();
    auto topology = std::unique_ptr<SubdivisionTopology>(new SubdivisionTopology);

    std::vector<std::vector<int>> indices;
    topology->m_uv_channels.assign(data.attributes.size(), -1);
    for (std::size_t a = 0; a < data.attributes.size(); ++a) {
        const Attribute& attribute = data.attributes[a];
        if (attribute.kind != AttributeKind::Uv || attribute.domain != Domain::Corner) continue;
        topology->m_uv_channels[a] = static_cast<int>(indices.size());
        topology->m_uv_values.emplace_back();
        indices.push_back(weld_uvs(data, attribute, topology->m_uv_values.back()));
    }
    std::vector<Far::TopologyDescriptor::FVarChannel> channels(indices.size());
    for (std::size_t c = 0; c < indices.size(); ++c) {
        channels[c].numValues = static_cast<int>(topology->m_uv_values[c].size() / 2);
        channels[c].valueIndices = indices[c].data();
    }
    std::vector<int> corners;
    std::vector<float> corner_weights;
    const Subdivision& subdivision = data.subdivision;
    for (std::size_t v = 0; v < subdivision.vertex_creases.size(); ++v)
        if (subdivision.vertex_creases[v] > 0.0f) {
            corners.push_back(static_cast<int>(v));
            corner_weights.push_back(subdivision.vertex_creases[v]);
        }

    Far::TopologyDescriptor descriptor;
    descriptor.numVertices = static_cast<int>(data.vertex_count());
    descriptor.numFaces = static_cast<int>(data.face_count());
    descriptor.numVertsPerFace = data.face_sizes.data();
    descriptor.vertIndicesPerFace = data.corner_verts.data();
    descriptor.numCreases = static_cast<int>(subdivision.crease_values.size());
    descriptor.creaseVertexIndexPairs = subdivision.crease_verts.data();
    descriptor.creaseWeights = subdivision.crease_values.data();
    descriptor.numCorners = static_cast<int>(corners.size());
    descriptor.cornerVertexIndices = corners.data();
    descriptor.cornerWeights = corner_weights.data();
    descriptor.numFVarChannels = static_cast<int>(channels.size());
    descriptor.fvarChannels = channels.data();

    using RefinerFactory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    const Sdc::SchemeType scheme = subdivision.scheme == SubdivisionScheme::Simple
                                       ? Sdc::SCHEME_BILINEAR
                                       : Sdc::SCHEME_CATMARK;
    topology->m_refiner.reset(RefinerFactory::Create(
        descriptor, RefinerFactory::Options(scheme, scheme_options(subdivision))));
    if (!topology->m_refiner) {
        why = far_message.empty() ? "its topology is invalid" : far_message;
        return nullptr;
    }
    topology->m_factory = std::make_unique<Factory>(*topology->m_refiner);
    return topology;
}

void SubdivisionTopology::find_owners(const std::vector<std::uint8_t>& usable) {
    const Far::TopologyLevel& level = m_refiner->GetLevel(0);
    const auto lowest = [&usable](const auto& faces, const auto& locals) {
        Owner owner;
        for (int i = 0; i < faces.size(); ++i)
            if (usable[static_cast<std::size_t>(faces[i])] &&
                (owner.face < 0 || faces[i] < owner.face))
                owner = {faces[i], locals[i]};
        return owner;
    };
    m_edges.resize(static_cast<std::size_t>(level.GetNumEdges()));
    for (std::size_t e = 0; e < m_edges.size(); ++e) {
        const int index = static_cast<int>(e);
        const auto vertices = level.GetEdgeVertices(index);
        const auto faces = level.GetEdgeFaces(index);
        m_edges[e].lo = std::min(vertices[0], vertices[1]);
        m_edges[e].hi = std::max(vertices[0], vertices[1]);
        m_edges[e].owner = lowest(faces, level.GetEdgeFaceLocalIndices(index));
        for (int i = 0; i < faces.size(); ++i)
            if (level.GetFaceVertices(faces[i]).size() != 4) m_edges[e].halved = true;
    }
    m_vertex_owners.resize(static_cast<std::size_t>(level.GetNumVertices()));
    for (std::size_t v = 0; v < m_vertex_owners.size(); ++v) {
        const int index = static_cast<int>(v);
        m_vertex_owners[v] =
            lowest(level.GetVertexFaces(index), level.GetVertexFaceLocalIndices(index));
    }
    m_bytes = sizeof(*this) + sizeof(Edge) * m_edges.size() +
              sizeof(Owner) * m_vertex_owners.size() +
              // The refiner does not tell: about fourteen integers a corner (measured 3.5.0).
              56 * static_cast<std::uint64_t>(level.GetNumFaceVertices());
    for (const auto& values : m_uv_values) m_bytes += 4 * values.size();
}

std::size_t SubdivisionTopology::face_edge(std::size_t face, int local) const {
    const auto edges = m_refiner->GetLevel(0).GetFaceEdges(static_cast<int>(face));
    return static_cast<std::size_t>(edges[local]);
}

}  // namespace granita
