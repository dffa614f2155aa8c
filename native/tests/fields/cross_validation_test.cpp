// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "fields/likely_field.hpp"

namespace realmodel::fields {
namespace {

constexpr Lattice kHundred{{0, 0, 0}, {10, 10, 10}, {11, 11, 11}};
const Likely kWithoutErrors{kIsotropic, {}, 3}, kWithLargeErrors{kIsotropic, {1, 100}, 3};

/// Two surfaces 20 apart, a plane or waves, with contacts and dips that are off.
struct BedsWithErrors {
    std::vector<std::array<double, 3>> contacts, dips, normals;
    std::vector<std::int32_t> surfaces;

    BedsWithErrors(double wave, double error) {
        std::mt19937 random(5);
        const auto drawn = [&] { return static_cast<double>(random()) / 4294967296.0; };
        for (int n = 0; n < 60; ++n) {
            const double x = 100 * drawn(), y = 100 * drawn(),
                         slope = 0.1 * wave * std::cos(x / 10);
            const double z = 40 + wave * std::sin(x / 10) + 2 * error * (drawn() - 0.5);
            surfaces.push_back(n % 2);
            contacts.push_back({x, y, z + 20 * surfaces.back()});
            const double steep = std::hypot(slope, 1);
            dips.push_back({x, 100 - y, z + 10});
            normals.push_back({-slope / steep, 0, 1 / steep});
        }
    }

    std::vector<double> costs(int threads) const {
        FieldData data;
        data.surfaces = 2;
        data.contacts = contacts;
        data.contact_surfaces = surfaces;
        data.dips = dips;
        data.normals = normals;
        const KnownData known(kHundred, data);
        return CrossValidation(known, {}).costs(std::vector{kWithoutErrors, kWithLargeErrors},
                                                {threads, nullptr});
    }
};

TEST(CrossValidation, ContactsThatAreOffArePredictedByPlanes) {
    const std::vector<double> costs = BedsWithErrors(0, 4).costs(1);
    EXPECT_LT(costs[1], costs[0]);
}

TEST(CrossValidation, WavesAreNotPredictedByPlanes) {
    const std::vector<double> costs = BedsWithErrors(5, 0).costs(1);
    EXPECT_LT(costs[0], costs[1] - 20);
}

TEST(CrossValidation, IsTheSameForAnyNumberOfThreads) {
    const BedsWithErrors beds(5, 4);
    EXPECT_EQ(beds.costs(1), beds.costs(3));
}

}  // namespace
}  // namespace realmodel::fields
