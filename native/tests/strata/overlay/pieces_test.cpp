// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/pieces.hpp"

#include "../scene.hpp"

namespace realmodel::strata {
namespace {

/// Twice the area of a polygon.
double twice_area(LocalArrangement& scope, PolygonView polygon) {
    double sum = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const auto p = scope.rounded(polygon[i].point),
                   q = scope.rounded(polygon[(i + 1) % polygon.size()].point);
        sum += p[0] * q[1] - q[0] * p[1];
    }
    return sum;
}

/// How much of a facet lies on each side of a surface, from its pieces.
struct Shares {
    double below = 0, not_below = 0, absent = 0;
    bool is_clear = false;
    std::size_t pieces = 0;
};
Shares shares(const OwnedSurface& upper, const OwnedSurface& lower) {
    Scene scene({lower, upper});
    const SurfaceTiling surface = scene.tiling(0), facets = scene.tiling(1);
    LocalArrangement scope(scene.geometry());
    PieceFinder finder(scope, surface);
    const Pieces& found = finder.find(facets.polygons[0], facets.plane[0]);
    Shares result;
    result.is_clear = found.is_clear;
    result.pieces = found.list.size();
    for (const Piece& piece : found.list) {
        const double area = twice_area(scope, found.outline(piece)) / 2;
        EXPECT_GT(area, 0);
        (piece.side == PieceSide::kBelow      ? result.below
         : piece.side == PieceSide::kNotBelow ? result.not_below
                                              : result.absent) += area;
    }
    EXPECT_DOUBLE_EQ(result.below + result.not_below + result.absent,
                     twice_area(scope, facets.polygons[0]) / 2);
    return result;
}

TEST(Pieces, AFacetOfTheSameCornersIsOnePiece) {
    const Shares s = shares(one_triangle(1, 1, 1), one_triangle(0, 0, 0));
    EXPECT_EQ(s.pieces, 1u);
    EXPECT_DOUBLE_EQ(s.below, 0.5);
    EXPECT_TRUE(s.is_clear);
}

TEST(Pieces, AreDividedWherePlanesAreEquallyHigh) {
    // the upper one is higher where x < 1/2
    const Shares s = shares(one_triangle(0.5, 0.5, 0.5), one_triangle(0, 1, 0));
    EXPECT_EQ(s.pieces, 2u);
    EXPECT_DOUBLE_EQ(s.not_below, 0.125);
    EXPECT_DOUBLE_EQ(s.below, 0.375);
    EXPECT_FALSE(s.is_clear);
}

TEST(Pieces, OnTheSurfaceAreNotBelow) {
    const Shares s = shares(one_triangle(0, 1, 2), one_triangle(0, 1, 2));
    EXPECT_DOUBLE_EQ(s.not_below, 0.5);
}

TEST(Pieces, TileTheFacetWhereTheSurfaceEnds) {
    const auto half = grid(1, 1, 0, 0, 0.5, 1, [](double, double) { return 0; });
    const Shares s = shares(one_triangle(1, 1, 1), half);
    EXPECT_DOUBLE_EQ(s.absent, 0.125);
    EXPECT_DOUBLE_EQ(s.below, 0.375);
}

}  // namespace
}  // namespace realmodel::strata
