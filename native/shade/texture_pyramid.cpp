// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/texture_pyramid.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace granita {

namespace {

/// Colour spaces whose values are used as they are.
bool is_linear_space(const std::string& name) {
    static const std::array<const char*, 7> kLinear = {
        "Non-Color", "Raw", "Linear", "Linear Rec.709", "scene_linear", "Linear BT.709", "data"};
    return std::find(kLinear.begin(), kLinear.end(), name) != kLinear.end();
}

bool is_data_space(const std::string& name) {
    return name == "Non-Color" || name == "Raw";
}

std::unique_ptr<OIIO::ImageInput> open_file(const Image& image) {
    // Cycles: colour channels of data, packed channels and ignored alpha are left untouched; others
    // arrive associated.
    OIIO::ImageSpec config;
    const bool untouched = is_data_space(image.colorspace) ||
                           image.alpha_mode == "CHANNEL_PACKED" || image.alpha_mode == "NONE";
    if (untouched) config.attribute("oiio:UnassociatedAlpha", 1);
    return OIIO::ImageInput::open(image.path, &config);
}

TexelKind kind_of(const Image& image, bool byte) {
    if (is_linear_space(image.colorspace))
        return byte ? TexelKind::LinearByte : TexelKind::LinearFloat;
    return byte ? TexelKind::EncodedByte : TexelKind::LinearFloat;
}

/// Grey, grey and alpha, rgb: to rgba.
template <class T>
void expand_channels(const std::vector<T>& from, int channels, T one, std::vector<T>& to) {
    const std::size_t texels = from.size() / channels;
    to.resize(texels * 4);
    for (std::size_t i = 0; i < texels; ++i) {
        const T* c = &from[i * channels];
        for (int k = 0; k < 3; ++k) to[i * 4 + k] = channels >= 3 ? c[k] : c[0];
        to[i * 4 + 3] = channels >= 4 ? c[3] : channels == 2 ? c[1] : one;
    }
}

void read_file(const Image& image, TexturePyramid& pyramid) {
    const auto input = open_file(image);
    if (!input) {
        pyramid.error = OIIO::geterror();
        return;
    }
    const OIIO::ImageSpec& spec = input->spec();
    const bool byte = spec.format == OIIO::TypeUInt8;
    pyramid.kind = kind_of(image, byte);
    TextureLevel level;
    level.width = spec.width;
    level.height = spec.height;
    const int channels = std::min(spec.nchannels, 4);
    const std::size_t values = static_cast<std::size_t>(spec.width) * spec.height * channels;
    bool complete = false;
    if (byte) {
        std::vector<std::uint8_t> raw(values);
        complete = input->read_image(0, 0, 0, channels, OIIO::TypeUInt8, raw.data());
        expand_channels<std::uint8_t>(raw, channels, 255, level.bytes);
    } else {
        std::vector<float> raw(values);
        complete = input->read_image(0, 0, 0, channels, OIIO::TypeFloat, raw.data());
        expand_channels(raw, channels, 1.0f, level.floats);
        // Files of more than 8 bits are decoded before they are filtered, as in Cycles.
        if (spec.format == OIIO::TypeUInt16 && !is_linear_space(image.colorspace)) {
            for (std::size_t i = 0; i < level.floats.size(); ++i)
                if (i % 4 != 3) level.floats[i] = linear_from_srgb(level.floats[i]);
        }
    }
    if (!complete) {
        pyramid.error = input->geterror();
        if (pyramid.error.empty()) pyramid.error = "incomplete file";
        return;
    }
    if (image.alpha_mode == "NONE") {
        for (std::size_t i = 3; i < level.bytes.size(); i += 4) level.bytes[i] = 255;
        for (std::size_t i = 3; i < level.floats.size(); i += 4) level.floats[i] = 1.0f;
    }
    pyramid.levels.push_back(std::move(level));
}

void take_pixels(const Image& image, TexturePyramid& pyramid) {
    pyramid.kind =
        is_linear_space(image.colorspace) ? TexelKind::LinearFloat : TexelKind::EncodedFloat;
    TextureLevel level;
    level.width = image.width;
    level.height = image.height;
    level.floats.resize(image.pixels.size());
    const std::size_t row = static_cast<std::size_t>(image.width) * 4;
    for (int y = 0; y < image.height; ++y) {
        const auto from = image.pixels.begin() + (image.height - 1 - y) * row;
        std::copy(from, from + row, level.floats.begin() + y * row);
    }
    if (is_encoded(pyramid.kind)) {
        for (std::size_t i = 0; i < level.floats.size(); ++i)
            if (i % 4 != 3) level.floats[i] = srgb_from_linear(level.floats[i]);
    }
    pyramid.levels.push_back(std::move(level));
}

std::array<float, 256> decode_table() {
    std::array<float, 256> table{};
    for (int i = 0; i < 256; ++i) table[i] = linear_from_srgb(static_cast<float>(i) / 255.0f);
    return table;
}

float linear_texel(const TextureLevel& level, TexelKind kind, std::size_t index, int channel) {
    static const std::array<float, 256> kDecode = decode_table();
    if (is_byte(kind)) {
        const std::uint8_t byte = level.bytes[index];
        return is_encoded(kind) && channel < 3 ? kDecode[byte] : static_cast<float>(byte) / 255.0f;
    }
    const float value = level.floats[index];
    return is_encoded(kind) && channel < 3 ? linear_from_srgb(value) : value;
}

}  // namespace

float srgb_from_linear(float x) {
    if (x < 0.0031308f) return x < 0.0f ? 0.0f : x * 12.92f;
    return 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
}

float linear_from_srgb(float x) {
    if (x < 0.04045f) return x < 0.0f ? 0.0f : x / 12.92f;
    return std::pow((x + 0.055f) / 1.055f, 2.4f);
}

TextureHeader read_texture_header(const Image& image) {
    TextureHeader header;
    if (!image.pixels.empty()) {
        header.width = image.width;
        header.height = image.height;
        header.kind =
            is_linear_space(image.colorspace) ? TexelKind::LinearFloat : TexelKind::EncodedFloat;
        return header;
    }
    const auto input = open_file(image);
    if (!input) {
        header.error = OIIO::geterror();
        if (header.error.empty()) header.error = "cannot be opened";
        return header;
    }
    header.width = input->spec().width;
    header.height = input->spec().height;
    header.kind = kind_of(image, input->spec().format == OIIO::TypeUInt8);
    return header;
}

std::uint64_t TexturePyramid::byte_count() const {
    std::uint64_t bytes = sizeof(*this);
    for (const TextureLevel& level : levels)
        bytes += level.bytes.size() + level.floats.size() * sizeof(float);
    return bytes;
}

TextureLevel half_level(const TextureLevel& level, TexelKind kind) {
    TextureLevel half;
    half.width = std::max(1, level.width / 2);
    half.height = std::max(1, level.height / 2);
    const std::size_t values = static_cast<std::size_t>(half.width) * half.height * 4;
    if (is_byte(kind)) {
        half.bytes.resize(values);
    } else {
        half.floats.resize(values);
    }
    const double step_x = static_cast<double>(level.width) / half.width;
    const double step_y = static_cast<double>(level.height) / half.height;
    for (int y = 0; y < half.height; ++y) {
        const double y0 = y * step_y, y1 = y0 + step_y;
        for (int x = 0; x < half.width; ++x) {
            const double x0 = x * step_x, x1 = x0 + step_x;
            std::array<double, 4> sum{};
            // Odd sizes: texels at the rim count by the part that is covered.
            for (int v = static_cast<int>(y0); v < level.height && v < y1; ++v) {
                const double wy = std::min<double>(v + 1, y1) - std::max<double>(v, y0);
                for (int u = static_cast<int>(x0); u < level.width && u < x1; ++u) {
                    const double w = wy * (std::min<double>(u + 1, x1) - std::max<double>(u, x0));
                    const std::size_t texel = (static_cast<std::size_t>(v) * level.width + u) * 4;
                    for (int c = 0; c < 4; ++c)
                        sum[c] += w * linear_texel(level, kind, texel + c, c);
                }
            }
            const std::size_t out = (static_cast<std::size_t>(y) * half.width + x) * 4;
            for (int c = 0; c < 4; ++c) {
                float mean = static_cast<float>(sum[c] / (step_x * step_y));
                if (is_encoded(kind) && c < 3) mean = srgb_from_linear(mean);
                if (is_byte(kind)) {
                    half.bytes[out + c] =
                        static_cast<std::uint8_t>(std::clamp(mean * 255.0f + 0.5f, 0.0f, 255.0f));
                } else {
                    half.floats[out + c] = mean;
                }
            }
        }
    }
    return half;
}

std::shared_ptr<const TexturePyramid> build_texture_pyramid(const Image& image) {
    auto pyramid = std::make_shared<TexturePyramid>();
    if (image.pixels.empty()) {
        read_file(image, *pyramid);
    } else {
        take_pixels(image, *pyramid);
    }
    if (!pyramid->error.empty()) return pyramid;
    while (pyramid->levels.back().width > 1 || pyramid->levels.back().height > 1)
        pyramid->levels.push_back(half_level(pyramid->levels.back(), pyramid->kind));
    return pyramid;
}

}  // namespace granita
