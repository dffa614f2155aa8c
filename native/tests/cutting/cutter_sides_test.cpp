// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/cutter_sides.hpp"

#include <gtest/gtest.h>

#include "../validation/small_complex.hpp"
#include "level_cutter.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {
namespace {

/// Two unit cubes, one on the other, and a surface.
struct Sided {
    explicit Sided(Cutter of) : surface(std::move(of)) {}

    validation::OwnedComplex cubes = validation::two_cubes();
    ComplexView model = cubes.view();
    Cutter surface;
    CutterOverlay overlay{model, surface, {1, nullptr}};
    CutterWinding winding{overlay, nullptr};
    CutterSides sides{overlay, winding, nullptr};
};

TEST(CutterSides, FacesAwayFromTheSurfaceHaveTheSideOfThoseBesideThem) {
    const Sided cut(level_cutter(0.5));
    EXPECT_EQ(cut.sides.of_face(0), kBelow);  // the base
    EXPECT_EQ(cut.sides.of_face(1), kAbove);
    EXPECT_EQ(cut.sides.of_face(2), kAbove);  // the top, away from the cell that is cut
    EXPECT_EQ(cut.sides.of_face(7), kAbove);
}

TEST(CutterSides, WhatIsConnectedCountsMoreThanWhatIsNearer) {
    Cutter two = level_cutter(0.5);
    const Cutter beyond = level_cutter(2.125);  // over the model, which is below it
    two.vertices.insert(two.vertices.end(), beyond.vertices.begin(), beyond.vertices.end());
    two.triangles.push_back({3, 4, 5});
    EXPECT_EQ(Sided(two).sides.of_face(2), kAbove);
}

TEST(CutterSides, RegionsOfAWallHaveTheSideTheyAreOn) {
    for (const bool upward : {true, false}) {
        Sided cut(level_cutter(0.5, upward));
        for (std::size_t r = 0; r < cut.overlay.size(); ++r) {
            if (cut.overlay.of_cutter(r)) continue;
            const double z = cut.overlay.points().rounded(cut.overlay.inner_point(r))[2];
            EXPECT_EQ(cut.sides.of_region(r, cut.overlay.face_of(r)),
                      (z > 0.5) == upward ? kAbove : kBelow);
        }
    }
}

TEST(CutterSides, OnlyCellsThatComeNearAreReached) {
    const Sided lower(level_cutter(0.5)), between(level_cutter(1));
    EXPECT_TRUE(lower.sides.reaches(0));
    EXPECT_FALSE(lower.sides.reaches(1));
    EXPECT_TRUE(between.sides.reaches(0));
    EXPECT_TRUE(between.sides.reaches(1));
}

TEST(CutterSides, BesideTheModelAllIsOnOneSide) {
    for (const double height : {-1.0, 3.0}) {
        const Sided cut(level_cutter(height));
        for (std::size_t f = 0; f < 11; ++f)
            EXPECT_EQ(cut.sides.of_face(f), height < 0 ? kAbove : kBelow);
    }
}

TEST(CutterSides, WithinAClosedSurfaceIsBelow) {
    const Sided cut(closed_cutter());
    for (std::size_t f = 0; f < 11; ++f)
        EXPECT_EQ(cut.sides.of_face(f), kAbove);
    Cutter around = closed_cutter();
    for (Position& p : around.vertices)  // 40 times as large, about (0.3, 0.3, 0.3)
        for (double& x : p)
            x = 0.3 + 40 * (x - 0.3);
    const Sided whole(around);
    for (std::size_t f = 0; f < 11; ++f)
        EXPECT_EQ(whole.sides.of_face(f), kBelow);
}

TEST(CutterSides, OfAClosedSurfaceWhatItTurnsItsBackToIsBelow) {
    const Sided cut(closed_cutter());
    for (std::size_t r = 0; r < cut.overlay.size(); ++r)
        EXPECT_EQ(cut.sides.below(r), kBelow);  // all triangles turn outward
}

struct RefusalAt {
    std::string kind;
    std::optional<std::array<double, 3>> place;
};

RefusalAt refusal(const Cutter& surface) {
    try {
        const Sided cut(surface);
    } catch (const InputError& error) {
        return {error.kind, error.place};
    }
    return {};
}

TEST(CutterSides, ASurfaceMayNotEndInsideOfTheModel) {
    Cutter half = level_cutter(0.5);
    for (Position& p : half.vertices)
        p[0] = (p[0] + 8) / 2 + 0.5;  // from x = 0.5 on
    const RefusalAt found = refusal(half);
    EXPECT_EQ(found.kind, "ends_inside");
    ASSERT_TRUE(found.place);
    EXPECT_EQ((*found.place)[0], 0.5);
}

TEST(CutterSides, APlaceMayNotBeAboveOnePartAndBelowAnother) {
    Cutter two = level_cutter(0.25);
    const Cutter upper = level_cutter(0.75);
    two.vertices.insert(two.vertices.end(), upper.vertices.begin(), upper.vertices.end());
    two.triangles.push_back({3, 4, 5});
    EXPECT_EQ(refusal(two).kind, "two_sides");
    std::swap(two.triangles[1][1], two.triangles[1][2]);  // they face each other
    EXPECT_EQ(refusal(two).kind, "");
}

}  // namespace
}  // namespace realmodel::cutting
