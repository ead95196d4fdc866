// SPDX-License-Identifier: GPL-3.0-or-later
// Images made in tests, and look-ups in them as nodes make them.
#pragma once

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "shade/textures/texel.h"
#include "shade/textures/texture.h"

namespace granita {

/// Floats, lowest row first.
inline Image image_of(int width, int height, const std::vector<Vec3f>& colors, const char* space) {
    Image image;
    image.name = "Image";
    image.space = plain_color_space(space);
    image.width = width;
    image.height = height;
    for (const Vec3f& c : colors) image.pixels.insert(image.pixels.end(), {c.x, c.y, c.z, 1.0f});
    return image;
}

/// Of bytes of sRGB, lowest row first.
inline Image image_of_bytes(int width, int height, const std::vector<std::uint8_t>& grey) {
    Image image = image_of(width, height, {}, "sRGB");
    for (const std::uint8_t g : grey) image.bytes.insert(image.bytes.end(), {g, g, g, 255});
    return image;
}

/// Black and white at random, in blocks of so many texels a side.
inline std::vector<std::uint8_t> random_blocks(int size, int block, unsigned seed) {
    std::mt19937 random(seed);
    const int blocks = size / block;
    std::vector<std::uint8_t> coarse(static_cast<std::size_t>(blocks) * blocks), grey;
    for (auto& c : coarse) c = random() & 1 ? 255 : 0;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) grey.push_back(coarse[y / block * blocks + x / block]);
    return grey;
}

/// A file of its own that goes with the object.
class ImageFile {
  public:
    explicit ImageFile(const std::string& suffix) {
        static int count = 0;
        m_path =
            std::filesystem::temp_directory_path() /
            ("granita-test-" + std::to_string(::getpid()) + "-" + std::to_string(count++) + suffix);
    }
    ~ImageFile() {
        std::error_code ignored;
        std::filesystem::remove(m_path, ignored);
    }
    ImageFile(const ImageFile&) = delete;
    ImageFile& operator=(const ImageFile&) = delete;
    std::string path() const { return m_path.string(); }

    void write(const std::vector<std::uint8_t>& bytes) const {
        std::ofstream(m_path, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()),
                   static_cast<std::streamsize>(bytes.size()));
    }
    std::vector<std::uint8_t> read() const {
        std::ifstream file(m_path, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    Image image(const char* space = "sRGB") const {
        Image made;
        made.name = "Image";
        made.path = path();
        made.space = plain_color_space(space);
        return made;
    }

  private:
    std::filesystem::path m_path;
};

/// A grey float image whose texel (x, y), counted from above, is `value(level, x, y)`.  In tiles of
/// `tile` where that is not 0, and then with all levels where `levels` is set.
template <class Value>
bool write_image(const ImageFile& file, int size, const Value& value, int tile = 0,
                 bool levels = false) {
    const auto out = OIIO::ImageOutput::create(file.path());
    if (!out) return false;
    using Output = OIIO::ImageOutput;
    const auto append = out->supports("mipmap") ? Output::AppendMIPLevel : Output::AppendSubimage;
    for (int level = 0; size > 0; ++level, size /= 2) {
        OIIO::ImageSpec spec(size, size, 3, OIIO::TypeFloat);
        spec.tile_width = spec.tile_height = tile;
        if (levels) spec.attribute("textureformat", "Plain Texture");
        std::vector<float> texels;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) texels.insert(texels.end(), 3, value(level, x, y));
        if (!out->open(file.path(), spec, level ? append : Output::Create) ||
            !out->write_image(OIIO::TypeFloat, texels.data()))
            return ADD_FAILURE() << out->geterror(), false;
        if (!levels) break;
    }
    return out->close();
}

/// One image in a scene of its own.
class Look {
  public:
    /// @param memory  As Options::memory, MiB; textures are given a quarter of it.  0: any.
    explicit Look(const Image& image, int memory = 0) {
        m_scene.images = {image};
        m_scene.options.memory = memory;
        m_store = std::make_unique<TextureStore>(m_scene, m_statistics, m_report);
    }
    std::vector<Vec4f> at(const std::vector<TexturePlace>& places, const TextureMode& mode = {}) {
        std::vector<Vec4f> out;
        m_store->find(m_scene.images[0].name, "node 'N'")->look_up(mode, places, out);
        return out;
    }
    /// `size`: of a square footprint, in the image's own width.
    Vec4f at(Vec2f center, float size, const TextureMode& mode = {}) {
        return at({TexturePlace{center, Vec2f(size, 0), Vec2f(0, size)}}, mode)[0];
    }
    std::vector<Warning> warnings() const { return m_report.warnings(); }
    std::uint64_t byte_count() const { return m_store->byte_count(); }

  private:
    Scene m_scene;
    Statistics m_statistics;
    Report m_report;
    std::unique_ptr<TextureStore> m_store;
};

/// n x n places all over an image, with a footprint of a x b texels turned by `angle`.
inline std::vector<TexturePlace> places_all_over(int n, int size, float a, float b, float angle) {
    const Vec2f u(std::cos(angle), std::sin(angle)), v(-u.y, u.x);
    std::vector<TexturePlace> places;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x)
            places.push_back(
                {(Vec2f(x, y) + 0.3f) / float(n), u * (a / float(size)), v * (b / float(size))});
    return places;
}

}  // namespace granita
