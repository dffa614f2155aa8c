// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/box_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace realmodel::spatial {
namespace {

std::vector<Box> random_boxes(std::size_t count) {
    std::mt19937 random(5);
    std::uniform_int_distribution<int> place(0, 30), size(0, 4);  // many touch
    std::vector<Box> boxes(count);
    for (Box& box : boxes) {
        const Box::Position low{1.0 * place(random), 1.0 * place(random), 1.0 * place(random)};
        box.include(low);
        box.include(
            Box::Position{low[0] + size(random), low[1] + size(random), low[2] + size(random)});
    }
    return boxes;
}

TEST(Box, AnEmptyOneAddsNothing) {
    Box box{{0, 1, 2}, {3, 4, 5}};
    box.include(Box());
    EXPECT_EQ(box.low, (Box::Position{0, 1, 2}));
    EXPECT_EQ(box.high, (Box::Position{3, 4, 5}));
}

TEST(BoxTree, FindsWhatMeetsABox) {
    const auto boxes = random_boxes(300);
    const BoxTree tree(boxes);
    for (const Box& asked : random_boxes(20)) {
        std::vector<std::int32_t> found, expected;
        tree.find(asked, [&](std::int32_t i) { found.push_back(i); });
        std::sort(found.begin(), found.end());
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            if (boxes[i].meets(asked)) expected.push_back(static_cast<std::int32_t>(i));
        }
        EXPECT_EQ(found, expected);
    }
}

TEST(BoxTree, FindsPairsOnce) {
    for (const std::size_t count : {0U, 1U, 4U, 5U, 300U}) {
        const auto boxes = random_boxes(count);
        const BoxTree tree(boxes);
        std::vector<std::array<std::int32_t, 2>> found, expected;
        for (std::size_t leaf = 0; leaf < tree.leaf_count(); leaf += 3) {
            tree.find_pairs(leaf, std::min(leaf + 3, tree.leaf_count()),
                            [&](std::size_t i, std::size_t j) {
                                found.push_back(unordered(tree.number_at(i), tree.number_at(j)));
                            });
        }
        std::sort(found.begin(), found.end());
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t j = i + 1; j < count; ++j) {
                if (boxes[i].meets(boxes[j]))
                    expected.push_back(
                        {static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)});
            }
        }
        EXPECT_EQ(found, expected);
    }
}

TEST(BoxTree, IsBuiltAlikeOnAnyNumberOfThreads) {
    const auto boxes = random_boxes(40'000);
    const auto order_with = [&](int threads) {
        std::vector<std::int32_t> order;
        BoxTree(boxes, {threads, nullptr}).find(Box{{0, 0, 0}, {9, 9, 99}}, [&](std::int32_t i) {
            order.push_back(i);
        });
        return order;
    };
    const auto order = order_with(1);
    EXPECT_EQ(std::ranges::count_if(boxes,
                                    [](const Box& box) {
                                        return box.meets({{0, 0, 0}, {9, 9, 99}});
                                    }),
              std::ssize(order));
    EXPECT_EQ(order_with(5), order);
}

}  // namespace
}  // namespace realmodel::spatial
