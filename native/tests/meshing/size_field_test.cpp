// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/size_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "plan_mesh_checks.hpp"

namespace realmodel::meshing {
namespace {

constexpr double kGrowth = 0.25, largest = 8;
const PlanPoint low{1000, 5000}, high{1100, 5060};

/// What sources ask for at a place, by their definition.
double asked(const std::vector<SizeSource>& sources, const PlanPoint& p) {
    double least = largest;
    for (const SizeSource& s : sources) {
        const double ux = s.b[0] - s.a[0], uy = s.b[1] - s.a[1], squared = ux * ux + uy * uy;
        const double along =
            squared > 0
                ? std::clamp(((p[0] - s.a[0]) * ux + (p[1] - s.a[1]) * uy) / squared, 0., 1.)
                : 0;
        const double away = std::hypot(p[0] - s.a[0] - along * ux, p[1] - s.a[1] - along * uy);
        least = std::min(least, std::max(s.least, s.start + kGrowth * away));
    }
    return least;
}

SizeField field_of(const std::vector<SizeSource>& sources, double most_leaves = 1e6) {
    return {largest, kGrowth, sources, low, high, most_leaves};
}

TEST(SizeField, IsUniformWithoutSources) {
    EXPECT_TRUE(field_of({}).is_uniform());
    SizeField longer = field_of({{{1050, 5030}, {1050, 5030}, 9, 9}});
    EXPECT_TRUE(longer.is_uniform()) << "what asks for more than the largest asks for nothing";
    EXPECT_EQ(longer.at({1050, 5030}), largest);
}

TEST(SizeField, GrowsFromItsSources) {
    const std::vector<SizeSource> sources{{{1020, 5010}, {1020, 5010}, 0.5, 0.5},
                                          {{1050, 5040}, {1090, 5050}, -1, 1}};
    SizeField size = field_of(sources);
    EXPECT_FALSE(size.is_uniform());
    EXPECT_NEAR(size.smallest(), 0.5, 0.1);
    std::mt19937 random(2);
    for (int i = 0; i < 2000; ++i) {
        const PlanPoint p{low[0] + 100 * (static_cast<double>(random()) / 4294967296.0),
                          low[1] + 60 * (static_cast<double>(random()) / 4294967296.0)};
        const double wanted = asked(sources, p);
        // Between the corners of a leaf, which is 1.5 lengths wide at most, it is interpolated.
        EXPECT_NEAR(size.at(p), wanted, 0.3 * wanted + 1e-6) << p[0] << ", " << p[1];
    }
    EXPECT_NEAR(size.at({1070, 5045}), 1, 0.1) << "within the distance of the line";
    EXPECT_EQ(size.at({1000, 5060}), largest);
}

TEST(SizeField, OutsideIsAsAtTheBorder) {
    SizeField size = field_of({{{1000, 5000}, {1000, 5000}, 1, 1}});
    EXPECT_EQ(size.at({0, 0}), size.at(low));
}

TEST(SizeField, RefusesWhatNeedsTooManyLeaves) {
    const std::vector<SizeSource> fine{{{1000, 5000}, {1100, 5060}, 1e-3, 1e-3}};
    SizeField size = field_of(fine, 1000);
    const auto ask = [&] {
        for (int i = 0; i < 2000; ++i)
            size.at({1000 + 0.05 * i, 5000 + 0.03 * i});
    };
    EXPECT_EQ(refusal(ask).kind, "too_large");
}

}  // namespace
}  // namespace realmodel::meshing
