// SPDX-License-Identifier: GPL-3.0-or-later
// Math: one of forty operations on up to three numbers, guarded as Cycles guards them (a division
// by zero is zero).
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "math/sampling.h"
#include "shade/nodes/nodes.h"
#include "shade/nodes/operation.h"
#include "shade/nodes/scalar_math.h"

namespace granita {

namespace {

using Operation = float (*)(float, float, float);

float compare(float a, float b, float c) {
    const float tolerance = std::max(c, std::numeric_limits<float>::epsilon());
    return a == b || std::abs(a - b) <= tolerance ? 1.0f : 0.0f;
}

float logarithm(float a, float b, float) {
    if (a <= 0.0f || b <= 0.0f) return 0.0f;
    return safe_divide(std::log(a), std::log(b));
}

float floored_modulo(float a, float b, float) {
    return b != 0.0f ? a - std::floor(a / b) * b : 0.0f;
}

const std::map<std::string, Operation>& operations() {
    static const std::map<std::string, Operation> kOperations = {
        {"ADD", [](float a, float b, float) { return a + b; }},
        {"SUBTRACT", [](float a, float b, float) { return a - b; }},
        {"MULTIPLY", [](float a, float b, float) { return a * b; }},
        {"DIVIDE", [](float a, float b, float) { return safe_divide(a, b); }},
        {"MULTIPLY_ADD", [](float a, float b, float c) { return a * b + c; }},
        {"POWER", [](float a, float b, float) { return safe_power(a, b); }},
        {"LOGARITHM", logarithm},
        {"SQRT", [](float a, float, float) { return std::sqrt(std::max(a, 0.0f)); }},
        {"INVERSE_SQRT", [](float a, float, float) { return a > 0.0f ? 1 / std::sqrt(a) : 0.0f; }},
        {"ABSOLUTE", [](float a, float, float) { return std::abs(a); }},
        {"EXPONENT", [](float a, float, float) { return std::exp(a); }},
        {"MINIMUM", [](float a, float b, float) { return std::min(a, b); }},
        {"MAXIMUM", [](float a, float b, float) { return std::max(a, b); }},
        {"LESS_THAN", [](float a, float b, float) { return a < b ? 1.0f : 0.0f; }},
        {"GREATER_THAN", [](float a, float b, float) { return a > b ? 1.0f : 0.0f; }},
        {"SIGN", [](float a, float, float) { return a > 0.0f   ? 1.0f
                                                    : a < 0.0f ? -1.0f
                                                               : 0.0f; }},
        {"COMPARE", compare},
        {"SMOOTH_MIN", smooth_minimum},
        {"SMOOTH_MAX", [](float a, float b, float c) { return -smooth_minimum(-a, -b, c); }},
        {"ROUND", [](float a, float, float) { return std::floor(a + 0.5f); }},
        {"FLOOR", [](float a, float, float) { return std::floor(a); }},
        {"CEIL", [](float a, float, float) { return std::ceil(a); }},
        {"TRUNC", [](float a, float, float) { return std::trunc(a); }},
        {"FRACT", [](float a, float, float) { return a - std::floor(a); }},
        {"MODULO", [](float a, float b, float) { return safe_modulo(a, b); }},
        {"FLOORED_MODULO", floored_modulo},
        {"WRAP", wrap},
        {"SNAP", [](float a, float b, float) { return std::floor(safe_divide(a, b)) * b; }},
        {"PINGPONG", ping_pong},
        {"SINE", [](float a, float, float) { return std::sin(a); }},
        {"COSINE", [](float a, float, float) { return std::cos(a); }},
        {"TANGENT", [](float a, float, float) { return std::tan(a); }},
        {"ARCSINE", [](float a, float, float) { return std::asin(std::clamp(a, -1.0f, 1.0f)); }},
        {"ARCCOSINE", [](float a, float, float) { return std::acos(std::clamp(a, -1.0f, 1.0f)); }},
        {"ARCTANGENT", [](float a, float, float) { return std::atan(a); }},
        {"ARCTAN2", [](float a, float b, float) { return std::atan2(a, b); }},
        {"SINH", [](float a, float, float) { return std::sinh(a); }},
        {"COSH", [](float a, float, float) { return std::cosh(a); }},
        {"TANH", [](float a, float, float) { return std::tanh(a); }},
        {"RADIANS", [](float a, float, float) { return a * (kPi / 180.0f); }},
        {"DEGREES", [](float a, float, float) { return a * (180.0f / kPi); }},
    };
    return kOperations;
}

}  // namespace

void build_math(NodeBuilder& b) {
    const Operation operation = chosen_operation(b, operations());
    const bool clamp = b.flag("use_clamp");
    b.output("Value", b.map<float>(
                          [operation, clamp](float x, float y, float z) {
                              const float value = operation(x, y, z);
                              return clamp ? std::clamp(value, 0.0f, 1.0f) : value;
                          },
                          b.number("Value"), b.number("Value_001"), b.number("Value_002")));
}

}  // namespace granita
