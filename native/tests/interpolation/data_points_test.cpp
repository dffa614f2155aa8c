// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/data_points.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "dense_kriging.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::interpolation {
namespace {

std::string refusal(std::span<const std::array<double, 3>> points) {
    try {
        prepare_points(points);
    } catch (const InputError& error) {
        return error.kind;
    }
    return "accepted";
}

TEST(DataPoints, RepeatedPointsAreMergedInTheirOrder) {
    const DataPoints data =
        prepare_points(Points{{100, 7, 1}, {103, 5, 2}, {100, 7, 1}, {99, 7, 3}, {103, 5, 2}});
    EXPECT_EQ(data.origin, (PlanPosition{100, 7}));
    EXPECT_EQ(data.local, (std::vector<PlanPosition>{{0, 0}, {3, -2}, {-1, 0}}));
    EXPECT_EQ(data.values, (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(data.number_of, (std::vector<std::int32_t>{0, 1, 0, 2, 1}));
    EXPECT_EQ(data.for_input_points(std::vector<double>{4, 5, 6}),
              (std::vector<double>{4, 5, 4, 6, 5}));
}

TEST(DataPoints, Refuses) {
    EXPECT_EQ(refusal({}), "no_points");
    EXPECT_EQ(refusal(Points{{0, 0, 0}, {0, 1e151, 0}}), "not_finite");
    EXPECT_EQ(refusal(Points{{0, 0, std::nan("")}}), "not_finite");
    try {
        prepare_points(Points{{2, 1, 0}, {5, 5, 0}, {2, 1, 4}});
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.kind, "contradicting_points");
        EXPECT_EQ(error.items, (std::vector<std::int64_t>{0, 2}));
    }
}

TEST(DataPoints, MoreThanCanBeNumberedAreRefusedBeforeTheyAreRead) {
    const std::array<double, 3> point{};
    EXPECT_EQ(refusal({&point, std::size_t{1} << 31}), "too_large");
    EXPECT_NO_THROW(require_countable(INT32_MAX, "nodes"));
    EXPECT_THROW(require_countable(std::size_t{INT32_MAX} + 1, "nodes"), InputError);
}

TEST(EvenPart, IsAllOrEvenlySpaced) {
    EXPECT_EQ(even_subset(3, 5), (std::vector<std::int32_t>{0, 1, 2}));
    EXPECT_EQ(even_subset(10, 4), (std::vector<std::int32_t>{0, 2, 5, 7}));
    EXPECT_TRUE(even_subset(0, 4).empty());
}

}  // namespace
}  // namespace realmodel::interpolation
