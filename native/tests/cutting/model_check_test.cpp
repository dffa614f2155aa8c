// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "../validation/small_complex.hpp"
#include "cutting/pieces.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {
namespace {

/// The array of two cubes, damaged, that is refused.
template <class Damage>
std::string refused_array(const Damage& damage) {
    auto cubes = validation::two_cubes();
    damage(cubes);
    try {
        check_model(cubes.view());
    } catch (const InputError& error) {
        EXPECT_EQ(error.kind, "bad_model");
        const std::string text = error.what();
        return text.substr(0, text.find(' '));
    }
    return "";
}

TEST(ModelCheck, AcceptsASoundModel) {
    EXPECT_EQ(refused_array([](auto&) {}), "");
}

TEST(ModelCheck, RefusesNumbersOfWhatIsNotThere) {
    EXPECT_EQ(refused_array([](auto& c) { c.loops[3][1] = 12; }), "face_vertices");
    EXPECT_EQ(refused_array([](auto& c) { c.loops[3][1] = -1; }), "face_vertices");
    EXPECT_EQ(refused_array([](auto& c) { c.cells[3][1] = 2; }), "face_cells");
    EXPECT_EQ(refused_array([](auto& c) { c.cells[3][1] = -2; }), "face_cells");
    EXPECT_EQ(refused_array([](auto& c) { c.block[1] = 2; }), "cell_block");
    EXPECT_EQ(refused_array([](auto& c) { c.block[1] = -1; }), "cell_block");
}

TEST(ModelCheck, RefusesFacesThatAreNone) {
    EXPECT_EQ(refused_array([](auto& c) { c.loops[3] = {1, 2}; }), "face_offsets");
    EXPECT_EQ(refused_array([](auto& c) { c.cells[3] = {-1, 0}; }), "face_cells");
    EXPECT_EQ(refused_array([](auto& c) { c.vertices[11][2] = NAN; }), "vertices");
}

TEST(ModelCheck, RefusesArraysOfDifferentLengths) {
    EXPECT_EQ(refused_array([](auto& c) { c.surface.pop_back(); }), "face_surface");
    EXPECT_EQ(refused_array([](auto& c) { c.cells.pop_back(); }), "face_offsets");
    auto cubes = validation::two_cubes();
    ComplexView model = cubes.view();
    model.face_vertices = model.face_vertices.first(model.face_vertices.size() - 1);
    EXPECT_THROW(check_model(model), InputError);
    model = cubes.view();
    model.face_cells = model.face_cells.first(model.face_cells.size() - 1);
    EXPECT_THROW(check_model(model), InputError);
}

}  // namespace
}  // namespace realmodel::cutting
