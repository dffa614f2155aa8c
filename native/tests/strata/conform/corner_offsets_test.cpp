// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <random>

#include "strata/conform/conformed_faces.hpp"

namespace realmodel::strata {
namespace {

/// Corners whose edges pass plan vertices, given in any order, as lines are dealt with.
struct Case {
    std::vector<PassedVertices> passed;
    std::vector<std::uint32_t> expected;  ///< first entry of each corner, and the total
};

Case make_case(std::size_t corners, int one_of, std::mt19937& random) {
    std::vector<std::uint32_t> plan_vertices(corners, 0);
    Case made;
    made.passed.resize(5);
    std::vector<std::size_t> order(corners);
    for (std::size_t c = 0; c < corners; ++c)
        order[c] = c;
    std::shuffle(order.begin(), order.end(), random);
    for (const std::size_t c : order) {
        if (static_cast<int>(random() % 1000) >= 1000 / one_of) continue;
        plan_vertices[c] = 1 + static_cast<std::uint32_t>(random() % 4);
        PassedVertices& list = made.passed[random() % made.passed.size()];
        list.edges.push_back(
            {static_cast<std::uint32_t>(c), plan_vertices[c], random() % 2 == 0 ? 1U : 0U});
        list.vertices.insert(list.vertices.end(), plan_vertices[c], 17);
    }
    std::uint32_t next = 0;
    for (std::size_t c = 0; c < corners; ++c) {
        made.expected.push_back(next);
        next += 1 + plan_vertices[c];
    }
    made.expected.push_back(next);
    return made;
}

TEST(CornerOffsets, AreThoseOfASimpleLoop) {
    std::mt19937 random(1);
    for (const std::size_t corners : {0, 1, 31, 32, 33, 64, 20000}) {
        for (const int one_of : {1, 2, 60}) {
            const Case made = make_case(corners, one_of, random);
            const CornerOffsets numbers(made.passed, corners, {3, nullptr});
            EXPECT_EQ(numbers.corners(), corners);
            for (std::size_t c = 0; c <= corners; ++c)
                ASSERT_EQ(numbers.first(c), made.expected[c]) << c << " of " << corners;
            const std::size_t begin = corners / 3, end = corners - corners / 5;
            std::size_t next = begin;
            numbers.for_each(begin, end, [&](std::size_t corner, std::uint32_t entry) {
                ASSERT_EQ(corner, next++);
                ASSERT_EQ(entry, made.expected[corner]) << corner << " of " << corners;
            });
            EXPECT_EQ(next, end);
        }
    }
}

}  // namespace
}  // namespace realmodel::strata
