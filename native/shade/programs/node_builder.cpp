// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/programs/node_builder.h"

#include <algorithm>

#include "shade/bsdf/valid_reflection.h"

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
        // And of a vector the mean of its components.
        NodeBuilder self(*this);
        if (from->kind == SocketKind::Color) return self.number_of(from->vector);
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

int NodeBuilder::load(Load wanted, const AttributeRequest& request) {
    auto& requests = m_program.requests;
    auto found = std::find(requests.begin(), requests.end(), request);
    if (found == requests.end()) found = requests.insert(requests.end(), request);
    wanted.request = static_cast<int>(found - requests.begin());
    for (const Load& load : m_program.loads) {
        wanted.slot = load.slot;
        if (load == wanted) return load.slot;
    }
    wanted.slot = m_program.new_slot(wanted.width);
    m_program.loads.push_back(wanted);
    return wanted.slot;
}

VectorSource NodeBuilder::attribute_at(const AttributeRequest& request, Shift shift) {
    if (m_program.is_world) return {-1, Vec3f(0.0f)};
    return {load({.shift = shift, .bump_width = bump_width_at(shift)}, request), Vec3f(0.0f)};
}

VectorSource NodeBuilder::attribute_beside(const AttributeRequest& request, Shift shift) {
    if (m_program.is_world) return {-1, Vec3f(0.0f)};
    return {load({.shift = shift}, request), Vec3f(0.0f)};
}

FloatSource NodeBuilder::attribute_component(const AttributeRequest& request, int component,
                                             Shift shift) {
    if (m_program.is_world) return {-1, 0.0f};
    const Load wanted{
        .shift = shift, .width = 1, .first = component, .bump_width = bump_width_at(shift)};
    return {load(wanted, request), 0.0f};
}

VectorSource NodeBuilder::shading_normal() {
    if (!has_surface()) return {-1, Vec3f(0.0f, 0.0f, 1.0f)};
    if (m_program.is_bumped) return m_program.bumped;
    return geometry<Vec3f>(
        [](const ShadingInput& in, std::size_t i) { return in.points->normal[i]; });
}

VectorSource NodeBuilder::normal_input(const std::string& input) {
    if (!linked(input)) return shading_normal();
    m_program.bends_normals = true;
    return vector(input);
}

VectorSource NodeBuilder::diffuse_normal(const std::string& input) {
    const VectorSource normal = normal_input(input);
    if (m_program.is_world || since(4, 0)) return normal;
    return with_valid_reflection(normal);
}

VectorSource NodeBuilder::specular_normal(const std::string& input) {
    if (m_program.is_world || !since(4, 0)) return diffuse_normal(input);
    return with_valid_reflection(normal_input(input));
}

VectorSource NodeBuilder::with_valid_reflection(const VectorSource& normal) {
    const VectorSource out = new_source<Vec3f>();
    const Scene& frame = scene();
    add_step(
        [=, &frame](Run& run) {
            const auto normals = run.read(normal);
            const ShadingPoints& points = *run.input().points;
            const bool is_curve =
                frame.geometry_of(*run.input().instance).kind == GeometryKind::Curves;
            Vec3f* result = run.write(out);
            for (std::size_t i = 0; i < run.count(); ++i) {
                result[i] = is_curve ? normals[i]
                                     : valid_reflection(points.geometric_normal[i], points.view[i],
                                                        normals[i]);
            }
        },
        {normal.slot}, {out.slot});
    return out;
}

FloatSource NodeBuilder::backfacing() {
    if (is_world()) return {-1, 0.0f};
    return geometry<float>([](const ShadingInput& in, std::size_t i) {
        return in.points->backfacing[i] ? 1.0f : 0.0f;
    });
}

VectorSource NodeBuilder::view() {
    if (!has_surface()) return {-1, Vec3f(0.0f, 0.0f, 1.0f)};
    return geometry<Vec3f>(
        [](const ShadingInput& in, std::size_t i) { return in.points->view[i]; });
}

}  // namespace granita
