// SPDX-License-Identifier: GPL-3.0-or-later
// Lines are moved to anchors by nearness: what lies nearest to an anchor goes to it. A line then
// runs from anchor to anchor along edges of their Delaunay triangulation, so lines cannot cross
// after they were moved, whatever they were; and anchors are apart, so no angle between two is
// sharp.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numbers>

#include "base/algorithms.hpp"
#include "base/disjoint_sets.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/vectors.hpp"
#include "meshing/size_field.hpp"
#include "realmodel/base/elementary.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/simulation/layered_mesh.hpp"
#include "simulation/column_heights.hpp"
#include "simulation/traces.hpp"

namespace realmodel::simulation {

namespace {

constexpr double kAnchorSpacing = 0.8;  ///< of an edge length

double distance_to_line(const PlanPoint& p, std::span<const PlanPoint> line) {
    double nearest = HUGE_VAL;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const PlanPoint &a = line[i], &b = line[std::min(i + 1, line.size() - 1)];
        const PlanPoint at = moved(a, nearest_share(a, b, p), minus(b, a));
        nearest = std::min(nearest, std::sqrt(squared_distance(p, at)));
    }
    return nearest;
}

double local_length(const PlanPoint& p, double edge_length, std::span<const LineLength> lengths) {
    double least = edge_length;
    for (const LineLength& size : lengths) {
        const double beyond =
            size.line.empty() ? 0 : std::max(0.0, distance_to_line(p, size.line) - size.distance);
        least = std::min(least, size.length + meshing::kGradation * beyond);
    }
    return least;
}

using PlanLink = std::array<std::int32_t, 2>;
/// What lies along a link between two anchors: a block that ends there, or -1: a step.
struct LinkUse {
    PlanLink link;
    std::int32_t block;
    auto operator<=>(const LinkUse&) const = default;
};

/// The anchors that lines run along, and what is along each pair, sorted.
std::vector<LinkUse> linked_anchors(const Traces& traces, std::span<const PlanPoint> anchors,
                                    const meshing::ConstrainedTriangulation& delaunay,
                                    Progress* progress) {
    std::vector<std::vector<std::int32_t>> neighbors(anchors.size());
    for (const auto& t : delaunay.triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            neighbors[index(t[i])].push_back(t[(i + 1) % 3]);
            neighbors[index(t[i])].push_back(t[(i + 2) % 3]);
        }
    }
    for (auto& adjacent : neighbors) {
        sort_unique(adjacent);
    }
    const auto nearest = [&](std::int32_t from, const PlanPoint& p) {
        double best = squared_distance(anchors[index(from)], p);
        for (bool moved = true; moved;) {
            moved = false;
            for (const std::int32_t n : neighbors[index(from)]) {
                const double squared = squared_distance(anchors[index(n)], p);
                if (squared < best || (squared == best && n < from)) {
                    best = squared;
                    from = n;
                    moved = true;
                    break;
                }
            }
        }
        return from;
    };
    std::vector<LinkUse> links;
    std::int32_t at = 0;
    std::size_t count = 0;
    for (const Traces::TraceSegment& segment : traces.segments) {
        poll(progress, count++);
        const PlanPoint &u = traces.points[index(segment.ends[0])],
                        &v = traces.points[index(segment.ends[1])];
        at = nearest(at, u);
        for (std::int32_t here = at;;) {
            const PlanPoint& a = anchors[index(here)];
            const double at_u = squared_distance(a, u), at_v = squared_distance(a, v);
            std::int32_t next = -1;
            double first = HUGE_VAL;
            for (const std::int32_t n : neighbors[index(here)]) {
                const double before = squared_distance(anchors[index(n)], u) - at_u,
                             after = squared_distance(anchors[index(n)], v) - at_v;
                // of two that are as near the first is taken, here and where lines go on
                if (after > 0 || (after == 0 && n > here)) continue;
                const double where = after < 0 ? before / (before - after) : 1;
                if (where < first) {
                    first = where;
                    next = n;
                }
            }
            if (next < 0) break;
            links.push_back({unordered(here, next), std::max(segment.block, -1)});
            here = next;
        }
    }
    sort_unique(links);
    return links;
}

/// The rock mass of each triangle of anchors: that of most of the area that no line divides.
std::vector<std::int32_t> rocks_of(const ComplexView& model, const RockBlocks& blocks,
                                   std::span<const PlanPoint> anchors,
                                   const meshing::ConstrainedTriangulation& delaunay,
                                   std::span<const LinkUse> links, const Execution& execution) {
    constexpr std::array<std::array<double, 3>, 7> kShares{{{1. / 3, 1. / 3, 1. / 3},
                                                            {.6, .2, .2},
                                                            {.2, .6, .2},
                                                            {.2, .2, .6},
                                                            {.1, .45, .45},
                                                            {.45, .1, .45},
                                                            {.45, .45, .1}}};
    const auto& triangles = delaunay.triangles;
    std::vector<PlanPoint> samples;
    for (const auto& t : triangles) {
        for (const auto& share : kShares) {
            PlanPoint p{};
            for (std::size_t i = 0; i < 3; ++i) {
                for (std::size_t axis = 0; axis < 2; ++axis)
                    p[axis] += share[i] * anchors[index(t[i])][axis];
            }
            samples.push_back(p);
        }
    }
    const ColumnHeights columns(model, blocks, samples, execution);
    DisjointSets faces(triangles.size());
    std::vector<std::int32_t> open;  // triangles that no line divides from beyond the anchors
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t n = delaunay.neighbors[t][i];
            const PlanLink edge = unordered(triangles[t][i], triangles[t][(i + 1) % 3]);
            if (!items_with_key(links, edge, &LinkUse::link).empty()) continue;
            if (n >= 0) {
                faces.join(static_cast<std::int32_t>(t), n);
            } else {
                open.push_back(static_cast<std::int32_t>(t));
            }
        }
    }
    std::vector<std::vector<double>> area(triangles.size());  // of each rock mass, then outside
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const auto face = index(faces.find(static_cast<std::int32_t>(t)));
        area[face].resize(blocks.count() + 1);
        const auto [a, b, c] = triangles[t];
        const double weight = twice_area(anchors[index(a)], anchors[index(b)], anchors[index(c)]);
        for (std::size_t s = 0; s < kShares.size(); ++s) {
            const std::int32_t rock = columns.rock(t * kShares.size() + s);
            area[face][rock < 0 ? blocks.count() : index(rock)] += weight;
        }
    }
    std::vector<std::uint8_t> is_open(triangles.size(), 0);  // it lies outside
    for (const std::int32_t t : open)
        is_open[index(faces.find(t))] = 1;
    std::vector<std::int32_t> rocks(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const auto face = index(faces.find(static_cast<std::int32_t>(t)));
        const auto& areas = area[face];
        const auto most =
            static_cast<std::size_t>(std::max_element(areas.begin(), areas.end()) - areas.begin());
        rocks[t] =
            is_open[face] != 0 || most == blocks.count() ? -1 : static_cast<std::int32_t>(most);
    }
    return rocks;
}

/// The closed lines that the region lies to the left of.
std::vector<meshing::Ring> border_rings(const PlanLines& lines) {
    std::map<std::int32_t, std::vector<std::int32_t>> next;
    for (const PlanSegment& s : lines.segments) {
        if (s.left_rock >= 0 && s.right_rock < 0) next[s.from].push_back(s.to);
        if (s.right_rock >= 0 && s.left_rock < 0) next[s.to].push_back(s.from);
    }
    const auto direction = [&](std::int32_t a, std::int32_t b) {
        return elementary::atan2(lines.points[index(b)][1] - lines.points[index(a)][1],
                                 lines.points[index(b)][0] - lines.points[index(a)][0]);
    };
    std::vector<meshing::Ring> rings;
    while (!next.empty()) {
        const std::int32_t start = next.begin()->first;
        std::int32_t before = -1, here = start;
        meshing::Ring ring;
        do {
            auto& choices = next[here];
            std::size_t best = 0;
            if (choices.size() > 1 && before >= 0) {
                // the sharpest turn to the left keeps what touches in a point apart
                double sharpest = HUGE_VAL;
                for (std::size_t i = 0; i < choices.size(); ++i) {
                    double turn = direction(here, before) - direction(here, choices[i]);
                    while (turn <= 0)
                        turn += 2 * std::numbers::pi;
                    if (turn < sharpest) {
                        sharpest = turn;
                        best = i;
                    }
                }
            }
            ring.push_back(lines.points[index(here)]);
            before = here;
            here = choices[best];
            choices.erase(choices.begin() + static_cast<std::ptrdiff_t>(best));
            if (choices.empty()) next.erase(before);
        } while (here != start && next.contains(here));
        assert(here == start);
        rings.push_back(std::move(ring));
    }
    return rings;
}

}  // namespace

PlanLines plan_lines(const ComplexView& model, std::span<const std::int32_t> block_rock,
                     double edge_length, std::span<const LineLength> lengths,
                     const Execution& execution) {
    const RockBlocks blocks(block_rock);
    const Traces traces = traces_of(model, execution.progress);
    const auto spacing = [&](const PlanPoint& p) {
        return kAnchorSpacing * local_length(p, edge_length, lengths);
    };
    PlanLines lines;
    lines.points = line_anchors(traces, spacing, execution.progress);
    const auto delaunay = meshing::constrained_delaunay(lines.points, {});
    if (delaunay.triangles.empty()) {
        throw InputError("nothing", "the model is smaller in plan than the edge length");
    }
    const auto links = linked_anchors(traces, lines.points, delaunay, execution.progress);
    const auto rocks = rocks_of(model, blocks, lines.points, delaunay, links, execution);
    std::map<PlanLink, PlanLink> sides;  // the rock masses left and right of each link
    for (std::size_t t = 0; t < delaunay.triangles.size(); ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t a = delaunay.triangles[t][i], b = delaunay.triangles[t][(i + 1) % 3];
            auto& beside = sides.try_emplace(unordered(a, b), PlanLink{-1, -1}).first->second;
            beside[a < b ? 0 : 1] = rocks[t];
        }
    }
    lines.ending_offsets.push_back(0);
    for (const auto along : groups_of(links, &LinkUse::link)) {
        const PlanLink& link = along[0].link;
        const auto& [left, right] = sides.at(link);
        if (left < 0 && right < 0) continue;
        lines.segments.push_back(
            {link[0], link[1], left, right, along[0].block < 0 || left != right});
        for (const LinkUse& use : along)
            if (use.block >= 0) lines.ending_blocks.push_back(use.block);
        lines.ending_offsets.push_back(static_cast<std::int32_t>(lines.ending_blocks.size()));
    }
    for (const Traces::TraceSegment& s : traces.segments) {
        if (s.block < 0)
            lines.steps.push_back(
                {traces.points[index(s.ends[0])], traces.points[index(s.ends[1])]});
    }
    lines.rings = border_rings(lines);
    if (lines.rings.empty()) {
        throw InputError("nothing", "the model is smaller in plan than the edge length");
    }
    return lines;
}

}  // namespace realmodel::simulation
