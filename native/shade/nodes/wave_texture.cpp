// SPDX-License-Identifier: GPL-3.0-or-later
#include <numbers>

#include "shade/nodes/gradient_noise.h"
#include "shade/nodes/nodes.h"
#include "shade/nodes/texture_place.h"

namespace granita {

namespace {

struct WaveShape {
    std::string type, bands, rings, profile;
};

/// Phase of the undistorted wave; bands are a metre over 20 radians apart, as Blender has them.
float phase_at(const WaveShape& shape, const Vec3f& p) {
    if (shape.type == "BANDS") {
        if (shape.bands == "X") return p.x * 20.0f;
        if (shape.bands == "Y") return p.y * 20.0f;
        if (shape.bands == "Z") return p.z * 20.0f;
        return (p.x + p.y + p.z) * 10.0f;
    }
    Vec3f across = p;
    if (shape.rings == "X") across.x = 0.0f;
    if (shape.rings == "Y") across.y = 0.0f;
    if (shape.rings == "Z") across.z = 0.0f;
    return glm::length(across) * 20.0f;
}

float profile_at(const std::string& profile, float phase) {
    constexpr float kTwoPi = 2.0f * std::numbers::pi_v<float>;
    if (profile == "SIN") return 0.5f + 0.5f * std::sin(phase - 0.25f * kTwoPi);
    const float turns = phase / kTwoPi;
    if (profile == "SAW") return turns - std::floor(turns);
    return std::abs(turns - std::floor(turns + 0.5f)) * 2.0f;
}

}  // namespace

void build_wave_texture(NodeBuilder& b) {
    const WaveShape shape{b.text("wave_type", "BANDS"), b.text("bands_direction", "X"),
                          b.text("rings_direction", "X"), b.text("wave_profile", "SIN")};
    const VectorSource vector = texture_place(b);
    const FloatSource factor = b.map<float>(
        [shape](const Vec3f& v, float scale, float distortion, float detail, float detail_scale,
                float roughness, float offset) {
            // The nudge keeps faces on whole numbers on one side, as in the checker.
            const Vec3f p = (v * scale + 1e-6f) * 0.999999f;
            float phase = phase_at(shape, p) + offset;
            if (distortion != 0.0f) {
                const Vec3f q = p * detail_scale;
                const Octaves octaves{detail, std::clamp(roughness, 0.0f, 1.0f)};
                phase += distortion * (fractal_noise<3>({q.x, q.y, q.z}, octaves) * 2.0f - 1.0f);
            }
            return profile_at(shape.profile, phase);
        },
        vector, b.number("Scale", 5.0f), b.number("Distortion"), b.number("Detail", 2.0f),
        b.number("Detail Scale", 1.0f), b.number("Detail Roughness", 0.5f),
        b.number("Phase Offset"));
    b.output("Fac", factor);
    b.output_color("Color", b.map<Vec3f>([](float x) { return Vec3f(x); }, factor));
}

}  // namespace granita
