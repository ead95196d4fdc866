// SPDX-License-Identifier: GPL-3.0-or-later
// Shading normals of a polygon mesh whose shape changes while the shutter is open.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "math/vec.h"
#include "scene/knot_time.h"

namespace granita {

class CarriedNormals;
class SharedGeometry;

/// When they are known: at the knots of its points and, where that lies between two, at the frame
/// time.
struct NormalTimes {
    std::size_t knots = 1;
    KnotTime frame;

    bool frame_is_knot() const { return frame.fraction == 0.0; }
    std::size_t count() const { return knots + (frame_is_knot() ? 0 : 1); }
    /// Which of them is the frame time.
    std::size_t frame_number() const { return frame.knot + (frame_is_knot() ? 0 : 1); }
    /// Of a time among the knots: which of them, and how much of the way to the next.
    KnotTime at(KnotTime t) const;
    /// Of a time of the shutter.
    KnotTime at(float time) const {
        return at(knot_time(static_cast<double>(time), static_cast<int>(knots)));
    }
};

/// Unit or zero, object space.
/// What is smooth has Blender's vertex normals anew at each knot.  Normals that were given go along
/// with the faces around the vertex that have them in common.
class KnotNormals {
  public:
    /// The geometry, which is no subdivision surface, outlives this.
    explicit KnotNormals(const SharedGeometry& geometry);
    ~KnotNormals();

    const NormalTimes& times() const { return m_times; }
    /// Of a corner at one of times().
    const Vec3f& of(std::uint32_t corner, std::size_t number) const;
    /// Between two of them.
    Vec3d of(std::uint32_t corner, const KnotTime& time) const;

  private:
    const SharedGeometry& m_geometry;
    NormalTimes m_times;
    std::unique_ptr<const CarriedNormals> m_carried;  ///< nullptr: all are vertices' own
    /// [times][vertices, or groups of what is carried]; empty at the frame time: the geometry's own
    std::vector<std::vector<Vec3f>> m_at;
};

}  // namespace granita
