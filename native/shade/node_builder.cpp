// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/node_builder.h"

#include <algorithm>

namespace granita {

namespace {

int shift_index(Shift shift) {
    return static_cast<int>(shift);
}

}  // namespace

bool NodeBuilder::linked(const std::string& input) const {
    const auto found = m_node.inputs.find(input);
    return found != m_node.inputs.end() && std::holds_alternative<NodeLink>(found->second);
}

const NodeOutput* NodeBuilder::link_source(const std::string& input, Shift shift) const {
    const auto found = m_node.inputs.find(input);
    if (found == m_node.inputs.end()) return nullptr;
    const auto* link = std::get_if<NodeLink>(&found->second);
    if (!link) return nullptr;
    const NodeOutputs& outputs = m_program.outputs[link->node][shift_index(shift)];
    const auto output = outputs.find(link->output);
    return output == outputs.end() ? nullptr : &output->second;
}

FloatSource NodeBuilder::number(const std::string& input, float fallback) const {
    return number_at(input, m_shift, fallback);
}

FloatSource NodeBuilder::number_at(const std::string& input, Shift shift, float fallback) const {
    if (const NodeOutput* from = link_source(input, shift)) {
        if (from->kind == SocketKind::Number) return from->number;
        // Cycles: a colour becomes its luminance, a vector the mean of its components.
        NodeBuilder self(*this);
        if (from->kind == SocketKind::Color) return self.map<float>(luminance, from->vector);
        return self.map<float>([](const Vec3f& v) { return (v.x + v.y + v.z) / 3.0f; },
                               from->vector);
    }
    const auto found = m_node.inputs.find(input);
    if (found == m_node.inputs.end()) return {-1, fallback};
    const auto* constant = std::get_if<Vec4f>(&found->second);
    return {-1, constant ? constant->x : 0.0f};
}

VectorSource NodeBuilder::vector(const std::string& input, const Vec3f& fallback) const {
    return vector_at(input, m_shift, fallback);
}

VectorSource NodeBuilder::vector_at(const std::string& input, Shift shift,
                                    const Vec3f& fallback) const {
    if (const NodeOutput* from = link_source(input, shift)) {
        if (from->kind != SocketKind::Number) return from->vector;
        NodeBuilder self(*this);
        return self.map<Vec3f>([](float x) { return Vec3f(x); }, from->number);
    }
    const auto found = m_node.inputs.find(input);
    if (found == m_node.inputs.end()) return {-1, fallback};
    const auto* constant = std::get_if<Vec4f>(&found->second);
    return {-1, constant ? Vec3f(*constant) : Vec3f(0.0f)};
}

std::string NodeBuilder::text(const std::string& property, const std::string& fallback) const {
    const auto found = m_node.properties.find(property);
    if (found == m_node.properties.end()) return fallback;
    const auto* value = std::get_if<std::string>(&found->second);
    return value ? *value : fallback;
}

double NodeBuilder::value(const std::string& property, double fallback) const {
    const auto found = m_node.properties.find(property);
    if (found == m_node.properties.end()) return fallback;
    const auto* value = std::get_if<double>(&found->second);
    return value ? *value : fallback;
}

std::vector<float> NodeBuilder::table(const std::string& property) const {
    const auto found = m_node.properties.find(property);
    if (found == m_node.properties.end()) return {};
    const auto* value = std::get_if<std::vector<float>>(&found->second);
    return value ? *value : std::vector<float>();
}

void NodeBuilder::output(const std::string& name, const FloatSource& source) {
    m_program.outputs[m_index][shift_index(m_shift)][name] = {SocketKind::Number, source, {}};
}

void NodeBuilder::output_color(const std::string& name, const VectorSource& source) {
    m_program.outputs[m_index][shift_index(m_shift)][name] = {SocketKind::Color, {}, source};
}

void NodeBuilder::output_vector(const std::string& name, const VectorSource& source) {
    m_program.outputs[m_index][shift_index(m_shift)][name] = {SocketKind::Vector, {}, source};
}

void NodeBuilder::warn(const std::string& message) {
    // Nodes are built once a shift; the message is for the first.
    if (m_shift == Shift::None)
        m_program.report.warn(m_program.owner, "node '" + m_node.name + "': " + message);
}

VectorSource NodeBuilder::attribute_at(const AttributeRequest& request, Shift shift) {
    if (m_program.is_world) return {-1, Vec3f(0.0f)};
    auto& requests = m_program.requests;
    auto found = std::find(requests.begin(), requests.end(), request);
    if (found == requests.end()) found = requests.insert(requests.end(), request);
    const VectorSource out = new_source<Vec3f>();
    m_program.loads.push_back({static_cast<int>(found - requests.begin()), shift, out.slot, 3, 0});
    return out;
}

FloatSource NodeBuilder::attribute_component(const AttributeRequest& request, int component) {
    if (m_program.is_world) return {-1, 0.0f};
    attribute_at(request, m_shift);  // enters the request; an unread load costs nothing
    const auto& requests = m_program.requests;
    const auto found = std::find(requests.begin(), requests.end(), request);
    const FloatSource out = new_source<float>();
    m_program.loads.push_back(
        {static_cast<int>(found - requests.begin()), m_shift, out.slot, 1, component});
    return out;
}

VectorSource NodeBuilder::shading_normal() {
    if (m_program.is_world) return {-1, Vec3f(0.0f, 0.0f, 1.0f)};
    return geometry<Vec3f>(
        [](const ShadingInput& in, std::size_t i) { return in.points->normal[i]; });
}

VectorSource NodeBuilder::normal_input(const std::string& input) {
    return linked(input) ? vector(input) : shading_normal();
}

VectorSource NodeBuilder::view() {
    if (m_program.is_world) return {-1, Vec3f(0.0f, 0.0f, 1.0f)};
    return geometry<Vec3f>(
        [](const ShadingInput& in, std::size_t i) { return in.points->view[i]; });
}

}  // namespace granita
