// SPDX-License-Identifier: GPL-3.0-or-later
// What structures divide is the same where triangles that meet nothing are left undivided.
#include <cmath>
#include <numbers>

#include "cutting/cell_parts.hpp"
#include "faulted_cubes.hpp"
#include "structures/wanted_parts.hpp"

namespace realmodel::structures {
namespace {

struct Made {
    std::size_t undivided = 0;
    std::vector<std::vector<Position>> polygons;
    std::vector<std::array<std::int32_t, 2>> parts;
    std::size_t cells = 0;
    bool operator==(const Made& other) const {
        return polygons == other.polygons && parts == other.parts && cells == other.cells;
    }
};

/// @param act  whether the structures divide the cubes
Made made(const FaultedCubes& of, bool leaves_undivided, std::uint8_t act) {
    const std::vector<std::int32_t> groups =
        leaves_undivided ? of.cutter.structure : std::vector<std::int32_t>{};
    CutterOverlay overlay(of.model, of.cutter.combined, {1, nullptr}, 0, groups);
    const CutterWinding winding(overlay, nullptr);
    const StructureSides sides(overlay, winding, of.cutter, of.structures, of.nearest, nullptr);
    const std::vector<std::int32_t> model_of_cell(of.model.cell_count(), 0);
    const std::vector<Sides> model_sides{Sides(of.structures.size(), 0)};
    const std::vector<std::uint8_t> acts(of.structures.size() * of.model.blocks, act);
    const WantedParts wanted(overlay, winding, sides, model_of_cell, model_sides, acts);
    const cutting::CellParts parts(overlay, winding, wanted, nullptr);
    Made found;
    for (std::size_t component = 0; component < overlay.undivided().components(); ++component)
        found.undivided += overlay.undivided().triangles(component).size();
    for (std::size_t p = 0; p < parts.pieces.size(); ++p) {
        auto& polygon = found.polygons.emplace_back();
        for (const NodeId node : parts.pieces.polygons[p])
            polygon.push_back(overlay.position(node));
        found.parts.push_back(parts.pieces[p].parts);
    }
    found.cells = parts.half_cells.size();
    return found;
}

/// @param undivided  triangles at least
void expect_alike(std::vector<strata::OwnedSurface> surfaces, std::size_t faults,
                  std::size_t undivided) {
    const FaultedCubes cubes(std::move(surfaces), faults);
    for (const std::uint8_t act : std::array<std::uint8_t, 2>{0, 1}) {
        const Made own = made(cubes, true, act);
        EXPECT_EQ(own, made(cubes, false, act)) << int{act};
        EXPECT_GT(own.undivided, undivided);
    }
}

/// A wavy sheet far beyond the cubes.
strata::OwnedSurface sheet(double height) {
    return strata::grid(24, 24, -1, -1, 2, 2, [height](double x, double y) {
        return height + 0.05 * std::sin(7 * x + 3 * y);
    });
}

/// A ball of many triangles.
strata::OwnedSurface ball(const Position& middle, double radius) {
    constexpr int kRings = 12, kCorners = 16;
    strata::OwnedSurface s;
    const auto vertex = [&](double up, double around) {
        s.vertex(middle[0] + radius * std::cos(up) * std::cos(around),
                 middle[1] + radius * std::cos(up) * std::sin(around),
                 middle[2] + radius * std::sin(up));
    };
    for (int ring = 1; ring < kRings; ++ring) {
        for (int i = 0; i < kCorners; ++i)
            vertex(std::numbers::pi * (static_cast<double>(ring) / kRings - 0.5),
                   2 * std::numbers::pi * i / kCorners);
    }
    vertex(-std::numbers::pi / 2, 0);
    vertex(std::numbers::pi / 2, 0);
    const int bottom = (kRings - 1) * kCorners, top = bottom + 1;
    for (int i = 0; i < kCorners; ++i) {
        const int next = (i + 1) % kCorners, last = bottom - kCorners;
        s.triangle(bottom, next, i);
        s.triangle(top, last + i, last + next);
        for (int ring = 0; ring + 2 < kRings; ++ring) {
            const int a = ring * kCorners;
            s.triangle(a + i, a + next, a + kCorners + next);
            s.triangle(a + i, a + kCorners + next, a + kCorners + i);
        }
    }
    return s;
}

TEST(Undivided, ASheetIsUndividedWithinTheCellsAndBeyondThem) {
    expect_alike({sheet(0.5)}, 1, 800);
}

TEST(Undivided, TwoSheetsMeetWhereTheyCross) {
    strata::OwnedSurface slanting =
        strata::grid(24, 24, -1, -1, 2, 2, [](double x, double) { return 0.1 + 0.8 * x; });
    expect_alike({sheet(0.5), slanting}, 2, 1300);
}

TEST(Undivided, ABallWithinACellIsUndividedButForOneTriangle) {
    expect_alike({ball({0.5, 0.5, 0.5}, 0.3)}, 0, 300);
}

TEST(Undivided, ABallAcrossAFaceAndOneWithinIt) {
    expect_alike({ball({0.5, 0.5, 1.1}, 0.3), ball({0.5, 0.5, 1.5}, 0.05)}, 0, 500);
}

}  // namespace
}  // namespace realmodel::structures
