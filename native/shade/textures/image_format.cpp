// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/textures/image_format.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>
#include <system_error>

namespace granita {

namespace {

using namespace std::string_view_literals;

struct Magic {
    std::string_view bytes;
    const char* reader;  ///< nullptr: known, not read
    const char* name;
};

constexpr Magic kMagics[] = {
    {"\x89PNG\r\n\x1a\n"sv, "png", "PNG"},
    {"\xff\xd8\xff"sv, "jpeg", "JPEG"},
    {"\x76\x2f\x31\x01"sv, "openexr", "OpenEXR"},
    {"II*\0"sv, "tiff", "TIFF"},
    {"MM\0*"sv, "tiff", "TIFF"},
    {"II+\0"sv, "tiff", "TIFF"},
    {"MM\0+"sv, "tiff", "TIFF"},
    {"#?"sv, "hdr", "Radiance"},
    {"BM"sv, "bmp", "BMP"},
    {"\0\0\0\x0cjP  \r\n\x87\n"sv, nullptr, "JPEG 2000"},
    {"\xff\x4f\xff\x51"sv, nullptr, "JPEG 2000"},
    {"GIF8"sv, "gif", "GIF"},
    {"P1"sv, "pnm", "PNM"},
    {"P2"sv, "pnm", "PNM"},
    {"P3"sv, "pnm", "PNM"},
    {"P4"sv, "pnm", "PNM"},
    {"P5"sv, "pnm", "PNM"},
    {"P6"sv, "pnm", "PNM"},
    {"PF"sv, "pnm", "PNM"},
    {"Pf"sv, "pnm", "PNM"},
    {"SDPX"sv, nullptr, "DPX"},
    {"XPDS"sv, nullptr, "DPX"},
    {"\x80\x2a\x5f\xd7"sv, nullptr, "Cineon"},
    {"\xd7\x5f\x2a\x80"sv, nullptr, "Cineon"},
    {"\x01\xda"sv, nullptr, "SGI"},
    {"FOR4"sv, nullptr, "Maya IFF"},
    {"8BPS"sv, nullptr, "Photoshop"},
    {"DDS "sv, nullptr, "DDS"},
};

bool is_webp(std::string_view head) {
    return head.size() >= 12 && head.substr(0, 4) == "RIFF" && head.substr(8, 4) == "WEBP";
}

/// Targa has no mark at its beginning: its name has to say it.
bool is_targa(const std::string& path) {
    std::string suffix = std::filesystem::path(path).extension().string();
    std::ranges::transform(suffix, suffix.begin(), [](unsigned char c) { return std::tolower(c); });
    return suffix == ".tga" || suffix == ".tpic";
}

}  // namespace

ImageFormat image_format(const std::string& path) {
    std::error_code failure;
    const auto status = std::filesystem::status(path, failure);
    // A pipe or a device would wait for ever.
    if (failure || !std::filesystem::exists(status)) return {nullptr, "there is no such file"};
    if (!std::filesystem::is_regular_file(status)) return {nullptr, "it is no file"};
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "rb"));
    if (!file) return {nullptr, std::generic_category().message(errno)};
    std::array<char, 16> bytes{};
    const std::string_view head(bytes.data(),
                                std::fread(bytes.data(), 1, bytes.size(), file.get()));
    if (head.empty()) return {nullptr, "it is empty"};
    for (const Magic& magic : kMagics) {
        if (!head.starts_with(magic.bytes)) continue;
        if (magic.reader) return {magic.reader, {}};
        return {nullptr, std::string(magic.name) + " files are not read"};
    }
    if (is_webp(head)) return {"webp", {}};
    if (is_targa(path)) return {"targa", {}};
    return {nullptr, "its format is not known"};
}

}  // namespace granita
