// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "../validation/small_complex.hpp"
#include "cutting/cutter_sides.hpp"
#include "level_cutter.hpp"

namespace realmodel::cutting {
namespace {

/// Two unit cubes, one on the other (face 0 is the base, face 1 between them, face 2 the top), and
/// a surface.
struct Parted {
    explicit Parted(Cutter of) : surface(std::move(of)) {}
    CutterCompartments parts(bool in_model_alone = true, bool leave_out = false) {
        return {overlay,
                winding,
                cells_near_cutter(overlay, winding),
                {[in_model_alone](std::span<const EdgeUse>) { return in_model_alone; },
                 [leave_out](std::size_t) { return leave_out; }},
                nullptr};
    }
    std::int32_t of_face(const CutterCompartments& parts, std::size_t face) const {
        return parts.of(overlay.size() + face);
    }

    validation::OwnedComplex cubes = validation::two_cubes();
    ComplexView model = cubes.view();
    Cutter surface;
    CutterOverlay overlay{model, surface, {1}};
    CutterWinding winding{overlay, nullptr};
};

TEST(CutterCompartments, ALevelSurfaceLeavesTwoParts) {
    Parted cut(level_cutter(0.5));
    const CutterCompartments parts = cut.parts();
    ASSERT_EQ(parts.size(), 2U);
    EXPECT_NE(cut.of_face(parts, 0), cut.of_face(parts, 1));
    EXPECT_EQ(cut.of_face(parts, 1), cut.of_face(parts, 2));
    for (std::size_t r = 0; r < cut.overlay.size(); ++r) {
        if (!cut.overlay.of_cutter(r) || parts.of(r) < 0) continue;
        EXPECT_EQ(parts.at(r, 0), cut.of_face(parts, 0));
        EXPECT_EQ(parts.at(r, 1), cut.of_face(parts, 1));
    }
}

TEST(CutterCompartments, AroundABorderBesideTheModelItLeavesOne) {
    Parted cut(level_cutter(0.5));
    EXPECT_EQ(cut.parts(false).size(), 1U);
}

TEST(CutterCompartments, APartKnowsOneOfItsSides) {
    Parted cut(level_cutter(0.5));
    const CutterCompartments parts = cut.parts();
    for (std::size_t part = 0; part < parts.size(); ++part) {
        const auto [item, side] = parts.first_side(part);
        const std::int32_t of = side == 0 ? parts.of(item) : parts.at(item, 1);
        EXPECT_EQ(of, static_cast<std::int32_t>(part));
    }
}

TEST(CutterCompartments, RegionsThatAreLeftOutAreJoinedWithNothing) {
    Parted cut(level_cutter(0.5));
    const CutterCompartments parts = cut.parts(true, true);
    EXPECT_GT(parts.size(), 2U);
    for (std::size_t r = 0; r < cut.overlay.size(); ++r) {
        if (!cut.overlay.of_cutter(r) || parts.of(r) < 0) continue;
        EXPECT_NE(parts.at(r, 0), cut.of_face(parts, 0));
    }
}

TEST(CellsNearSurface, AreThoseWithAFaceNearItOrAroundIt) {
    Parted lower(level_cutter(0.5)), within(closed_cutter());
    EXPECT_EQ(cells_near_cutter(lower.overlay, lower.winding), (std::vector<std::uint8_t>{1, 0}));
    EXPECT_EQ(cells_near_cutter(within.overlay, within.winding), (std::vector<std::uint8_t>{1, 0}));
}

}  // namespace
}  // namespace realmodel::cutting
