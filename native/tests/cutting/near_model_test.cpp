// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/near_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "../strata/complex_checks.hpp"

namespace realmodel::cutting {
namespace {

using strata::CellComplex;
using strata::grid;
using strata::OwnedSurface;

/// One layer of 4 x 1 squares, two columns each, from x = 0 to 4.
CellComplex row() {
    std::vector<OwnedSurface> surfaces;
    for (const double z : {0.0, 1.0})
        surfaces.push_back(grid(4, 1, 0, 0, 4, 1, [z](double, double) { return z; }));
    return strata::build(surfaces);
}

/// Upright, at one x; its upper side is where x is less.
Cutter upright(double x) {
    return {{{x, -1, -1}, {x, 5, -1}, {x, 5, 5}, {x, -1, 5}}, {{0, 2, 1}, {0, 3, 2}}};
}

double middle_of(const CellComplex& model, std::int32_t cell) {
    const ComplexView view = model;
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (std::size_t f = 0; f < view.face_count(); ++f) {
        if (view.cell(f, 0) != cell && view.cell(f, 1) != cell) continue;
        for (const NodeId v : view.face(f)) {
            low = std::min(low, view.vertex(v)[0]);
            high = std::max(high, view.vertex(v)[0]);
        }
    }
    return (low + high) / 2;
}

std::vector<std::uint8_t> near_cells(const CellComplex& model, double x, int threads) {
    const Cutter surface = upright(x);
    const NearestSide nearest(surface);
    return cells_near(CellBoxes(model, {&nearest, 1}, {threads, nullptr}), nearest,
                      {threads, nullptr});
}

TEST(NearModel, CellsThatTheSurfaceCrossesOrTouchesAreNear) {
    const CellComplex model = row();
    const auto inside = near_cells(model, 1.5, 1);
    const auto between = near_cells(model, 2, 2);
    for (std::int32_t c = 0; c < 8; ++c) {
        const double x = middle_of(model, c);
        EXPECT_EQ(inside[index(c)] != 0, x == 1.5);
        EXPECT_EQ(between[index(c)] != 0, x == 1.5 || x == 2.5);
    }
}

TEST(NearModel, OnlyCellsThatMayBeNearHaveABox) {
    const CellComplex model = row();
    const Cutter surface = upright(1.5), other = upright(3.5);
    const std::array nearest{NearestSide(surface), NearestSide(other)};
    const CellBoxes of_one(model, {nearest.data(), 1}, {2, nullptr});
    const CellBoxes of_both(model, nearest, {1, nullptr});
    for (std::int32_t c = 0; c < 8; ++c) {
        const double x = middle_of(model, c);
        const spatial::Box& box = of_both.boxes[index(c)];
        EXPECT_EQ(box.low[0], x < 1 ? HUGE_VAL : x - 0.5);
        EXPECT_EQ(box.high[0], x < 1 ? -HUGE_VAL : x + 0.5);
        EXPECT_EQ(of_one.boxes[index(c)].low[0], x == 1.5 ? 1 : HUGE_VAL);
    }
}

TEST(NearModel, TheOthersAreOnOneSideEach) {
    const CellComplex model = row();
    const Cutter surface = upright(1.5);
    const NearestSide nearest(surface);
    const CellBoxes cells(model, {&nearest, 1}, {1, nullptr});
    const auto sides =
        sides_of_far_cells(model, nearest, cells_near(cells, nearest, {1, nullptr}), {2, nullptr});
    for (std::int32_t c = 0; c < 8; ++c) {
        const double x = middle_of(model, c);
        EXPECT_EQ(sides[index(c)], x < 1 ? kAbove : x < 2 ? kOn : kBelow);
    }
}

/// Puts all faces of a part back as they are.
void expect_put_back(const ComplexView& all, const NearModel& part) {
    const ComplexView near = part.view();
    CutPieces pieces;
    std::vector<HalfCell> cells;
    for (std::int32_t c = 0; index(c) < near.cell_count(); ++c)
        cells.push_back({c, kAbove});
    for (std::size_t f = 0; f < near.face_count(); ++f) {
        const std::array own{near.cell(f, 0), near.cell(f, 1)};
        pieces.add(
            near.face(f),
            {static_cast<std::int32_t>(f), own, {kAbove, own[1] < 0 ? kOn : kAbove}, false, own});
    }
    const std::vector<std::int8_t> sides(all.cell_count(), kAbove);
    const auto whole = part.put_back(std::move(pieces), cells, sides);
    ASSERT_TRUE(whole);
    ASSERT_EQ(cells.size(), all.cell_count());
    for (std::int32_t c = 0; index(c) < cells.size(); ++c)
        EXPECT_EQ(cells[index(c)].cell, c);
    EXPECT_EQ(whole->near().size(), near.face_count());
    std::size_t f = 0;
    const auto visit = [&](std::span<const NodeId> polygon, const CutPiece& piece) {
        ASSERT_LT(f, all.face_count());
        EXPECT_EQ(piece.face, static_cast<std::int32_t>(f));
        std::vector<NodeId> own(polygon.begin(), polygon.end());
        std::array parts = piece.parts;
        if (parts[0] != all.cell(f, 0)) {  // it was turned over
            std::swap(parts[0], parts[1]);
            std::ranges::reverse(own);
        }
        EXPECT_EQ(parts, (std::array{all.cell(f, 0), all.cell(f, 1)}));
        EXPECT_TRUE(std::ranges::equal(own, all.face(f)));
        ++f;
    };
    for (std::size_t chunk = 0; chunk < whole->chunks(); ++chunk)
        whole->for_each_of(chunk, visit);
    EXPECT_EQ(f, all.face_count());
}

TEST(NearModel, WhatIsPutBackUntouchedIsTheModel) {
    const CellComplex model = row();
    const NearModel part(model, near_cells(model, 1.5, 1), {2, nullptr});
    EXPECT_EQ(part.view().cell_count(), 2U);
    expect_put_back(model, part);
}

/// Two layers of 9 x 4 squares from x = 0 to 9 as blocks.
CellComplex blocks() {
    strata::StackInput input;
    std::vector<OwnedSurface> surfaces;
    for (const double z : {0.0, 1.0, 2.0})
        surfaces.push_back(
            grid(9, 4, 0, 0, 9, 4, [z](double x, double y) { return z + 0.001 * x * x * y; }));
    for (const OwnedSurface& s : surfaces)
        input.surfaces.push_back(s.view());
    return strata::build_stack(input, {1, nullptr}, CellKind::kBlocks);
}

TEST(NearModel, FacesOfBlocksAwayFromTheSurfaceAreLeftOut) {
    const CellComplex model = blocks();
    const ComplexView all = model;
    ASSERT_EQ(all.cell_count(), 2U);
    const Cutter surface = upright(4.5);  // through the lower block
    const NearestSide nearest(surface);
    const CellBoxes cells(model, {&nearest, 1}, {1, nullptr});
    for (const std::uint8_t upper : {0, 1}) {  // whether it is of the part, too
        std::vector<std::uint8_t> is_near(2, upper);
        for (std::size_t f = 0; f < all.face_count(); ++f) {
            if (all.vertex(all.face(f)[0])[2] == 0) is_near[index(all.cell(f, 0))] = 1;
        }
        const NearModel part(model, is_near, {2, nullptr}, &nearest, margin_of(cells, nearest));
        const FarFaces& far = part.far();
        EXPECT_EQ(part.view().cell_count(), 1U + upper);
        EXPECT_GE(far.groups(), 4U);  // outer faces and those between, on either side
        EXPECT_GT(far.faces().size(), 10U);
        std::size_t left_out = 0;
        for (std::int32_t group = 0; index(group) < far.groups(); ++group) {
            left_out += far.of_group(group).size();
            EXPECT_TRUE(far.is_first(index(far.first(group))));
            for (const std::int32_t face : far.of_group(group)) {
                for (const NodeId v : all.face(index(face)))
                    EXPECT_GE(std::abs(all.vertex(v)[0] - 4.5), 1.5);
            }
        }
        EXPECT_EQ(left_out, far.faces().size());
        expect_put_back(model, part);
    }
}

TEST(NearModel, AFaceBesideAnotherCellThatWasChangedIsTold) {
    const CellComplex model = row();
    const auto is_near = near_cells(model, 1.5, 1);
    const NearModel part(model, is_near, {2, nullptr});
    CutPieces pieces;  // none of the part's faces is left
    std::vector<HalfCell> cells;
    const std::vector<std::int8_t> sides(model.cell_block.size(), kAbove);
    EXPECT_FALSE(part.put_back(std::move(pieces), cells, sides));
}

}  // namespace
}  // namespace realmodel::cutting
