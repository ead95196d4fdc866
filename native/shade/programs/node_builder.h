// SPDX-License-Identifier: GPL-3.0-or-later
// What the build function of a node sees: its inputs converted to the type it asks for (as Cycles
// converts between sockets), its properties, and map(), which turns a function of single values
// into a step over all points and folds it when its arguments are constant.
//
//   void build_gamma(NodeBuilder& b) {
//       b.output("Color", b.map<Vec3f>(gamma, b.color("Color"), b.number("Gamma")));
//   }
#pragma once

#include <array>
#include <set>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "base/report.h"
#include "scene/scene.h"
#include "shade/programs/node_output.h"
#include "shade/programs/program.h"
#include "shade/rays/ray_type.h"
#include "shade/textures/texture.h"

namespace granita {

/// The growing program and everything nodes may ask about the frame.
struct ProgramBuilder {
    const Scene& scene;
    TextureStore& textures;
    Report& report;
    std::string owner;            ///< for messages: "material 'Wood'"
    bool is_world = false;        ///< or a lamp's: of no geometry
    const Light* lamp = nullptr;  ///< whose it is
    int material_index = 0;
    bool moves_surface = false;      ///< displacement does
    bool has_moved_normals = false;  ///< a mesh's own, which maps bend, are those of its relief
    RayType ray_type = RayType::Camera;
    bool is_volume = false;  ///< of what fills a thing or the world
    /// How far shifted values lie from the point, pixels: heights of bumps are told apart over it,
    /// on the surface and not as it is seen from the side (Cycles).  0: by the points' own steps.
    float bump_width = 0.0f;
    std::vector<std::set<std::string>> read{};  ///< [nodes] outputs that something reads
    std::vector<Load> loads{};
    std::vector<Step> steps{};
    std::vector<AttributeRequest> requests{};
    std::vector<int> widths{};  ///< [slots] floats
    VectorSource
        bumped{};  ///< the shading normal, where `is_bumped`: what displacement makes of it
    bool is_bumped = false;
    bool is_patterned = false;   ///< some node's values are a pattern
    bool bends_normals = false;  ///< a node is linked to what others take for the normal
    /// [node][shift]
    std::vector<std::array<NodeOutputs, 3>> outputs{};

    int new_slot(int floats) {
        widths.push_back(floats);
        return static_cast<int>(widths.size()) - 1;
    }
};

class NodeBuilder {
  public:
    NodeBuilder(ProgramBuilder& program, const Node& node, std::size_t index, Shift shift)
        : m_program(program), m_node(node), m_index(index), m_shift(shift) {}

    const Node& node() const { return m_node; }
    /// In its graph.
    std::size_t index() const { return m_index; }
    Shift shift() const { return m_shift; }
    /// Of shifted values, for Run::step_scale.
    float bump_width() const { return m_program.bump_width; }
    bool is_world() const { return m_program.is_world; }
    /// Whose light the program makes; nullptr: no lamp's.
    const Light* lamp() const { return m_program.lamp; }
    /// Whether points have a normal and are seen from somewhere.
    bool has_surface() const { return !is_world() || lamp(); }
    bool is_volume() const { return m_program.is_volume; }
    const Scene& scene() const { return m_program.scene; }
    int material_index() const { return m_program.material_index; }
    RayType ray_type() const { return m_program.ray_type; }
    bool is_read(const std::string& output) const {
        return m_program.read[m_index].count(output) != 0;
    }
    TextureStore& textures() { return m_program.textures; }
    Report& report() { return m_program.report; }

    // Inputs.  A missing socket gives the fallback.
    bool linked(const std::string& input) const;
    bool has(const std::string& input) const { return m_node.inputs.count(input) != 0; }
    FloatSource number(const std::string& input, float fallback = 0.0f) const;
    FloatSource number_at(const std::string& input, Shift shift, float fallback = 0.0f) const;
    VectorSource vector(const std::string& input, const Vec3f& fallback = Vec3f(0.0f)) const;
    VectorSource vector_at(const std::string& input, Shift shift,
                           const Vec3f& fallback = Vec3f(0.0f)) const;
    VectorSource color(const std::string& input, const Vec3f& fallback = Vec3f(0.0f)) const {
        return vector(input, fallback);
    }

    /// Luminance, which Cycles makes of a colour where a number is asked for.
    FloatSource number_of(const VectorSource& color) {
        return map<float>(
            [colors = scene().working_space](const Vec3f& c) { return colors.number(c); }, color);
    }

    // Properties.
    std::string text(const std::string& property, const std::string& fallback = "") const {
        return m_node.text(property, fallback);
    }
    double value(const std::string& property, double fallback = 0.0) const {
        return m_node.value(property, fallback);
    }
    bool flag(const std::string& property) const { return m_node.flag(property); }
    /// Whether the node means what it means in this version of Blender and later ones.
    bool since(int major, int minor) const { return value("version", 400) >= 100 * major + minor; }
    std::vector<float> table(const std::string& property) const;

    // Outputs.
    void output(const std::string& name, const FloatSource& source);
    void output_color(const std::string& name, const VectorSource& source);
    void output_vector(const std::string& name, const VectorSource& source);

    /// The artist is told once that this node is not rendered as asked.
    void warn(const std::string& message);

    /// An attribute of the grid's vertices at this builder's shift.
    VectorSource attribute(const AttributeRequest& request) {
        return attribute_at(request, m_shift);
    }
    VectorSource attribute_at(const AttributeRequest& request, Shift shift);
    /// By the points' own steps, as dp_du and dp_dv are, whatever a bump's width is.
    VectorSource attribute_beside(const AttributeRequest& request, Shift shift);
    FloatSource attribute_component(const AttributeRequest& request, int component) {
        return attribute_component(request, component, m_shift);
    }
    FloatSource attribute_component(const AttributeRequest& request, int component, Shift shift);

    template <class Out, class F, class... In>
    Source<Out> map(F function, const Source<In>&... inputs) {
        if ((inputs.is_constant() && ...)) return {-1, function(inputs.constant...)};
        const Source<Out> out{m_program.new_slot(sizeof(Out) / sizeof(float)), Out{}};
        add_step(
            [=](Run& run) {
                const auto columns = std::make_tuple(run.read(inputs)...);
                Out* result = run.write(out);
                for (std::size_t i = 0; i < run.count(); ++i) {
                    result[i] = std::apply(
                        [&](const auto&... column) { return function(column[i]...); }, columns);
                }
            },
            {inputs.slot...}, {out.slot}, true);
        return out;
    }

    /// A value that the points give: function(input, i).
    /// @param counts as Step's.
    template <class Out, class F>
    Source<Out> geometry(F function, bool counts = false) {
        const Source<Out> out{m_program.new_slot(sizeof(Out) / sizeof(float)), Out{}};
        add_step(
            [=](Run& run) {
                Out* result = run.write(out);
                for (std::size_t i = 0; i < run.count(); ++i) result[i] = function(run.input(), i);
            },
            {}, {out.slot});
        m_program.steps.back().counts = counts;
        return out;
    }

    template <class Out>
    Source<Out> new_source() {
        return {m_program.new_slot(sizeof(Out) / sizeof(float)), Out{}};
    }
    /// @param is_still as Step's.
    void add_step(std::function<void(Run&)> run, std::vector<int> reads, std::vector<int> writes,
                  bool is_still = false) {
        m_program.steps.push_back({std::move(run), std::move(reads), std::move(writes), is_still});
    }

    bool moves_surface() const { return m_program.moves_surface; }
    bool has_moved_normals() const { return m_program.has_moved_normals; }
    /// The shading normal, faced to the viewer.
    VectorSource shading_normal();
    /// The input "Normal", or the shading normal where it is not linked.
    VectorSource normal_input(const std::string& input = "Normal");
    // Normals of shaders, about which nothing is mirrored through the surface (valid_reflection.h),
    // but for curves: before Blender 4 all are made so, since then those of specular lobes.
    VectorSource diffuse_normal(const std::string& input = "Normal");
    VectorSource specular_normal(const std::string& input = "Normal");
    /// Unit, from the point to the eye.
    VectorSource view();
    /// 1 where the viewer sees the surface's back.
    FloatSource backfacing();

  private:
    float bump_width_at(Shift shift) const {
        return shift == Shift::None ? 0.0f : m_program.bump_width;
    }
    const NodeOutput* link_source(const std::string& input, Shift shift) const;
    VectorSource with_valid_reflection(const VectorSource& normal);
    /// The slot of what is wanted of an attribute; equal loads share one.
    int load(Load wanted, const AttributeRequest& request);

    ProgramBuilder& m_program;
    const Node& m_node;
    std::size_t m_index;
    Shift m_shift;
};

}  // namespace granita
