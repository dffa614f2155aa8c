// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/sheet_links.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "base/disjoint_sets.hpp"
#include "base/lists.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

/// Finds what of a surface lies beneath some positions.
class SheetLinks {
public:
    SheetLinks(PlanArrangement& geometry, const WholeTriangleFilter& filter,
               const BlockTiling& tiling, const SealedFacets& sealed, const Envelope& parts,
               const Execution& execution)
        : geometry_(geometry),
          filter_(filter),
          tiling_(tiling),
          sealed_(sealed),
          parts_(parts),
          execution_(execution),
          scope_(geometry),
          clipper_(scope_) {}

    /// A sealed facet, whose link is to be found.
    void add(std::int32_t node) {
        const auto i = static_cast<std::size_t>(node - sealed_.first_node);
        const auto point = [&](const Corner& corner) -> const exact::Point& {
            return geometry_.point(corner.point);
        };
        const auto middle =
            i < sealed_.wholes.size()
                ? middle_of(geometry_, sealed_.wholes[i])
                : middle_of(parts_.outlines[sealed_.parts[i - sealed_.wholes.size()]], point);
        searched_.push_back({tiles().tile_at(middle), middle, node, kNothing});
    }

    /// Calls link(node, triangle) with what lies beneath each facet.
    template <class Link>
    void find(const Link& link) {
        if (searched_.empty()) return;
        sort_by_tile();
        // The middle of a convex outline is inside it, so a triangle that it is in for certain
        // shares an area with the outline. The exact test is for the few middles near an edge.
        const auto near = found_in_each<std::pair<std::uint32_t, std::int32_t>>(
            tiling_.whole.size(), execution_, [&](std::size_t t, auto& found) {
                if (filter_.surface[t] == Standing::kBelow) look(t, found);
            });
        for (const auto& [s, t] : near) {
            if (searched_[s].beneath == kNothing && lies_over(searched_[s].node, t))
                searched_[s].beneath = t;
        }
        const auto triangles = static_cast<std::int32_t>(tiling_.whole.size());
        for (Searched& s : searched_) {
            // where rounding put a middle into a tile that nothing beneath it meets
            for (std::int32_t t = 0; t < triangles && s.beneath == kNothing; ++t) {
                if (filter_.surface[static_cast<std::size_t>(t)] == Standing::kBelow &&
                    lies_over(s.node, t))
                    s.beneath = t;
            }
            assert(s.beneath != kNothing);
            if (s.beneath != kNothing) link(s.node, s.beneath);
        }
    }

private:
    static constexpr std::int32_t kNothing = -1;
    struct Searched {
        std::size_t tile;
        std::array<double, 2> middle;
        std::int32_t node;
        std::int32_t beneath;  ///< a triangle of the surface that lies there
    };

    const PlanTiles& tiles() const { return filter_.tiles(); }

    /// Most tiles have none, and that is asked of bytes.
    void sort_by_tile() {
        first_.assign(tiles().size() + 1, 0);
        is_searched_.assign(tiles().size(), 0);
        for (const Searched& s : searched_) {
            ++first_[s.tile + 1];
            is_searched_[s.tile] = 1;
        }
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
        std::stable_sort(searched_.begin(), searched_.end(),
                         [](const Searched& a, const Searched& b) { return a.tile < b.tile; });
    }

    /// Looks which middles lie in a triangle; those near its border go to `near`.
    void look(std::size_t t, std::vector<std::pair<std::uint32_t, std::int32_t>>& near) {
        const auto number = static_cast<std::int32_t>(t);
        const PlanTriangle& triangle = geometry_.plane(tiling_.whole[t]).plan;
        tiles().for_each(filter_.surface_at[t].span, [&](std::size_t tile) {
            if (is_searched_[tile] == 0) return;
            for (auto s = first_[tile]; s < first_[tile + 1]; ++s) {
                const int side = side_of_border(geometry_, triangle, searched_[s].middle);
                if (side == 0) near.emplace_back(s, number);
                // a position is well inside one triangle at the most
                if (side > 0) searched_[s].beneath = number;
            }
        });
    }

    bool lies_over(std::int32_t node, std::int32_t triangle) {
        const auto outline_of = [&](PlaneId plane) {
            return triangle_outline(geometry_, geometry_.plane(plane).plan);
        };
        const auto below = outline_of(tiling_.whole[static_cast<std::size_t>(triangle)]);
        const auto i = static_cast<std::size_t>(node - sealed_.first_node);
        if (i < sealed_.wholes.size())
            return clipper_.overlap(outline_of(sealed_.wholes[i]), below);
        return clipper_.overlap(parts_.outlines[sealed_.parts[i - sealed_.wholes.size()]], below);
    }

    PlanArrangement& geometry_;
    const WholeTriangleFilter& filter_;
    const BlockTiling& tiling_;
    const SealedFacets& sealed_;
    const Envelope& parts_;
    Execution execution_;
    LocalArrangement scope_;
    Clipper clipper_;
    std::vector<Searched> searched_;
    std::vector<std::uint32_t> first_;  ///< of each tile
    std::vector<std::uint8_t> is_searched_;
};

/// Joins sealed triangles that are neighbors over one block.
void join_neighbors(const TriangleLinks& links, const SealedFacets& sealed,
                    const WholeTriangles& wholes, const Construction& construction,
                    DisjointSets& sets, const Execution& execution) {
    const auto count = static_cast<std::int32_t>(sealed.wholes.size());
    const auto block = [&](std::int32_t node) {
        return construction.node_block[static_cast<std::size_t>(node)];
    };
    parallel_each(sealed.wholes.size(), execution, [&](std::size_t i) {
        const PlaneId plane = sealed.wholes[i];
        const std::int32_t node = sealed.first_node + static_cast<std::int32_t>(i);
        for (const PlaneId other : links.of(plane)) {
            if (other <= plane) continue;
            const std::int32_t below = wholes.of(other).below;
            const std::int32_t j = below - sealed.first_node;
            if (j >= 0 && j < count && block(below) == block(node))
                sets.join(static_cast<std::int32_t>(i), j);
        }
    });
}

}  // namespace

void link_sheets(PlanArrangement& geometry, const TriangleLinks& links,
                 const WholeTriangleFilter& filter, const BlockTiling& tiling,
                 const std::vector<std::int32_t>& node_above, const SealedFacets& sealed,
                 const Envelope& parts, const WholeTriangles& wholes, Construction& construction,
                 const Execution& execution) {
    const std::size_t count = sealed.wholes.size();
    DisjointSets sets(count);
    join_neighbors(links, sealed, wholes, construction, sets, execution);
    SheetLinks sheets(geometry, filter, tiling, sealed, parts, execution);
    for (std::size_t i = 0; i < count + sealed.parts.size(); ++i) {
        const auto k = static_cast<std::int32_t>(i);
        if (i >= count || sets.find(k) == k) sheets.add(sealed.first_node + k);
    }
    sheets.find([&](std::int32_t node, std::int32_t triangle) {
        construction.links.emplace_back(node, node_above[static_cast<std::size_t>(triangle)]);
    });
}

}  // namespace realmodel::strata
