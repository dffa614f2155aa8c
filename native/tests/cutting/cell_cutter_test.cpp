// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>

#include "../arrangement/small_polygons.hpp"
#include "cutting/plane_division.hpp"
#include "prism.hpp"

namespace realmodel::cutting {
namespace {

/// A model of one cell without faces in the plane, cut at a height.
class CutAt {
public:
    CutAt(validation::OwnedComplex complex, double height)
        : complex_(std::move(complex)),
          model_(complex_.view()),
          plane_(checked_plane({{0, 0, height}, {0, 0, 1}})),
          sides_(vertex_sides(model_, plane_, {1, nullptr})),
          cuts_(model_, plane_, cut_edges()) {
        FaceSplitter splitter(model_, sides_, cuts_);
        for (std::size_t f = 0; f < model_.face_count(); ++f) {
            const auto& loop = complex_.loops[f];
            const NodeLoop face(loop.begin(), loop.end());
            SplitFace parts;
            const auto [low, high] =
                std::ranges::minmax(loop, {}, [this](std::int32_t v) { return sides_[index(v)]; });
            if (sides_[index(low)] * sides_[index(high)] < 0) {
                splitter.split(face, parts);
            } else {
                parts.polygons.add(face);
                parts.sides = {sides_[index(low)] != kOn ? sides_[index(low)]
                                                         : sides_[index(high)]};
            }
            for (std::size_t p = 0; p < parts.sides.size(); ++p) {
                refs_.push_back({static_cast<std::int32_t>(pieces_.size()), 0});
                pieces_.add(parts.polygons[p],
                            {static_cast<std::int32_t>(f), {0, -1}, {parts.sides[p], kOn}, false});
            }
        }
        CellCutter(model_, sides_, cuts_, pieces_, plane_).cut(refs_, cut);
    }
    /// Parts on a side of the plane.
    std::ptrdiff_t count(std::int8_t side) const { return std::ranges::count(cut.part_side, side); }
    /// The part that what remains of a face belongs to, on a side of the plane.
    std::int32_t part_of(std::int32_t face, std::int8_t side) const {
        for (std::size_t i = 0; i < refs_.size(); ++i) {
            const CutPiece& piece = pieces_[index(refs_[i].piece)];
            if (piece.face == face && piece.sides[0] == side) return cut.part[i];
        }
        return -1;
    }
    /// Parts below and above a cut face.
    std::array<std::int32_t, 2> beside_cap(std::size_t cut_face) const {
        return {cut.part[refs_.size() + 2 * cut_face], cut.part[refs_.size() + 2 * cut_face + 1]};
    }
    /// The area of all cut faces, seen from above.
    double area() const {
        double twice = 0;
        for (std::size_t c = 0; c < cut.cut_faces.size(); ++c) {
            std::vector<Position> corners;
            for (const NodeId node : cut.cut_faces[c])
                corners.push_back(cuts_.contains(node) ? cuts_.position(node)
                                                       : complex_.vertices[index(node)]);
            twice += polygon_normal(corners)[2];
        }
        return twice / 2;
    }

    CellCut cut;

private:
    std::vector<std::array<NodeId, 2>> cut_edges() const {
        std::vector<std::array<NodeId, 2>> edges;
        for (const auto& loop : complex_.loops) {
            for (std::size_t i = 0; i < loop.size(); ++i) {
                const std::int32_t a = loop[i], b = loop[(i + 1) % loop.size()];
                if (sides_[index(a)] * sides_[index(b)] < 0)
                    edges.push_back(unordered(NodeId{a}, NodeId{b}));
            }
        }
        return edges;
    }

    validation::OwnedComplex complex_;
    ComplexView model_;
    exact::OrientedPlane plane_;
    std::vector<std::int8_t> sides_;
    EdgeIntersections cuts_;
    CutPieces pieces_;
    std::vector<PieceRef> refs_;
};

TEST(CellCutter, ACubeHasOneBelowItsCapAndOneAbove) {
    const CutAt cut(prism({{0, 0}, {1, 0}, {1, 1}, {0, 1}}), 0.5);
    EXPECT_TRUE(cut.cut.is_clean);
    EXPECT_EQ(cut.cut.cut_faces.size(), 1U);
    EXPECT_DOUBLE_EQ(cut.area(), 1);
    EXPECT_EQ(cut.count(kBelow), 1);
    EXPECT_EQ(cut.count(kAbove), 1);
    // of each wall, what is below the cut face and what is above
    for (const std::int32_t wall : {0, 1, 3, 5})
        EXPECT_EQ((std::array{cut.part_of(wall, kBelow), cut.part_of(wall, kAbove)}),
                  cut.beside_cap(0));
}

TEST(CellCutter, AUFallsIntoItsFootAndTwoTowers) {
    const CutAt cut(u_shape(), 1.5);
    EXPECT_EQ(cut.cut.cut_faces.size(), 2U);
    EXPECT_DOUBLE_EQ(cut.area(), 2);
    EXPECT_EQ(cut.count(kBelow), 1);
    EXPECT_EQ(cut.count(kAbove), 2);
    EXPECT_EQ(cut.beside_cap(0)[0], cut.beside_cap(1)[0]);
    EXPECT_NE(cut.beside_cap(0)[1], cut.beside_cap(1)[1]);
}

TEST(CellCutter, WhereAValleyTouchesThePlaneWhatIsAboveFallsApart) {
    const CutAt cut(prism({{0, 0}, {3, 0}, {3, 2}, {1, 1}, {0, 2}}), 1);
    EXPECT_DOUBLE_EQ(cut.area(), 3);
    EXPECT_EQ(cut.count(kBelow), 1);
    EXPECT_EQ(cut.count(kAbove), 2);
    EXPECT_NE(cut.part_of(4, kAbove), cut.part_of(5, kAbove));  // the slopes of the valley
}

TEST(CellCutter, WhereARoofTouchesThePlaneFromWithinWhatIsBelowFallsApart) {
    const CutAt cut(prism({{0, 0}, {1, 1}, {3, 0}, {3, 2}, {0, 2}}), 1);
    EXPECT_DOUBLE_EQ(cut.area(), 3);
    EXPECT_EQ(cut.count(kBelow), 2);
    EXPECT_EQ(cut.count(kAbove), 1);
}

TEST(CellCutter, ATopThatOnlyTouchesThePlaneHasNoCap) {
    // two peaks, the left one as high as the plane
    const CutAt cut(prism({{0, 0}, {4, 0}, {3, 2}, {2, 0.5}, {1, 1}}), 1);
    EXPECT_EQ(cut.cut.cut_faces.size(), 1U);
    EXPECT_EQ(cut.count(kBelow), 1);
    EXPECT_EQ(cut.count(kAbove), 1);
}

/// Makes a hollow between y = 0.25 and y = 0.75 in a cell.
validation::OwnedComplex with_hollow(validation::OwnedComplex o, const Outline& outline) {
    const validation::OwnedComplex inner = prism(outline);
    const auto first = static_cast<std::int32_t>(o.vertices.size());
    for (const auto& [x, y, z] : inner.vertices)
        o.vertices.push_back({x, 0.25 + y / 2, z});
    for (std::vector<std::int32_t> loop : inner.loops) {
        std::reverse(loop.begin(), loop.end());
        for (std::int32_t& v : loop)
            v += first;
        o.add_face(loop, 0, -1, 0);
    }
    return o;
}

validation::OwnedComplex hollow_cube() {
    return with_hollow(prism({{0, 0}, {1, 0}, {1, 1}, {0, 1}}),
                       {{0.25, 0.25}, {0.75, 0.25}, {0.75, 0.75}, {0.25, 0.75}});
}

TEST(CellCutter, AHollowBelongsToThePartAroundIt) {
    const CutAt below_it(hollow_cube(), 0.125), above_it(hollow_cube(), 0.875);
    EXPECT_EQ(below_it.cut.part_side.size(), 2U);
    EXPECT_EQ(below_it.part_of(6, kAbove), below_it.beside_cap(0)[1]);
    EXPECT_EQ(above_it.cut.part_side.size(), 2U);
    EXPECT_EQ(above_it.part_of(6, kBelow), above_it.beside_cap(0)[0]);
}

TEST(CellCutter, AHollowInOneTowerBelongsToThatTower) {
    // the tower to the right is the smaller one; faces 3 and 9 are the towers' outer walls
    const Outline right{{2.25, 1.6}, {2.75, 1.6}, {2.75, 1.8}, {2.25, 1.8}},
        left{{0.25, 1.6}, {0.75, 1.6}, {0.75, 1.8}, {0.25, 1.8}};
    for (const bool is_right : {true, false}) {
        auto u = u_shape();
        for (const std::size_t v : {2U, 3U, 10U, 11U})
            u.vertices[v][2] = 1.9;
        const CutAt cut(with_hollow(u, is_right ? right : left), 1.5);
        EXPECT_EQ(cut.count(kAbove), 2);
        EXPECT_EQ(cut.part_of(10, kAbove), cut.part_of(is_right ? 3 : 9, kAbove));
    }
}

TEST(CellCutter, AHollowBelongsToTheTowerAroundItThoughASmallerOneReachesRoundBoth) {
    // a frame that hangs round a wide tower; face 3 is a wall of that
    const auto frame = prism({{0, 0},
                              {8, 0},
                              {8, 8},
                              {2, 8},
                              {2, 1},
                              {1, 1},
                              {1, 9},
                              {9, 9},
                              {9, 2},
                              {10, 2},
                              {10, 10},
                              {0, 10}});
    const CutAt cut(with_hollow(frame, {{4, 4}, {6, 4}, {6, 6}, {4, 6}}), 1.5);
    EXPECT_EQ(cut.count(kAbove), 2);
    EXPECT_EQ(cut.part_of(14, kAbove), cut.part_of(3, kAbove));
}

TEST(CellCutter, ThroughAHollowTheCapsGoRoundIt) {
    const CutAt cut(hollow_cube(), 0.5);
    EXPECT_DOUBLE_EQ(cut.area(), 0.75);
    EXPECT_EQ(cut.cut.part_side.size(), 2U);
}

}  // namespace
}  // namespace realmodel::cutting
