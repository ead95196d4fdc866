// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/textures/texture_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <exception>
#include <string_view>
#include <utility>

#include "shade/textures/image_format.h"
#include "shade/textures/openexr_header.h"

namespace granita {

namespace {

/// Images beyond these are refused: no header can ask for more memory or time than that.
constexpr int kMostTexelsAside = 1 << 16;
constexpr std::int64_t kMostTexels = std::int64_t{1} << 30;
constexpr int kMostChannels = 64;
/// A tile of a file is read whole, and tiles that are not served a row of them at a time.
constexpr int kLargestTile = 4096, kLargestServedTile = 512;
constexpr std::uint64_t kMostBytesAtOnce = std::uint64_t{512} << 20;
/// A file's own levels are used where they end in so few texels.
constexpr int kLastLevel = 64;

/// Of a row of tiles as texels, and of a tile as it is stored.
std::uint64_t bytes_at_once(const OIIO::ImageSpec& spec) {
    if (spec.tile_width == 0) return 0;
    const auto row =
        static_cast<std::uint64_t>(spec.width) * static_cast<std::uint64_t>(spec.tile_height);
    return std::max<std::uint64_t>(row * sizeof(Vec4f), spec.tile_bytes(true));
}

}  // namespace

TextureFile::TextureFile(const Image& image) {
    try {
        if (!open(image) && m_header.error.empty()) m_header.error = "it cannot be opened";
    } catch (const std::exception& failure) {
        m_header.error = failure.what();
    }
    if (!error().empty()) m_input.reset();
}

bool TextureFile::open(const Image& image) {
    const ImageFormat format = image_format(image.path);
    m_header.error = format.error;
    if (!format.reader) return false;
    if (std::string_view(format.reader) == "openexr" && !openexr_header_fits(image.path)) {
        m_header.error = "its header is damaged";
        return false;
    }
    m_input = OIIO::ImageInput::create(format.reader);
    if (!m_input) {
        m_header.error = OIIO::geterror();
        return false;
    }
    // Cycles: colour channels of data, packed channels and ignored alpha are left untouched; others
    // arrive associated, since 5.1 by what is said of them instead of by the file.
    OIIO::ImageSpec config;
    const std::string& alpha = image.alpha_mode;
    const bool opaque = alpha == "NONE";
    const bool untouched =
        image.space->is_data || opaque || alpha == "CHANNEL_PACKED" || alpha == "ASSOCIATED";
    const bool by_us = std::string_view(format.reader) == "png" || alpha == "UNASSOCIATED";
    if (untouched || by_us) config.attribute("oiio:UnassociatedAlpha", 1);
    if (!m_input->open(image.path, m_spec, config)) {
        m_header.error = m_input->geterror();
        return false;
    }
    if (!check(m_spec)) return false;
    m_channels = std::min(m_spec.nchannels, 4);
    const bool has_alpha = m_channels == 2 || m_channels == 4;
    m_associate = by_us && !untouched && has_alpha;
    m_raw_type = m_spec.format == OIIO::TypeUInt8  ? TexelType::Byte
                 : m_spec.format == OIIO::TypeHalf ? TexelType::Half
                                                   : TexelType::Float;
    m_converter = TexelConverter({.space = image.space,
                                  .type = m_raw_type,
                                  .channels = m_channels,
                                  .opaque = opaque,
                                  .is_associated = has_alpha && image.has_products()});
    m_header.width = m_spec.width;
    m_header.height = m_spec.height;
    m_header.has_alpha = has_alpha && !opaque;
    m_header.encoded = m_converter.encoded();
    m_header.type = m_converter.type();
    if (m_spec.tile_width > 0) m_strip = m_spec.tile_height;
    find_levels();
    return true;
}

/// Before anything is made as large as the header says.
bool TextureFile::check(const OIIO::ImageSpec& spec) {
    if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1) {
        m_header.error = "it has no pixels";
    } else if (spec.width > kMostTexelsAside || spec.height > kMostTexelsAside ||
               std::int64_t{spec.width} * spec.height > kMostTexels) {
        m_header.error = "its header says " + std::to_string(spec.width) + " x " +
                         std::to_string(spec.height) + " pixels, which is too many";
    } else if (spec.depth > 1 || spec.deep || spec.nchannels > kMostChannels) {
        m_header.error = "it is no flat picture";
    } else if (spec.tile_width < 0 || spec.tile_height < 0 || spec.tile_width > kLargestTile ||
               spec.tile_height > kLargestTile || (spec.tile_width > 0) != (spec.tile_height > 0)) {
        m_header.error = "its tiles have no possible size";
    } else if (bytes_at_once(spec) > kMostBytesAtOnce) {
        m_header.error = "its tiles are too large";
    }
    return m_header.error.empty();
}

void TextureFile::find_levels() {
    const auto serves = [](const OIIO::ImageSpec& spec) {
        const auto fits = [](int size) {
            return size >= 16 && size <= kLargestServedTile &&
                   std::has_single_bit(static_cast<unsigned>(size));
        };
        return fits(spec.tile_width) && fits(spec.tile_height);
    };
    std::vector<FileLevel> levels;
    OIIO::ImageSpec spec = m_spec;
    while (serves(spec) && spec.nchannels == m_spec.nchannels && spec.format == m_spec.format &&
           spec.depth <= 1) {
        // Levels are about half the one before: a file that says otherwise is served as one image.
        if (!levels.empty()) {
            const auto halves = [](int fine, int coarse) {
                return coarse == std::max(1, fine / 2) || coarse == (fine + 1) / 2;
            };
            if (!halves(levels.back().width, spec.width) ||
                !halves(levels.back().height, spec.height))
                break;
        }
        levels.push_back({spec.width, spec.height,
                          std::countr_zero(static_cast<unsigned>(spec.tile_width)),
                          std::countr_zero(static_cast<unsigned>(spec.tile_height))});
        if (spec.width == 1 && spec.height == 1) break;
        spec = m_input->spec(0, static_cast<int>(levels.size()));
        if (spec.format == OIIO::TypeUnknown || spec.width < 1 || spec.height < 1) break;
    }
    (void)m_input->geterror();
    if (levels.size() > 1 && levels.back().width <= kLastLevel &&
        levels.back().height <= kLastLevel)
        m_levels = std::move(levels);
}

/// As it is stored where that is known: for anything else OpenImageIO takes 16 MiB a call.
OIIO::TypeDesc TextureFile::raw_type() const {
    const bool is_stored = m_spec.channelformats.empty() &&
                           (m_spec.format == OIIO::TypeUInt8 || m_spec.format == OIIO::TypeHalf ||
                            m_spec.format == OIIO::TypeFloat);
    return is_stored                       ? OIIO::TypeUnknown
           : m_raw_type == TexelType::Byte ? OIIO::TypeUInt8
           : m_raw_type == TexelType::Half ? OIIO::TypeHalf
                                           : OIIO::TypeFloat;
}

void* TextureFile::raw_memory(std::size_t texels) {
    m_raw.resize(texels * m_channels * byte_size(m_raw_type) / 4);
    return m_raw.data();
}

bool TextureFile::read_rows(int begin, int count, std::byte* out) {
    const std::size_t texels = static_cast<std::size_t>(m_spec.width) * count;
    void* raw = raw_memory(texels);
    const int top = m_spec.y + begin, left = m_spec.x;
    const bool complete =
        m_spec.tile_width > 0
            ? m_input->read_tiles(0, 0, left, left + m_spec.width, top, top + count, m_spec.z,
                                  m_spec.z + 1, 0, m_channels, raw_type(), raw)
            : m_input->read_scanlines(0, 0, top, top + count, m_spec.z, 0, m_channels, raw_type(),
                                      raw);
    if (complete) {
        convert(raw, texels, out);
    } else {
        m_header.error = m_input->geterror();
        if (m_header.error.empty()) m_header.error = "it is incomplete";
    }
    return complete;
}

bool TextureFile::read_tile(int level, int across, int down, std::byte* out) {
    const FileLevel& size = m_levels[static_cast<std::size_t>(level)];
    const OIIO::ImageSpec spec = m_input->spec_dimensions(0, level);
    const int x0 = across << size.tile_columns, y0 = down << size.tile_rows;
    const int x1 = std::min(x0 + (1 << size.tile_columns), size.width);
    const int y1 = std::min(y0 + (1 << size.tile_rows), size.height);
    const std::size_t texels = static_cast<std::size_t>(x1 - x0) * (y1 - y0);
    void* raw = raw_memory(texels);
    if (!m_input->read_tiles(0, level, spec.x + x0, spec.x + x1, spec.y + y0, spec.y + y1, spec.z,
                             spec.z + 1, 0, m_channels, raw_type(), raw)) {
        m_header.error = m_input->geterror();
        return false;
    }
    convert(raw, texels, out);
    return true;
}

/// Colour times alpha, of the numbers as they are stored: so do Blender and Cycles.  OpenImageIO's
/// own reader of PNG does so in 2.4, bytes rounded down, and multiplies light in 2.5.
void TextureFile::associate(void* raw, std::size_t count) const {
    const int alpha = m_channels - 1;
    const auto multiply = [&](auto* texel, auto product) {
        for (std::size_t i = 0; i < count; ++i, texel += m_channels)
            for (int c = 0; c < alpha; ++c) texel[c] = product(texel[c], texel[alpha]);
    };
    if (m_raw_type == TexelType::Byte)
        multiply(static_cast<std::uint8_t*>(raw),
                 [](int x, int a) { return static_cast<std::uint8_t>(x * a / 255); });
    else if (m_raw_type == TexelType::Half)
        multiply(static_cast<std::uint16_t*>(raw), [](std::uint16_t x, std::uint16_t a) {
            return half_from_float(float_from_half(x) * float_from_half(a));
        });
    else
        multiply(static_cast<float*>(raw), [](float x, float a) { return x * a; });
}

void TextureFile::convert(void* raw, std::size_t count, std::byte* out) const {
    if (m_associate) associate(raw, count);
    m_converter.convert(raw, count, out);
}

}  // namespace granita
