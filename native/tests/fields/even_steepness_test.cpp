// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "fields/spline_constraints.hpp"

namespace realmodel::fields {
namespace {

constexpr Lattice kBoxOfBed{{0, 0, 0}, {10, 10, 10}, {11, 11, 11}};

/// Two surfaces, with a bed of 20 in the middle of a box, which is thinner by `thinner` to one side
/// of it.
struct Bed {
    std::vector<std::array<double, 3>> contacts;
    std::vector<std::int32_t> surfaces;

    explicit Bed(double thinner) {
        for (int n = 0; n < 9; ++n) {
            const double x = 40.0 + 10 * (n % 3), y = 40.0 + 10 * (n / 3);
            contacts.push_back({x, y, 40});
            contacts.push_back({x, y, 60 - thinner * (x - 50) / 10});
            surfaces.insert(surfaces.end(), {0, 1});
        }
    }

    KnownData known() const {
        FieldData data;
        data.surfaces = 2;
        data.contacts = contacts;
        data.contact_surfaces = surfaces;
        return {kBoxOfBed, data};
    }

    static Spline solved(const KnownData& known, const std::vector<Functional>& more) {
        std::vector<Functional> rows = known.fixed({});
        for (std::size_t n = 0; n < known.contacts().size(); ++n) {
            if (n != known.reference(known.surface_of(n))) rows.push_back(known.on_surface(n));
        }
        rows.insert(rows.end(), more.begin(), more.end());
        return {rows, {}, {1, nullptr}};
    }
};

/// How steep a function is on one side of the box, as a share of that on the other side.
double unevenness(const KnownData& known, const Spline& spline) {
    const auto steep = [&](double x) {
        return length(spline.gradient(known.frame().to_local({x, 50, 50})));
    };
    return steep(95) / steep(5);
}

TEST(EvenSteepness, APlaneIsAsSteepAsItIs) {
    const Bed bed(0);
    const KnownData known = bed.known();
    const Spline spline = Bed::solved(known, {});
    const EvenSteepness even(known);
    const std::vector<Vec3> directions = even.directions(spline);
    EXPECT_GT(directions.size(), 200u);
    for (const Vec3& direction : directions)
        EXPECT_NEAR(dot(direction, spline.gradient({0, 0, 0})), 1, 1e-6);
    EXPECT_EQ(even.rows(directions, 3, 0.1).size(), directions.size());
}

TEST(EvenSteepness, WithoutAnyBendingNothingIsAskedFor) {
    const Bed bed(0);
    const KnownData known = bed.known();
    const EvenSteepness even(known);
    EXPECT_TRUE(even.rows(even.directions(Bed::solved(known, {})), 3, HUGE_VAL).empty());
}

TEST(EvenSteepness, ABedThatThinsKeepsItsThicknessFarAway) {
    const Bed bed(2);
    const KnownData known = bed.known();
    const EvenSteepness even(known);
    Spline spline = Bed::solved(known, {});
    const double before = unevenness(known, spline);
    const double variance = EvenSteepness::variance(spline);
    for (int round = 0; round < EvenSteepness::kRounds; ++round)
        spline = Bed::solved(known, even.rows(even.directions(spline), 3, variance));
    EXPECT_LT(std::abs(unevenness(known, spline) - 1), 0.5 * std::abs(before - 1));
    // the contacts hold
    for (std::size_t n = 0; n < known.contacts().size(); ++n)
        EXPECT_NEAR(spline.of(known.on_surface(n)), 0, 1e-9);
}

}  // namespace
}  // namespace realmodel::fields
