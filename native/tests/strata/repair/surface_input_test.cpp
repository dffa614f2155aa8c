// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "../complex_checks.hpp"
#include "strata/repair/plan_context.hpp"

namespace realmodel::strata {
namespace {

/// Surfaces that were entered, with what was left out.
struct LoadedInput {
    exact::PlanArrangement geometry;
    std::vector<Warning> warnings;
    std::vector<UsedTriangle> triangles;

    explicit LoadedInput(const OwnedSurface& surface, const PlanSnapping& snapping = {}) {
        triangles = load_surface(geometry, surface.view(), 7, snapping, warnings, {1, nullptr});
    }
    std::vector<BorderEdge> border() const {
        std::vector<PlanTriangle> corners;
        for (const UsedTriangle& triangle : triangles)
            corners.push_back(plan_of(geometry, triangle));
        return link_triangles(corners, nullptr).border;
    }
};

std::string refusal(const OwnedSurface& surface) {
    try {
        LoadedInput entered(surface);
    } catch (const InputError& error) {
        EXPECT_EQ(error.surface, 7);
        return error.kind;
    }
    return "accepted";
}

TEST(CutterInput, TrianglesTurnCounterClockwiseWhicheverWayTheyWereGiven) {
    OwnedSurface s;
    const auto a = s.vertex(0, 0, 0), b = s.vertex(1, 0, 0), c = s.vertex(0, 1, 0);
    s.triangle(a, c, b);
    const LoadedInput entered(s);
    ASSERT_EQ(entered.triangles.size(), 1u);
    const auto& corner = entered.triangles[0].corner;
    double area = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto at = [&](std::size_t k) -> const exact::Point& {
            return entered.geometry.point(entered.geometry.space(corner[k % 3]).plan);
        };
        area += at(i).x * at(i + 1).y - at(i).y * at(i + 1).x;
    }
    EXPECT_EQ(area, 1);
}

TEST(CutterInput, EqualVerticesAreOne) {
    OwnedSurface s;
    for (int copy = 0; copy < 2; ++copy) {  // two triangles of a square, with vertices of their own
        const auto a = s.vertex(0, 0, 5), b = s.vertex(1, 1, 5);
        const auto c = copy == 0 ? s.vertex(1, 0, 5) : s.vertex(0, 1, 5);
        s.triangle(a, b, c);
    }
    const LoadedInput entered(s);
    EXPECT_EQ(entered.border().size(), 4u);  // they hang together
}

TEST(CutterInput, WhatHasNoAreaIsLeftOutWithAWarning) {
    OwnedSurface s;
    const auto a = s.vertex(0, 0, 0), b = s.vertex(1, 0, 0), c = s.vertex(0, 1, 0),
               middle = s.vertex(0.5, 0, 0);
    s.triangle(a, b, c);
    s.triangle(a, middle, b);  // in one line
    s.triangle(a, a, c);
    const LoadedInput entered(s);
    ASSERT_EQ(entered.triangles.size(), 1u);
    EXPECT_EQ(entered.triangles[0].number, 0);
    ASSERT_EQ(entered.warnings.size(), 1u);
    EXPECT_EQ(entered.warnings[0].surface, 7);
    EXPECT_EQ(entered.warnings[0].items, (std::vector<std::int64_t>{1, 2}));
}

TEST(CutterInput, RefusesWhatIsNoSurfaceOverThePlan) {
    OwnedSurface vertical;
    vertical.triangle(vertical.vertex(0, 0, 0), vertical.vertex(1, 0, 0),
                      vertical.vertex(0.5, 0, 1));
    EXPECT_EQ(refusal(vertical), "vertical_triangle");
    OwnedSurface missing;
    missing.triangle(missing.vertex(0, 0, 0), missing.vertex(1, 0, 0), 2);
    EXPECT_EQ(refusal(missing), "bad_index");
    OwnedSurface not_a_number;
    not_a_number.triangle(not_a_number.vertex(0, 0, 0), not_a_number.vertex(1, 0, NAN),
                          not_a_number.vertex(0, 1, 0));
    EXPECT_EQ(refusal(not_a_number), "not_finite");
}

TEST(CutterInput, CoordinatesAreSnappedBeforeVerticesAreCompared) {
    OwnedSurface s;
    const double beside = std::nextafter(1.0, 2.0);
    const auto a = s.vertex(0, 0, 0), b = s.vertex(1, 1, 0), c = s.vertex(1, 0, 0),
               other_b = s.vertex(beside, 1, 0), d = s.vertex(0, 1, 0);
    s.triangle(a, c, b);
    s.triangle(a, other_b, d);
    EXPECT_EQ(LoadedInput(s).border().size(), 6u);
    PlanSnapping snapping;
    snapping.x = AxisSnapping({{beside, 1.0}});
    EXPECT_EQ(LoadedInput(s, snapping).border().size(), 4u);
}

}  // namespace
}  // namespace realmodel::strata
