// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "strata/overlay/polygon.hpp"
#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {

inline constexpr std::int32_t kOutsideCell = -1;

/// Faces that are finished: convex plan polygons, each in the plane of a triangle, between two
/// cells.
struct FaceList {
    PolygonPool polygons;
    GrowingArray<PlaneId> plane;
    GrowingArray<std::int32_t> layer;  ///< number of the surface that the face lies on, -1 the base
    GrowingArray<std::int32_t> above;  ///< cell, or kOutsideCell
    GrowingArray<std::int32_t> below;

    std::size_t size() const { return plane.size(); }
    void add(PolygonView polygon, PlaneId in_plane, std::int32_t in_layer, std::int32_t cell_above,
             std::int32_t cell_below) {
        polygons.add(polygon);
        plane.push_back(in_plane);
        layer.push_back(in_layer);
        above.push_back(cell_above);
        below.push_back(cell_below);
    }
    void append(const FaceList& other) {
        polygons.append(other.polygons);
        plane.append(other.plane.begin(), other.plane.end());
        layer.append(other.layer.begin(), other.layer.end());
        above.append(other.above.begin(), other.above.end());
        below.append(other.below.begin(), other.below.end());
    }
};

/// The lower envelope of the surfaces seen so far, youngest first: what survives of them, as convex
/// facets that tile the frame. Each facet lies in one plane and carries the faces that cells above
/// it already have there; they tile the facet.
struct Envelope {
    PolygonPool outlines;
    GrowingArray<PlaneId> plane;         ///< kSky, kOutside, or the plane of a triangle
    GrowingArray<std::int32_t> layer;    ///< surface of the facet, -1 for the sky
    GrowingArray<std::int32_t> pending;  ///< the block beneath: last surface seen here, -1 the sky
    GrowingArray<std::int64_t> face_offsets{0};
    PolygonPool face_polygons;
    GrowingArray<std::int32_t> face_above;  ///< cell above each face, or kOutsideCell

    std::size_t size() const { return plane.size(); }
    void add_facet(PolygonView outline, PlaneId in_plane, std::int32_t in_layer,
                   std::int32_t block_beneath) {
        outlines.add(outline);
        plane.push_back(in_plane);
        layer.push_back(in_layer);
        pending.push_back(block_beneath);
        face_offsets.push_back(face_offsets.back());
    }
    /// Adds a facet of another envelope, with its faces.
    void add_facet_of(const Envelope& other, std::size_t facet, std::int32_t block_beneath) {
        add_facet(other.outlines[facet], other.plane[facet], other.layer[facet], block_beneath);
        for (auto f = other.face_offsets[facet]; f < other.face_offsets[facet + 1]; ++f) {
            const auto i = static_cast<std::size_t>(f);
            add_face(other.face_polygons[i], other.face_above[i]);
        }
    }
    /// Adds all facets of another envelope.
    void append(const Envelope& other) {
        const auto faces_before = face_offsets.back();
        outlines.append(other.outlines);
        plane.append(other.plane.begin(), other.plane.end());
        layer.append(other.layer.begin(), other.layer.end());
        pending.append(other.pending.begin(), other.pending.end());
        for (std::size_t i = 1; i < other.face_offsets.size(); ++i)
            face_offsets.push_back(faces_before + other.face_offsets[i]);
        face_polygons.append(other.face_polygons);
        face_above.append(other.face_above.begin(), other.face_above.end());
    }
    /// Adds a face to the facet added last.
    void add_face(PolygonView polygon, std::int32_t cell_above) {
        face_polygons.add(polygon);
        face_above.push_back(cell_above);
        ++face_offsets.back();
    }
};

/// Cells and faces made so far.
struct Construction {
    FaceList faces;
    GrowingArray<std::int32_t> cell_block;
    /// Of each cell: 1 where its top is above its bottom everywhere, its border included, by far
    /// more than rounding moves heights.
    GrowingArray<std::uint8_t> cell_is_thick;
};

/// The envelope before the first overlay: the youngest surface itself, or the region under the sky.
Envelope initial_envelope(const SurfaceTiling& layer, std::int32_t number);

/// Lays surface `number` under the envelope: where it is lower, a cell is closed between the two
/// and the surface becomes the envelope; elsewhere it was eroded away and the envelope stays.
Envelope overlay(exact::PlanArrangement& geometry, const Envelope& envelope,
                 const SurfaceTiling& layer, std::int32_t number, Construction& construction,
                 int threads, const Progress* progress);

/// Closes what is left: block 0 down to a flat base where there is one, the outside elsewhere.
/// @param is_thick  whether the base is far below all, see Construction
void finish(const Envelope& envelope, std::optional<PlaneId> base, bool is_thick,
            Construction& construction);

}  // namespace realmodel::strata
