// SPDX-License-Identifier: GPL-3.0-or-later
// Vector Math, Map Range (of numbers) and Clamp.
#include <algorithm>
#include <cmath>
#include <map>

#include "shade/nodes/nodes.h"
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

}  // namespace

void build_vector_math(NodeBuilder& b) {
    const std::string name = b.text("operation", "ADD");
    const VectorSource x = b.vector("Vector"), y = b.vector("Vector_001");
    const auto scalar = scalar_operations().find(name);
    if (scalar != scalar_operations().end()) {
        b.output("Value", b.map<float>(scalar->second, x, y));
        return;
    }
    const auto found = vector_operations().find(name);
    if (found == vector_operations().end())
        b.warn("operation " + name + " is not supported; rendered as Add");
    const VectorOperation operation =
        found == vector_operations().end() ? vector_operations().at("ADD") : found->second;
    b.output_vector("Vector",
                    b.map<Vec3f>(operation, x, y, b.vector("Vector_002"), b.number("Scale", 1.0f)));
}

void build_map_range(NodeBuilder& b) {
    const std::string kind = b.text("interpolation_type", "LINEAR");
    if (b.text("data_type", "FLOAT") != "FLOAT")
        b.warn("ranges of vectors are not supported; rendered as numbers");
    const bool clamp = b.value("clamp", 1.0) != 0.0;
    const bool smooth = kind == "SMOOTHSTEP", smoother = kind == "SMOOTHERSTEP";
    const FloatSource steps = kind == "STEPPED" ? b.number("Steps", 4.0f) : FloatSource{-1, -1.0f};
    b.output("Result",
             b.map<float>(
                 [=](float x, float from0, float from1, float to0, float to1, float n) {
                     if (from0 == from1) return 0.0f;
                     float t = (x - from0) / (from1 - from0);
                     if (n >= 0.0f) t = n > 0.0f ? std::floor(t * (n + 1.0f)) / n : 0.0f;
                     if (smooth || smoother) {
                         t = std::clamp(t, 0.0f, 1.0f);
                         t = smooth ? smoothstep(t) : smootherstep(t);
                     }
                     const float out = to0 + t * (to1 - to0);
                     const bool limited = clamp && !smooth && !smoother;
                     return limited ? std::clamp(out, std::min(to0, to1), std::max(to0, to1)) : out;
                 },
                 b.number("Value"), b.number("From Min"), b.number("From Max", 1.0f),
                 b.number("To Min"), b.number("To Max", 1.0f), steps));
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
