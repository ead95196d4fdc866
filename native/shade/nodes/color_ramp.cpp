// SPDX-License-Identifier: GPL-3.0-or-later
// Color Ramp and RGB Curves: the exporter hands over what Blender evaluates, as tables.  256
// entries over [0,1], like Cycles', so that a constant ramp steps at the same places.
#include <algorithm>
#include <memory>

#include "shade/nodes/nodes.h"
#include "shade/nodes/scalar_math.h"

namespace granita {

namespace {

using Table = std::shared_ptr<const std::vector<float>>;

/// Entry of a table of `width` components at `place` in [0,1].
float look_up(const std::vector<float>& table, int width, int component, float place,
              bool interpolate) {
    const int last = static_cast<int>(table.size()) / width - 1;
    const float x = saturate(place) * static_cast<float>(last);
    const int i = std::min(static_cast<int>(x), last);
    const float t = x - static_cast<float>(i);
    const float before = table[i * width + component];
    if (!interpolate || t <= 0.0f) return before;
    return (1.0f - t) * before + t * table[(i + 1) * width + component];
}

/// Curves go on straight beyond their ends, as Blender extends them.
float look_up_extended(const std::vector<float>& table, int width, int component, float place) {
    const int last = static_cast<int>(table.size()) / width - 1;
    const float step = static_cast<float>(last);
    if (place < 0.0f) {
        const float slope = (table[width + component] - table[component]) * step;
        return table[component] + slope * place;
    }
    if (place > 1.0f) {
        const float end = table[last * width + component];
        return end + (end - table[(last - 1) * width + component]) * step * (place - 1.0f);
    }
    return look_up(table, width, component, place, true);
}

}  // namespace

void build_color_ramp(NodeBuilder& b) {
    const Table table = std::make_shared<const std::vector<float>>(b.table("ramp"));
    const FloatSource factor = b.number("Fac", 0.5f);
    if (table->size() < 8) {
        b.warn("has no colours");
        b.output_color("Color", {-1, Vec3f(0.0f)});
        b.output("Alpha", FloatSource{-1, 1.0f});
        return;
    }
    const bool interpolate = b.text("interpolation", "LINEAR") != "CONSTANT";
    b.output_color("Color", b.map<Vec3f>(
                                [table, interpolate](float x) {
                                    return Vec3f(look_up(*table, 4, 0, x, interpolate),
                                                 look_up(*table, 4, 1, x, interpolate),
                                                 look_up(*table, 4, 2, x, interpolate));
                                },
                                factor));
    b.output("Alpha", b.map<float>([table, interpolate](
                                       float x) { return look_up(*table, 4, 3, x, interpolate); },
                                   factor));
}

namespace {

/// Three curves, over the components of an input; beyond their ends they go on straight if they are
/// `open`.
VectorSource three_curves(NodeBuilder& b, const VectorSource& input, bool open = true) {
    const Table table = std::make_shared<const std::vector<float>>(b.table("curves"));
    if (table->size() < 6) {
        b.warn("has no curves; rendered unchanged");
        return input;
    }
    const auto low = static_cast<float>(b.value("low", 0.0));
    const auto range = static_cast<float>(b.value("high", 1.0)) - low;
    return b.map<Vec3f>(
        [=](float factor, const Vec3f& c) {
            Vec3f out;
            for (int i = 0; i < 3; ++i) {
                const float place = (c[i] - low) / range;
                out[i] = look_up_extended(*table, 3, i, open ? place : saturate(place));
            }
            return c * (1.0f - factor) + out * factor;
        },
        b.number("Fac", 1.0f), input);
}

}  // namespace

void build_rgb_curves(NodeBuilder& b) {
    b.output_color("Color", three_curves(b, b.color("Color")));
}

void build_vector_curves(NodeBuilder& b) {
    b.output_vector("Vector", three_curves(b, b.vector("Vector")));
}

void build_float_curve(NodeBuilder& b) {
    const FloatSource value = b.number("Value", 1.0f);
    const VectorSource all = b.map<Vec3f>([](float x) { return Vec3f(x); }, value);
    // Since 5.0 Cycles ends the curve for what it knows beforehand.
    const VectorSource curve = three_curves(b, all, !(value.is_constant() && b.since(5, 0)));
    b.output("Value", b.map<float>([](const Vec3f& v) { return v.x; }, curve));
}

}  // namespace granita
