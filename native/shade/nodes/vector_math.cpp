// SPDX-License-Identifier: GPL-3.0-or-later
// Vector Math, Map Range and Clamp.
#include <algorithm>
#include <cmath>
#include <map>

#include "shade/nodes/nodes.h"
#include "shade/nodes/operation.h"
#include "shade/nodes/scalar_math.h"

namespace granita {

namespace {

using V = const Vec3f&;
using VectorOperation = Vec3f (*)(V a, V b, V c, float scale);
using ScalarOperation = float (*)(V a, V b);

template <class F>
Vec3f each(F function, V a, V b = Vec3f(0.0f), V c = Vec3f(0.0f)) {
    return {function(a.x, b.x, c.x), function(a.y, b.y, c.y), function(a.z, b.z, c.z)};
}

Vec3f unit(V v) {
    const float length = glm::length(v);
    return length != 0.0f ? v / length : Vec3f(0.0f);
}

Vec3f project(V a, V b) {
    const float length = glm::dot(b, b);
    return length != 0.0f ? glm::dot(a, b) / length * b : Vec3f(0.0f);
}

Vec3f refract(V a, V b, float eta) {
    const Vec3f n = unit(b);
    const float k = 1.0f - eta * eta * (1.0f - glm::dot(n, a) * glm::dot(n, a));
    return k < 0.0f ? Vec3f(0.0f) : eta * a - (eta * glm::dot(n, a) + std::sqrt(k)) * n;
}

const std::map<std::string, VectorOperation>& vector_operations() {
    using F = float;
    static const std::map<std::string, VectorOperation> kOperations = {
        {"ADD", [](V a, V b, V, F) { return a + b; }},
        {"SUBTRACT", [](V a, V b, V, F) { return a - b; }},
        {"MULTIPLY", [](V a, V b, V, F) { return a * b; }},
        {"DIVIDE",
         [](V a, V b, V, F) { return each([](F x, F y, F) { return safe_divide(x, y); }, a, b); }},
        {"MULTIPLY_ADD", [](V a, V b, V c, F) { return a * b + c; }},
        {"CROSS_PRODUCT", [](V a, V b, V, F) { return glm::cross(a, b); }},
        {"PROJECT", [](V a, V b, V, F) { return project(a, b); }},
        {"REFLECT", [](V a, V b, V, F) { return a - 2.0f * unit(b) * glm::dot(a, unit(b)); }},
        {"REFRACT", [](V a, V b, V, F s) { return refract(a, b, s); }},
        {"FACEFORWARD", [](V a, V b, V c, F) { return glm::dot(c, b) < 0.0f ? a : -a; }},
        {"SCALE", [](V a, V, V, F s) { return a * s; }},
        {"NORMALIZE", [](V a, V, V, F) { return unit(a); }},
        {"WRAP", [](V a, V b, V c, F) { return each(wrap, a, b, c); }},
        {"SNAP",
         [](V a, V b, V, F) {
             return each([](F x, F y, F) { return std::floor(safe_divide(x, y)) * y; }, a, b);
         }},
        {"FLOOR", [](V a, V, V, F) { return glm::floor(a); }},
        {"CEIL", [](V a, V, V, F) { return glm::ceil(a); }},
        {"ROUND", [](V a, V, V, F) { return glm::floor(a + 0.5f); }},
        {"MODULO",
         [](V a, V b, V, F) { return each([](F x, F y, F) { return safe_modulo(x, y); }, a, b); }},
        {"FRACTION", [](V a, V, V, F) { return a - glm::floor(a); }},
        {"ABSOLUTE", [](V a, V, V, F) { return glm::abs(a); }},
        {"POWER",
         [](V a, V b, V, F) { return each([](F x, F y, F) { return safe_power(x, y); }, a, b); }},
        {"SIGN", [](V a, V, V, F) { return glm::sign(a); }},
        {"MINIMUM", [](V a, V b, V, F) { return glm::min(a, b); }},
        {"MAXIMUM", [](V a, V b, V, F) { return glm::max(a, b); }},
        {"SINE", [](V a, V, V, F) { return glm::sin(a); }},
        {"COSINE", [](V a, V, V, F) { return glm::cos(a); }},
        {"TANGENT", [](V a, V, V, F) { return glm::tan(a); }},
    };
    return kOperations;
}

const std::map<std::string, ScalarOperation>& scalar_operations() {
    static const std::map<std::string, ScalarOperation> kOperations = {
        {"DOT_PRODUCT", [](V a, V b) { return glm::dot(a, b); }},
        {"DISTANCE", [](V a, V b) { return glm::distance(a, b); }},
        {"LENGTH", [](V a, V) { return glm::length(a); }},
    };
    return kOperations;
}

float smoothstep(float t) {
    return (3.0f - 2.0f * t) * t * t;
}
float smootherstep(float t) {
    return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f);
}

/// Numbers from one range to another, as a Map Range node is set.
class Range {
  public:
    explicit Range(const NodeBuilder& b) {
        const std::string kind = b.text("interpolation_type", "LINEAR");
        m_steps = kind == "STEPPED";
        m_smooth = kind == "SMOOTHSTEP";
        m_smoother = kind == "SMOOTHERSTEP";
        m_clamps = b.value("clamp", 1.0) != 0.0;
    }

    /// A range without length is as if `x` lay at its begin.
    float operator()(float x, float from0, float from1, float to0, float to1, float steps) const {
        float t = safe_divide(x - from0, from1 - from0);
        if (m_steps) t = steps > 0.0f ? std::floor(t * (steps + 1.0f)) / steps : 0.0f;
        if (m_smooth) t = smoothstep(std::clamp(t, 0.0f, 1.0f));
        if (m_smoother) t = smootherstep(std::clamp(t, 0.0f, 1.0f));
        const float out = to0 + t * (to1 - to0);
        return m_clamps ? std::clamp(out, std::min(to0, to1), std::max(to0, to1)) : out;
    }

  private:
    bool m_steps, m_smooth, m_smoother, m_clamps;
};

}  // namespace

void build_vector_math(NodeBuilder& b) {
    const std::string name = b.text("operation", "ADD");
    const VectorSource x = b.vector("Vector"), y = b.vector("Vector_001");
    const auto scalar = scalar_operations().find(name);
    if (scalar != scalar_operations().end()) {
        b.output("Value", b.map<float>(scalar->second, x, y));
        return;
    }
    const VectorOperation operation = chosen_operation(b, vector_operations());
    b.output_vector("Vector",
                    b.map<Vec3f>(operation, x, y, b.vector("Vector_002"), b.number("Scale", 1.0f)));
}

void build_map_range(NodeBuilder& b) {
    const Range range(b);
    if (b.text("data_type", "FLOAT") == "FLOAT") {
        const auto mapped = [range](float x, float from0, float from1, float to0, float to1,
                                    float n) {
            return from0 == from1 ? 0.0f : range(x, from0, from1, to0, to1, n);
        };
        b.output("Result", b.map<float>(mapped, b.number("Value"), b.number("From Min"),
                                        b.number("From Max", 1.0f), b.number("To Min"),
                                        b.number("To Max", 1.0f), b.number("Steps", 4.0f)));
        return;
    }
    const auto mapped = [range](V x, V from0, V from1, V to0, V to1, V n) {
        Vec3f out;
        for (int i = 0; i < 3; ++i) out[i] = range(x[i], from0[i], from1[i], to0[i], to1[i], n[i]);
        return out;
    };
    b.output_vector(
        "Vector", b.map<Vec3f>(mapped, b.vector("Vector"), b.vector("From_Min_FLOAT3"),
                               b.vector("From_Max_FLOAT3", Vec3f(1.0f)), b.vector("To_Min_FLOAT3"),
                               b.vector("To_Max_FLOAT3", Vec3f(1.0f)),
                               b.vector("Steps_FLOAT3", Vec3f(4.0f))));
}

void build_clamp(NodeBuilder& b) {
    const bool range = b.text("clamp_type", "MINMAX") == "RANGE";
    b.output("Result", b.map<float>(
                           [range](float x, float low, float high) {
                               if (range && low > high) std::swap(low, high);
                               return std::min(std::max(x, low), high);
                           },
                           b.number("Value", 1.0f), b.number("Min"), b.number("Max", 1.0f)));
}

}  // namespace granita
