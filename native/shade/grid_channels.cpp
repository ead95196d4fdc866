// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/grid_channels.h"

#include <algorithm>
#include <cmath>

#include "shade/interpolated_points.h"
#include "shade/speed.h"

namespace granita {
namespace {

float mean(const Vec3f& v) {
    return (v.x + v.y + v.z) / 3.0f;
}

/// The lobes' normals by weight, as Cycles averages its closures'.
Vec3f average_normal(const ShadingPoints& points, const SurfaceClosure& closure, std::size_t i) {
    Vec3f sum(0.0f);
    for (const Lobe& lobe : closure.lobes) sum += lobe.normal[i] * std::abs(mean(lobe.weight[i]));
    for (const SubsurfaceLobe& lobe : closure.subsurface)
        sum += lobe.normal[i] * std::abs(mean(lobe.weight[i]));
    const float length = glm::length(sum);
    return length > 0.0f ? sum / length : points.normal[i];
}

/// How little of a point is lost in the mist, times its opacity.  A mist of no depth takes nothing,
/// as in Cycles.
float clarity(const Mist& mist, const Vec3f& p_camera, bool perspective, float opacity) {
    const float distance = perspective ? glm::length(p_camera) : std::abs(p_camera.z);
    const float place = mist.depth > 0.0f ? (distance - mist.start) / mist.depth : 0.0f;
    return (1.0f - std::pow(std::clamp(place, 0.0f, 1.0f), mist.exponent)) * opacity;
}

Vec3f opacity_of(const Grid& grid, std::size_t point) {
    if (grid.opacity.empty()) return Vec3f(1.0f);
    const std::vector<std::uint32_t>& anchors = grid.shading_positions.anchors;
    return grid.opacity[anchors.empty() ? point : anchors[point]];
}

/// Rows of one channel in Grid::channels, a point each.
class Rows {
  public:
    Rows(Grid& grid, const ChannelSet& channels, const Channel& channel)
        : m_first(grid.channels.data() + channel.first), m_width(channels.vertex_width()) {
        if (channel.merge == Merge::Center || channel.merge == Merge::CenterConstant)
            m_first += channels.surface_width();
    }
    void write(std::size_t point, float value) const { m_first[point * m_width] = value; }
    void write(std::size_t point, const Vec3f& value) const {
        for (int c = 0; c < 3; ++c) m_first[point * m_width + c] = value[c];
    }
    void write(std::size_t point, const Vec4f& value) const {
        for (int c = 0; c < 4; ++c) m_first[point * m_width + c] = value[c];
    }

  private:
    float* m_first;
    std::size_t m_width;
};

/// Which passes tell of Combined's parts.
bool is_light(Quantity quantity) {
    switch (quantity) {
        case Quantity::DiffuseDirect:
        case Quantity::DiffuseIndirect:
        case Quantity::GlossyDirect:
        case Quantity::GlossyIndirect:
        case Quantity::TransmissionDirect:
        case Quantity::TransmissionIndirect:
        case Quantity::Emission:
            return true;
        default:
            return false;
    }
}

}  // namespace

void fill_channels(Grid& grid, const ChannelSet& channels, const Scene& scene,
                   const ShadingCamera& camera, const ShadedGrid& shaded) {
    const ShadingPoints& points = shaded.points;
    grid.channels.assign(points.count * channels.vertex_width(), 0.0f);
    // What is cut out of the picture is in no pass but those of its own nodes, as in Cycles.
    const bool is_cut = grid.holdout && !scene.catches_shadows(grid.instance, grid.material);
    for (const Channel& channel : channels.channels()) {
        if (channel.quantity == Quantity::Environment) continue;
        if (is_cut && channel.aov < 0) continue;
        if (channel.aov >= 0 && !shaded.sources.writes_aov[channel.aov]) continue;
        const Rows rows(grid, channels, channel);
        const auto fill = [&](auto value) {
            for (std::size_t i = 0; i < points.count; ++i) rows.write(i, value(i));
        };
        const auto copy = [&](const std::vector<Vec3f>& values) {
            for (std::size_t i = 0; i < values.size(); ++i) rows.write(i, values[i]);
        };
        switch (channel.quantity) {
            case Quantity::DiffuseDirect:
                copy(shaded.parts.diffuse);
                break;
            case Quantity::DiffuseIndirect:
                copy(shaded.parts.diffuse_bounced);
                break;
            case Quantity::DiffuseColor:
                copy(shaded.parts.diffuse_color);
                break;
            case Quantity::GlossyDirect:
                copy(shaded.parts.glossy);
                break;
            case Quantity::GlossyIndirect:
                copy(shaded.parts.glossy_bounced);
                break;
            case Quantity::GlossyColor:
                copy(shaded.parts.glossy_color);
                break;
            case Quantity::TransmissionDirect:
                copy(shaded.parts.transmission);
                break;
            case Quantity::TransmissionIndirect:
                copy(shaded.parts.transmission_bounced);
                break;
            case Quantity::TransmissionColor:
                copy(shaded.parts.transmission_color);
                break;
            case Quantity::Albedo:
                fill([&](std::size_t i) {
                    return shaded.parts.diffuse_color[i] + shaded.parts.glossy_color[i] +
                           shaded.parts.transmission_color[i];
                });
                break;
            case Quantity::LampsArriving:
                copy(shaded.parts.arriving);
                break;
            case Quantity::LampsUnblocked:
                copy(shaded.parts.unblocked);
                break;
            case Quantity::Emission:
                copy(shaded.closure.emission);
                break;
            case Quantity::Clarity:
                fill([&](std::size_t i) {
                    return clarity(scene.options.mist, grid.shading_p()[i], camera.perspective,
                                   mean(opacity_of(grid, i)));
                });
                break;
            case Quantity::Normal:
                fill([&](std::size_t i) { return average_normal(points, shaded.closure, i); });
                break;
            case Quantity::Uv: {
                const auto uv = shaded.run.read(shaded.sources.uv);
                const GeometryData& geometry = scene.geometry_of(scene.instances[grid.instance]);
                const float mapped = geometry.default_uv() ? 1.0f : 0.0f;
                fill([&](std::size_t i) { return Vec3f(uv[i].x, uv[i].y, mapped); });
                break;
            }
            case Quantity::AovColor: {
                const auto color = shaded.run.read(shaded.sources.aov_colors[channel.aov]);
                fill([&](std::size_t i) { return Vec4f(color[i], 1.0f); });
                break;
            }
            case Quantity::AovValue: {
                const auto value = shaded.run.read(shaded.sources.aov_values[channel.aov]);
                fill([&](std::size_t i) { return value[i]; });
                break;
            }
            case Quantity::Speed: {
                const Speed speed(scene, scene.instances[grid.instance]);
                const auto now = shaded.run.read(shaded.sources.now);
                const auto previous = shaded.run.read(shaded.sources.previous);
                const auto next = shaded.run.read(shaded.sources.next);
                fill([&](std::size_t i) { return speed.at(now[i], previous[i], next[i]); });
                break;
            }
            case Quantity::Composed:
                fill([&](std::size_t i) { return opacity_of(grid, i); });
                break;
            case Quantity::Surface:
                fill([&](std::size_t) { return Vec4f(1.0f); });
                break;
            case Quantity::Position: {
                const Vec3d origin(camera.world_from_camera[3]);
                fill([&](std::size_t i) { return Vec3f(origin + Vec3d(points.p[i])); });
                break;
            }
            case Quantity::ObjectIndex: {
                const auto index = static_cast<float>(scene.instances[grid.instance].object_index);
                fill([&](std::size_t) { return index; });
                break;
            }
            case Quantity::MaterialIndex: {
                const int index = grid.material < 0 ? 0 : scene.materials[grid.material].index;
                fill([&](std::size_t) { return static_cast<float>(index); });
                break;
            }
            case Quantity::Caught:  // by fill_caught()
            case Quantity::VolumeDirect:
            case Quantity::VolumeIndirect:
            case Quantity::Environment:
                break;
        }
    }
    for (float& value : grid.channels)
        if (!std::isfinite(value)) value = 0.0f;  // its material is named by who shades the grid
    interpolate_points(grid, channels.vertex_width(), grid.channels);
}

void fill_caught(Grid& grid, const ChannelSet& channels) {
    for (const Channel& channel : channels.channels()) {
        if (channel.quantity == Quantity::Environment) continue;
        const Rows rows(grid, channels, channel);
        for (std::size_t v = 0; v < grid.radiance.size(); ++v) {
            if (channel.quantity == Quantity::Caught)
                rows.write(v, Vec3f(1.0f) - grid.radiance[v]);
            else if (channel.quantity == Quantity::Composed || is_light(channel.quantity))
                rows.write(v, Vec3f(0.0f));
        }
    }
}

}  // namespace granita
