// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/array_tests.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/index.hpp"
#include "small_complex.hpp"

namespace realmodel::validation {
namespace {

std::vector<std::string> texts(const ComplexView& model) {
    std::vector<std::string> texts;
    for (const Offender& offender : check_arrays(model, {1, nullptr}).first)
        texts.push_back(offender.text);
    return texts;
}
template <class Damage>
std::vector<std::string> texts_of(const Damage& damage) {
    auto cubes = two_cubes();
    damage(cubes);
    return texts(cubes.view());
}

using Texts = std::vector<std::string>;

TEST(ArraysTest, SoundArraysPass) {
    auto cubes = two_cubes();
    const Findings found = check_arrays(cubes.view(), {2, nullptr});
    EXPECT_TRUE(found.passed());
    EXPECT_EQ(found.examined, 11);
}

TEST(ArraysTest, EachNumberOutOfRangeIsNamed) {
    EXPECT_EQ(texts_of([](OwnedComplex& c) {
                  c.loops[0][0] = 12;
                  c.loops[1] = {4, 5};
                  c.cells[2] = {1, 1};
                  c.surface[3] = kCutFace - 1;
                  c.surface[4] = 2;
              }),
              (Texts{"face 0 names vertex 12", "face 1 has 2 corners",
                     "face 2 lies between cells 1 and 1", "face 3 names surface -4",
                     "face 4 names surface 2"}));
}

TEST(ArraysTest, TheLastNumbersInRangeAreNot) {
    EXPECT_EQ(texts_of([](OwnedComplex& c) {
                  c.surface[3] = kCutFace;
                  c.surface[4] = 1;
                  c.loops[5] = {11, 0, 10};
              }),
              Texts{});
}

TEST(ArraysTest, CellsHaveFacesAndBlocks) {
    EXPECT_EQ(texts_of([](OwnedComplex& c) { c.block = {0, 1, 1}; }), Texts{"cell 2 has no faces"});
    EXPECT_EQ(texts_of([](OwnedComplex& c) {
                  c.block = {-1, 2};
              }),
              (Texts{"cell 0 names block -1", "cell 1 names block 2"}));
}

TEST(ArraysTest, CoordinatesAreFinite) {
    EXPECT_EQ(texts_of([](OwnedComplex& c) {
                  c.vertices[3][0] = HUGE_VAL;
                  c.vertices[7][2] = NAN;
              }),
              (Texts{"vertex 3 is not finite", "vertex 7 is not finite"}));
}

TEST(ArraysTest, LengthsThatDoNotFitEndTheTest) {
    const auto ends_with = [](const Texts& found, const std::string& text) {
        return found.size() == 1 && found[0].find(text) != std::string::npos;
    };
    EXPECT_TRUE(ends_with(texts_of([](OwnedComplex& c) { c.surface.pop_back(); }), "face_surface"));
    auto cubes = two_cubes();
    ComplexView model = cubes.view();
    model.vertices = model.vertices.first(35);
    EXPECT_TRUE(ends_with(texts(model), "not in threes"));
    model = cubes.view();
    model.block_volume = model.block_volume.first(1);
    EXPECT_TRUE(ends_with(texts(model), "blocks without a volume or base"));
    model = cubes.view();
    model.block_base = model.block_base.first(1);
    EXPECT_TRUE(ends_with(texts(model), "blocks without a volume or base"));
    model = cubes.view();
    model.face_offsets = model.face_offsets.first(11);
    EXPECT_TRUE(ends_with(texts(model), "face_offsets has 11 entries for 11 faces"));
    model = cubes.view();
    model.face_vertices = model.face_vertices.first(43);
    EXPECT_TRUE(ends_with(texts(model), "does not run from 0 to the number of corners"));
}

std::vector<std::string> texts(const Findings& findings) {
    std::vector<std::string> texts;
    for (const Offender& offender : findings.first)
        texts.push_back(offender.text);
    EXPECT_EQ(texts.size(), std::min<std::size_t>(Findings::kMost, index(findings.failed)));
    return texts;
}

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

/// Two cubes that do not know of each other: the face between them is there for each.
OwnedComplex cubes_apart() {
    auto cubes = two_cubes();
    cubes.cells[1] = {0, -1};
    cubes.add_face({6, 5, 4, 7}, 1, -1, 0);
    return cubes;
}

TEST(OutsideTest, FacesBetweenTwoCellsAreNoOutside) {
    auto cubes = two_cubes();
    const Findings found = check_outside(cubes.view(), {1, nullptr});
    EXPECT_EQ(found.examined, 10);
    EXPECT_TRUE(found.passed());
}

TEST(OutsideTest, AFaceStoredTwiceIsFoundWhateverItsFirstCornerAndDirection) {
    auto cubes = cubes_apart();
    for (int turn = 0; turn < 4; ++turn) {
        const Findings found = check_outside(cubes.view(), {1, nullptr});
        ASSERT_EQ(found.failed, 1);
        EXPECT_EQ(found.first[0].text,
                  "face 11 has one cell, but face 1 of cell 0 lies at the same position");
        EXPECT_EQ(found.first[0].face, 11);
        EXPECT_EQ(found.first[0].cell, 1);
        std::rotate(cubes.loops[11].begin(), cubes.loops[11].begin() + 1, cubes.loops[11].end());
    }
    std::ranges::reverse(cubes.loops[11]);
    EXPECT_EQ(check_outside(cubes.view(), {1, nullptr}).failed, 1);
}

TEST(OutsideTest, FacesThatDifferInOneCornerAreTwo) {
    auto cubes = cubes_apart();
    cubes.vertices.push_back({0.5, 0.5, 1});
    cubes.loops[11] = {6, 5, 4, 12};
    EXPECT_TRUE(check_outside(cubes.view(), {1, nullptr}).passed());
    cubes.loops[11] = {6, 5, 4, 7, 12};
    EXPECT_TRUE(check_outside(cubes.view(), {1, nullptr}).passed());
}

}  // namespace
}  // namespace realmodel::validation
