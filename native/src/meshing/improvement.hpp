// SPDX-License-Identifier: GPL-3.0-or-later
// Better triangles in the mesh of a region: refinement, then smoothing, and what a round of this
// consists of.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "meshing/check.hpp"
#include "meshing/flat_mesh.hpp"
#include "meshing/size_field.hpp"

namespace realmodel::meshing {

struct RefinementTarget {
    double least_angle;    ///< radians; asked of every angle not given by two fixed edges
    double longest_edge;   ///< times the length wanted; a triangle with a longer one is refined
    double shortest_edge;  ///< nothing is refined where edges are as short as this already
    std::size_t most_vertices;  ///< beyond it InputError "too_large"
};

/// Adds vertices until triangles meet the target (Ruppert 1995 with the lenses of Shewchuk 2002,
/// "Delaunay refinement algorithms for triangular mesh generation", section 3.4: a fixed edge is
/// cut where a new vertex would come too near to it, or would lie beyond it). Fixed edges are only
/// ever cut in two. Triangles before `first`, but for those in `also`, are taken to be good.
/// Deterministic; `check` is called often.
void refine(FlatMesh& mesh, const RefinementTarget& target, SizeField& size, std::int32_t first,
            std::span<const std::int32_t> also, const Check& check);

/// Fills triangles larger than `size` wants with vertices, from the border and from what is small
/// enough inwards: each vertex makes a triangle of the wanted size with an edge that has such a
/// triangle or the border behind it (frontal Delaunay: Rebay 1993, "Efficient unstructured mesh
/// generation by means of Delaunay triangulation and Bowyer-Watson algorithm"). Fixed edges are
/// left whole. Triangles before `first` are taken to be small enough.
void advance_front(FlatMesh& mesh, SizeField& size, std::int32_t first, std::size_t most_vertices,
                   const Check& check);

/// Refuses a mesh that has grown beyond what there is room for.
void require_room(const FlatMesh& mesh, std::size_t most_vertices);

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

/// Moves vertices, one at a time, by Newton's method to where the sum of the inverse mean ratios of
/// their triangles is least (Munson 2007, "Mesh shape-quality optimization using the inverse
/// mean-ratio metric"): within the star of a vertex this sum is convex. Some vertices are free,
/// some slide along a line, all others stay.
class StarMoves {
public:
    explicit StarMoves(Valences& valences)
        : valences_(valences), mesh_(valences.mesh()), kinds_(mesh_.points.size(), kStays) {}

    void free(std::int32_t vertex) { kinds_[vertex] = kIsFree; }
    bool moves_freely(std::int32_t vertex) const { return kinds_[vertex] == kIsFree; }
    /// Lets vertices slide between two ends.
    std::int32_t add_line(const PlanPoint& begin, const PlanPoint& end);
    void slide_on(std::int32_t vertex, std::int32_t line) { kinds_[vertex] = line; }
    bool slides(std::int32_t vertex) const { return kinds_[vertex] >= 0; }

    void move(std::int32_t vertex);

private:
    struct StarShape;
    static constexpr std::int32_t kStays = -1, kIsFree = -2;

    void go_freely(std::int32_t vertex);
    void slide(std::int32_t vertex);
    StarShape shape_of_star(std::int32_t vertex);
    StarShape shape_at(const PlanPoint& place) const;
    template <class Place>
    void step(std::int32_t vertex, const StarShape& now, double way, const Place& place_at);

    const Valences& valences_;
    FlatMesh& mesh_;
    std::vector<std::int32_t> kinds_;  ///< of each vertex: kStays, kIsFree or the line it slides on
    std::vector<std::array<PlanPoint, 2>> lines_;
    std::vector<std::array<std::int32_t, 2>> base_;  ///< the edges opposite to the vertex
};

/// Tries flips, one or several on end, moves the vertices that they touch a little, and takes what
/// proves worth it; all else is left as it was.
class JudgedFlips {
public:
    JudgedFlips(Valences& valences, StarMoves& moves) : valences_(valences), moves_(moves) {}

    /// Looks for a way of at most so many flips from a vertex that lessens the strain, and takes it
    /// if triangles get hardly worse. A vertex with five neighbors beside one with seven is a
    /// dislocation, the end of a row: a flip beside it that changes no strain takes it one row on,
    /// and where it meets an opposite one both are gone (Hirth and Lothe 1982, "Theory of
    /// dislocations"; Surazhsky and Gotsman 2003, "Explicit surface remeshing", drift irregular
    /// vertices alike).
    bool glide(std::int32_t vertex, int most_flips);

    /// Takes the first flip of an edge at a vertex with a bad triangle that makes triangles better,
    /// whatever becomes of the strain.
    bool mend(std::int32_t vertex);

private:
    using Ends = std::array<std::int32_t, 2>;
    struct FlipCandidate {
        int gain;
        Ends ends;
    };
    struct Flip {
        Ends before, after;
    };
    static constexpr int kAnyGain = std::numeric_limits<int>::min();

    bool seek(std::span<const std::int32_t> changed, int gained, int flips_left);
    void add_candidate(HalfEdge edge, int least_gain);
    void sort_candidates(std::size_t begin);
    bool try_flip(const Ends& ends);
    void undo();
    bool is_worth_it(double most_worse, double most_worse_beside_lines);
    double badness();
    HalfEdge edge_between(const Ends& ends) const;
    bool may_change(std::int32_t vertex) const;

    Valences& valences_;
    StarMoves& moves_;
    std::vector<FlipCandidate> candidates_;  ///< of all flips of the way so far, one after another
    std::vector<Flip> way_;
    std::vector<std::int32_t> touched_;  ///< by the way
    std::vector<std::int32_t> star_;     ///< the triangles of those
    std::vector<PlanPoint> places_;      ///< of those, before it
    int looks_left_ = 0;
};

/// Improves the triangles from `first` on, those in `also`, and their neighbors, in rounds of
///   - flips and collapses that bring vertices nearer to six neighbors (Valences),
///   - ways of several flips that bring a vertex of five and one of seven neighbors to their
///     opposites, and flips that make bad triangles better (JudgedFlips),
///   - moves of one vertex at a time to where its triangles are best (StarMoves).
/// In the end all but fixed edges are Delaunay again. Vertices on fixed edges, and those in
/// `fixed`, stay; but of those from number `corners` on that lie between two corners of the border,
/// where sizes vary, some slide along it and some are taken out. Vertices that were collapsed are
/// used by no triangle. Deterministic.
void smooth(FlatMesh& mesh, SizeField& size, std::int32_t first, std::span<const std::int32_t> also,
            std::int32_t corners, std::span<const std::int32_t> fixed, const Check& check);

}  // namespace realmodel::meshing
