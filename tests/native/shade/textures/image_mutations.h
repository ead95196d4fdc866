// SPDX-License-Identifier: GPL-3.0-or-later
// Small images of every format that is read, and what a disk or a stranger may have made of them.
#pragma once

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

namespace granita {

struct SeedFormat {
    const char* suffix;
    int channels;
    OIIO::TypeDesc::BASETYPE type;
    const char* compression;
    int tile;
};

inline const SeedFormat kSeedFormats[] = {
    {".png", 4, OIIO::TypeDesc::UINT8, "", 0},      {".png", 3, OIIO::TypeDesc::UINT16, "", 0},
    {".jpg", 3, OIIO::TypeDesc::UINT8, "", 0},      {".tif", 3, OIIO::TypeDesc::UINT8, "lzw", 0},
    {".tif", 4, OIIO::TypeDesc::UINT16, "zip", 16}, {".tif", 3, OIIO::TypeDesc::FLOAT, "none", 0},
    {".tif", 3, OIIO::TypeDesc::UINT8, "jpeg", 0},  {".exr", 3, OIIO::TypeDesc::HALF, "zip", 0},
    {".exr", 4, OIIO::TypeDesc::FLOAT, "piz", 16},  {".exr", 4, OIIO::TypeDesc::HALF, "dwaa", 0},
    {".exr", 4, OIIO::TypeDesc::HALF, "rle", 0},    {".exr", 3, OIIO::TypeDesc::HALF, "b44", 0},
    {".hdr", 3, OIIO::TypeDesc::FLOAT, "", 0},      {".tga", 4, OIIO::TypeDesc::UINT8, "", 0},
    {".tga", 3, OIIO::TypeDesc::UINT8, "rle", 0},   {".bmp", 3, OIIO::TypeDesc::UINT8, "", 0},
    {".webp", 4, OIIO::TypeDesc::UINT8, "", 0},     {".gif", 3, OIIO::TypeDesc::UINT8, "", 0},
    {".ppm", 3, OIIO::TypeDesc::UINT8, "", 0},      {".jp2", 3, OIIO::TypeDesc::UINT8, "", 0}};

inline bool write_seed(const SeedFormat& format, const std::string& path) {
    constexpr int kWidth = 67, kHeight = 65;
    const auto out = OIIO::ImageOutput::create(path);
    if (!out) return false;
    OIIO::ImageSpec spec(kWidth, kHeight, format.channels, format.type);
    spec.tile_width = spec.tile_height = format.tile;
    if (*format.compression) spec.attribute("compression", format.compression);
    std::vector<float> texels;
    for (int i = 0; i < kWidth * kHeight * format.channels; ++i)
        texels.push_back(static_cast<float>(i * 37 % 101) / 101.0f);
    return out->open(path, spec) && out->write_image(OIIO::TypeFloat, texels.data()) &&
           out->close();
}

/// Checksums made right, or a reader would look no further.
inline void seal_png(std::vector<std::uint8_t>& png) {
    const auto number = [&](std::size_t at) {
        return std::uint32_t{png[at]} << 24 | std::uint32_t{png[at + 1]} << 16 |
               std::uint32_t{png[at + 2]} << 8 | png[at + 3];
    };
    for (std::size_t at = 8; at + 12 <= png.size();) {
        const std::size_t length = number(at);
        if (length > png.size() || at + 12 + length > png.size()) break;
        std::uint32_t crc = 0xffffffffu;
        for (std::size_t i = at + 4; i < at + 8 + length; ++i) {
            crc ^= png[i];
            for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1u ? 0xedb88320u : 0u);
        }
        crc = ~crc;
        for (int k = 0; k < 4; ++k)
            png[at + 8 + length + k] = static_cast<std::uint8_t>(crc >> (24 - 8 * k));
        at += 12 + length;
    }
}

/// One to six faults: bits, bytes, numbers, a missing end, parts copied elsewhere; every second one
/// in the header.
inline std::vector<std::uint8_t> mutated(std::vector<std::uint8_t> bytes, std::mt19937& random) {
    const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
    for (std::size_t fault = 1 + below(6); fault > 0 && !bytes.empty(); --fault) {
        const std::size_t at =
            below(2) ? below(bytes.size()) : below(std::min<std::size_t>(bytes.size(), 200));
        const std::size_t rest = bytes.size() - at;
        switch (below(6)) {
            case 0:
                bytes[at] ^= static_cast<std::uint8_t>(1u << below(8));
                break;
            case 1:
                bytes[at] = static_cast<std::uint8_t>(random());
                break;
            case 2:
                bytes[at] = below(2) ? 0xff : 0x00;
                break;
            case 3:
                std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                            std::min<std::size_t>(4, rest),
                            static_cast<std::uint8_t>(below(3) ? 0xff : 0x7f));
                break;
            case 4:
                if (below(4) == 0) bytes.resize(1 + below(bytes.size()));
                break;
            default: {
                const std::size_t from = below(bytes.size());
                const std::size_t count = std::min({1 + below(32), bytes.size() - from, rest});
                std::memmove(&bytes[at], &bytes[from], count);
            }
        }
    }
    if (bytes.size() > 8 && bytes[1] == 'P' && bytes[2] == 'N') seal_png(bytes);
    return bytes;
}

}  // namespace granita
