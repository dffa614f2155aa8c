// SPDX-License-Identifier: GPL-3.0-or-later
// Models spoilt on purpose, each in one way: none passes.
#include "complex_defects.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "../strata/merged_columns.hpp"
#include "judge.hpp"

namespace realmodel::fuzz {
namespace {

using strata::CellComplex;

/// A level lattice, a plane that crosses it, a square of partial extent above: walls and wedges.
StackCase crossing_stack() {
    Mesh level, tilted;
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 4; ++x) {
            level.vertices.push_back({static_cast<double>(x), static_cast<double>(y), 0});
            tilted.vertices.push_back({static_cast<double>(x), static_cast<double>(y), x - 1.25});
        }
    }
    for (const std::int32_t a : {0, 1, 2, 4, 5, 6, 8, 9, 10}) {
        level.triangles.push_back({a, a + 1, a + 5});
        level.triangles.push_back({a, a + 5, a + 4});
    }
    tilted.triangles = level.triangles;
    const Mesh part{{{0.5, 0.5, 3}, {2.5, 0.5, 3}, {2.5, 2.5, 3}, {0.5, 2.5, 3}},
                    {{0, 1, 2}, {0, 2, 3}}};
    return {{{{level, tilted, part}, {}, {}, {}}}, ""};
}

CellComplex built() {
    const StackCase stack = crossing_stack();
    return strata::build_rock_masses(views_of(stack), {1, nullptr});
}

std::vector<std::string> kinds_of(const CellComplex& complex) {
    std::vector<std::string> kinds;
    for (const Defect& defect : complex_defects(complex, Cells::kColumns))
        kinds.push_back(defect.kind);
    for (const Defect& defect : surface_defects(complex, crossing_stack()))
        kinds.push_back(defect.kind);
    return kinds;
}

bool has(const std::vector<std::string>& kinds, const char* kind) {
    return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

TEST(ComplexDefects, TheModelItselfHasNone) {
    EXPECT_EQ(kinds_of(built()), std::vector<std::string>{});
    EXPECT_TRUE(defects_of(crossing_stack()).empty());
}

TEST(ComplexDefects, AVertexMovedUp) {
    CellComplex c = built();
    (*std::max_element(c.vertices.begin(), c.vertices.end(),
                       [](auto& a, auto& b) { return a[2] < b[2]; }))[2] += 1e-3;
    EXPECT_TRUE(has(kinds_of(c), "off its surface"));
    EXPECT_TRUE(has(kinds_of(c), "stated volume"));
}

TEST(ComplexDefects, AVertexMovedAside) {
    CellComplex c = built();
    (*std::max_element(c.vertices.begin(), c.vertices.end()))[0] += 1e-3;
    EXPECT_TRUE(has(kinds_of(c), "leaning wall"));
}

TEST(ComplexDefects, AFaceTurnedRound) {
    CellComplex c = built();
    std::reverse(c.face_vertices.begin(), c.face_vertices.begin() + c.face_offsets[1]);
    EXPECT_TRUE(has(kinds_of(c), "not closed"));
}

TEST(ComplexDefects, AllFacesTurnedRound) {
    CellComplex c = built();
    for (std::size_t f = 0; f + 1 < c.face_offsets.size(); ++f)
        std::reverse(c.face_vertices.begin() + c.face_offsets[f],
                     c.face_vertices.begin() + c.face_offsets[f + 1]);
    EXPECT_TRUE(has(kinds_of(c), "negative volume"));
}

TEST(ComplexDefects, AnInnerFaceWithOneCell) {
    CellComplex c = built();
    (*std::find_if(c.face_cells.begin(), c.face_cells.end(),
                   [](auto& cells) { return cells[1] >= 0; }))[1] = -1;
    EXPECT_TRUE(has(kinds_of(c), "not closed"));
}

TEST(ComplexDefects, TheWrongSurface) {
    CellComplex c = built();
    std::replace(c.face_surface.begin(), c.face_surface.end(), 1, 0);
    EXPECT_TRUE(has(kinds_of(c), "off its surface"));
}

TEST(ComplexDefects, TheWrongVolume) {
    CellComplex c = built();
    c.volumes[1] *= 1 + 1e-6;
    EXPECT_TRUE(has(kinds_of(c), "stated volume"));
}

TEST(ComplexDefects, EqualUnusedAndRepeatedVertices) {
    CellComplex c = built();
    c.vertices.push_back(c.vertices[0]);
    EXPECT_TRUE(has(kinds_of(c), "equal vertices"));
    EXPECT_TRUE(has(kinds_of(c), "unused vertices"));
    c = built();
    c.face_vertices[1] = c.face_vertices[0];
    EXPECT_TRUE(has(kinds_of(c), "repeated vertex"));
}

TEST(ComplexDefects, NumbersOutOfRange) {
    CellComplex c = built();
    c.face_vertices[0] = static_cast<std::int32_t>(c.vertices.size());
    EXPECT_TRUE(has({complex_defects(c, Cells::kColumns)[0].kind}, "shape"));
}

TEST(ComplexDefects, ColumnsMustNotTouchThemselvesButBlocksMay) {
    // two unit cubes that share one edge, as one cell
    CellComplex c;
    c.cell_block = {0};
    c.volumes = {2};
    c.face_offsets = {0};
    const auto cube = [&](double x, double y) {
        std::vector<std::int32_t> v;
        for (int i = 0; i < 8; ++i) {
            const Point p{x + (i & 1), y + ((i >> 1) & 1), static_cast<double>(i >> 2)};
            const auto at = std::find(c.vertices.begin(), c.vertices.end(), p);
            v.push_back(static_cast<std::int32_t>(at - c.vertices.begin()));
            if (at == c.vertices.end()) c.vertices.push_back(p);
        }
        for (const auto& [a, b, d, e] : {std::array{0, 2, 3, 1},
                                         {4, 5, 7, 6},
                                         {0, 1, 5, 4},
                                         {2, 6, 7, 3},
                                         {0, 4, 6, 2},
                                         {1, 3, 7, 5}}) {
            for (const int i : {a, b, d, e})
                c.face_vertices.push_back(v[static_cast<std::size_t>(i)]);
            c.face_offsets.push_back(static_cast<std::int64_t>(c.face_vertices.size()));
            c.face_cells.push_back({0, -1});
            c.face_surface.push_back(a == 0 && b == 2 ? strata::kBase : a == 4 ? 0 : strata::kWall);
        }
    };
    cube(0, 0);
    cube(1, 1);
    EXPECT_TRUE(complex_defects(c, Cells::kBlocks).empty());
    const auto defects = complex_defects(c, Cells::kColumns);
    ASSERT_EQ(defects.size(), 1u);
    EXPECT_EQ(defects[0].kind, "not closed");
}

TEST(ComplexDefects, BlocksWithAnotherBoundary) {
    const CellComplex columns = built();
    CellComplex blocks = strata::merge_columns(columns);
    EXPECT_TRUE(boundary_differences(columns, blocks).empty());
    std::replace(blocks.face_surface.begin(), blocks.face_surface.end(), 2, 1);
    EXPECT_FALSE(boundary_differences(columns, blocks).empty());
}

}  // namespace
}  // namespace realmodel::fuzz
