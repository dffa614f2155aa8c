// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/structures/build_compartments.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>
#include <utility>

#include "../strata/complex_checks.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::structures {
namespace {

using strata::OwnedSurface;

OwnedSurface level(double z, int n = 4) {
    return strata::grid(n, n, 0, 0, 4, 4, [z](double, double) { return z; });
}

/// The rectangle x = at + slant z, which goes far beyond the rock.
OwnedSurface inclined(double at, double slant) {
    OwnedSurface s;
    for (const double z : {-9.0, 9.0}) {
        for (const double y : {-9.0, 9.0})
            s.vertex(at + slant * z, y, z);
    }
    s.triangle(0, 1, 3);
    s.triangle(0, 3, 2);
    return s;
}

/// Layers over the square from (0, 0) to (4, 4), given for each part by the heights of their tops,
/// and faults that divide all of them.
struct Faulted {
    Faulted(std::vector<OwnedSurface> faults, const std::vector<std::vector<double>>& heights,
            std::vector<Sides> sides)
        : shapes(std::move(faults)) {
        for (const std::vector<double>& own : heights) {
            for (const double z : own)
                sheets.push_back(level(z));
        }
        for (const OwnedSurface& shape : shapes)
            input.structures.push_back({shape.view()});
        input.surfaces = static_cast<std::int32_t>(heights[0].size());
        input.blocks = heights[0].size();
        acts.assign(shapes.size() * input.blocks, 1);
        input.acts = acts;
        std::size_t next = 0;
        for (std::size_t p = 0; p < heights.size(); ++p) {
            CompartmentStack stack;
            for (std::size_t k = 0; k < heights[p].size(); ++k) {
                const auto number = static_cast<std::int32_t>(k);
                stack.stack.surfaces.push_back(sheets[next++].view());
                stack.surfaces.push_back({number, k == 0 ? -1 : number});
            }
            input.compartments.push_back({std::move(sides[p]), {stack}});
        }
    }
    CompartmentStack& stack(std::size_t part) { return input.compartments[part].rocks[0]; }

    std::vector<OwnedSurface> shapes, sheets;
    std::vector<std::uint8_t> acts;
    StructuredInput input;
};

/// Below the fault layers of thickness 1, above it the same, half as high again.
Faulted one_fault() {
    return {{inclined(1, 0.25)}, {{0, 1, 2}, {0.5, 1.5, 2.5}}, {{-1}, {1}}};
}

void expect_equal(const Joined& one, const Joined& other) {
    EXPECT_TRUE(std::ranges::equal(one.complex.vertices, other.complex.vertices));
    EXPECT_TRUE(std::ranges::equal(one.complex.face_vertices, other.complex.face_vertices));
    EXPECT_TRUE(std::ranges::equal(one.complex.face_cells, other.complex.face_cells));
    EXPECT_TRUE(std::ranges::equal(one.complex.face_surface, other.complex.face_surface));
    EXPECT_TRUE(std::ranges::equal(one.complex.cell_block, other.complex.cell_block));
    EXPECT_EQ(one.complex.volumes, other.complex.volumes);
    EXPECT_EQ(one.cell_compartment, other.cell_compartment);
}

Joined built(const StructuredInput& input) {
    const Joined one = build_compartments(input, {1, nullptr});
    strata::expect_valid(one.complex, input.cells == CellKind::kBlocks);
    for (const int threads : {2, 5})
        expect_equal(one, build_compartments(input, {threads, nullptr}));
    return one;
}

InputError refused(const StructuredInput& input) {
    try {
        build_compartments(input, {2, nullptr});
    } catch (const InputError& error) {
        return error;
    }
    return {"nothing", "is refused"};
}

TEST(BuildParts, AreTheStacksJoined) {
    for (const CellKind cells : {CellKind::kColumns, CellKind::kBlocks}) {
        Faulted own = one_fault();
        own.input.cells = cells;
        std::vector<CellComplex> stacks;
        std::vector<CompartmentModel> models;
        for (std::size_t p = 0; p < 2; ++p)
            stacks.push_back(strata::build_stack(own.stack(p).stack, {1, nullptr}, cells));
        for (std::size_t p = 0; p < 2; ++p)
            models.push_back({stacks[p], own.input.compartments[p].sides});
        const Joined all = built(own.input);
        EXPECT_EQ(all.complex.cell_kind, cells);
        EXPECT_GT(std::ranges::count(all.complex.face_surface, 3), 0);  // on the fault
        expect_equal(all, join_models(models, own.input.structures, own.acts, {1, nullptr}));
        // below the fault x > 1 + z / 4, above it x < 1 + z / 4; between y = 0 and y = 4
        EXPECT_NEAR(all.complex.volumes[1], 4 * (3 - 0.125) + 4 * (1 + 0.25), 1e-12);
        EXPECT_NEAR(all.complex.volumes[2], 4 * (3 - 0.375) + 4 * (1 + 0.5), 1e-12);
        for (std::size_t c = 0; c < all.cell_compartment.size(); ++c)
            EXPECT_TRUE(all.cell_compartment[c] == 0 || all.cell_compartment[c] == 1);
    }
}

/// One compartment with two solids, one in the other: a plunging edge of two level sets. In the
/// inner one is block 1, in the outer one block 2, and outside of both block 3; above z = 2 there
/// is block 4 everywhere.
struct Folded {
    explicit Folded(CellKind cells) {
        input.surfaces = 5;
        input.blocks = 5;
        input.cells = cells;
        for (const double z : {0.0, 2.0, 3.0})
            sheets.push_back(level(z));
        CompartmentInput part;
        for (std::size_t s = 0; s < 2; ++s)
            part.solids.push_back({solids[s].view(), static_cast<std::int32_t>(s + 1)});
        for (std::int32_t m = 0; m < 3; ++m) {
            CompartmentStack stack;
            for (const OwnedSurface& sheet : sheets)
                stack.stack.surfaces.push_back(sheet.view());
            stack.surfaces = {{kBase, -1}, {3, m + 1}, {4, 4}};
            const Sides sides{static_cast<std::int8_t>(m == 0 ? -1 : 1),
                              static_cast<std::int8_t>(m < 2 ? -1 : 1)};
            part.between.push_back({sides, {stack}});
        }
        input.compartments.push_back(std::move(part));
    }
    std::vector<OwnedSurface> solids{strata::box({1.5, -2, -2}, {2.5, 9, 1}),
                                     strata::box({0.5, -3, -3}, {3, 10, 4})};
    std::vector<OwnedSurface> sheets;
    StructuredInput input;
};

TEST(BuildParts, SolidsEndCellsWhereBlocksDiffer) {
    for (const CellKind cells : {CellKind::kColumns, CellKind::kBlocks}) {
        Folded own(cells);
        const Joined all = built(own.input);
        const std::vector<double> volumes{0, 4, 10 * 2 - 4, 32 - 20, 16};
        for (std::size_t block = 1; block < 5; ++block)
            EXPECT_NEAR(all.complex.volumes[block], volumes[block], 1e-12);
        std::set<std::int32_t> named;
        for (std::size_t f = 0; f < all.complex.face_surface.size(); ++f) {
            const auto& cells_of_face = all.complex.face_cells[f];
            named.insert(all.complex.face_surface[f]);
            if (all.complex.face_surface[f] != 1 && all.complex.face_surface[f] != 2) continue;
            ASSERT_GE(cells_of_face[1], 0);
            EXPECT_NE(all.complex.cell_block[static_cast<std::size_t>(cells_of_face[0])],
                      all.complex.cell_block[static_cast<std::size_t>(cells_of_face[1])]);
        }
        EXPECT_EQ(named, (std::set<std::int32_t>{kBase, kWall, 1, 2, 3, 4}));
        if (cells == CellKind::kBlocks) {  // outside of both there is rock on two sides
            EXPECT_EQ(all.complex.cell_block.size(), 5U);
        }
    }
}

TEST(BuildParts, SolidsThatDoNotFitAreRefused) {
    Folded without(CellKind::kColumns);
    without.input.compartments[0].between[1].sides.pop_back();
    EXPECT_EQ(refused(without.input).kind, "bad_part");
    Folded both(CellKind::kColumns);
    both.input.compartments[0].rocks = both.input.compartments[0].between[0].rocks;
    EXPECT_EQ(refused(both.input).kind, "bad_part");
    Folded unknown(CellKind::kColumns);
    unknown.input.compartments[0].solids[0].surface = 5;
    EXPECT_EQ(refused(unknown.input).kind, "bad_part");
    Folded open(CellKind::kColumns);
    open.solids[0].triangles.resize(open.solids[0].triangles.size() - 3);
    open.input.compartments[0].solids[0].boundary = open.solids[0].view();
    EXPECT_EQ(refused(open.input).kind, "not_closed");
}

TEST(BuildParts, WhereARockMassIsNotThereNothingIs) {
    Faulted own({inclined(1, 0), inclined(3, 0)}, {{0, 1}, {0, 1}, {0, 1}}, {{}, {}, {}});
    const auto parts =
        compartments_of({{{0, 0, 0}, {4, 4, 1}}}, own.input.structures, {1, nullptr});
    ASSERT_EQ(parts.size(), 3U);  // the second is the one between the faults
    for (std::size_t p = 0; p < 3; ++p)
        own.input.compartments[p].sides = parts[p].sides;
    EXPECT_NEAR(built(own.input).complex.volumes[1], 16, 1e-12);
    own.stack(1) = {};
    const Joined beside = built(own.input);
    EXPECT_NEAR(beside.complex.volumes[1], 8, 1e-12);
    EXPECT_EQ(std::ranges::count(beside.cell_compartment, 1), 0);
    EXPECT_GT(std::ranges::count(beside.cell_compartment, 0), 0);
    EXPECT_GT(std::ranges::count(beside.cell_compartment, 2), 0);
    for (const std::size_t part : {0, 2})
        own.stack(part) = {};
    const Joined nothing = built(own.input);
    EXPECT_TRUE(nothing.complex.cell_block.empty());
    EXPECT_EQ(nothing.complex.volumes, std::vector<double>(2, 0));
}

TEST(BuildParts, SurfacesHaveTheirNumbersInTheWhole) {
    Faulted own = one_fault();
    own.input.surfaces = 7;
    own.input.blocks = 9;
    own.acts.assign(9, 1);
    own.input.acts = own.acts;
    own.stack(0).surfaces = {{4, -1}, {5, 8}, {6, 2}};
    own.stack(1).surfaces = {{4, -1}, {kWall, 8}, {6, 2}};  // there it only fills
    const Joined all = built(own.input);
    for (const std::int32_t block : all.complex.cell_block)
        EXPECT_TRUE(block == 2 || block == 8);
    std::set<std::int32_t> surfaces(all.complex.face_surface.begin(),
                                    all.complex.face_surface.end());
    EXPECT_EQ(surfaces, (std::set<std::int32_t>{kWall, 4, 5, 6, 7}));  // 7: the fault
    EXPECT_EQ(all.complex.volumes.size(), 9U);
    EXPECT_GT(all.complex.volumes[8], 0);
}

TEST(BuildParts, LayersOfOneBlockAreOneCellOfAModelOfBlocks) {
    Faulted own = one_fault();
    own.input.cells = CellKind::kBlocks;
    for (const std::size_t part : {0, 1})
        own.stack(part).surfaces[1].block = 2;
    const Joined all = built(own.input);
    EXPECT_EQ(all.complex.cell_block.size(), 2U);
    EXPECT_EQ(std::ranges::count(all.complex.face_surface, 1), 0);
}

TEST(BuildParts, WhatIsNothingIsLeftOut) {
    for (const CellKind cells : {CellKind::kColumns, CellKind::kBlocks}) {
        Faulted own = one_fault();
        own.input.cells = cells;
        for (const std::size_t part : {0, 1})
            own.stack(part).surfaces[2].block = -1;
        const Joined all = built(own.input);
        EXPECT_EQ(all.complex.volumes[2], 0);
        EXPECT_NEAR(all.complex.volumes[1], 4 * (3 - 0.125) + 4 * (1 + 0.25), 1e-12);
    }
}

TEST(BuildParts, StacksThatAreEmptiedBecomeBlocks) {
    Faulted own = one_fault();
    own.input.cells = CellKind::kBlocks;
    own.stack(0).stack.emptied = {1};  // what was there is air: the upper two layers fill it
    const Joined all = built(own.input);
    EXPECT_EQ(all.complex.cell_kind, CellKind::kBlocks);
    EXPECT_EQ(std::ranges::count(all.cell_compartment, 0), 1);  // surface 1 lies upon nothing there
    EXPECT_EQ(std::ranges::count(all.cell_compartment, 1), 2);
}

TEST(BuildParts, ColumnsWhereNothingIsWantedMayBeLeftOut) {
    Faulted own = one_fault();
    const Joined all = built(own.input);
    const std::vector<std::uint8_t> cells{1, 1, 0, 0};  // part 0 is where x > 1: nothing is wanted
    own.input.compartments[0].wanted =
        strata::WantedSpace{{0, 0, -9}, {1, 4, 18}, {4, 1, 1}, cells};
    const Joined few = built(own.input);
    EXPECT_LT(std::ranges::count(few.cell_compartment, 0),
              std::ranges::count(all.cell_compartment, 0));
    EXPECT_EQ(std::ranges::count(few.cell_compartment, 1),
              std::ranges::count(all.cell_compartment, 1));
}

TEST(BuildParts, WarningsOfSeveralPartsComeOnce) {
    Faulted own = one_fault();
    for (const std::size_t part : {0, 1}) {
        OwnedSurface& sheet = own.sheets[3 * part + 1];
        sheet.triangle(0, 1, 1);  // without area
        own.stack(part).stack.surfaces[1] = sheet.view();
    }
    std::vector<std::int64_t> numbers(33);
    for (std::size_t t = 0; t < numbers.size(); ++t)
        numbers[t] = 100 + static_cast<std::int64_t>(t);
    for (const std::size_t part : {0, 1})
        own.stack(part).surfaces[1].triangles = numbers;
    const Joined all = built(own.input);
    ASSERT_EQ(all.complex.warnings.size(), 1U);
    EXPECT_EQ(all.complex.warnings[0].surface, 1);
    EXPECT_EQ(all.complex.warnings[0].items, std::vector<std::int64_t>{132});
    numbers[32] = 7;
    const std::vector<std::int64_t> others = numbers;
    numbers[32] = 8;
    own.stack(0).surfaces[1].triangles = others;
    EXPECT_EQ(built(own.input).complex.warnings.size(), 2U);
}

TEST(BuildParts, WhatIsRefusedIsNamedAsInTheWhole) {
    Faulted own = one_fault();
    own.input.surfaces = 7;
    OwnedSurface& sheet = own.sheets[4];  // surface 1 of part 1
    sheet.vertices.insert(sheet.vertices.end(),
                          {sheet.vertices[0], sheet.vertices[1], sheet.vertices[2] + 1});
    sheet.triangle(0, 1, 25);
    own.stack(1).stack.surfaces[1] = sheet.view();
    const std::vector<std::int64_t> numbers(33, 50);
    own.stack(1).surfaces[1] = {5, 1, numbers};
    const InputError vertical = refused(own.input);
    EXPECT_EQ(vertical.kind, "vertical_triangle");
    EXPECT_EQ(vertical.surface, 5);
    EXPECT_EQ(vertical.items, std::vector<std::int64_t>{50});

    own = one_fault();
    own.shapes[0].triangles[5] = 99;
    own.input.structures[0].surface = own.shapes[0].view();
    const InputError structure = refused(own.input);
    EXPECT_EQ(structure.kind, "bad_index");
    EXPECT_EQ(structure.surface, 3);  // counted after the surfaces
}

TEST(BuildParts, OverlappingRockMassesHaveTheirNumbers) {
    Faulted own = one_fault();
    const CompartmentStack rock = own.stack(1);
    own.input.compartments[0].rocks = {{}, {}, {}};
    own.input.compartments[1].rocks = {rock, {}, rock};
    const InputError error = refused(own.input);
    EXPECT_EQ(error.kind, "rocks_overlap");
    EXPECT_EQ(error.items, (std::vector<std::int64_t>{0, 2}));
}

TEST(BuildParts, PartsThatDoNotFitTheRestAreRefused) {
    const std::vector<std::uint8_t> few(2, 1);
    const std::vector<std::int64_t> numbers(3);
    const std::vector<std::pair<std::int64_t, std::function<void(Faulted&)>>> cases{
        {-1, [&](Faulted& own) { own.input.acts = few; }},
        {-1, [](Faulted& own) { own.input.piece.emplace().continued.resize(2); }},
        {1, [](Faulted& own) { own.input.compartments[1].sides = {}; }},
        {1, [](Faulted& own) { own.input.compartments[1].rocks.emplace_back(); }},
        {0, [](Faulted& own) { own.stack(0).surfaces.pop_back(); }},
        {0, [](Faulted& own) { own.stack(0).surfaces[1].number = 3; }},
        {0, [](Faulted& own) { own.stack(0).surfaces[1].number = -4; }},
        {1, [](Faulted& own) { own.stack(1).surfaces[1].block = 3; }},
        {1, [](Faulted& own) { own.stack(1).surfaces[1].block = -2; }},
        {1, [&](Faulted& own) { own.stack(1).surfaces[1].triangles = numbers; }},
        {1, [](Faulted& own) { own.stack(1).stack.rules = {strata::Rule::kErosional}; }},
        {1, [](Faulted& own) { own.stack(1).stack.emptied = {3}; }},
        {1,
         [](Faulted& own) {
             own.stack(1).stack.emptied = {2, 1};
         }},
        {1, [](Faulted& own) { own.stack(1).stack.fills = {1}; }},
    };
    for (const auto& [part, change] : cases) {
        Faulted own = one_fault();
        change(own);
        const InputError error = refused(own.input);
        EXPECT_EQ(error.kind, "bad_part") << error.what();
        EXPECT_EQ(error.items, part < 0 ? std::vector<std::int64_t>{} : std::vector{part})
            << error.what();
    }
}

TEST(BuildParts, CanBeWatchedAndCancelled) {
    const Faulted own = one_fault();
    Progress progress;
    build_compartments(own.input, {2, &progress});
    EXPECT_DOUBLE_EQ(progress.fraction(), 1);
    EXPECT_EQ(progress.text(), "joining the compartments");
    progress.cancel();
    EXPECT_THROW(build_compartments(own.input, {2, &progress}), Cancelled);
}

}  // namespace
}  // namespace realmodel::structures
