// SPDX-License-Identifier: GPL-3.0-or-later
// A file that a fault leaves: what was rendered, what each thread's work was, a backtrace.
#pragma once

#include <string>

namespace granita {

/// While one lives, a fault in the process (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT) writes the
/// file first and then goes on to the handler that was there before: the host's, with its exit
/// code. Nothing is allocated in a fault.  Of several at once, the last one's file is written.  A
/// stack that overflows leaves one on the thread that made this, and on those with a CrashScope.
class CrashReport {
  public:
    /// `about`: lines that say what is rendered.
    CrashReport(const std::string& path, const std::string& about);
    ~CrashReport();
    CrashReport(const CrashReport&) = delete;
    CrashReport& operator=(const CrashReport&) = delete;
};

/// What this thread works at, for a crash report.  Two words are written: it costs nothing; a
/// thread's first takes memory for the stack of its faults, which lives as long as the thread.
class CrashScope {
  public:
    /// Both have to outlive it; `work` as in "dices".
    CrashScope(const char* work, const std::string& name);
    ~CrashScope();
    CrashScope(const CrashScope&) = delete;
    CrashScope& operator=(const CrashScope&) = delete;

  private:
    const char* m_work;
    const char* m_name;
};

}  // namespace granita
