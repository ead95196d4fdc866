// SPDX-License-Identifier: GPL-3.0-or-later
// A surface's program, run over points: what it leaves there.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "shade/nodes/node_compiler.h"

namespace granita {

/// The values of a source at all points of a run.
template <class T>
std::vector<T> values_of(const Run& run, const Source<T>& source) {
    const Column<T> column = run.read(source);
    std::vector<T> values(run.count());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = column[i];
    return values;
}

/// Values that are no numbers become 0; returns how many did.
std::size_t make_finite(std::vector<Vec3f>& values);

class SurfaceRun {
  public:
    /// `surface` and `in`, its points among it, must outlive this.
    SurfaceRun(const SurfaceProgram& surface, const ShadingInput& in);
    SurfaceRun(const SurfaceRun&) = delete;
    SurfaceRun& operator=(const SurfaceRun&) = delete;

    /// Those of the input; their normals bent where a displacement says so.
    const ShadingPoints& points() const { return m_bent ? *m_bent : *m_points; }
    const SurfaceClosure& closure() const { return m_closure; }
    /// To be changed; leaves none here.
    SurfaceClosure take_closure() { return std::move(m_closure); }
    /// Weights of lobes that are no numbers: as in Cycles such a lobe is not there.
    std::size_t broken() const { return m_broken; }
    const Run& run() const { return m_run; }

  private:
    const ShadingPoints* m_points;
    Run m_run;
    std::optional<ShadingPoints> m_bent;
    SurfaceClosure m_closure;
    std::size_t m_broken = 0;
};

}  // namespace granita
