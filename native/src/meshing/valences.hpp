// SPDX-License-Identifier: GPL-3.0-or-later
// How many triangles vertices have, and should have.
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
    Valences(FlatMesh& mesh, SizeField& size);

    FlatMesh& mesh() { return mesh_; }
    const FlatMesh& mesh() const { return mesh_; }

    bool is_gone(std::int32_t vertex) const { return triangles_[vertex] == 0; }
    bool is_fixed(std::int32_t vertex) const { return is_fixed_[vertex]; }
    /// Vertices that must stay what they are though no fixed edge ends in them.
    void keep(std::int32_t vertex) { is_fixed_[vertex] = true; }
    std::int32_t triangles(std::int32_t vertex) const { return triangles_[vertex]; }
    bool is_regular(std::int32_t vertex) const { return strain(vertex, 0) == 0; }

    /// Visits the edges that leave a vertex, counter-clockwise; a star at the border from its
    /// border on.
    template <class Visit>
    void around(std::int32_t vertex, Visit&& visit) const {
        HalfEdge begin = leaving_[vertex];
        if (is_fixed_[vertex]) {
            for (HalfEdge edge = begin; !edge.is_none();) {
                begin = edge;
                edge = mesh_.rotate_cw(edge);
                if (edge == leaving_[vertex]) break;
            }
        }
        HalfEdge edge = begin;
        do {
            visit(edge);
            edge = mesh_.rotate_ccw(edge);
        } while (!edge.is_none() && edge != begin);
    }

    /// By how much a flip lessens the strain of the four vertices.
    int gain_of_flip(HalfEdge edge) const;
    /// Whether an edge that is not fixed can be flipped: both triangles stay upright and fair, no
    /// vertex inside is left with two.
    bool can_flip(HalfEdge edge) const;
    HalfEdge flip(HalfEdge edge);

    /// Takes a vertex inside with five triangles or fewer to its neighbor where that lessens the
    /// strain most, if anywhere.
    void collapse(std::int32_t vertex);
    /// Takes a vertex with two triangles out of the border where that helps the one opposite. It
    /// must lie between two vertices of the border in one line with it.
    void remove_from_border(std::int32_t vertex);

private:
    int strain(std::int32_t vertex, int more) const {
        const int off = triangles_[vertex] + more - wanted_[vertex];
        return off * off;
    }
    double angle_at(HalfEdge edge) const;
    void want_on_lines();
    bool can_collapse_to(std::int32_t vertex) const;
    void collapse(HalfEdge edge);

    FlatMesh& mesh_;
    SizeField& size_;
    std::vector<HalfEdge> leaving_;        ///< of each vertex: an edge from it
    std::vector<std::int32_t> triangles_;  ///< of each vertex: how many it has; 0: it is gone
    std::vector<std::int32_t> wanted_;     ///< and how many it should have
    std::vector<bool> is_fixed_;
    std::vector<HalfEdge> edges_;
};

/// 1 where a triangle is equilateral, 0 or less where it is flat or turned over.
double mean_ratio(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c);

}  // namespace realmodel::meshing
