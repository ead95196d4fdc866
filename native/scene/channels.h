// SPDX-License-Identifier: GPL-3.0-or-later
// The table of passes: what an artist may ask for beside Combined, which channels it is made of,
// and how a channel gets from the vertices of grids to pixels.
//
//   pass      what leaves the film under a name: one channel, or the ratio of two
//   channel   1, 3 or 4 floats that shading leaves at vertices (Grid::channels), compositing
//             interpolates at samples, and the film filters
//
// Visibility is found once, whatever is asked: samples remember what they saw.
#pragma once

#include <string>
#include <vector>

#include "scene/options.h"

namespace granita {

enum class Quantity {
    DiffuseDirect,    ///< radiance of lamps and the world that diffuse lobes reflect
    DiffuseIndirect,  ///< of other surfaces
    DiffuseColor,     ///< their albedo
    GlossyDirect,
    GlossyIndirect,
    GlossyColor,
    TransmissionDirect,
    TransmissionIndirect,
    TransmissionColor,
    Albedo,        ///< the three colours together, which denoisers ask for
    VolumeDirect,  ///< light that media scatter; surfaces have none
    VolumeIndirect,
    Emission,        ///< of surfaces and media
    LampsArriving,   ///< radiance reflected of lamps
    LampsUnblocked,  ///< the same without shadows
    Caught,          ///< 1 - what is left of a shadow catcher's light
    Composed,        ///< opacity of what is no shadow catcher, media too
    Clarity,         ///< (1 - mist) opacity
    Normal,          ///< unit, world space, of the lobes (bumps included), faced to the viewer
    Uv,              ///< (u, v, 1) of the UV map active for render
    AovColor,        ///< (r, g, b, 1)
    AovValue,
    Position,  ///< world space, metres
    ObjectIndex,
    MaterialIndex,
    Speed,    ///< pixels from here to the place one frame before, and to here from the one after
    Surface,  ///< 1, four times: what Speed is divided by
    Environment,  ///< the world as the camera sees it; known at samples alone
};

/// How the layers of a sample become its value, and samples a pixel.
enum class Merge {
    /// Premultiplied, over each other and filtered, as Combined.
    Layers,
    /// Of the first layer whose opacity reaches Options::pass_alpha_threshold, 0 without one;
    /// filtered.
    First,
    /// The same layer, of the one sample nearest to the pixel's centre.
    Center,
    /// As Center, and constant over a micropolygon: of its first corner.
    CenterConstant,
};

struct Channel {
    Quantity quantity;
    Merge merge;
    int width;
    int aov = -1;   ///< index in Options::aovs
    int first = 0;  ///< of the row that holds it, see ChannelSet
};

struct Pass {
    std::string name;
    int width;
    int channel;       ///< index in ChannelSet::channels()
    int divisor = -1;  ///< likewise: the pass is the ratio of both after filtering
    /// 1 less the channel, and the divisor is 1 less its own.
    bool complement = false;
};

/// The channels that a frame's passes need.  Rows of floats, each without gaps:
///
///   vertex   [Layers | First | Center and CenterConstant]     of Grid::channels
///   sample   [Layers | First | Environment]                   filtered
///   pixel    [Center and CenterConstant]                      not filtered
class ChannelSet {
  public:
    /// Throws SceneError for a pass that is not in the table and for names given twice.  Combined
    /// and Depth are not channels; they may be named.
    explicit ChannelSet(const Options& options);

    bool empty() const { return m_channels.empty(); }
    const std::vector<Channel>& channels() const { return m_channels; }
    const std::vector<Pass>& passes() const { return m_passes; }
    /// nullptr where it is not needed.
    const Channel* find(Quantity quantity, int aov = -1) const;

    int vertex_width() const { return m_filtered + m_center; }
    int layers_width() const { return m_layers; }     ///< of a sample's row, from its start
    int surface_width() const { return m_filtered; }  ///< what surfaces give of it
    int sample_width() const { return m_filtered + (m_environment ? 3 : 0); }
    int center_width() const { return m_center; }
    bool has_environment() const { return m_environment; }
    /// Which opacity a float of a sample's [Layers] is attenuated by: 0 to 2 = a channel, 3 = mean.
    const std::vector<unsigned char>& layer_components() const { return m_components; }

  private:
    int need(Quantity quantity, Merge merge, int width, int aov = -1);
    void place();

    std::vector<Channel> m_channels;
    std::vector<Pass> m_passes;
    std::vector<unsigned char> m_components;
    int m_layers = 0, m_filtered = 0, m_center = 0;
    bool m_environment = false;
};

}  // namespace granita
