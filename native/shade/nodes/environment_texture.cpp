// SPDX-License-Identifier: GPL-3.0-or-later
// Environment Texture: equirectangular and mirror-ball images of all directions.
#include <algorithm>
#include <cmath>

#include "math/sampling.h"
#include "shade/nodes/coordinates.h"
#include "shade/nodes/nodes.h"
#include "shade/nodes/texture_mode.h"
#include "shade/nodes/texture_place.h"

namespace granita {

namespace {

Vec2f project_equirectangular(const Vec3f& d) {
    return {-std::atan2(d.y, d.x) / (2.0f * kPi) + 0.5f,
            std::atan2(d.z, std::hypot(d.x, d.y)) / kPi + 0.5f};
}

Vec2f project_mirror_ball(const Vec3f& direction) {
    Vec3f d = direction;
    d.y -= 1.0f;
    const float scale = 2.0f * std::sqrt(std::max(-0.5f * d.y, 0.0f));
    if (scale > 0.0f) d /= scale;
    return {0.5f * (d.x + 1.0f), 0.5f * (d.z + 1.0f)};
}

}  // namespace

void build_environment_texture(NodeBuilder& b) {
    const std::string image = b.text("image");
    if (image.empty()) {
        b.output_color("Color", {-1, Vec3f(1.0f, 0.0f, 1.0f)});
        return;
    }
    const auto texture = b.textures().find(image, "node '" + b.node().name + "'");
    const bool ball = b.text("projection", "EQUIRECTANGULAR") == "MIRROR_BALL";
    TextureMode mode;
    mode.filter = texture_filter(b);
    const VectorSource direction = mapped_place(
        b, b.linked("Vector") ? b.vector("Vector") : world_position_at(b, Shift::None));
    const VectorSource color = b.new_source<Vec3f>();
    b.add_step(
        [=](Run& run) {
            const std::size_t n = run.count();
            const auto directions = run.read(direction);
            const float spread = run.input().spread;
            std::vector<TexturePlace> places(n);
            for (std::size_t i = 0; i < n; ++i) {
                const float length = glm::length(directions[i]);
                const Vec3f d = length > 0.0f ? directions[i] / length : Vec3f(0, 0, 1);
                const Vec2f center = ball ? project_mirror_ball(d) : project_equirectangular(d);
                // A circle of directions is wider in longitude the nearer it is to a pole.
                const float across = std::max(std::hypot(d.x, d.y), 0.5f * spread);
                const float u = across > 0.0f ? spread / (2.0f * kPi * across) : 0.0f;
                places[i] = {center, Vec2f(std::min(u, 1.0f), 0.0f), Vec2f(0.0f, spread / kPi)};
            }
            std::vector<Vec4f> texels;
            texture->look_up(mode, places, texels);
            Vec3f* out = run.write(color);
            for (std::size_t i = 0; i < n; ++i) out[i] = Vec3f(texels[i]);
        },
        {direction.slot}, {color.slot});
    b.output_color("Color", color);
}

}  // namespace granita
