// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/structures/structures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "../../cuda/offload.hpp"
#include "../strata/complex_checks.hpp"
#include "cutting/pieces.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::structures {
namespace {

using strata::box;
using strata::CellComplex;
using strata::grid;
using strata::OwnedSurface;

TriangleView view(const OwnedSurface& s) {
    return {s.vertices, s.triangles};
}

/// Layers over the square from (0, 0) to (4, 4), each given by the height of its top.
CellComplex layers(const std::vector<double>& heights, int n = 4) {
    std::vector<OwnedSurface> surfaces;
    for (const double z : heights)
        surfaces.push_back(grid(n, n, 0, 0, 4, 4, [z](double, double) { return z; }));
    return strata::build(surfaces);
}

/// A view of a model that counts structures after its surfaces.
ComplexView with(const CellComplex& model, std::size_t structures) {
    ComplexView all = model;
    all.blocks += structures;
    return all;
}

/// The rectangle x = at + slant z, y from south to north, z from low to high.
OwnedSurface sheet(double at, double slant, double south = -9, double north = 9, double low = -9,
                   double high = 9) {
    OwnedSurface s;
    for (const double z : {low, high}) {
        for (const double y : {south, north})
            s.vertex(at + slant * z, y, z);
    }
    s.triangle(0, 1, 3);
    s.triangle(0, 3, 2);
    return s;
}

Structure fault(const OwnedSurface& s) {
    return {view(s), false, {}, false};
}
Structure body(const OwnedSurface& s) {
    return {view(s), true, {}, false};
}

/// @param coordinates  of points, one after another
std::vector<std::int8_t> sides_of_points(std::span<const Structure> structures,
                                         std::span<const double> coordinates,
                                         const Execution& execution) {
    std::vector<std::array<double, 3>> points;
    for (std::size_t i = 0; i < coordinates.size(); i += 3)
        points.push_back({coordinates[i], coordinates[i + 1], coordinates[i + 2]});
    return PreparedStructure(structures).sides(points, execution);
}

std::vector<Sides> sides_of(const std::vector<Compartment>& parts) {
    std::vector<Sides> sides;
    for (const Compartment& part : parts)
        sides.push_back(part.sides);
    return sides;
}

std::size_t faces_on(const CellComplex& c, std::int32_t cutter) {
    return static_cast<std::size_t>(std::ranges::count(c.face_surface, cutter));
}

Joined joined(std::span<const CompartmentModel> models, std::span<const Structure> structures,
              std::span<const std::uint8_t> acts) {
    Joined one = join_models(models, structures, acts, {1, nullptr});
    strata::expect_valid(one.complex, false);
    cuda::Offload<cuda::CpuBackend> device("", std::make_unique<cuda::CpuBackend>());
    for (const Execution& execution : {Execution{3}, Execution{1, nullptr, &device.device()}}) {
        const Joined two = join_models(models, structures, acts, execution);
        EXPECT_TRUE(std::ranges::equal(one.complex.vertices, two.complex.vertices));
        EXPECT_TRUE(std::ranges::equal(one.complex.face_vertices, two.complex.face_vertices));
        EXPECT_TRUE(std::ranges::equal(one.complex.face_cells, two.complex.face_cells));
    }
    EXPECT_TRUE(device.take_messages().empty());
    return one;
}

std::string refusal(const auto& work) {
    try {
        work();
    } catch (const InputError& error) {
        return error.kind;
    }
    return "";
}

const std::vector<std::uint8_t> kAllAct(64, 1);

/// A box with rock.
const std::array<std::array<double, 3>, 2> kRock{{{0, 0, 0}, {4, 4, 3}}};

TEST(PartsOf, AFaultLeavesTwoBesideIt) {
    const OwnedSurface upright = sheet(1, 0);
    const auto parts = compartments_of(kRock, std::array{fault(upright)}, {1, nullptr});
    ASSERT_EQ(parts.size(), 2U);
    EXPECT_EQ(parts[0].sides, Sides{-1});
    // the box of either part ends at the fault
    EXPECT_EQ(std::max(parts[0].low[0], parts[1].low[0]), 1);
    EXPECT_EQ(std::min(parts[0].high[0], parts[1].high[0]), 1);
}

TEST(PartsOf, FaultsThatCrossLeaveFour) {
    const OwnedSurface one = sheet(1, 0.1);
    OwnedSurface other;
    for (const auto& [x, z] :
         std::array<std::array<double, 2>, 4>{{{-9, -9}, {9, -9}, {9, 9}, {-9, 9}}})
        other.vertex(x, 2 + z / 8, z);
    other.triangle(0, 1, 2);
    other.triangle(0, 2, 3);
    const auto parts = compartments_of(kRock, std::array{fault(one), fault(other)}, {1, nullptr});
    EXPECT_EQ(sides_of(parts), (std::vector<Sides>{{-1, -1}, {-1, 1}, {1, -1}, {1, 1}}));
}

TEST(PartsOf, ABranchEndsAtTheOtherFault) {
    const OwnedSurface trunk = sheet(2, 0.25);
    OwnedSurface branch;  // crosses the trunk; the larger part is where x is great
    for (const auto& [x, z] :
         std::array<std::array<double, 2>, 4>{{{0, -9}, {9, -9}, {9, 9}, {0, 9}}})
        branch.vertex(x, 2 + z / 8, z);
    branch.triangle(0, 1, 2);
    branch.triangle(0, 2, 3);
    Structure ends = fault(branch);
    ends.ends_at = {0};
    const auto parts = compartments_of(kRock, std::array{fault(trunk), ends}, {1, nullptr});
    ASSERT_EQ(parts.size(), 3U);
    EXPECT_EQ(std::ranges::count_if(parts, [](const Compartment& p) { return p.sides[1] == 0; }),
              1);
    const auto whole =
        std::ranges::find_if(parts, [](const Compartment& p) { return p.sides[1] == 0; });
    EXPECT_EQ(whole->low[0], 0);  // what the branch does not reach is on the other side
}

TEST(PartsOf, OneThatMissesTheFaultThatItIsToEndAtIsRefused) {
    const OwnedSurface trunk = sheet(1, 0), far = sheet(3, 0);
    Structure ends = fault(far);
    ends.ends_at = {0};
    EXPECT_EQ(refusal([&] {
                  compartments_of(kRock, std::array{fault(trunk), ends}, {1, nullptr});
              }),
              "does_not_meet");
}

TEST(PartsOf, ABranchMayMeetItsFaultAwayFromTheRock) {
    const OwnedSurface trunk = sheet(90, 0, -99, 99);
    OwnedSurface branch;  // level: what is in the rock ends before the trunk, and is continued
    for (const double x : {-30.0, 50.0, 95.0}) {
        branch.vertex(x, -20, 1.5);
        branch.vertex(x, 20, 1.5);
    }
    for (const int v : {0, 2}) {
        branch.triangle(v, v + 2, v + 3);
        branch.triangle(v, v + 3, v + 1);
    }
    Structure ends = fault(branch);
    ends.ends_at = {0};
    const auto parts = compartments_of(kRock, std::array{fault(trunk), ends}, {1, nullptr});
    const std::int8_t side =
        sides_of_points(std::array{fault(trunk)}, std::array{0.0, 0.0, 0.0}, {1, nullptr})[0];
    EXPECT_EQ(sides_of(parts), (std::vector<Sides>{{side, -1}, {side, 1}}));
}

TEST(PartsOf, ABodyHasAnInside) {
    const OwnedSurface chest = box({1, 1, 1}, {2, 2, 2});
    const auto parts = compartments_of(kRock, std::array{body(chest)}, {1, nullptr});
    ASSERT_EQ(parts.size(), 2U);
    EXPECT_EQ(parts[0].sides, Sides{-1});
    EXPECT_EQ(parts[0].low, (std::array<double, 3>{1, 1, 1}));
    EXPECT_EQ(parts[0].high, (std::array<double, 3>{2, 2, 2}));
}

TEST(PartsOf, ABodyThatIsNotClosedIsRefusedWithThePlace) {
    OwnedSurface chest = box({1, 1, 1}, {2, 2, 2});
    chest.triangles.resize(chest.triangles.size() - 3);
    try {
        compartments_of(kRock, std::array{body(chest)}, {1, nullptr});
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.kind, "not_closed");
        EXPECT_EQ(error.surface, 0);
        ASSERT_TRUE(error.place);
        EXPECT_EQ((*error.place)[1], 2);  // the triangle that was taken away is on y = 2
    }
}

TEST(JoinModels, LayersAreDisplacedAlongAnUprightFault) {
    const CellComplex west = layers({0, 1, 2}), east = layers({0.5, 1.5, 2.5});
    const OwnedSurface upright = sheet(1, 0);
    const std::array structures{fault(upright)};
    const std::int8_t east_side =
        sides_of_points(std::span(structures).first(1), std::array{3.0, 2.0, 1.0}, {1, nullptr})[0];
    const auto west_side = static_cast<std::int8_t>(-east_side);
    const Joined j = joined(std::array<CompartmentModel, 2>{{{with(west, 1), {west_side}},
                                                             {with(east, 1), {east_side}}}},
                            structures, kAllAct);
    EXPECT_DOUBLE_EQ(j.complex.volumes[1], 16);
    EXPECT_DOUBLE_EQ(j.complex.volumes[2], 16);
    EXPECT_GT(faces_on(j.complex, 3), 0U);
    double area = 0;
    for (std::size_t f = 0; f < j.complex.face_surface.size(); ++f) {
        if (j.complex.face_surface[f] != 3) continue;
        std::vector<cutting::Position> corners;
        const ComplexView all = j.complex;
        for (const std::int32_t v : all.face(f))
            corners.push_back(all.vertex(v));
        const auto normal = polygon_normal(corners);
        area += std::abs(normal[0]) / 2;
    }
    EXPECT_NEAR(area, 4 * 2.5, 1e-12);  // from 0 to 2.5 on one side or the other
    for (std::size_t f = 0; f < j.complex.face_cells.size(); ++f) {  // none leads through the fault
        const auto [a, b] = j.complex.face_cells[f];
        if (b >= 0 && j.complex.face_surface[f] != 3) {
            EXPECT_EQ(j.cell_compartment[index(a)], j.cell_compartment[index(b)]);
        }
    }
}

TEST(JoinModels, StructuresMayBeContinuedBefore) {
    const CellComplex west = layers({0, 1, 2}), east = layers({0.5, 1.5, 2.5});
    const OwnedSurface upright = sheet(1, 0, 1, 3, 0.5, 1.5), other = sheet(2.5, 0.1);
    Structure dying = fault(upright);
    dying.dies_out = true;
    const std::array structures{dying, fault(other)};
    const auto side = [&](std::size_t s, double x) {
        return sides_of_points(std::span(structures).subspan(s, 1), std::array{x, 2.0, 1.0},
                               {1, nullptr})[0];
    };
    std::vector<CompartmentModel> models;
    for (const double x : {0.5, 2.0, 3.8})
        models.push_back({with(x > 3 ? east : west, 2), {side(0, x), side(1, x)}});
    const Joined here = joined(models, structures, kAllAct);
    const auto continued = continued_structures(structures, {{{0, 0, 0}, {4, 4, 2.5}}});
    ASSERT_EQ(continued.size(), 2U);
    EXPECT_GT(std::ranges::count(continued[0].is_continuation, 1), 0);
    EXPECT_EQ(std::ranges::count(continued[1].is_continuation, 1), 0);  // it divides the rock
    const Joined there = join_models(models, structures, kAllAct, {1, nullptr}, continued);
    EXPECT_TRUE(std::ranges::equal(here.complex.vertices, there.complex.vertices));
    EXPECT_TRUE(std::ranges::equal(here.complex.face_vertices, there.complex.face_vertices));
    EXPECT_TRUE(std::ranges::equal(here.complex.face_cells, there.complex.face_cells));
    EXPECT_EQ(here.cell_compartment, there.cell_compartment);
}

TEST(ContinuedStructures, ABranchHasTheSideOnWhichItRemains) {
    const OwnedSurface main = sheet(2, 0);
    OwnedSurface branch;  // level, most of it west of the other one
    for (const double y : {-9.0, 9.0}) {
        for (const double x : {-9.0, 3.0})
            branch.vertex(x, y, 1);
    }
    branch.triangle(0, 1, 3);
    branch.triangle(0, 3, 2);
    Structure ends = fault(branch);
    ends.ends_at = {0};
    const std::array structures{fault(main), ends};
    const auto continued = continued_structures(structures, {{{0, 0, 0}, {4, 4, 2}}});
    EXPECT_TRUE(continued[0].end_sides.empty());
    const std::int8_t west =
        sides_of_points(std::span(structures).first(1), std::array{0.5, 2.0, 1.0}, {1, nullptr})[0];
    EXPECT_EQ(continued[1].end_sides, (std::vector<std::int8_t>{west}));
}

TEST(JoinModels, WhatLiesBetweenTwoCellsOnAFaultIsNotDividedFromItsMiddle) {
    const CellComplex west = layers({0, 1, 2}, 1), east = layers({0.5, 1.5, 2.5}, 1);
    const OwnedSurface inclined = sheet(1, 0.25);
    const std::array structures{fault(inclined)};
    const Joined j =
        joined(std::array<CompartmentModel, 2>{{{with(west, 1), {1}}, {with(east, 1), {-1}}}},
               structures, kAllAct);
    // every corner of such a face is on an edge of one of the two models
    const ComplexView all = j.complex;
    std::set<std::int32_t> on_fault, elsewhere;  // vertices
    for (std::size_t f = 0; f < all.face_count(); ++f) {
        const auto face = all.face(f);
        (all.face_surface[f] == 3 ? on_fault : elsewhere).insert(face.begin(), face.end());
    }
    EXPECT_GT(on_fault.size(), 8U);
    EXPECT_TRUE(std::ranges::includes(elsewhere, on_fault));
}

TEST(JoinModels, AReverseFaultHasASurfaceTwiceAtOnePlace) {
    const CellComplex low = layers({0, 1}), high = layers({1.5, 2.5});
    const OwnedSurface inclined = sheet(0.5, 1);  // 45 degrees
    const std::array structures{fault(inclined)};
    const std::int8_t above =
        sides_of_points(std::span(structures).first(1), std::array{0.0, 2.0, 2.0}, {1, nullptr})[0];
    EXPECT_EQ(above, 1);
    const Joined j =
        joined(std::array<CompartmentModel, 2>{{{with(high, 1), {1}}, {with(low, 1), {-1}}}},
               structures, kAllAct);
    // above the fault, x < 0.5 + z, between 1.5 and 2.5; below it, x > 0.5 + z, between 0 and 1
    EXPECT_NEAR(j.complex.volumes[1], 4 * (2.5 + 3), 1e-12);
}

TEST(JoinModels, AFaultLeavesRockThatIsYoungerAlone) {
    const CellComplex west = layers({0, 1, 3}), east = layers({0, 2, 3});
    const OwnedSurface inclined = sheet(1.3, 0.3);
    const std::array structures{fault(inclined)};
    std::vector<std::uint8_t> acts{1, 1, 0, 0};  // on the two older blocks
    const Joined j =
        joined(std::array<CompartmentModel, 2>{{{with(west, 1), {1}}, {with(east, 1), {-1}}}},
               structures, acts);
    const ComplexView all = j.complex;
    for (std::size_t f = 0; f < all.face_count(); ++f) {
        if (all.face_surface[f] != 3) continue;
        EXPECT_TRUE(all.block(all.cell(f, 0)) < 2 || all.block(all.cell(f, 1)) < 2);
    }
    // the cells of the youngest block are whole: as many as triangles above it
    EXPECT_EQ(std::ranges::count(all.cell_block, 2), 32);
}

TEST(JoinModels, AFaultThatEndsInRockThatDiffersIsRefusedWithThePlace) {
    const CellComplex west = layers({0, 1, 3}), east = layers({0, 2, 3});
    const OwnedSurface half = sheet(1.3, 0.3, -9, 2);
    for (const bool dies_out : {false, true}) {
        Structure ends = fault(half);
        ends.dies_out = dies_out;
        try {
            join_models(
                std::array<CompartmentModel, 2>{{{with(west, 1), {1}}, {with(east, 1), {-1}}}},
                std::array{ends}, kAllAct, {1, nullptr});
            FAIL();
        } catch (const InputError& error) {
            EXPECT_EQ(error.kind, "ends_inside");
            ASSERT_TRUE(error.place);
            EXPECT_GT((*error.place)[1], 2);
        }
    }
}

TEST(JoinModels, AFaultThatEndsInTheRockMustSayThatItDiesOut) {
    const CellComplex rock = layers({0, 1, 3});
    const OwnedSurface half = sheet(1.3, 0.3, -9, 2);
    Structure ends = fault(half);
    const std::array<CompartmentModel, 2> models{{{with(rock, 1), {1}}, {with(rock, 1), {-1}}}};
    EXPECT_EQ(refusal([&] {
                  join_models(models, std::array{ends}, kAllAct, {1, nullptr});
              }),
              "ends_inside");
    ends.dies_out = true;
    EXPECT_NO_THROW(join_models(models, std::array{ends}, kAllAct, {1, nullptr}));
}

TEST(PartsOf, AFaultThatIsContinuedAcrossAnotherIsCrossedAllThrough) {
    const CellComplex rock = layers({0, 3});
    OwnedSurface slanted;  // its northern border leans, and is continued in its plane
    slanted.vertex(-2, -9, -9);
    slanted.vertex(2, -9, 9);
    slanted.vertex(2.5, 3, 9);
    slanted.vertex(-1.5, 1, -9);
    slanted.triangle(0, 1, 2);
    slanted.triangle(0, 2, 3);
    OwnedSurface small;  // ends close around the rock
    for (const auto& [x, z] :
         std::array<std::array<double, 2>, 4>{{{-0.5, -0.5}, {4.5, -0.5}, {4.5, 3.5}, {-0.5, 3.5}}})
        small.vertex(x, 3.5 + x / 16, z);
    small.triangle(0, 1, 2);
    small.triangle(0, 2, 3);
    Structure dies = fault(small);
    dies.dies_out = true;
    EXPECT_EQ(compartments_of(kRock, std::array{fault(slanted), dies}, {1, nullptr}).size(), 4U);
}

TEST(JoinModels, AFaultThatDiesOutIsASlit) {
    // displaced where y < 2 alone
    std::vector<CellComplex> models;
    for (const double throw_ : {0.0, 0.5}) {
        std::vector<OwnedSurface> surfaces;
        for (const double z : {0.0, 1.0}) {
            surfaces.push_back(grid(4, 4, 0, 0, 4, 4, [&](double, double y) {
                return z + throw_ * std::max(0.0, 1 - y);
            }));
        }
        models.push_back(strata::build(surfaces));
    }
    const OwnedSurface half = sheet(2, 0, -9, 2);
    Structure dies = fault(half);
    dies.dies_out = true;
    const Joined j = joined(
        std::array<CompartmentModel, 2>{{{with(models[0], 1), {1}}, {with(models[1], 1), {-1}}}},
        std::array{dies}, kAllAct);
    const ComplexView all = j.complex;
    EXPECT_GT(faces_on(j.complex, 2), 0U);
    for (std::size_t f = 0; f < all.face_count(); ++f) {
        if (all.face_surface[f] != 2) continue;
        for (const std::int32_t v : all.face(f))
            EXPECT_LE(all.vertex(v)[1], 2);
    }
}

TEST(JoinModels, ABodyTakesThePlaceOfRock) {
    const CellComplex rock = layers({0, 1, 2}), inside = layers({-5, 9});
    CellComplex filled = inside;
    for (auto& block : filled.cell_block)
        block = 3;
    const OwnedSurface chest = box({1.25, 1.25, 0.5}, {2.75, 2.75, 1.5});
    const Joined j =
        joined(std::array<CompartmentModel, 2>{{{with(rock, 1), {1}}, {with(filled, 2), {-1}}}},
               std::array{body(chest)}, kAllAct);
    EXPECT_NEAR(j.complex.volumes[3], 2.25, 1e-12);
    EXPECT_NEAR(j.complex.volumes[1], 16 - 1.125, 1e-12);
    EXPECT_NEAR(j.complex.volumes[2], 16 - 1.125, 1e-12);
}

TEST(JoinModels, AVoidBodyLeavesNothing) {
    const CellComplex rock = layers({0, 1, 2});
    const OwnedSurface tunnel = box({1.25, -1, 0.5}, {2.75, 5, 1.5});
    const Joined j = joined(std::array<CompartmentModel, 1>{{{with(rock, 1), {1}}}},
                            std::array{body(tunnel)}, kAllAct);
    EXPECT_NEAR(j.complex.volumes[1], 16 - 3, 1e-12);
    EXPECT_NEAR(j.complex.volumes[2], 16 - 3, 1e-12);
    const ComplexView all = j.complex;
    for (std::size_t f = 0; f < all.face_count(); ++f) {
        if (all.face_surface[f] == 3) {
            EXPECT_EQ(all.cell(f, 1), -1);
        }
    }
}

TEST(SidesOfPoints, AboveAFaultsBorderAreThoseOfWhatIsStraightAboveIt) {
    const OwnedSurface inclined = sheet(0, 1, -9, 9, -1, 1);  // 45 degrees, from x = -1 to 1
    EXPECT_EQ(sides_of_points(std::array{fault(inclined)}, std::array{0.5, 0.0, 3.0, 1.5, 0.0, 3.0},
                              {1, nullptr}),
              (std::vector<std::int8_t>{1, -1}));
}

TEST(SidesOfPoints, AreThoseOfTheNearestTriangle) {
    const OwnedSurface inclined = sheet(0, 1);
    const auto sides =
        sides_of_points(std::array{fault(inclined)},
                        std::array{-1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0}, {1, nullptr});
    EXPECT_EQ(sides, (std::vector<std::int8_t>{1, -1, 1}));  // the last lies on it
    const OwnedSurface chest = box({0, 0, 0}, {1, 1, 1});
    EXPECT_EQ(sides_of_points(std::array{body(chest)}, std::array{0.5, 0.5, 0.5, 0.5, 0.5, 1.5},
                              {2, nullptr}),
              (std::vector<std::int8_t>{-1, 1}));
}

TEST(SidesOfPoints, OfLimbsThatAreNearlyOneTheNearerCounts) {
    for (const double gap : {1e-3, 1e-10, 1e-14}) {
        OwnedSurface fold;  // a level sheet with a limb under it
        for (const auto& [x, y] : {std::array{-9.0, -9.0}, {9.0, -9.0}, {9.0, 9.0}, {-9.0, 9.0}})
            fold.vertex(x, y, 0);
        fold.vertex(0, 9, -gap);
        fold.vertex(0, -9, -gap);
        fold.triangle(0, 1, 2);
        fold.triangle(0, 2, 3);
        fold.triangle(1, 4, 2);
        fold.triangle(1, 5, 4);
        const std::array points{5.0, 0.0, 1.0, 4.0, -3.0, 1.0, 7.0, 5.0, 1.0};
        EXPECT_EQ(sides_of_points(std::array{fault(fold)}, points, {1, nullptr}),
                  (std::vector<std::int8_t>{1, 1, 1}));
    }
}

TEST(SidesOfPoints, BeyondTheFaultThatItEndsAtAFaultGoesOnInItsPlane) {
    const OwnedSurface trunk = sheet(0, 0);                   // x = 0
    const OwnedSurface branch = sheet(0, 1, -9, 9, -9, 0.5);  // x = z, until x = 0.5
    const std::array points{1.0, 0.0, 1.25, 1.0, 0.0, 0.75};
    Structure alone = fault(branch);
    EXPECT_EQ(sides_of_points(std::array{alone}, points, {1, nullptr}),
              (std::vector<std::int8_t>{-1, -1}));  // beside what goes straight up
    Structure ends = fault(branch);
    ends.ends_at = {1};
    EXPECT_EQ(sides_of_points(std::array{ends, fault(trunk)}, points, {1, nullptr}),
              (std::vector<std::int8_t>{1, -1}));
}

TEST(TrianglesBeyond, AreMetWhereAFaultThatDiesOutWouldGoOn) {
    const OwnedSurface upright = sheet(2, 0, -9, 2);  // x = 2 until y = 2
    Structure dying = fault(upright);
    dying.dies_out = true;
    // beside the fault, across its tip, beyond it, and with an edge in its plane beyond it
    const std::vector<double> low{1, 0, 0, 3, 0, 0, 1, 1, 0, 1, 3, 0, 3, 3, 0, 2, 4, 0, 2, 5, 0};
    const std::vector<std::int32_t> triangles{0, 1, 2, 0, 1, 4, 2, 4, 3, 3, 5, 6};
    EXPECT_EQ(triangles_beyond(std::array{dying}, low, low, triangles, {1, nullptr}),
              (std::vector<std::uint8_t>{0, 0, 2, 1}));
    std::vector<double> high = low;
    for (std::size_t v = 0; v < 7; ++v)
        high[3 * v + 2] = 100;  // its upper border is at 9
    EXPECT_EQ(triangles_beyond(std::array{dying}, low, high, triangles, {1, nullptr}),
              (std::vector<std::uint8_t>{2, 2, 2, 1}));
}

TEST(ContinuationOf, ABranchDoesNotComeBackThroughTheFaultThatItEndsAt) {
    const OwnedSurface trunk = sheet(0, 0);  // x = 0
    OwnedSurface branch;                     // level, with a corner beyond that leans over a bay
    const std::array<std::array<double, 2>, 6> places{
        {{-9, -9}, {1, -9}, {1, 0}, {1, 9}, {-9, 9}, {4, 3}}};
    for (const auto& [x, y] : places)
        branch.vertex(x, y, 0);
    for (const auto& [a, b, c] :
         std::array<std::array<std::int32_t, 3>, 4>{{{0, 1, 2}, {0, 2, 4}, {2, 3, 4}, {1, 5, 2}}})
        branch.triangle(a, b, c);
    Structure ends = fault(branch);
    ends.ends_at = {1};
    std::size_t found = 0;
    for (const auto& t :
         continuation_of(std::array{ends, fault(trunk)}, {{{0, 0, -1}, {2, 2, 1}}})) {
        if (std::ranges::count(t, std::array{4.0, 3.0, 0.0}) == 0) continue;
        ++found;
        for (const auto& p : t)
            EXPECT_GT(p[0], 0);
    }
    EXPECT_GE(found, 3U);
}

TEST(ContinuationOf, AFaultThatDiesOutDoesNotCrossItselfWhereItBends) {
    OwnedSurface bent;  // an arc that leans outward: its lower border is longer than the upper one
    constexpr int kSticks = 9;
    for (int i = 0; i < kSticks; ++i) {
        const double turn = (i - 4) * 0.25;
        for (const double z : {1.0, -1.0}) {
            const double radius = 5 + z;
            bent.vertex(radius * std::sin(turn), radius * std::cos(turn), z);
        }
    }
    for (int i = 0; i + 1 < kSticks; ++i) {
        bent.triangle(2 * i, 2 * i + 1, 2 * i + 2);
        bent.triangle(2 * i + 2, 2 * i + 1, 2 * i + 3);
    }
    Structure dying = fault(bent);
    dying.dies_out = true;
    const auto beyond = continuation_of(std::array{dying}, {{{-9, -9, -9}, {9, 9, 9}}});
    EXPECT_GT(beyond.size(), 0U);
    // all that has the mean plane's normal on one side: a function over that plane
    std::vector<std::array<double, 3>> normals;
    for (const auto& t : beyond) {
        const auto a = minus(t[1], t[0]), b = minus(t[2], t[0]);
        normals.push_back(
            {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]});
    }
    for (const auto& n : normals)
        EXPECT_GT(dot(n, normals[0]), 0);
}

/// Of triangles in a plane x = const: the sum of their areas, negative where they turn about.
double area_along_x(const std::vector<std::array<std::array<double, 3>, 3>>& triangles) {
    double sum = 0;
    for (const auto& [a, b, c] : triangles)
        sum += ((b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1])) / 2;
    return sum;
}

TEST(ContinuationOf, ARaggedFaultThatDiesOutIsContinuedOnceEverywhere) {
    OwnedSurface comb;  // teeth that reach different ways, in the plane x = 2
    for (int i = 0; i <= 6; ++i) {
        comb.vertex(2, i, 0);
        comb.vertex(2, i + 0.25 * (i % 3), i % 2 == 0 ? 1 : 4);
    }
    for (std::int32_t i = 0; i < 6; ++i) {
        comb.triangle(2 * i, 2 * i + 2, 2 * i + 1);
        if (i % 3 != 1) comb.triangle(2 * i + 2, 2 * i + 3, 2 * i + 1);
    }
    Structure dying = fault(comb);
    dying.dies_out = true;
    const auto beyond = continuation_of(std::array{dying}, {{{-9, -9, -9}, {9, 9, 9}}});
    std::vector<std::array<std::array<double, 3>, 3>> all = beyond;
    for (std::size_t t = 0; t + 2 < comb.triangles.size(); t += 3) {
        auto& corners = all.emplace_back();
        for (std::size_t i = 0; i < 3; ++i) {
            const auto v = static_cast<std::size_t>(3 * comb.triangles[t + i]);
            corners[i] = {comb.vertices[v], comb.vertices[v + 1], comb.vertices[v + 2]};
        }
    }
    double size = 0;
    std::array<double, 2> low{0, 0}, high{0, 0};
    for (const auto& t : all) {
        size += std::abs(area_along_x({t}));
        for (const auto& p : t) {
            EXPECT_EQ(p[0], 2);
            for (std::size_t k = 0; k < 2; ++k) {
                low[k] = std::min(low[k], p[k + 1]);
                high[k] = std::max(high[k], p[k + 1]);
            }
        }
    }
    const double whole = (high[0] - low[0]) * (high[1] - low[1]);
    EXPECT_NEAR(std::abs(area_along_x(all)), whole, 1e-9 * whole);
    EXPECT_NEAR(size, whole, 1e-9 * whole);
}

TEST(ContinuationOf, PartsOfAFaultThatDiesOutMayNotLieBesideEachOther) {
    OwnedSurface two;
    for (const double x : {0.0, 1.0}) {
        for (const double z : {0.0, 4.0}) {
            two.vertex(x, 3 * x, z);
            two.vertex(x, 3 * x + 5, z);
        }
    }
    for (const std::int32_t first : {0, 4}) {
        two.triangle(first, first + 1, first + 3);
        two.triangle(first, first + 3, first + 2);
    }
    Structure dying = fault(two);
    dying.dies_out = true;
    try {
        compartments_of({{{0, 0, 0}, {4, 4, 4}}}, std::array{dying}, {1, nullptr});
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.kind, "folded");
        EXPECT_EQ(error.surface, 0);
        EXPECT_TRUE(error.place.has_value());
    }
    dying.dies_out = false;
    EXPECT_NO_THROW(continuation_of(std::array{dying}, {{{-9, -9, -9}, {9, 9, 9}}}));
}

}  // namespace
}  // namespace realmodel::structures
