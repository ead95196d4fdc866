// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that every CPU executor must pass: TEST_P(ExecutorTest, ...) with GetParam() the maker.
#pragma once

#include <gtest/gtest.h>

#include "grid_builder.h"

namespace granita::test {

class ExecutorTest : public testing::TestWithParam<HiderMaker> {};

inline std::string executor_name(const testing::TestParamInfo<HiderMaker>& info) {
    return info.param == make_reference_hider ? "reference" : "simd";
}

}  // namespace granita::test

#define GRANITA_BOTH_EXECUTORS(Suite)                                                \
    INSTANTIATE_TEST_SUITE_P(Executors, Suite,                                       \
                             testing::Values(make_reference_hider, make_simd_hider), \
                             granita::test::executor_name)
