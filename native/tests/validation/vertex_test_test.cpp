// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/vertex_test.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/index.hpp"
#include "small_complex.hpp"

namespace realmodel::validation {
namespace {

std::vector<std::string> texts(const Findings& findings) {
    std::vector<std::string> texts;
    for (const Offender& offender : findings.first)
        texts.push_back(offender.text);
    EXPECT_EQ(texts.size(), std::min<std::size_t>(Findings::kMost, index(findings.failed)));
    return texts;
}

using Texts = std::vector<std::string>;

/// Vertices of one face that has them all.
Texts about_vertices(const std::vector<std::array<double, 3>>& vertices) {
    OwnedComplex complex;
    complex.vertices = vertices;
    std::vector<std::int32_t> loop(vertices.size());
    std::iota(loop.begin(), loop.end(), 0);
    complex.add_face(loop, 0, -1, 0);
    const Findings found = check_vertices(complex.view(), {1, nullptr});
    EXPECT_EQ(found.examined, static_cast<std::int64_t>(vertices.size()));
    return texts(found);
}

TEST(VertexTest, DistinctVerticesPassInAnyOrder) {
    EXPECT_EQ(about_vertices({{0, 0, 0}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}}), Texts{});
    EXPECT_EQ(about_vertices({{1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {0, 0, 1}}), Texts{});
    EXPECT_EQ(about_vertices({{1, 0, 0}, {std::nextafter(1, 2), 0, 0}, {0, 0, 0}}), Texts{});
}

TEST(VertexTest, AVertexInThePlaceOfAnotherIsNamedWithIt) {
    EXPECT_EQ(about_vertices({{3, 1, 2}, {0, 0, 0}, {3, 1, 2}}),
              Texts{"vertex 2 has the coordinates of vertex 0"});
    // though all ascend but for being equal
    EXPECT_EQ(about_vertices({{0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {2, 2, 2}}),
              Texts{"vertex 2 has the coordinates of vertex 1"});
}

/// As those that a tile takes over from its neighbors.
TEST(VertexTest, FewVerticesMayStandBehindThoseThatAscend) {
    std::vector<std::array<double, 3>> vertices;
    for (int i = 0; i < 300; ++i)
        vertices.push_back({0.5 * i, 1, 2});
    vertices.push_back({7.25, 1, 2});
    vertices.push_back({3.25, 1, 2});
    EXPECT_EQ(about_vertices(vertices), Texts{});
    auto again = vertices;
    again.push_back({3.25, 1, 2});
    EXPECT_EQ(about_vertices(again), Texts{"vertex 302 has the coordinates of vertex 301"});
    again.back()[0] = 4;
    EXPECT_EQ(about_vertices(again), Texts{"vertex 302 has the coordinates of vertex 8"});
    again.back()[0] = std::nan("");
    EXPECT_EQ(about_vertices(again), Texts{});
}

TEST(VertexTest, BothZerosAreOnePlace) {
    EXPECT_EQ(about_vertices({{0, -0.0, 1}, {5, 5, 5}, {-0.0, 0, 1}}),
              Texts{"vertex 2 has the coordinates of vertex 0"});
}

TEST(VertexTest, OfManyInOnePlaceEachButTheFirstIsCounted) {
    EXPECT_EQ(about_vertices(std::vector(9, std::array{1.0, 2.0, 3.0})).size(), Findings::kMost);
    OwnedComplex complex;
    complex.vertices.assign(9, {1, 2, 3});
    EXPECT_EQ(check_vertices(complex.view(), {1, nullptr}).failed, 8 + 9);  // and no face has any
}

TEST(VertexTest, AVertexOfNoFaceIsFound) {
    auto cubes = two_cubes();
    EXPECT_TRUE(check_vertices(cubes.view(), {1, nullptr}).passed());
    cubes.loops[2] = {8, 9, 10};
    for (std::size_t wall : {9U, 10U})
        cubes.loops[wall] = {5, 6, 10, 9};
    const Findings found = check_vertices(cubes.view(), {1, nullptr});
    EXPECT_EQ(texts(found), Texts{"vertex 11 belongs to no face"});
    EXPECT_EQ(found.first[0].vertex, 11);
    EXPECT_EQ(found.first[0].place, (std::array<double, 3>{0, 1, 2}));
}

/// A face of so many corners; the last one is that of number `last`.
Texts about_loop(std::int32_t corners, std::int32_t last) {
    OwnedComplex complex;
    complex.vertices.assign(index(corners), {0, 0, 0});
    std::vector<std::int32_t> loop(index(corners));
    std::iota(loop.begin(), loop.end(), 0);
    loop.back() = last;
    complex.add_face({0, 1, 2}, 0, -1, 0);
    complex.add_face(loop, 0, -1, 0);
    return texts(check_loops(complex.view(), {1, nullptr}));
}

TEST(VertexTest, ALoopMayNotPassAVertexTwiceHoweverLongItIs) {
    for (const std::int32_t corners : {3, 4, 12, 13, 40}) {
        EXPECT_EQ(about_loop(corners, corners - 1), Texts{});
        EXPECT_EQ(about_loop(corners, 1), Texts{"face 1 passes vertex 1 more than once"});
        EXPECT_EQ(about_loop(corners, 0), Texts{"face 1 passes vertex 0 more than once"});
    }
}

}  // namespace
}  // namespace realmodel::validation
