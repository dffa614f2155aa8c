// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/tiling_walk.hpp"

#include <cmath>
#include <random>

#include "../scene.hpp"

namespace realmodel::strata {
namespace {

/// A level surface of n x n quads over the unit square, with nodes drawn beside those of a lattice.
/// @param step  what coordinates are multiples of, if not 0
OwnedSurface jittered(int n, double z, double jitter, std::mt19937_64& random, double step = 0) {
    OwnedSurface s = grid(n, n, 0, 0, 1, 1, [=](double, double) { return z; });
    std::uniform_real_distribution<double> draw(-jitter / n, jitter / n);
    for (std::size_t v = 0; v < s.vertices.size(); v += 3) {
        for (std::size_t k = 0; k < 2; ++k) {
            double& x = s.vertices[v + k];
            if (x > 0 && x < 1) x += draw(random);
            if (step > 0) x = std::round(x / step) * step;
        }
    }
    return s;
}

std::vector<PointId> points_of(PolygonView polygon) {
    std::vector<PointId> result;
    for (const Corner& corner : polygon)
        result.push_back(corner.point);
    return result;
}

/// How many facets can be walked around, of which all that is found agrees with the clipper.
int walked(const OwnedSurface& facets, const OwnedSurface& surface) {
    Scene scene({surface, facets});
    const SurfaceTiling tiling = scene.tiling(0), upper = scene.tiling(1);
    LocalArrangement scope(scene.geometry());
    TilingWalk walk(scope, tiling);
    Clipper reference(scope);
    Array<std::int32_t> near;
    int count = 0;
    for (std::size_t f = 0; f < facets.triangles.size() / 3; ++f) {
        const PolygonView facet = upper.polygons[f];
        tiling.grid.candidates(scope, facet, near);
        const bool is_known = walk.begin(facet);
        if (!is_known && !(walk.locate(facet, {near.begin(), near.end()}) && walk.begin(facet)))
            continue;
        ++count;
        reference.begin(facet);
        std::size_t next = 0;
        for (std::size_t t = 0; t < tiling.plane.size(); ++t) {
            const PolygonView expected = reference.intersect(tiling.polygons[t]);
            if (expected.empty()) continue;
            EXPECT_LT(next, walk.size());
            if (next == walk.size()) break;
            EXPECT_EQ(walk.polygon(next), static_cast<std::int32_t>(t));
            const std::vector<PointId> corners = points_of(expected);
            EXPECT_EQ(points_of(walk.common(next)), corners) << f << ", " << t;
            ++next;
        }
        EXPECT_EQ(next, walk.size()) << f;
    }
    return count;
}

TEST(TilingWalk, FindsTheTrianglesOfEachFacetAndWhatTheyHaveInCommon) {
    std::mt19937_64 random(3);
    const OwnedSurface coarse = jittered(6, 1, 0.3, random), alike = jittered(7, 0, 0.3, random),
                       fine = jittered(19, 0, 0.3, random);
    EXPECT_GT(walked(coarse, alike), 10);
    EXPECT_GT(walked(coarse, fine), 20);
    EXPECT_GT(walked(fine, coarse), 200);  // with triangles that have several facets inside
}

TEST(TilingWalk, GoesOnWhereTheSurfaceEnds) {
    std::mt19937_64 random(3);
    const OwnedSurface facets =
        grid(5, 5, -0.33, -0.21, 1.27, 1.39, [](double, double) { return 1; });
    EXPECT_GT(walked(facets, jittered(6, 0, 0.3, random)), 40);
}

TEST(TilingWalk, BeginsPolygonsAsTheClipperDoesWhereCornersLieOnLinesOfTheOther) {
    std::mt19937_64 random(3);
    int count = 0;
    for (int round = 0; round < 20; ++round)
        count += walked(jittered(4, 1, 0.2, random, 0x1p-7), jittered(8, 0, 0.2, random, 0x1p-7)) +
                 walked(jittered(8, 1, 0.2, random, 0x1p-7), jittered(4, 0, 0.2, random, 0x1p-7));
    EXPECT_GT(count, 300);
}

TEST(TilingWalk, LeavesFacetsAloneWhereSomethingCoincides) {
    std::mt19937_64 random(3);
    const OwnedSurface lattice = jittered(6, 1, 0, random);
    EXPECT_EQ(walked(lattice, grid(
                                  6, 6, 0, 0, 1, 1, [](double, double) { return 0; }, true)),
              0);
    EXPECT_EQ(walked(lattice, jittered(12, 0, 0, random)), 0);
}

}  // namespace
}  // namespace realmodel::strata
