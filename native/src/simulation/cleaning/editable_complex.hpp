// SPDX-License-Identifier: GPL-3.0-or-later
// A complex whose faces can be replaced, and what decides whether it stays valid by a change.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/index.hpp"
#include "base/vectors.hpp"
#include "realmodel/complex.hpp"
#include "realmodel/simulation/clean_cells.hpp"

namespace realmodel::simulation {

/// Many short lists of numbers in one array; a list that outgrows its room moves to the end.
class ListPool {
public:
    /// Lists that are given one after another: list i is numbers[offsets[i] .. offsets[i + 1]].
    template <class Offset>
    ListPool(std::span<const Offset> offsets, std::vector<std::int32_t> numbers)
        : numbers_(std::move(numbers)) {
        lists_.reserve(offsets.size());
        for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
            const auto size = static_cast<std::uint32_t>(offsets[i + 1] - offsets[i]);
            lists_.push_back({static_cast<std::size_t>(offsets[i]), size, size});
        }
    }
    std::size_t size() const { return lists_.size(); }
    std::span<const std::int32_t> operator[](std::int32_t list) const {
        const NumberList& range = lists_[index(list)];
        return {numbers_.data() + range.begin, range.size};
    }
    std::int32_t add_list() {
        lists_.push_back({numbers_.size(), 0, 0});
        return checked_number(lists_.size() - 1, "faces");
    }
    void push(std::int32_t list, std::int32_t number) {
        NumberList& range = lists_[index(list)];
        if (range.size == range.room) make_room(range, 2 * range.size + 2);
        numbers_[range.begin + range.size++] = number;
    }
    /// Takes out a number that is there once; the order of the others stays.
    void erase(std::int32_t list, std::int32_t number) {
        NumberList& range = lists_[index(list)];
        const auto begin = numbers_.begin() + static_cast<std::ptrdiff_t>(range.begin);
        const auto end = begin + range.size;
        assert(std::count(begin, end, number) == 1);
        range.size = static_cast<std::uint32_t>(std::remove(begin, end, number) - begin);
    }
    void set(std::int32_t list, std::span<const std::int32_t> numbers) {
        NumberList& range = lists_[index(list)];
        range.size = 0;
        if (numbers.size() > range.room) make_room(range, numbers.size());
        std::copy(numbers.begin(), numbers.end(),
                  numbers_.begin() + static_cast<std::ptrdiff_t>(range.begin));
        range.size = static_cast<std::uint32_t>(numbers.size());
    }

private:
    struct NumberList {
        std::size_t begin;
        std::uint32_t size, room;
    };
    void make_room(NumberList& list, std::size_t room) {
        const std::size_t begin = numbers_.size();
        numbers_.resize(begin + room);
        std::copy_n(numbers_.begin() + static_cast<std::ptrdiff_t>(list.begin), list.size,
                    numbers_.begin() + static_cast<std::ptrdiff_t>(begin));
        list.begin = begin;
        list.room = static_cast<std::uint32_t>(room);
    }

    std::vector<std::int32_t> numbers_;
    std::vector<NumberList> lists_;
};

inline bool contains(std::span<const std::int32_t> numbers, std::int32_t number) {
    return std::ranges::find(numbers, number) != numbers.end();
}

/// The corners after and before one in a loop; nothing where it has no such corner.
inline std::optional<std::array<std::int32_t, 2>> beside(std::span<const std::int32_t> loop,
                                                         std::int32_t corner) {
    const auto at = static_cast<std::size_t>(std::ranges::find(loop, corner) - loop.begin());
    const std::size_t n = loop.size();
    if (at == n) return std::nullopt;
    return std::array{loop[(at + 1) % n], loop[(at + n - 1) % n]};
}

/// The area vector of a face, away from its first cell, and its center, as OpenFOAM has them: of
/// the triangles between its edges and the mean of its corners.
struct FaceVectors {
    Vec3 area{}, center{};
};

struct CellShape {
    double volume = 0;
    double area = 0;       ///< of all its faces
    int turned_faces = 0;  ///< from whose inner side the cell's center is not seen
};

/// A face and the side from which a cell has it.
struct SeenFace {
    FaceVectors shape;
    double sign;
};

CellShape cell_shape(std::span<const SeenFace> faces);

/// Faces that replace others. Vertices stay where they are: a change joins them, or brings one into
/// an edge, so it is wholly in the corners of faces and in the cells beside them.
struct Change {
    struct AddedFace {
        std::int32_t origin;  ///< the face that it was
        std::uint32_t begin, size;
        std::array<std::int32_t, 2> cells;
        std::int32_t surface;
        bool is_joined;  ///< of two faces
        FaceVectors shape;
    };
    std::vector<std::int32_t> removed;
    std::vector<AddedFace> added;
    std::vector<std::int32_t> corners;
    /// Cells (-1: the outside) whose faces may meet in other ways than before.
    std::vector<std::int32_t> tested;

    void clear();
    std::span<const std::int32_t> loop(const AddedFace& face) const {
        return std::span(corners).subspan(face.begin, face.size);
    }
    /// Adds the pieces of a loop, divided where it meets itself in a vertex; pieces of fewer than
    /// three corners vanish.
    void add(std::span<const std::int32_t> loop, std::int32_t origin,
             std::array<std::int32_t, 2> cells, std::int32_t surface);

private:
    void add_simple(std::span<const std::int32_t> loop, std::int32_t origin,
                    std::array<std::int32_t, 2> cells, std::int32_t surface);
    std::vector<std::int32_t> open_;  // of add(): the piece that is not divided off yet
};

/// A complex whose faces can be replaced, with the faces of each cell and vertex.
class EditableComplex {
public:
    EditableComplex(const ComplexView& model, const Execution& execution);

    std::span<const std::int32_t> corners(std::int32_t face) const { return corners_[face]; }
    std::span<const std::int32_t> cell_faces(std::int32_t cell) const { return cell_faces_[cell]; }
    std::span<const std::int32_t> vertex_faces(std::int32_t v) const { return vertex_faces_[v]; }
    const std::array<std::int32_t, 2>& cells(std::int32_t face) const {
        return cells_[index(face)];
    }
    std::int32_t surface(std::int32_t face) const { return surface_[index(face)]; }
    const FaceVectors& shape(std::int32_t face) const { return shapes_[index(face)]; }
    const CellShape& cell(std::int32_t cell) const { return cell_shapes_[index(cell)]; }
    /// Relative to the middle of the model.
    Vec3 point(std::int32_t v) const { return points_[index(v)]; }
    double distance(std::int32_t u, std::int32_t v) const {
        return length(minus(point(u), point(v)));
    }
    std::int32_t block(std::int32_t cell) const { return model_.cell_block[index(cell)]; }
    bool has_face(std::int32_t face) const { return !corners(face).empty(); }
    bool has_cell(std::int32_t cell) const { return !cell_faces(cell).empty(); }
    std::int32_t face_count() const { return static_cast<std::int32_t>(corners_.size()); }
    std::int32_t cell_count() const { return static_cast<std::int32_t>(cell_faces_.size()); }
    std::int32_t vertex_count() const { return static_cast<std::int32_t>(points_.size()); }

    FaceVectors shape_of(std::span<const std::int32_t> loop) const;
    /// The cell as it is.
    CellShape measured(std::int32_t cell) const;

    void apply(const Change& change);

    ComplexCounts counts() const;
    std::vector<double> block_volumes() const;
    /// What is left, without vertices that no face has.
    CleanedCells taken() const;

private:
    void remove(std::int32_t face);
    bool is_closed(std::int32_t cell) const;

    ComplexView model_;
    std::vector<Vec3> points_;
    std::vector<std::array<std::int32_t, 2>> cells_;
    std::vector<std::int32_t> surface_;
    std::vector<FaceVectors> shapes_;
    std::vector<CellShape> cell_shapes_;
    ListPool corners_, cell_faces_, vertex_faces_;
};

/// Decides whether a complex stays valid by a change.
class ChangeCheck {
public:
    ChangeCheck(const EditableComplex& complex, std::span<const std::int32_t> surface_kind)
        : complex_(complex), surface_kind_(surface_kind) {}

    /// Joins faces at a vertex that the change has made equal: what lies between them is gone.
    /// Then says whether all cells beside the change (the outside among them) stay closed,
    /// connected and of the same genus, with edges between cells one round each, and whether
    /// volumes stay positive and no face turns over. The shapes of the added faces are set.
    /// @param vertex  -1: no faces have become equal
    bool settle(Change& change, std::int32_t vertex);

    /// Of the change that settled last: how far it changes the volumes of the blocks, together,
    /// what goes to the outside or comes from it twice.
    double volume_change() const { return volume_change_; }

    bool is_fault(std::int32_t surface) const {
        return surface >= 0 && index(surface) < surface_kind_.size() &&
               surface_kind_[index(surface)] != 0;
    }

private:
    using FaceLoop = std::span<const std::int32_t>;

    struct KeyedFace {
        std::array<std::uint64_t, 2> key;  ///< equal for equal corners
        std::int32_t face;                 ///< of the complex, or -1 - (number in `added`)
    };
    struct Beside {
        std::int32_t cell, face;  ///< as of KeyedFace
        auto operator<=>(const Beside&) const = default;
    };
    using BlockChange = std::pair<std::int32_t, double>;  ///< of its volume
    struct Around {
        std::int32_t vertex;
        std::array<std::int32_t, 2> cells;
    };

    template <class Visit>
    void for_faces_after(const Change& change, std::int32_t vertex, const Visit& visit) const;
    bool join_equal_faces(Change& change, std::int32_t vertex);
    bool join_pair(Change& change, std::vector<std::int32_t>& equal) const;
    FaceLoop loop_of(const Change& change, std::int32_t face) const {
        return face >= 0 ? complex_.corners(face) : change.loop(change.added[index(-1 - face)]);
    }
    std::array<std::int32_t, 2> cells_of(const Change& change, std::int32_t face) const {
        return face >= 0 ? complex_.cells(face) : change.added[index(-1 - face)].cells;
    }
    std::int32_t surface_of(const Change& change, std::int32_t face) const {
        return face >= 0 ? complex_.surface(face) : change.added[index(-1 - face)].surface;
    }
    const FaceVectors& shape_of(const Change& change, std::int32_t face) const {
        return face >= 0 ? complex_.shape(face) : change.added[index(-1 - face)].shape;
    }

    bool keeps_faces(Change& change) const;
    bool keeps_cells(const Change& change);
    bool keeps_cell(const Change& change, std::int32_t cell, std::span<const Beside> sides);
    void take_surroundings(const Change& change, std::int32_t cell, std::span<const Beside> sides);
    bool keeps_shape(const Change& change, std::int32_t cell, double& volume);
    bool keeps_volume(const Change& change, std::int32_t cell, std::span<const Beside> sides,
                      double& volume) const;
    bool keeps_edges(const Change& change, std::int32_t vertex);
    static bool is_round(std::span<Around> faces);
    int euler_number(const Change& change, std::int32_t cell, std::span<const std::int32_t> faces,
                     int& doubled);
    bool is_removed(std::int32_t face) const {
        return std::binary_search(removed_.begin(), removed_.end(), face);
    }

    const EditableComplex& complex_;
    std::span<const std::int32_t> surface_kind_;
    double volume_change_ = 0;
    std::vector<std::int32_t> removed_;  // ascending
    // scratch
    std::vector<KeyedFace> entries_;
    std::vector<std::int32_t> before_, after_, vertices_;
    std::vector<std::pair<std::int32_t, std::int32_t>> edges_;
    std::vector<Beside> beside_;
    std::vector<SeenFace> seen_;
    std::vector<Around> around_;
    std::vector<BlockChange> block_change_;
};

}  // namespace realmodel::simulation
