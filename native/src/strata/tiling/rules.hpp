// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "realmodel/strata/stack.hpp"
#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {

inline bool cuts(Rule rule) {
    return rule == Rule::kErosional || rule == Rule::kDiscontinuous;
}
inline bool protects(Rule rule) {
    return rule == Rule::kBase || rule == Rule::kDiscontinuous;
}

/// Replays the rules forward in time: turns each surface S_k, as it comes, into e_k, what it leaves
/// as the top of the rock: S_k itself, or the top so far (the floor that may not be cut) where S_k
/// lies below it and its rule does not cut (something protects itself). The layers of e_k are made
/// of facets of S_k and of older layers, all in the planes of input triangles.
class RuleReplay {
public:
    /// rules: of all surfaces, oldest first; what no later surface asks for is not kept.
    RuleReplay(exact::PlanArrangement& geometry, std::vector<Rule> rules, int threads,
               const Progress* progress);

    /// The next surface, oldest first; returns its e_k.
    SurfaceTiling add(SurfaceTiling surface);

private:
    bool needs_top(std::size_t from) const;
    bool needs_floor(std::size_t from) const;

    exact::PlanArrangement& geometry_;
    std::vector<Rule> rules_;
    int threads_;
    const Progress* progress_;
    std::size_t next_ = 0;
    std::optional<SurfaceTiling> top_, floor_;
};

}  // namespace realmodel::strata
