// SPDX-License-Identifier: GPL-3.0-or-later
// Textures of a frame: tiled, mip-mapped, in bounded memory.  OpenImageIO decodes files, no more.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/progress.h"
#include "base/report.h"
#include "base/statistics.h"
#include "scene/scene.h"

namespace granita {

enum class TextureFilter { Linear, Closest, Cubic };
enum class TextureExtension { Repeat, Extend, Clip, Mirror };

/// How a node reads an image.
struct TextureMode {
    TextureFilter filter = TextureFilter::Linear;
    TextureExtension extension = TextureExtension::Repeat;
    /// Divide colour by alpha after the look-up: Cycles does where the Alpha output is linked.
    bool unassociate = false;
};

/// Where an image is read: [0,1]^2 with v upward, and the two edges of the footprint.
struct TexturePlace {
    Vec2f center{0.0f}, along_u{0.0f}, along_v{0.0f};
};

/// One image, ready for look-ups.  Missing images are magenta, as in Cycles.
class Texture {
  public:
    virtual ~Texture() = default;
    /// rgb linear, alpha; [n] both.
    virtual void look_up(const TextureMode& mode, const std::vector<TexturePlace>& places,
                         std::vector<Vec4f>& out) const = 0;
};

class TextureStore {
  public:
    /// What is given outlives it.  `progress`, which may be absent: asked while images are decoded.
    TextureStore(const Scene& scene, Statistics& statistics, Report& report,
                 const Progress* progress = nullptr);
    ~TextureStore();

    /// Scene::images by name.  A name that is not there is reported with `user` and is magenta.
    std::shared_ptr<const Texture> find(const std::string& image, const std::string& user);

    /// Of decoded tiles in memory.  Thread-safe.
    std::uint64_t byte_count() const;
    /// From now on, where it is less than before.  Thread-safe.
    void keep_within(std::uint64_t bytes);

  private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace granita
