// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "base/parallel.hpp"
#include "cutting/distinct.hpp"
#include "cutting/halves.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::cutting {

/// Makes sound parts of exact ones whose nodes were rounded to doubles.
///
/// Nodes that came to lie in one position become one, and polygons between them vanish, wherever
/// the parts around stay closed and keep an extent. Others get positions beside it, parts and
/// upright walls without extent are given one, all by single units in the last place; nodes on the
/// flat base stay on it, and those on walls move up or down before they move aside. Last, polygons
/// that are no longer convex are divided.
class PartRounding {
public:
    /// @param new_positions  of nodes after the model's vertices; they may move
    /// @param touches        whether parts below, above may use an edge more than twice
    /// @param joins_models   whether several models are joined, of which each was rounded by
    /// itself:
    ///                       then nodes, too, become one whose edge is as short as rounding
    PartRounding(const ComplexView& model, std::vector<Position>& new_positions, Pieces& pieces,
                 std::vector<HalfCell>& half_cells, const std::array<bool, 2>& touches,
                 const Execution& execution, bool joins_models = false, double least_rounding = 0);
    void run();

private:
    bool is_new(NodeId node) const { return index(node) >= model_.vertex_count(); }
    const Position& at(NodeId node) const;
    Position& moving(NodeId node) { return new_positions_[index(node) - model_.vertex_count()]; }
    bool is_changed(std::int32_t part) const;
    bool is_wall(std::size_t piece) const;
    bool is_whole_face(std::size_t piece) const;
    template <class IsIt>
    std::size_t first_where(std::size_t count, const IsIt& is_it) const;

    void find_pieces_of_parts();
    void level_base();
    void contract();
    std::vector<NodeId> find_contractions();
    bool join_short_edges();
    bool leaves_wall(NodeId from, NodeId to) const;
    void keep_sound(const std::vector<NodeId>& contracted);
    /// Of polygons of a part: how often they use an edge beyond twice, how many there are, and
    /// where.
    struct Around {
        std::size_t touches = 0, count = 0;
        spatial::Box box;
    };
    /// A polygon of a part as contractions leave it: nodes from `begin` on.
    struct Face {
        std::uint64_t hash;
        std::size_t begin, size;
        int winding;
    };
    /// What around() uses again.
    struct Memory {
        std::vector<Face> faces;
        std::vector<NodeId> nodes, sorted;  ///< of all, the latter of each in order
        std::vector<std::uint8_t> is_repeated;
        std::vector<std::uint64_t> uses;  ///< of edges
    };
    /// An edge as one number: these are sorted sooner.
    static std::uint64_t number_of(const std::array<NodeId, 2>& edge) {
        return static_cast<std::uint64_t>(edge[0]) << 32 | static_cast<std::uint64_t>(edge[1]);
    }
    static std::array<NodeId, 2> edge_of(std::uint64_t number) {
        return {static_cast<NodeId>(number >> 32), static_cast<NodeId>(number & UINT32_MAX)};
    }
    std::optional<Around> around(std::span<const std::int32_t> pieces, std::int32_t part,
                                 Memory& memory) const;
    std::optional<Around> around(std::int32_t part, Memory& memory) const;
    bool stays_sound(std::int32_t part, Memory& memory) const;
    template <class Visit>
    void each_of_parts(std::span<const std::int32_t> parts, const Visit& visit) const;
    void add_contracted(std::size_t piece, std::vector<NodeId>& nodes) const;
    void contract_pieces();
    class ShortEdges;
    std::vector<std::pair<std::vector<NodeId>, std::size_t>> find_doubled() const;
    void cancel_doubled();
    std::vector<std::array<NodeId, 2>> touching_edges() const;
    void set_touching_apart();
    void set_apart();
    void take_all_vertices();
    Freedom freedom_of(std::span<const NodeId> nodes) const;
    void move_aside(NodeId node);
    bool is_upright(std::size_t piece) const;
    void give_extents();
    struct Outer;
    int winding(std::size_t piece) const;
    bool glue(std::span<const std::size_t> equal, std::int8_t half, Pieces& glued);
    void glue_doubled();
    void drop_hollow();
    bool is_bent(std::size_t piece) const;
    bool lacks_extent(std::size_t piece, const Position& middle) const;
    NodeId add_middle(std::size_t piece);
    NodeId add_between(const std::array<NodeId, 2>& edge);
    void divide_bent();
    void drop_empty();

    const ComplexView& model_;
    std::vector<Position>& new_positions_;
    Pieces& pieces_;
    std::vector<HalfCell>& half_cells_;
    std::array<bool, 2> touches_;
    Execution execution_;
    bool joins_models_;
    double least_rounding_;

    std::vector<Position> vertices_;      ///< of the model, as `at` gives them
    std::vector<std::uint8_t> parts_of_;  ///< of the model's cells: how many, 2 for more
    std::vector<NodeId> becomes_;         ///< of nodes: the one that they are contracted to
    std::vector<std::uint8_t> on_base_, on_wall_;  ///< of nodes
    std::vector<std::uint8_t> is_near_;     ///< of nodes: of a part that is less than its cell
    std::vector<std::uint8_t> is_doubled_;  ///< of pieces: another of a half has its nodes
    Buckets<std::int32_t> pieces_of_;       ///< the pieces around each part
    Positions taken_;                       ///< positions of nodes
    bool has_taken_all_ = false;            ///< those of all of the model's vertices, too
};

/// Calls visit(i, memory) for all of some parts, on several threads.
template <class Visit>
void PartRounding::each_of_parts(std::span<const std::int32_t> parts, const Visit& visit) const {
    constexpr std::size_t kAtOnce = 1 << 6;
    parallel_workers((parts.size() + kAtOnce - 1) / kAtOnce, execution_,
                     [&] {
                         return [&, memory = Memory()](std::size_t chunk) mutable {
                             const std::size_t end = std::min(parts.size(), (chunk + 1) * kAtOnce);
                             for (std::size_t i = chunk * kAtOnce; i < end; ++i)
                                 visit(i, memory);
                         };
                     },
                     0.02);
}

}  // namespace realmodel::cutting
