// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <tuple>
#include <vector>

#include "scene/scene.h"
#include "shade/nodes/node_compiler.h"
#include "shade/rays/ray.h"
#include "shade/volumes/medium.h"
#include "shade/volumes/volume_space.h"

namespace granita {

/// What the programs of a frame's volumes go by.
struct FilledThings {
    static constexpr std::uint32_t kWorld = ~0u;
    Vec3d origin{0.0};                            ///< of shading space, in the world
    std::map<std::uint32_t, VolumeSpace> spaces;  ///< of instances
    std::map<std::uint32_t, float> steps;         ///< metres; of kWorld too
};

/// A part of a ray that a program fills.
struct FilledSpan {
    const VolumeProgram* program;
    std::uint32_t instance;  ///< in Scene::instances, or FilledThings::kWorld
    std::int32_t material;   ///< in Scene::materials
    float begin, end;
};

/// Makes media of what rays pass through: all that varies is asked for at once, in fill().
class MediaFiller {
  public:
    /// `media` is emptied.
    MediaFiller(const Scene& scene, const FilledThings& things, RayMedia& media)
        : m_scene(scene), m_things(things), m_media(media) {
        media.clear();
    }
    /// Spans may overlap: their media are mixed.  `shift` in [0, 1): of the places in its steps.
    void add_ray(const Ray& ray, float shift, std::span<const FilledSpan> spans);
    void fill();

  private:
    /// Where a program is asked.
    struct Place {
        std::size_t piece;
        Vec3f p, direction;
        float time;
    };
    struct Asked {
        const VolumeProgram* program = nullptr;
        std::vector<Place> places;
    };
    /// A way without an end, of which no more is asked than lets light through.
    struct Unending {
        std::size_t ray, first, asked;  ///< its number; its first piece; how many of them
        Ray along;
        float shift;
        std::vector<FilledSpan> there;
        Vec3f transmittance{1.0f};  ///< of what was asked, as far as it was looked at
    };
    void add_pieces(const Ray& ray, float shift, float begin, float end,
                    std::span<const FilledSpan> there);
    void ask(std::size_t piece, std::size_t step, const Ray& ray, float shift,
             std::span<const FilledSpan> there);
    void ask_all();
    void go_on(Unending& way);
    std::uint64_t receives(std::uint32_t instance) const;
    void fill(std::uint32_t instance, const VolumeProgram& program, std::span<const Place> places);

    const Scene& m_scene;
    const FilledThings& m_things;
    RayMedia& m_media;
    std::vector<float> m_ends;
    std::vector<FilledSpan> m_there;
    /// By instance, material and type of ray.
    std::map<std::tuple<std::uint32_t, std::int32_t, RayType>, Asked> m_asked;
    std::vector<Unending> m_unending;
};

}  // namespace granita
