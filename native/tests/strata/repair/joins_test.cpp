// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/strata/joins.hpp"

#include "../complex_checks.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::strata {
namespace {

/// Three surfaces of a square, the second with its east border written with other digits, in a
/// triangle.
struct Input {
    std::vector<OwnedSurface> surfaces;
    std::vector<double> corners{0, 0, 6, 1, 1, 5};
    std::vector<std::int32_t> triangle{0, 1, 2};

    explicit Input(double east = std::nextafter(7.0, 8.0)) {
        for (int k = 0; k < 3; ++k)
            surfaces.push_back(grid(3 + k, 3 + k, -1, -1, 7, 7, [k](double, double) { return k; }));
        for (std::size_t i = 0; i < surfaces[1].vertices.size(); i += 3) {
            if (surfaces[1].vertices[i] == 7.0) surfaces[1].vertices[i] = east;
        }
    }
    StackInput view() const {
        StackInput input;
        for (const OwnedSurface& s : surfaces)
            input.surfaces.push_back(s.view());
        input.region = {corners, triangle};
        return input;
    }
};

TEST(Joins, AreNoneWhereNothingIsClose) {
    const Input owned(7.0);
    const StackInput input = owned.view();
    for (const bool borders : {true, false})
        EXPECT_FALSE(find_joins({&input, 1}, borders));
}

TEST(Joins, GiveTheMeshesThatAreBuilt) {
    const Input owned;
    const OwnedSurface expected = Input(7.0).surfaces[1];
    const StackInput input = owned.view();
    for (const bool borders : {true, false}) {
        const auto joins = find_joins({&input, 1}, borders);
        ASSERT_TRUE(joins);
        const auto mesh = joins->mesh(input.surfaces[1], 3);
        ASSERT_TRUE(mesh);
        EXPECT_EQ(mesh->vertices, expected.vertices);
        EXPECT_EQ(mesh->triangles, expected.triangles);
        EXPECT_EQ(joins->snapped(input.surfaces[1].vertices, 3), expected.vertices);
        const auto region = joins->mesh(*input.region, 2);
        ASSERT_TRUE(region);
        EXPECT_EQ(region->vertices, owned.corners);
        EXPECT_EQ(joins->snapped(input.region->vertices, 2), owned.corners);
        const auto built = build_stack(input, {1, nullptr}).warnings;
        ASSERT_EQ(built.size(), 1U);
        EXPECT_EQ(joins->warning().text, built[0].text);
    }
}

TEST(Joins, AreNotMadeInAMeshThatIsNotSingleValued) {
    Input owned;
    OwnedSurface& twice = owned.surfaces[0];
    twice.triangle(twice.vertex(0, 0, 9), twice.vertex(1, 0, 9), twice.vertex(0, 1, 9));
    const StackInput input = owned.view();
    const auto joins = find_joins({&input, 1});
    ASSERT_TRUE(joins);
    EXPECT_FALSE(joins->mesh(input.surfaces[0], 3));
    EXPECT_TRUE(joins->mesh(input.surfaces[1], 3));
    const std::vector<double> bow{0, 0, 4, 4, 4, 0, 0, 4, -1, 2, 5, 2};
    const std::vector<std::int32_t> crossing{0, 1, 4, 2, 3, 5};
    EXPECT_FALSE(joins->mesh({bow, crossing}, 2));
}

TEST(Joins, RefuseWhatTheBuilderRefuses) {
    Input owned;
    OwnedSurface& upright = owned.surfaces[0];
    upright.triangle(upright.vertex(0, 0, 9), upright.vertex(1, 0, 9), upright.vertex(0.5, 0, 10));
    const StackInput input = owned.view();
    const auto joins = find_joins({&input, 1});
    ASSERT_TRUE(joins);
    EXPECT_THROW(joins->mesh(input.surfaces[0], 3), InputError);
}

}  // namespace
}  // namespace realmodel::strata
