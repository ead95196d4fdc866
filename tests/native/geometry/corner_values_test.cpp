// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/corner_values.h"

#include <gtest/gtest.h>

#include <vector>

namespace granita {
namespace {

struct Value {
    std::vector<float> value, du, dv;
};

Value at(const CornerValues& corners, const Vec2d& uv, int width = 4) {
    Value found;
    interpolate(corners, PatchKind::SubFace, {&uv, 1}, width, found.value, found.du, found.dv);
    return found;
}

// Red along u, green along v, blue all but black, where the curve is straight; alpha along v.
CornerValues colors() {
    CornerValues corners;
    corners.at = {{{0.0, 0.2, 0.03, 0.0},
                   {1.0, 0.2, 0.03, 0.0},
                   {1.0, 0.8, 0.01, 1.0},
                   {0.0, 0.8, 0.01, 1.0}}};
    corners.encoded = true;
    return corners;
}

TEST(CornerValues, EncodedColorsAreDecodedAfterTheyAreBlended) {
    const std::vector<float> middle = at(colors(), {0.5, 0.5}).value;
    EXPECT_NEAR(middle[0], 0.21404, 1e-5);  // of .5 by IEC 61966-2-1
    EXPECT_NEAR(middle[1], 0.21404, 1e-5);
    EXPECT_NEAR(middle[2], 0.02 / 12.92, 1e-7);
    EXPECT_EQ(middle[3], 0.5f);
    CornerValues linear = colors();
    linear.encoded = false;
    EXPECT_EQ(at(linear, {0.5, 0.5}).value[0], 0.5f);
}

TEST(CornerValues, TheirDerivativesAreThoseOfWhatIsDecoded) {
    constexpr double kStep = 1e-3;
    const CornerValues corners = colors();
    for (const Vec2d& uv : {Vec2d(0.5, 0.5), Vec2d(0.2, 0.9), Vec2d(0.03, 0.4)}) {
        const Value here = at(corners, uv);
        const Value before = at(corners, uv - Vec2d(kStep, 0.0)),
                    after = at(corners, uv + Vec2d(kStep, 0.0)),
                    below = at(corners, uv - Vec2d(0.0, kStep)),
                    above = at(corners, uv + Vec2d(0.0, kStep));
        for (std::size_t c = 0; c < 4; ++c) {
            EXPECT_NEAR(here.du[c], (after.value[c] - before.value[c]) / (2.0 * kStep), 2e-4);
            EXPECT_NEAR(here.dv[c], (above.value[c] - below.value[c]) / (2.0 * kStep), 2e-4);
        }
    }
}

}  // namespace
}  // namespace granita
