// SPDX-License-Identifier: GPL-3.0-or-later
// Image Texture: projections flat, box, sphere and tube, tiles; footprints from the shifted
// vectors.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "base/object_pool.h"
#include "math/sampling.h"
#include "shade/nodes/coordinates.h"
#include "shade/nodes/nodes.h"
#include "shade/nodes/texture_mode.h"
#include "shade/nodes/texture_place.h"
#include "shade/textures/udim_texture.h"

namespace granita {

namespace {

/// A place on the unit sphere around the middle of the unit cube, as longitude and latitude.
Vec2f project_sphere(const Vec3f& coordinate) {
    const Vec3f p = (coordinate - 0.5f) * 2.0f;
    const float length = glm::length(p);
    if (length == 0.0f) return Vec2f(0.0f);
    const float u = p.x == 0.0f && p.y == 0.0f ? 0.0f : (1.0f - std::atan2(p.x, p.y) / kPi) / 2.0f;
    return {u, 1.0f - std::acos(std::clamp(p.z / length, -1.0f, 1.0f)) / kPi};
}

Vec2f project_tube(const Vec3f& coordinate) {
    const Vec3f p = (coordinate - 0.5f) * 2.0f;
    if (p.x == 0.0f && p.y == 0.0f) return Vec2f(0.0f);
    return {(1.0f - std::atan2(p.x, p.y) / kPi) * 0.5f, (p.z + 1.0f) * 0.5f};
}

/// An edge of a footprint; one that jumps over the seam of a periodic projection is taken the short
/// way round.
Vec2f edge(const Vec2f& from, const Vec2f& to, bool seam) {
    Vec2f d = to - from;
    if (seam) d.x -= std::round(d.x);
    return d;
}

/// How much each axis' face shows: (Cycles' box projection) one face alone, or two or three blended
/// where the normal is within `blend` of the diagonal.
Vec3f box_weights(const Vec3f& normal, float blend) {
    Vec3f n = glm::abs(normal);
    n /= std::max(n.x + n.y + n.z, 1e-20f);
    const float limit = 0.5f * (1.0f + blend);
    if (n.x > limit * (n.x + n.y) && n.x > limit * (n.x + n.z)) return {1, 0, 0};
    if (n.y > limit * (n.x + n.y) && n.y > limit * (n.y + n.z)) return {0, 1, 0};
    if (n.z > limit * (n.x + n.z) && n.z > limit * (n.y + n.z)) return {0, 0, 1};
    if (blend <= 0.0f) return {1, 0, 0};
    const auto share = [blend](float a, float b) {
        return std::clamp((a / (a + b) - 0.5f * (1.0f - blend)) / blend, 0.0f, 1.0f);
    };
    if (n.z < (1.0f - limit) * (n.y + n.x)) {
        const float x = share(n.x, n.y);
        return {x, 1.0f - x, 0.0f};
    }
    if (n.x < (1.0f - limit) * (n.y + n.z)) {
        const float y = share(n.y, n.z);
        return {0.0f, y, 1.0f - y};
    }
    if (n.y < (1.0f - limit) * (n.x + n.z)) {
        const float x = share(n.x, n.z);
        return {x, 0.0f, 1.0f - x};
    }
    return ((2.0f - limit) * n + (limit - 1.0f)) / (2.0f * limit - 1.0f);
}

/// The plane that a face of the box shows, mirrored on one side so that text reads alike.
Vec2f box_plane(int axis, const Vec3f& p, const Vec3f& normal) {
    if (axis == 0) return {normal.x < 0.0f ? 1.0f - p.y : p.y, p.z};
    if (axis == 1) return {normal.y > 0.0f ? 1.0f - p.x : p.x, p.z};
    return {normal.z > 0.0f ? 1.0f - p.y : p.y, p.x};
}

TextureMode texture_mode(NodeBuilder& b) {
    const std::string extension = b.text("extension", "REPEAT");
    TextureMode mode;
    mode.filter = texture_filter(b);
    mode.extension = extension == "EXTEND"   ? TextureExtension::Extend
                     : extension == "CLIP"   ? TextureExtension::Clip
                     : extension == "MIRROR" ? TextureExtension::Mirror
                                             : TextureExtension::Repeat;
    mode.unassociate = b.flag("unassociate_alpha");
    return mode;
}

/// `image` is the first of its tiles.  A box sees no other: it repeats that one, and since 5.2 it
/// has nothing beside it.
std::shared_ptr<const Texture> find_texture(NodeBuilder& b, const std::string& image, bool box) {
    const std::string user = "node '" + b.node().name + "'";
    const std::vector<float> numbers = b.table("tiles");
    if (numbers.empty() || (box && !b.since(5, 2))) return b.textures().find(image, user);
    std::map<int, std::shared_ptr<const Texture>> tiles;
    for (const float number : numbers) {
        const int tile = static_cast<int>(number);
        if (box && tile != UdimTexture::kFirst) continue;
        const std::string name = b.text("tiles_of") + "/" + std::to_string(tile);
        tiles[tile] = b.textures().find(name, user);
    }
    return std::make_shared<UdimTexture>(std::move(tiles));
}

/// Where the texture is read, and the point with its neighbours, whose differences are the edges of
/// the area that one read stands for: the same at each shift, or a bump would take differences of
/// filters for slopes.
struct Footprint {
    VectorSource center, point, next_u, next_v;
    float width = 0.0f;  ///< of the two: Run::step_scale
};

Footprint footprint(NodeBuilder& b) {
    const auto at = [&](Shift shift) { return mapped_place(b, b.vector_at("Vector", shift)); };
    if (b.linked("Vector"))
        return {at(b.shift()), at(Shift::None), at(Shift::U), at(Shift::V), b.bump_width()};
    return {mapped_place(b, uv_at(b, "", b.shift())), mapped_place(b, uv_at(b, "", Shift::None)),
            mapped_place(b, uv_beside(b, "", Shift::U)),
            mapped_place(b, uv_beside(b, "", Shift::V))};
}

/// Shadow rays look up one place at a time.
void give_back(std::vector<TexturePlace>& places, std::vector<Vec4f>& texels) {
    ObjectPool<std::vector<TexturePlace>>::give(std::move(places));
    ObjectPool<std::vector<Vec4f>>::give(std::move(texels));
}

}  // namespace

void build_image_texture(NodeBuilder& b) {
    const std::string image = b.text("image");
    if (image.empty()) {
        b.output_color("Color", {-1, Vec3f(1.0f, 0.0f, 1.0f)});
        b.output("Alpha", FloatSource{-1, 1.0f});
        return;
    }
    const TextureMode mode = texture_mode(b);
    const std::string projection = b.text("projection", "FLAT");
    const auto texture = find_texture(b, image, projection == "BOX");
    const Footprint print = footprint(b);
    const VectorSource color = b.new_source<Vec3f>();
    const FloatSource alpha = b.new_source<float>();
    std::vector<int> reads = {print.center.slot, print.point.slot, print.next_u.slot,
                              print.next_v.slot};

    if (projection == "BOX") {
        const auto blend = static_cast<float>(b.value("projection_blend"));
        const VectorSource normal = object_normal(b);
        reads.push_back(normal.slot);
        b.add_step(
            [=](Run& run) {
                const std::size_t n = run.count();
                const auto at = run.read(print.center), p = run.read(print.point),
                           u = run.read(print.next_u), v = run.read(print.next_v),
                           normals = run.read(normal);
                std::vector<Vec4f> sum(n, Vec4f(0.0f));
                auto texels = ObjectPool<std::vector<Vec4f>>::take();
                auto places = ObjectPool<std::vector<TexturePlace>>::take();
                places.resize(n);
                for (int axis = 0; axis < 3; ++axis) {
                    for (std::size_t i = 0; i < n; ++i) {
                        const Vec2f point = box_plane(axis, p[i], normals[i]);
                        places[i] = {box_plane(axis, at[i], normals[i]),
                                     (box_plane(axis, u[i], normals[i]) - point) /
                                         run.step_scale(print.width, Shift::U, i),
                                     (box_plane(axis, v[i], normals[i]) - point) /
                                         run.step_scale(print.width, Shift::V, i)};
                    }
                    texture->look_up(mode, places, texels);
                    for (std::size_t i = 0; i < n; ++i)
                        sum[i] += texels[i] * box_weights(normals[i], blend)[axis];
                }
                Vec3f* out_color = run.write(color);
                float* out_alpha = run.write(alpha);
                for (std::size_t i = 0; i < n; ++i) {
                    out_color[i] = Vec3f(sum[i]);
                    out_alpha[i] = sum[i].w;
                }
                give_back(places, texels);
            },
            reads, {color.slot, alpha.slot});
    } else {
        using Project = Vec2f (*)(const Vec3f&);
        const Project project = projection == "SPHERE" ? project_sphere
                                : projection == "TUBE" ? project_tube
                                                       : [](const Vec3f& p) { return Vec2f(p); };
        const bool seam = projection == "SPHERE" || projection == "TUBE";
        b.add_step(
            [=](Run& run) {
                const std::size_t n = run.count();
                const auto at = run.read(print.center), p = run.read(print.point),
                           u = run.read(print.next_u), v = run.read(print.next_v);
                auto places = ObjectPool<std::vector<TexturePlace>>::take();
                places.resize(n);
                for (std::size_t i = 0; i < n; ++i) {
                    const Vec2f point = project(p[i]);
                    places[i] = {
                        project(at[i]),
                        edge(point, project(u[i]), seam) / run.step_scale(print.width, Shift::U, i),
                        edge(point, project(v[i]), seam) /
                            run.step_scale(print.width, Shift::V, i)};
                }
                auto texels = ObjectPool<std::vector<Vec4f>>::take();
                texture->look_up(mode, places, texels);
                Vec3f* out_color = run.write(color);
                float* out_alpha = run.write(alpha);
                for (std::size_t i = 0; i < n; ++i) {
                    out_color[i] = Vec3f(texels[i]);
                    out_alpha[i] = texels[i].w;
                }
                give_back(places, texels);
            },
            reads, {color.slot, alpha.slot}, print.width == 0.0f);
    }
    b.output_color("Color", color);
    b.output("Alpha", alpha);
}

}  // namespace granita
