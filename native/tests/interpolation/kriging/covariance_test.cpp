// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/kriging/covariance.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../variogram_models.hpp"

namespace realmodel::interpolation {
namespace {

TEST(Covariance, IsOneLessTheSemivarianceInUnitsOfTheSill) {
    for (const VariogramModel model : kRisingModels) {
        Variogram v{model, 400, 9, 0.5, {}, {}};
        v.further.push_back({VariogramModel::kCubic, 1000, 3, {}});
        const Covariance covariance(v);
        ASSERT_EQ(covariance.structures().size(), 2U);
        for (const double h : {1e-6, 1.0, 57.0, 399.0, 400.0, 401.0, 999.0, 5000.0}) {
            EXPECT_NEAR(covariance({3, 4}, {3 + 0.6 * h, 4 - 0.8 * h}), 1 - gamma_of(v, h) / 9,
                        1e-13)
                << name_of(model) << " " << h;
        }
    }
}

TEST(Covariance, AcrossTheAzimuthTheRangeIsShorter) {
    // Longest along N 30 E, a third of that across; a ratio of 1/3 is the same.
    const double x = std::sin(std::acos(-1) / 6), y = std::cos(std::acos(-1) / 6);
    for (const double ratio : {3.0, 1.0 / 3}) {
        const Covariance covariance({VariogramModel::kSpherical, 300, 1, 0, {ratio, 30}, {}});
        EXPECT_NEAR(covariance({0, 0}, {150 * x, 150 * y}), 1 - 0.6875, 1e-14);
        EXPECT_NEAR(covariance({0, 0}, {50 * y, -50 * x}), 1 - 0.6875, 1e-14);
        EXPECT_EQ(covariance({0, 0}, {101 * y, -101 * x}), 0);
    }
}

TEST(Covariance, OfAWaveRisesAndFallsAcrossItsCrests) {
    // Crests along N 30 E, four of them in a range: 75 apart.
    const double x = std::sin(std::acos(-1) / 6), y = std::cos(std::acos(-1) / 6);
    for (const double ratio : {4.0, 1.0 / 4}) {
        const Covariance covariance({VariogramModel::kWave, 300, 1, 0, {ratio, 30}, {}});
        const auto fades = [](double h) { return std::exp(-3 * h * h / 9e4); };
        EXPECT_NEAR(covariance({0, 0}, {150 * x, 150 * y}), fades(150), 1e-14);
        EXPECT_NEAR(covariance({0, 0}, {75 * y, -75 * x}), fades(75), 1e-14);
        EXPECT_NEAR(covariance({0, 0}, {37.5 * y, -37.5 * x}), -fades(37.5), 1e-14);
        EXPECT_NEAR(covariance({0, 0}, {12.5 * y, -12.5 * x}), fades(12.5) / 2, 1e-14);
    }
}

TEST(CosineOfTurns, WithinEightUnitsInTheLastPlaceOfOne) {
    // 2 sin^2 <= 2 has six roundings, and the angle two
    const long double two_pi = 2 * std::acos(-1.0L);
    for (int i = -100000; i <= 100000; ++i) {
        const double x = i * 3e-5;
        const long double exact = std::cos(two_pi * (x - std::round(x)));
        ASSERT_LT(std::abs(cosine_of_turns(x) - exact), 1.8e-15L) << x;
    }
    EXPECT_EQ(cosine_of_turns(0.0), 1);
    EXPECT_EQ(cosine_of_turns(0.5), -1);
    EXPECT_EQ(cosine_of_turns(1e6), 1);
}

TEST(Decay, WithinTwoUnitsInTheLastPlace) {
    for (int i = 0; i < 200000; ++i) {
        const double x = i < 100000 ? i * 7e-3 : (i - 100000) * 1e-5;
        const double exact = std::exp(-x);
        ASSERT_NEAR(decay(x), exact, 4.5e-16 * exact) << x;
    }
    EXPECT_EQ(decay(0.0), 1);
    EXPECT_LT(decay(1e300), 1e-300);
}

}  // namespace
}  // namespace realmodel::interpolation
