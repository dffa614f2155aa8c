// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/closed_form.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "../strata/complex_checks.hpp"

namespace realmodel::validation {

static bool operator==(const BlockInterval& a, const BlockInterval& b) {
    return a.block == b.block && a.low == b.low && a.high == b.high;
}

namespace {

using strata::OwnedSurface;
using strata::Rule;
using Intervals = std::vector<BlockInterval>;

OwnedSurface plane(double at_origin, double along_x = 0, double along_y = 0) {
    OwnedSurface s;
    s.vertex(0, 0, at_origin);
    s.vertex(4, 0, at_origin + 4 * along_x);
    s.vertex(0, 4, at_origin + 4 * along_y);
    s.triangle(0, 1, 2);
    return s;
}

/// Surfaces of one triangle each, oldest first.
struct Rock {
    explicit Rock(const std::vector<double>& heights, std::vector<Rule> with = {})
        : rules(std::move(with)) {
        for (const double z : heights)
            surfaces.push_back(plane(z));
    }
    strata::StackInput view() const {
        strata::StackInput input;
        for (const OwnedSurface& s : surfaces)
            input.surfaces.push_back(s.view());
        input.rules = rules;
        input.base_elevation = base;
        return input;
    }
    std::vector<OwnedSurface> surfaces;
    std::vector<Rule> rules;
    std::optional<double> base = 0.0;
};

/// Above (1, 1); the block beneath each surface has its number. `missing`: surfaces that have no
/// triangle there.
ClosedColumn column(const std::vector<Rock>& rocks, const std::vector<std::size_t>& missing = {}) {
    std::vector<strata::StackInput> inputs;
    std::vector<std::int32_t> blocks, triangles;
    for (const Rock& rock : rocks) {
        inputs.push_back(rock.view());
        for (std::size_t k = 0; k < rock.surfaces.size(); ++k) {
            triangles.push_back(std::ranges::count(missing, blocks.size()) != 0 ? -1 : 0);
            blocks.push_back(static_cast<std::int32_t>(blocks.size()));
        }
    }
    return closed_column({inputs, blocks}, triangles, {1, 1});
}
Intervals intervals(const Rock& rock, const std::vector<std::size_t>& missing = {}) {
    return column({rock}, missing).intervals;
}

TEST(ClosedForm, LayersLieOnEachOther) {
    Rock rock({1, 2, 4});
    EXPECT_EQ(intervals(rock), (Intervals{{0, 0, 1}, {1, 1, 2}, {2, 2, 4}}));
    rock.base.reset();  // nothing beneath the oldest
    EXPECT_EQ(intervals(rock), (Intervals{{1, 1, 2}, {2, 2, 4}}));
}

TEST(ClosedForm, AnErosionalSurfaceCutsAllThatIsHigher) {
    EXPECT_EQ(intervals(Rock({1, 3, 2})), (Intervals{{0, 0, 1}, {1, 1, 2}}));
    EXPECT_EQ(intervals(Rock({1, 3, 0.5})), (Intervals{{0, 0, 0.5}}));
    // and what is deposited on it fills up
    EXPECT_EQ(intervals(Rock({1, 3, 2, 5})), (Intervals{{0, 0, 1}, {1, 1, 2}, {3, 2, 5}}));
}

TEST(ClosedForm, AConformableSurfaceOnlyDeposits) {
    const std::vector<Rule> rules{Rule::kErosional, Rule::kErosional, Rule::kConformable};
    EXPECT_EQ(intervals(Rock({1, 3, 2}, rules)), (Intervals{{0, 0, 1}, {1, 1, 3}}));
    EXPECT_EQ(intervals(Rock({1, 3, 4}, rules)), (Intervals{{0, 0, 1}, {1, 1, 3}, {2, 3, 4}}));
}

TEST(ClosedForm, WhatIsProtectedIsNotCut) {
    for (const Rule rule : {Rule::kBase, Rule::kDiscontinuous}) {
        const std::vector<Rule> rules{Rule::kErosional, rule, Rule::kErosional};
        EXPECT_EQ(intervals(Rock({1, 3, 2}, rules)), (Intervals{{0, 0, 1}, {1, 1, 3}}));
    }
    // a base does not cut either, a discontinuous surface does
    EXPECT_EQ(intervals(Rock({3, 1}, {Rule::kErosional, Rule::kBase})), (Intervals{{0, 0, 3}}));
    EXPECT_EQ(intervals(Rock({3, 1}, {Rule::kErosional, Rule::kDiscontinuous})),
              (Intervals{{0, 0, 1}}));
}

TEST(ClosedForm, EquallyHighSurfacesHaveNothingBetweenThem) {
    EXPECT_EQ(intervals(Rock({1, 1, 2})), (Intervals{{0, 0, 1}, {2, 1, 2}}));
}

TEST(ClosedForm, ASurfaceThatIsNotThereLeavesItsBlockOut) {
    const Rock rock({1, 2, 4});
    EXPECT_EQ(intervals(rock, {1}), (Intervals{{0, 0, 1}, {2, 1, 4}}));
    // without the oldest nothing stands on the base
    EXPECT_EQ(intervals(rock, {0}), (Intervals{{2, 2, 4}}));
    EXPECT_EQ(intervals(rock, {0, 1, 2}), Intervals{});
}

TEST(ClosedForm, HeightsAreThoseOfThePlanesThere) {
    Rock rock({});
    rock.surfaces = {plane(0.5), plane(1, 0.5, -2), plane(9)};
    std::swap(rock.surfaces[1].triangles[0], rock.surfaces[1].triangles[1]);
    const ClosedColumn found = column({rock}, {2});
    EXPECT_EQ(found.surface_height,
              (std::vector<std::optional<double>>{0.5, 1 + 0.5 - 2, std::nullopt}));
    EXPECT_EQ(found.slope, 2.5);
    EXPECT_EQ(found.highest, 7);  // 4 along y, downward
}

TEST(ClosedForm, RockMassesFollowEachOther) {
    const Rock one({1, 2}), other({5, 6});
    const ClosedColumn found = column({one, other}, {0, 1});
    EXPECT_EQ(found.intervals, (Intervals{{2, 0, 5}, {3, 5, 6}}));
    EXPECT_EQ(found.surface_height,
              (std::vector<std::optional<double>>{std::nullopt, std::nullopt, 5, 6}));
}

}  // namespace
}  // namespace realmodel::validation
