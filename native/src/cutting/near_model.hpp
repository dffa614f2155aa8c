// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "cutting/nearest_side.hpp"
#include "cutting/pieces.hpp"
#include "realmodel/complex.hpp"

namespace realmodel::cutting {

/// Faces of near cells that a cutter does not come near, and that NearModel leaves out: in groups,
/// each between the same two cells and connected by edges that no other faces have. So all of a
/// group is on one side, and of one part of either cell. The first face of each group is left in,
/// and stands for it; so are those that have other edges, which are of the group, too.
class FarFaces {
public:
    FarFaces() = default;
    /// @param is_near  of cells
    /// @param faces    of near cells, in order; it keeps those that are left in
    /// @param nearest  whatever is no farther from it than `margin` is left in
    FarFaces(const ComplexView& model, std::span<const std::uint8_t> is_near,
             std::vector<std::int32_t>& faces, const NearestSide& nearest, double margin,
             const Execution& execution);

    /// Of faces that are left in, by their numbers among these: the group, -1 none.
    std::int32_t group(std::size_t face) const { return group_.empty() ? -1 : group_[face]; }
    std::size_t groups() const { return first_.size(); }
    /// The number of the first face of a group.
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
    /// Whether the first cell of a face is not near, so that the near model has it turned around.
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

/// The pieces of a whole model of which the near model was cut up: its own, and the other faces,
/// which stay as they are.
class WholePieces {
public:
    WholePieces() = default;
    /// All was cut up.
    explicit WholePieces(CutPieces&& pieces) : near_(std::move(pieces)) {}

    /// In chunks, of which several threads may visit some each: calls visit(polygon, piece) in the
    /// order of the model's faces; cut faces last.
    std::size_t chunks() const {
        return chunks_of(model_.face_count()) + chunks_of(cut_face_count());
    }
    template <class Visit>
    void for_each_of(std::size_t chunk, const Visit& visit) const;
    /// Those of the near model alone.
    const CutPieces& near() const { return near_; }

private:
    friend class NearModel;
    static constexpr std::int32_t kNear = -2;
    static constexpr std::size_t kChunk = 1 << 14;

    static std::size_t chunks_of(std::size_t count) { return (count + kChunk - 1) / kChunk; }
    std::size_t cut_face_count() const { return near_.size() - first_cut_face_; }
    /// The first of the near model's pieces that is of a face from this one on.
    std::size_t first_from(std::size_t face) const {
        const auto begin = near_.origins.begin();
        return static_cast<std::size_t>(
            std::partition_point(begin, begin + static_cast<std::ptrdiff_t>(first_cut_face_),
                                 [face](const CutPiece& p) { return index(p.face) < face; }) -
            begin);
    }

    ComplexView model_;
    const FarFaces* far_ = nullptr;
    CutPieces near_;
    std::vector<CutPiece> of_groups_;     ///< of far faces: as their first faces are
    std::size_t first_cut_face_ = 0;      ///< in `near_`
    std::vector<std::int32_t> far_part_;  ///< of cells: -1 left out, kNear: near
    std::span<const std::int8_t> sides_;
};

/// The cells of a model that a cutter may touch, as a model of their own: what is done to them
/// costs what they are, and the cells beside them stay as they are. Of cells that are large beside
/// the cutter so do the faces away from it.
class NearModel {
public:
    /// @param is_near  of the model's cells: not 0 if it is one of them
    /// @param nearest  whose far faces are left out of blocks, which is asked for here alone;
    ///                 nullptr: all faces are there
    /// @param margin   how far from it they are at least
    NearModel(const ComplexView& model, std::span<const std::uint8_t> is_near,
              const Execution& execution, const NearestSide* nearest = nullptr, double margin = 0);

    ComplexView view() const;
    /// What was left out of near cells.
    const FarFaces& far() const { return far_; }
    /// The model's cells that those of the near model are.
    const std::vector<std::int32_t>& cells() const { return cells_; }
    /// Makes pieces of the near model's faces, and parts of its cells, those of the whole model, in
    /// the order of its faces and cells: the other cells are added, and their faces follow from
    /// them.
    /// @param sides  of the model's cells that are none of the near model's: kOn leaves them out
    /// @return nothing where rounding did not leave a face alone that lies beside another cell; to
    ///         be used as long as the near model is
    std::optional<WholePieces> put_back(CutPieces&& pieces, std::vector<HalfCell>& half_cells,
                                        std::span<const std::int8_t> sides) const;

private:
    std::vector<std::int32_t> number_parts(std::vector<HalfCell>& half_cells,
                                           WholePieces& whole) const;

    ComplexView model_;
    FarFaces far_;
    std::vector<std::int32_t> number_;  ///< of the model's cells, -1 none of the near model's
    CellComplex complex_;
    std::vector<std::int32_t> cells_, vertices_of_, faces_;
    /// Of faces: the model's cell beyond, where that is none of the near model's; else -1.
    std::vector<std::int32_t> beyond_;
};

/// Where the cells of a model are that may come near cutters.
struct CellBoxes {
    CellBoxes(const ComplexView& model, std::span<const NearestSide> nearest_sides,
              const Execution& execution);

    std::vector<spatial::Box> boxes;  ///< empty of cells that are away from all cutters
    double rounding = 0;              ///< what vertices may be off by
};

/// How far from a cutter a cell may be that is taken to be near: farther than CutterOverlay takes
/// to be near.
double margin_of(const CellBoxes& cells, const NearestSide& nearest);

/// Of cells: 1 where they come near a cutter.
/// @param nearest  one of those that the boxes were made for
std::vector<std::uint8_t> cells_near(const CellBoxes& cells, const NearestSide& nearest,
                                     const Execution& execution);

/// Of cells that are not near a cutter, the side of it that they are on; kOn of the others. What
/// is connected beside the cutter is on one side.
/// @param is_near  of cells, not 0: near, or not asked for
std::vector<std::int8_t> sides_of_far_cells(const ComplexView& model, const NearestSide& nearest,
                                            std::span<const std::uint8_t> is_near,
                                            const Execution& execution);

template <class Visit>
void WholePieces::for_each_of(std::size_t chunk, const Visit& visit) const {
    const auto visit_near = [&](std::size_t i) { visit(near_.polygons[i], near_[i]); };
    if (const std::size_t of_faces = chunks_of(model_.face_count()); chunk >= of_faces) {
        const std::size_t begin = first_cut_face_ + (chunk - of_faces) * kChunk;
        for (std::size_t i = begin; i < std::min(near_.size(), begin + kChunk); ++i)
            visit_near(i);
        return;
    }
    const std::size_t begin = chunk * kChunk, end = std::min(model_.face_count(), begin + kChunk);
    std::size_t next = first_from(begin);
    const auto far = far_->faces();
    auto beyond = std::ranges::lower_bound(far, static_cast<std::int32_t>(begin));
    std::vector<NodeId> reversed;
    for (std::size_t f = begin; f < end; ++f) {
        while (next < first_cut_face_ && index(near_[next].face) <= f)
            visit_near(next++);
        if (beyond != far.end() && index(*beyond) == f) {
            const auto number = static_cast<std::size_t>(beyond++ - far.begin());
            CutPiece piece = of_groups_[index(far_->groups_of_faces()[number])];
            piece.face = static_cast<std::int32_t>(f);
            const auto polygon = model_.face(f);
            if (far_->is_reversed(piece.face)) {
                reversed.assign(polygon.rbegin(), polygon.rend());
                visit(std::span<const NodeId>(reversed), piece);
            } else {
                visit(polygon, piece);
            }
            continue;
        }
        CutPiece piece{static_cast<std::int32_t>(f),
                       {model_.cell(f, 0), model_.cell(f, 1)},
                       {kOn, kOn},
                       false};
        for (std::size_t k = 0; k < 2; ++k) {
            if (piece.cells[k] < 0) continue;
            piece.parts[k] = far_part_[index(piece.cells[k])];
            piece.sides[k] = sides_[index(piece.cells[k])];
        }
        if (piece.parts[0] == kNear || piece.parts[1] == kNear) continue;
        if (piece.parts[0] >= 0 || piece.parts[1] >= 0) visit(model_.face(f), piece);
    }
}

}  // namespace realmodel::cutting
