// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields/spline.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <random>

#include "fields/likely_field.hpp"

namespace realmodel::fields {
namespace {

const Map3 kIdentity{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
const Map3 kStretched{{{0.3, 0.1, 0}, {0.1, 1, 0}, {0, 0, 0.7}}};

/// Differences of values and slopes at random places, all of a function.
std::vector<Functional> known_of(double (*value)(const Vec3&), Vec3 (*slope)(const Vec3&)) {
    std::mt19937 random(7);
    const auto drawn = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
    std::vector<Functional> known;
    const Vec3 from{0.1, 0.2, -0.3};
    for (int n = 0; n < 60; ++n) {
        const Vec3 at{drawn(), drawn(), drawn()};
        if (n % 3 == 0) {
            const Vec3 along{drawn(), drawn(), drawn()};
            known.push_back(Functional::slope(at, along));
            known.back().right = dot(slope(at), along);
        } else {
            known.push_back(Functional::difference(at, from));
            known.back().right = value(at) - value(from);
        }
    }
    return known;
}

/// For splines of second derivatives.
std::vector<Functional> by_differences(std::vector<Functional> known) {
    for (Functional& functional : known)
        functional = functional.by_differences(0.02);
    return known;
}
Smoothness rough(const Map3& map) {
    return {map, {}, 2};
}

/// Of a quarter of the range.
Smoothness smooth(Map3 map) {
    for (Vec3& row : map)
        row = times(4, row);
    return {map, {}, 5};
}

double wave(const Vec3& p) {
    return p[2] + 0.2 * std::sin(3 * p[0]);
}
Vec3 wave_slope(const Vec3& p) {
    return {0.6 * std::cos(3 * p[0]), 0, 1};
}
double plane(const Vec3& p) {
    return 2 * p[0] - p[1] + 0.5 * p[2];
}
Vec3 plane_slope(const Vec3&) {
    return {2, -1, 0.5};
}

TEST(Spline, MeetsValuesAndSlopes) {
    const std::vector<Functional> known = known_of(wave, wave_slope);
    for (const Map3& map : {kIdentity, kStretched}) {
        const Spline spline(known, {map}, {});
        for (const Functional& f : known)
            EXPECT_NEAR(spline.of(f), f.right, 1e-9);
        EXPECT_TRUE(spline.log_likelihood().has_value());
        const std::vector<Functional> differences = by_differences(known);
        const Spline second(differences, rough(map), {});
        for (const Functional& f : differences)
            EXPECT_NEAR(second.of(f), f.right, 1e-9);
        const Spline fifth(known, smooth(map), {});
        for (const Functional& f : known)
            EXPECT_NEAR(fifth.of(f), f.right, 1e-8);
    }
}

TEST(Spline, APlaneComesOutAsItIs) {
    const std::vector<Functional> known = known_of(plane, plane_slope);
    const Spline spline(known, {kStretched}, {});
    for (std::size_t n = 0; n < known.size(); ++n)
        EXPECT_NEAR(spline.force(n), 0, 1e-9);
    const Vec3 gradient = spline.gradient({5, -3, 2});
    EXPECT_NEAR(gradient[0], 2, 1e-8);
    EXPECT_NEAR(gradient[1], -1, 1e-8);
    EXPECT_NEAR(gradient[2], 0.5, 1e-8);
}

std::vector<Spline> of_all_orders() {
    const std::vector<Functional> known = known_of(wave, wave_slope);
    std::vector<Spline> out;
    out.emplace_back(known, Smoothness{kStretched}, Execution{});
    out.emplace_back(by_differences(known), rough(kStretched), Execution{});
    out.emplace_back(known, smooth(kStretched), Execution{});
    return out;
}

TEST(Spline, GradientsAreThoseOfTheValues) {
    for (const Spline& spline : of_all_orders()) {
        const Vec3 at{0.31, -0.22, 0.47};
        const Vec3 gradient = spline.gradient(at);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            Vec3 step{};
            step[axis] = 1e-5;
            const double difference = spline.value(plus(at, step)) - spline.value(minus(at, step));
            EXPECT_NEAR(gradient[axis], difference / 2e-5, 1e-6);
        }
    }
}

TEST(Spline, ManyValuesAtOnceAreThoseOfEach) {
    for (const Spline& spline : of_all_orders()) {
        std::vector<Vec3> at;
        for (int n = 0; n < 150; ++n)
            at.push_back({0.01 * n, 0.5 - 0.003 * n, 0.2});
        std::vector<double> values(at.size());
        spline.values_at(at, {}, values);
        for (std::size_t n = 0; n < at.size(); ++n)
            EXPECT_NEAR(values[n], spline.value(at[n]), 1e-12);
    }
}

/// A slope, and values on both sides of a slit at x = 0 that dies out at y = 0: z, and z + 1 where
/// x > 0 as far as it is open.
std::vector<Functional> beside_a_slit() {
    const auto lift = [](const Vec3& p) {
        return Lift{(p[0] > 0 ? 0.5 : -0.5) * std::max(0.0, -p[1])};
    };
    const Vec3 from{0.5, 0.5, 0};
    std::vector<Functional> known;
    for (int n = 0; n < 120; ++n) {
        const Vec3 at{n % 2 == 0 ? 0.05 : -0.05, 0.2 * (n / 2 % 10) - 1, 0.3 * (n / 20) - 0.8};
        known.push_back(Functional::difference(at, from, lift(at), lift(from)));
        known.back().right = at[2] + lift(at)[0];
    }
    for (const Vec3& along : {Vec3{1, 0, 0}, Vec3{0, 1, 0}}) {
        known.push_back({{}, {{{0.3, -0.5, 0}, along, {0.25}, {-0.5 * along[1]}}}, 0, false});
        known.back().right = known.back().slopes[0].along_lift[0];
    }
    return known;
}

TEST(Spline, BesideASlitBothSidesAreMet) {
    const std::vector<Functional> known = beside_a_slit();
    const std::vector<Functional> differences = by_differences(known);
    Smoothness second = rough(kStretched);
    second.lift = 2;
    for (const Spline& spline :
         {Spline(known, {kStretched, {}, 3, 2}, {}), Spline(differences, second, {})}) {
        for (const Functional& functional : known) {
            if (functional.slopes.empty()) {
                EXPECT_NEAR(spline.of(functional), functional.right, 1e-8);
            }
        }
        // across the open part it jumps, between data, too
        const double jump =
            spline.value({0.01, -0.5, 0.15}, {0.25}) - spline.value({-0.01, -0.5, 0.15}, {-0.25});
        EXPECT_NEAR(jump, 0.5, 0.05);
    }
    const Spline spline(known, {kStretched, {}, 3, 2}, {});
    for (const Functional& functional : known)
        EXPECT_NEAR(spline.of(functional), functional.right, 1e-8);
    EXPECT_TRUE(spline.log_likelihood().has_value());
    const std::vector<Vec3> at{{0.1, -0.2, 0.3}, {-0.4, 0.1, 0}};
    std::vector<double> values(2);
    spline.values_at(at, std::array{0.1, -0.3}, values);
    for (std::size_t n = 0; n < 2; ++n)
        EXPECT_NEAR(values[n], spline.value(at[n], {n == 0 ? 0.1 : -0.3}), 1e-12);
    const Functional beyond = Functional::difference({0.2, 1, 0}, {-0.2, 1, 0}, {0}, {0});
    EXPECT_NEAR(spline.of(beyond), 0, 0.05);
}

/// Values of the wave and its slopes on both sides of a fault at x = 0, which has moved them along
/// z.
std::vector<Functional> beside_a_fault(const Vec3& thrown) {
    std::mt19937 random(5);
    const auto drawn = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
    const Lift from_lift{0.5};
    const Vec3 from{0.3, 0, 0};
    std::vector<Functional> known;
    for (int n = 0; n < 60; ++n) {
        const Vec3 at{drawn(), drawn(), drawn()};
        const Lift lift{at[0] > 0 ? 0.5 : -0.5};
        const Vec3 before = moved(at, lift[0], thrown);
        known.push_back(Functional::difference(at, from, lift, from_lift));
        known.back().right = wave(before) - wave(moved(from, 0.5, thrown));
        if (n % 2 == 0) continue;
        const Vec3 along{drawn(), drawn(), drawn()};
        known.push_back({{}, {{at, along, lift, {0}}}, dot(wave_slope(before), along), false});
    }
    return known;
}

TEST(Spline, PlacesAreThoseBeforeAFault) {
    const Vec3 thrown{0, 0, 0.2};
    const std::vector<Functional> known = beside_a_fault(thrown);
    const Spline spline(known, {kStretched, {}, 3, 0.1, {thrown}}, {});
    for (const Functional& functional : known)
        EXPECT_NEAR(spline.of(functional), functional.right, 1e-7);
    const std::vector<Vec3> at{{0.1, -0.2, 0.3}, {-0.4, 0.1, 0}};
    std::vector<double> values(2);
    spline.values_at(at, std::array{0.5, -0.5}, values);
    for (std::size_t n = 0; n < 2; ++n)
        EXPECT_NEAR(values[n], spline.value(at[n], {n == 0 ? 0.5 : -0.5}), 1e-12);
    // the same as a spline in those places
    std::vector<Functional> before = known;
    for (Functional& functional : before) {
        for (ValueAtom& atom : functional.values)
            atom.at = moved(atom.at, atom.lift[0], thrown);
        for (SlopeAtom& atom : functional.slopes)
            atom.at = moved(atom.at, atom.lift[0], thrown);
    }
    const Spline there(before, {kStretched, {}, 3, 0.1}, {});
    EXPECT_NEAR(spline.value({0.4, 0.3, 0.1}, {0.5}), there.value({0.4, 0.3, 0.2}, {0.5}), 1e-9);
}

TEST(Spline, BetweenAStepASecondOrderOvershootsLess) {
    std::vector<Functional> known;
    for (int n = -10; n <= 10; ++n) {
        if (n == 0) continue;
        known.push_back(Functional::difference({0.1 * n, 0, 0}, {0, 0, 0}));
        known.back().right = n < 0 ? -1 : 1;
    }
    known.push_back(Functional::slope({0, 0, 0}, {0, 1, 0}));
    known.push_back(Functional::slope({0, 0, 0}, {0, 0, 1}));
    const auto overshoot = [](const Spline& spline) {
        return spline.value({0.15, 0, 0}) - spline.value({0.1, 0, 0});
    };
    const double third = overshoot(Spline(known, {}, {}));
    const double second = overshoot(Spline(by_differences(known), rough(kIdentity), {}));
    EXPECT_GT(third, 0.05);
    EXPECT_LT(second, 0.5 * third);
}

TEST(Spline, WhatFollowsFromOthersIsLeftOut) {
    std::vector<Functional> known = known_of(wave, wave_slope);
    const std::size_t count = known.size();
    known.push_back(known[1]);
    const Spline spline(known, {kIdentity}, {});
    EXPECT_TRUE(spline.left_out(count));
    EXPECT_FALSE(spline.left_out(1));
    EXPECT_NEAR(spline.of(known[1]), known[1].right, 1e-9);
    EXPECT_FALSE(spline.log_likelihood().has_value());
}

/// The likelihood of contrasts without moments, from the kernel alone.
double likelihood_by_contrasts(const std::vector<Functional>& known, const Map3& map, int order) {
    const auto n = static_cast<Eigen::Index>(known.size());
    Eigen::MatrixXd kernel(n, n), terms(n, 3);
    Eigen::VectorXd right(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const Functional a = known[i].mapped_by(map);
        for (Eigen::Index j = 0; j < n; ++j)
            kernel(i, j) = a.with(known[j].mapped_by(map), {order, 0});
        const Vec3 of = a.of_coordinates();
        terms.row(i) << of[0], of[1], of[2];
        right(i) = a.right;
    }
    const Eigen::MatrixXd q = Eigen::HouseholderQR<Eigen::MatrixXd>(terms).householderQ();
    const Eigen::MatrixXd free = q.rightCols(n - 3);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(free.transpose() * kernel * free);
    EXPECT_GT(solver.eigenvalues()(0), 0);
    const Eigen::VectorXd along = solver.eigenvectors().transpose() * (free.transpose() * right);
    double misfit = 0, logs = 0;
    for (Eigen::Index i = 0; i < n - 3; ++i) {
        misfit += along(i) * along(i) / solver.eigenvalues()(i);
        logs += std::log(solver.eigenvalues()(i));
    }
    const auto count = static_cast<double>(n - 3);
    return -0.5 * (count * std::log(misfit / count) + logs);
}

TEST(Spline, TheLikelihoodIsThatOfContrasts) {
    const std::vector<Functional> known = known_of(wave, wave_slope);
    for (const Map3& map : {kIdentity, kStretched}) {
        const double expected = likelihood_by_contrasts(known, map, 3);
        EXPECT_NEAR(*Spline(known, {map}, {}).log_likelihood(), expected,
                    1e-6 * std::abs(expected));
        const std::vector<Functional> differences = by_differences(known);
        const double second = likelihood_by_contrasts(differences, map, 2);
        EXPECT_NEAR(*Spline(differences, rough(map), {}).log_likelihood(), second,
                    1e-6 * std::abs(second));
        const double fifth = likelihood_by_contrasts(known, smooth(map).map, 5);
        EXPECT_NEAR(*Spline(known, smooth(map), {}).log_likelihood(), fifth,
                    1e-6 * std::abs(fifth));
    }
}

TEST(Spline, ErrorsOfValuesAreNoSmallerThanTheyAreSaidToBe) {
    const std::vector<Functional> known = known_of(wave, wave_slope);
    EXPECT_FALSE(Spline(known, {}, {}).log_likelihood(0.1));
    const Spline spline(known, {kIdentity, {1e-4, 0}}, {});
    const double own = std::sqrt(1e-4 * spline.scale());
    const double likely = *spline.log_likelihood();
    EXPECT_EQ(*spline.log_likelihood(0.9 * own), likely);
    // with twice the error four times the scale
    const auto free = static_cast<double>(known.size() - 3);
    EXPECT_NEAR(*spline.log_likelihood(2 * own), likely - 0.5 * free * (std::log(4.0) + 0.25 - 1),
                1e-9);
}

TEST(Spline, WeightsSayWhatAValueIsMadeOf) {
    const std::vector<Functional> known = known_of(wave, wave_slope);
    const Spline spline(known, {}, {});
    const Functional unknown = Functional::difference({0.4, -0.2, 0.1}, {0.1, 0.2, -0.3});
    const std::vector<double> weights = spline.weights_for(unknown);
    double sum = 0;
    for (std::size_t n = 0; n < known.size(); ++n) {
        const Vec3 of = known[n].of_coordinates();
        const double variance = known[n].with(known[n], {3, 0}) + 100 * dot(of, of);
        sum += weights[n] * known[n].right / std::sqrt(variance);
    }
    EXPECT_NEAR(sum, spline.of(unknown), 1e-9);
}

TEST(Anisotropy, MapsScaleAlongTheAxes) {
    const double half = std::sqrt(0.5);
    const AxisRatios of{{{{half, half, 0}, {-half, half, 0}, {0, 0, 1}}}, {0.1, 1, 0.5}};
    const Vec3 along = mapped(map_of(of), {half, half, 2});
    EXPECT_NEAR(along[0], 0.1 * half, 1e-15);
    EXPECT_NEAR(along[1], 0.1 * half, 1e-15);
    EXPECT_NEAR(along[2], 1, 1e-15);
}

TEST(Anisotropy, IsFoundAlongTheFoldAxis) {
    const std::vector<Functional> known = known_of(wave, wave_slope);
    std::vector<Vec3> normals;
    for (int n = 0; n < 20; ++n)
        normals.push_back(unit(wave_slope({0.1 * n, 0, 0})));
    for (const int threads : {1, 4}) {
        const Likely likely = most_likely(known, normals, {}, 0, {threads, nullptr});
        EXPECT_EQ(likely.errors.value, 0);
        const AxisRatios& found = likely.anisotropy;
        EXPECT_NEAR(std::abs(found.axes[0][1]), 1, 1e-9);
        EXPECT_LE(found.ratios[0], 0.1);
        // and upwards, along which the wave is only moved
        EXPECT_NEAR(std::abs(found.axes[1][2]), 1, 0.02);
        EXPECT_LT(found.ratios[1], 0.5);
    }
}

TEST(Anisotropy, ByHowMuchAFaultHasMovedRockIsFound) {
    const Vec3 thrown{0, 0, 0.37};
    const std::vector<Functional> known = beside_a_fault(thrown);
    const std::vector<Vec3> faults{{1, 0, 0}};
    for (const int threads : {1, 4}) {
        const Likely likely = most_likely(known, {}, faults, 0, {threads, nullptr});
        ASSERT_EQ(likely.throws.size(), 1U);
        EXPECT_EQ(likely.throws[0][0], 0);
        EXPECT_NEAR(likely.throws[0][2], thrown[2], 0.02);
        EXPECT_LT(likely.lift, 1);
    }
}

}  // namespace
}  // namespace realmodel::fields
