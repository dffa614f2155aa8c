// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cassert>
#include <optional>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "base/key_table.hpp"
#include "cutting/near_model.hpp"
#include "cutting/pieces.hpp"
#include "realmodel/base/execution.hpp"
#include "realmodel/complex.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::cutting {

/// Where a point may move to: anywhere, on its height only, or rather up and down than aside.
enum class Freedom { kAny, kLevel, kUpright };

using Positions = KeyNumbers<Position>;

/// A position as near to p as doubles allow that is not taken yet; it is then.
Position free_position_beside(const Position& p, Freedom freedom, Positions& taken);

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
        const HalfCell& half_cell = half_cells[index(part)];
        return half_cell.is_changed || parts_of_[index(half_cell.cell)] > 1;
    }
    /// The model's surface that a piece is of, `none` if it is no part of a face.
    std::int32_t surface_of(std::size_t piece, std::int32_t none) const {
        const std::int32_t face = pieces[piece].face;
        return face < 0 ? none : model.face_surface[index(face)];
    }
    /// Whether a piece is a wall, or may become one: between joined models any cut face may.
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
    /// Of nodes, from separate_coincident_nodes() on; of the vertices those near new nodes.
    Positions taken;

private:
    std::vector<std::uint8_t> parts_of_;  ///< of the model's cells: how many, 2 for more
    bool has_taken_all_ = false;          ///< the positions of all of the model's vertices
};

/// Which way round a loop goes from its least node to the lesser of the two beside that: 1 or -1.
int winding_of(std::span<const NodeId> loop);

/// The nodes of a loop from its least one on, toward the lesser of the two beside that: the same
/// for loops that pass the same edges.
void put_first(std::span<const NodeId> loop, std::vector<NodeId>& nodes);

/// Pieces near the cutter that pass the same edges: groups of two or more.
std::vector<std::vector<std::size_t>> equal_pieces(const RoundedParts& parts);

/// Nodes that become others, and what the parts around them become by it.
class Contraction {
public:
    /// @param may_fold  whether two polygons of a part that are the same but face each other cancel
    Contraction(RoundedParts& parts, bool may_fold);

    /// Of polygons of a part: how often they use an edge beyond twice, how many there are, and
    /// where.
    struct PartShape {
        std::size_t touches = 0, count = 0;
        spatial::Box box;
    };
    /// A polygon of a part as contractions leave it: nodes from `begin` on.
    struct ContractedPolygon {
        std::uint32_t hash;
        std::size_t begin, size;
        int winding;
    };
    /// What shape() uses again.
    struct ShapeScratch {
        std::vector<ContractedPolygon> faces;
        std::vector<NodeId> nodes, sorted;  ///< of all, the latter of each in order
        std::vector<std::uint8_t> is_repeated;
        std::vector<std::uint64_t> uses;  ///< of edges, as numbers: these are sorted sooner
    };
    /// What some of the polygons of a part are like. None where a polygon passes a node twice, or
    /// two have the same nodes.
    std::optional<PartShape> shape(std::span<const std::int32_t> pieces, std::int32_t part,
                                   ShapeScratch& scratch) const;
    /// The same of a whole part, which stays closed.
    std::optional<PartShape> shape(std::int32_t part, ShapeScratch& scratch) const;
    /// Whether a whole part has an extent, or vanishes where its polygons may cancel.
    bool is_sound(const PartShape& shape, std::int32_t part) const;
    /// Makes it so: polygons that vanish are no more.
    void apply();

    std::vector<NodeId> becomes;  ///< of nodes

private:
    void add_contracted(std::size_t piece, std::vector<NodeId>& nodes) const;

    RoundedParts& parts_;
    bool may_fold_;
};

}  // namespace realmodel::cutting
