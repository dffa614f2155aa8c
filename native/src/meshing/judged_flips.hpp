// SPDX-License-Identifier: GPL-3.0-or-later
// Flips that are judged by what triangles become once their vertices have moved.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "meshing/star_moves.hpp"
#include "meshing/valences.hpp"

namespace realmodel::meshing {

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
    struct Candidate {
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
    std::vector<Candidate> candidates_;  ///< of all flips of the way so far, one after another
    std::vector<Flip> way_;
    std::vector<std::int32_t> touched_;  ///< by the way
    std::vector<std::int32_t> star_;     ///< the triangles of those
    std::vector<PlanPoint> places_;      ///< of those, before it
    int looks_left_ = 0;
};

}  // namespace realmodel::meshing
