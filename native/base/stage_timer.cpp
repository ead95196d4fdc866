// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/stage_timer.h"

#include <algorithm>
#include <chrono>

#include "base/system.h"

namespace granita {
namespace {

thread_local StageLedger* t_ledger = nullptr;
thread_local StageTimer* t_timer = nullptr;
/// Its address names the thread.
thread_local char t_here = 0;

double wall() {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration<double>(now).count();
}
double beside() {
    return process_seconds() - thread_seconds();
}

}  // namespace

StageLedger::StageLedger(Statistics& statistics)
    : m_statistics(statistics), m_outermost(t_ledger == nullptr) {
    if (!m_outermost) return;
    t_ledger = this;
    m_wall = wall();
    m_processor = thread_seconds();
}

StageLedger::~StageLedger() {
    if (!m_outermost) return;
    t_ledger = nullptr;
    const double passed = wall() - m_wall;
    const double part =
        passed > 0.0 ? std::min(1.0, (thread_seconds() - m_processor) / passed) : 0.0;
    for (std::size_t stage = 0; stage < m_seconds.size(); ++stage)
        if (m_seconds[stage] > 0.0)
            m_statistics.add_seconds(static_cast<Stage>(stage), part * m_seconds[stage]);
}

StageTimer::StageTimer(Statistics& statistics, Stage stage)
    : m_statistics(statistics),
      m_stage(stage),
      m_outer(t_timer),
      m_start(t_ledger ? wall() : thread_seconds()) {
    if (m_outer) m_outer->stop(m_start);
    t_timer = this;
}

StageTimer::~StageTimer() {
    const double now = t_ledger ? wall() : thread_seconds();
    stop(now);
    t_timer = m_outer;
    if (m_outer) m_outer->m_start = now;
}

void StageTimer::stop(double now) {
    if (t_ledger)
        t_ledger->m_seconds[static_cast<std::size_t>(m_stage)] += now - m_start;
    else
        m_statistics.add_seconds(m_stage, now - m_start);
}

StageTimer::Current StageTimer::current() {
    if (!t_timer) return {nullptr, Stage::Open, &t_here};
    return {&t_timer->m_statistics, t_timer->m_stage, &t_here};
}

StageShare::StageShare(const StageTimer::Current& of) : m_of(of) {
    if (m_of.thread == &t_here || t_timer || t_ledger) m_of.statistics = nullptr;
    if (!m_of.statistics) return;
    m_of.statistics->add(Counter::LoopPiecesShared);
    m_start = thread_seconds();
}

StageShare::~StageShare() {
    if (m_of.statistics) m_of.statistics->add_seconds(m_of.stage, thread_seconds() - m_start);
}

ForeignThreads::ForeignThreads() : m_start(beside()) {}

ForeignThreads::~ForeignThreads() {
    const StageTimer::Current of = StageTimer::current();
    if (of.statistics) of.statistics->add_seconds(of.stage, std::max(0.0, beside() - m_start));
}

}  // namespace granita
