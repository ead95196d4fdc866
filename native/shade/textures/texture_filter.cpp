// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/textures/texture_filter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "math/saturate.h"

namespace granita {

namespace {

/// The longer axis of a footprint over the shorter one that is looked at.
constexpr float kMostAnisotropy = 16.0f;

/// Texels of one level, read one by one; the level's place [0,1]^2, v downward.
class LevelReader {
  public:
    LevelReader(TiledImage& image, int level, TextureExtension extension)
        : m_image(image), m_index(level), m_level(image.level(level)), m_extension(extension) {}

    /// To where the image repeats, as texels: the middle of texel i is at i + 1/2.
    Vec2f texels(Vec2f place) const {
        return {folded(place.x) * static_cast<float>(m_level.width),
                folded(place.y) * static_cast<float>(m_level.height)};
    }

    template <class Read>
    Vec4f bilinear(Vec2f at, const Read& read) {
        const Vec2f p = at - 0.5f, floor = glm::floor(p), f = p - floor;
        const int x = static_cast<int>(floor.x), y = static_cast<int>(floor.y);
        const Vec4f upper = texel(x, y, read) * (1.0f - f.x) + texel(x + 1, y, read) * f.x;
        const Vec4f lower = texel(x, y + 1, read) * (1.0f - f.x) + texel(x + 1, y + 1, read) * f.x;
        return upper * (1.0f - f.y) + lower * f.y;
    }

    /// The uniform cubic B-spline, as Cycles' and OpenImageIO's cubic interpolation.
    template <class Read>
    Vec4f bicubic(Vec2f at, const Read& read) {
        const Vec2f p = at - 0.5f, floor = glm::floor(p), f = p - floor;
        const int x = static_cast<int>(floor.x), y = static_cast<int>(floor.y);
        float across[4], down[4];
        spline(f.x, across);
        spline(f.y, down);
        Vec4f sum(0.0f);
        for (int j = 0; j < 4; ++j)
            for (int i = 0; i < 4; ++i)
                sum += texel(x + i - 1, y + j - 1, read) * (across[i] * down[j]);
        return sum;
    }

    template <class Read>
    Vec4f closest(Vec2f at, const Read& read) {
        // v counts from below: of two texels that meet at a place, the upper one, as in Cycles.
        return texel(static_cast<int>(std::floor(at.x)), static_cast<int>(std::ceil(at.y)) - 1,
                     read);
    }

  private:
    static void spline(float t, float* w) {
        const float u = 1.0f - t;
        w[0] = u * u * u / 6.0f;
        w[1] = (4.0f + t * t * (3.0f * t - 6.0f)) / 6.0f;
        w[2] = (4.0f + u * u * (3.0f * u - 6.0f)) / 6.0f;
        w[3] = t * t * t / 6.0f;
    }

    float folded(float x) const {
        switch (m_extension) {
            case TextureExtension::Repeat:
                return x - std::floor(x);
            case TextureExtension::Mirror: {
                const float twice = x - 2.0f * std::floor(0.5f * x);
                return twice > 1.0f ? 2.0f - twice : twice;
            }
            default:  // far enough out to be beyond the rim of any level
                return std::clamp(x, -4.0f, 5.0f);
        }
    }

    /// False: outside an image that is clipped.
    bool wrap(int& i, int size) const {
        if (static_cast<unsigned>(i) < static_cast<unsigned>(size)) return true;
        if (m_extension == TextureExtension::Clip) return false;
        if (m_extension == TextureExtension::Repeat) {
            i %= size;
            if (i < 0) i += size;
        } else {  // a mirrored rim is beside itself
            i = std::clamp(i, 0, size - 1);
        }
        return true;
    }

    template <class Read>
    Vec4f texel(int x, int y, const Read& read) {
        if (!wrap(x, m_level.width) || !wrap(y, m_level.height)) return Vec4f(0.0f);
        const int across = x >> m_level.tile_columns, down = y >> m_level.tile_rows;
        if (across != m_across || down != m_down || !m_tile) {
            m_tile = m_image.tile(m_index, across, down);
            m_across = across;
            m_down = down;
        }
        return read(
            m_tile->at(x - (across << m_level.tile_columns), y - (down << m_level.tile_rows)),
            m_level.type);
    }

    TiledImage& m_image;
    int m_index;
    const TextureLevel& m_level;
    TextureExtension m_extension;
    const Tile* m_tile = nullptr;
    int m_across = 0, m_down = 0;
};

/// A row of probes of equal light along the longer axis: whole ones of `step`, and one at each end
/// that grows from nothing, so that nothing jumps as the footprint grows.
class Probes {
  public:
    Probes(float length, float step) : m_step(step) {
        const float cells = std::max(length / step, 1.0f);  // of one probe each
        m_whole = 2 * static_cast<int>((cells - 1.0f) / 2.0f) + 1;
        m_end = 0.5f * (cells - static_cast<float>(m_whole));
        m_total = cells;
    }
    int count() const { return m_whole + (m_end > 0.0f ? 2 : 0); }
    /// Of probe k: how far from the middle, texels, and its weight.
    float offset(int k) const {
        const float half = 0.5f * static_cast<float>(m_whole);
        if (k < m_whole) return (static_cast<float>(k) + 0.5f - half) * m_step;
        return (k == m_whole ? -1.0f : 1.0f) * (half + 0.5f * m_end) * m_step;
    }
    float weight(int k) const { return (k < m_whole ? 1.0f : m_end) / m_total; }

  private:
    float m_step, m_end, m_total;
    int m_whole;
};

/// Mean light over the footprint.
Vec4f light_over(TiledImage& image, const TextureMode& mode, Vec2f center,
                 const TextureFootprint& print) {
    const TexelDecoder& decoder = image.decoder();
    const auto stored_light = [&](const std::byte* at, TexelType type) {
        return decoder.light(at, type);
    };
    const Vec2f size(image.level(0).width, image.level(0).height);
    const float shorter = print.probe();
    const float last = static_cast<float>(image.level_count() - 1);
    const float depth = std::min(print.depth(), last);
    const int finer = static_cast<int>(depth);
    const float blend = depth - static_cast<float>(finer);
    const Probes probes(print.longer, shorter);
    Vec4f sum(0.0f);
    const auto add = [&](int level, float share) {
        LevelReader reader(image, level, mode.extension);
        for (int k = 0; k < probes.count(); ++k) {
            const Vec2f at = reader.texels(center + print.axis * (probes.offset(k) / size));
            const Vec4f light = level > 0 ? reader.bilinear(at, stored_texel)
                                : mode.filter == TextureFilter::Cubic
                                    ? reader.bicubic(at, stored_light)
                                    : reader.bilinear(at, stored_light);
            sum += light * (probes.weight(k) * share);
        }
    };
    if (blend < 1.0f) add(finer, 1.0f - blend);
    if (blend > 0.0f) add(finer + 1, blend);
    return decoder.seen(sum);
}

/// Interpolated numbers of level 0, decoded last.
Vec4f magnified(TiledImage& image, const TextureMode& mode, Vec2f center) {
    LevelReader reader(image, 0, mode.extension);
    const Vec2f at = reader.texels(center);
    const Vec4f stored = mode.filter == TextureFilter::Closest ? reader.closest(at, stored_texel)
                         : mode.filter == TextureFilter::Cubic ? reader.bicubic(at, stored_texel)
                                                               : reader.bilinear(at, stored_texel);
    return image.decoder().seen_of_stored(stored);
}

/// What an axis of a footprint has before the image, in it, or behind it.
struct Part {
    float center, kept;  ///< of the axis's length
    float share;         ///< of what is seen
};

/// Of an axis from center - half to center + half.
int parts_of(float center, float half, Part (&parts)[3]) {
    const float from = center - half, to = center + half;
    if (!(half > 0.0f && std::isfinite(half)) || (from >= 0.0f && to <= 1.0f)) {
        parts[0] = {center, 1.0f, 1.0f};
        return 1;
    }
    const float low = std::max(from, 0.0f), high = std::min(to, 1.0f), of_all = 0.5f / half;
    const float within = (high - low) * of_all;  // less than 0 where all is beyond
    const Part all[] = {{0.0f, 0.0f, (std::min(to, 0.0f) - from) * of_all},
                        {0.5f * (low + high), within, within},
                        {1.0f, 0.0f, (to - std::max(from, 1.0f)) * of_all}};
    int count = 0;
    for (const Part& part : all)
        if (part.share > 0.0f) parts[count++] = part;
    return count;
}

/// The parts of a footprint in an image and beyond its rim, which goes on there for ever, or where
/// there is nothing.
template <class See>
void see_parts(TextureExtension extension, const TexturePlace& place, const See& see) {
    Part parts[2][3];
    int count[2];
    for (int axis = 0; axis < 2; ++axis) {
        const float half = 0.5f * (std::abs(place.along_u[axis]) + std::abs(place.along_v[axis]));
        count[axis] = parts_of(place.center[axis], half, parts[axis]);
    }
    for (int j = 0; j < count[1]; ++j)
        for (int i = 0; i < count[0]; ++i) {
            const Part &x = parts[0][i], &y = parts[1][j];
            const Vec2f kept(x.kept, y.kept);
            const bool is_beyond = x.kept == 0.0f || y.kept == 0.0f;
            if (extension == TextureExtension::Clip && is_beyond) continue;
            see({{x.center, y.center}, place.along_u * kept, place.along_v * kept},
                x.share * y.share);
        }
}

/// Of one that is clipped, how far a footprint wider than it is seen by its parts: its levels know
/// of what is beyond no more than half of their own width.
float part_of_parts(const TextureMode& mode, const TexturePlace& place) {
    if (mode.extension == TextureExtension::Extend) return 1.0f;
    if (mode.extension != TextureExtension::Clip) return 0.0f;
    const Vec2f width = glm::abs(place.along_u) + glm::abs(place.along_v);
    return saturate(std::max(width.x, width.y) - 1.0f);
}

TextureFootprint footprint_of(const Vec2f& size, const TexturePlace& place) {
    return TextureFootprint::of(place.along_u, place.along_v, size);
}

/// As levels tell it.
Vec4f seen_as_one(TiledImage& image, const TextureMode& mode, const TexturePlace& place) {
    const Vec2f size(image.level(0).width, image.level(0).height);
    const TextureFootprint print = footprint_of(size, place);
    // Rows run downward.
    const Vec2f center(place.center.x, 1.0f - place.center.y);
    TextureFootprint down = print;
    down.axis.y = -down.axis.y;
    // Numbers that are light already, interpolated between neighbours, are the same either way.
    const bool always_light = !image.decoder().encoded && mode.filter != TextureFilter::Closest;
    if (always_light || print.longer >= 1.0f) return light_over(image, mode, center, down);
    const Vec4f near = magnified(image, mode, center);
    if (print.longer <= 0.5f) return near;
    const float share = std::log2(print.longer) + 1.0f;
    return near * (1.0f - share) + light_over(image, mode, center, down) * share;
}

}  // namespace

float TextureFootprint::probe() const {
    return std::max({shorter, longer / kMostAnisotropy, 1.0f});
}

float TextureFootprint::depth() const {
    return std::log2(probe());
}

int finest_level(const Vec2f& size, const TextureMode& mode, const TexturePlace& place) {
    const float by_parts = part_of_parts(mode, place);
    float depth = by_parts < 1.0f ? footprint_of(size, place).depth() : HUGE_VALF;
    if (by_parts > 0.0f)
        see_parts(mode.extension, place, [&](const TexturePlace& part, float) {
            depth = std::min(depth, footprint_of(size, part).depth());
        });
    return static_cast<int>(std::min(depth, 32.0f));
}

TextureFootprint TextureFootprint::of(const Vec2f& along_u, const Vec2f& along_v,
                                      const Vec2f& size) {
    const Vec2f a = along_u * size, b = along_v * size;
    const float xx = a.x * a.x + b.x * b.x, yy = a.y * a.y + b.y * b.y, xy = a.x * a.y + b.x * b.y;
    const float mean = 0.5f * (xx + yy), half = 0.5f * (xx - yy);
    const float spread = std::sqrt(half * half + xy * xy);
    TextureFootprint print;
    if (!(mean + spread < 1e20f)) {  // also what is no number: everything is under the pixel
        print.longer = print.shorter = 1e10f;
        return print;
    }
    print.longer = std::sqrt(mean + spread);
    print.shorter = std::sqrt(std::max(mean - spread, 0.0f));
    // The better conditioned of the two rows of (matrix - larger eigenvalue).
    const Vec2f axis = half > 0.0f ? Vec2f(spread + half, xy) : Vec2f(xy, spread - half);
    const float length = glm::length(axis);
    if (length > 0.0f) print.axis = axis / length;
    return print;
}

Vec4f filtered(TiledImage& image, const TextureMode& mode, const TexturePlace& place) {
    const float by_parts = part_of_parts(mode, place);
    if (by_parts == 0.0f) return seen_as_one(image, mode, place);
    Vec4f sum(0.0f);
    if (by_parts < 1.0f) sum = seen_as_one(image, mode, place) * (1.0f - by_parts);
    TextureMode inside = mode;  // parts end at the rim, and do not fade there
    inside.extension = TextureExtension::Extend;
    see_parts(mode.extension, place, [&](const TexturePlace& part, float share) {
        sum += seen_as_one(image, inside, part) * (by_parts * share);
    });
    return sum;
}

}  // namespace granita
