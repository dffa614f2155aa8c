// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/sheet_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../dense_kriging.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::interpolation {
namespace {

/// Contacts of three sheets of a fold, 4, 12 and 9, and their numbers.
struct Folds {
    Points points = hills(25, 1000, {5e5, 4e6}, 3);
    std::vector<std::int32_t> of_points;
    std::vector<double> variances{0, 0, 0};

    /// @param varying  how much thicknesses of 25 differ
    explicit Folds(double varying) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            const std::int32_t sheet = i < 4 ? 0 : i < 16 ? 1 : 2;
            const double x = points[i][0] - 5e5, y = points[i][1] - 4e6;
            const double thickness = 25 + varying * std::sin(y / 110) * (sheet == 1 ? 1 : -0.4);
            points[i][2] = 50 * std::sin(x / 70) + 0.1 * y + sheet * thickness;
            of_points.push_back(sheet);
        }
    }
    Sheets sheets() const { return {of_points, {}, variances}; }
    FitOptions options() const {
        FitOptions options;
        options.finds_anisotropy = true;
        return options;
    }
};

TEST(SheetFit, WhatParallelSheetsLieApart) {
    const Folds folds(0);
    const auto found = fit_sheets(folds.points, folds.sheets(), {}, folds.options());
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->constants[1] - found->constants[0], 25, 2);
    EXPECT_NEAR(found->constants[2] - found->constants[1], 25, 1);
    EXPECT_LT(found->thickness, 1e-3);
    EXPECT_FALSE(found->experimental.lags.empty());
}

TEST(SheetFit, ThicknessesVaryAsTheyDo) {
    const Folds parallel(0), varying(12);
    const auto none = fit_sheets(parallel.points, parallel.sheets(), {}, parallel.options());
    const auto some = fit_sheets(varying.points, varying.sheets(), {}, varying.options());
    ASSERT_TRUE(none && some);
    EXPECT_GT(some->thickness, 10 * none->thickness);
}

TEST(SheetFit, AGivenVariogramStays) {
    const Folds folds(12);
    const Variogram given{VariogramModel::kCubic, 300, 900, 4, {}, {}};
    const auto found = fit_sheets(folds.points, folds.sheets(), {}, folds.options(), given);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->variogram.range, 300);
    EXPECT_EQ(found->variogram.sill, 900);
    EXPECT_GT(found->thickness, 0);
    EXPECT_NEAR(found->constants[2] - found->constants[0], 50, 15);
}

TEST(SheetFit, ASheetWithoutPointsHasNoConstant) {
    Folds folds(0);
    for (std::int32_t& sheet : folds.of_points)
        sheet = sheet == 0 ? 2 : sheet;
    const auto found = fit_sheets(folds.points, folds.sheets(), {}, folds.options());
    ASSERT_TRUE(found);
    EXPECT_EQ(found->constants[0], 0);
}

/// Contacts of two parallel sheets of folds, at the same positions where both are met; of the
/// second only at the first few.
struct ManyContacts {
    Points points;
    std::vector<std::int32_t> of_points;

    ManyContacts(std::size_t of_first, std::size_t of_second) {
        const Points plan = hills(of_first, 1000, {5e5, 4e6}, 3);
        for (std::size_t i = 0; i < of_first + of_second; ++i) {
            const auto [x, y, z] = plan[i % of_first];
            const std::int32_t sheet = i < of_first ? 0 : 1;
            points.push_back({x, y, 50 * std::sin((x - 5e5) / 150) + 30 * sheet});
            of_points.push_back(sheet);
        }
    }
};

TEST(SheetFit, OfManyPointsAnEvenPartCounts) {
    const ManyContacts many(kMostPointsOfSheets + 250, 20);
    const std::vector<double> variances{0, 0};
    const Sheets sheets{many.of_points, {}, variances};
    const auto found = fit_sheets(many.points, sheets, {}, {});
    ASSERT_TRUE(found);
    EXPECT_EQ(found->points, kMostPointsOfSheets);
    EXPECT_NEAR(found->constants[1] - found->constants[0], 30, 0.5);  // by all points of the second
    const std::vector<std::int32_t> one{0};
    EXPECT_THROW(fit_sheets(many.points, {one, {}, variances}, {}, {}), InputError);
}

}  // namespace
}  // namespace realmodel::interpolation
