// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/ties.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "realmodel/interpolation/surface_heights.hpp"

namespace realmodel::interpolation {
namespace {

using Places = std::vector<std::array<double, 2>>;

/// A grid of n x n nodes, each square halved.
struct Grid {
    explicit Grid(int n) : count(n) {
        for (int i = 0; i < n * n; ++i) {
            nodes.push_back({1.0 * (i % n), 1.0 * (i / n)});
            if (i % n == n - 1 || i / n == n - 1) continue;
            triangles.push_back({i, i + 1, i + n});
            triangles.push_back({i + 1, i + n + 1, i + n});
        }
    }
    /// The heights of a surface over the grid at places.
    std::vector<double> at(const Places& places, const std::vector<double>& z) const {
        std::vector<std::array<double, 3>> vertices;
        for (std::size_t i = 0; i < nodes.size(); ++i)
            vertices.push_back({nodes[i][0], nodes[i][1], z[i]});
        return heights_on_surface(vertices, triangles, places);
    }

    int count;
    Places nodes;
    std::vector<std::array<std::int32_t, 3>> triangles;
};

/// Data of one sheet.
struct Asked {
    Places places;
    std::vector<double> lower, upper;
    std::vector<std::int32_t> sheets;

    void add(const std::array<double, 2>& place, double low, double high, int sheet = 0) {
        places.push_back(place);
        lower.push_back(low);
        upper.push_back(high);
        sheets.push_back(sheet);
    }
    void contact(const std::array<double, 2>& place, double z, int sheet = 0) {
        add(place, z, z, sheet);
    }
    TieData data() const { return {places, lower, upper, sheets}; }
};

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr double kTolerance = 1e-11;

/// One in each cell of 3 x 3 edges, at random.
Asked scattered(int n, unsigned seed) {
    std::mt19937_64 random(seed);
    const auto draw = [&] { return static_cast<double>(random() >> 11) / 9007199254740992.0; };
    Asked asked;
    for (int x = 0; x + 4 < n; x += 3)
        for (int y = 0; y + 4 < n; y += 3)
            asked.contact({x + 2.5 * draw(), y + 2.5 * draw()}, 100 * draw());
    return asked;
}

TEST(Ties, SurfacePassesThroughContactsWithinTriangles) {
    const Grid grid(40);
    const std::vector<double> z(grid.nodes.size(), 50);
    const Asked asked = scattered(40, 1);
    const Ties ties = tie({grid.nodes, grid.triangles, z, {}, {}}, asked.data(), kTolerance);
    const std::vector<double> tied = tied_heights(z, grid.nodes, {}, ties.terms);
    const std::vector<double> found = grid.at(asked.places, tied);
    for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_NEAR(found[i], asked.lower[i], 1e-10);
        EXPECT_NEAR(ties.before[i], asked.lower[i] - 50, 1e-10);
        EXPECT_NEAR(ties.after[i], asked.lower[i] - found[i], 1e-10);
    }
    for (const double height : tied) {  // no spikes: contacts differ from the surface by up to 50
        EXPECT_GT(height, -50);
        EXPECT_LT(height, 150);
    }
}

TEST(Ties, OneContactMakesASmoothBump) {
    const Grid grid(41);
    const std::vector<double> z(grid.nodes.size(), 0);
    Asked asked;
    asked.contact({20.3, 20.3}, 1);
    const Ties ties = tie({grid.nodes, grid.triangles, z, {}, {}}, asked.data(), kTolerance);
    const std::vector<double> tied = tied_heights(z, grid.nodes, {}, ties.terms);
    EXPECT_LT(*std::max_element(tied.begin(), tied.end()), 1.01);
    EXPECT_GE(*std::min_element(tied.begin(), tied.end()), 0);
    EXPECT_GT(tied[20 * 41 + 25], 0.5);  // it is as wide as contacts are apart
}

TEST(Ties, WhatHoldsStaysAsItIs) {
    const Grid grid(10);
    std::vector<double> z;
    for (const auto& [x, y] : grid.nodes)
        z.push_back(3 * x - y);
    Asked asked;
    asked.contact({3.25, 4.5}, 3 * 3.25 - 4.5);
    asked.add({6.5, 2.5}, -kNone, 30);
    asked.contact({100, 100}, 7);  // beyond the mesh
    const Ties ties = tie({grid.nodes, grid.triangles, z, {}, {}}, asked.data(), kTolerance);
    EXPECT_TRUE(ties.terms.radii.empty());
    EXPECT_EQ(tied_heights(z, grid.nodes, {}, ties.terms), z);
    EXPECT_TRUE(std::isnan(ties.after[2]));
}

TEST(Ties, ContactsNeverYieldToInequalities) {
    const Grid grid(12);
    const auto plane = [](double x, double y) { return 3 * x - y; };
    std::vector<double> z;
    for (const auto& [x, y] : grid.nodes)
        z.push_back(plane(x, y));
    Asked asked;
    for (int i = 0; i < 121; ++i) {
        const double x = i % 11 + 0.3, y = i / 11 + 0.3;
        asked.contact({x, y}, plane(x, y));
    }
    std::mt19937_64 random(5);
    const auto draw = [&] { return 11 * static_cast<double>(random() >> 11) / 9007199254740992.0; };
    for (int i = 0; i < 60;
         ++i) {  // a little above the plane, with hardly any room between contacts
        const double x = draw(), y = draw();
        asked.add({x, y}, plane(x, y) + 1e-3, kNone);
    }
    const Ties ties = tie({grid.nodes, grid.triangles, z, {}, {}}, asked.data(), kTolerance);
    for (std::size_t i = 0; i < 121; ++i)
        EXPECT_NEAR(ties.after[i], 0, 1e-10) << i;
    const auto held = std::count_if(ties.after.begin() + 121, ties.after.end(),
                                    [](double after) { return after < 1e-10; });
    EXPECT_GT(held, 20);
}

TEST(Ties, BoundsHoldBesideContacts) {
    const Grid grid(40);
    const std::vector<double> z(grid.nodes.size(), 0);
    Asked asked;
    asked.contact({10.2, 10.4}, 5);
    asked.add({14.6, 10.3}, 8, kNone);
    asked.add({18.7, 11.3}, -kNone, -2);
    asked.add({25.5, 25.5}, -3, 3);  // holds already
    const Ties ties = tie({grid.nodes, grid.triangles, z, {}, {}}, asked.data(), kTolerance);
    const std::vector<double> found =
        grid.at(asked.places, tied_heights(z, grid.nodes, {}, ties.terms));
    EXPECT_NEAR(found[0], 5, 1e-10);
    EXPECT_GE(found[1], 8 - 1e-10);
    EXPECT_LE(found[2], -2 + 1e-10);
    EXPECT_LE(std::abs(found[3]), 3 + 1e-10);
}

TEST(Ties, LowerBoundsDenserThanNodesAllHold) {
    // A surface that is high enough keeps them all, though no nodes could meet each of them.
    const Grid grid(8);
    std::mt19937_64 random(3);
    const auto draw = [&] { return static_cast<double>(random() >> 11) / 9007199254740992.0; };
    Asked asked;
    for (int i = 0; i < 300; ++i)
        asked.add({7 * draw(), 7 * draw()}, 100 * draw(), kNone);
    const std::vector<double> z(grid.nodes.size(), 50);
    const Ties ties = tie({grid.nodes, grid.triangles, z, {}, {}}, asked.data(), kTolerance);
    for (const double after : ties.after)
        EXPECT_LE(after, 2 * kTolerance);
    const std::vector<double> tied = tied_heights(z, grid.nodes, {}, ties.terms);
    EXPECT_LT(*std::max_element(tied.begin(), tied.end()), 250);
}

TEST(Ties, ContactsComeBeforeBoundsThatContradictThem) {
    const Grid grid(20);
    const std::vector<double> z(grid.nodes.size(), 0);
    Asked asked;
    asked.add({10.3001, 10.3}, 9, kNone);
    asked.contact({10.3, 10.3}, 5);
    const Ties ties = tie({grid.nodes, grid.triangles, z, {}, {}}, asked.data(), kTolerance);
    EXPECT_NEAR(ties.after[0], 4, 0.01);
    EXPECT_NEAR(ties.after[1], 0, 1e-10);
}

TEST(Ties, BoundsThatHardlyDoNotHoldAreMetCloseToContacts) {
    const Grid grid(20);
    const std::vector<double> z(grid.nodes.size(), 0);
    Asked asked;
    asked.contact({10.3, 10.3}, 5);
    asked.add({10.36, 10.3}, -kNone, 4.993);
    asked.contact({3.5, 3.2}, -5);
    const Ties ties = tie({grid.nodes, grid.triangles, z, {}, {}}, asked.data(), kTolerance);
    for (const double after : ties.after)
        EXPECT_NEAR(after, 0, 1e-10);
    const std::vector<double> tied = tied_heights(z, grid.nodes, {}, ties.terms);
    EXPECT_LT(*std::max_element(tied.begin(), tied.end()), 7);
    EXPECT_GT(*std::min_element(tied.begin(), tied.end()), -7);
}

TEST(Ties, NodesAreNotMovedFarForBoundsThatHardlyDoNotHold) {
    const Grid grid(5);
    const std::vector<double> z(grid.nodes.size(), 0);
    for (const unsigned seed : {11u, 36u, 38u}) {
        std::mt19937 random(seed);
        const auto drawn = [&] { return static_cast<double>(random()) / 4294967296.0; };
        Asked asked;
        for (int n = 0; n < 60; ++n) {
            const std::array<double, 2> at{4 * drawn(), 4 * drawn()};
            const double height = at[0] + 0.02 * drawn();
            if (n % 6 == 0) asked.contact(at, height);
            if (n % 6 != 0)
                asked.add(at, n % 2 == 0 ? height : -kNone, n % 2 == 0 ? kNone : height);
        }
        const Ties ties = tie({grid.nodes, grid.triangles, z, {}, {}}, asked.data(), kTolerance);
        const std::vector<double> tied = tied_heights(z, grid.nodes, {}, ties.terms);
        EXPECT_LT(*std::max_element(tied.begin(), tied.end()), 8) << seed;
        EXPECT_GT(*std::min_element(tied.begin(), tied.end()), -4) << seed;
    }
}

TEST(Ties, SameBytesForAnyThreadsAndForSomeNodes) {
    const Grid grid(60);
    const std::vector<double> z(grid.nodes.size(), 5e5);
    const Asked asked = scattered(60, 2);
    const TiedSheets sheets{grid.nodes, grid.triangles, z, {}, {}};
    const Ties one = tie(sheets, asked.data(), kTolerance, {1});
    const Ties four = tie(sheets, asked.data(), kTolerance, {4});
    EXPECT_EQ(one.terms.coefficients, four.terms.coefficients);
    const std::vector<double> all = tied_heights(z, grid.nodes, {}, one.terms, {1});
    EXPECT_EQ(tied_heights(z, grid.nodes, {}, one.terms, {4}), all);
    const Places some(grid.nodes.begin() + 777, grid.nodes.begin() + 1234);
    EXPECT_EQ(tied_heights(std::span(z).first(some.size()), some, {}, one.terms),
              std::vector<double>(all.begin() + 777, all.begin() + 1234));
}

TEST(Ties, SheetsStayEqualWhereAFaultHasNoWeight) {
    const Grid grid(40);
    const std::size_t count = grid.nodes.size();
    const std::vector<double> z(2 * count, 0), sides{-1, 1};
    std::vector<double> weights;
    for (const auto& [x, y] : grid.nodes)
        weights.push_back(x < 20 ? 1 : 0);
    Asked asked;
    asked.contact({10.4, 10.4}, 4, 0);
    asked.contact({10.4, 11.3}, -6, 1);
    asked.contact({30.4, 30.3}, 3, 1);
    const TiedSheets sheets{grid.nodes, grid.triangles, z, sides, weights};
    const Ties ties = tie(sheets, asked.data(), kTolerance);
    std::vector<std::vector<double>> tied;
    for (const double side : sides) {
        std::vector<double> sided;
        for (const double weight : weights)
            sided.push_back(side * weight);
        tied.push_back(tied_heights(std::span(z).first(count), grid.nodes, sided, ties.terms));
    }
    for (std::size_t i = 0; i < count; ++i)
        if (weights[i] == 0) {
            EXPECT_EQ(tied[0][i], tied[1][i]);
        }
    EXPECT_NEAR(grid.at({asked.places[0]}, tied[0])[0], 4, 1e-10);
    EXPECT_NEAR(grid.at({asked.places[1]}, tied[1])[0], -6, 1e-10);
    EXPECT_NEAR(grid.at({asked.places[2]}, tied[0])[0], 3, 1e-10);
}

TEST(Ties, CrowdedDataAreThoseThatNodesCannotTellApart) {
    const Grid grid(20);
    const std::vector<double> z(grid.nodes.size(), 0);
    Asked asked;
    asked.contact({3, 3}, 0);        // a node
    asked.contact({3.01, 3.01}, 1);  // beside it
    asked.contact({10.2, 10.2}, 2);  // two in a triangle
    asked.contact({10.25, 10.2}, 3);
    asked.contact({15.3, 4.3}, 4);       // alone
    asked.add({15.31, 4.3}, -kNone, 5);  // which that implies
    const CrowdedData found =
        crowded_data({grid.nodes, grid.triangles, z, {}, {}}, asked.data(), 0.3);
    ASSERT_EQ(found.numbers.size(), 2u);
    EXPECT_EQ(found.numbers[0], 1);
    EXPECT_TRUE(found.numbers[1] == 2 || found.numbers[1] == 3);
    EXPECT_NEAR(found.room[0], 0.01 * std::sqrt(2.0), 1e-12);
    EXPECT_NEAR(found.room[1], 0.05, 1e-12);
}

TEST(Ties, BoundsThatContradictNearDataAreCrowded) {
    const Grid grid(20);
    const std::vector<double> z(grid.nodes.size(), 0);
    Asked asked;
    asked.contact({10.3, 10.3}, 5);
    asked.add({10.3001, 10.3}, 9, kNone);
    EXPECT_EQ(
        crowded_data({grid.nodes, grid.triangles, z, {}, {}}, asked.data(), 0.3).numbers.size(),
        1u);
}

}  // namespace
}  // namespace realmodel::interpolation
