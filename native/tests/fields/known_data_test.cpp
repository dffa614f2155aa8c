// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields/known_data.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "realmodel/base/errors.hpp"

namespace realmodel::fields {
namespace {

constexpr Lattice kBox{{0, 0, 0}, {10, 10, 10}, {11, 11, 11}};

/// Two level surfaces at z = 40 and 60, each with four contacts, and dips that point up.
struct Beds {
    std::vector<std::array<double, 3>> contacts{{10, 10, 40}, {90, 10, 40}, {10, 90, 40},
                                                {90, 90, 40}, {10, 10, 60}, {90, 10, 60},
                                                {10, 90, 60}, {90, 90, 60}};
    std::vector<std::int32_t> surfaces{0, 0, 0, 0, 1, 1, 1, 1};
    std::vector<std::array<double, 3>> dips{{20, 50, 50}, {40, 50, 50}, {60, 50, 50}, {80, 50, 50}};
    std::vector<std::array<double, 3>> normals{4, {0, 0, 1}};

    FieldData data() const {
        FieldData out;
        out.surfaces = 2;
        out.contacts = contacts;
        out.contact_surfaces = surfaces;
        out.dips = dips;
        out.normals = normals;
        return out;
    }
    KnownData known() const { return {kBox, data()}; }
};

std::string refusal(const Beds& beds) {
    try {
        beds.known();
        return {};
    } catch (const InputError& e) {
        return e.kind;
    }
}

TEST(KnownData, TheLatticesBoxIsAboutTheOriginAndHalfOfItsDiagonalIsOne) {
    const Beds beds;
    const KnownData known = beds.known();
    const double half = 50 * std::sqrt(3.0);
    EXPECT_DOUBLE_EQ(known.frame().unit, half);
    EXPECT_DOUBLE_EQ(known.contacts()[0][0], -40 / half);
    EXPECT_DOUBLE_EQ(known.contacts()[7][2], 10 / half);
    EXPECT_DOUBLE_EQ(known.half_spacing(), 5 / half);
    EXPECT_NEAR(known.total_gap(), 20 / half, 0.3 * 20 / half);
}

TEST(KnownData, EachSurfaceHasAReferenceOfItsOwn) {
    const Beds beds;
    const KnownData known = beds.known();
    for (const std::int32_t surface : {0, 1})
        EXPECT_EQ(known.surface_of(known.reference(surface)), surface);
}

TEST(KnownData, ADipHasTwoDirectionsInItsPlane) {
    Beds beds;
    const std::size_t with = beds.known().fixed({}).size();
    beds.dips.pop_back();
    beds.normals.pop_back();
    EXPECT_EQ(with, beds.known().fixed({}).size() + 2);
}

TEST(KnownData, LevelsRiseAndPolaritiesAreInequalities) {
    const Beds beds;
    std::size_t orders = 0, polarities = 0;
    for (const Inequality& inequality : beds.known().inequalities()) {
        orders += inequality.kind == Inequality::Origin::kOrder ? 1 : 0;
        polarities += inequality.kind == Inequality::Origin::kPolarity ? 1 : 0;
    }
    EXPECT_EQ(orders, 1U);
    EXPECT_EQ(polarities, 4U);
}

TEST(KnownData, RefusesDataOutsideAndSurfacesWithoutContacts) {
    Beds outside;
    outside.contacts[3][2] = 101;
    EXPECT_EQ(refusal(outside), "outside");
    Beds none;
    none.surfaces.assign(8, 0);
    EXPECT_EQ(refusal(none), "no_contacts");
}

TEST(Neighbors, OfEachSurfaceOneContactIsKeptInEachCube) {
    Beds beds;
    const std::size_t count = beds.contacts.size();
    for (std::size_t n = 0; n < count; ++n) {
        const auto [x, y, z] = beds.contacts[n];
        beds.contacts.push_back({x + 5, y, z});
        beds.surfaces.push_back(beds.surfaces[n]);
    }
    const KnownData known = beds.known();
    EXPECT_EQ(thinned(known, 16).size(), 16U);
    const auto some = thinned(known, 8);
    EXPECT_EQ(some.size(), 8U);
    EXPECT_EQ(std::ranges::count_if(some, [&](std::size_t n) { return known.surface_of(n) == 0; }),
              4);
    EXPECT_NE(cube_of(known, 0, 4), cube_of(known, 4, 4));  // of other surfaces, in one place
}

TEST(Neighbors, SurfacesAreAsFarApartAsTheirContacts) {
    const Beds beds;
    const KnownData known = beds.known();
    const auto apart = distances_between(known, 100);
    ASSERT_EQ(apart.size(), 1U);
    EXPECT_NEAR(apart[0], 20 / known.frame().unit, 1e-12);
}

TEST(Neighbors, PairsAreContactsOfOneSurfaceWithoutItsReference) {
    const Beds beds;
    const KnownData known = beds.known();
    const auto pairs = spread_pairs(known, 100);
    EXPECT_EQ(pairs.size(), 6U);
    for (const std::size_t n : pairs)
        EXPECT_NE(n, known.reference(known.surface_of(n)));
}

TEST(Neighbors, ADipThatIsUpsideDownAmongOthersIsAgainstThem) {
    Beds beds;
    EXPECT_FALSE(is_against_neighbors(beds.known(), 1));
    beds.normals[1] = {0, 0, -1};
    EXPECT_TRUE(is_against_neighbors(beds.known(), 1));
    EXPECT_FALSE(is_against_neighbors(beds.known(), 0));
}

}  // namespace
}  // namespace realmodel::fields
