// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/textures/texture.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <map>
#include <utility>

#include "shade/textures/texture_filter.h"
#include "shade/textures/tiled_image.h"

namespace granita {

namespace {

/// Of decoded tiles, all images together; what is beyond lies in a temporary file, or is read again
/// where a file has tiles and levels of its own.
constexpr std::uint64_t kMemory = std::uint64_t{1} << 30;

std::uint64_t memory_of(const Options& options) {
    const std::uint64_t share = (static_cast<std::uint64_t>(options.memory) << 20) / 4;
    return share > 0 ? std::min(share, kMemory) : kMemory;
}

constexpr std::size_t kOpenFiles = 64;
/// Look-ups during which no tile is freed.
constexpr std::size_t kBatch = 256;
/// Beyond, texels are not to be told apart in single precision.
constexpr float kFarthest = 1e6f;

class MissingTexture final : public Texture {
  public:
    void look_up(const TextureMode&, const std::vector<TexturePlace>& places,
                 std::vector<Vec4f>& out) const override {
        out.assign(places.size(), kMagenta);
    }
};

class ImageTexture final : public Texture {
  public:
    ImageTexture(const Image& image, const TextureHeader& header,
                 const std::shared_ptr<TileCache>& cache, const std::shared_ptr<OpenFiles>& files,
                 Statistics& statistics, Report& report, const Progress* progress)
        : m_image(image),
          m_has_alpha(header.has_alpha),
          m_size(header.width, header.height),
          m_plain(image, header, false, cache, files),
          m_divided(image, header, true, cache, files),
          m_statistics(statistics),
          m_report(report),
          m_progress(progress) {}

    void look_up(const TextureMode& mode, const std::vector<TexturePlace>& places,
                 std::vector<Vec4f>& out) const override {
        TiledImage& tiled = mode.unassociate && m_has_alpha ? m_divided : m_plain;
        out.resize(places.size());
        m_statistics.add(Counter::TextureLookups, places.size());
        if (!tiled.make_ready(finest_of(tiled, mode, places), m_progress)) {
            out.assign(places.size(), kMagenta);
            warn("cannot be read, shown magenta: ", tiled.error());
            return;
        }
        for (std::size_t begin = 0; begin < places.size(); begin += kBatch) {
            const TileCache::ReadScope scope(tiled.cache());
            const std::size_t end = std::min(begin + kBatch, places.size());
            for (std::size_t i = begin; i < end; ++i) {
                const Vec2f& p = places[i].center;
                const bool is_near = std::abs(p.x) < kFarthest && std::abs(p.y) < kFarthest;
                out[i] = is_near ? filtered(tiled, mode, places[i]) : Vec4f(0.0f);
            }
        }
        if (tiled.is_damaged()) warn("parts cannot be read, shown magenta: ", {});
    }

  private:
    /// Of the levels that these places read.
    int finest_of(const TiledImage& tiled, const TextureMode& mode,
                  const std::vector<TexturePlace>& places) const {
        if (tiled.is_whole()) return 0;
        int finest = INT_MAX;
        for (const TexturePlace& place : places)
            finest = std::min(finest, finest_level(m_size, mode, place));
        return finest;
    }

    void warn(const std::string& what, const std::string& why) const {
        const std::string reason = why.empty() ? std::string() : " (" + why + ")";
        m_report.warn("image '" + m_image.name + "'", what + m_image.path + reason);
    }

    const Image& m_image;
    bool m_has_alpha;
    Vec2f m_size;  ///< texels
    /// Means of light, and of what is divided by alpha: not the same image.
    mutable TiledImage m_plain, m_divided;
    Statistics& m_statistics;
    Report& m_report;
    const Progress* m_progress;
};

}  // namespace

struct TextureStore::Impl {
    const Scene& scene;
    Statistics& statistics;
    Report& report;
    const Progress* progress;
    std::shared_ptr<TileCache> cache;
    std::shared_ptr<OpenFiles> files = std::make_shared<OpenFiles>(kOpenFiles);
    std::map<std::string, std::shared_ptr<const Texture>> textures;

    Impl(const Scene& s, Statistics& stats, Report& r, const Progress* p)
        : scene(s),
          statistics(stats),
          report(r),
          progress(p),
          cache(std::make_shared<TileCache>(memory_of(s.options), r)) {}
};

TextureStore::TextureStore(const Scene& scene, Statistics& statistics, Report& report,
                           const Progress* progress)
    : m_impl(std::make_unique<Impl>(scene, statistics, report, progress)) {}

TextureStore::~TextureStore() = default;

std::uint64_t TextureStore::byte_count() const {
    return m_impl->cache->byte_count();
}

void TextureStore::keep_within(std::uint64_t bytes) {
    m_impl->cache->set_limit(bytes);
}

std::shared_ptr<const Texture> TextureStore::find(const std::string& name,
                                                  const std::string& user) {
    const auto known = m_impl->textures.find(name);
    if (known != m_impl->textures.end()) return known->second;
    std::shared_ptr<const Texture>& texture = m_impl->textures[name];
    texture = std::make_shared<MissingTexture>();
    const auto& images = m_impl->scene.images;
    const auto image = std::find_if(images.begin(), images.end(),
                                    [&](const Image& candidate) { return candidate.name == name; });
    if (image == images.end()) {
        m_impl->report.warn(user, "image '" + name + "' is not in the scene, shown magenta");
        return texture;
    }
    const std::string owner = "image '" + name + "'";
    const TextureHeader header = read_texture_header(*image);
    if (!header.error.empty()) {
        m_impl->report.warn(
            owner, "cannot be read, shown magenta: " + image->path + " (" + header.error + ")");
        return texture;
    }
    texture = std::make_shared<ImageTexture>(*image, header, m_impl->cache, m_impl->files,
                                             m_impl->statistics, m_impl->report, m_impl->progress);
    return texture;
}

}  // namespace granita
