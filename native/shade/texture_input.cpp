// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/texture_input.h"

#include <algorithm>
#include <cstring>
#include <list>
#include <map>
#include <memory>
#include <mutex>

#include "shade/texture_pyramid.h"

namespace granita {

namespace {

/// Decoded images on their way into the cache.  A tile that is evicted there and wanted again
/// decodes its image anew unless it is still here.
constexpr std::uint64_t kPyramidBytes = 256ull << 20;

struct Registry {
    std::mutex mutex;
    std::map<std::string, const Image*> images;
    std::uint64_t next = 0;
    std::list<std::pair<std::string, std::shared_ptr<const TexturePyramid>>> recent;

    const Image* image(const std::string& name) {
        const std::lock_guard lock(mutex);
        const auto found = images.find(name);
        return found == images.end() ? nullptr : found->second;
    }

    std::shared_ptr<const TexturePyramid> pyramid(const std::string& name) {
        const std::lock_guard lock(mutex);
        for (auto entry = recent.begin(); entry != recent.end(); ++entry) {
            if (entry->first != name) continue;
            recent.splice(recent.begin(), recent, entry);
            return recent.front().second;
        }
        recent.emplace_front(name, build_texture_pyramid(*images.at(name)));
        std::uint64_t bytes = 0;
        for (auto entry = recent.begin(); entry != recent.end();) {
            bytes += entry->second->byte_count();
            entry = bytes > kPyramidBytes && entry != recent.begin() ? recent.erase(entry)
                                                                     : std::next(entry);
        }
        return recent.front().second;
    }
};

Registry& registry() {
    static Registry the_registry;
    return the_registry;
}

class PyramidInput final : public OIIO::ImageInput {
  public:
    const char* format_name() const override { return "granita"; }
    int supports(OIIO::string_view feature) const override { return feature == "mipmap"; }

    bool open(const std::string& name, OIIO::ImageSpec& spec) override {
        const Image* image = registry().image(name);
        if (!image) return false;
        const TextureHeader header = read_texture_header(*image);
        if (!header.error.empty()) {
            errorfmt("{}", header.error);
            return false;
        }
        m_name = name;
        m_header = header;
        m_level = -1;
        if (!seek_subimage(0, 0)) return false;
        spec = m_spec;
        return true;
    }
    bool open(const std::string& name, OIIO::ImageSpec& spec, const OIIO::ImageSpec&) override {
        return open(name, spec);
    }
    bool close() override {
        m_name.clear();
        return true;
    }
    int current_subimage() const override { return 0; }
    int current_miplevel() const override { return m_level; }

    bool seek_subimage(int subimage, int level) override {
        if (subimage != 0 || level < 0) return false;
        int width = m_header.width, height = m_header.height;
        for (int i = 0; i < level; ++i) {
            if (width == 1 && height == 1) return false;
            width = std::max(1, width / 2);
            height = std::max(1, height / 2);
        }
        const OIIO::TypeDesc format = is_byte(m_header.kind) ? OIIO::TypeUInt8 : OIIO::TypeFloat;
        m_spec = OIIO::ImageSpec(width, height, 4, format);
        m_level = level;
        return true;
    }

    bool read_native_scanline(int subimage, int level, int y, int, void* data) override {
        const lock_guard lock(*this);
        if (!seek_subimage(subimage, level)) return false;
        const auto pyramid = registry().pyramid(m_name);
        if (level >= static_cast<int>(pyramid->levels.size())) {
            errorfmt("{}", pyramid->error);
            return false;
        }
        const TextureLevel& from = pyramid->levels[level];
        const std::size_t row = static_cast<std::size_t>(from.width) * 4;
        if (is_byte(pyramid->kind)) {
            std::memcpy(data, from.bytes.data() + y * row, row);
        } else {
            std::memcpy(data, from.floats.data() + y * row, row * sizeof(float));
        }
        return true;
    }

  private:
    std::string m_name;
    TextureHeader m_header;
    int m_level = -1;
};

OIIO::ImageInput* create_input() {
    return new PyramidInput;
}

}  // namespace

TextureRegistration::TextureRegistration(const Image& image, OIIO::ImageCache& cache) {
    {
        Registry& all = registry();
        const std::lock_guard lock(all.mutex);
        m_name = "granita:" + std::to_string(all.next++);
        all.images[m_name] = &image;
    }
    cache.add_file(OIIO::ustring(m_name), create_input, nullptr, false);
}

TextureRegistration::~TextureRegistration() {
    Registry& all = registry();
    const std::lock_guard lock(all.mutex);
    all.images.erase(m_name);
    all.recent.remove_if([this](const auto& entry) { return entry.first == m_name; });
}

}  // namespace granita
