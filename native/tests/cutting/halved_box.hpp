// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <set>

#include "../arrangement/small_polygons.hpp"
#include "cutting/assembly.hpp"
#include "cutting/near_model.hpp"
#include "cutting/rounding/part_rounding.hpp"

namespace realmodel::cutting {

/// One cell, a box of 1 x 1 x 2, that a level cutter divides at some height. Nodes 8 to 11 are
/// where it cuts the upright edges, in the order of x and then y. Pieces 0 and 1 are the bottom and
/// the top, then come the lower and the upper piece of each side, and the cut face (kCap).
class AHalvedBox : public testing::Test {
protected:
    AHalvedBox() {
        for (int i = 0; i < 8; ++i)
            vertices_.insert(vertices_.end(),
                             {i & 1 ? 1.0 : 0.0, i & 2 ? 1.0 : 0.0, i & 4 ? 2.0 : 0.0});
        for (std::size_t f = 0; f <= kFaces.size(); ++f)
            offsets_.push_back(4 * static_cast<std::int64_t>(f));
        for (const auto& face : kFaces)
            face_vertices_.insert(face_vertices_.end(), face.begin(), face.end());
        for (std::size_t f = 0; f < kFaces.size(); ++f)
            cells_.insert(cells_.end(), {0, -1});
        model_.vertices = vertices_;
        model_.face_offsets = offsets_;
        model_.face_vertices = face_vertices_;
        model_.face_cells = cells_;
        model_.face_surface = surfaces_;
        model_.cell_block = block_;
        model_.blocks = 1;
    }
    void add(std::int32_t face, std::int8_t side, const std::vector<NodeId>& polygon) {
        pieces_.add(polygon, {face, {0, -1}, {side, kOn}, false, {side == kBelow ? 0 : 1, -1}});
    }
    void cut_at(double height) {
        for (int i = 0; i < 4; ++i)
            new_.push_back({i & 1 ? 1.0 : 0.0, i & 2 ? 1.0 : 0.0, height});
        add(0, kBelow, {0, 2, 3, 1});
        add(1, kAbove, {4, 5, 7, 6});
        const std::array<std::array<NodeId, 2>, 4> sides{{{0, 1}, {1, 3}, {3, 2}, {2, 0}}};
        for (std::size_t s = 0; s < 4; ++s) {
            const auto [a, b] = sides[s];
            const auto face = static_cast<std::int32_t>(2 + s);
            add(face, kBelow, {a, b, b + 8, a + 8});
            add(face, kAbove, {a + 8, b + 8, b + 4, a + 4});
        }
        pieces_.add(std::array{8, 9, 11, 10}, {-1, {0, 0}, {kBelow, kAbove}, true, {0, 1}});
    }
    RoundedParts rounded_parts(bool are_joined = false) {
        return {model_, new_, pieces_, parts_, are_joined, {1, nullptr}};
    }
    NodeLoop nodes(std::size_t piece) const { return from_least(pieces_.polygons[piece]); }
    Cut rounded() {
        round_parts(rounded_parts(), {false, false});
        return assemble_halves(model_, new_, WholePieces(CutPieces(pieces_)), parts_, {1, nullptr});
    }
    static void expect_distinct(const CellComplex& half) {
        const std::set<Position> found(half.vertices.begin(), half.vertices.end());
        EXPECT_EQ(found.size(), half.vertices.size());
    }

    static constexpr std::size_t kCap = 10;
    static constexpr std::array<std::array<std::int32_t, 4>, 6> kFaces{
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {1, 3, 7, 5}, {3, 2, 6, 7}, {2, 0, 4, 6}}};
    std::vector<double> vertices_;
    std::vector<std::int64_t> offsets_;
    std::vector<std::int32_t> face_vertices_, cells_, surfaces_{1, 1, -1, -1, -1, -1}, block_{0};
    ComplexView model_;
    CutPieces pieces_;
    std::vector<Position> new_;
    std::vector<HalfCell> parts_{{0, kBelow}, {0, kAbove}};
};

}  // namespace realmodel::cutting
