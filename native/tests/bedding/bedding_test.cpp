// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/bedding/bedding.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../strata/complex_checks.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::bedding {
namespace {

using strata::OwnedSurface;

/// All sides of all faces of a model of one rock mass.
std::vector<BedPolygon> sides_of(const ComplexView& complex) {
    std::vector<BedPolygon> polygons;
    for (std::size_t f = 0; f < complex.face_count(); ++f) {
        for (const bool reversed : {false, true}) {
            const std::int32_t cell = complex.cell(f, reversed ? 1 : 0);
            if (cell < 0) continue;
            polygons.push_back({static_cast<std::int32_t>(f), reversed, 0, complex.block(cell)});
        }
    }
    return polygons;
}

struct Made {
    CellComplex complex;
    std::vector<BedPolygon> polygons;
    Bedding bedding;

    /// Calls visit(polygon, position, corner) for all corners.
    template <class Visit>
    void for_each(const Visit& visit) const {
        const ComplexView view = complex;
        std::size_t corner = 0;
        for (const BedPolygon& polygon : polygons) {
            const auto face = view.face(static_cast<std::size_t>(polygon.face));
            for (std::size_t i = 0; i < face.size(); ++i, ++corner)
                visit(polygon, view.vertex(face[polygon.reversed ? face.size() - 1 - i : i]),
                      corner);
        }
    }
};

Made made_of(const std::vector<OwnedSurface>& surfaces, std::vector<strata::Rule> rules = {},
             std::optional<double> base = {}, int threads = 2) {
    strata::StackInput input;
    for (const OwnedSurface& surface : surfaces)
        input.surfaces.push_back(surface.view());
    input.rules = std::move(rules);
    input.base_elevation = base;
    Made made{strata::build_stack(input, {threads, nullptr}), {}, {}};
    made.polygons = sides_of(made.complex);
    const History history{input.surfaces, input.rules, input.base_elevation};
    made.bedding = bedding_of(made.complex, {&history, 1}, made.polygons, {}, {threads});
    return made;
}

TEST(BeddingTest, HeightsInAFoldedLayerThatIsErodedLater) {
    const auto fold = [](double x, double) { return 3 * std::sin(x); };
    const auto above = [&](double x, double y) { return fold(x, y) + 4; };
    const auto ground = [](double, double y) { return 2 + 0.1 * y; };
    const Made made =
        made_of({strata::grid(12, 4, 0, 0, 12, 4, fold), strata::grid(12, 4, 0, 0, 12, 4, above),
                 strata::grid(9, 5, 0, 0, 12, 4, ground, true)});
    std::size_t inside = 0;
    made.for_each(
        [&](const BedPolygon& polygon, const std::array<double, 3>& at, std::size_t corner) {
            const double depth = 2 + 0.1 * at[1] - at[2];
            EXPECT_NEAR(made.bedding.depth[corner], std::max(0.0, depth), 1e-5);
            if (polygon.layer != 1) return;
            const double left = std::floor(at[0]), share = at[0] - left;  // of a column of the grid
            const double base = (1 - share) * fold(left, 0) + share * fold(left + 1, 0);
            EXPECT_NEAR(made.bedding.thickness[corner], 4.0, 1e-5);
            EXPECT_NEAR(made.bedding.height[corner], (at[2] - base) / 4, 1e-6);
            inside += made.bedding.height[corner] > 0.01 && made.bedding.height[corner] < 0.99;
        });
    EXPECT_GT(inside, 100);  // corners of the eroded top
}

TEST(BeddingTest, TheBaseOfALayerIsWhatIsThereNotTheSurfaceBelow) {
    const auto flat = [](double z) { return [z](double, double) { return z; }; };
    // laid on 0, eroded to 2 of 10, then 2 to 6 is deposited; a conformable sheet at 4 adds nothing
    const Made made =
        made_of({strata::grid(2, 2, 0, 0, 4, 4, flat(0)), strata::grid(2, 2, 0, 0, 4, 4, flat(10)),
                 strata::grid(2, 2, 0, 0, 4, 4, flat(2)), strata::grid(2, 2, 0, 0, 4, 4, flat(6)),
                 strata::grid(2, 2, 0, 0, 4, 4, flat(4))},
                {strata::Rule::kErosional, strata::Rule::kErosional, strata::Rule::kErosional,
                 strata::Rule::kErosional, strata::Rule::kConformable},
                -5.0);
    std::set<std::tuple<int, float, float, float>> found;  // layer, z, height, thickness
    made.for_each(
        [&](const BedPolygon& polygon, const std::array<double, 3>& at, std::size_t corner) {
            found.emplace(polygon.layer, static_cast<float>(at[2]), made.bedding.height[corner],
                          made.bedding.thickness[corner]);
            EXPECT_FLOAT_EQ(made.bedding.depth[corner], static_cast<float>(6 - at[2]));
        });
    const std::set<std::tuple<int, float, float, float>> wanted{
        {0, -5, 0, 5}, {0, 0, 1, 5}, {1, 0, 0, 10}, {1, 2, 0.2F, 10}, {3, 2, 0, 4}, {3, 6, 1, 4}};
    EXPECT_EQ(found, wanted);
}

TEST(BeddingTest, EachSideOfAStepHasItsOwnLayer) {
    // the base jumps from 0 to 2 at x = 1; the top is 4
    OwnedSurface base;
    for (const auto& [x0, x1, z] : {std::tuple(0.0, 1.0, 0.0), std::tuple(1.0, 2.0, 2.0)}) {
        const auto a = base.vertex(x0, 0, z), b = base.vertex(x1, 0, z);
        const auto c = base.vertex(x1, 1, z), d = base.vertex(x0, 1, z);
        base.triangle(a, b, c);
        base.triangle(a, c, d);
    }
    const Made made =
        made_of({base, strata::grid(1, 1, 0, 0, 2, 1, [](double, double) { return 4.0; })});
    const ComplexView view = made.complex;
    made.for_each([&](const BedPolygon& polygon, const std::array<double, 3>& at,
                      std::size_t corner) {
        double middle = 0;
        const auto face = view.face(static_cast<std::size_t>(polygon.face));
        for (const std::int32_t v : face)
            middle += view.vertex(v)[0] / static_cast<double>(face.size());
        if (std::abs(middle - 1) < 1e-9) return;  // the wall of the step: of the cell on its side
        const double low = middle < 1 ? 0 : 2;
        EXPECT_FLOAT_EQ(made.bedding.thickness[corner], static_cast<float>(4 - low));
        EXPECT_FLOAT_EQ(made.bedding.height[corner], static_cast<float>((at[2] - low) / (4 - low)));
    });
}

TEST(BeddingTest, WhereALayerEndsItsSidesKeepTheirHeights) {
    const auto flat = [](double, double) { return 1.0; };
    const auto wedge = [](double x, double) { return x; };  // above 1 where x > 1
    const Made made =
        made_of({strata::grid(4, 1, 0, 0, 4, 1, flat), strata::grid(4, 1, 0, 0, 4, 1, wedge)},
                {strata::Rule::kErosional, strata::Rule::kConformable});
    const ComplexView view = made.complex;
    std::size_t ends = 0;
    made.for_each(
        [&](const BedPolygon& polygon, const std::array<double, 3>& at, std::size_t corner) {
            const bool is_wall = view.face_surface[static_cast<std::size_t>(polygon.face)] == kWall;
            if (at[0] != 1.0) return;
            ++ends;
            const bool is_top = view.face_surface[static_cast<std::size_t>(polygon.face)] == 1;
            EXPECT_FLOAT_EQ(made.bedding.height[corner], is_wall ? 0.5F : is_top ? 1.0F : 0.0F);
            EXPECT_EQ(made.bedding.thickness[corner], 0.0F);
        });
    EXPECT_GT(ends, 4);
}

TEST(BeddingTest, TheSameForAnyNumberOfThreads) {
    const auto wave = [](double x, double y) { return std::sin(x) + std::cos(y); };
    const auto other = [](double x, double y) { return std::cos(x * y); };
    const std::vector<OwnedSurface> surfaces{strata::grid(30, 30, 0, 0, 9, 9, wave),
                                             strata::grid(25, 31, 0, 0, 9, 9, other, true)};
    const Made one = made_of(surfaces, {}, -3.0, 1), three = made_of(surfaces, {}, -3.0, 3);
    EXPECT_TRUE(std::ranges::equal(one.bedding.height, three.bedding.height));
    EXPECT_TRUE(std::ranges::equal(one.bedding.thickness, three.bedding.thickness));
    EXPECT_TRUE(std::ranges::equal(one.bedding.depth, three.bedding.depth));
}

TEST(BeddingTest, SheetsThatShareTheirPlanAreAsSheetsByThemselves) {
    const auto wave = [](double z) {
        return [z](double x, double y) { return z + std::sin(x) * std::cos(y); };
    };
    std::vector<OwnedSurface> surfaces{strata::grid(9, 7, 0, 0, 9, 7, wave(0)),
                                       strata::grid(9, 7, 0, 0, 9, 7, wave(2)),
                                       strata::grid(9, 7, 0, 0, 9, 7, wave(3))};
    const Made made = made_of(surfaces);
    History apart;
    for (std::size_t n = 0; n < surfaces.size(); ++n) {
        for (std::size_t more = 0; more < n; ++more)
            surfaces[n].vertex(0, 0, 0);  // of no triangle
        apart.sheets.push_back(surfaces[n].view());
    }
    const Bedding found = bedding_of(made.complex, {&apart, 1}, made.polygons, {}, {2});
    EXPECT_TRUE(std::ranges::equal(found.height, made.bedding.height));
    EXPECT_TRUE(std::ranges::equal(found.thickness, made.bedding.thickness));
    EXPECT_TRUE(std::ranges::equal(found.depth, made.bedding.depth));
}

TEST(BeddingTest, NumbersOutOfRangeAreRefused) {
    const Made made =
        made_of({strata::grid(1, 1, 0, 0, 1, 1, [](double, double) { return 1.0; })}, {}, 0.0);
    const History history;
    for (const BedPolygon& bad : {BedPolygon{-1, false, 0, -1}, BedPolygon{0, false, 1, -1},
                                  BedPolygon{0, false, 0, 0}, BedPolygon{9999, false, 0, -1}}) {
        EXPECT_THROW(bedding_of(made.complex, {&history, 1}, {&bad, 1}, {}, {1}), InputError);
    }
    const BedPolygon good{0, false, 0, -1};
    const std::vector<std::int32_t> few{0}, wrong{0, 0, 1};
    for (const auto& histories : {few, wrong}) {
        EXPECT_THROW(bedding_of(made.complex, {&history, 1}, {&good, 1}, histories, {1}),
                     InputError);
    }
}

}  // namespace
}  // namespace realmodel::bedding
