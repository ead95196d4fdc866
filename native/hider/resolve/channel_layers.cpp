// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/resolve/channel_layers.h"

#include "base/check.h"

namespace granita {
namespace {

/// A grid's three rows and their weights.
struct RowMix {
    const float *a, *b, *c;
    float wa, wb, wc;

    RowMix(const SurfacePoint& at, int width)
        : a(row(at, 0, width)),
          b(row(at, 1, width)),
          c(row(at, 2, width)),
          wa(at.weight[0]),
          wb(at.weight[1]),
          wc(at.weight[2]) {}
    float operator()(int k) const { return wa * a[k] + wb * b[k] + wc * c[k]; }

  private:
    static const float* row(const SurfacePoint& at, int corner, int width) {
        return at.grid->channels.data() +
               static_cast<std::size_t>(at.vertex[corner]) * static_cast<std::size_t>(width);
    }
};

}  // namespace

ChannelLayers::ChannelLayers(const ChannelSet& channels, const TileSamples& samples,
                             SampleChannels& out)
    : m_channels(channels),
      m_out(out),
      m_centers(center_samples(samples)),
      m_samples(static_cast<std::uint32_t>(samples.samples)) {
    for (const Channel& channel : channels.channels())
        if (channel.merge == Merge::Center) m_interpolated_center += channel.width;
    out.filtered.assign(samples.x.size() * channels.sample_width() + SampleChannels::kPadding,
                        0.0f);
    out.center.assign(m_centers.size() * channels.center_width(), 0.0f);
}

void ChannelLayers::add(std::uint32_t sample, const SurfacePoint& at, const Vec3d& transmission) {
    const int layers = m_channels.layers_width();
    if (layers == 0) return;
    GRANITA_CHECK(!at.grid->channels.empty());
    const RowMix mix(at, m_channels.vertex_width());
    float* const out =
        m_out.filtered.data() + static_cast<std::size_t>(sample) * m_channels.sample_width();
    if (transmission == Vec3d(1.0)) {
        for (int k = 0; k < layers; ++k) out[k] += mix(k);
        return;
    }
    const float share[4] = {
        static_cast<float>(transmission.x), static_cast<float>(transmission.y),
        static_cast<float>(transmission.z),
        static_cast<float>((transmission.x + transmission.y + transmission.z) / 3.0)};
    const unsigned char* const component = m_channels.layer_components().data();
    for (int k = 0; k < layers; ++k) out[k] += share[component[k]] * mix(k);
}

void ChannelLayers::set_first(std::uint32_t sample, const SurfacePoint& at) {
    if (m_channels.vertex_width() == 0) return;  // the environment alone is asked for
    GRANITA_CHECK(!at.grid->channels.empty());
    const RowMix mix(at, m_channels.vertex_width());
    const int surface = m_channels.surface_width();
    float* const out =
        m_out.filtered.data() + static_cast<std::size_t>(sample) * m_channels.sample_width();
    for (int k = m_channels.layers_width(); k < surface; ++k) out[k] = mix(k);
    const std::uint32_t pixel = sample / m_samples;
    if (m_centers[pixel] != sample) return;
    const int width = m_channels.center_width();
    float* const center = m_out.center.data() + static_cast<std::size_t>(pixel) * width;
    for (int k = 0; k < width; ++k)
        center[k] = k < m_interpolated_center ? mix(surface + k) : mix.a[surface + k];
}

void ChannelLayers::add_volume(std::uint32_t sample, const SampleVolume& volume,
                               const Vec3d& transmission) {
    float* const row =
        m_out.filtered.data() + static_cast<std::size_t>(sample) * m_channels.sample_width();
    const auto add = [&](Quantity quantity, const Vec3f& light) {
        const Channel* const channel = m_channels.find(quantity);
        if (!channel) return;
        for (int c = 0; c < 3; ++c)
            row[channel->first + c] += static_cast<float>(transmission[c] * light[c]);
    };
    add(Quantity::Emission, volume.emitted);
    add(Quantity::VolumeDirect, volume.direct);
    add(Quantity::VolumeIndirect, volume.indirect);
    add(Quantity::Composed, Vec3f(1.0f) - volume.transmittance);
}

void ChannelLayers::add_environment(std::uint32_t sample, const Vec3f& radiance,
                                    const Vec3d& transmission) {
    if (!m_channels.has_environment()) return;
    float* const out = m_out.filtered.data() +
                       static_cast<std::size_t>(sample) * m_channels.sample_width() +
                       m_channels.surface_width();
    for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(transmission[c] * radiance[c]);
}

}  // namespace granita
