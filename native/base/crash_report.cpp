// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/crash_report.h"

#include <execinfo.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstring>
#include <mutex>

namespace granita {
namespace {

constexpr std::array kSignals{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
constexpr std::size_t kMostText = 4096;

struct Armed {
    std::mutex mutex;
    int count = 0;
    std::array<char, kMostText> path{}, about{};
    std::array<struct sigaction, kSignals.size()> before{};
};

Armed& armed() {
    static Armed* const state = new Armed;  // a fault may come after static objects are gone
    return *state;
}

thread_local const char* t_work = nullptr;
thread_local const char* t_name = nullptr;

void put(int file, const char* text) {
    std::size_t left = std::strlen(text);
    while (left > 0) {
        const ssize_t done = ::write(file, text, left);
        if (done <= 0) return;
        text += done;
        left -= static_cast<std::size_t>(done);
    }
}

const char* name_of(int signal) {
    switch (signal) {
        case SIGSEGV:
            return "SIGSEGV";
        case SIGBUS:
            return "SIGBUS";
        case SIGFPE:
            return "SIGFPE";
        case SIGILL:
            return "SIGILL";
        default:
            return "SIGABRT";
    }
}

void write_report(int signal) {
    const Armed& state = armed();
    const int file = ::open(state.path.data(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (file < 0) return;
    put(file, "Granita ended by ");
    put(file, name_of(signal));
    put(file, "\n");
    put(file, state.about.data());
    if (t_work != nullptr) {
        put(file, "\nThe thread ");
        put(file, t_work);
        put(file, " ");
        put(file, t_name);
    }
    put(file, "\n\nBacktrace (build id and offsets: docs/decisions/portable.md)\n");
    std::array<void*, 64> frames{};
    const int count = ::backtrace(frames.data(), static_cast<int>(frames.size()));
    ::backtrace_symbols_fd(frames.data(), count, file);
    ::close(file);
    put(STDERR_FILENO, "Granita: a report of the crash is in ");
    put(STDERR_FILENO, state.path.data());
    put(STDERR_FILENO, "\n");
}

void on_fault(int signal) {
    Armed& state = armed();
    const auto at = std::find(kSignals.begin(), kSignals.end(), signal) - kSignals.begin();
    // First, so that a fault in here ends as if there were no report.
    ::sigaction(signal, &state.before[static_cast<std::size_t>(at)], nullptr);
    write_report(signal);
    ::raise(signal);  // held back until this returns; then the handler of before has it
}

void copy(const std::string& text, std::array<char, kMostText>& to) {
    to.fill('\0');
    std::copy_n(text.begin(), std::min(text.size(), kMostText - 1), to.begin());
}

}  // namespace

CrashReport::CrashReport(const std::string& path, const std::string& about) {
    Armed& state = armed();
    const std::lock_guard lock(state.mutex);
    copy(path, state.path);
    copy(about, state.about);
    if (state.count++ > 0) return;
    void* frame = nullptr;
    ::backtrace(&frame, 1);  // the first call loads a library, which a fault could not
    struct sigaction action {};
    action.sa_handler = &on_fault;
    sigemptyset(&action.sa_mask);
    for (std::size_t i = 0; i < kSignals.size(); ++i)
        ::sigaction(kSignals[i], &action, &state.before[i]);
}

CrashReport::~CrashReport() {
    Armed& state = armed();
    const std::lock_guard lock(state.mutex);
    if (--state.count > 0) return;
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
        struct sigaction now {};
        ::sigaction(kSignals[i], nullptr, &now);
        // Another's, set since: it stays.
        if (now.sa_handler == &on_fault) ::sigaction(kSignals[i], &state.before[i], nullptr);
    }
}

CrashScope::CrashScope(const char* work, const std::string& name) : m_work(t_work), m_name(t_name) {
    t_work = work;
    t_name = name.c_str();
}

CrashScope::~CrashScope() {
    t_work = m_work;
    t_name = m_name;
}

}  // namespace granita
