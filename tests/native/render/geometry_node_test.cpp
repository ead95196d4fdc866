// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/geometry_node.h"

#include <gtest/gtest.h>

#include <algorithm>

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

/// Four buckets in a row, none of which has ended.
struct Row {
    const BucketLayout layout{{0, 0, 64, 16}, 16};
    BucketEnds ends{layout};
    Statistics statistics;
    int alive = 0;  ///< strips

    std::shared_ptr<GeometryNode> node(float lo, float hi, float leaf) {
        auto strip = std::make_unique<Strip>(lo, hi, leaf, alive);
        const Rect buckets = layout.range(strip->bounds());
        return std::make_shared<GeometryNode>(std::move(strip), buckets);
    }
    const GeometryNode::Content& expand(GeometryNode& node) {
        return node.expand(layout, ends, statistics);
    }
};

TEST(GeometryNode, dices_once_for_all_buckets_and_frees_after_the_last) {
    Row row;
    const auto node = row.node(1.0f, 63.0f, 100.0f);
    std::weak_ptr<SharedGrid> grid;
    for (int bucket = 0; bucket < 4; ++bucket) {
        grid = row.expand(*node).grid;
        EXPECT_FALSE(grid.expired());
        row.ends.end(bucket);
    }
    EXPECT_TRUE(grid.expired());
    EXPECT_EQ(row.statistics.get(Counter::GridsDiced), 1u);
    EXPECT_EQ(row.alive, 0);
}

TEST(GeometryNode, pieces_are_freed_with_their_own_last_bucket) {
    Row row;
    const auto node = row.node(0.5f, 63.5f, 32.0f);
    row.ends.end(0);  // before the split: the left piece is then wanted by bucket 1 and 2 alone
    const auto children = row.expand(*node).children;
    ASSERT_EQ(children.size(), 2u);
    const std::weak_ptr<SharedGrid> left = row.expand(*children[0].node).grid;
    EXPECT_FALSE(left.expired());
    row.ends.end(1);
    EXPECT_FALSE(left.expired());  // x = 32 touches bucket 2
    row.ends.end(2);
    EXPECT_TRUE(left.expired());
    const std::weak_ptr<SharedGrid> right = row.expand(*children[1].node).grid;
    EXPECT_FALSE(right.expired());
    row.ends.end(3);
    EXPECT_TRUE(right.expired());
    EXPECT_EQ(row.statistics.get(Counter::PrimitivesSplit), 1u);
}

TEST(GeometryNode, what_no_bucket_will_ask_for_is_not_made) {
    Row row;
    const auto node = row.node(0.5f, 63.5f, 31.5f);
    row.ends.end(0);
    row.ends.end(1);
    row.ends.end(2);
    const auto& children = row.expand(*node).children;
    ASSERT_EQ(children.size(), 1u);
    EXPECT_EQ(children[0].buckets, (Rect{2, 0, 4, 1}));
    EXPECT_EQ(row.alive, 1);
}

TEST(BucketEnds, are_taken_in_any_order) {
    std::vector<int> order = {0, 1, 2, 3};
    do {
        Row row;
        const auto node = row.node(1.0f, 63.0f, 100.0f);
        const std::weak_ptr<SharedGrid> grid = row.expand(*node).grid;
        for (int i = 0; i < 4; ++i) {
            EXPECT_FALSE(grid.expired());
            EXPECT_FALSE(row.ends.all_ended(node->buckets()));
            row.ends.end(order[static_cast<std::size_t>(i)]);
        }
        EXPECT_TRUE(grid.expired());
        EXPECT_TRUE(row.ends.all_ended(node->buckets()));
    } while (std::ranges::next_permutation(order).found);
}

}  // namespace
}  // namespace granita
