// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/line_sums.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "dense_kriging.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::interpolation {
namespace {

const Nodes kDirections{{1, 0}, {0.6, 0.8}};

TEST(LineSums, BetweenSamplesAndBeyondTheEnds) {
    const std::vector<double> starts{0, -5}, values{1, 3, 2, 0, 10, 20};
    const Nodes nodes{{0, 0}, {1, 0}, {3, 4}, {-100, 0}, {100, 0}};
    const std::vector<double> sums = line_sums(nodes, {kDirections, starts, values, 2.0}, {1});
    EXPECT_DOUBLE_EQ(sums[0], 1 + 20);  // the second line is past its end
    EXPECT_DOUBLE_EQ(sums[1], 2 + 20);
    EXPECT_DOUBLE_EQ(sums[2], 2.5 + 20);
    EXPECT_DOUBLE_EQ(sums[3], 1 + 0);
    EXPECT_DOUBLE_EQ(sums[4], 2 + 20);
}

TEST(LineSums, TheSameForAnyNumberOfThreads) {
    std::vector<double> values(400);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = std::sin(7.3 * double(i));
    const std::vector<double> starts{-20, -30};
    const Nodes nodes = scattered_nodes(5000, 100);
    const Lines lines{kDirections, starts, values, 0.7};
    const std::vector<double> one = line_sums(nodes, lines, {1});
    EXPECT_EQ(one, line_sums(nodes, lines, {5}));
}

TEST(LineSums, Refuses) {
    const std::vector<double> starts{0, 0}, values{1, 2, 3, 4}, few{1, 2, 3}, single{1, 2};
    const Nodes nodes{{1, 2}};
    EXPECT_THROW(line_sums(nodes, {{}, {}, {}, 1}, {1}), InputError);
    EXPECT_THROW(line_sums(nodes, {kDirections, single, few, 1}, {1}), InputError);
    EXPECT_THROW(line_sums(nodes, {kDirections, starts, single, 1}, {1}), InputError);
    EXPECT_THROW(line_sums(nodes, {kDirections, starts, values, 0}, {1}), InputError);
    EXPECT_THROW(line_sums(Nodes{{std::nan(""), 0}}, {kDirections, starts, values, 1}, {1}),
                 InputError);
    Progress progress;
    progress.cancel();
    EXPECT_THROW(line_sums(nodes, {kDirections, starts, values, 1}, {0, &progress}), Cancelled);
}

}  // namespace
}  // namespace realmodel::interpolation
