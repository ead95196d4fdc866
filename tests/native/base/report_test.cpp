// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/report.h"

#include <gtest/gtest.h>

#include "base/check.h"

namespace granita {
namespace {

TEST(Report, counts_equal_warnings_and_sorts_them) {
    Report report;
    report.warn("object 'B'", "is empty");
    report.warn("object 'A'", "is empty", 3);
    report.warn("object 'B'", "is empty");
    const auto list = report.warnings();
    ASSERT_EQ(list.size(), 2u);
    EXPECT_EQ(list[0].datablock, "object 'A'");
    EXPECT_EQ(list[0].count, 3u);
    EXPECT_EQ(list[1].count, 2u);
}

TEST(Report, adds_of_another_what_is_new_alone) {
    Report report, other;
    report.warn("object 'A'", "is empty");
    other.warn("object 'A'", "is empty");
    other.warn("object 'A'", "is far away", 2);
    report.add_new(other);
    const auto list = report.warnings();
    ASSERT_EQ(list.size(), 2u);
    EXPECT_EQ(list[0].count, 1u);
    EXPECT_EQ(list[1].message, "is far away");
    EXPECT_EQ(list[1].count, 2u);
}

TEST(Check, failure_throws_with_both_values) {
    try {
        GRANITA_CHECK_EQ(2 + 2, 5);
        FAIL();
    } catch (const InternalError& error) {
        EXPECT_NE(std::string(error.what()).find("4 against 5"), std::string::npos);
    }
}

}  // namespace
}  // namespace granita
