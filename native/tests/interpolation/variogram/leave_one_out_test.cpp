// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/variogram/leave_one_out.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../dense_kriging.hpp"
#include "interpolation/variogram/variogram_search.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"
#include "realmodel/interpolation/kriging.hpp"

namespace realmodel::interpolation {
namespace {

TEST(LeaveOneOut, TheErrorsOfCrossValidation) {
    const Points points = hills(300, 1000, {4e5, 5e6});
    const ManyPoints data(points);
    const Variogram v{VariogramModel::kMatern32, 500, 4, 0.1, {}, {}};
    for (const Drift drift : {Drift::kConstant, Drift::kLinear}) {
        const Kriged expected = krige_left_out(points, v, {{12}, drift}, {1});
        for (const int threads : {1, 3}) {
            const LeaveOneOut some(data, 12, 100, 0, {threads, nullptr});
            ASSERT_EQ(some.size(), 100U);
            const PredictionErrors found = some.errors(Covariance(v), drift);
            for (std::size_t k = 0; k < 100; ++k) {
                EXPECT_NEAR(found.errors[k], expected.z[3 * k] - points[3 * k][2], 1e-9);
                EXPECT_NEAR(4 * found.variances[k], expected.variance[3 * k], 1e-9);
            }
        }
    }
}

TEST(LeaveOneOut, OneStructureInSeveralSharesAtOnce) {
    const Points points = hills(300, 1000, {4e5, 5e6});
    const ManyPoints data(points);
    const LeaveOneOut some(data, 12, 101, 0, {1, nullptr});
    std::vector<Covariance> alike;
    for (const double rough : {0.5, 1.0, 1.7}) {
        const NestedStructure part{VariogramModel::kExponential, 200, rough, {2, 30}};
        alike.emplace_back(Variogram{VariogramModel::kCubic, 500, 4, rough / 10, {2, 30}, {part}});
    }
    const std::vector<PredictionErrors> found = some.errors(alike);
    ASSERT_EQ(found.size(), 3U);
    for (std::size_t k = 0; k < alike.size(); ++k) {
        const PredictionErrors alone = some.errors(alike[k]);
        EXPECT_EQ(found[k].errors, alone.errors);
        EXPECT_EQ(found[k].variances, alone.variances);
    }
    EXPECT_NE(found[0].errors, found[1].errors);
    EXPECT_TRUE(some.errors(std::span<const Covariance>{}).empty());
}

TEST(LeaveOneOut, FewPointsAndCancelling) {
    const Points two{{0, 0, 1}, {1, 0, 4}};
    const ManyPoints data(two);
    Progress progress;
    const LeaveOneOut both(data, 32, 1000, 0, {1, &progress});
    EXPECT_EQ(both.neighbors(), 1U);
    const Covariance covariance({VariogramModel::kSpherical, 2, 1, 0, {}, {}});
    const PredictionErrors found = both.errors(covariance);
    EXPECT_EQ(found.errors, (std::vector<double>{3, -3}));
    EXPECT_NEAR(found.variances[0], 2 * 0.6875, 1e-14);  // 2 gamma
    progress.cancel();
    EXPECT_THROW(both.errors(covariance), Cancelled);
    EXPECT_THROW(both.errors(covariance, Drift::kLinear), Cancelled);
}

TEST(CappedSquare, OutliersCountAsTwentyDeviations) {
    std::vector<double> errors(99, 1.0);
    errors.push_back(1e3);
    // The deviation is 1.4826 times the median 1; the limit 20 of them or the root mean square.
    const double limit = std::max(20 * 1.4826, std::sqrt((99 + 1e6) / 100));
    const CappedSquare square_of(errors);
    EXPECT_NEAR(square_of(errors), (99 + limit * limit) / 100, 1e-9);
    const std::vector<double> small{3, 4};
    EXPECT_EQ(square_of(small), 12.5);
    const std::vector<double> halves(100, 0.5), ones(100, 1.0), nearly(100, 0.99);
    EXPECT_TRUE(square_of.surely_less(halves, ones));
    EXPECT_FALSE(square_of.surely_less(ones, halves));
    EXPECT_FALSE(square_of.surely_less(nearly, ones));  // less than 3 %
}

TEST(CappedSquare, QuantilesAndHonestSills) {
    EXPECT_EQ(quantile({5, 1, 4, 2, 3}, 0.5), 3);
    EXPECT_EQ(quantile({5, 1, 4, 2, 3}, 1), 5);
    EXPECT_EQ(quantile({7}, 0.95), 7);
    // Of ratios 1 .. 101 the 95 % lie below 96: within two deviations with a sill of 96 / 4.
    PredictionErrors found;
    for (int i = 1; i <= 101; ++i) {
        found.errors.push_back(std::sqrt(2.0 * i));
        found.variances.push_back(2);
    }
    EXPECT_NEAR(honest_sill(found), 24, 1e-12);
}

TEST(AnisotropySearch, OfPointsThatSpreadAndThatDoNot) {
    EXPECT_TRUE(spread_in_plan(ManyPoints(hills(50, 100))));
    Points line;
    for (int i = 0; i < 50; ++i)
        line.push_back({3.0 * i, 2.0 * i + 0.01 * (i % 3), 0});
    EXPECT_FALSE(spread_in_plan(ManyPoints(line)));
    CurveFit fit;
    fit.curve.range = 10;
    EXPECT_EQ(stretched(fit, {4, 0}).curve.range, 20);
}

TEST(AnisotropySearch, FindsTheDirectionInWhichHeightsChangeLeast) {
    Points points = hills(400, 100);
    for (auto& p : points)
        p[2] = std::sin(p[0] / 6) + std::sin(p[1] / 18);  // longest toward north
    const ManyPoints data(points);
    const LeaveOneOut all(data, 16, 400, 0, {0, nullptr});
    CurveFit fit;
    fit.curve = {.model = VariogramModel::kMatern52, .range = 40};
    fit.partial_sill = 1;
    const CappedSquare square_of(all.errors(Covariance(variogram_of(fit, {}))).errors);
    const Anisotropy found = find_anisotropy(all, fit, square_of);
    EXPECT_GT(found.ratio, 1.5);
    const double from_north = std::min(found.azimuth, 180 - found.azimuth);
    EXPECT_LT(from_north, 15);
}

}  // namespace
}  // namespace realmodel::interpolation
