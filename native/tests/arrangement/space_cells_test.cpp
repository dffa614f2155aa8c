// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrangement/space_cells.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace realmodel::arrangement {
namespace {

using spatial::Box;

TEST(RayBoxes, ARayGoesFromItsPointToTheEnd) {
    exact::SpacePoints points;
    const Box ray = ray_box(points, points.add(exact::SpacePosition{1, 2, 3}), 1);
    EXPECT_EQ(ray.low, (Box::Position{1, 2, 3}));
    EXPECT_EQ(ray.high, (Box::Position{1, HUGE_VAL, 3}));
}

TEST(RayBoxes, AreFoundInOrderWithATreeAsWithout) {
    Array<Box> boxes;
    for (int i = 0; i < 100; ++i) {
        const double x = i % 10, z = 99 - i;
        boxes.push_back({{x, 0, z}, {x + 1, 1, z + 1}});
    }
    RayBoxes rays(boxes);
    exact::SpacePoints points;
    for (int n = 0; n < 40; ++n) {  // a tree is made on the way
        const Box ray = ray_box(points, points.add(exact::SpacePosition{4.5, 0.5, 50.5}), 2);
        EXPECT_EQ(rays.find(ray, nullptr), (std::vector<std::int32_t>{4, 14, 24, 34, 44}));
    }
}

TEST(RayBoxes, OfAPointThatNoDoubleIsItMeetsWhatThePointIsIn) {
    exact::SpacePoints points;
    const mpq_class third(1, 3);
    const auto p = points.add(exact::RationalPoint{third, third, third});
    const double x = points.rounded(p)[0];
    ASSERT_LT(mpq_class(x), third);  // rounded down: the box begins there, the point is in it
    RayBoxes rays(Array<Box>{Box{{x, x, 0}, {1, 1, 1}}, Box{{0, 0, 0}, {x, x, 1}}});
    EXPECT_EQ(rays.find(ray_box(points, p, 2), nullptr), (std::vector<std::int32_t>{0, 1}));
}

using Way = SpaceCells::Way;

/// Three facets upon one another, which leave four layers: sides 2 f and 2 f + 1 of facet f.
SpaceCells layers() {
    SpaceCells cells(6);
    cells.join(1, 2);
    cells.join(3, 4);
    cells.number([](std::size_t) { return true; }, {1});
    cells.connect([&cells](const auto& visit) {
        for (std::size_t f = 0; f < 3; ++f)
            visit(f, cells.of(2 * f), cells.of(2 * f + 1));
    });
    return cells;
}

TEST(SpaceCells, AreNumberedInTheOrderOfTheirFirstSides) {
    const SpaceCells cells = layers();
    ASSERT_EQ(cells.size(), 4U);
    std::vector<std::int32_t> of;
    for (std::size_t side = 0; side < 6; ++side)
        of.push_back(cells.of(side));
    EXPECT_EQ(of, (std::vector<std::int32_t>{0, 1, 1, 2, 2, 3}));
    EXPECT_EQ(cells.first_side(2), 3U);
}

TEST(SpaceCells, WhatDoesNotCountIsInNone) {
    SpaceCells cells(4);
    cells.join(0, 3);
    cells.number([](std::size_t side) { return side != 0 && side != 1; }, {1});
    EXPECT_EQ(cells.size(), 2U);
    EXPECT_EQ(cells.of(0), -1);
    EXPECT_EQ(cells.of(1), -1);
    EXPECT_EQ(cells.of(3), 1);
    EXPECT_EQ(cells.first_side(1), 3U);  // the first that counts
}

TEST(SpaceCells, ALabelChangesWithEachFacetAndBackAgain) {
    const SpaceCells cells = layers();
    std::vector<std::optional<int>> labels(4);
    labels[2] = 10;
    cells.spread(
        2, labels,
        [](const Way& way, int label) {
            return std::optional(label + way.direction * (1 + way.facet));
        },
        [](const Way&) { FAIL() << "all ways agree"; });
    EXPECT_EQ(labels, (std::vector<std::optional<int>>{7, 8, 10, 13}));
}

TEST(SpaceCells, AWayThatEndsLeadsNowhere) {
    const SpaceCells cells = layers();
    std::vector<std::optional<int>> labels(4);
    labels[0] = 5;
    cells.spread(
        0, labels,
        [](const Way& way, int label) {
            return way.facet == 1 ? std::nullopt : std::optional(label);
        },
        [](const Way&) { FAIL(); });
    EXPECT_EQ(labels, (std::vector<std::optional<int>>{5, 5, std::nullopt, std::nullopt}));
}

TEST(SpaceCells, WhereASurfaceEndsTwoWaysDiffer) {
    SpaceCells cells(2);
    cells.join(0, 1);  // round the border of the only facet
    cells.number([](std::size_t) { return true; }, {1});
    cells.connect([](const auto& visit) { visit(0, 0, 0); });
    std::vector<std::optional<int>> labels{0};
    int differ = 0;
    cells.spread(
        0, labels, [](const Way& way, int label) { return std::optional(label + way.direction); },
        [&](const Way& way) {
            EXPECT_EQ(way.facet, 0);
            ++differ;
        });
    EXPECT_EQ(differ, 2);  // there and back
    EXPECT_EQ(labels[0], 0);
}

TEST(SpaceCells, ASectorIsBetweenWhatIsAheadOfABladeAndBehindTheNext) {
    // half-planes: item 0; items 1 and 2, which lie upon each other and face each other; item 3
    const std::vector<EdgeUse> uses{
        {{4, 7}, 0, 1}, {{4, 7}, 1, 1}, {{4, 7}, 2, -1}, {{4, 7}, 3, 1}};
    const EdgeFan fan{{0, 1, 2, 3}, {0, 1, 3, 4}};
    SpaceCells cells(8);
    const auto side_of = [](std::size_t item, std::size_t side) {
        return static_cast<std::int32_t>(2 * item + side);
    };
    for (std::size_t half_plane = 0; half_plane < fan.half_planes(); ++half_plane)
        cells.join_sector(uses, fan, half_plane, side_of);
    cells.number([](std::size_t) { return true; }, {1});
    EXPECT_EQ(cells.size(), 3U);
    EXPECT_EQ(cells.of(0), cells.of(3));  // ahead of 0, behind 1
    EXPECT_EQ(cells.of(0), cells.of(4));  // and behind 2, which is turned over
    EXPECT_EQ(cells.of(2), cells.of(5));  // ahead of both
    EXPECT_EQ(cells.of(2), cells.of(7));  // and behind 3
    EXPECT_EQ(cells.of(6), cells.of(1));  // ahead of 3, behind 0
}

TEST(SpaceCells, WhatIsLeftOutOfASectorIsJoinedWithNothing) {
    const std::vector<EdgeUse> uses{{{0, 1}, 0, 1}, {{0, 1}, 1, 1}};
    const EdgeFan fan{{0, 1}, {0, 1, 2}};
    SpaceCells cells(4);
    cells.join_sector(uses, fan, 0, [](std::size_t item, std::size_t side) {
        return item == 1 ? -1 : static_cast<std::int32_t>(2 * item + side);
    });
    cells.number([](std::size_t) { return true; }, {1});
    EXPECT_EQ(cells.size(), 4U);
}

}  // namespace
}  // namespace realmodel::arrangement
