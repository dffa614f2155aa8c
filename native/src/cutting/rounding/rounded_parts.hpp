// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cassert>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "cutting/far_faces.hpp"
#include "cutting/pieces.hpp"
#include "cutting/positions.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"

namespace realmodel::cutting {

/// Exact parts of cells whose nodes were rounded to doubles: what the passes of part_rounding.hpp
/// work on, one after another.
struct RoundedParts {
    /// @param positions   of nodes after the model's vertices; they may move
    /// @param of_several  whether the cells are of several models, of which each was rounded by
    ///                    itself
    /// @param far         faces that were left out of the model
    RoundedParts(const ComplexView& of, std::vector<Position>& positions, CutPieces& polygons,
                 std::vector<HalfCell>& cells, bool of_several, const Execution& executed,
                 const FarFaces& far = kNoFarFaces);

    bool is_new(NodeId node) const { return index(node) >= vertices.size(); }
    const Position& at(NodeId node) const {
        return is_new(node) ? new_positions[index(node) - vertices.size()] : vertices[index(node)];
    }
    Position& moving(NodeId node) {
        assert(is_new(node));
        return new_positions[index(node) - vertices.size()];
    }
    /// A new node at a position, or beside it where there is one already.
    NodeId add_node(Position p, Freedom freedom);
    /// How a node may move that is where some others are: on all of their faces.
    Freedom freedom_of(std::span<const NodeId> nodes) const;

    /// Whether a part is less than the model's cell, which was sound.
    bool is_changed(std::int32_t part) const {
        const HalfCell& own = half_cells[index(part)];
        return own.is_changed || parts_of_[index(own.cell)] > 1;
    }
    /// The model's surface that a piece is of, `none` if it is no part of a face.
    std::int32_t surface_of(std::size_t piece, std::int32_t none) const {
        const std::int32_t face = pieces[piece].face;
        return face < 0 ? none : model.face_surface[index(face)];
    }
    /// Whether a piece is a wall, or may become one: between joined models any cap may.
    bool may_be_wall(std::size_t piece) const {
        return surface_of(piece, are_joined ? kWall : kCutFace) == kWall;
    }
    /// Whether such a piece has no extent in plan.
    bool is_upright(std::size_t piece) const;
    /// Whether a piece is a face of the model as it was.
    bool is_whole_face(std::size_t piece) const;

    // What holds for all parts, for assertions: they take long.
    /// Whether each uses its edges as often in one direction as in the other.
    bool are_closed() const;
    /// Whether no two nodes of polygons are in one position.
    bool are_apart() const;

    /// Finds the arrays below anew, for other pieces or nodes.
    void update();
    void replace_pieces(CutPieces&& with) {
        pieces = std::move(with);
        update();
    }

    const ComplexView& model;
    std::vector<Position>& new_positions;
    CutPieces& pieces;
    std::vector<HalfCell>& half_cells;
    bool are_joined;
    Execution execution;

    /// Of parts: whether faces were left out, so that they have an extent.
    std::vector<std::uint8_t> has_far_faces;
    std::vector<Position> vertices;              ///< of the model, as `at` gives them
    std::vector<std::uint8_t> on_base, on_wall;  ///< of nodes
    std::vector<std::uint8_t> is_near;           ///< of nodes: of what the cutter has changed
    Buckets<std::int32_t> pieces_of;             ///< the pieces around each part
    Positions taken;  ///< of nodes, from set_apart() on; of the vertices those near new nodes

private:
    std::vector<std::uint8_t> parts_of_;  ///< of the model's cells: how many, 2 for more
    bool has_taken_all_ = false;          ///< the positions of all of the model's vertices
};

}  // namespace realmodel::cutting
