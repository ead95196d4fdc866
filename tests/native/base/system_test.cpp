// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/system.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

namespace granita {
namespace {

std::vector<std::byte> bytes(std::initializer_list<int> values) {
    std::vector<std::byte> out;
    for (const int value : values) out.push_back(static_cast<std::byte>(value));
    return out;
}

class TemporaryFileTest : public testing::Test {
  protected:
    void SetUp() override { std::filesystem::create_directory(folder); }
    void TearDown() override { std::filesystem::remove_all(folder); }

    std::filesystem::path folder = std::filesystem::temp_directory_path() /
                                   ("granita_temporary_file_test_" + std::to_string(getpid()));
    TemporaryFile file;
};

TEST_F(TemporaryFileTest, bytes_are_read_from_where_they_were_written) {
    ASSERT_FALSE(file.open(folder));
    ASSERT_FALSE(file.write(3, bytes({4, 5, 6})));
    ASSERT_FALSE(file.write(0, bytes({1, 2, 3})));
    std::vector<std::byte> read(4);
    EXPECT_FALSE(file.read(1, read));
    EXPECT_EQ(read, bytes({2, 3, 4, 5}));
}

TEST_F(TemporaryFileTest, it_has_no_name_while_it_is_open) {
    ASSERT_FALSE(file.open(folder));
    ASSERT_FALSE(file.write(0, bytes({1})));
    EXPECT_TRUE(file.is_open());
    EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST_F(TemporaryFileTest, reading_past_its_end_is_an_error) {
    ASSERT_FALSE(file.open(folder));
    ASSERT_FALSE(file.write(0, bytes({1, 2, 3})));
    std::vector<std::byte> read(2);
    EXPECT_FALSE(file.read(1, read));
    EXPECT_EQ(file.read(2, read), std::errc::io_error);
}

TEST_F(TemporaryFileTest, a_folder_that_is_not_there_is_the_reason_given) {
    EXPECT_EQ(file.open(folder / "nowhere"), std::errc::no_such_file_or_directory);
    EXPECT_FALSE(file.is_open());
}

TEST(System, a_library_that_is_nowhere_does_not_open) {
    EXPECT_TRUE(open_library("libc.so.6"));
    EXPECT_FALSE(open_library("libgranita_that_is_nowhere.so"));
}

stack_t fault_stack() {
    stack_t now{};
    sigaltstack(nullptr, &now);
    return now;
}

TEST(System, a_thread_that_has_a_stack_for_faults_keeps_its_own) {
    std::thread([] {
        const stack_t before = fault_stack();
        std::vector<std::byte> memory(1 << 16);
        stack_t own{};
        own.ss_sp = memory.data();
        own.ss_size = memory.size();
        ASSERT_EQ(sigaltstack(&own, nullptr), 0);
        keep_stack_for_faults();
        EXPECT_EQ(fault_stack().ss_sp, memory.data());
        sigaltstack(&before, nullptr);
    }).join();
}

}  // namespace
}  // namespace granita
