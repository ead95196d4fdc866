// SPDX-License-Identifier: GPL-3.0-or-later
// One frame being rendered on its own threads; finished tiles leave through one queue (decision
// 14).
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/report.h"
#include "base/statistics.h"
#include "film/film.h"
#include "render/choose_executor.h"
#include "render/dearest_objects.h"
#include "render/session.h"
#include "scene/scene.h"

namespace granita {

class RenderJob {
  public:
    /// Starts at once; returns before the frame is done, unless not one more thread can be made.
    /// The scene is shared and immutable.  `gpu`: as in choose_executor.h.  `session`: whose scene
    /// it was made (Session::adopt); without one, nothing is kept.
    ///
    /// A GPU that fails in mid-frame costs the time spent: the CPU begins the frame anew, with one
    /// warning, and its tiles follow those that the GPU has finished and replace them.
    explicit RenderJob(std::shared_ptr<const Scene> scene,
                       const gl::ContextOptions& gpu = kHardware,
                       std::shared_ptr<Session> session = nullptr);
    /// Cancels and joins.
    ~RenderJob();

    /// Finished tiles; waits at most `seconds` for the first.
    std::vector<Tile> take_tiles(double seconds);
    bool done() const;  ///< no tile will come any more and the threads are idle
    double fraction() const;
    /// Buckets done and in all, for "Sample k/n".
    long buckets_done() const;
    long buckets_total() const;
    /// Ends soon, and delivers no tile any more.
    void cancel();
    /// Joins; rethrows the first failure (SceneError, GlError, Cancelled, ...).
    void finish();

    /// Once the frame is finished: pixels of each bucket and the processor seconds of the
    /// thread that rendered it.
    std::vector<std::pair<Rect, double>> bucket_seconds() const;
    const Statistics& statistics() const;
    /// So far.
    std::vector<DearObject> dearest_objects(std::size_t most) const;
    const Report& report() const;
    std::string device() const;
    /// Of the GPU, once the frame is finished; 0 where there was none.
    gl::DeviceUse device_use() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace granita
