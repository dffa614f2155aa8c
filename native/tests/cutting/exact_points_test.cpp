// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/exact_points.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace realmodel::cutting {
namespace {

/// Points of many kinds, with crossings of lines and planes through them among them.
std::vector<NodeId> some_points(ExactPoints& points, std::mt19937_64& random, int kind) {
    const auto coordinate = [&]() -> double {
        const auto whole = static_cast<double>(random() % 5);
        if (kind == 0) return whole;                                        // a lattice
        if (kind == 1) return static_cast<double>(random() % 1000) / 1000;  // not on doubles
        if (kind == 2) return 5e5 + whole / 10;                             // far from the origin
        return std::ldexp(whole - 2, static_cast<int>(random() % 600) - 300);  // too wide a range
    };
    std::vector<NodeId> made;
    for (int i = 0; i < 8; ++i)
        made.push_back(points.add(Position{coordinate(), coordinate(), coordinate()}));
    for (int i = 0; i < 12; ++i) {
        const auto any = [&] { return made[random() % made.size()]; };
        const NodeId p = any(), q = any(), a = any(), b = any(), c = any();
        const int from = points.orientation(a, b, c, p), to = points.orientation(a, b, c, q);
        if (from * to < 0) made.push_back(points.crossing(p, q, a, b, c));
        if (i == 6) made.push_back(points.middle({p, q, a}));
    }
    return made;
}

int sign_of_determinant(const ExactPoints& points, NodeId a, NodeId b, NodeId c, NodeId d) {
    const Fractions o = points.exact(a);
    return sgn(determinant(minus(points.exact(b), o), minus(points.exact(c), o),
                           minus(points.exact(d), o)));
}

TEST(ExactPoints, SignsAreThoseOfFractions) {
    std::mt19937_64 random(7);
    for (int round = 0; round < 120; ++round) {
        ExactPoints points;
        const auto made = some_points(points, random, round % 4);
        const auto any = [&] { return made[random() % made.size()]; };
        for (int i = 0; i < 60; ++i) {
            const NodeId a = any(), b = any(), c = any(), d = any();
            EXPECT_EQ(points.orientation(a, b, c, d), sign_of_determinant(points, a, b, c, d));
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const Fractions o = points.exact(a);
                EXPECT_EQ(points.turn(axis, a, b, c),
                          sgn(cross(minus(points.exact(b), o), minus(points.exact(c), o), axis)));
                const int order = cmp(points.exact(a)[axis], points.exact(b)[axis]);
                EXPECT_EQ(points.compare(axis, a, b), (order > 0) - (order < 0));
            }
        }
    }
}

TEST(ExactPoints, EqualPointsHaveOneNumberWhateverTheyWereMadeOf) {
    ExactPoints points;
    const auto at = [&points](double x, double y, double z) {
        return points.add(Position{x, y, z});
    };
    const NodeId a = at(0, 0, 0), b = at(3, 0, 0), c = at(0, 3, 0), p = at(1, 1, -1),
                 q = at(1, 1, 2);
    // a crossing that is at doubles is those doubles
    EXPECT_EQ(points.crossing(p, q, a, b, c), at(1, 1, 0));
    // one that is not, by its name, by another plane, and in fractions
    const NodeId low = at(0, 0, 1), high = at(1, 1, 2), e = at(1. / 3, 0, 0), f = at(0, 1. / 3, 0),
                 top = at(1. / 3, 0, 1);
    const NodeId made = points.crossing(low, high, e, f, top);
    EXPECT_EQ(points.crossing(high, low, f, top, e), made);
    EXPECT_EQ(points.crossing(low, high, at(1. / 3, 0, 5), e, f), made);
    EXPECT_EQ(points.add(points.exact(made)), made);
    EXPECT_NE(points.add(points.rounded(low)), made);
    EXPECT_EQ(points.add(points.rounded(low)), low);
}

}  // namespace
}  // namespace realmodel::cutting
