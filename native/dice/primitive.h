// SPDX-License-Identifier: GPL-3.0-or-later
// The interface of Reyes: bound, split, dice (paper 9.3.2; Cook, Carpenter and Catmull 1987).
//
//   auto opened = open_instance(view, instance_index, report);      // once a frame and instance
//   for face in 0 .. opened->primitive_count():
//       bounds = opened->bounds(face)                                 // cheap, no allocation kept
//       primitive = opened->primitive(face)
//       while (!primitive->diceable()) primitive->split() ...
//       grid = primitive->dice()
//
// Everything depends on primitive, camera and rates alone (decision 1), never on who asks.  Shared
// borders of neighbouring primitives are diced from edge data alone and their vertices are
// bit-identical at every knot. All methods are const and thread-safe.
//
// Primitives keep the opened instance alive; the View and the Report that it was opened with must
// outlive both.  Counting what is opened, split and diced is the caller's.
#pragma once

#include <memory>
#include <vector>

#include "base/report.h"
#include "dice/grid.h"
#include "scene/scene.h"

namespace granita {

/// What dicing needs of the frame; built once a frame.
struct View;

class Primitive {
  public:
    virtual ~Primitive() = default;
    virtual RasterBounds bounds() const = 0;
    /// [knots] boxes in camera space, equidistant, between which everything moves linearly.  Empty:
    /// it stands still, or bounds() must do.
    virtual std::vector<Bounds3f> knot_boxes() const { return {}; }
    virtual GridKey key() const = 0;
    virtual bool diceable() const = 0;
    /// At least two children, in a fixed order, that tile this one exactly.
    virtual std::vector<std::unique_ptr<Primitive>> split() const = 0;
    /// Positions and bounds; shading state and the material's attributes too, or else what makes
    /// them (Grid::shading_state).  Never shaded.  nullptr when every vertex is non-finite.
    virtual std::unique_ptr<Grid> dice() const = 0;
};

/// An instance's geometry in camera space at its knots, ready to hand out primitives.
class OpenedInstance {
  public:
    virtual ~OpenedInstance() = default;
    virtual std::size_t primitive_count() const = 0;
    virtual RasterBounds bounds(std::size_t primitive) const = 0;
    /// As Primitive::knot_boxes().
    virtual std::vector<Bounds3f> knot_boxes(std::size_t) const { return {}; }
    virtual std::unique_ptr<Primitive> primitive(std::size_t primitive) const = 0;
    virtual std::uint64_t bytes() const = 0;
};

}  // namespace granita
