// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/crash_report.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

namespace granita {
namespace {

std::string path_of_report() {
    return (std::filesystem::temp_directory_path() / "granita_crash_report_test.txt").string();
}

std::string text_of(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
}

void fault_in_a_thread() {
    const CrashReport report(path_of_report(), "frame 7 of 'Scene'");
    const std::string name = "object 'Cube'";
    std::thread([&name] {
        const CrashScope scope("dices", name);
        { const CrashScope inner("shades", name); }
        std::raise(SIGSEGV);
    }).join();
}

/// A call within a call, without end for any stack; what comes after each keeps it from being a
/// loop.
unsigned call_on(unsigned depth) {
    volatile unsigned frame[64];
    frame[0] = depth;
    return depth + 1 == 0 ? 0 : call_on(depth + 1) + frame[0];
}

void overflow_where_the_report_was_made() {
    std::thread([] {
        const CrashReport report(path_of_report(), "");
        call_on(0);
    }).join();
}

void overflow_in_a_scope() {
    const CrashReport report(path_of_report(), "");
    const std::string name = "object 'Cube'";
    std::thread([&name] {
        const CrashScope scope("opens", name);
        call_on(0);
    }).join();
}

/// Under a sanitizer the handler of before is its own, and ends otherwise.
bool ended_badly(int status) {
    return !WIFEXITED(status) || WEXITSTATUS(status) != 0;
}

[[noreturn]] void hosts_handler(int) {
    std::_Exit(42);
}

TEST(CrashReportDeathTest, AFaultLeavesAFile) {
    testing::GTEST_FLAG(death_test_style) = "threadsafe";
    std::filesystem::remove(path_of_report());
    EXPECT_EXIT(fault_in_a_thread(), ended_badly, "a report of the crash");
    const std::string text = text_of(path_of_report());
    EXPECT_NE(text.find("ended by SIGSEGV"), std::string::npos) << text;
    EXPECT_NE(text.find("frame 7 of 'Scene'"), std::string::npos) << text;
    EXPECT_NE(text.find("The thread dices object 'Cube'"), std::string::npos) << text;
    EXPECT_NE(text.find("granita_test_base"), std::string::npos) << text;  // the backtrace
    std::filesystem::remove(path_of_report());
}

TEST(CrashReportDeathTest, TheHostsHandlerHasTheLastWord) {
    testing::GTEST_FLAG(death_test_style) = "threadsafe";
    EXPECT_EXIT(
        {
            std::signal(SIGABRT, &hosts_handler);
            const CrashReport report(path_of_report(), "");
            std::abort();
        },
        testing::ExitedWithCode(42), "a report of the crash");
    std::filesystem::remove(path_of_report());
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SKIP_UNDER_A_SANITIZER() GTEST_SKIP() << "a sanitizer has frames and handlers of its own"
#else
#define SKIP_UNDER_A_SANITIZER()
#endif

TEST(CrashReportDeathTest, AnOverflowOfTheStackLeavesAFile) {
    SKIP_UNDER_A_SANITIZER();
    testing::GTEST_FLAG(death_test_style) = "threadsafe";
    EXPECT_EXIT(overflow_where_the_report_was_made(), testing::KilledBySignal(SIGSEGV),
                "a report of the crash");
    std::filesystem::remove(path_of_report());
}

TEST(CrashReportDeathTest, AnOverflowOfTheStackInAScopeNamesItsWork) {
    SKIP_UNDER_A_SANITIZER();
    testing::GTEST_FLAG(death_test_style) = "threadsafe";
    std::filesystem::remove(path_of_report());
    EXPECT_EXIT(overflow_in_a_scope(), testing::KilledBySignal(SIGSEGV), "a report of the crash");
    const std::string text = text_of(path_of_report());
    EXPECT_NE(text.find("ended by SIGSEGV"), std::string::npos) << text;
    EXPECT_NE(text.find("The thread opens object 'Cube'"), std::string::npos) << text;
    EXPECT_NE(text.find("granita_test_base"), std::string::npos) << text;  // the backtrace
    std::filesystem::remove(path_of_report());
}

TEST(CrashReport, HandlersAreThoseOfBeforeWhenItIsGone) {
    struct sigaction before {
    }, after{};
    ::sigaction(SIGSEGV, nullptr, &before);
    {
        const CrashReport report(path_of_report(), "");
        const CrashReport another(path_of_report(), "");
        ::sigaction(SIGSEGV, nullptr, &after);
        EXPECT_NE(before.sa_handler, after.sa_handler);
    }
    ::sigaction(SIGSEGV, nullptr, &after);
    EXPECT_EQ(before.sa_handler, after.sa_handler);
}

}  // namespace
}  // namespace granita
