// SPDX-License-Identifier: GPL-3.0-or-later
// How many triangles vertices have, and should have. Private.
#pragma once

#include <cstdint>
#include <vector>

#include "meshing/flat_mesh.hpp"
#include "meshing/size_field.hpp"

namespace realmodel::meshing {

/// Of each vertex how many triangles it has and how many it wants: six inside, on fixed lines as
/// many of about 60 degrees as fill its angles. Flips and collapses go through here, so that counts
/// stay right. The strain of a vertex is the square of what it has too many or too few (Frey and
/// Field 1991, "Mesh relaxation").
class Valences {
public:
    Valences(FlatMesh& mesh, const SizeField& size);

    FlatMesh& mesh() { return mesh_; }
    const FlatMesh& mesh() const { return mesh_; }

    bool is_gone(std::int32_t vertex) const { return triangles_[vertex] == 0; }
    bool is_fixed(std::int32_t vertex) const { return is_fixed_[vertex]; }
    /// Vertices that must stay what they are though no fixed side ends in them.
    void keep(std::int32_t vertex) { is_fixed_[vertex] = true; }
    std::int32_t triangles(std::int32_t vertex) const { return triangles_[vertex]; }
    bool is_regular(std::int32_t vertex) const { return strain(vertex, 0) == 0; }

    /// Visits the sides that leave a vertex, counter-clockwise; a star at the border from its
    /// border on.
    template <class Visit>
    void around(std::int32_t vertex, Visit&& visit) const {
        Side begin = leaving_[vertex];
        if (is_fixed_[vertex]) {
            for (Side side = begin; !side.is_outside();) {
                begin = side;
                side = mesh_.turn_right(side);
                if (side == leaving_[vertex]) break;
            }
        }
        Side side = begin;
        do {
            visit(side);
            side = mesh_.turn_left(side);
        } while (!side.is_outside() && side != begin);
    }

    /// By how much a flip lessens the strain of the four vertices.
    int gain_of_flip(Side side) const;
    /// Whether a side that is not fixed can be flipped: both triangles stay upright and fair, no
    /// vertex inside is left with two.
    bool can_flip(Side side) const;
    Side flip(Side side);

    /// Takes a vertex inside with five triangles or fewer to its neighbour where that lessens the
    /// strain most, if anywhere.
    void collapse(std::int32_t vertex);
    /// Takes a vertex with two triangles out of the border where that helps the one opposite. It
    /// must lie between two vertices of the border in one line with it.
    void pass_by(std::int32_t vertex);

private:
    int strain(std::int32_t vertex, int more) const {
        const int off = triangles_[vertex] + more - wanted_[vertex];
        return off * off;
    }
    double angle_at(Side side) const;
    void want_on_lines();
    bool can_collapse_to(std::int32_t vertex) const;
    void collapse(Side side);

    FlatMesh& mesh_;
    const SizeField& size_;
    std::vector<Side> leaving_;            ///< of each vertex: a side from it
    std::vector<std::int32_t> triangles_;  ///< of each vertex: how many it has; 0: it is gone
    std::vector<std::int32_t> wanted_;     ///< and how many it should have
    std::vector<bool> is_fixed_;
    std::vector<Side> sides_;
};

/// 1 where a triangle is equilateral, 0 or less where it is flat or turned over.
double mean_ratio(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c);

}  // namespace realmodel::meshing
