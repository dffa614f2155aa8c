// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "arrangement/triangle_arrangement.hpp"
#include "booleans/triangle_pieces.hpp"
#include "exact/orientation.hpp"

namespace realmodel::booleans {

/// Pieces that meet elsewhere than in corners and edges that they share, and their exact division
/// along one another.
class ExactDivision {
public:
    /// @param chosen  pieces, among them all that may meet fresh ones
    ExactDivision(TrianglePieces& pieces, std::vector<PieceId>&& chosen,
                  const Execution& execution);

    using Meeting = arrangement::TriangleArrangement::TriangleIntersection;
    /// Where fresh pieces meet others out of order. Finds them; pieces without area are dropped.
    const std::vector<Meeting>& meetings() const { return meetings_; }
    const PieceId& piece(std::int32_t triangle) const {
        return chosen_[index(piece_of_[index(triangle)])];
    }

    /// Whether triangles meet in one plane, or along a segment that doubles can give.
    bool is_in_doubles(const Meeting& met) {
        return met.in_one_plane || std::all_of(met.ends.begin(), met.ends.end(), [&](auto& end) {
                   return pieces_.points.is_double(arrangement_.point_of(end));
               });
    }

    /// Divides the pieces at some of the meetings, and rounds the new points. Pieces with such a
    /// corner are fresh.
    void divide(const std::vector<Meeting>& at);

private:
    /// A piece as its neighbors are found.
    struct CandidatePiece {
        TriangleCorners corners;
        /// Along which axes it is certain to turn left (bits 0, 2, 4) or right (1, 3, 5).
        std::uint8_t turns;
        bool is_fresh;
    };
    std::vector<std::uint8_t> flat_stars(std::span<const CandidatePiece> items) const;
    void find_candidates();
    bool is_aside(const TriangleCorners& triangle, const TriangleCorners& other,
                  const exact::SideFilter& plane_of_other) const;
    void find_meetings();
    bool is_contact(const Meeting& met) const;
    bool meet_in_plane(std::int32_t one, std::int32_t other) const;
    std::vector<TriangleCorners> divided(const arrangement::Region& region) const;
    /// Which region a region coincides with: itself where it is the first, -1 of a triangle.
    struct Copy {
        std::int32_t of = -1;
        bool is_reversed = false;  ///< whether the two are seen from different sides
    };
    std::vector<Copy> coinciding_regions() const;
    std::vector<std::vector<TrianglePiece>> pieces_of_triangles();
    void divide_regions();

    TrianglePieces& pieces_;
    std::vector<PieceId> chosen_;
    Execution execution_;
    std::vector<std::array<std::int32_t, 2>> candidates_;  ///< first chosen pieces, then triangles
    arrangement::TriangleArrangement arrangement_;
    std::vector<std::int32_t> piece_of_;  ///< of triangles of the arrangement: the chosen piece
    std::vector<Meeting> meetings_;
};

}  // namespace realmodel::booleans
