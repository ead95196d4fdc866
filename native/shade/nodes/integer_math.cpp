// SPDX-License-Identifier: GPL-3.0-or-later
// Integer Math and Boolean Math.  Sockets of integers cut fractions off, those of booleans are true
// above zero; divisions by zero are zero.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <numeric>

#include "shade/nodes/nodes.h"
#include "shade/nodes/operation.h"

namespace granita {

namespace {

using Integer = std::int64_t;  // products of two of 32 bits fit
using Operation = Integer (*)(Integer, Integer, Integer);

/// Within 32 bits, as Blender's are; 0 of what is no number.
Integer integer(float x) {
    return x == x ? static_cast<Integer>(std::clamp(x, -2147483648.0f, 2147483520.0f)) : 0;
}

Integer floored(Integer a, Integer b) {
    return b == 0 ? 0 : a / b - (a % b != 0 && (a < 0) != (b < 0));
}

Integer rounded(Integer a, Integer b) {
    return b == 0 ? 0 : std::llround(static_cast<double>(a) / static_cast<double>(b));
}

Integer power(Integer a, Integer b) {
    if (a == 0 && b < 0) return 0;
    return integer(static_cast<float>(std::pow(static_cast<double>(a), static_cast<double>(b))));
}

const std::map<std::string, Operation>& operations() {
    static const std::map<std::string, Operation> kOperations = {
        {"ADD", [](Integer a, Integer b, Integer) { return a + b; }},
        {"SUBTRACT", [](Integer a, Integer b, Integer) { return a - b; }},
        {"MULTIPLY", [](Integer a, Integer b, Integer) { return a * b; }},
        {"DIVIDE", [](Integer a, Integer b, Integer) { return b == 0 ? 0 : a / b; }},
        {"MULTIPLY_ADD", [](Integer a, Integer b, Integer c) { return a * b + c; }},
        {"ABSOLUTE", [](Integer a, Integer, Integer) { return std::abs(a); }},
        {"NEGATE", [](Integer a, Integer, Integer) { return -a; }},
        {"POWER", [](Integer a, Integer b, Integer) { return power(a, b); }},
        {"MINIMUM", [](Integer a, Integer b, Integer) { return std::min(a, b); }},
        {"MAXIMUM", [](Integer a, Integer b, Integer) { return std::max(a, b); }},
        {"SIGN", [](Integer a, Integer, Integer) { return Integer{(a > 0) - (a < 0)}; }},
        {"DIVIDE_ROUND", [](Integer a, Integer b, Integer) { return rounded(a, b); }},
        {"DIVIDE_FLOOR", [](Integer a, Integer b, Integer) { return floored(a, b); }},
        {"DIVIDE_CEIL", [](Integer a, Integer b, Integer) { return -floored(-a, b); }},
        {"FLOORED_MODULO",
         [](Integer a, Integer b, Integer) { return b == 0 ? 0 : a - floored(a, b) * b; }},
        {"MODULO", [](Integer a, Integer b, Integer) { return b == 0 ? 0 : a % b; }},
        {"GCD", [](Integer a, Integer b, Integer) { return std::gcd(a, b); }},
        {"LCM", [](Integer a, Integer b, Integer) { return std::lcm(a, b); }},
    };
    return kOperations;
}

using Logic = bool (*)(bool, bool);

const std::map<std::string, Logic>& logic() {
    static const std::map<std::string, Logic> kLogic = {
        {"AND", [](bool a, bool b) { return a && b; }},
        {"OR", [](bool a, bool b) { return a || b; }},
        {"NOT", [](bool a, bool) { return !a; }},
        {"NAND", [](bool a, bool b) { return !(a && b); }},
        {"NOR", [](bool a, bool b) { return !(a || b); }},
        {"XNOR", [](bool a, bool b) { return a == b; }},
        {"XOR", [](bool a, bool b) { return a != b; }},
        {"IMPLY", [](bool a, bool b) { return !a || b; }},
        {"NIMPLY", [](bool a, bool b) { return a && !b; }},
    };
    return kLogic;
}

}  // namespace

void build_integer_math(NodeBuilder& b) {
    const Operation operation = chosen_operation(b, operations());
    b.output("Value",
             b.map<float>(
                 [operation](float x, float y, float z) {
                     return static_cast<float>(operation(integer(x), integer(y), integer(z)));
                 },
                 b.number("Value"), b.number("Value_001"), b.number("Value_002")));
}

void build_boolean_math(NodeBuilder& b) {
    const Logic operation = chosen_operation(b, logic(), "AND");
    b.output("Boolean", b.map<float>(
                            [operation](float x, float y) {
                                return operation(x > 0.0f, y > 0.0f) ? 1.0f : 0.0f;
                            },
                            b.number("Boolean"), b.number("Boolean_001")));
}

}  // namespace granita
