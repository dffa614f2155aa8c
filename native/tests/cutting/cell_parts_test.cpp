// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/cell_parts.hpp"

#include <gtest/gtest.h>

#include <map>

#include "../arrangement/small_polygons.hpp"
#include "../validation/small_complex.hpp"
#include "level_cutter.hpp"
#include "prism.hpp"

namespace realmodel::cutting {
namespace {

/// The parts of a model that a surface cuts.
struct PartedCells {
    PartedCells(validation::OwnedComplex of, Cutter by)
        : complex(std::move(of)), surface(std::move(by)) {}
    std::ptrdiff_t count(std::int32_t cell, std::int8_t side) const {
        return std::ranges::count_if(parts.half_cells, [&](const HalfCell& part) {
            return part.cell == cell && part.side == side;
        });
    }
    std::vector<std::size_t> cut_faces() const {
        std::vector<std::size_t> found;
        for (std::size_t p = 0; p < parts.pieces.size(); ++p) {
            if (parts.pieces[p].is_on_cutter) found.push_back(p);
        }
        return found;
    }
    double height_of_normal(std::size_t piece) const {
        std::vector<Position> corners;
        for (const NodeId node : parts.pieces.polygons[piece])
            corners.push_back(overlay.position(node));
        return polygon_normal(corners)[2];
    }

    validation::OwnedComplex complex;
    ComplexView model = complex.view();
    Cutter surface;
    CutterOverlay overlay{model, surface, {1, nullptr}};
    CutterWinding winding{overlay, nullptr};
    CutterSides sides{overlay, winding, nullptr};
    CellParts parts{overlay, winding, sides, nullptr};
};

TEST(CellParts, ACubeCutInHalfHasTwoPartsAndTheOneAboveItStaysWhole) {
    const PartedCells cut(validation::two_cubes(), level_cutter(0.5));
    EXPECT_EQ(cut.parts.half_cells.size(), 3U);
    EXPECT_EQ(cut.count(0, kBelow), 1);
    EXPECT_EQ(cut.count(0, kAbove), 1);
    EXPECT_EQ(cut.count(1, kAbove), 1);
    // four walls in two, the other seven faces, one cut face
    EXPECT_EQ(cut.parts.pieces.size(), 8U + 7 + 1);
    EXPECT_EQ(cut.parts.touches, (std::array{false, false}));
}

TEST(CellParts, ACapHasThePartBelowFirstAndIsSeenFromAbove) {
    const PartedCells cut(validation::two_cubes(), level_cutter(0.5));
    const auto cut_faces = cut.cut_faces();
    ASSERT_EQ(cut_faces.size(), 1U);
    const CutPiece& cut_face = cut.parts.pieces[cut_faces[0]];
    EXPECT_EQ(cut_face.face, -1);
    EXPECT_EQ(cut_face.cells, (std::array<std::int32_t, 2>{0, 0}));
    EXPECT_EQ(cut_face.sides, (std::array<std::int8_t, 2>{kBelow, kAbove}));
    EXPECT_EQ(cut.height_of_normal(cut_faces[0]), 2);
}

TEST(CellParts, EachPartIsClosed) {
    for (const double height : {0.5, 1.0, 1.5}) {
        const PartedCells cut(validation::two_cubes(), level_cutter(height));
        std::map<std::pair<std::int32_t, std::array<NodeId, 2>>, int> uses;
        for (std::size_t p = 0; p < cut.parts.pieces.size(); ++p) {
            const auto nodes = cut.parts.pieces.polygons[p];
            for (std::size_t k = 0; k < 2; ++k) {
                const std::int32_t part = cut.parts.pieces[p].parts[k];
                for (std::size_t i = 0; part >= 0 && i < nodes.size(); ++i) {
                    const NodeId a = nodes[i], b = nodes[(i + 1) % nodes.size()];
                    uses[{part, unordered(a, b)}] += (a < b) == (k == 0) ? 1 : -1;
                }
            }
        }
        for (const auto& [edge, sum] : uses)
            EXPECT_EQ(sum, 0) << height;
    }
}

TEST(CellParts, AlongAFaceNoCellIsPartedAndTheFaceIsTheCap) {
    const PartedCells cut(validation::two_cubes(), level_cutter(1));
    EXPECT_EQ(cut.parts.half_cells.size(), 2U);
    for (const std::size_t cut_face : cut.cut_faces())
        EXPECT_EQ(cut.parts.pieces[cut_face].cells, (std::array<std::int32_t, 2>{0, 1}));
    EXPECT_EQ(cut.cut_faces().size(), 2U);  // the face's triangles
}

TEST(CellParts, TheTowersOfAUBecomeTwoParts) {
    const PartedCells cut(u_shape(), level_cutter(1.5));
    EXPECT_EQ(cut.count(0, kBelow), 1);
    EXPECT_EQ(cut.count(0, kAbove), 2);
    EXPECT_EQ(cut.cut_faces().size(), 2U);
}

TEST(CellParts, AHollowThatIsCutOutBelongsToThePartAroundIt) {
    const PartedCells cut(validation::two_cubes(), closed_cutter());
    EXPECT_EQ(cut.parts.half_cells.size(), 3U);
    EXPECT_EQ(cut.count(0, kBelow), 1);
    EXPECT_EQ(cut.count(0, kAbove), 1);
    EXPECT_EQ(cut.cut_faces().size(), 4U);
}

TEST(CellParts, LoopsOfAWallStayOnePolygonOthersBecomeConvex) {
    auto u = u_shape();
    const ComplexView model = u.view();
    const Cutter surface = level_cutter(9);
    CutterOverlay overlay(model, surface, {1, nullptr});
    const std::vector<NodeLoop> front{node_loop({0, 1, 2, 3, 4, 5, 6, 7})};
    arrangement::LoopTable<NodeId> loops;
    loops.add_loop(front[0]);
    loops.end_region();
    Polygons wall, other;
    EXPECT_TRUE(divide_loops(overlay, {0, -1, 0}, loops[0], true, wall));
    EXPECT_EQ(loops_of(wall), front);
    EXPECT_TRUE(divide_loops(overlay, {0, -1, 0}, loops[0], false, other));
    EXPECT_EQ(other.size(), 3U);  // the foot and the towers
}

}  // namespace
}  // namespace realmodel::cutting
