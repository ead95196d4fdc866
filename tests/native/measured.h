// SPDX-License-Identifier: GPL-3.0-or-later
// What a test measured against which limit, for the tables of docs (tests/case_table.py): the
// test's property "held" is the error that came nearest to its limit, and that limit.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace granita::test {

inline void note_held(double error, double limit) {
    static const testing::TestInfo* test = nullptr;
    static double worst = -1.0;
    const auto* const now = testing::UnitTest::GetInstance()->current_test_info();
    if (now != test) worst = -1.0;
    test = now;
    if (!(limit > 0.0) || !(error / limit > worst)) return;
    worst = error / limit;
    char held[64];
    std::snprintf(held, sizeof held, "%.3g %.3g", error, limit);
    testing::Test::RecordProperty("held", held);
}

inline testing::AssertionResult is_within(const char* value_text, const char* expected_text,
                                          const char* limit_text, double value, double expected,
                                          double limit) {
    note_held(std::fabs(value - expected), limit);
    if (std::fabs(value - expected) <= limit) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << value_text << " is " << value << ", not within " << limit << " (" << limit_text
           << ") of " << expected_text << ", " << expected;
}

}  // namespace granita::test

/// EXPECT_NEAR that notes what it measured.
#define EXPECT_WITHIN(value, expected, limit) \
    EXPECT_PRED_FORMAT3(granita::test::is_within, value, expected, limit)
