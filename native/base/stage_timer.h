// SPDX-License-Identifier: GPL-3.0-or-later
// Processor time by stage.  Asking the system for a thread's processor time costs a microsecond,
// too much for each of a million grids; so stages take wall time, and a ledger around them, one a
// bucket, brings it to the processor time that the thread had meanwhile: a busy machine does not
// count.
#pragma once

#include <array>

#include "base/statistics.h"

namespace granita {

/// What this thread spends by stage while it lives, added to the statistics at its end.  Of nested
/// ledgers the outermost counts.
class StageLedger {
  public:
    explicit StageLedger(Statistics& statistics);
    ~StageLedger();
    StageLedger(const StageLedger&) = delete;
    StageLedger& operator=(const StageLedger&) = delete;

  private:
    friend class StageTimer;
    Statistics& m_statistics;
    bool m_outermost;
    double m_wall = 0.0, m_processor = 0.0;  ///< at its beginning
    std::array<double, static_cast<int>(Stage::kCount)> m_seconds{};
};

/// Adds the life time of the object to a stage: processor seconds of this thread.  Of nested timers
/// the inner one counts.  Without a ledger it asks the system itself.
class StageTimer {
  public:
    StageTimer(Statistics& statistics, Stage stage);
    ~StageTimer();
    StageTimer(const StageTimer&) = delete;
    StageTimer& operator=(const StageTimer&) = delete;

    /// The stage that a thread is in, for those that do a part of its work.
    struct Current {
        Statistics* statistics = nullptr;
        Stage stage = Stage::Open;
        const void* thread = nullptr;
    };
    static Current current();

  private:
    void stop(double now);

    Statistics& m_statistics;
    Stage m_stage;
    StageTimer* m_outer;
    double m_start;
};

/// On a thread that does a part of another's work: counts where the other does.
class StageShare {
  public:
    explicit StageShare(const StageTimer::Current& of);
    ~StageShare();
    StageShare(const StageShare&) = delete;
    StageShare& operator=(const StageShare&) = delete;

  private:
    StageTimer::Current m_of;
    double m_start = 0.0;
};

/// Of work that a library spreads over threads of its own while all of ours but this one wait:
/// adds what the process spent beside this thread to the stage that the thread is in.
class ForeignThreads {
  public:
    ForeignThreads();
    ~ForeignThreads();
    ForeignThreads(const ForeignThreads&) = delete;
    ForeignThreads& operator=(const ForeignThreads&) = delete;

  private:
    double m_start;
};

}  // namespace granita
