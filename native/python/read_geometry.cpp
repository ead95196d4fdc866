// SPDX-License-Identifier: GPL-3.0-or-later
// Geometries and instances of the snapshot.
#include <algorithm>
#include <cstring>
#include <numeric>
#include <utility>

#include "geometry/random_per_island.h"
#include "python/snapshot.h"

namespace granita::python {
namespace {

using FloatArray = py::array_t<float, py::array::c_style | py::array::forcecast>;

std::vector<Vec3f> vectors(const Record& r, const char* key, py::ssize_t count) {
    if (!r.has(key)) return {};
    const auto a = r.array<float>(key, {count, 3});
    std::vector<Vec3f> list(static_cast<std::size_t>(a.shape(0)));
    if (!list.empty()) std::memcpy(list.data(), a.data(), list.size() * sizeof(Vec3f));
    return list;
}

Attribute read_attribute(const Record& r, const GeometryData& g) {
    Attribute attribute;
    attribute.name = r.text("name");
    attribute.domain =
        static_cast<Domain>(choice(r, "domain", r.text("domain"), {"POINT", "FACE", "CORNER"}));
    attribute.kind = static_cast<AttributeKind>(
        choice(r, "kind", r.text("kind", "GENERIC"), {"GENERIC", "UV", "COLOR"}));
    const std::size_t elements = attribute.domain == Domain::Point  ? g.vertex_count()
                                 : attribute.domain == Domain::Face ? g.element_count()
                                                                    : g.corner_verts.size();
    const auto a = r.array<float>("values", {static_cast<py::ssize_t>(elements), -1});
    attribute.width = static_cast<int>(a.shape(1));
    if (attribute.width < 1 || attribute.width > 4)
        r.fail("attribute '" + attribute.name + "' has " + std::to_string(attribute.width) +
               " components, expected 1 to 4");
    attribute.encoded = r.boolean("encoded", false);
    attribute.values.assign(a.data(), a.data() + a.size());
    return attribute;
}

void read_subdivision(const Record& r, GeometryData& g) {
    Subdivision& s = g.subdivision;
    g.is_subdivision = true;
    s.scheme = static_cast<SubdivisionScheme>(
        choice(r, "scheme", r.text("scheme", "CATMULL_CLARK"), {"CATMULL_CLARK", "SIMPLE"}));
    s.boundary = choice(r, "boundary", r.text("boundary", "ALL"), {"PRESERVE_CORNERS", "ALL"}) == 0
                     ? SubdivisionBoundary::EdgeAndCorner
                     : SubdivisionBoundary::EdgeOnly;
    s.uv = static_cast<SubdivisionUv>(
        choice(r, "uv_smooth", r.text("uv_smooth", "PRESERVE_BOUNDARIES"),
               {"NONE", "PRESERVE_CORNERS", "PRESERVE_CORNERS_AND_JUNCTIONS",
                "PRESERVE_CORNERS_JUNCTIONS_AND_CONCAVE", "PRESERVE_BOUNDARIES", "SMOOTH_ALL"}));
    s.crease_verts = r.values<std::int32_t>("crease_verts", {-1, 2});
    s.crease_values =
        r.values<float>("crease_values", {static_cast<py::ssize_t>(s.crease_verts.size() / 2)});
    s.vertex_creases = r.values<float>("vertex_creases", {-1});
    const auto n = static_cast<std::int32_t>(g.vertex_count());
    if (!s.vertex_creases.empty() && s.vertex_creases.size() != g.vertex_count())
        r.fail("'vertex_creases' must have one value a vertex");
    for (const std::int32_t v : s.crease_verts)
        if (v < 0 || v >= n) r.fail("'crease_verts' names a vertex that does not exist");
}

void check_ngon_triangles(const Record& r, const GeometryData& g) {
    std::size_t i = 0;
    for (const std::int32_t size : g.face_sizes) {
        if (size <= 4) continue;
        const std::size_t end = i + 3 * static_cast<std::size_t>(size - 2);
        if (end > g.ngon_triangles.size()) r.fail("'ngon_triangles' are too few for 'face_sizes'");
        for (; i < end; ++i)
            if (g.ngon_triangles[i] < 0 || g.ngon_triangles[i] >= size)
                r.fail("'ngon_triangles' names corner " + std::to_string(g.ngon_triangles[i]) +
                       " of a face of " + std::to_string(size));
    }
    if (i != g.ngon_triangles.size()) r.fail("'ngon_triangles' are too many for 'face_sizes'");
}

void read_faces(const Record& r, GeometryData& g) {
    g.face_sizes = r.values<std::int32_t>("face_sizes", {-1});
    g.corner_verts = r.values<std::int32_t>("corner_verts", {-1});
    std::int64_t corners = 0;
    for (const std::int32_t size : g.face_sizes) {
        if (size < 3) r.fail("'face_sizes' holds a face of " + std::to_string(size) + " corners");
        corners += size;
    }
    if (corners != static_cast<std::int64_t>(g.corner_verts.size()))
        r.fail("'face_sizes' add up to " + std::to_string(corners) + ", 'corner_verts' has " +
               std::to_string(g.corner_verts.size()));
    const auto vertices = static_cast<std::int32_t>(g.vertex_count());
    for (const std::int32_t v : g.corner_verts)
        if (v < 0 || v >= vertices)
            r.fail("'corner_verts' names vertex " + std::to_string(v) + " of " +
                   std::to_string(vertices));
    g.smooth = r.values<std::uint8_t>("smooth", {static_cast<py::ssize_t>(g.face_count())});
    g.corner_normals =
        vectors(r, "corner_normals", static_cast<py::ssize_t>(g.corner_verts.size()));
    g.ngon_triangles = r.values<std::int32_t>("ngon_triangles", {-1, 3});
    if (!g.ngon_triangles.empty()) check_ngon_triangles(r, g);
    g.quads_by_normal = r.boolean("quads_by_normal", false);
    if (r.has("subdivision")) read_subdivision(r.record("subdivision"), g);
}

void read_curve_sizes(const Record& r, GeometryData& g) {
    g.curve_sizes = r.values<std::int32_t>("curve_sizes", {-1});
    std::int64_t points = 0;
    for (const std::int32_t size : g.curve_sizes) {
        if (size < 1) r.fail("'curve_sizes' holds a curve of " + std::to_string(size) + " points");
        points += size;
    }
    if (points != static_cast<std::int64_t>(g.vertex_count()))
        r.fail("'curve_sizes' add up to " + std::to_string(points) + ", 'points' has " +
               std::to_string(g.vertex_count()));
}

void read_radius(const Record& r, GeometryData& g) {
    const auto radius = r.array<float>("radius", {-1, static_cast<py::ssize_t>(g.vertex_count())});
    if (radius.shape(0) != 1 && radius.shape(0) != g.knots)
        r.fail("'radius' has " + std::to_string(radius.shape(0)) + " knots, 'points' has " +
               std::to_string(g.knots));
    g.radius.assign(radius.data(), radius.data() + radius.size());
}

}  // namespace

void read_geometry(const Record& r, GeometryData& g) {
    g.kind = static_cast<GeometryKind>(
        choice(r, "kind", r.text("kind", "MESH"), {"MESH", "CURVES", "POINTS"}));
    const auto points = r.array<float>("points", {-1, -1, 3});
    g.knots = static_cast<int>(points.shape(0));
    if (g.knots < 1) r.fail("'points' must hold at least one knot");
    g.points.resize(static_cast<std::size_t>(points.shape(0) * points.shape(1)));
    if (!g.points.empty())
        std::memcpy(g.points.data(), points.data(), g.points.size() * sizeof(Vec3f));

    if (r.has("adjacent")) {
        const auto others =
            r.array<float>("adjacent", {2, static_cast<py::ssize_t>(g.vertex_count()), 3});
        g.adjacent.resize(2 * g.vertex_count());
        if (!g.adjacent.empty())
            std::memcpy(g.adjacent.data(), others.data(), g.adjacent.size() * sizeof(Vec3f));
    }
    g.generated = vectors(r, "generated", static_cast<py::ssize_t>(g.vertex_count()));
    if (g.kind == GeometryKind::Mesh)
        read_faces(r, g);
    else
        read_radius(r, g);
    if (g.kind == GeometryKind::Curves) read_curve_sizes(r, g);

    g.material_index =
        r.values<std::int32_t>("material_index", {static_cast<py::ssize_t>(g.element_count())});
    for (const py::handle item : r.list("attributes")) {
        if (!py::isinstance<py::dict>(item)) r.fail("'attributes' must hold dicts");
        g.attributes.push_back(
            read_attribute(Record(py::reinterpret_borrow<py::dict>(item), r.datablock()), g));
    }
    if (r.has("edges") && g.kind == GeometryKind::Mesh) {
        const auto edges = r.values<std::int32_t>("edges", {-1, 2});
        for (const std::int32_t v : edges)
            if (v < 0 || static_cast<std::size_t>(v) >= g.vertex_count())
                r.fail("'edges' names a vertex that does not exist");
        g.attributes.push_back(random_per_island(g, edges));
    }
}

void read_instances(const Record& r, Scene& scene) {
    const py::list names = r.list("name");
    const auto n = static_cast<py::ssize_t>(names.size());
    const auto geometry = r.values<std::int32_t>("geometry", {n});
    const auto knots = r.values<std::int32_t>("knots", {n});
    const auto transforms = n > 0 ? matrices(r, "world_from_object") : std::vector<Mat4d>{};
    const auto adjacent =
        n > 0 && r.has("adjacent") ? matrices(r, "adjacent") : std::vector<Mat4d>{};
    if (!adjacent.empty() && adjacent.size() != 2 * static_cast<std::size_t>(n))
        r.fail("'adjacent' must hold two matrices an instance");
    const auto slots = r.values<std::int32_t>("slots", {n});
    const auto materials = r.values<std::int32_t>("materials", {-1});
    const auto flags = r.values<std::uint32_t>("flags", {n});
    const auto object_index = r.values<std::int32_t>("object_index", {n});
    const auto random = r.values<float>("random", {n});
    const auto key = r.values<std::uint32_t>("key", {n});
    const auto lifespans = r.values<float>("lifespan", {n, 2});
    const auto receives = r.values<std::uint64_t>("receives", {n});
    const auto blocks = r.values<std::uint64_t>("blocks", {n});
    const auto receiver_set = r.values<std::int32_t>("receiver_set", {n});
    const auto blocker_set = r.values<std::int32_t>("blocker_set", {n});
    for (const auto& [name, sets] :
         {std::pair("receiver_set", &receiver_set), std::pair("blocker_set", &blocker_set)})
        if (std::ranges::any_of(*sets, [](int set) { return set < -1 || set >= 64; }))
            r.fail("'" + std::string(name) + "' must be from -1 to 63");
    if (r.has("receives_in_volumes"))
        scene.receives_in_volumes = py::cast<std::uint64_t>(r.get("receives_in_volumes"));
    if (n > 0 && (geometry.empty() || knots.empty() || slots.empty()))
        r.fail("'geometry', 'knots' and 'slots' are needed for every instance");

    std::size_t knot = 0, slot = 0;
    scene.instances.resize(static_cast<std::size_t>(n));
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        Instance& instance = scene.instances[i];
        instance.name = py::cast<std::string>(names[i]);
        const std::string datablock = "object '" + instance.name + "'";
        const auto fail = [&](const std::string& message) { throw SceneError(datablock, message); };
        instance.geometry = geometry[i];
        if (instance.geometry < 0 ||
            static_cast<std::size_t>(instance.geometry) >= scene.geometries.size())
            fail("names a geometry that does not exist");
        if (knots[i] < 1 || knot + static_cast<std::size_t>(knots[i]) > transforms.size())
            fail("'knots' do not match 'world_from_object'");
        instance.world_from_object.assign(
            transforms.begin() + static_cast<std::ptrdiff_t>(knot),
            transforms.begin() + static_cast<std::ptrdiff_t>(knot) + knots[i]);
        knot += static_cast<std::size_t>(knots[i]);
        if (!adjacent.empty()) instance.adjacent = {adjacent[2 * i], adjacent[2 * i + 1]};
        if (slots[i] < 0 || slot + static_cast<std::size_t>(slots[i]) > materials.size())
            fail("'slots' do not match 'materials'");
        for (int s = 0; s < slots[i]; ++s) {
            const std::int32_t material = materials[slot++];
            if (material >= static_cast<std::int32_t>(scene.materials.size()) || material < -1)
                fail("names a material that does not exist");
            instance.materials.push_back(material);
        }
        const std::uint32_t f = flags.empty() ? 123u : flags[i];
        instance.visible_camera = f & 1u;
        instance.casts_shadow = f & 2u;
        instance.holdout = f & 4u;
        instance.visible_diffuse = f & 8u;
        instance.visible_glossy = f & 16u;
        instance.visible_transmission = f & 32u;
        instance.visible_volume = f & 64u;
        instance.shadow_catcher = f & 128u;
        instance.terminator_offset = static_cast<float>(f >> 16) / 65535.0f;
        instance.object_index = object_index.empty() ? 0 : object_index[i];
        instance.random = random.empty() ? 0.0f : random[i];
        instance.key = key.empty() ? static_cast<std::uint32_t>(i) : key[i];
        if (!receives.empty()) instance.receives = receives[i];
        if (!blocks.empty()) instance.blocks = blocks[i];
        if (!receiver_set.empty()) instance.receiver_set = receiver_set[i];
        if (!blocker_set.empty()) instance.blocker_set = blocker_set[i];
        if (!lifespans.empty())
            instance.lifespan = lifespan(datablock, lifespans[2 * i], lifespans[2 * i + 1]);
    }
    if (r.has("values"))
        for (const auto& [key, item] : py::cast<py::dict>(r.get("values"))) {
            const auto a = FloatArray::ensure(item);
            if (!a || a.ndim() != 2 || a.shape(0) != n || a.shape(1) != 4)
                r.fail("'values' must hold arrays of four numbers an instance");
            std::vector<Vec4f>& values = scene.instance_values[py::cast<std::string>(key)];
            values.resize(static_cast<std::size_t>(n));
            if (n > 0) std::memcpy(values.data(), a.data(), values.size() * sizeof(Vec4f));
        }
    if (knot != transforms.size())
        r.fail("'world_from_object' holds more matrices than 'knots' ask for");
}

}  // namespace granita::python
