// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/variogram.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../variogram_models.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::interpolation {
namespace {

TEST(Structure, ValuesByHand) {
    EXPECT_NEAR(structure(VariogramModel::kSpherical, 0.5), 0.6875, 1e-15);  // 0.75 - 1/16
    EXPECT_EQ(structure(VariogramModel::kSpherical, 2), 1);
    EXPECT_NEAR(structure(VariogramModel::kExponential, std::log(2) / 3), 0.5, 1e-15);
    EXPECT_NEAR(structure(VariogramModel::kGaussian, std::sqrt(std::log(2) / 3)), 0.5, 1e-15);
    // 7/4 - 8.75/8 + 3.5/32 - 0.75/128
    EXPECT_NEAR(structure(VariogramModel::kCubic, 0.5), 0.759765625, 1e-15);
    EXPECT_EQ(structure(VariogramModel::kCubic, 1), 1);
    // At a t = 1: 1 - 2 / e; at b t = 1: 1 - (2 + 1/3) / e.
    EXPECT_NEAR(structure(VariogramModel::kMatern32, 1 / 4.743864518390579), 1 - 2 / std::exp(1),
                1e-15);
    EXPECT_NEAR(structure(VariogramModel::kMatern52, 1 / 5.918649346310188),
                1 - 7 / (3 * std::exp(1)), 1e-15);
    for (const VariogramModel model : kAllVariogramModels) {
        EXPECT_EQ(structure(model, 0), 0);
        const double at_range = structure(model, 1);
        EXPECT_TRUE(at_range == 1 || std::abs(at_range - 0.95) < 3e-4) << name_of(model);
        EXPECT_EQ(variogram_model(name_of(model)), model);
    }
    EXPECT_THROW(variogram_model("linear"), InputError);
}

TEST(Variogram, NestedStructuresShareTheSill) {
    Variogram v{VariogramModel::kSpherical, 100, 10, 1, {}, {}};
    v.further.push_back({VariogramModel::kSpherical, 400, 3, {}});
    EXPECT_EQ(v.first_sill(), 6);
    EXPECT_EQ(gamma_of(v, 0), 0);
    // f(50 / 100) = 0.6875, f(50 / 400) = 0.1875 - 0.5 / 512
    EXPECT_NEAR(gamma_of(v, 50), 1 + 6 * 0.6875 + 3 * (0.1875 - 0.5 / 512), 1e-14);
    EXPECT_EQ(gamma_of(v, 400), 10);
    EXPECT_NO_THROW(check_variogram(v));
}

TEST(Variogram, RefusesNumbersThatMeanNothing) {
    const Variogram good{VariogramModel::kCubic, 100, 10, 1, {}, {}};
    const auto kind = [&](auto&& change) {
        Variogram v = good;
        change(v);
        try {
            check_variogram(v);
        } catch (const InputError& error) {
            return error.kind;
        }
        return std::string("accepted");
    };
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(kind([](Variogram&) {}), "accepted");
    EXPECT_EQ(kind([](Variogram& v) { v.range = 0; }), "variogram");
    EXPECT_EQ(kind([](Variogram& v) { v.range = kInfinity; }), "variogram");
    EXPECT_EQ(kind([](Variogram& v) { v.sill = std::nan(""); }), "variogram");
    EXPECT_EQ(kind([](Variogram& v) { v.nugget = 11; }), "variogram");
    EXPECT_EQ(kind([](Variogram& v) { v.nugget = -1; }), "variogram");
    EXPECT_EQ(kind([](Variogram& v) { v.anisotropy.ratio = 0; }), "anisotropy");
    EXPECT_EQ(kind([](Variogram& v) { v.anisotropy.azimuth = kInfinity; }), "anisotropy");
    EXPECT_EQ(kind([](Variogram& v) { v.further.push_back({}); }), "accepted");
    EXPECT_EQ(kind([](Variogram& v) { v.further.push_back({{}, 1, 9.5, {}}); }), "variogram");
    EXPECT_EQ(kind([](Variogram& v) { v.further.push_back({{}, -1, 1, {}}); }), "variogram");
    EXPECT_EQ(kind([](Variogram& v) { v.further.push_back({{}, 1, 1, {-2, 0}}); }), "anisotropy");
}

}  // namespace
}  // namespace realmodel::interpolation
