// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/variogram/many_points.hpp"

#include <gtest/gtest.h>

#include "../../sanitized.hpp"
#include "../dense_kriging.hpp"
#include "interpolation/variogram/experimental_variogram.hpp"
#include "interpolation/variogram/leave_one_out.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"
#include "realmodel/interpolation/thin_plate.hpp"
#include "realmodel/interpolation/variogram_fit.hpp"

namespace realmodel::interpolation {
namespace {

/// Scattered points, points on a lattice, whose distances are equal, a dense cluster and one far
/// away.
Points varied() {
    constexpr int kSide = kSanitized ? 14 : 40;
    Points points = hills(kSanitized ? 600 : 3000, 1000, {4e5, 5e6});
    for (int i = 0; i < kSide; ++i) {
        for (int j = 0; j < kSide; ++j)
            points.push_back({4e5 + 2000 + 10 * i, 5e6 + 10 * j, 0.1 * i * j});
    }
    for (int i = 0; i < (kSanitized ? 200 : 1000); ++i)
        points.push_back({4e5 + 0.01 * (i % 31), 5e6 + 3000 + 0.01 * i, 0.01 * i});
    points.push_back({0, 0, 100});
    return points;
}

TEST(NearestOfSome, AsATreeOfAllFindsThem) {
    const Points points = varied();
    const DistinctPoints positions{points.size(), [&](std::size_t i) {
                                       return PlanPosition{points[i][0], points[i][1]};
                                   }};
    std::vector<std::int32_t> asked = even_subset(points.size(), 700);
    asked.push_back(static_cast<std::int32_t>(points.size()) - 1);
    for (const std::size_t count : {1U, 2U, 33U}) {
        const auto expected = nearest_of_some(positions, asked, count, {1, nullptr});
        ASSERT_EQ(expected.size(), asked.size() * count);
        for (std::size_t k = 0; k < asked.size(); ++k)
            EXPECT_EQ(expected[k * count].point, asked[k]);
        for (const std::size_t most : {kSanitized ? 20U : 1U, 50U, 900U, 4000U})
            EXPECT_EQ(nearest_of_some(positions, asked, count, {1, nullptr}, most), expected);
    }
    const DistinctPoints three{3, positions.at};
    const auto of_three = nearest_of_some(three, std::vector<std::int32_t>{1}, 33, {1, nullptr}, 2);
    EXPECT_EQ(of_three, nearest_of_some(three, std::vector<std::int32_t>{1}, 33, {1, nullptr}));
    EXPECT_EQ(of_three.size(), 3U);
    Progress progress;
    progress.cancel();
    EXPECT_THROW(nearest_of_some(positions, asked, 2, {1, &progress}, 50), Cancelled);
}

TEST(ManyPoints, APartOfThemGivesTheSame) {
    const Points points = varied();
    const Variogram v{VariogramModel::kMatern32, 500, 4, 0.1, {}, {}};
    for (const Drift drift : {Drift::kConstant, Drift::kLinear}) {
        ManyPoints all(points), few(points, true, 100);
        if (drift != Drift::kConstant) {
            all.take_drift_out(drift);
            few.take_drift_out(drift);
        }
        for (const Anisotropy& anisotropy : {Anisotropy{}, Anisotropy{3, 40}}) {
            const auto a = experimental_variogram(all, anisotropy);
            const auto b = experimental_variogram(few, anisotropy);
            EXPECT_EQ(a.lags, b.lags);
            EXPECT_EQ(a.gamma, b.gamma);
            EXPECT_EQ(a.pairs, b.pairs);
        }
        if (kSanitized && drift == Drift::kConstant) continue;
        const LeaveOneOut of_all(all, 16, 60, 0, {1, nullptr}),
            of_few(few, 16, 60, 0, {1, nullptr});
        const PredictionErrors a = of_all.errors(Covariance(v), drift);
        const PredictionErrors b = of_few.errors(Covariance(v), drift);
        EXPECT_EQ(a.errors, b.errors);
        EXPECT_EQ(a.variances, b.variances);
    }
    EXPECT_LT(ManyPoints(points, true, 100).subset_with({}).size(), 100U);
}

TEST(ManyPoints, RepeatedOnesCountOnce) {
    Points points = hills(300, 100);
    const Points once = points;
    points.insert(points.begin() + 9, points[4]);
    points.push_back(points[0]);
    const FittedVariogram a = fit_variogram(points, {}), b = fit_variogram(once, {});
    EXPECT_EQ(a.variogram.range, b.variogram.range);
    EXPECT_EQ(a.experimental.gamma, b.experimental.gamma);
    FitOptions options;
    options.are_apart = true;
    EXPECT_EQ(fit_variogram(once, {}, options).variogram.range, b.variogram.range);
    EXPECT_EQ(mean_spacing(once, true), mean_spacing(points));
    points.push_back({points[0][0], points[0][1], 1e9});
    EXPECT_THROW(ManyPoints{points}, InputError);
}

std::vector<double> residuals(const Points& points, Drift drift) {
    ManyPoints data(points);
    data.take_drift_out(drift);
    std::vector<double> out;
    for (std::size_t i = 0; i < data.size(); ++i)
        out.push_back(data.value(i));
    return out;
}

TEST(ManyPoints, WithoutDriftNothingIsLeftOfAPlane) {
    Points points = hills(40, 300, {4e5, 5e6});
    for (auto& p : points)
        p[2] = 1000 + 0.5 * (p[0] - 4e5) - 2 * (p[1] - 5e6);
    for (const double residual : residuals(points, Drift::kLinear))
        EXPECT_NEAR(residual, 0, 1e-10);
    const auto means = residuals({{0, 0, 1}, {1, 0, 2}, {0, 1, 6}}, Drift::kConstant);
    EXPECT_NEAR(means[0], -2, 1e-15);
    EXPECT_NEAR(means[2], 3, 1e-15);
}

TEST(ManyPoints, ResidualsAreWhatNoPolynomialTells) {
    Points points = hills(60, 100, {4e5, 5e6});
    const std::vector<double> left = residuals(points, Drift::kLinear);
    double sum = 0, along_x = 0, along_y = 0;
    for (std::size_t i = 0; i < left.size(); ++i) {
        sum += left[i];
        along_x += left[i] * (points[i][0] - 4e5);
        along_y += left[i] * (points[i][1] - 5e6);
    }
    EXPECT_NEAR(sum, 0, 1e-9);
    EXPECT_NEAR(along_x, 0, 1e-8);
    EXPECT_NEAR(along_y, 0, 1e-8);
    for (auto& [x, y, z] : points) {
        const double u = x - 4e5, v = y - 5e6;
        z = 2 + 0.1 * u - 0.3 * v + 1e-3 * u * u + 2e-3 * u * v - 1e-3 * v * v;
    }
    for (const double residual : residuals(points, Drift::kQuadratic))
        EXPECT_NEAR(residual, 0, 1e-12);
}

TEST(ManyPoints, TheTrendOfMoreThanAreFittedIsThatOfAPart) {
    Points points = hills(30'000, 1000, {4e5, 5e6});
    for (auto& [x, y, z] : points)
        z = 3 + 0.25 * (x - 4e5) - 0.5 * (y - 5e6);
    ManyPoints many(points);
    many.take_drift_out(Drift::kLinear);
    for (std::size_t i = 0; i < points.size(); i += 77)
        EXPECT_NEAR(many.value(i), 0, 1e-9);
    EXPECT_NEAR(many.largest_value(), 497, 3);
}

}  // namespace
}  // namespace realmodel::interpolation
