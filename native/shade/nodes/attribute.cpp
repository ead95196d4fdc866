// SPDX-License-Identifier: GPL-3.0-or-later
// Attribute and Color Attribute: primitive variables by name.
#include <algorithm>

#include "shade/nodes/instance_value.h"
#include "shade/nodes/nodes.h"

namespace granita {

namespace {

/// Components of the attribute in the first geometry that has it; 0 = none has.
int stored_width(const Scene& scene, const std::string& name) {
    for (const GeometryData& geometry : scene.geometries) {
        if (const Attribute* attribute = geometry.find_attribute(name)) return attribute->width;
    }
    return 0;
}

int default_color_width(const Scene& scene) {
    for (const GeometryData& geometry : scene.geometries) {
        if (const Attribute* attribute = geometry.default_color()) return attribute->width;
    }
    return 0;
}

void output_value(NodeBuilder& b, const VectorSource& value, const FloatSource& alpha) {
    b.output_color("Color", value);
    b.output_vector("Vector", value);
    // Cycles: the number is the mean of the components.
    b.output("Fac", b.map<float>([](const Vec3f& v) { return (v.x + v.y + v.z) / 3.0f; }, value));
    b.output("Alpha", alpha);
}

void output_attribute(NodeBuilder& b, const AttributeRequest& request) {
    const VectorSource value = b.attribute(request);
    output_value(b, value,
                 request.width == 4 ? b.attribute_component(request, 3) : FloatSource{-1, 1.0f});
}

}  // namespace

void build_attribute(NodeBuilder& b) {
    const std::string type = b.text("attribute_type", "GEOMETRY");
    const std::string name = b.text("attribute_name");
    if (type == "OBJECT" || type == "INSTANCER") {
        const InstanceValue value = instance_value(b, type + ":" + name);
        output_value(b, value.color, value.alpha);
        return;
    }
    if (type == "VIEW_LAYER") {
        const std::vector<float> v = b.table("layer_value");
        const bool has = v.size() == 4;
        output_value(b, {-1, has ? Vec3f(v[0], v[1], v[2]) : Vec3f(0.0f)}, {-1, has ? v[3] : 0.0f});
        return;
    }
    const int width = stored_width(b.scene(), name);
    if (width == 0) {
        // Cycles: what is not there is black and opaque.
        output_value(b, {-1, Vec3f(0.0f)}, {-1, 1.0f});
        return;
    }
    output_attribute(b, {AttributeSource::Named, name, width, false});
}

void build_color_attribute(NodeBuilder& b) {
    const std::string name = b.text("layer_name");
    const int width = name.empty() ? default_color_width(b.scene()) : stored_width(b.scene(), name);
    if (width == 0) {
        b.output_color("Color", {-1, Vec3f(0.0f)});
        b.output("Alpha", FloatSource{-1, 0.0f});
        return;
    }
    const AttributeSource source =
        name.empty() ? AttributeSource::DefaultColor : AttributeSource::Named;
    output_attribute(b, {source, name, width, false});
}

}  // namespace granita
