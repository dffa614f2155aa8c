// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/oriented_plane.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace realmodel::exact {
namespace {

TEST(OrientedPlane, SidesAreExact) {
    const OrientedPlane plane({0.1, 0.2, 0.3}, {1, 1, 1});
    EXPECT_EQ(plane.side({0.1, 0.2, 0.3}), 0);
    EXPECT_EQ(plane.side({0.1, 0.2, std::nextafter(0.3, 1)}), 1);
    EXPECT_EQ(plane.side({std::nextafter(0.1, 0), 0.2, 0.3}), -1);
    EXPECT_EQ(plane.side({5, 0, 0}), 1);
}

TEST(OrientedPlane, TheLengthOfTheNormalDoesNotMatter) {
    const OrientedPlane tiny({0, 0, 1}, {0, 0, 1e-300}), huge({0, 0, 1}, {0, 0, 1e300});
    for (const double z : {0.0, 1.0, 1e200}) {
        EXPECT_EQ(tiny.side({3, 4, z}), huge.side({3, 4, z}));
        EXPECT_EQ(tiny.side({3, 4, z}), z < 1 ? -1 : z > 1 ? 1 : 0);
    }
}

TEST(OrientedPlane, CutsALineInTheNearestDoubles) {
    // x + y = 1 and the line from the origin to (3, 6, 9): a third of 1, of 2 and of 3
    const OrientedPlane plane({1, 0, 0}, {1, 1, 0});
    EXPECT_EQ(plane.intersection({0, 0, 0}, {3, 6, 9}), (SpacePosition{1. / 3, 2. / 3, 1}));
    const RationalPoint exact = plane.exact_intersection({0, 0, 0}, {3, 6, 9});
    EXPECT_EQ(exact[0], mpq_class(1, 3));
    EXPECT_EQ(exact[2], 1);
}

TEST(OrientedPlane, ALevelPlaneGivesItsOwnHeight) {
    const OrientedPlane plane({7, 7, 0.1}, {0, 0, -2});
    EXPECT_EQ(plane.intersection({0, 0, 0}, {1, 0, 0.7})[2], 0.1);
    EXPECT_EQ(plane.side({0, 0, 1}), -1);
}

}  // namespace
}  // namespace realmodel::exact
