// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "../variogram_models.hpp"
#include "interpolation/variogram/experimental_variogram.hpp"

namespace realmodel::interpolation {
namespace {

ExperimentalVariogram values_of(const Variogram& v) {
    ExperimentalVariogram e;
    for (int i = 1; i <= 15; ++i) {
        e.lags.push_back(10.0 * i);
        e.gamma.push_back(gamma_of(v, 10.0 * i));
        e.pairs.push_back(100 + i);
    }
    return e;
}

TEST(WeightedFit, FindsTheCurveThatTheValuesAreOf) {
    for (const VariogramModel model : kAllVariogramModels) {
        const Variogram v{model, 90, 7, 0.5, {}, {}};
        const CurveFit fit = fit_curve(values_of(v), model, true);
        EXPECT_NEAR(fit.curve.range, 90, 1e-4) << name_of(model);
        EXPECT_NEAR(fit.nugget, 0.5, 1e-5);
        EXPECT_NEAR(fit.sill(), 7, 1e-5);
        EXPECT_LT(fit.misfit, 1e-9);
        // Without a nugget it cannot be as good.
        const CurveFit without = fit_curve(values_of(v), model, false);
        EXPECT_EQ(without.nugget, 0);
        EXPECT_GT(without.misfit, 1e-4);
    }
}

TEST(WeightedFit, TheSillAloneByHand) {
    // Two values with weights 4 / 1 and 8 / 4, f = 0.6875 and 1; nugget 1:
    // sill = sum w f (gamma - 1) / sum w f^2.
    const ExperimentalVariogram e{{1, 2}, {2, 4}, {4, 8}};
    const CurveFit fit = fit_sill(e, {.model = VariogramModel::kSpherical, .range = 2}, 1);
    const double sill = (4 * 0.6875 * 1 + 2 * 3) / (4 * 0.6875 * 0.6875 + 2);
    EXPECT_NEAR(fit.partial_sill, sill, 1e-14);
    const double one = 2 - 1 - 0.6875 * sill, two = 4 - 1 - sill;
    EXPECT_NEAR(fit.misfit, 4 * one * one + 2 * two * two, 1e-13);
    EXPECT_EQ(fit_sill(e, {.range = 2}, 100).partial_sill, 0);
}

TEST(VariogramCurve, WithARougherPart) {
    const VariogramCurve curve{VariogramModel::kGaussian, 100, VariogramModel::kExponential, 0.5,
                               0.25};
    EXPECT_NEAR(curve(40),
                0.75 * structure(VariogramModel::kGaussian, 0.4) +
                    0.25 * structure(VariogramModel::kExponential, 0.8),
                1e-15);
    CurveFit fit;
    fit.curve = curve;
    fit.nugget = 1;
    fit.partial_sill = 8;
    const Variogram v = variogram_of(fit, {});
    EXPECT_EQ(v.sill, 9);
    EXPECT_EQ(v.first_sill(), 6);
    ASSERT_EQ(v.further.size(), 1U);
    EXPECT_EQ(v.further[0].range, 50);
    EXPECT_NEAR(gamma_of(v, 40), 1 + 8 * curve(40), 1e-14);
}

}  // namespace
}  // namespace realmodel::interpolation
