// SPDX-License-Identifier: GPL-3.0-or-later
// The world as a light: its radiance baked over all directions, for importance sampling
// (pbrt 12.5). Directions are world axes; the map is equirectangular, z up, rows of equal polar
// angle.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/progress.h"
#include "math/vec.h"
#include "shade/rays/ray_type.h"

namespace granita {

/// The world as a light.
struct WorldEvaluator {
    /// Along `directions` (unit, world axes), each standing for a cone of `spread` radians (texture
    /// filtering), as rays of a type see it.  Any thread.
    std::function<void(const std::vector<Vec3f>& directions, float spread, RayType ray,
                       std::vector<Vec3f>& out)>
        radiance;
    bool is_constant = false;  ///< one radiance for all directions, as each type of ray sees it
    bool by_lobe = false;      ///< the types of rays that lobes send may see different worlds
    bool is_filtered = false;  ///< nothing narrower than `spread` is missed, as in images
    bool is_image = false;     ///< and there is nothing but images: their means tell all
};

class Environment {
  public:
    /// A world that is not constant is evaluated in parallel over `height` x 2 `height` texels:
    /// once in each where it is filtered; else at 4 x 4 places, so that what is at least 0.35 of a
    /// texel wide (of the default an eighth of a degree, a quarter of the sun) is found, and at
    /// 16 x 16 of texels that much of the samples are due to.  Radiance that is not finite counts
    /// as black.  Throws Cancelled.
    Environment(const WorldEvaluator& world, const Progress& progress, int height = 512);

    /// Directions whose radiance was not finite.
    std::size_t broken() const { return m_broken; }
    /// Constant and black.  A world that varies is none, however dark its texels: lobes may find
    /// what is between them.
    bool is_black() const { return m_black; }
    bool is_constant() const { return m_constant; }
    /// Of a constant world, as a type of ray sees it.
    const Vec3f& constant_radiance(RayType ray) const {
        return m_constant_radiance[static_cast<std::size_t>(ray)];
    }
    /// Whether sample() has anything to go by: not where the world is constant or all texels are
    /// black.
    bool has_density() const { return !m_rows.empty(); }

    /// A direction and what is known of the world there.
    struct Sample {
        Vec3f direction;
        float pdf;          ///< of sample(), per solid angle; 0 without one
        std::size_t texel;  ///< of the table, where there is a density
    };
    /// With a density near proportional to luminance; u in [0, 1)^2.
    Sample sample(const Vec2f& u) const;
    Sample at(const Vec3f& direction) const;

    /// Whether texel_radiance() says what sample() stands for: of images, whose lookups are most of
    /// what lighting by a world costs.  A program may hold what is between a texel's places.
    bool has_radiance() const { return !m_radiance.empty(); }
    /// The mean over a texel, as kBlurredRays see it.
    const Vec3f& texel_radiance(std::size_t texel, RayType ray) const {
        const auto* const world = std::ranges::find(kBlurredRays, ray);
        return m_radiance[static_cast<std::size_t>(world - kBlurredRays.begin()) * m_texels_apart +
                          texel];
    }

    /// Angle between neighbouring directions of the table: what sample() stands for.
    float texel_angle() const;
    std::size_t bytes() const;

  private:
    /// The types of rays that lobes send that are not sharp.
    static constexpr std::array kBlurredRays{RayType::Diffuse, RayType::Glossy,
                                             RayType::Transmission, RayType::Translucent,
                                             RayType::Scattered};
    /// Those that may see other worlds than the first does.
    static std::span<const RayType> kinds(const WorldEvaluator& world) {
        return std::span(kBlurredRays).first(world.by_lobe ? kBlurredRays.size() : 1);
    }

    /// [kFine + 1] distribution over the rows of a texel, then [kFine][kFine + 1] inside each.
    static constexpr int kFine = 16;
    static constexpr std::size_t kFineSize = (kFine + 1) * (kFine + 1);
    using FineTexel = std::array<float, kFineSize>;

    /// [height][width] luminance
    std::vector<float> bake(const WorldEvaluator& world, const Progress& progress);
    void build_distribution(const std::vector<float>& luminance);
    void build_fine(const WorldEvaluator& world, const Progress& progress,
                    std::vector<float>& luminance);
    std::vector<double> look_closely(const WorldEvaluator& world, std::size_t texel) const;
    /// Of all samples, those of a texel.
    float part(std::size_t texel) const;
    const FineTexel* fine(std::size_t texel) const {
        return m_fine_of.empty() || m_fine_of[texel] == 0 ? nullptr : &m_fine[m_fine_of[texel] - 1];
    }
    static float fill_fine(std::span<const double> bright, FineTexel& fine);
    /// Of a row of a texel.
    template <class Fine>
    static auto* fine_columns(Fine& fine, int row) {
        return fine.data() + (row + 1) * (kFine + 1);
    }
    float per_solid_angle(float part, float sine) const;

    int m_width = 0, m_height = 0;
    std::size_t m_broken = 0;
    bool m_black = false, m_constant = false;
    std::array<Vec3f, kRayTypes> m_constant_radiance{};  ///< [types of rays]
    std::vector<float> m_rows;                           ///< [height + 1] distribution over rows
    std::vector<float> m_columns;  ///< [height][width + 1] distribution inside each row
    /// [height][kGuides] for each step of a row's distribution, the column before it: bisecting a
    /// thousand columns missed the cache five times, a tenth of a lit world's time.
    std::vector<std::uint16_t> m_guides;
    /// [1 or kBlurredRays][height][width] as each of these sees it.
    std::vector<Vec3f> m_radiance;
    std::size_t m_texels_apart = 0;  ///< between two of them
    /// Bright texels of worlds that are not filtered, in which there may be a sun's limb.
    std::vector<FineTexel> m_fine;
    std::vector<std::uint16_t> m_fine_of;  ///< [height][width] 1 + index; empty: there are none
};

}  // namespace granita
