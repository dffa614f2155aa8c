// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/arrays_test.hpp"

#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace realmodel::validation
