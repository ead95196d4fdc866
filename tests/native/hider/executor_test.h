// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that every executor of any sampling must pass: TEST_P(ExecutorTest, ...) with GetParam()
// the maker.
#pragma once

#include <gtest/gtest.h>

#include "grid_builder.h"
#include "hider/compute/compute_executor.h"

namespace granita::test {

class ExecutorTest : public testing::TestWithParam<HiderMaker> {};

inline std::string executor_name(const testing::TestParamInfo<HiderMaker>& info) {
    if (info.param == make_reference_hider) return "reference";
    if (info.param == raster_executor) return "raster";
    return info.param == make_simd_hider ? "simd" : "compute";
}

}  // namespace granita::test

#define GRANITA_EXECUTORS(Suite, ...)                                        \
    INSTANTIATE_TEST_SUITE_P(Executors, Suite, testing::Values(__VA_ARGS__), \
                             granita::test::executor_name)
/// Tests that look at samples.
#define GRANITA_STORING_EXECUTORS(Suite)                            \
    GRANITA_EXECUTORS(Suite, make_reference_hider, make_simd_hider, \
                      granita::test::make_device_hider)
/// Tests that look at pictures.
#define GRANITA_ALL_EXECUTORS(Suite)                                \
    GRANITA_EXECUTORS(Suite, make_reference_hider, make_simd_hider, \
                      granita::test::make_device_hider, granita::test::raster_executor)
