// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/crash_report.h"

#include <algorithm>
#include <array>
#include <mutex>

#include "base/system.h"

namespace granita {
namespace {

constexpr std::size_t kMostText = 4096;

struct Armed {
    std::mutex mutex;
    int count = 0;
    std::array<char, kMostText> path{}, about{};
};

Armed& armed() {
    static Armed* const state = new Armed;  // a fault may come after static objects are gone
    return *state;
}

thread_local const char* t_work = nullptr;
thread_local const char* t_name = nullptr;

void write_report(const char* fault) {
    const char* const path = armed().path.data();
    const bool works = t_work != nullptr;
    if (write_fault_file(
            path,
            {"Granita ended by ", fault, "\n", armed().about.data(), works ? "\nThe thread " : "",
             works ? t_work : "", works ? " " : "", works ? t_name : "",
             "\n\nBacktrace (build id and offsets: docs/decisions/portable.md)\n"}))
        write_fault_message({"Granita: a report of the crash is in ", path, "\n"});
}

void copy(const std::string& text, std::array<char, kMostText>& to) {
    to.fill('\0');
    std::copy_n(text.begin(), std::min(text.size(), kMostText - 1), to.begin());
}

}  // namespace

CrashReport::CrashReport(const std::string& path, const std::string& about) {
    keep_stack_for_faults();
    Armed& state = armed();
    const std::lock_guard lock(state.mutex);
    copy(path, state.path);
    copy(about, state.about);
    if (state.count++ == 0) catch_faults(&write_report);
}

CrashReport::~CrashReport() {
    Armed& state = armed();
    const std::lock_guard lock(state.mutex);
    if (--state.count == 0) release_faults();
}

CrashScope::CrashScope(const char* work, const std::string& name) : m_work(t_work), m_name(t_name) {
    keep_stack_for_faults();
    t_work = work;
    t_name = name.c_str();
}

CrashScope::~CrashScope() {
    t_work = m_work;
    t_name = m_name;
}

}  // namespace granita
