// SPDX-License-Identifier: GPL-3.0-or-later
// How long edges should be at each place, and what a request asks for.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "meshing/check.hpp"
#include "meshing/region_graph.hpp"
#include "realmodel/meshing/triangulation.hpp"

namespace realmodel::meshing {

/// A segment (or a point: both ends equal) near which edges are short: `least` at it, growing as
/// `start` + growth * distance where that is more.
struct SizeSource {
    PlanPoint a, b;
    double start;
    double least;
    /// No more than the field's gradation, which holds where nothing else is said.
    double growth = std::numeric_limits<double>::infinity();
};

/// The least of what sources ask for, and of a largest length. No length differs from another by
/// more than gradation * distance. Kept in a quadtree whose leaves are no larger than edges are
/// there, each with the lengths at its corners. Leaves are made where they are asked for, so asking
/// changes the field; what it answers does not depend on what was asked before.
class SizeField {
public:
    /// The same length everywhere.
    explicit SizeField(double length) : largest_(length), smallest_(length) {}

    /// Between `low` and `high`, beyond them what is at their border. From `most_leaves` on it
    /// refuses to answer, by InputError "too_large".
    SizeField(double largest, double gradation, std::vector<SizeSource> sources,
              const PlanPoint& low, const PlanPoint& high, double most_leaves);

    bool is_uniform() const { return nodes_.empty(); }
    double largest() const { return largest_; }
    /// No length between `low` and `high` is less.
    double smallest() const { return smallest_; }
    double at(const PlanPoint& p) { return nodes_.empty() ? largest_ : look_up(p); }

private:
    static constexpr std::int32_t kInner = -1, kLeaf = -2;

    /// An inner node: the first of its four children; a leaf: its number; a node that nobody has
    /// asked for yet: the first of the sources that may count in it, and how many they are.
    struct QuadtreeNode {
        std::int32_t index, count;
    };
    struct QuadtreeCell {
        double x, y, width;
        std::int32_t depth;
    };
    /// A leaf, and where it is among the cells of its size.
    struct CachedLeaf {
        double scale, column, row;
        std::int32_t leaf;
    };
    double look_up(const PlanPoint& p);
    void open(std::int32_t node, const QuadtreeCell& cell);
    void make_leaf(std::int32_t node, const std::array<double, 4>& lengths);
    std::array<double, 4> corner_lengths(const QuadtreeCell& cell,
                                         std::span<const std::int32_t> sources) const;
    double length_at(const SizeSource& source, double x, double y) const;

    double largest_, smallest_, gradation_ = 0, most_leaves_ = 0;
    PlanPoint low_{};
    double width_ = 0;
    std::vector<SizeSource> sources_;
    std::vector<QuadtreeNode> nodes_;
    std::vector<std::int32_t> candidates_;      // numbers of sources
    std::vector<std::array<float, 4>> leaves_;  // shares of the largest length
    CachedLeaf last_{0, 1, 1, 0};               // none yet
};

/// How much lengths may differ from place to place, for each unit between them.
inline constexpr double kGradation = 0.25;

/// The sources of a request's local lengths and densities. `scale` multiplies what densities ask
/// for. @throws InputError "size" and "density".
std::vector<SizeSource> requested_sources(const RegionGraph& graph, const MeshRequest& request,
                                          double edge_length, double scale);

/// About how many edges lie along the sources within a box: no mesh has fewer.
double pieces_along(std::span<const SizeSource> sources, const PlanPoint& low,
                    const PlanPoint& high);

/// The longest edge that a request by density allows: four times what the points, evenly spread
/// over the region, would ask for.
double longest_by_density(const RegionGraph& graph, const MeshRequest& request);

/// The distinct lengths that a field has over whole areas, where lattices fit: the largest, and
/// those of local lengths with room around them.
std::vector<double> lattice_lengths(const MeshRequest& request, SizeField& size);

/// About how many triangles of these sizes fill a region.
double triangles_in(const RegionGraph& graph, SizeField& size, const Check& check);

}  // namespace realmodel::meshing
