// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs of a vertex with five and one with seven neighbours, brought together. Private.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "meshing/star_moves.hpp"
#include "meshing/valences.hpp"

namespace realmodel::meshing {

/// A vertex with five neighbours beside one with seven is a dislocation: the end of a row. A flip
/// beside it that changes no strain takes it one row on; where it meets an opposite one, both are
/// gone (Hirth and Lothe 1982, "Theory of dislocations"; Surazhsky and Gotsman 2003, "Explicit
/// surface remeshing", drift irregular vertices alike). Looks for such ways of some flips, and
/// takes those that lessen the strain.
class Dislocations {
public:
    Dislocations(Valences& valences, StarMoves& moves) : valences_(valences), moves_(moves) {}

    /// Whether a way from a vertex was found, of at most so many flips, and taken.
    bool glide(std::int32_t vertex, int most_flips);

private:
    using Edge = std::array<std::int32_t, 2>;
    struct Candidate {
        int gain;
        Edge edge;
    };
    struct Flip {
        Edge before, after;
    };
    bool seek(std::span<const std::int32_t> changed, int gained, int flips_left);
    void find_candidates(std::span<const std::int32_t> changed);
    Side side_between(const Edge& edge) const;
    bool may_change(std::int32_t vertex) const;
    bool is_better_shaped(int gained);
    double badness();

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
