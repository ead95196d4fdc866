// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/textures/openexr_header.h"

#include <cstdint>
#include <fstream>

namespace granita {

namespace {

constexpr int kBeforeHeader = 8;       // magic number, version and flags
constexpr int kPartsFlag = 0x10;       // of the byte after the version
constexpr std::size_t kLongest = 255;  // of names

/// False where there is none.
bool read_name(std::istream& file, std::string& name) {
    name.clear();
    for (int c = file.get(); file && name.size() <= kLongest; c = file.get()) {
        if (c == 0) return true;
        name.push_back(static_cast<char>(c));
    }
    return false;
}

/// Little-endian.
std::int32_t read_number(std::istream& file) {
    std::uint32_t number = 0;
    for (int k = 0; k < 4; ++k) number |= static_cast<std::uint32_t>(file.get() & 0xff) << (8 * k);
    return static_cast<std::int32_t>(number);
}

}  // namespace

bool openexr_header_fits(const std::string& path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    const std::int64_t end = file.tellg();
    file.seekg(5);
    const bool parts = file.get() & kPartsFlag;
    file.seekg(kBeforeHeader);
    std::string name;
    // An empty name ends a header, an empty header those of parts.
    bool first = true;
    while (read_name(file, name)) {
        if (name.empty()) {
            if (!parts || first) return true;
            first = true;
            continue;
        }
        first = false;
        if (!read_name(file, name)) return false;  // its type
        const std::int32_t size = read_number(file);
        if (!file || size < 0 || static_cast<std::int64_t>(file.tellg()) + size > end) return false;
        file.seekg(size, std::ios::cur);
    }
    return false;
}

}  // namespace granita
