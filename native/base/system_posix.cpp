// SPDX-License-Identifier: GPL-3.0-or-later
#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <unistd.h>
#ifdef __linux__
#include <malloc.h>
#include <sys/mman.h>
#endif

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <memory>
#include <new>
#include <string>
#include <string_view>

#include "base/system.h"

namespace granita {
namespace {

double seconds(clockid_t clock) {
    timespec t{};
    clock_gettime(clock, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

std::error_code reason() {
    return {errno, std::generic_category()};
}

/// Calls `step(done)`, which returns the bytes it got through or -1, until `count` are done.
template <class Step>
std::error_code do_all(std::size_t count, const Step& step) {
    for (std::size_t done = 0; done < count;) {
        const ssize_t more = step(done);
        if (more < 0 && errno == EINTR) continue;
        if (more < 0) return reason();
        if (more == 0) return std::make_error_code(std::errc::io_error);
        done += static_cast<std::size_t>(more);
    }
    return {};
}

struct Fault {
    int signal;
    const char* name;
    struct sigaction before;
};

constinit std::array<Fault, 5> g_faults{{{SIGSEGV, "SIGSEGV", {}},
                                         {SIGBUS, "SIGBUS", {}},
                                         {SIGFPE, "SIGFPE", {}},
                                         {SIGILL, "SIGILL", {}},
                                         {SIGABRT, "SIGABRT", {}}}};
constinit FaultHandler g_handler = nullptr;

void on_fault(int signal) {
    for (const Fault& fault : g_faults)
        if (fault.signal == signal) {
            // First, so that a fault in here ends as if there were no handler.
            sigaction(signal, &fault.before, nullptr);
            g_handler(fault.name);
        }
    raise(signal);  // held back until this returns; then the handler of before has it
}

/// The stack that a thread's faults are handled on, unless it has one: a sanitizer's, the host's.
class FaultStack {
  public:
    FaultStack() {
        stack_t now{};
        if (sigaltstack(nullptr, &now) != 0 || (now.ss_flags & SS_DISABLE) == 0) return;
        m_memory.reset(new (std::nothrow) std::byte[kBytes]);
        stack_t own{};
        own.ss_sp = m_memory.get();
        own.ss_size = kBytes;
        if (m_memory && sigaltstack(&own, nullptr) != 0) m_memory.reset();
    }
    ~FaultStack() {
        stack_t now{}, none{};
        none.ss_flags = SS_DISABLE;
        if (!m_memory || sigaltstack(nullptr, &now) != 0) return;
        if (now.ss_sp == m_memory.get()) sigaltstack(&none, nullptr);
    }
    FaultStack(const FaultStack&) = delete;
    FaultStack& operator=(const FaultStack&) = delete;

  private:
    /// Registers of the widest units, the handler, the unwinder; pages that are not used cost none.
    static constexpr std::size_t kBytes = std::size_t{1} << 16;
    std::unique_ptr<std::byte[]> m_memory;
};

void put(int file, std::initializer_list<const char*> texts) {
    for (const std::string_view text : texts) {
        const auto step = [&](std::size_t done) {
            return write(file, text.data() + done, text.size() - done);
        };
        if (do_all(text.size(), step)) return;
    }
}

}  // namespace

#ifdef __linux__
void want_huge_pages(void* memory, std::size_t bytes) {
    madvise(memory, bytes, MADV_HUGEPAGE);
}

std::uint64_t process_memory() {
    std::uint64_t kibibytes = 0;  // proc(5), status
    std::ifstream status("/proc/self/status");
    for (std::string name; status >> name; status.ignore(256, '\n')) {
        std::uint64_t size = 0;
        if ((name == "RssAnon:" || name == "RssShmem:" || name == "VmSwap:") && status >> size)
            kibibytes += size;
    }
    return kibibytes << 10;
}

void return_freed_memory() {
    malloc_trim(0);
}
#else
void want_huge_pages(void*, std::size_t) {}

std::uint64_t process_memory() {
    return 0;
}

void return_freed_memory() {}
#endif

double thread_seconds() {
    return seconds(CLOCK_THREAD_CPUTIME_ID);
}

double process_seconds() {
    return seconds(CLOCK_PROCESS_CPUTIME_ID);
}

bool open_library(const char* name) {
    return dlopen(name, RTLD_LAZY | RTLD_LOCAL) != nullptr;
}

TemporaryFile::~TemporaryFile() {
    if (is_open()) close(static_cast<int>(m_file));
}

std::error_code TemporaryFile::open(const std::filesystem::path& folder) {
    std::string name = (folder / "granita-XXXXXX").string();
    m_file = mkostemp(name.data(), O_CLOEXEC);
    if (!is_open()) return reason();
    unlink(name.c_str());
    return {};
}

std::error_code TemporaryFile::write(std::uint64_t offset, std::span<const std::byte> bytes) {
    return do_all(bytes.size(), [&](std::size_t done) {
        return pwrite(static_cast<int>(m_file), bytes.data() + done, bytes.size() - done,
                      static_cast<off_t>(offset + done));
    });
}

std::error_code TemporaryFile::read(std::uint64_t offset, std::span<std::byte> bytes) const {
    return do_all(bytes.size(), [&](std::size_t done) {
        return pread(static_cast<int>(m_file), bytes.data() + done, bytes.size() - done,
                     static_cast<off_t>(offset + done));
    });
}

void catch_faults(FaultHandler handler) {
    g_handler = handler;
    void* frame = nullptr;
    backtrace(&frame, 1);  // the first call loads a library, which a fault could not
    struct sigaction action {};
    action.sa_handler = &on_fault;
    action.sa_flags = SA_ONSTACK;
    sigemptyset(&action.sa_mask);
    for (Fault& fault : g_faults) sigaction(fault.signal, &action, &fault.before);
}

void release_faults() {
    for (const Fault& fault : g_faults) {
        struct sigaction now {};
        sigaction(fault.signal, nullptr, &now);
        if (now.sa_handler == &on_fault) sigaction(fault.signal, &fault.before, nullptr);
    }
}

void keep_stack_for_faults() {
    thread_local const FaultStack stack;
}

bool write_fault_file(const char* path, std::initializer_list<const char*> texts) {
    const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (file < 0) return false;
    put(file, texts);
    std::array<void*, 64> frames{};
    const int count = backtrace(frames.data(), static_cast<int>(frames.size()));
    backtrace_symbols_fd(frames.data(), count, file);
    close(file);
    return true;
}

void write_fault_message(std::initializer_list<const char*> texts) {
    put(STDERR_FILENO, texts);
}

}  // namespace granita
