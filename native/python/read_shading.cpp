// SPDX-License-Identifier: GPL-3.0-or-later
// Node graphs, images and lights of the snapshot.
#include <algorithm>

#include "python/snapshot.h"

namespace granita::python {
namespace {

/// ("LINK", node, output) or (node, output)
NodeLink read_link(const Record& r, const py::handle& value, std::size_t node, std::size_t limit) {
    const auto sequence = py::cast<py::sequence>(value);
    const std::size_t size = sequence.size();
    if (size < 2) r.fail("a link of node " + std::to_string(node) + " names no node and output");
    const std::size_t first = size - 2;
    NodeLink link{py::cast<int>(sequence[first]), py::cast<std::string>(sequence[first + 1])};
    if (link.node < 0 || static_cast<std::size_t>(link.node) >= limit)
        r.fail("node " + std::to_string(node) + " is linked to node " + std::to_string(link.node) +
               ", which does not come before it");
    return link;
}

NodeInput read_input(const Record& r, const py::handle& value, std::size_t node) {
    if (py::isinstance<py::sequence>(value) && !py::isinstance<py::str>(value)) {
        const auto sequence = py::reinterpret_borrow<py::sequence>(value);
        if (sequence.size() == 3 && py::isinstance<py::str>(sequence[0]))
            return read_link(r, value, node, node);
        Vec4f v(0.0f, 0.0f, 0.0f, 1.0f);
        if (sequence.empty() || sequence.size() > 4)
            r.fail("a socket of node " + std::to_string(node) + " must have 1 to 4 values");
        for (std::size_t i = 0; i < sequence.size(); ++i)
            v[static_cast<int>(i)] = py::cast<float>(sequence[i]);
        return v;
    }
    const float x = py::cast<float>(value);
    return Vec4f(x, x, x, 1.0f);
}

NodeProperty read_property(const py::handle& value) {
    if (py::isinstance<py::str>(value)) return py::cast<std::string>(value);
    if (py::isinstance<py::array>(value) || (py::isinstance<py::sequence>(value))) {
        const auto a = py::array_t<float, py::array::c_style | py::array::forcecast>::ensure(value);
        if (!a) throw py::cast_error();
        return std::vector<float>(a.data(), a.data() + a.size());
    }
    return py::cast<double>(value);
}

}  // namespace

void read_graph(const Record& r, NodeGraph& graph) {
    for (const py::handle item : r.list("nodes")) {
        const Record node(py::cast<py::dict>(item), r.datablock());
        const std::size_t index = graph.nodes.size();
        Node out;
        out.type = node.text("type");
        out.name = node.text("name", out.type);
        read_checked(node.named(r.datablock() + ", node '" + out.name + "'"), [&](const Record& n) {
            if (n.has("inputs"))
                for (const auto& [key, value] : py::cast<py::dict>(n.get("inputs")))
                    out.inputs[py::cast<std::string>(key)] = read_input(r, value, index);
            if (n.has("properties"))
                for (const auto& [key, value] : py::cast<py::dict>(n.get("properties")))
                    out.properties[py::cast<std::string>(key)] = read_property(value);
        });
        graph.nodes.push_back(std::move(out));
    }
    const std::size_t count = graph.nodes.size();
    if (r.has("surface")) graph.surface = read_link(r, r.get("surface"), count, count);
    if (r.has("displacement"))
        graph.displacement = read_link(r, r.get("displacement"), count, count);
    if (r.has("volume")) graph.volume = read_link(r, r.get("volume"), count, count);
    graph.displacement_method = static_cast<DisplacementMethod>(
        choice(r, "displacement_method", r.text("displacement_method", "DISPLACEMENT"),
               {"BUMP", "DISPLACEMENT", "BOTH"}));
}

namespace {

/// A bit of the masks of instances, or -1.
int light_set(const Record& r, const char* name) {
    const double set = r.number(name, -1.0);
    if (!(set >= -1.0 && set < 64.0)) r.fail(std::string("'") + name + "' must be from -1 to 63");
    return static_cast<int>(set);
}

}  // namespace

int read_most_bounces(const Record& r) {
    const double most = r.number("most_bounces", Light::kAnyBounces);
    return static_cast<int>(std::clamp(most, 0.0, double{Light::kAnyBounces}));
}

void read_light(const Record& r, Light& light) {
    light.kind =
        static_cast<LightKind>(choice(r, "kind", r.text("kind"), {"POINT", "SUN", "SPOT", "AREA"}));
    light.world_from_light = matrices(r, "world_from_light");
    if (light.world_from_light.empty()) r.fail("'world_from_light' must hold at least one knot");
    const auto color = r.values<float>("color", {3});
    if (color.size() == 3) light.color = {color[0], color[1], color[2]};
    light.energy = static_cast<float>(r.number("energy"));
    light.energy_knots = r.values<float>("energy_knots", {-1});
    const auto life = r.values<float>("lifespan", {2});
    if (!life.empty()) light.lifespan = lifespan(r.datablock(), life[0], life[1]);
    light.radius = static_cast<float>(r.number("radius", 0.0));
    light.soft_falloff = r.boolean("soft_falloff", true);
    light.sun_angle = static_cast<float>(r.number("sun_angle", 0.0));
    light.sun_flat = r.boolean("sun_flat", false);
    light.spot_size = static_cast<float>(r.number("spot_size", 0.0));
    light.spot_blend = static_cast<float>(r.number("spot_blend", 0.0));
    light.spot_cosine = r.boolean("spot_cosine", false);
    light.shape = static_cast<AreaShape>(
        choice(r, "shape", r.text("shape", "SQUARE"), {"SQUARE", "RECTANGLE", "DISK", "ELLIPSE"}));
    if (r.has("size")) light.size = Vec2f(r.pair("size"));
    light.spread = static_cast<float>(r.number("spread", light.spread));
    light.casts_shadow = r.boolean("casts_shadow", true);
    light.lights_catchers = r.boolean("lights_catchers", true);
    light.visible_diffuse = r.boolean("visible_diffuse", true);
    light.visible_glossy = r.boolean("visible_glossy", true);
    light.visible_transmission = r.boolean("visible_transmission", true);
    light.visible_volume = r.boolean("visible_volume", true);
    light.diffuse_factor = static_cast<float>(r.number("diffuse_factor", 1.0));
    light.specular_factor = static_cast<float>(r.number("specular_factor", 1.0));
    light.most_bounces = read_most_bounces(r);
    light.receiver_set = light_set(r, "receiver_set");
    light.blocker_set = light_set(r, "blocker_set");
    if (r.has("nodes")) read_graph(r, light.graph);
}

}  // namespace granita::python
