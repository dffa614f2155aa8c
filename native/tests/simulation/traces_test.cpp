// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/traces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "plane_models.hpp"
#include "towers.hpp"

namespace realmodel::simulation {
namespace {

TEST(TracesTest, OfATowerTheOutline) {
    const Traces traces = traces_of(Tower({0, 5, 9}).view, nullptr);
    EXPECT_EQ(traces.points, (std::vector<PlanPoint>{{0, 0}, {0, 6}, {10, 0}, {10, 6}}));
    using TraceSegment = Traces::TraceSegment;
    EXPECT_EQ(traces.segments, (std::vector<TraceSegment>{{{0, 1}, Traces::kOfTop},
                                                          {{0, 1}, -1},
                                                          {{0, 2}, Traces::kOfTop},
                                                          {{0, 2}, -1},
                                                          {{1, 3}, Traces::kOfTop},
                                                          {{1, 3}, -1},
                                                          {{2, 3}, Traces::kOfTop},
                                                          {{2, 3}, -1}}));
}

TEST(TracesTest, ABlockEndsWhereItsTopMeetsItsBottom) {
    const Model model({{0, 0}, {4, 4}, {2, 6}});
    const Traces traces = traces_of(model.view, nullptr);
    double ends = 0;
    for (const Traces::TraceSegment& s : traces.segments) {
        if (s.block < 0) continue;
        const PlanPoint &a = traces.points[static_cast<std::size_t>(s.ends[0])],
                        &b = traces.points[static_cast<std::size_t>(s.ends[1])];
        EXPECT_EQ(s.block, 1);
        EXPECT_NEAR(a[0], 5, 1e-9);
        EXPECT_NEAR(b[0], 5, 1e-9);
        ends += std::abs(b[1] - a[1]);
    }
    EXPECT_NEAR(ends, 6, 1e-9);
}

TEST(LineAnchorsTest, CornersAndPointsApartOnAllLines) {
    const Traces traces = traces_of(Tower({0, 5}).view, nullptr);
    const auto anchors = line_anchors(
        traces, [](const PlanPoint&) { return 1.0; }, nullptr);
    for (const PlanPoint& corner : traces.points)
        EXPECT_NE(std::find(anchors.begin(), anchors.end(), corner), anchors.end());
    for (std::size_t i = 0; i < anchors.size(); ++i) {
        EXPECT_TRUE(anchors[i][0] == 0 || anchors[i][0] == 10 || anchors[i][1] == 0 ||
                    anchors[i][1] == 6);
        double nearest = HUGE_VAL;
        for (std::size_t j = 0; j < anchors.size(); ++j) {
            if (j == i) continue;
            nearest = std::min(
                nearest, std::hypot(anchors[i][0] - anchors[j][0], anchors[i][1] - anchors[j][1]));
        }
        EXPECT_GE(nearest, 0.7);
        EXPECT_LE(nearest, 2);
    }
}

}  // namespace
}  // namespace realmodel::simulation
