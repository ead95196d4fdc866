// SPDX-License-Identifier: GPL-3.0-or-later
// Materials, lights and world of a frame, compiled once, run over grids.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "base/progress.h"
#include "base/report.h"
#include "base/statistics.h"
#include "dice/grid.h"
#include "dice/view.h"
#include "scene/scene.h"
#include "shade/background_rays.h"
#include "shade/persistent_shading.h"
#include "shade/refined_points.h"
#include "shade/seen_volumes.h"
#include "shade/textures/texture.h"
#include "shade/told_light.h"

namespace granita {

struct GridShading;
class MaterialDisplacement;

class ShadingSystem {
  public:
    /// Compiles every material's programs (displacement, opacity, radiance: decision 6); unknown
    /// nodes are reported once by material and node and replaced by their nearest kin.  Builds the
    /// ray scene only if something needs rays.
    /// @param refines whether refine() will be called where grids ask for it (Grid::unsettled).
    /// @param kept of an earlier frame; what this one makes is left there too.
    ShadingSystem(const Scene& scene, Statistics& statistics, Report& report,
                  const Progress& progress, bool refines = true,
                  const PersistentShading& kept = {});
    ~ShadingSystem();

    /// For View: [materials + 1], the last for "no material".
    const std::vector<std::vector<AttributeRequest>>& requests() const;
    /// nullptr: nothing is displaced.
    const MaterialDisplacement* displacement() const;
    /// For View: whether anything that is seen asks for light.
    bool has_light() const;

    /// For View: what rays and dicing know of the same geometries.
    std::shared_ptr<GeometryCache> geometries() const;

    /// Whether grids take light from those around them.
    bool shares_light() const;

    /// Whether opacity must run before visibility (it is not the constant 1).  -1 = no material.
    bool opacity_varies(int material) const;
    /// Whether opacity depends on what rays of its nodes meet.
    bool opacity_asks_rays(int material) const;
    /// Whether other surfaces' light depends on it where none bounces: it lets light through,
    /// shines, or bends the normals by which light enters a mesh.  -1 = no material.
    bool reaches_others(int material) const;
    /// Fills Grid::opacity and opacity_varies.  Thread-safe for different grids.
    void shade_opacity(Grid& grid) const;
    /// Whether shade_radiance() will leave a grid of small faces or ribbons to the samples that see
    /// it: then only opacity needs its shading state.
    bool leaves_to_samples(const Grid& grid) const;
    /// Fills Grid::radiance (premultiplied by opacity, plus emission) and what depends on it, of a
    /// grid that grids around tell nothing.  Thread-safe for different grids.
    void shade_radiance(Grid& grid) const;
    /// Its first half: what the grid's points find by themselves, among it what they tell grids
    /// around (Grid::told).  nullptr: there is no other half, or an equal grid of an earlier
    /// picture has told it, and has been shaded where Grid::light_fraction says so.
    /// @param anew whatever earlier pictures have.
    std::shared_ptr<GridShading> begin_radiance(Grid& grid, bool anew = false) const;
    /// `around`: what grids near this one tell it, in the order of their keys.
    void end_radiance(Grid& grid, GridShading& begun, const ToldLights& around) const;

    /// Shades points between the vertices of a shaded grid, each at its time.
    /// @return as many vertices, point by point: place, radiance, channels and, where the grid's
    /// varies, opacity alone are there.
    Grid refine(const Grid& grid, std::span<const RefinedPoint> points) const;

    /// Bend of displayed colour from which on samples are shaded by themselves, for the frame's
    /// number of samples.
    float threshold() const;

    /// The world as the camera sees it.  Fills `out` [n].
    void background(const BackgroundRays& rays, std::vector<Vec3f>& out) const;
    /// The world's colour is one constant: `background` of any one direction.
    bool background_is_constant() const;
    /// There may be anything between two of its directions, as stars are.
    bool background_is_patterned() const;

    /// nullptr where nothing is filled.
    const SeenVolumes* volumes() const;

    /// Of which TextureStore says what may be done meanwhile.
    TextureStore& textures() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace granita
