// SPDX-License-Identifier: GPL-3.0-or-later
#include "shade/lights/shadow_agreement.h"

#include <gtest/gtest.h>

namespace granita {
namespace {

using Answer = ShadowAgreement::Answer;

constexpr std::size_t kSide = 24;
constexpr std::size_t at(std::size_t column, std::size_t row) {
    return row * kSide + column;
}

/// Four rays of each point of a square grid that find `through`, but for one of a single point.
ShadowAgreement grid(const Vec3f& through, std::size_t other, const Vec3f& found,
                     std::size_t columns = kSide) {
    ShadowAgreement agreement(kSide * kSide, columns);
    for (std::size_t i = 0; i < kSide * kSide; ++i)
        for (int ray = 0; ray < 4; ++ray)
            agreement.add(i, i == other && ray == 2 ? found : through);
    agreement.share();
    return agreement;
}

TEST(ShadowAgreement, AnswersWhereAllAroundAgree) {
    const ShadowAgreement open = grid(Vec3f(1.0f), 0, Vec3f(1.0f));
    const ShadowAgreement closed = grid(Vec3f(0.0f), 0, Vec3f(0.0f));
    for (std::size_t i = 0; i < kSide * kSide; ++i) {
        EXPECT_EQ(open.answer(i), Answer::Open) << i;
        EXPECT_EQ(closed.answer(i), Answer::Closed) << i;
    }
}

TEST(ShadowAgreement, OneRayOfOnePointIsKnownFourPointsAround) {
    const ShadowAgreement agreement = grid(Vec3f(1.0f), at(10, 12), Vec3f(0.0f));
    for (std::size_t row = 0; row < kSide; ++row)
        for (std::size_t column = 0; column < kSide; ++column) {
            const bool is_near = column >= 6 && column <= 14 && row >= 8 && row <= 16;
            EXPECT_EQ(agreement.answer(at(column, row)), is_near ? Answer::None : Answer::Open);
        }
}

TEST(ShadowAgreement, RowsDoNotGoOnInTheNext) {
    const ShadowAgreement agreement = grid(Vec3f(0.0f), at(kSide - 1, 12), Vec3f(1.0f));
    EXPECT_EQ(agreement.answer(at(kSide - 5, 12)), Answer::None);
    EXPECT_EQ(agreement.answer(at(0, 12)), Answer::Closed);
    EXPECT_EQ(agreement.answer(at(0, 13)), Answer::Closed);
}

TEST(ShadowAgreement, WhatLetsAPartThroughIsNeither) {
    EXPECT_EQ(grid(Vec3f(0.5f), 0, Vec3f(0.5f)).answer(at(12, 12)), Answer::None);
    EXPECT_EQ(grid(Vec3f(1.0f), at(12, 12), Vec3f(1.0f, 1.0f, 0.9f)).answer(at(12, 12)),
              Answer::None);
}

TEST(ShadowAgreement, FewRaysTellNothing) {
    ShadowAgreement few(16, 4), none(kSide * kSide, kSide);
    for (std::size_t i = 0; i < 16; ++i)
        for (int ray = 0; ray < 4; ++ray) few.add(i, Vec3f(1.0f));
    few.share();
    none.share();
    EXPECT_EQ(few.answer(5), Answer::None);
    EXPECT_EQ(none.answer(at(12, 12)), Answer::None);
}

TEST(ShadowAgreement, SeparateFacesAskThoseBeforeAndAfter) {
    const ShadowAgreement agreement = grid(Vec3f(1.0f), 100, Vec3f(0.0f), 0);
    EXPECT_EQ(agreement.answer(67), Answer::Open);
    EXPECT_EQ(agreement.answer(68), Answer::None);
    EXPECT_EQ(agreement.answer(132), Answer::None);
    EXPECT_EQ(agreement.answer(133), Answer::Open);
}

}  // namespace
}  // namespace granita
