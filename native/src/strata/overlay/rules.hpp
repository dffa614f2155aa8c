// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "realmodel/strata/stack.hpp"
#include "strata/overlay/whole_triangles.hpp"
#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {

/// Replays the rules forward in time: turns each surface S_k, as it comes, into e_k, what it leaves
/// as the top of the rock: S_k itself, or the top so far (the floor that may not be cut) where S_k
/// lies below it and its rule does not cut (something protects itself). The tilings of e_k are made
/// of facets of S_k and of older tilings, all in the planes of input triangles.
///
/// `Raising` says how: raise(surface, bound) is the higher of the two where there is a surface,
/// first(e) a bound that has nothing but e, and cover(bound, e, surface) a bound with e where there
/// is a surface. One that can empty the rock also has lower(bound, bound), where there are both,
/// lowest(...), what is below the oldest surface, and stays(lowest), what of it stays.
template <class Raising>
class RuleReplay {
public:
    using Tiling = typename Raising::Tiling;
    using Bound = typename Raising::Bound;

    /// rules: of all surfaces, oldest first; what no later surface asks for is not kept. fills: as
    /// StackInput has it.
    RuleReplay(Raising raising, std::vector<Rule> rules, std::vector<std::uint8_t> fills = {})
        : raising_(std::move(raising)), rules_(std::move(rules)), fills_(std::move(fills)) {}

    /// The next surface, oldest first; returns its e_k.
    Tiling add(Tiling surface) {
        const std::size_t number = next_++;
        const Rule rule = rules_[number];
        raising_.begin(surface);
        std::optional<Tiling> raised;
        if (const std::optional<Bound> low = bound_after_emptying(rule)) {
            raised = raising_.raise(surface, *low);
        } else if (const auto& bound = meaning(rule).cuts ? floor_ : top_; bound && !is_emptied_) {
            raised = raising_.raise(surface, *bound);
        }
        const Tiling& e = raised ? *raised : surface;
        if constexpr (kCanEmpty) {
            if (number < fills_.size()) lowest_ = raising_.lowest(lowest_, e, fills_[number] != 0);
        }
        const auto renew = [&](std::optional<Bound>& bound) {
            bound = bound ? raising_.cover(*bound, e, surface) : raising_.first(e);
        };
        if (!is_needed_later(false)) {
            top_.reset();
        } else {
            renew(top_);
        }
        if (!is_needed_later(true)) {
            floor_.reset();
        } else if (meaning(rule).protects) {
            if (is_emptied_ && floor_) {  // what is protected may be higher than the rock
                floor_ = raising_.cover(*floor_, raising_.raise(e, *floor_), surface);
            } else {
                renew(floor_);
            }
        }
        return raised ? std::move(*raised) : std::move(surface);
    }

    /// All that is there becomes air, or all above what is below the oldest surface, the top of
    /// which is the result; what is protected stays so. From now on the floor may be above the
    /// top: then nothing below the top may be cut.
    std::optional<Tiling> clear_rock() {
        is_emptied_ = true;
        top_.reset();
        if constexpr (kCanEmpty) {
            if (lowest_) lowest_ = raising_.stays(std::move(*lowest_));
            top_ = lowest_;
        }
        return lowest_;
    }

private:
    static constexpr bool kCanEmpty = requires(Raising raising, Bound bound) {
        raising.lower(bound, bound);
    };

    /// What a surface must be raised to once the rock was emptied.
    std::optional<Bound> bound_after_emptying(Rule rule) {
        if constexpr (kCanEmpty) {
            if (!is_emptied_ || !top_) return std::nullopt;
            if (!meaning(rule).cuts) return top_;
            if (floor_) return raising_.lower(*top_, *floor_);
        }
        return std::nullopt;
    }
    /// The floor only matters to surfaces that cut: the top, which bounds the others, is never
    /// below it, but after the rock was emptied.
    bool is_needed_later(bool by_cutting) const {
        return std::any_of(
            rules_.begin() + static_cast<std::ptrdiff_t>(next_), rules_.end(),
            [&](Rule r) { return meaning(r).cuts == by_cutting || (is_emptied_ && !by_cutting); });
    }

    Raising raising_;
    std::vector<Rule> rules_;
    std::vector<std::uint8_t> fills_;
    std::size_t next_ = 0;
    bool is_emptied_ = false;
    std::optional<Bound> top_, floor_;
    std::optional<Tiling> lowest_;
};

/// The higher of a surface and a bound, where there is a surface. Polygons that are `excluded` are
/// not among the result: they lie elsewhere, or the bound is above them.
/// @param excluded  of each polygon of the surface; empty: none
SurfaceTiling raise_tiling(exact::PlanArrangement& geometry, const SurfaceTiling& surface,
                           const SurfaceTiling& bound, std::span<const std::uint8_t> excluded,
                           const Execution& execution);

/// What of an older tiling the surface does not cover; facets that it covers nowhere are not
/// divided.
SurfaceTiling uncovered_tiling(exact::PlanArrangement& geometry, const SurfaceTiling& older,
                               const SurfaceTiling& surface, const Execution& execution);

/// The lower one of two bounds where there are both.
SurfaceTiling lower_tiling(exact::PlanArrangement& geometry, const SurfaceTiling& one,
                           SurfaceTiling other, const Execution& execution);

/// The lower one of two tilings, and that which there is where the other one is not. Where `one`
/// has kSky it stays, and so where it has nothing and the other one fills a body.
SurfaceTiling lowest_tiling(exact::PlanArrangement& geometry, const SurfaceTiling& one,
                            const SurfaceTiling& other, bool fills, const Execution& execution);

/// Rules on whole tilings.
class TilingRaising {
public:
    using Tiling = SurfaceTiling;
    using Bound = SurfaceTiling;

    TilingRaising(exact::PlanArrangement& geometry, const Execution& execution)
        : geometry_(geometry), execution_(execution) {}

    void begin(const SurfaceTiling&) const {}
    SurfaceTiling raise(const SurfaceTiling& surface, const SurfaceTiling& bound) const;
    SurfaceTiling first(const SurfaceTiling& e) const { return e; }
    SurfaceTiling lower(const SurfaceTiling& one, const SurfaceTiling& other) const {
        return lower_tiling(geometry_, one, other, execution_);
    }
    SurfaceTiling cover(const SurfaceTiling& older, const SurfaceTiling& newer,
                        const SurfaceTiling& surface) const;
    /// The top of what is below the oldest surface, with kSky where a body was there first.
    /// @param e  what the next surface left as the top of the rock; fills: it is one of a body
    SurfaceTiling lowest(const std::optional<SurfaceTiling>& so_far, const SurfaceTiling& e,
                         bool fills) const;
    /// The same as a surface: with nothing where a body was there first.
    SurfaceTiling stays(SurfaceTiling lowest) const;

private:
    exact::PlanArrangement& geometry_;
    Execution execution_;
};

/// What is carried along while rules are replayed for blocks: the top so far, or the floor. Where
/// there is none its pieces are void.
struct BlockBound {
    BlockTiling tiling;
    std::vector<Cover> cover;  ///< of each tile without a border
};

/// Rules on tilings of which most triangles stay whole.
class BlockRaising {
public:
    using Tiling = BlockTiling;
    using Bound = BlockBound;

    BlockRaising(exact::PlanArrangement& geometry, const BorderEdges& borders,
                 double largest_height, const Execution& execution)
        : geometry_(geometry),
          filter_(geometry, borders, largest_height, execution),
          execution_(execution) {}

    void begin(const BlockTiling& surface) { filter_.begin(surface); }
    BlockTiling raise(const BlockTiling& surface, const BlockBound& bound);
    BlockBound first(const BlockTiling& e);
    BlockBound cover(const BlockBound& older, const BlockTiling& newer, const BlockTiling&);

private:
    static FacetView view(const BlockBound& bound) {
        return {bound.tiling.whole,       {}, bound.tiling.pieces,
                bound.tiling.piece_plane, {}, bound.cover};
    }
    SurfaceTiling exact_facets(const BlockTiling& bound);

    exact::PlanArrangement& geometry_;
    WholeTriangleFilter filter_;
    Execution execution_;
};

}  // namespace realmodel::strata
