// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact_volumes.hpp"

#include <gtest/gtest.h>

namespace realmodel::fuzz {
namespace {

using strata::Rule;

/// The unit square in two triangles, heights at (0, 0), (1, 0), (1, 1), (0, 1).
Mesh square(double a, double b, double c, double d) {
    return {{{0, 0, a}, {1, 0, b}, {1, 1, c}, {0, 1, d}}, {{0, 1, 2}, {0, 2, 3}}};
}

std::vector<double> volumes_of(std::vector<Mesh> surfaces, std::vector<Rule> rules = {},
                               std::optional<double> base = {}) {
    const StackCase stack{{{std::move(surfaces), std::move(rules), {}, base}}, ""};
    return exact_volumes(stack, 1000).value();
}

TEST(ExactVolumes, LevelLayersAndABase) {
    EXPECT_EQ(volumes_of({square(0, 0, 0, 0), square(1, 1, 1, 1), square(3, 3, 3, 3)}, {}, -1.0),
              (std::vector<double>{1, 1, 2}));
}

TEST(ExactVolumes, ACrossingPlaneErodes) {
    // rises from -1 to 1: half of it lies above, a wedge of a quarter is left
    EXPECT_EQ(volumes_of({square(0, 0, 0, 0), square(-1, 1, 1, -1)}),
              (std::vector<double>{0, 0.25}));
    EXPECT_EQ(volumes_of({square(0, 0, 0, 0), square(1, 1, 1, 1), square(-1, 1, 1, -1)}, {}, -2.0),
              (std::vector<double>{1.75, 0.25, 0}));
}

TEST(ExactVolumes, OfEveryRule) {
    const Mesh low = square(0, 0, 0, 0), high = square(2, 2, 2, 2), cut = square(1, 1, 1, 1);
    EXPECT_EQ(volumes_of({low, high, cut}), (std::vector<double>{0, 1, 0}));
    EXPECT_EQ(
        volumes_of({low, high, cut}, {Rule::kErosional, Rule::kErosional, Rule::kConformable}),
        (std::vector<double>{0, 2, 0}));
    EXPECT_EQ(volumes_of({low, high, cut}, {Rule::kErosional, Rule::kBase, Rule::kErosional}),
              (std::vector<double>{0, 2, 0}));
    EXPECT_EQ(
        volumes_of({low, high, cut}, {Rule::kErosional, Rule::kErosional, Rule::kDiscontinuous}),
        (std::vector<double>{0, 1, 0}));
}

TEST(ExactVolumes, OnlyWhereThereIsASurface) {
    const Mesh half{{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}}, {{2, 1, 0}}};  // turned the other way
    EXPECT_EQ(volumes_of({square(0, 0, 0, 0), half}), (std::vector<double>{0, 0.5}));
}

TEST(ExactVolumes, InsideTheRegion) {
    StackCase stack{{{{square(0, 0, 0, 0), square(1, 1, 1, 1)}, {}, {}, {}}}, ""};
    stack.rocks[0].region = PlanMesh{{{0, 0}, {0.5, 0}, {0.5, 0.5}}, {{0, 1, 2}}};
    EXPECT_EQ(exact_volumes(stack, 1000).value(), (std::vector<double>{0, 0.125}));
}

TEST(ExactVolumes, DifferencesOfOneUnitInTheLastPlaceCount) {
    const double above = 1 + 0x1p-52;
    EXPECT_EQ(volumes_of({square(1, 1, 1, 1), square(above, above, above, above)}),
              (std::vector<double>{0, 0x1p-52}));
    const double least = std::numeric_limits<double>::denorm_min();
    EXPECT_GT(volumes_of({square(0, 0, 0, 0), square(0, 0, least, 0)})[1], 0);
}

TEST(ExactVolumes, GivesUpWhereItWouldTakeTooLong) {
    const StackCase stack{{{{square(0, 0, 0, 0), square(1, 1, 1, 1)}, {}, {}, {}}}, ""};
    EXPECT_FALSE(exact_volumes(stack, 1).has_value());
}

}  // namespace
}  // namespace realmodel::fuzz
