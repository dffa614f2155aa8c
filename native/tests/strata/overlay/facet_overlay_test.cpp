// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/facet_overlay.hpp"

#include "../scene.hpp"

namespace realmodel::strata {
namespace {

/// The envelope and the construction after a surface was laid under another one.
struct Columns {
    Construction made;
    Envelope envelope;

    Columns(const OwnedSurface& lower, const OwnedSurface& upper) {
        Scene scene({lower, upper});
        const SurfaceTiling facets = scene.tiling(1), surface = scene.tiling(0);
        envelope = overlay_columns(scene.geometry(), initial_envelope(facets, 1), {surface, 0},
                                   made, nullptr, {1, nullptr});
    }
    std::vector<std::int32_t> blocks_beneath() const {
        std::vector<std::int32_t> blocks;
        for (std::size_t f = 0; f < envelope.size(); ++f) {
            if (envelope.plane[f].has_value()) blocks.push_back(envelope.block_beneath[f]);
        }
        std::sort(blocks.begin(), blocks.end());
        return blocks;
    }
};

TEST(FacetOverlay, ClosesAColumnUnderEachFacet) {
    const Columns c(square(0), square(1));
    EXPECT_EQ(c.made.node_block, (Array<std::int32_t>{1, 1}));
    EXPECT_EQ(c.made.node_is_thick, (Array<std::uint8_t>{1, 1}));
    ASSERT_EQ(c.made.faces.size(), 2u);
    for (std::size_t f = 0; f < 2; ++f) {
        EXPECT_EQ(c.made.faces.above[f], kOutsideCell);
        EXPECT_EQ(c.made.faces.below[f], static_cast<std::int32_t>(f));
        EXPECT_EQ(c.made.faces.surface[f], 1);
    }
    // the surface is the envelope now, each of its triangles a facet with one face
    EXPECT_EQ(c.blocks_beneath(), (std::vector<std::int32_t>{0, 0}));
}

TEST(FacetOverlay, AFacetOverTwoTrianglesIsOneColumnWithTwoFacesBeneath) {
    const Columns c(square(0, 0, true), one_triangle(1, 1, 1));
    EXPECT_EQ(c.made.node_block.size(), 1u);
    EXPECT_EQ(c.made.faces.size(), 1u);
    std::size_t faces = 0;
    for (std::size_t f = 0; f < c.envelope.size(); ++f) {
        const auto [begin, end] = c.envelope.faces_of(f);
        for (std::size_t face = begin; face < end; ++face)
            faces += c.envelope.face_above[face] == 0 ? 1 : 0;
    }
    EXPECT_GE(faces, 1u);
}

TEST(FacetOverlay, WhatWasErodedLeavesTheFacetOverItsBlock) {
    const Columns c(square(1), square(0));
    EXPECT_TRUE(c.made.node_block.empty());
    EXPECT_TRUE(c.made.faces.size() == 0);
    EXPECT_EQ(c.blocks_beneath(), (std::vector<std::int32_t>{0, 0}));
    for (std::size_t f = 0; f < c.envelope.size(); ++f) {
        EXPECT_EQ(c.envelope.surface[f], c.envelope.plane[f].has_value() ? 1 : -1);
    }
}

TEST(FacetOverlay, WhereSurfacesCrossBothAreDivided) {
    const Columns c(square(0, 1), square(0.5));
    EXPECT_FALSE(c.made.node_block.empty());
    for (const std::int32_t block : c.made.node_block)
        EXPECT_EQ(block, 1);
    // columns that end in an edge are not thick
    for (const std::uint8_t thick : c.made.node_is_thick)
        EXPECT_EQ(thick, 0);
    std::array<int, 2> facets{0, 0};  // of the younger and the older one
    for (std::size_t f = 0; f < c.envelope.size(); ++f) {
        if (c.envelope.plane[f].has_value()) ++facets[c.envelope.surface[f] == 1 ? 0 : 1];
    }
    EXPECT_GT(facets[0], 0);
    EXPECT_GT(facets[1], 0);
}

TEST(FacetOverlay, ManyFacetsAreJoinedInOrderOfChunks) {
    // more facets than fit into one chunk
    const auto height = [](double z) { return [z](double, double) { return z; }; };
    const Columns c(grid(40, 40, 0, 0, 1, 1, height(0)), grid(40, 40, 0, 0, 1, 1, height(1)));
    ASSERT_EQ(c.made.node_block.size(), 3200u);
    ASSERT_EQ(c.made.faces.size(), 3200u);
    for (std::size_t f = 0; f < 3200; ++f)
        EXPECT_EQ(c.made.faces.below[f], static_cast<std::int32_t>(f));
}

TEST(FacetOverlay, FinishClosesBlockZeroDownToTheBase) {
    Scene scene({square(1)});
    Construction made;
    const Envelope envelope = initial_envelope(scene.tiling(0), 0);
    EXPECT_EQ(lowest_position(scene.geometry(), envelope)[2], 1.0);
    finish(envelope, PlaneId{0}, true, made);
    EXPECT_EQ(made.node_block, (Array<std::int32_t>{0, 0}));
    EXPECT_EQ(made.faces.size(), 4u);  // a base and a top for each
    made = {};
    finish(envelope, std::nullopt, false, made);
    EXPECT_EQ(made.faces.size(), 0u);  // nothing on either side
}

}  // namespace
}  // namespace realmodel::strata
