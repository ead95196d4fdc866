// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/texture.h"

#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/texture.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <tuple>
#include <utility>

#include "shade/texture_input.h"
#include "shade/texture_pyramid.h"

namespace granita {

namespace {

/// Decoded tiles kept in memory, all images together.
constexpr float kCacheMegabytes = 512.0f;
constexpr int kOpenFiles = 64;
const Vec4f kMagenta(1.0f, 0.0f, 1.0f, 1.0f);

class MissingTexture final : public Texture {
  public:
    void look_up(const TextureMode&, const std::vector<TexturePlace>& places,
                 std::vector<Vec4f>& out) const override {
        out.assign(places.size(), kMagenta);
    }
};

OIIO::TextureOpt options_for(const TextureMode& mode) {
    OIIO::TextureOpt options;
    const auto wrap = mode.extension == TextureExtension::Repeat   ? OIIO::TextureOpt::WrapPeriodic
                      : mode.extension == TextureExtension::Mirror ? OIIO::TextureOpt::WrapMirror
                      : mode.extension == TextureExtension::Clip   ? OIIO::TextureOpt::WrapBlack
                                                                   : OIIO::TextureOpt::WrapClamp;
    options.swrap = options.twrap = wrap;
    options.interpmode = mode.filter == TextureFilter::Closest ? OIIO::TextureOpt::InterpClosest
                         : mode.filter == TextureFilter::Cubic ? OIIO::TextureOpt::InterpBicubic
                                                               : OIIO::TextureOpt::InterpBilinear;
    options.mipmode = OIIO::TextureOpt::MipModeAniso;
    options.anisotropic = 16;
    return options;
}

constexpr int kMostProbes = 16;

/// A long footprint as short ones in a row.
struct Probes {
    int count = 1;
    Vec2f step{0.0f};  ///< between two of them; the footprint's longer edge becomes this
    bool along_u = true;
};

Probes probes_of(const TexturePlace& place, const Vec2f& size) {
    const float u = glm::length(place.along_u * size), v = glm::length(place.along_v * size);
    Probes probes;
    probes.along_u = u >= v;
    const float ratio = std::max(u, v) / std::max(std::min(u, v), 1.0f);
    if (ratio > 1.0f)
        probes.count = static_cast<int>(std::ceil(std::min(ratio, float{kMostProbes})));
    probes.step =
        (probes.along_u ? place.along_u : place.along_v) / static_cast<float>(probes.count);
    return probes;
}

class CachedTexture final : public Texture {
  public:
    CachedTexture(const Image& image, const TextureHeader& header, OIIO::TextureSystem& system,
                  OIIO::ImageCache& cache, Statistics& statistics, Report& report)
        : m_image(image),
          m_kind(header.kind),
          m_size(header.width, header.height),
          m_registration(image, cache),
          m_system(system),
          m_handle(system.get_texture_handle(OIIO::ustring(m_registration.name()))),
          m_statistics(statistics),
          m_report(report) {}

    void look_up(const TextureMode& mode, const std::vector<TexturePlace>& places,
                 std::vector<Vec4f>& out) const override {
        out.resize(places.size());
        auto* thread = m_system.get_perthread_info();
        OIIO::TextureOpt options = options_for(mode);
        std::uint64_t failures = 0;
        for (std::size_t i = 0; i < places.size(); ++i) {
            const TexturePlace& place = places[i];
            const Vec2f p = place.center;
            if (!(std::abs(p.x) < 1e6f && std::abs(p.y) < 1e6f)) {  // also catches NaN
                out[i] = Vec4f(0.0f);
                continue;
            }
            Vec4f texel;
            if (!look(thread, options, mode, place, texel)) {
                ++failures;
                texel = kMagenta;
            }
            out[i] = texel;
        }
        m_statistics.add(Counter::TextureLookups, places.size());
        if (failures) {
            m_system.geterror();  // the text differs by tile: one message for the artist
            m_report.warn("image '" + m_image.name + "'",
                          "cannot be read completely, shown magenta: " + m_image.path, failures);
        }
    }

  private:
    using Thread = OIIO::TextureSystem::Perthread;

    /// What is encoded must not be averaged along a long footprint before it is decoded: a mean of
    /// black and white would be a fifth of white.  Its probes are therefore taken one by one.
    bool look(Thread* thread, OIIO::TextureOpt& options, const TextureMode& mode,
              const TexturePlace& place, Vec4f& sum) const {
        if (!is_encoded(m_kind)) return probe(thread, options, mode, place, sum);
        const Probes probes = probes_of(place, m_size);
        TexturePlace part = place;
        (probes.along_u ? part.along_u : part.along_v) = probes.step;
        const auto count = static_cast<float>(probes.count);
        sum = Vec4f(0.0f);
        for (int k = 0; k < probes.count; ++k) {
            part.center =
                place.center + probes.step * (static_cast<float>(k) + 0.5f - 0.5f * count);
            Vec4f texel;
            if (!probe(thread, options, mode, part, texel)) return false;
            sum += texel / count;
        }
        return true;
    }

    bool probe(Thread* thread, OIIO::TextureOpt& options, const TextureMode& mode,
               const TexturePlace& place, Vec4f& texel) const {
        const Vec2f p = place.center;
        // OpenImageIO's t runs downward.
        if (!m_system.texture(m_handle, thread, options, p.x, 1.0f - p.y, place.along_u.x,
                              -place.along_u.y, place.along_v.x, -place.along_v.y, 4, &texel.x))
            return false;
        if (mode.unassociate && texel.w != 0.0f && texel.w != 1.0f)
            texel = Vec4f(Vec3f(texel) / texel.w, texel.w);
        if (is_encoded(m_kind))
            texel = Vec4f(linear_from_srgb(texel.x), linear_from_srgb(texel.y),
                          linear_from_srgb(texel.z), texel.w);
        return true;
    }

    const Image& m_image;
    TexelKind m_kind;
    Vec2f m_size;  ///< texels
    TextureRegistration m_registration;
    OIIO::TextureSystem& m_system;
    OIIO::TextureSystem::TextureHandle* m_handle;
    Statistics& m_statistics;
    Report& m_report;
};

/// A cache with its texture system, lent to one frame at a time and never destroyed:
/// OpenImageIO 2.4 deletes both as if they were a char, and the sized delete of jemalloc, which
/// Debian's Blender links, then corrupts the heap (TextureSystemImpl and ImageCacheImpl::operator
/// delete).
class LentCache {
  public:
    LentCache() {
        const std::lock_guard lock(idle().mutex);
        if (idle().caches.empty()) {
            cache = OIIO::ImageCache::create(false);
            cache->attribute("max_memory_MB", kCacheMegabytes);
            cache->attribute("max_open_files", kOpenFiles);
            cache->attribute("autotile", 64);
            cache->attribute("deduplicate", 0);
            system = OIIO::TextureSystem::create(false, cache);
        } else {
            std::tie(cache, system) = idle().caches.back();
            idle().caches.pop_back();
        }
    }
    ~LentCache() {
        cache->invalidate_all(true);
        const std::lock_guard lock(idle().mutex);
        idle().caches.emplace_back(cache, system);
    }
    LentCache(const LentCache&) = delete;
    LentCache& operator=(const LentCache&) = delete;

    OIIO::ImageCache* cache;
    OIIO::TextureSystem* system;

  private:
    struct Idle {
        std::mutex mutex;
        std::vector<std::pair<OIIO::ImageCache*, OIIO::TextureSystem*>> caches;
    };
    static Idle& idle() {
        static Idle the_idle;
        return the_idle;
    }
};

}  // namespace

struct TextureStore::Impl {
    const Scene& scene;
    Statistics& statistics;
    Report& report;
    LentCache lent;
    std::map<std::string, std::shared_ptr<const Texture>> textures;

    Impl(const Scene& s, Statistics& stats, Report& r) : scene(s), statistics(stats), report(r) {}
};

TextureStore::TextureStore(const Scene& scene, Statistics& statistics, Report& report)
    : m_impl(std::make_unique<Impl>(scene, statistics, report)) {}

TextureStore::~TextureStore() = default;

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
    const TextureHeader header = read_texture_header(*image);
    if (!header.error.empty()) {
        m_impl->report.warn("image '" + name + "'",
                            "cannot be read, shown magenta: " + image->path);
        return texture;
    }
    texture =
        std::make_shared<CachedTexture>(*image, header, *m_impl->lent.system, *m_impl->lent.cache,
                                        m_impl->statistics, m_impl->report);
    return texture;
}

}  // namespace granita
