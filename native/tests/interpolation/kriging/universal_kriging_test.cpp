// SPDX-License-Identifier: GPL-3.0-or-later
// Kriging with a drift, nested variograms, and points left out.
#include <gtest/gtest.h>

#include <cstring>

#include "../../sanitized.hpp"
#include "../dense_kriging.hpp"
#include "../variogram_models.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/interpolation/kriging.hpp"
#include "realmodel/interpolation/variogram_fit.hpp"

namespace realmodel::interpolation {
namespace {

const Variogram kVariogram{VariogramModel::kSpherical, 40, 4, 0.5, {}, {}};

KrigingOptions with(Drift drift, int neighbors) {
    return {{neighbors}, drift};
}

double polynomial(const std::array<double, 2>& p, bool quadratic) {
    const double x = p[0] / 50, y = p[1] / 50;
    return 7 + 3 * x - 2 * y + (quadratic ? x * x - 3 * x * y + 0.5 * y * y : 0);
}

Points on_polynomial(int count, bool quadratic) {
    Points points = hills(count, 100);
    for (auto& p : points)
        p[2] = polynomial({p[0], p[1]}, quadratic);
    return points;
}

TEST(UniversalKriging, TheDriftItselfComesOutWhateverTheVariogram) {
    const Nodes nodes = scattered_nodes(100, 140, {-20, -20});
    for (const bool quadratic : {false, true}) {
        const Points points = on_polynomial(80, quadratic);
        const Drift drift = quadratic ? Drift::kQuadratic : Drift::kLinear;
        for (const int neighbors : {0, 16}) {
            const Kriged kriged = krige(points, nodes, kVariogram, with(drift, neighbors));
            for (std::size_t i = 0; i < nodes.size(); ++i) {
                ASSERT_NEAR(kriged.z[i], polynomial(nodes[i], quadratic), 1e-9);
                ASSERT_GT(kriged.variance[i], 0);
            }
        }
    }
}

TEST(UniversalKriging, WithFewPoints) {
    // One point is a constant; two are a line along theirs, and constant across it; three a plane.
    const Nodes nodes{{5, 5}, {10, 0}, {0, 10}};
    const auto z = [&](const Points& points, Drift drift) {
        return krige(points, nodes, kVariogram, with(drift, 16)).z;
    };
    for (const Drift drift : {Drift::kLinear, Drift::kQuadratic}) {
        EXPECT_EQ(z({{0, 0, 3}}, drift), (std::vector<double>{3, 3, 3}));
        const std::vector<double> line = z({{0, 0, 0}, {2, 2, 4}}, drift);
        EXPECT_NEAR(line[0], 10, 1e-9);
        EXPECT_NEAR(line[1], 10, 1e-9);
        EXPECT_NEAR(line[2], 10, 1e-9);
    }
    const std::vector<double> plane = z({{0, 0, 0}, {1, 0, 1}, {0, 1, -2}}, Drift::kLinear);
    EXPECT_NEAR(plane[0], -5, 1e-9);
    EXPECT_NEAR(plane[1], 10, 1e-9);
    EXPECT_NEAR(plane[2], -20, 1e-9);
}

TEST(UniversalKriging, PointsInOneLineHaveNoSlopeAcrossIt) {
    Points line;
    for (int i = 0; i < 30; ++i)
        line.push_back({1e5 + 3.0 * i, 5e6 + 1.0 * i, 2.0 * i});
    for (const int neighbors : {0, 10}) {
        const Kriged kriged = krige(line, Nodes{{1e5 + 60, 5e6 + 20}, {1e5 + 50, 5e6 + 50}},
                                    kVariogram, with(Drift::kLinear, neighbors));
        EXPECT_NEAR(kriged.z[0], 40, 1e-6);
        EXPECT_NEAR(kriged.z[1], 40, 1e-6);
    }
}

TEST(UniversalKriging, SameBytesForAnyNumberOfThreads) {
    const Points points = hills(500, 100);
    const Nodes nodes = scattered_nodes(kSanitized ? 300 : 1000, 100);
    for (const int neighbors : {0, 20}) {
        const Kriged one =
            krige(points, nodes, kVariogram, with(Drift::kQuadratic, neighbors), {1});
        const Kriged three =
            krige(points, nodes, kVariogram, with(Drift::kQuadratic, neighbors), {3});
        EXPECT_EQ(std::memcmp(one.z.data(), three.z.data(), 8 * nodes.size()), 0);
        EXPECT_EQ(std::memcmp(one.variance.data(), three.variance.data(), 8 * nodes.size()), 0);
    }
}

TEST(UniversalKriging, TheVariogramIsThatOfTheResiduals) {
    Points points = hills(300, 100);
    // Rough enough that rounding, which a slope adds to, decides nothing.
    std::mt19937 random(4);
    std::normal_distribution<double> normal;
    for (auto& p : points)
        p[2] += normal(random);
    const Variogram plain = fit_variogram(points, {}, {Drift::kLinear}).variogram;
    for (auto& p : points)
        p[2] += 40 * p[0] - 25 * p[1];
    const Variogram tilted = fit_variogram(points, {}, {Drift::kLinear}).variogram;
    EXPECT_EQ(tilted.model, plain.model);
    EXPECT_NEAR(tilted.sill, plain.sill, 1e-6 * plain.sill);
    EXPECT_NEAR(tilted.range, plain.range, 1e-6 * plain.range);
    EXPECT_GT(fit_variogram(points, {}).variogram.sill, 100 * plain.sill);
}

TEST(NestedVariogram, TwoOfOneKindAreOneOfTheirSum) {
    const Points points = hills(100, 100);
    const Nodes nodes = scattered_nodes(50, 100);
    const Variogram nested{
        VariogramModel::kSpherical, 40, 4, 0.5, {}, {{VariogramModel::kSpherical, 40, 1.25, {}}}};
    check_variogram(nested);
    EXPECT_DOUBLE_EQ(nested.first_sill(), 2.25);
    EXPECT_DOUBLE_EQ(gamma_of(nested, 13), gamma_of(kVariogram, 13));
    for (const int neighbors : {0, 16}) {
        const Kriged a = krige(points, nodes, nested, {{neighbors}});
        const Kriged b = krige(points, nodes, kVariogram, {{neighbors}});
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            EXPECT_NEAR(a.z[i], b.z[i], 1e-11);
            EXPECT_NEAR(a.variance[i], b.variance[i], 1e-11);
        }
    }
}

TEST(NestedVariogram, RefusesWhatIsNone) {
    const auto refused = [](const NestedStructure& further) {
        try {
            check_variogram({VariogramModel::kSpherical, 40, 4, 0.5, {}, {further}});
        } catch (const InputError& error) {
            return error.kind;
        }
        return std::string("accepted");
    };
    EXPECT_EQ(refused({VariogramModel::kGaussian, 40, 3.5, {}}), "accepted");
    EXPECT_EQ(refused({VariogramModel::kGaussian, 40, 3.6, {}}), "variogram");
    EXPECT_EQ(refused({VariogramModel::kGaussian, 0, 1, {}}), "variogram");
    EXPECT_EQ(refused({VariogramModel::kGaussian, 40, -1, {}}), "variogram");
    EXPECT_EQ(refused({VariogramModel::kGaussian, 40, 1, {0, 0}}), "anisotropy");
}

TEST(LeftOut, AsKrigingWithoutThePoint) {
    Points points = hills(90, 100, {4e5, 5e6});
    points.push_back(points[5]);  // repeats one: the two leave together
    for (const Drift drift : {Drift::kConstant, Drift::kLinear, Drift::kQuadratic}) {
        for (const int neighbors : {0, 12}) {
            const KrigingOptions options = with(drift, neighbors);
            const Kriged found = krige_left_out(points, kVariogram, options);
            ASSERT_EQ(found.z.size(), points.size());
            EXPECT_EQ(found.z[5], found.z.back());
            for (std::size_t i = 0; i < 90; i += 7) {
                Points others = points;
                others.pop_back();
                others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
                const Kriged alone =
                    krige(others, Nodes{{points[i][0], points[i][1]}}, kVariogram, options);
                EXPECT_NEAR(found.z[i], alone.z[0], 1e-8);
                EXPECT_NEAR(found.variance[i], alone.variance[0], 1e-9);
            }
        }
    }
}

TEST(LeftOut, WhatOthersTellWhollyOrNotAtAll) {
    const Kriged alone = krige_left_out(Points{{1, 2, 3}}, kVariogram, {});
    EXPECT_EQ(alone.z[0], 3);
    EXPECT_TRUE(std::isinf(alone.variance[0]));
    // Three points make a plane; two of them a line only.
    const Kriged three = krige_left_out(Points{{0, 0, 0}, {1, 0, 1}, {0, 1, -2}}, kVariogram,
                                        with(Drift::kLinear, 0));
    for (const double z : three.z)
        EXPECT_TRUE(std::isfinite(z));
    // Nearly singular: most of these points the others tell to the last digit.
    Points smooth;
    for (int i = 0; i < 144; ++i)
        smooth.push_back({1.0 * (i % 12), 1.0 * (i / 12), 0.5 * (i % 12)});
    const Variogram gaussian{VariogramModel::kGaussian, 30, 10, 0, {}, {}};
    const Kriged found = krige_left_out(smooth, gaussian, {{0}});
    for (std::size_t i = 0; i < smooth.size(); ++i)
        EXPECT_NEAR(found.z[i], smooth[i][2], 0.01);
}

}  // namespace
}  // namespace realmodel::interpolation
