// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/geometry_node.h"

#include <gtest/gtest.h>

namespace granita {
namespace {

/// Splits along x until a piece is at most `leaf` wide; counts what is alive.
struct Strip : Primitive {
    Strip(float lo, float hi, float leaf, int& alive)
        : x0(lo), x1(hi), leaf_width(leaf), count(alive) {
        ++count;
    }
    ~Strip() override { --count; }
    RasterBounds bounds() const override {
        RasterBounds b;
        b.x0 = x0, b.x1 = x1, b.y0 = 1, b.y1 = 2;
        b.visible = true;
        return b;
    }
    GridKey key() const override { return {}; }
    bool diceable() const override { return x1 - x0 <= leaf_width; }
    std::vector<std::unique_ptr<Primitive>> split() const override {
        const float middle = 0.5f * (x0 + x1);
        std::vector<std::unique_ptr<Primitive>> parts;
        parts.push_back(std::make_unique<Strip>(x0, middle, leaf_width, count));
        parts.push_back(std::make_unique<Strip>(middle, x1, leaf_width, count));
        return parts;
    }
    std::unique_ptr<Grid> dice() const override {
        auto grid = std::make_unique<Grid>();
        grid->n_u = grid->n_v = 1;
        grid->positions.resize(4);
        grid->bounds = bounds();
        return grid;
    }
    float x0, x1, leaf_width;
    int& count;
};

TEST(GeometryNode, dices_once_for_all_buckets_and_frees_after_the_last) {
    const BucketLayout layout({0, 0, 64, 16}, 16);
    Statistics statistics;
    int alive = 0;
    auto strip = std::make_unique<Strip>(1.0f, 63.0f, 100.0f, alive);
    const RasterBounds bounds = strip->bounds();
    GeometryNode node(std::move(strip), bounds, layout, nullptr);
    std::weak_ptr<SharedGrid> grid;
    for (int bucket = 0; bucket < 4; ++bucket) {
        grid = node.expand(layout, statistics).grid;
        EXPECT_FALSE(grid.expired());
        node.release(bucket);
        node.release(bucket);  // a second time is harmless
    }
    EXPECT_TRUE(grid.expired());
    EXPECT_EQ(statistics.get(Counter::GridsDiced), 1u);
    EXPECT_EQ(alive, 0);
}

TEST(GeometryNode, pieces_are_freed_with_their_own_last_bucket) {
    const BucketLayout layout({0, 0, 64, 16}, 16);
    Statistics statistics;
    int alive = 0;
    auto strip = std::make_unique<Strip>(0.5f, 63.5f, 32.0f, alive);
    const RasterBounds bounds = strip->bounds();
    GeometryNode node(std::move(strip), bounds, layout, nullptr);
    node.release(0);  // before the split: the left piece is then wanted by bucket 1 and 2 alone
    auto children = node.expand(layout, statistics).children;
    ASSERT_EQ(children.size(), 2u);
    const std::weak_ptr<SharedGrid> left = children[0]->expand(layout, statistics).grid;
    EXPECT_FALSE(left.expired());
    node.release(1);
    EXPECT_FALSE(left.expired());  // x = 32 touches bucket 2
    node.release(2);
    EXPECT_TRUE(left.expired());
    const std::weak_ptr<SharedGrid> right = children[1]->expand(layout, statistics).grid;
    EXPECT_FALSE(right.expired());
    node.release(3);
    EXPECT_TRUE(right.expired());
    EXPECT_EQ(statistics.get(Counter::PrimitivesSplit), 1u);
}

}  // namespace
}  // namespace granita
