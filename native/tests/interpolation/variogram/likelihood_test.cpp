// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/variogram/likelihood.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "../dense_kriging.hpp"
#include "realmodel/interpolation/distances.hpp"
#include "realmodel/interpolation/kriging.hpp"

namespace realmodel::interpolation {
namespace {

using Slopes = std::vector<std::array<double, 2>>;

/// Folds of wavelength 400 whose axes run north.
double fold(double x) {
    return 50 * std::sin(x / 400 * 6.283185307179586);
}

struct Folded {
    Points points = hills(12, 1000, {5e5, 4e6}, 3);
    Slopes positions, slopes;

    Folded() {
        for (auto& point : points)
            point[2] = fold(point[0] - 5e5);
        for (const auto& [x, y, z] : hills(15, 1000, {5e5, 4e6}, 8)) {
            positions.push_back({x, y});
            slopes.push_back({(fold(x - 5e5 + 0.01) - fold(x - 5e5 - 0.01)) / 0.02, 0});
        }
    }
    FitOptions options() const {
        return {Drift::kConstant, 32, true, false, {positions, slopes, 190, 0}};
    }
};

TEST(Likelihood, OfTwoPointsByHand) {
    // Of two values one difference is free: log N(d; 0, 2 s (1 - c)), less what all shapes share.
    const Points points{{0, 0, 3}, {100, 0, 7}};
    const Likelihood likelihood(points, {}, Drift::kConstant);
    EXPECT_EQ(likelihood.free(), 1U);
    const Variogram shape{VariogramModel::kSpherical, 400, 1, 0, {}, {}};
    const double c = 1 - (1.5 * 0.25 - 0.5 * 0.25 * 0.25 * 0.25);
    const auto found = likelihood.of({shape});
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->sill(), 16 / (2 * (1 - c)), 1e-9);
    // -1/2 (log sill + log |C| + log 1' C^-1 1), with |C| = 1 - c^2 and 1' C^-1 1 = 2 / (1 + c)
    const double expected = -0.5 * (std::log(found->sill()) + std::log(2 * (1 - c)));
    EXPECT_NEAR(found->logarithm(), expected, 1e-9);
}

TEST(Likelihood, OfALeastSillByHand) {
    // The same two values: log N(d; 0, 2 s (1 - c)) for a sill s beside the one that is most
    // likely.
    const Points points{{0, 0, 3}, {100, 0, 7}};
    const Likelihood likelihood(points, {}, Drift::kConstant);
    auto found = likelihood.of({{VariogramModel::kSpherical, 400, 1, 0, {}, {}}});
    ASSERT_TRUE(found);
    const double best = found->logarithm(), sill = found->sill();
    found->least_sill = sill / 2;
    EXPECT_EQ(found->logarithm(), best);
    found->least_sill = 3 * sill;
    EXPECT_EQ(found->sill(), 3 * sill);
    EXPECT_NEAR(found->logarithm(), best - 0.5 * (std::log(3.0) + 1.0 / 3 - 1), 1e-12);
}

TEST(Likelihood, ANuggetIsNoLessThanTheErrorOfHeights) {
    // Along lines where hills of height 60 cut a plane: exact heights are those of the hills, too.
    Points points;
    const auto hill = [](double x) { return 60 * std::sin(x / 159); };
    for (double y = 0; y < 2000; y += 100) {
        const double height = -20 + 0.02 * y, angle = std::asin(height / 60);
        for (const double x : {angle, 3.141592653589793 - angle, angle + 6.283185307179586})
            points.push_back({159 * x, y, height});
    }
    FitOptions options{Drift::kConstant, 32, false};
    options.has_bounds = true;
    const Nodes between{{250, 300}, {250, 1700}, {700, 1000}, {800, 400}};
    const auto worst = [&](const Variogram& variogram) {
        const Kriged found = krige(points, between, variogram, {{0}});
        double off = 0;
        for (std::size_t i = 0; i < between.size(); ++i)
            off = std::max(off, std::abs(found.z[i] - (-20 + 0.02 * between[i][1])));
        return off;
    };
    const Variogram exact = fit_variogram(points, {}, options).variogram;
    options.error = 4;
    const Variogram allowed = fit_variogram(points, {}, options).variogram;
    EXPECT_GE(allowed.nugget, 4 * (1 - 1e-12));
    EXPECT_LT(worst(allowed), 1.5);
    EXPECT_GT(std::abs(hill(250) - (-20 + 0.02 * 300)), 60);  // the hills are far off there
    EXPECT_GT(allowed.range, exact.range);
    const auto alike = fit_alike(std::vector<SurfaceData>{{points}}, {}, options);
    ASSERT_EQ(alike.size(), 1U);
    EXPECT_GE(alike[0].variogram.nugget, 4 * (1 - 1e-12));
}

TEST(Likelihood, NoGaussianModelWhereThereAreBounds) {
    Points points = hills(14, 1000, {0, 0}, 3);
    for (auto& point : points)
        point[2] = fold(point[0] / 4);
    FitOptions options;
    EXPECT_EQ(likeliest_variogram(points, {}, options, nullptr)->model, VariogramModel::kGaussian);
    options.has_bounds = true;
    EXPECT_NE(likeliest_variogram(points, {}, options, nullptr)->model, VariogramModel::kGaussian);
}

TEST(Likelihood, DoesNotDependOnTheUnitOfHeights) {
    Folded feet;
    const Folded meters;
    for (auto& point : feet.points)
        point[2] /= 0.3048;
    for (auto& slope : feet.slopes)
        slope = {slope[0] / 0.3048, slope[1] / 0.3048};
    const auto a = likeliest_variogram(meters.points, {}, meters.options(), nullptr);
    const auto b = likeliest_variogram(feet.points, {}, feet.options(), nullptr);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->model, b->model);
    EXPECT_NEAR(a->range, b->range, 1e-6 * a->range);
    EXPECT_NEAR(a->sill, b->sill * 0.3048 * 0.3048, 1e-6 * a->sill);
}

TEST(Likelihood, DipsOfFoldsShowTheirAxis) {
    Folded folded;
    folded.positions.resize(5);  // too few for a wave
    folded.slopes.resize(5);
    const auto found = likeliest_variogram(folded.points, {}, folded.options(), nullptr);
    ASSERT_TRUE(found);
    EXPECT_GT(found->anisotropy.ratio, 3);
    const double azimuth = found->anisotropy.azimuth;
    EXPECT_LT(std::min(azimuth, 180 - azimuth), 5);
    EXPECT_EQ(found->nugget, 0);
    EXPECT_TRUE(found->further.empty());
}

TEST(Likelihood, DipsOfManyFoldsShowTheirLength) {
    const Folded folded;
    const auto found = likeliest_variogram(folded.points, {}, folded.options(), nullptr);
    ASSERT_TRUE(found);
    ASSERT_EQ(found->further.size(), 1U);
    const NestedStructure& wave = found->further[0];
    EXPECT_EQ(wave.model, VariogramModel::kWave);
    EXPECT_NEAR(wave.range / wave.anisotropy.ratio, 400, 4);
    EXPECT_LT(std::min(wave.anisotropy.azimuth, 180 - wave.anisotropy.azimuth), 1);
    EXPECT_GT(wave.sill, 0.3 * found->sill);
    EXPECT_NO_THROW(check_variogram(*found));
}

TEST(Likelihood, OneDomeIsNoWave) {
    Points points = hills(20, 1000, {0, 0}, 3);
    const auto dome = [](double x, double y) {
        return 100 * std::exp(-((x - 500) * (x - 500) + (y - 450) * (y - 450)) / 9e4);
    };
    for (auto& point : points)
        point[2] = dome(point[0], point[1]);
    Slopes positions, slopes;
    for (const auto& [x, y, z] : hills(20, 1000, {0, 0}, 8)) {
        positions.push_back({x, y});
        slopes.push_back({(dome(x + 0.01, y) - dome(x - 0.01, y)) / 0.02,
                          (dome(x, y + 0.01) - dome(x, y - 0.01)) / 0.02});
    }
    const FitOptions options{Drift::kConstant, 32, true, false, {positions, slopes, 160, 0}};
    const auto found = likeliest_variogram(points, {}, options, nullptr);
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->further.empty());
}

/// Waves in all directions.
double choppy(double x, double y, unsigned seed) {
    std::mt19937 random(seed);
    double sum = 0;
    for (int wave = 0; wave < 100; ++wave) {
        const double azimuth = static_cast<double>(random()), phase = static_cast<double>(random());
        const double number = 0.0075 * static_cast<double>(random()) / 4294967296.0;
        sum += std::cos((x * std::cos(azimuth) + y * std::sin(azimuth)) * number + phase);
    }
    return sum;
}

TEST(Likelihood, AFewContactsShowNoAnisotropyByChance) {
    FitOptions options;
    options.finds_anisotropy = true;
    int anisotropic = 0;
    for (unsigned seed = 0; seed < 20; ++seed) {
        Points points = hills(9, 1000, {0, 0}, seed);
        for (auto& [x, y, z] : points)
            z = choppy(x, y, 100 + seed);
        const auto found = likeliest_variogram(points, {}, options, nullptr);
        ASSERT_TRUE(found);
        anisotropic += found->anisotropy.ratio > 1 ? 1 : 0;
    }
    EXPECT_LE(anisotropic, 1);
}

TEST(Likelihood, AGivenAnisotropyStays) {
    const Folded folded;
    FitOptions options = folded.options();
    options.finds_anisotropy = false;
    const auto found = likeliest_variogram(folded.points, {3, 20}, options, nullptr);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->anisotropy.ratio, 3);
    EXPECT_EQ(found->anisotropy.azimuth, 20);
}

TEST(Likelihood, NoiseIsANugget) {
    Points points = hills(28, 1000, {0, 0}, 4);
    for (std::size_t i = 0; i < points.size(); ++i)
        points[i][2] = 0.1 * points[i][0] + (i % 2 == 0 ? 15 : -15);
    const auto found = likeliest_variogram(points, {}, {}, nullptr);
    ASSERT_TRUE(found);
    EXPECT_GT(found->nugget + (found->range < 100 ? found->sill : 0), 50);
}

TEST(Likelihood, OfTooFewDataThereIsNone) {
    EXPECT_FALSE(likeliest_variogram(Points{{0, 0, 1}, {1, 0, 2}}, {}, {}, nullptr));
    // one point with a dip: two slopes are free
    const Slopes at{{5, 5}}, slope{{0.1, 0.2}};
    const FitOptions options{Drift::kConstant, 32, false, false, {at, slope, 5, 0}};
    EXPECT_TRUE(likeliest_variogram(Points{{0, 0, 1}}, {}, options, nullptr));
}

TEST(Likelihood, FitUsesIt) {
    const Folded folded;
    const FittedVariogram fitted = fit_variogram(folded.points, {}, folded.options());
    const auto found = likeliest_variogram(folded.points, {}, folded.options(), nullptr);
    ASSERT_TRUE(found);
    EXPECT_EQ(fitted.variogram.range, found->range);
    EXPECT_EQ(fitted.variogram.sill, found->sill);
    EXPECT_FALSE(fitted.experimental.lags.empty());
}

TEST(Likelihood, SurfacesThatVaryAlikeHaveTheShapeThatTheirDataShowTogether) {
    const Folded folded;
    // three contacts of a surface of twice the amplitude, and one of another
    Points few{{5e5 + 100, 4e6, 100}, {5e5 + 500, 4e6 + 300, 101}, {5e5 + 300, 4e6 + 700, -99}};
    const Points single{{5e5 + 50, 4e6 + 50, 7}};
    const FitOptions options = folded.options();
    const std::vector<SurfaceData> surfaces{{folded.points, options.dips}, {few}, {single}};
    const auto found = fit_alike(surfaces, {}, options);
    ASSERT_EQ(found.size(), 3U);
    for (const FittedVariogram& each : found) {
        EXPECT_EQ(each.variogram.model, found[0].variogram.model);
        EXPECT_EQ(each.variogram.range, found[0].variogram.range);
        ASSERT_EQ(each.variogram.further.size(), 1U);
        EXPECT_EQ(each.variogram.further[0].range, found[0].variogram.further[0].range);
        EXPECT_NEAR(each.variogram.further[0].sill / each.variogram.sill,
                    found[0].variogram.further[0].sill / found[0].variogram.sill, 1e-12);
    }
    // too few data for a sill of their own: that of all
    EXPECT_EQ(found[1].variogram.sill, found[2].variogram.sill);
    EXPECT_NE(found[1].variogram.sill, found[0].variogram.sill);
    EXPECT_EQ(found[1].experimental.pairs.size(), found[1].experimental.lags.size());
}

TEST(Likelihood, OneSurfaceAloneVariesAsItself) {
    const Folded folded;
    const FitOptions options = folded.options();
    const std::vector<SurfaceData> one{{folded.points, options.dips}};
    const auto found = fit_alike(one, {}, options);
    const auto alone = likeliest_variogram(folded.points, {}, options, nullptr);
    ASSERT_TRUE(alone && found.size() == 1);
    EXPECT_EQ(found[0].variogram.range, alone->range);
    EXPECT_EQ(found[0].variogram.sill, alone->sill);
}

TEST(Likelihood, SurfacesOfTooFewDataHaveNone) {
    const Points one{{0, 0, 1}}, other{{5, 0, 2}};
    EXPECT_TRUE(fit_alike(std::vector<SurfaceData>{{one}, {other}}, {}, {}).empty());
}

}  // namespace
}  // namespace realmodel::interpolation
