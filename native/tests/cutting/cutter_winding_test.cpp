// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "../validation/small_complex.hpp"
#include "cutting/cutter_sides.hpp"
#include "level_cutter.hpp"

namespace realmodel::cutting {
namespace {

/// Two unit cubes, one on the other (cells 0 and 1), and a surface.
struct Wound {
    explicit Wound(Cutter of) : surface(std::move(of)) {}
    /// What is below and above each region of the surface that counts and touches the model.
    std::vector<std::array<Winding, 2>> around() const {
        std::vector<std::array<Winding, 2>> found;
        for (std::size_t r = 0; r < overlay.size(); ++r) {
            if (winding.counts(r) && winding.touches_model(r))
                found.push_back({winding.around(r, 0), winding.around(r, 1)});
        }
        return found;
    }

    validation::OwnedComplex cubes = validation::two_cubes();
    ComplexView model = cubes.view();
    Cutter surface;
    CutterOverlay overlay{model, surface, {1, nullptr}};
    CutterWinding winding{overlay, nullptr};
};

using Around = std::vector<std::array<Winding, 2>>;
const Winding kLower{{0, 1}}, kUpper{{1, 1}}, kOutside;

TEST(CutterWinding, ThroughACellItIsOnBothSides) {
    EXPECT_EQ(Wound(level_cutter(0.5)).around(), (Around{{kLower, kLower}}));
    EXPECT_EQ(Wound(level_cutter(1.5)).around(), (Around{{kUpper, kUpper}}));
}

TEST(CutterWinding, CellsOfSeveralModelsShareTheRegionsOfTheirFaces) {
    validation::OwnedComplex twice = validation::two_cubes();
    const std::size_t faces = twice.loops.size();
    for (std::size_t f = 0; f < faces; ++f) {
        const std::array own = twice.cells[f];
        twice.add_face(twice.loops[f], own[0] + 2, own[1] < 0 ? -1 : own[1] + 2, twice.surface[f]);
    }
    twice.block.insert(twice.block.end(), {0, 0});
    const ComplexView model = twice.view();
    const Cutter surface = level_cutter(0.5);
    CutterOverlay overlay(model, surface, {1, nullptr}, 0, std::vector<std::int32_t>{0});
    EXPECT_EQ(overlay.size(), Wound(surface).overlay.size());
    EXPECT_EQ(overlay.active_faces(), (std::vector<std::int32_t>{3, 4, 5, 6}));
    EXPECT_TRUE(overlay.is_active(faces + 3));
    const CutterWinding winding(overlay, nullptr);
    const Winding both{{0, 1}, {2, 1}};
    for (std::size_t r = 0; r < overlay.size(); ++r) {
        if (!overlay.of_cutter(r)) {
            const auto all = overlay.faces_of(r);
            EXPECT_EQ(std::vector(all.begin(), all.end()),
                      (std::vector{all[0], all[0] + static_cast<std::int32_t>(faces)}));
        } else if (winding.touches_model(r)) {
            EXPECT_EQ(winding.around(r, 0), both);
            EXPECT_EQ(winding.around(r, 1), both);
        }
    }
}

TEST(CutterWinding, BetweenTwoCellsEachIsOnItsSide) {
    // two regions, as the face there is two triangles
    EXPECT_EQ(Wound(level_cutter(1)).around(), (Around{{kLower, kUpper}, {kLower, kUpper}}));
    EXPECT_EQ(Wound(level_cutter(1, false)).around(), (Around{{kUpper, kLower}, {kUpper, kLower}}));
}

TEST(CutterWinding, AlongTheTopNothingIsAbove) {
    EXPECT_EQ(Wound(level_cutter(2)).around(), (Around{{kUpper, kOutside}, {kUpper, kOutside}}));
    EXPECT_EQ(Wound(level_cutter(0)).around(), (Around{{kOutside, kLower}, {kOutside, kLower}}));
}

TEST(CutterWinding, WhatCrossesNoFaceIsFoundByARay) {
    Wound within(closed_cutter());
    EXPECT_EQ(within.around(), Around(4, {kLower, kLower}));
    for (Position& p : within.surface.vertices)
        p[2] += 5;
    EXPECT_TRUE(Wound(within.surface).around().empty());
}

TEST(CutterWinding, WhatStandsOnAFaceAndCrossesNoneHasTheOtherCellBelow) {
    Cutter upper = closed_cutter();
    for (Position& p : upper.vertices)
        p[2] += 0.75;  // on the face between the cells
    int on_face = 0;
    for (const auto& around : Wound(upper).around()) {  // side 0 is within
        EXPECT_EQ(around[0], kUpper);
        on_face += around[1] == kLower;
        EXPECT_TRUE(around[1] == kLower || around[1] == kUpper);
    }
    EXPECT_GT(on_face, 0);
}

TEST(CutterWinding, AFaceKnowsTheRegionItLiesOnAndHowItFaces) {
    for (const bool upward : {true, false}) {
        const Wound wound(level_cutter(1, upward));
        int found = 0;
        for (std::size_t r = 0; r < wound.overlay.size(); ++r) {
            if (wound.overlay.of_cutter(r)) continue;
            const bool lies_on = wound.winding.coincident(r) >= 0;
            EXPECT_EQ(lies_on, wound.overlay.face_of(r) == 1);
            if (!lies_on) continue;
            ++found;
            EXPECT_EQ(wound.winding.coincident_facing(r), upward ? 1 : -1);
        }
        EXPECT_EQ(found, 2);
    }
}

TEST(CutterWinding, WhereAnOpenSurfaceIsTwiceOneCountsAndOfAClosedOneNone) {
    Cutter twice = level_cutter(0.5);
    twice.triangles.push_back({0, 2, 1});
    EXPECT_EQ(Wound(twice).around().size(), 1U);
    twice.is_closed = true;
    EXPECT_TRUE(Wound(twice).around().empty());
}

TEST(CutterWinding, AnInsideOutCellGoesRoundMinusOnce) {
    Wound wound(level_cutter(0.5));
    for (const std::size_t f : {0U, 3U, 4U, 5U, 6U})
        std::ranges::reverse(wound.cubes.loops[f]);
    wound.cubes.cells[1] = {1, -1};
    wound.cubes.loops[1] = {7, 6, 5, 4};
    wound.cubes.add_face({7, 6, 5, 4}, 0, -1, 0);
    const ComplexView inside_out = wound.cubes.view();
    CutterOverlay overlay(inside_out, wound.surface, {1, nullptr});
    const CutterWinding winding(overlay, nullptr);
    for (std::size_t r = 0; r < overlay.size(); ++r) {
        if (!winding.counts(r) || !winding.touches_model(r)) continue;
        EXPECT_EQ(winding.around(r, 0), (Winding{{0, -1}}));
    }
}

TEST(CutterWinding, ItsEdgesAreThoseOfTheRegions) {
    const Wound wound(level_cutter(0.5));
    EXPECT_EQ(wound.winding.edge_count(), 4U + 3);
    EXPECT_TRUE(wound.winding.is_edge(wound.winding.edge(3)[0].edge));
    EXPECT_FALSE(wound.winding.is_edge({NodeId{0}, NodeId{1}}));
    for (std::size_t e = 0; e < wound.winding.edge_count(); ++e) {
        const auto uses = wound.winding.edge(e);
        // at a wall: the surface on both sides, the wall above and below it
        EXPECT_TRUE(uses.size() == 4 || uses.size() == 1);
        EXPECT_EQ(std::ranges::count(wound.winding.sectors(e).windings, 0),
                  uses.size() == 4 ? 2 : 1);
    }
}

}  // namespace
}  // namespace realmodel::cutting
