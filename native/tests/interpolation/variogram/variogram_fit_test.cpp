// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/variogram_fit.hpp"

#include <gtest/gtest.h>

#include "../../sanitized.hpp"
#include "../dense_kriging.hpp"
#include "../variogram_models.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"
#include "realmodel/interpolation/kriging.hpp"

namespace realmodel::interpolation {
namespace {

/// One draw of a normal field with a given variogram at scattered positions.
Points drawn_field(const Variogram& v, int count, double size, unsigned seed) {
    Points points = hills(count, size, {3e5, 4e6}, seed);
    std::vector<Variogram> parts{v};
    parts[0].sill = v.first_sill() + v.nugget;
    for (const NestedStructure& part : v.further)
        parts.push_back({part.model, part.range, part.sill, 0, part.anisotropy, {}});
    const auto gamma = [&](double dx, double dy) {
        double sum = 0;
        for (const Variogram& part : parts)
            sum += dense_gamma(part, dx, dy);
        return sum;
    };
    Eigen::MatrixXd covariance(count, count);
    for (int i = 0; i < count; ++i) {
        for (int j = 0; j < count; ++j) {
            covariance(i, j) =
                v.sill - gamma(points[i][0] - points[j][0], points[i][1] - points[j][1]);
        }
    }
    const Eigen::MatrixXd factor = covariance.llt().matrixL();
    std::mt19937 random(seed + 100);
    std::normal_distribution<double> normal;
    Eigen::VectorXd noise(count);
    for (int i = 0; i < count; ++i)
        noise(i) = normal(random);
    const Eigen::VectorXd z = factor * noise;
    for (int i = 0; i < count; ++i)
        points[i][2] = 100 + z(i);
    return points;
}

void expect_usable(const FittedVariogram& fitted) {
    EXPECT_NO_THROW(check_variogram(fitted.variogram));
    EXPECT_EQ(fitted.experimental.lags.size(), fitted.experimental.gamma.size());
    EXPECT_EQ(fitted.experimental.lags.size(), fitted.experimental.pairs.size());
}

TEST(ExperimentalVariogram, ByHand) {
    // Four points in a row: three pairs one apart, two pairs two apart, one three apart, of which
    // half the extent takes in the first only (1.5).
    const Points points{{0, 0, 0}, {1, 0, 2}, {2, 0, 2}, {3, 0, 6}};
    const ExperimentalVariogram e = experimental_variogram(points, {});
    ASSERT_EQ(e.lags.size(), 1U);
    EXPECT_EQ(e.pairs[0], 3);
    EXPECT_DOUBLE_EQ(e.lags[0], 1);
    EXPECT_DOUBLE_EQ(e.gamma[0], (4 + 0 + 16) / 6.0);
}

TEST(ExperimentalVariogram, MeasuresUnderTheAnisotropy) {
    // Across the azimuth a distance counts three times.
    const Points points{{0, 0, 0}, {1, 0, 2}};
    EXPECT_NEAR(experimental_variogram(points, {3, 0}).lags[0], 3, 1e-12);
    EXPECT_NEAR(experimental_variogram(points, {3, 90}).lags[0], 1, 1e-12);
}

TEST(ExperimentalVariogram, NearPairsOfManyPointsAreAllCounted) {
    // On a lattice every inner point has four neighbors one spacing away: 2 n (n - 1) pairs.
    Points points;
    constexpr int n = 100;
    for (int y = 0; y < n; ++y) {
        for (int x = 0; x < n; ++x)
            points.push_back({10.0 * x, 10.0 * y, x % 2 == 0 ? 0.0 : 1.0});
    }
    const ExperimentalVariogram e = experimental_variogram(points, {});
    EXPECT_EQ(e.pairs[0], 2 * n * (n - 1));
    EXPECT_DOUBLE_EQ(e.lags[0], 10);
    EXPECT_DOUBLE_EQ(e.gamma[0], 0.25);  // half of the pairs, those along x, differ by 1
}

TEST(VariogramFit, FindsTheVariogramAFieldWasDrawnFrom) {
    const Variogram truth{VariogramModel::kSpherical, 30, 4, 0, {}};
    const FittedVariogram fitted = fit_variogram(drawn_field(truth, 900, 200, 3), {});
    expect_usable(fitted);
    // One draw scatters about the truth; what must hold is gamma at short lags, and the sill.
    for (const double h : {3.0, 6.0, 12.0}) {
        EXPECT_NEAR(gamma_of(fitted.variogram, h), gamma_of(truth, h), 0.35 * gamma_of(truth, h));
    }
    EXPECT_NEAR(fitted.variogram.sill, 4, 2);
}

TEST(VariogramFit, FindsANugget) {
    const Variogram truth{VariogramModel::kExponential, 60, 5, 2, {}};
    const FittedVariogram fitted = fit_variogram(drawn_field(truth, 900, 300, 5), {});
    EXPECT_NEAR(gamma_of(fitted.variogram, 1), 2, 1);
    EXPECT_NEAR(gamma_of(fitted.variogram, 30), gamma_of(truth, 30), 1.5);
}

TEST(VariogramFit, ASmoothSurfaceAsksForASmoothModel) {
    const Points points = hills(800, 100);
    const FittedVariogram fitted = fit_variogram(points, {});
    expect_usable(fitted);
    EXPECT_NE(fitted.variogram.model, VariogramModel::kSpherical);
    EXPECT_NE(fitted.variogram.model, VariogramModel::kExponential);
    // Kriged with it the surface comes out better than with a spherical guess.
    const Nodes nodes = scattered_nodes(300, 90, {5, 5}, 9);
    const auto error = [&](const Variogram& v) {
        double sum = 0;
        const Kriged kriged = krige(points, nodes, v, {});
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const double x = nodes[i][0] / 100, y = nodes[i][1] / 100;
            sum +=
                std::pow(kriged.z[i] - (500 + 20 * std::sin(5 * x) * std::cos(4 * y) + 3 * x), 2);
        }
        return std::sqrt(sum / static_cast<double>(nodes.size()));
    };
    EXPECT_LT(error(fitted.variogram), 0.5 * error({VariogramModel::kSpherical, 50, 200, 0, {}}));
}

TEST(VariogramFit, APlaneComesOutAsAPlane) {
    Points points = hills(200, 100);
    for (auto& p : points)
        p[2] = 7 + 0.3 * p[0] - 0.1 * p[1];
    const FittedVariogram fitted = fit_variogram(points, {});
    expect_usable(fitted);
    const Nodes nodes = scattered_nodes(100, 80, {10, 10});
    const Kriged kriged = krige(points, nodes, fitted.variogram, {});
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        EXPECT_NEAR(kriged.z[i], 7 + 0.3 * nodes[i][0] - 0.1 * nodes[i][1], 0.05);
    }
}

TEST(VariogramFit, LittleOrConstantData) {
    Points constant = hills(50, 10);
    for (auto& p : constant)
        p[2] = 1234.5;
    Points line;
    for (int i = 0; i < 30; ++i)
        line.push_back({1.0 * i, 3.0 * i, std::sin(0.3 * i)});
    for (const Points& points :
         {constant, Points{{1, 1, 5}}, Points{{0, 0, 1}, {3, 4, 2}}, Points{{0, 0, 1}, {0, 0, 1}},
          Points{{0, 0, 1}, {3, 4, 2}, {1, 0, 0}}, line,
          Points{{0, 0, 1e9}, {1e-9, 0, 1e9 + 1}, {1e9, 0, 0}, {0, 1e9, -1e9}}}) {
        const FittedVariogram fitted = fit_variogram(points, {});
        expect_usable(fitted);
        const Nodes nodes{{0.3, 0.4}, {5, 5}, {-100, 1e4}};
        const Kriged kriged = krige(points, nodes, fitted.variogram, {});
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            EXPECT_TRUE(std::isfinite(kriged.z[i]));
            EXPECT_GE(kriged.variance[i], 0);
        }
    }
    EXPECT_LT(fit_variogram(constant, {}).variogram.sill, 1e-5);
    EXPECT_EQ(krige(constant, Nodes{{3, 3}}, fit_variogram(constant, {}).variogram, {}).z[0],
              1234.5);
}

TEST(VariogramFit, VariancesAreHonest) {
    // A smooth field measured with errors; and one with a few mistakes in it.
    for (const int every : {0, 150}) {
        if (kSanitized && every == 0) continue;
        Points points = drawn_field({VariogramModel::kMatern32, 80, 9, 0.02, {}}, 900, 200, 7);
        for (int i = 0; every > 0 && i < 900; i += every)
            points[static_cast<std::size_t>(i)][2] += 4;
        const Variogram v = fit_variogram(points, {}).variogram;
        const Kriged found = krige_left_out(points, v, {{32}});
        int within = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (std::abs(found.z[i] - points[i][2]) <= 2 * std::sqrt(found.variance[i])) ++within;
        }
        EXPECT_GT(within, 0.92 * 900);
        EXPECT_LT(within, 0.975 * 900);
        EXPECT_NEAR(v.sill, 9, 7);  // and far from points too
    }
}

TEST(VariogramFit, FindsAnAnisotropyWhereThereIsOne) {
    const Variogram truth{VariogramModel::kMatern32, 60, 4, 0, {2.5, 120}};
    const Points points = drawn_field(truth, 900, 200, 3);
    FitOptions options;
    options.finds_anisotropy = true;
    // What is given beside it does not count.
    const FittedVariogram fitted = fit_variogram(points, {3, 10}, options);
    expect_usable(fitted);
    const Anisotropy& found = fitted.variogram.anisotropy;
    EXPECT_NEAR(found.ratio, 2.5, 0.8);
    EXPECT_NEAR(found.azimuth, 120, 15);
    for (const NestedStructure& part : fitted.variogram.further)
        EXPECT_EQ(part.anisotropy.ratio, found.ratio);
    // Distances of the experimental values are those under it.
    EXPECT_EQ(fitted.experimental.gamma, experimental_variogram(points, found).gamma);
    const auto square = [&](const Variogram& v) {
        const Kriged kriged = krige_left_out(points, v, {{32}});
        double sum = 0;
        for (std::size_t i = 0; i < points.size(); ++i)
            sum += std::pow(kriged.z[i] - points[i][2], 2);
        return sum;
    };
    EXPECT_LT(square(fitted.variogram), 0.97 * square(fit_variogram(points, {}).variogram));
}

TEST(VariogramFit, FindsNoAnisotropyWhereThereIsNone) {
    FitOptions options;
    options.finds_anisotropy = true;
    Points line;
    for (int i = 0; i < 200; ++i)
        line.push_back({1.0 * i, 3.0 * i + 1e-3 * (i % 7), std::sin(0.3 * i)});
    for (const Points& points :
         {drawn_field({VariogramModel::kMatern32, 60, 4, 0, {}}, 900, 200, 3), hills(20, 100),
          line}) {
        const FittedVariogram found = fit_variogram(points, {}, options);
        const FittedVariogram plain = fit_variogram(points, {});
        EXPECT_EQ(found.variogram.anisotropy.ratio, 1);
        EXPECT_EQ(found.variogram.range, plain.variogram.range);
        EXPECT_EQ(found.variogram.sill, plain.variogram.sill);
    }
}

TEST(VariogramFit, ARougherPartWhereItTellsPointsBetter) {
    // Smooth from afar and rough from near: no single model is both.
    const Variogram truth{VariogramModel::kMatern52,
                          300,
                          20.6,
                          0,
                          {},
                          {{VariogramModel::kExponential, 300, 0.6, {}}}};
    const Points points = drawn_field(truth, 1000, 200, 11);
    const FittedVariogram fitted = fit_variogram(points, {});
    expect_usable(fitted);
    ASSERT_EQ(fitted.variogram.further.size(), 1U);
    for (const double h : {3.0, 8.0, 20.0})
        EXPECT_NEAR(gamma_of(fitted.variogram, h), gamma_of(truth, h), 0.4 * gamma_of(truth, h));
}

TEST(VariogramFit, SameForAnyNumberOfThreadsAndRefusesNoNeighbors) {
    const Points points = hills(kSanitized ? 1000 : 3000, 100);
    for (const Drift drift : {Drift::kConstant, Drift::kLinear}) {
        const Variogram one = fit_variogram(points, {}, {drift, 16}, {1}).variogram;
        const Variogram three = fit_variogram(points, {}, {drift, 16}, {3}).variogram;
        EXPECT_EQ(one.model, three.model);
        EXPECT_EQ(one.range, three.range);
        EXPECT_EQ(one.sill, three.sill);
        EXPECT_EQ(one.nugget, three.nugget);
    }
    EXPECT_THROW(fit_variogram(points, {}, {Drift::kConstant, 0}), InputError);
}

TEST(VariogramFit, SameEveryTime) {
    const Points points = hills(kSanitized ? 1500 : 6000, 100);
    const FittedVariogram a = fit_variogram(points, {2, 40}), b = fit_variogram(points, {2, 40});
    EXPECT_EQ(a.variogram.range, b.variogram.range);
    EXPECT_EQ(a.variogram.sill, b.variogram.sill);
    EXPECT_EQ(a.experimental.gamma, b.experimental.gamma);
    EXPECT_EQ(a.variogram.anisotropy.ratio, 2);
}

TEST(VariogramFit, Refuses) {
    const auto kind = [](const Points& points, const Anisotropy& anisotropy) -> std::string {
        try {
            fit_variogram(points, anisotropy);
        } catch (const InputError& error) {
            return error.kind;
        }
        return "accepted";
    };
    EXPECT_EQ(kind({}, {}), "no_points");
    EXPECT_EQ(kind({{0, 0, 1}, {0, 0, 2}}, {}), "contradicting_points");
    EXPECT_EQ(kind({{0, 0, std::nan("")}}, {}), "not_finite");
    EXPECT_EQ(kind(hills(9, 1), {0, 0}), "anisotropy");
    EXPECT_EQ(kind(hills(9, 1), {1, HUGE_VAL}), "anisotropy");
    Progress progress;
    progress.cancel();
    EXPECT_THROW(fit_variogram(hills(50, 1), {}, {}, {0, &progress}), Cancelled);
}

}  // namespace
}  // namespace realmodel::interpolation
