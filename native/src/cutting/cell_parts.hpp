// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "base/disjoint_sets.hpp"
#include "cutting/cutter_sides.hpp"
#include "cutting/pieces.hpp"

namespace realmodel::cutting {

/// The parts that a cutter divides cells into, and the polygons around them: a face's regions that
/// nothing of the cutter lies between, joined again, and for each region of the cutter a cut face
/// for whatever it goes through. A part has all that bounds its cell on one side, and as many cut
/// faces as the cell's boundary goes round them: so every part is closed, whatever rounding made of
/// the cell. Parts that are not wanted are left out; parts that the cutter does not separate are
/// one.
class CellParts {
public:
    CellParts(CutterOverlay& overlay, const CutterWinding& winding, const PartSides& sides,
              Progress* progress);

    CutPieces pieces;
    std::vector<HalfCell> half_cells;
    /// Of cells below and above: whether some use an edge more than twice.
    std::array<bool, 2> touches{false, false};

private:
    /// What bounds a part: a face piece of a face, a whole face, or a cut face, as its cell sees
    /// it.
    struct HalfFace {
        std::int32_t cell;
        std::int8_t half;
        /// 1: turns counter-clockwise seen from outside of the cell, -1 does not.
        std::int8_t sign;
        std::int32_t source;  ///< its face piece; of cut faces -1 - their number
    };
    /// What the faces of a chunk are divided into, by the numbers of face pieces in it.
    struct DividedFaces {
        std::vector<std::int32_t> face;  ///< of face pieces
        arrangement::LoopTable<NodeId> loops;
        std::vector<std::int32_t> beside;  ///< of the edges of all loops: the region
        std::vector<std::int32_t> regions;
        std::vector<std::size_t> region_begins{0};

        std::span<const std::int32_t> regions_of(std::size_t face_piece) const {
            return {regions.data() + region_begins[face_piece],
                    regions.data() + region_begins[face_piece + 1]};
        }
    };
    class FaceDivider;
    /// Regions of one face that no edge of the cutter lies between; or a whole face, which has no
    /// regions.
    struct FacePiece {
        std::int32_t face;
        std::int8_t half;
        const DividedFaces* divided = nullptr;  ///< nullptr: the whole face
        std::size_t number = 0;                 ///< in `divided`
        std::array<std::int32_t, 2> half_faces{-1, -1};

        Loops<NodeId> loops() const { return divided->loops[number]; }
        std::span<const std::int32_t> regions() const { return divided->regions_of(number); }
    };
    /// The half-faces of one region of the cutter, or of a component of undivided triangles: what
    /// is below it, then what is above.
    struct CutFaces {
        std::int32_t region;     ///< of a component that at its first border
        std::int32_t component;  ///< -1: the region alone
        std::array<std::vector<std::int32_t>, 2> half_faces;
        /// Half-faces with the region between them, -1 nothing wanted: of cells that lie one below
        /// and one above it, and pairs of cells that overlap on one side, of which one is there as
        /// often too much as the other too little.
        std::vector<std::array<std::int32_t, 2>> pairs_through, pairs_on_one_side;
    };
    /// What is one polygon, or several, between the half-faces of cut faces: their region, or one
    /// of the undivided triangles.
    struct CutFacet {
        std::size_t cut_faces;
        std::int32_t triangle;  ///< -1: the region
    };
    /// A half-face at one of its edges.
    struct HalfFaceUse {
        std::int32_t cell;
        std::int8_t half;
        EdgeUse use;
        std::int32_t half_face;
        bool operator<(const HalfFaceUse& other) const {
            if (key() != other.key()) return key() < other.key();
            if (use < other.use) return true;
            return !(other.use < use) && half_face < other.half_face;
        }
        /// The edge, and the half of a cell.
        std::pair<std::uint64_t, std::uint64_t> key() const {
            return {use.key(), packed_pair(cell, half + 1)};
        }
    };

    void make_face_pieces(Progress* progress);
    void make_cut_faces();
    void add_cut_faces(std::int32_t region, std::int32_t component);
    void add_cut_faces_of_undivided(std::int32_t triangle, std::vector<std::int32_t>& cut_faces_of);
    template <class Visit>
    void visit_cut_face_loops(const CutFaces& cut_faces, const Visit& visit) const;
    void divide(const CutFacet& facet, Polygons& polygons);
    void leave_out(std::size_t face);
    void add_face_piece(FacePiece face_piece);
    std::int32_t add_half_face(std::int32_t cell, std::int8_t half, std::int8_t sign,
                               std::int32_t source);
    template <class Visit>
    void for_each_use(const FacePiece& face_piece, const Visit& visit) const;
    template <class Visit>
    void for_each_use(const CutFaces& cut_faces, const Visit& visit) const;
    void collect_uses(Progress* progress);
    void pair_cut_faces(CutFaces& cut_faces);
    void join_parts(Progress* progress);
    void join_unseparated();
    void join_round_edge(std::span<const HalfFaceUse> uses);
    void attach_hollows(Progress* progress);
    void number_parts();
    void write_face_pieces(Progress* progress);
    void write_cut_faces(Progress* progress);
    void divide(const FacePiece& face_piece, Polygons& polygons);
    void write(const Polygons& polygons, bool reversed, std::int32_t face,
               std::array<std::int32_t, 2> half_faces, bool on_cutter);
    void find_touches(Progress* progress);

    CutterOverlay& overlay_;
    const CutterWinding& winding_;
    const PartSides& sides_;
    std::vector<HalfFace> half_faces_;
    std::vector<DividedFaces> divided_;  ///< of chunks of active faces
    std::vector<FacePiece> face_pieces_;
    std::vector<CutFaces> cut_faces_;
    std::vector<CutFacet> cut_facets_;  ///< in the order of the cutter's triangles
    /// By the lesser nodes of edges, in order: those of one edge, cell and half side by side.
    Buckets<HalfFaceUse> uses_;
    std::optional<DisjointSets> joined_;  ///< half-faces of the same part
    std::vector<std::int32_t> part_;      ///< of half-faces
    bool has_joined_cells_ = false;       ///< some parts are of several cells
    std::vector<std::uint8_t> loses_;     ///< of the model's cells: a part of it is left out
};

/// The region that some of the overlay's loops bound, in convex polygons (`is_wall`: one polygon if
/// it has one outline), which are added. `normal` is that of the face or triangle they lie on.
/// False where they cross each other as seen along it: rounding has bent the face over itself.
bool divide_loops(CutterOverlay& overlay, const Position& normal, const Loops<NodeId>& loops,
                  bool is_wall, Polygons& polygons);

}  // namespace realmodel::cutting
