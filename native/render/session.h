// SPDX-License-Identifier: GPL-3.0-or-later
// What outlives a picture: an edit makes again what depends on it and nothing else.
//
//   an edit of                                                parts of geometry   its rays
//   its own bytes; Blender's time in the shutter              made again          made again
//   how casters use it (opacity, lifespans, sets of lights)   kept                made again
//   view, transforms; a subdivision surface                   kept                made again
//   view, transforms; others                                  kept                kept
//   view, transforms, its displacement; what is displaced     kept                made again
//   lens, lights, colours, samples, film                      kept                kept
//
// What samples have seen and how grids were shaded is kept by picture (persistent_visibility.h);
// which edit each of them reads stands in scene/scene_changes.h.
//
// A final frame is a session that lives for one picture.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "render/persistent_visibility.h"
#include "scene/scene.h"
#include "shade/persistent_shading.h"

namespace granita {

/// Thread-safe; shared by the jobs that use it, of which one may still be ending when the next has
/// begun.
class Session {
  public:
    /// Before the scene is rendered: geometries that are the same in every byte as one of the scene
    /// before become that one; what is made of others is forgotten.
    void adopt(Scene& scene);

    const PersistentShading& shading() const { return m_shading; }

    /// What a picture of the scene's size has left, or nullptr.  Who takes it has it alone.
    std::unique_ptr<PersistentVisibility> take_visibility(const Scene& scene);
    /// Of the pictures that came last, one of each size, as many as fit in
    /// PersistentVisibility::kMostBytes.
    void keep(std::unique_ptr<PersistentVisibility> visibility);

    /// Since the session began.
    std::uint64_t geometries_adopted() const { return m_adopted; }
    std::uint64_t geometries_made() const { return m_shading.geometry->made(); }
    std::uint64_t ray_shapes_made() const { return m_shading.rays->made(); }

  private:
    std::mutex m_mutex;
    PersistentShading m_shading;
    GeometryList m_before;
    std::vector<std::unique_ptr<PersistentVisibility>> m_visibility;  ///< latest first
    std::atomic<std::uint64_t> m_adopted{0};
};

}  // namespace granita
