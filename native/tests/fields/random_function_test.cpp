// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "fields/frame_function.hpp"

namespace realmodel::fields {
namespace {

constexpr std::size_t kLines = 48, kSteps = 256;

struct Numbers {
    std::vector<double> directions, steps;

    Numbers(std::size_t dimensions, unsigned seed)
        : directions(dimensions * kLines), steps(kLines * kSteps) {
        std::mt19937 random(seed);
        std::normal_distribution<double> normal;
        for (std::vector<double>* const each : {&directions, &steps}) {
            for (double& number : *each)
                number = normal(random);
        }
    }
};

/// Combinations of values whose weights sum to 0, and whose places do.
const std::vector<std::vector<ValueAtom>> kCurved{
    {{{-0.3, 0, 0}, 1}, {{0, 0, 0}, -2}, {{0.3, 0, 0}, 1}},
    {{{0.1, -0.6, 0.2}, 1}, {{0.1, 0, -0.1}, -2}, {{0.1, 0.6, -0.4}, 1}},
    {{{0, 0.2, 0.5}, 1}, {{0.5, 0.2, 0.5}, -1}, {{0.2, 0.2, 0.2}, -1}, {{0.7, 0.2, 0.2}, 1}}};

/// These, on one side of faults.
std::vector<Functional> curved(std::size_t faults) {
    std::vector<Functional> out;
    for (std::vector<ValueAtom> atoms : kCurved) {
        for (ValueAtom& atom : atoms)
            atom.lift.assign(faults, 0.2);
        out.push_back({std::move(atoms), {}, 0, false});
    }
    return out;
}

class RandomFunctions : public testing::TestWithParam<std::pair<int, std::size_t>> {};

TEST_P(RandomFunctions, HaveTheKernelAsCovariance) {
    const auto [order, dimensions] = GetParam();
    Smoothness smoothness;
    smoothness.order = order;
    const std::vector<Functional> all = curved(dimensions - 3);
    std::vector<double> squares(all.size());
    constexpr int kDraws = 600;
    for (unsigned seed = 0; seed < kDraws; ++seed) {
        const Numbers numbers(dimensions, seed);
        const RandomFunction drawn(smoothness, 0.7, 1.5, 0.01,
                                   {dimensions, numbers.directions, numbers.steps, {}});
        for (std::size_t n = 0; n < all.size(); ++n)
            squares[n] += drawn.of(all[n]) * drawn.of(all[n]) / kDraws;
    }
    for (std::size_t n = 0; n < all.size(); ++n) {
        const double variance = 0.7 * all[n].with(all[n], smoothness.kernel());
        EXPECT_NEAR(squares[n] / variance, 1, 0.2) << n;
    }
}

INSTANTIATE_TEST_SUITE_P(OfAllOrders, RandomFunctions,
                         testing::Values(std::pair{3, std::size_t{3}}, std::pair{2, std::size_t{3}},
                                         std::pair{3, std::size_t{4}}, std::pair{3, std::size_t{5}},
                                         std::pair{5, std::size_t{3}},
                                         std::pair{5, std::size_t{4}}));

void expect_rises_as_slopes_say(int order) {
    const Numbers numbers(4, 3);
    Smoothness smoothness;
    smoothness.order = order;
    smoothness.map = {{{0.3, 0.1, 0}, {0.1, 1, 0}, {0, 0, 0.7}}};
    smoothness.lift = 2;
    smoothness.throws = {{0.1, -0.2, 0.3}};
    const RandomFunction drawn(smoothness, 1, 2, 0.1, {4, numbers.directions, numbers.steps, {}});
    const Vec3 at{0.2, -0.1, 0.3}, along{0.5, 1, -0.4};
    constexpr double kStep = 1e-6;
    Functional slope = Functional::slope(at, along);
    slope.slopes[0].lift = {0.1};
    slope.slopes[0].along_lift = {0.3};
    const double rise = drawn.value(moved(at, kStep, along), {0.1 + 0.3 * kStep}) -
                        drawn.value(moved(at, -kStep, along), {0.1 - 0.3 * kStep});
    EXPECT_NEAR(drawn.of(slope), rise / (2 * kStep), 1e-4);
}

TEST(RandomFunction, RisesAsItsSlopesSay) {
    expect_rises_as_slopes_say(3);
    expect_rises_as_slopes_say(5);
}

}  // namespace
}  // namespace realmodel::fields
