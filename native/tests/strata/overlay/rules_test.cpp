// SPDX-License-Identifier: GPL-3.0-or-later
#include "../complex_checks.hpp"

namespace realmodel::strata {
namespace {

std::vector<Rule> every_rule() {
    std::vector<Rule> every;
    for (const RuleMeaning& row : kRules)
        every.push_back(*rule_named(row.name));
    return every;
}

CellComplex build_ruled(const std::vector<OwnedSurface>& surfaces, std::vector<Rule> rules,
                        std::optional<double> base = std::nullopt,
                        CellKind cells = CellKind::kColumns) {
    StackInput input;
    for (const OwnedSurface& s : surfaces)
        input.surfaces.push_back(s.view());
    input.rules = std::move(rules);
    input.base_elevation = base;
    return build_stack(input, {2, nullptr}, cells);
}

OwnedSurface flat(double z, bool other = false) {
    return grid(
        1, 1, 0, 0, 1, 1, [z](double, double) { return z; }, other);
}

OwnedSurface rising(double from, double to) {
    return grid(1, 1, 0, 0, 1, 1, [=](double x, double) { return from + (to - from) * x; });
}

TEST(Rules, OnlapEndsWhereItMeetsTheTop) {
    // a level at 1/2 over z = x fills the low half only
    const auto c = build_ruled({flat(-1), rising(0, 1), flat(0.5, true)},
                               {Rule::kErosional, Rule::kErosional, Rule::kConformable});
    expect_valid(c);
    EXPECT_DOUBLE_EQ(c.volumes[1], 1.5);
    EXPECT_DOUBLE_EQ(c.volumes[2], 0.125);
}

TEST(Rules, WhatProtectsItselfIsNotCut) {
    for (const Rule rule : {Rule::kBase, Rule::kDiscontinuous}) {
        const auto c = build_ruled({flat(-1), rising(0, 1), flat(0.5, true)},
                                   {Rule::kErosional, rule, Rule::kErosional});
        expect_valid(c);
        EXPECT_DOUBLE_EQ(c.volumes[1], 1.5);
        EXPECT_DOUBLE_EQ(c.volumes[2], 0.125);
    }
}

TEST(Rules, DiscontinuousCutsAndErosionalIsCut) {
    const auto c =
        build_ruled({flat(-1), flat(0), rising(-0.5, 0.5), flat(-0.25, true)},
                    {Rule::kErosional, Rule::kErosional, Rule::kDiscontinuous, Rule::kErosional});
    expect_valid(c);
    EXPECT_DOUBLE_EQ(c.volumes[1], 1.0 - 0.125);
    EXPECT_DOUBLE_EQ(c.volumes[2], 0.125);    // above z = 0 it protects what lies beneath it
    EXPECT_DOUBLE_EQ(c.volumes[3], 0.03125);  // fills the low quarter of the dip
}

TEST(Rules, APartialSurfaceRaisesTheTopWhereItIs) {
    const auto patch = grid(1, 1, 0.25, 0.25, 0.75, 0.75, [](double, double) { return 2; });
    const auto c = build_ruled({flat(0), patch, flat(1, true)},
                               {Rule::kErosional, Rule::kErosional, Rule::kConformable});
    expect_valid(c);
    EXPECT_DOUBLE_EQ(c.volumes[1], 0.5);
    EXPECT_DOUBLE_EQ(c.volumes[2], 0.75);
}

/// Volumes where z = x protects, all becomes air, and others come upon a level at -1.
std::vector<double> upon_emptied(const std::vector<double>& heights, std::vector<Rule> rules) {
    std::vector<OwnedSurface> surfaces{rising(0, 1), flat(-1, true)};
    for (const double z : heights)
        surfaces.push_back(flat(z, surfaces.size() % 2 == 0));
    StackInput input;
    for (const OwnedSurface& s : surfaces)
        input.surfaces.push_back(s.view());
    input.rules = {Rule::kBase, Rule::kConformable};
    input.rules.insert(input.rules.end(), rules.begin(), rules.end());
    input.emptied = {1};
    const auto c = build_stack(input, {2, nullptr}, CellKind::kColumns);
    expect_valid(c);
    EXPECT_EQ(c.volumes[0], 0);
    EXPECT_EQ(c.volumes[1], 0);
    return {c.volumes.begin() + 2, c.volumes.end()};
}

TEST(Rules, WhereRockWasEmptiedWhatWasProtectedIsNotCut) {
    const auto erosional = [](std::size_t count) {
        return std::vector<Rule>(count, Rule::kErosional);
    };
    const auto filled = upon_emptied({2, 0.5}, erosional(2));
    EXPECT_DOUBLE_EQ(filled[0], 1.625);
    EXPECT_DOUBLE_EQ(filled[1], 0);
    // what was protected is higher than some of what came since
    const auto low = upon_emptied({0.25, 0.75, 0.5}, erosional(3));
    EXPECT_DOUBLE_EQ(low[0], 1.25);
    EXPECT_DOUBLE_EQ(low[1], 0.34375);
    EXPECT_DOUBLE_EQ(low[2], 0);
    // a lower one that protects takes nothing from it
    const auto both =
        upon_emptied({0.25, 0.75, 0}, {Rule::kBase, Rule::kErosional, Rule::kErosional});
    EXPECT_DOUBLE_EQ(both[0], 1.25);
    EXPECT_DOUBLE_EQ(both[1], 0.25);
    EXPECT_DOUBLE_EQ(both[2], 0);
}

/// The volume beneath the youngest surface, where all above what is below the oldest one becomes
/// air before each of some surfaces.
double upon_oldest(const std::vector<OwnedSurface>& surfaces, std::vector<Rule> rules,
                   std::vector<std::size_t> emptied, std::vector<std::uint8_t> fills) {
    StackInput input;
    for (const OwnedSurface& s : surfaces)
        input.surfaces.push_back(s.view());
    input.rules = std::move(rules);
    input.emptied = std::move(emptied);
    input.fills = std::move(fills);
    const auto c = build_stack(input, {2, nullptr}, CellKind::kColumns);
    expect_valid(c);
    for (std::size_t k = 0; k + 1 < c.volumes.size(); ++k)
        EXPECT_EQ(c.volumes[k], 0);
    for (const std::int32_t named : c.face_surface)
        EXPECT_GE(named, kWall);
    return c.volumes.back();
}

TEST(Rules, WhatIsBelowTheOldestSurfaceMayStayWhereRockWasEmptied) {
    const Rule cuts = Rule::kErosional, deposits = Rule::kConformable;
    const auto left = grid(1, 1, 0, 0, 0.5, 1, [](double, double) { return 0; });
    // z = x, cut at 1/2
    const std::vector<OwnedSurface> cut{rising(0, 1), flat(0.5, true), flat(2)};
    EXPECT_DOUBLE_EQ(upon_oldest(cut, {cuts, cuts, cuts}, {2}, {0, 0}), 1.625);
    EXPECT_DOUBLE_EQ(upon_oldest(cut, {cuts, deposits, cuts}, {2}, {0, 0}), 1.5);
    EXPECT_DOUBLE_EQ(upon_oldest(cut, {Rule::kBase, cuts, cuts}, {2}, {0, 0}), 1.5);
    EXPECT_DOUBLE_EQ(upon_oldest(cut, {cuts, cuts, cuts}, {1, 2}, {0, 0}), 1.625);
    // the oldest surface is another one on either side
    const std::vector<OwnedSurface> partial{left, flat(0.25), flat(1, true)};
    EXPECT_DOUBLE_EQ(upon_oldest(partial, {cuts, cuts, cuts}, {2}, {0, 0}), 0.875);
    // nothing is below a body, so what comes later has nothing to end at but a level given for that
    const std::vector<OwnedSurface> body{left, flat(10), flat(0.25), flat(1, true)};
    EXPECT_DOUBLE_EQ(upon_oldest(body, {cuts, deposits, cuts, cuts}, {3}, {0, 1, 0}), 0.5);
    const std::vector<OwnedSurface> deep{left, flat(10), flat(0.25), flat(-1), flat(1, true)};
    const std::vector<Rule> rules{cuts, deposits, cuts, deposits, cuts};
    EXPECT_DOUBLE_EQ(upon_oldest(deep, rules, {3}, {0, 1, 0}), 1.5);
    EXPECT_DOUBLE_EQ(upon_oldest(deep, rules, {3}, {}), 2);
}

/// Block k at one plan point by the recurrence of docs/dev/geometry.md.
std::vector<double> thickness(const std::vector<double>& heights, const std::vector<Rule>& rules) {
    std::vector<double> e, before;
    double top = 0, floor = -HUGE_VAL;
    for (std::size_t k = 0; k < heights.size(); ++k) {
        before.push_back(top);
        double z = heights[k];
        if (k > 0 && !meaning(rules[k]).cuts) z = std::max(z, top);
        z = std::max(z, floor);
        top = z;
        if (meaning(rules[k]).protects) floor = z;
        e.push_back(z);
    }
    std::vector<double> result(heights.size(), 0.0);
    double lowest = HUGE_VAL;
    for (std::size_t k = heights.size(); k-- > 1;) {
        lowest = std::min(lowest, e[k]);
        result[k] = lowest - std::min(before[k], lowest);
    }
    return result;
}

TEST(Rules, EveryMixtureOfFourLevelSurfacesIsTheClosedForm) {
    const std::vector<double> heights{0, 3, 1, 2};
    const std::vector<Rule> every = every_rule();
    for (const Rule a : every) {
        for (const Rule b : every) {
            for (const Rule c : every) {
                for (const Rule d : every) {
                    const std::vector<Rule> rules{a, b, c, d};
                    std::vector<OwnedSurface> surfaces;
                    for (std::size_t k = 0; k < 4; ++k)
                        surfaces.push_back(flat(heights[k], k % 2));
                    const auto built = build_ruled(surfaces, rules);
                    expect_valid(built);
                    const auto expected = thickness(heights, rules);
                    for (std::size_t k = 1; k < 4; ++k) {
                        EXPECT_DOUBLE_EQ(built.volumes[k], expected[k]);
                    }
                }
            }
        }
    }
}

TEST(Rules, MixturesOverCrossingSurfacesAreValid) {
    const std::vector<OwnedSurface> surfaces{
        flat(-2), rising(1, -1), rising(-1, 1),
        grid(
            2, 2, 0, 0, 1, 1, [](double x, double y) { return 4 * (x - 0.5) * (y - 0.5); }, true)};
    const std::vector<Rule> every = every_rule();
    for (const Rule b : every) {
        for (const Rule c : every) {
            for (const Rule d : every) {
                const std::vector<Rule> rules{Rule::kErosional, b, c, d};
                const auto built = build_ruled(surfaces, rules, -3.0);
                expect_valid(built);
                const auto merged = merge_columns(built);
                expect_valid(merged, true);
                const auto blocks = build_ruled(surfaces, rules, -3.0, CellKind::kBlocks);
                expect_valid(blocks, true);
                EXPECT_EQ(cells_of_blocks(blocks), cells_of_blocks(merged));
                for (std::size_t k = 0; k < built.volumes.size(); ++k)
                    EXPECT_NEAR(blocks.volumes[k], built.volumes[k], 1e-12);
            }
        }
    }
}

TEST(Rules, NothingButErosionIsTheSameByName) {
    const std::vector<OwnedSurface> surfaces{flat(-2), rising(1, -1), rising(-1, 1)};
    const auto named = build_ruled(surfaces, std::vector<Rule>(3, Rule::kErosional));
    const auto plain = build(surfaces);
    EXPECT_EQ(named.vertices, plain.vertices);
    EXPECT_EQ(named.face_vertices, plain.face_vertices);
}

}  // namespace
}  // namespace realmodel::strata
