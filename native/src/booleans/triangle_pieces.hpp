// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/algorithms.hpp"
#include "booleans/facet_division.hpp"
#include "realmodel/booleans/intersect.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::booleans {

/// A triangle of the inputs as a whole, or a part of one.
struct TrianglePiece {
    TriangleCorners corners;
    bool is_fresh = false;  ///< changed since it was last known to meet others in order
};

/// A piece: the triangle of the inputs, and which of its pieces.
struct PieceId {
    std::int32_t input, piece;
    auto operator<=>(const PieceId&) const = default;
};

/// The triangles of both surfaces, and the pieces of those that were divided. Corners are points of
/// `points`, all of them given by doubles.
class TrianglePieces {
public:
    /// @throws InputError kinds not_finite, bad_index, no_triangles, too_large
    TrianglePieces(const std::array<TriangleView, 2>& surfaces, const Execution& execution);

    SpacePoints points;

    std::size_t input_count() const { return whole_.size(); }
    /// Of all pieces, undivided triangles too.
    std::size_t count() const { return count_; }
    /// Whether none has been divided.
    bool are_whole() const { return lists_.empty(); }
    std::uint8_t source(std::int32_t input) const { return index(input) < second_ ? 0 : 1; }
    /// The row of a triangle in its surface.
    std::int32_t row(std::int32_t input) const {
        return source(input) == 0 ? input : input - static_cast<std::int32_t>(second_);
    }
    std::span<const TrianglePiece> of(std::int32_t input) const {
        const std::int32_t list = list_[index(input)];
        return list < 0 ? std::span(&whole_[index(input)], 1)
                        : std::span(lists_[index(list)].pieces);
    }
    const TrianglePiece& operator[](const PieceId& id) const {
        return of(id.input)[index(id.piece)];
    }
    TrianglePiece& operator[](const PieceId& id) {
        const std::int32_t list = list_[index(id.input)];
        return list < 0 ? whole_[index(id.input)] : lists_[index(list)].pieces[index(id.piece)];
    }
    void replace(std::int32_t input, std::vector<TrianglePiece>&& pieces);

    spatial::Box box(const TriangleCorners& corners) const {
        return spatial::bounding_box(corners, [this](SpacePointId v) { return points.rounded(v); });
    }
    /// Calls visit(input) for the triangles of the inputs whose pieces may meet a box.
    template <class Visit>
    void find_inputs(spatial::Box near, const Visit& visit) const {
        near.widen(reach_);
        tree_->find(near, visit);
    }
    /// Calls visit(piece) for the pieces that may meet a box.
    template <class Visit>
    void find(const spatial::Box& near, const Visit& visit) const {
        find_inputs(near, [&](std::int32_t input) {
            const std::int32_t list = list_[index(input)];
            if (list >= 0 && lists_[index(list)].tree != nullptr) {
                lists_[index(list)].tree->find(near, [&](std::int32_t piece) {
                    visit(lists_[index(list)].pieces[index(piece)]);
                });
                return;
            }
            for (const TrianglePiece& piece : of(input)) {
                if (near.meets(box(piece.corners))) visit(piece);
            }
        });
    }
    const spatial::BoxTree& tree() const { return *tree_; }
    /// Notes that pieces may have moved by so much.
    void moved_by(double distance) { reach_ += distance; }
    double largest_coordinate() const { return largest_; }

private:
    struct PieceList {
        std::vector<TrianglePiece> pieces;
        std::unique_ptr<spatial::BoxTree> tree;  ///< where there are many
    };
    void add_triangles(const std::array<TriangleView, 2>& surfaces, Progress* progress);
    void make_tree(const std::array<TriangleView, 2>& surfaces, const Execution& execution);

    Progress* progress_;
    std::size_t second_;  ///< the first triangle of the second surface
    std::vector<TrianglePiece> whole_;
    std::size_t count_ = 0;
    std::vector<std::int32_t> list_;  ///< of each input triangle: its pieces in lists_, -1 itself
    std::vector<PieceList> lists_;
    std::unique_ptr<spatial::BoxTree> tree_;
    double reach_ = 0;  ///< how far pieces may be outside of the boxes in the tree
    double largest_ = 0;
};

/// The corners in order, and whether that turns the triangle over.
inline std::pair<TriangleCorners, bool> in_order(TriangleCorners corners) {
    bool odd = false;
    const auto exchange = [&](std::size_t i, std::size_t j) {
        if (corners[j] < corners[i]) {
            std::swap(corners[i], corners[j]);
            odd = !odd;
        }
    };
    exchange(0, 1);
    exchange(1, 2);
    exchange(0, 1);
    return {corners, odd};
}

inline bool has_equal_corners(const TriangleCorners& c) {
    return c[0] == c[1] || c[1] == c[2] || c[2] == c[0];
}

}  // namespace realmodel::booleans
