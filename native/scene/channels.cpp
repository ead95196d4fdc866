// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/channels.h"

#include <algorithm>
#include <optional>

#include "base/error.h"

namespace granita {
namespace {

struct PassKind {
    const char* name;
    Quantity quantity;
    Merge merge;
    int width;
    std::optional<Quantity> divisor{};
    bool complement = false;
};

/// What Cycles filters is filtered, what it takes of one sample is of one sample.
const PassKind kPasses[] = {
    {"Diffuse Direct", Quantity::DiffuseDirect, Merge::Layers, 3, Quantity::DiffuseColor},
    {"Diffuse Indirect", Quantity::DiffuseIndirect, Merge::Layers, 3, Quantity::DiffuseColor},
    {"Diffuse Color", Quantity::DiffuseColor, Merge::Layers, 3},
    {"Glossy Direct", Quantity::GlossyDirect, Merge::Layers, 3, Quantity::GlossyColor},
    {"Glossy Indirect", Quantity::GlossyIndirect, Merge::Layers, 3, Quantity::GlossyColor},
    {"Glossy Color", Quantity::GlossyColor, Merge::Layers, 3},
    {"Transmission Direct", Quantity::TransmissionDirect, Merge::Layers, 3,
     Quantity::TransmissionColor},
    {"Transmission Indirect", Quantity::TransmissionIndirect, Merge::Layers, 3,
     Quantity::TransmissionColor},
    {"Transmission Color", Quantity::TransmissionColor, Merge::Layers, 3},
    {"Volume Direct", Quantity::VolumeDirect, Merge::Layers, 3},
    {"Volume Indirect", Quantity::VolumeIndirect, Merge::Layers, 3},
    {"Denoising Albedo", Quantity::Albedo, Merge::Layers, 3},
    {"Denoising Normal", Quantity::Normal, Merge::First, 3},
    {"Emission", Quantity::Emission, Merge::Layers, 3},
    {"Environment", Quantity::Environment, Merge::Layers, 3},
    {"Shadow", Quantity::LampsArriving, Merge::Layers, 3, Quantity::LampsUnblocked},
    {"Shadow Catcher", Quantity::Caught, Merge::Layers, 3, Quantity::Composed, true},
    {"Mist", Quantity::Clarity, Merge::Layers, 1, {}, true},
    {"Normal", Quantity::Normal, Merge::First, 3},
    {"UV", Quantity::Uv, Merge::First, 3},
    {"Vector", Quantity::Speed, Merge::First, 4, Quantity::Surface},
    {"Position", Quantity::Position, Merge::Center, 3},
    {"Object Index", Quantity::ObjectIndex, Merge::CenterConstant, 1},
    {"Material Index", Quantity::MaterialIndex, Merge::CenterConstant, 1},
};

[[noreturn]] void fail_unknown(const std::string& name) {
    std::string known = "Combined, Depth";
    for (const PassKind& kind : kPasses) known += std::string(", ") + kind.name;
    throw SceneError("render settings", "pass '" + name + "' is unknown; known: " + known);
}

}  // namespace

ChannelSet::ChannelSet(const Options& options) {
    for (const std::string& name : options.passes) {
        if (name == "Combined" || name == "Depth") continue;
        const auto* kind = std::find_if(std::begin(kPasses), std::end(kPasses),
                                        [&](const PassKind& k) { return k.name == name; });
        if (kind == std::end(kPasses)) fail_unknown(name);
        Pass pass{kind->name, kind->width, need(kind->quantity, kind->merge, kind->width)};
        if (kind->divisor) pass.divisor = need(*kind->divisor, kind->merge, kind->width);
        pass.complement = kind->complement;
        m_passes.push_back(std::move(pass));
    }
    for (int i = 0; i < static_cast<int>(options.aovs.size()); ++i) {
        const Aov& aov = options.aovs[i];
        const int width = aov.is_color ? 4 : 1;
        const Quantity quantity = aov.is_color ? Quantity::AovColor : Quantity::AovValue;
        m_passes.push_back({aov.name, width, need(quantity, Merge::First, width, i)});
    }
    for (std::size_t i = 0; i < m_passes.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (m_passes[i].name == m_passes[j].name)
                throw SceneError("render settings",
                                 "two passes have the name '" + m_passes[i].name + "'");
    place();
}

const Channel* ChannelSet::find(Quantity quantity, int aov) const {
    for (const Channel& channel : m_channels)
        if (channel.quantity == quantity && channel.aov == aov) return &channel;
    return nullptr;
}

int ChannelSet::need(Quantity quantity, Merge merge, int width, int aov) {
    if (const Channel* known = find(quantity, aov))
        return static_cast<int>(known - m_channels.data());
    m_channels.push_back({quantity, merge, width, aov});
    return static_cast<int>(m_channels.size()) - 1;
}

void ChannelSet::place() {
    const auto place_merged = [&](Merge merge, int& end) {
        for (Channel& channel : m_channels) {
            if (channel.merge != merge || channel.quantity == Quantity::Environment) continue;
            channel.first = end;
            end += channel.width;
        }
    };
    place_merged(Merge::Layers, m_layers);
    for (const Channel& channel : m_channels)
        if (channel.merge == Merge::Layers && channel.quantity != Quantity::Environment)
            for (int c = 0; c < channel.width; ++c)
                m_components.push_back(static_cast<unsigned char>(channel.width == 1 ? 3 : c));
    m_filtered = m_layers;
    place_merged(Merge::First, m_filtered);
    place_merged(Merge::Center, m_center);
    place_merged(Merge::CenterConstant, m_center);
    for (Channel& channel : m_channels) {
        if (channel.quantity != Quantity::Environment) continue;
        channel.first = m_filtered;
        m_environment = true;
    }
}

}  // namespace granita
