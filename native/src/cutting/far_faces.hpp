// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "cutting/nearest_side.hpp"
#include "realmodel/complex.hpp"

namespace realmodel::cutting {

/// Faces of near cells that a surface does not come near, and that NearPart leaves out: in groups,
/// each between the same two cells and connected by edges that no other faces have. So all of a
/// group is on one side, and of one part of either cell. The first face of each group is left in,
/// and stands for it; so are those that have other edges, which are of the group, too.
class FarFaces {
public:
    FarFaces() = default;
    /// @param is_near  of cells
    /// @param faces    of near cells, in order; it keeps those that are left in
    /// @param surface  whatever is no farther from it than `margin` is left in
    FarFaces(const ComplexView& model, std::span<const std::uint8_t> is_near,
             std::vector<std::int32_t>& faces, const NearestSide& surface, double margin,
             const Execution& execution);

    /// Of faces that are left in, by their places among these: the group, -1 none.
    std::int32_t group(std::size_t face) const { return group_.empty() ? -1 : group_[face]; }
    std::size_t groups() const { return first_.size(); }
    /// The place of the first face of a group.
    std::int32_t first(std::int32_t group) const { return first_[index(group)]; }
    bool is_first(std::size_t face) const {
        return group(face) >= 0 && index(first(group(face))) == face;
    }
    /// The model's faces that are left out, in order, and the group of each.
    std::span<const std::int32_t> faces() const { return faces_; }
    std::span<const std::int32_t> groups_of_faces() const { return groups_of_faces_; }
    /// Those of a group, in order.
    std::span<const std::int32_t> of_group(std::int32_t group) const {
        return of_group_[index(group)];
    }
    /// Around all faces of near cells.
    const spatial::Box& box() const { return box_; }
    /// Whether the first cell of a face is not near, so that the part has it turned around.
    bool is_reversed(std::int32_t face) const {
        return is_near_[index(model_.cell(index(face), 0))] == 0;
    }
    const ComplexView& model() const { return model_; }
    /// Whether beyond an edge of a face that is left in, by its nodes as numbered, a face is left
    /// out.
    bool is_beyond(std::uint64_t edge) const { return std::ranges::binary_search(edges_, edge); }
    /// Gives nodes other numbers, in the same order.
    void renumber(std::span<const NodeId> number);

private:
    ComplexView model_;
    std::span<const std::uint8_t> is_near_;
    std::vector<std::int32_t> group_, first_, faces_, groups_of_faces_;
    Buckets<std::int32_t> of_group_;
    spatial::Box box_;
    std::vector<std::uint64_t> edges_;  ///< as packed pairs, in order
};

/// Nothing is left out.
inline const FarFaces kNoFarFaces;

}  // namespace realmodel::cutting
