// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/shell.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

namespace realmodel::cutting {
namespace {

using Footprint = std::vector<std::array<double, 2>>;

/// Polygons of shells; the number of each is its place here.
struct Bodies {
    std::vector<std::vector<std::vector<Position>>> shells;
    std::vector<int> signs;

    /// A prism over a counter-clockwise outline.
    void add(const Footprint& outline, double low, double high, int sign) {
        std::vector<std::vector<Position>> faces(2);
        for (std::size_t i = 0; i < outline.size(); ++i) {
            const auto [x, y] = outline[i];
            const auto [u, v] = outline[(i + 1) % outline.size()];
            faces[0].push_back({x, y, high});
            faces[1].insert(faces[1].begin(), {x, y, low});
            faces.push_back({{x, y, low}, {u, v, low}, {u, v, high}, {x, y, high}});
        }
        shells.push_back(faces);
        signs.push_back(sign);
    }
    /// The shell that is joined with the last one.
    std::size_t around_last() const {
        DisjointSets sets(shells.size());
        std::vector<std::int32_t> all(shells.size());
        std::iota(all.begin(), all.end(), 0);
        join_hollows(all, sets, [this](std::int32_t s, const VisitShellPolygon& visit) {
            for (const auto& face : shells[index(s)])
                visit(face, signs[index(s)]);
        });
        const auto last = static_cast<std::int32_t>(shells.size() - 1);
        std::size_t found = shells.size();
        for (std::size_t s = 0; s + 1 < shells.size(); ++s) {
            if (sets.find(static_cast<std::int32_t>(s)) != sets.find(last)) continue;
            EXPECT_EQ(found, shells.size());
            found = s;
        }
        return found;
    }
};

const Footprint kFrame{{0, 0}, {10, 0}, {10, 10}, {9, 10}, {9, 1}, {1, 1}, {1, 10}, {0, 10}};
const Footprint kFinger{{2, 2}, {8, 2}, {8, 10}, {2, 10}};
const Footprint kHole{{4, 4}, {6, 4}, {6, 6}, {4, 6}};

TEST(JoinHollows, AHollowGoesToTheShellThatContainsIt) {
    Bodies in_finger, in_frame;
    in_finger.add(kFrame, 0, 2, 1);
    in_finger.add(kFinger, 0, 2, 1);
    in_frame = in_finger;
    in_finger.add(kHole, 0.5, 1.5, -1);
    EXPECT_EQ(in_finger.around_last(), 1U);  // though the frame is smaller, and its box contains it
    in_frame.add({{0.2, 0.2}, {0.8, 0.2}, {0.8, 5}, {0.2, 5}}, 0.5, 1.5, -1);
    EXPECT_EQ(in_frame.around_last(), 0U);
}

TEST(JoinHollows, AHollowThatTouchesTheWallsIsInsideAllTheSame) {
    Bodies bodies;
    bodies.add(kFrame, 0, 2, 1);
    bodies.add(kFinger, 0, 2, 1);
    // three of its edges lie in walls of the finger
    bodies.add({{2, 5}, {5, 2}, {8, 5}, {5, 8}}, 0.5, 1.5, -1);
    EXPECT_EQ(bodies.around_last(), 1U);
}

TEST(JoinHollows, OfShellsInOneAnotherItIsTheInnermost) {
    Bodies bodies;
    bodies.add({{-9, -9}, {19, -9}, {19, 19}, {-9, 19}}, -9, 9, 1);
    bodies.add(kFinger, 0, 2, 1);
    bodies.add(kHole, 0.5, 1.5, -1);
    EXPECT_EQ(bodies.around_last(), 1U);
}

}  // namespace
}  // namespace realmodel::cutting
