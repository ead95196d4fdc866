// SPDX-License-Identifier: GPL-3.0-or-later
#include "hider/raster/raster_filter.h"

#include <gtest/gtest.h>

#include "base/check.h"
#include "raster_scene.h"

namespace granita {
namespace {

TEST(RasterFilter, box_is_the_mean_of_the_pixels_own_sub_samples) {
    for (const int lattice : {1, 2, 3, 8}) {
        const RasterFilter box = raster_test::box_filter(lattice);
        EXPECT_EQ(box.first, 0);
        EXPECT_EQ(box.margin(), 0);
        ASSERT_EQ(box.weights.size(), static_cast<std::size_t>(lattice));
        for (const double weight : box.weights) EXPECT_DOUBLE_EQ(weight, 1.0 / lattice);
    }
}

TEST(RasterFilter, weights_are_symmetric_with_sum_one_and_the_apron_holds_them) {
    for (const int lattice : {1, 2, 5, 8}) {
        const RasterFilter f = make_raster_filter(lattice, 2.0, raster_test::mitchell);
        double sum = 0.0;
        for (std::size_t i = 0; i < f.weights.size(); ++i) {
            sum += f.weights[i];
            EXPECT_NEAR(f.weights[i], f.weights[f.weights.size() - 1 - i], 1e-15);
        }
        EXPECT_NEAR(sum, 1.0, 1e-12);
        // Support -2 .. 2 about the pixel's centre: -1.5 .. 2.5 about its corner.
        EXPECT_EQ(f.margin(), lattice == 1 ? 1 : 2);
        EXPECT_GE(f.first, -f.margin() * lattice);
        EXPECT_LE(f.first + static_cast<int>(f.weights.size()), (1 + f.margin()) * lattice);
    }
}

TEST(RasterFilter, narrower_than_the_lattice_takes_the_nearest_sub_samples) {
    const auto nothing = [](double) { return 0.0; };
    EXPECT_EQ(make_raster_filter(4, 0.01, nothing).weights, std::vector<double>({0.5, 0.5}));
    EXPECT_EQ(make_raster_filter(4, 0.01, nothing).first, 1);
    EXPECT_EQ(make_raster_filter(3, 0.01, nothing).weights, std::vector<double>({1.0}));
    EXPECT_EQ(make_raster_filter(3, 0.01, nothing).first, 1);
}

TEST(RasterFilter, refuses_a_radius_that_is_no_length) {
    EXPECT_THROW(make_raster_filter(4, 0.0, raster_test::mitchell), InternalError);
    EXPECT_THROW(make_raster_filter(4, NAN, raster_test::mitchell), InternalError);
}

}  // namespace
}  // namespace granita
