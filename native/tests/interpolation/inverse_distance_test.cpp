// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cstring>

#include "dense_kriging.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"
#include "realmodel/interpolation/distances.hpp"

namespace realmodel::interpolation {
namespace {

TEST(InverseDistance, ByHand) {
    const Points points{{0, 0, 1}, {3, 0, 5}, {0, 100, 1000}};
    // Distances 1 and 2 along the line: weights 1 and 1/4.
    EXPECT_DOUBLE_EQ(inverse_distance(points, Nodes{{1, 0}}, {2, {2}})[0], (1 + 5 / 4.0) / 1.25);
    EXPECT_DOUBLE_EQ(inverse_distance(points, Nodes{{1, 0}}, {1, {2}})[0], (1 + 5 / 2.0) / 1.5);
    EXPECT_DOUBLE_EQ(inverse_distance(points, Nodes{{1, 0}}, {3, {1}})[0], 1);
    const double w = 1 / 10001.0;
    EXPECT_NEAR(inverse_distance(points, Nodes{{1, 0}}, {2, {0}})[0],
                (1 + 5 / 4.0 + 1000 * w) / (1.25 + w), 1e-12);
}

TEST(InverseDistance, HonorsTheDataAndStaysBetween) {
    Points points = hills(100, 1000, {4e5, 5e6});
    points.push_back(points[3]);
    Nodes nodes;
    for (const auto& p : points)
        nodes.push_back({p[0], p[1]});
    for (const int neighbors : {0, 1, 8, 1000}) {
        const auto z = inverse_distance(points, nodes, {2, {neighbors}});
        for (std::size_t i = 0; i < nodes.size(); ++i)
            EXPECT_EQ(z[i], points[i][2]);
        for (const double value :
             inverse_distance(points, scattered_nodes(500, 1000, {4e5, 5e6}), {3, {neighbors}})) {
            EXPECT_GE(value, 480);
            EXPECT_LE(value, 523);
        }
    }
}

TEST(InverseDistance, NeitherOverflowsNorUnderflows) {
    const Points points{{0, 0, 1}, {1, 0, 3}};
    for (const double scale : {1e-100, 1e100}) {
        const Points scaled{{0, 0, 1}, {scale, 0, 3}};
        EXPECT_DOUBLE_EQ(inverse_distance(scaled, Nodes{{scale / 2, 0}}, {40, {0}})[0], 2);
    }
    EXPECT_DOUBLE_EQ(inverse_distance(points, Nodes{{1e-9, 0}}, {60, {2}})[0], 1);
}

TEST(InverseDistance, SameBytesForAnyNumberOfThreads) {
    const Points points = hills(700, 100);
    const Nodes nodes = scattered_nodes(3000, 100);
    for (const int neighbors : {0, 16}) {
        const auto one = inverse_distance(points, nodes, {2.5, {neighbors}}, {1});
        const auto three = inverse_distance(points, nodes, {2.5, {neighbors}}, {3});
        EXPECT_EQ(std::memcmp(one.data(), three.data(), 8 * nodes.size()), 0);
    }
}

TEST(InverseDistance, Refuses) {
    const Points points{{0, 0, 1}, {3, 0, 5}};
    const auto kind = [](const Points& p, const InverseDistanceOptions& options) -> std::string {
        try {
            inverse_distance(p, Nodes{{1, 1}}, options);
        } catch (const InputError& error) {
            return error.kind;
        }
        return "accepted";
    };
    EXPECT_EQ(kind(points, {0, {16}}), "option");
    EXPECT_EQ(kind(points, {std::nan(""), {16}}), "option");
    EXPECT_EQ(kind(points, {2, {-1}}), "option");
    EXPECT_EQ(kind({}, {}), "no_points");
    EXPECT_EQ(kind({{0, 0, 1}, {0, 0, 2}}, {}), "contradicting_points");
    EXPECT_EQ(kind({{0, 0, HUGE_VAL}}, {}), "not_finite");
}

TEST(InverseDistance, CanBeStopped) {
    Progress progress;
    progress.cancel();
    EXPECT_THROW(inverse_distance(hills(10, 1), scattered_nodes(10, 1), {}, {0, &progress}),
                 Cancelled);
}

}  // namespace
}  // namespace realmodel::interpolation
