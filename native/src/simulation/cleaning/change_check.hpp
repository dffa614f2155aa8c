// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "simulation/cleaning/editable_complex.hpp"

namespace realmodel::simulation {

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
    using Loop = std::span<const std::int32_t>;

    struct Entry {
        std::array<std::uint64_t, 2> key;  ///< equal for equal corners
        std::int32_t face;                 ///< of the complex, or -1 - (number in `added`)
    };
    struct Beside {
        std::int32_t cell, face;  ///< as of Entry
        auto operator<=>(const Beside&) const = default;
    };
    struct Around {
        std::int32_t vertex;
        std::array<std::int32_t, 2> cells;
    };

    template <class Visit>
    void for_faces_after(const Change& change, std::int32_t vertex, const Visit& visit) const;
    bool join_equal_faces(Change& change, std::int32_t vertex);
    bool join_pair(Change& change, std::vector<std::int32_t>& equal) const;
    Loop loop_of(const Change& change, std::int32_t face) const {
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
    bool keeps_cell(const Change& change, std::int32_t cell, std::span<const Beside> added);
    void take_surroundings(const Change& change, std::int32_t cell, std::span<const Beside> own);
    bool keeps_shape(const Change& change, std::int32_t cell, double& volume);
    bool keeps_volume(const Change& change, std::int32_t cell, std::span<const Beside> own,
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
    std::vector<Entry> entries_;
    std::vector<std::int32_t> before_, after_, vertices_;
    std::vector<std::pair<std::int32_t, std::int32_t>> edges_;
    std::vector<Beside> beside_;
    std::vector<SeenFace> seen_;
    std::vector<Around> around_;
    std::vector<std::pair<std::int32_t, double>> block_change_;
};

}  // namespace realmodel::simulation
