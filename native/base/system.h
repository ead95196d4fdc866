// SPDX-License-Identifier: GPL-3.0-or-later
// What Granita asks of the operating system, in no system's terms.  system_posix.cpp is the one
// file that calls it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <system_error>

namespace granita {

/// Asks for large pages under memory that was just taken.  A wish: it cannot fail.
void want_huge_pages(void* memory, std::size_t bytes);

/// Bytes that the system cannot take back from this process by itself, swapped out or not: files
/// that are mapped do not count.  0 where it does not tell.
std::uint64_t process_memory();

/// Has the C library give back what it keeps of what was freed.
void return_freed_memory();

/// Processor seconds that this thread has had: a busy machine does not count.  Asking takes a
/// microsecond.
double thread_seconds();

/// Processor seconds that all threads of the process have had.
double process_seconds();

/// Whether there is a shared library of that name.  It stays open: what opens it later gets this.
bool open_library(const char* name);

/// A file without a name: it goes with the object, or with the process whatever becomes of it.
class TemporaryFile {
  public:
    TemporaryFile() = default;
    ~TemporaryFile();
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    bool is_open() const { return m_file != kNone; }
    /// Makes it, once.
    std::error_code open(const std::filesystem::path& folder);
    /// All the bytes, or why not.  Thread-safe where the bytes of no two calls are the same.
    std::error_code write(std::uint64_t offset, std::span<const std::byte> bytes);
    /// All the bytes, or why not; a file that ends before them is an error.  Thread-safe.
    std::error_code read(std::uint64_t offset, std::span<std::byte> bytes) const;

  private:
    static constexpr std::intptr_t kNone = -1;
    std::intptr_t m_file = kNone;  ///< the system's name for it
};

/// Called on the thread that has the fault, with the fault's name as in "SIGSEGV".  It may neither
/// allocate nor lock.
using FaultHandler = void (*)(const char* fault);

/// From now on a fault in the process (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT) calls the handler
/// and then goes on to what handled it before.  Not thread-safe, and not twice in a row.
void catch_faults(FaultHandler handler);
/// Puts back what handled faults before; what another has set since stays.
void release_faults();

/// Lets faults be handled on this thread when its own stack is full, until it ends.  Every call but
/// a thread's first looks at a flag of the thread and no more.
void keep_stack_for_faults();

/// May be called in a fault: writes a file of these texts, one after the other, and of the calls
/// that led here.  @return false: it cannot be made.
bool write_fault_file(const char* path, std::initializer_list<const char*> texts);
/// May be called in a fault: writes the texts to the standard error.
void write_fault_message(std::initializer_list<const char*> texts);

}  // namespace granita
