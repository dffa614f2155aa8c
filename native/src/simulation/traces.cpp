// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/traces.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/algorithms.hpp"
#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/vectors.hpp"
#include "realmodel/base/elementary.hpp"
#include "simulation/column_heights.hpp"
#include "spatial/hash_grid.hpp"

namespace realmodel::simulation {

namespace {

/// An edge of the top (even key) or bottom (odd key) of a block, kept at its lesser end.
struct BoundaryEdge {
    std::int32_t to, key, direction;
};

/// The edges of tops and bottoms of blocks, and of the top of the model (as of a block more).
Buckets<BoundaryEdge> border_edges(const ComplexView& model, Progress* progress) {
    return bucketize<BoundaryEdge>(model.vertex_count(), [&](const auto& put) {
        for (std::size_t f = 0; f < model.face_count(); ++f) {
            poll(progress, f);
            std::int32_t below = model.block(model.cell(f, 0)),
                         above = model.block(model.cell(f, 1));
            if (below == above || is_vertical(model, f)) continue;
            const bool is_upward = faces_up(model, f);
            if (!is_upward) std::swap(below, above);
            const auto loop = model.face(f);
            std::int32_t from = loop.back();
            for (const std::int32_t to : loop) {
                const auto add = [&, a = from](std::int32_t key) {
                    const auto [low, high] = unordered(a, to);
                    put(index(low), BoundaryEdge{high, key, (a < to) == is_upward ? 1 : -1});
                };
                if (below >= 0) add(2 * below);
                if (above >= 0) add(2 * above + 1);
                if (below >= 0 && above < 0) add(static_cast<std::int32_t>(2 * model.blocks));
                from = to;
            }
        }
    });
}

/// Of a trace between two vertices: what ends there (Traces::Segment::block).
struct VertexTrace {
    std::int32_t from, to, block;
};

/// Edges that no other face of the same top or bottom continues. One that is open in the top and
/// the bottom of a block is where the block ends without thickness.
std::vector<VertexTrace> open_edges(const ComplexView& model, Progress* progress) {
    const auto edges = border_edges(model, progress);
    const auto top_of_all = static_cast<std::int32_t>(2 * model.blocks);
    std::vector<VertexTrace> traces;
    std::vector<BoundaryEdge> vertex_edges;
    const auto to_and_key = [](const BoundaryEdge& e) { return std::pair(e.to, e.key); };
    for (std::size_t v = 0; v < edges.size(); ++v) {
        poll(progress, v);
        vertex_edges.assign(edges[v].begin(), edges[v].end());
        std::ranges::sort(vertex_edges, {}, to_and_key);
        BoundaryEdge open{-1, -1, 0};  // the last
        for (const auto equal : groups_of(vertex_edges, to_and_key)) {
            std::int32_t sum = 0;
            for (const BoundaryEdge& edge : equal)
                sum += edge.direction;
            if (sum == 0) continue;
            const auto [to, key, direction] = equal[0];
            VertexTrace trace{static_cast<std::int32_t>(v), to, -1};
            if (key == top_of_all) trace.block = Traces::kOfTop;
            if (key % 2 == 1 && open.key == key - 1 && open.to == to) {
                trace.block = key / 2;
                traces.pop_back();  // the step that the top alone would be
            }
            traces.push_back(trace);
            open = equal[0];
        }
    }
    return traces;
}

}  // namespace

Traces traces_of(const ComplexView& model, Progress* progress) {
    const std::vector<VertexTrace> vertex_traces = open_edges(model, progress);
    Traces traces;
    for (const VertexTrace& trace : vertex_traces) {
        traces.points.push_back(plan_of(model, trace.from));
        traces.points.push_back(plan_of(model, trace.to));
    }
    sort_unique(traces.points);
    const auto number = [&](std::int32_t v) {
        const auto at =
            std::lower_bound(traces.points.begin(), traces.points.end(), plan_of(model, v));
        assert(at != traces.points.end() && *at == plan_of(model, v));
        return static_cast<std::int32_t>(at - traces.points.begin());
    };
    for (const VertexTrace& trace : vertex_traces) {
        const auto ends = unordered(number(trace.from), number(trace.to));
        if (ends[0] != ends[1]) traces.segments.push_back({ends, trace.block});
    }
    sort_unique(traces.segments);
    return traces;
}

namespace {

constexpr double kNearerOnSteps = 0.7;
constexpr double kCornerTurn = 0.35;  ///< radians: a wall that turns by more has a corner

/// What lies along each edge of traces, whatever ends or steps there.
struct TraceEdgeUse {
    bool is_step = false, is_of_top = false;
};

/// How sharply the steps and walls at a point turn: pi at an end, 0 where they go straight on or
/// there are none.
double turn_of_steps(const Traces& traces, const EdgeGraph& graph,
                     std::span<const TraceEdgeUse> uses, std::int32_t point) {
    std::vector<std::array<double, 2>> directions;
    for (const std::int32_t e : graph.at[index(point)]) {
        if (!uses[index(e)].is_step) continue;
        const PlanPoint &p = traces.points[index(point)],
                        &q = traces.points[index(graph.other(e, point))];
        const double length = distance(p, q);
        directions.push_back({(q[0] - p[0]) / length, (q[1] - p[1]) / length});
    }
    if (directions.empty()) return 0;
    double sharpest = 0;  // of the edges that have no straight continuation
    for (std::size_t i = 0; i < directions.size(); ++i) {
        double least = std::numbers::pi;
        for (std::size_t j = 0; j < directions.size(); ++j) {
            if (i == j) continue;
            const double cosine = -dot(directions[i], directions[j]);
            least = std::min(least, elementary::acos(std::clamp(cosine, -1.0, 1.0)));
        }
        sharpest = std::max(sharpest, least);
    }
    return sharpest;
}

}  // namespace

EdgeGraph::EdgeGraph(std::size_t points, std::vector<std::array<std::int32_t, 2>> of)
    : edges(std::move(of)), at(bucketize<std::int32_t>(points, [&](const auto& put) {
          for (std::size_t e = 0; e < edges.size(); ++e) {
              for (const std::int32_t point : edges[e])
                  put(index(point), static_cast<std::int32_t>(e));
          }
      })) {}

std::vector<std::vector<std::int32_t>> EdgeGraph::chains(
    std::span<const std::uint8_t> is_end) const {
    std::vector<std::vector<std::int32_t>> made;
    std::vector<std::uint8_t> used(edges.size(), 0);
    const auto walk = [&](std::int32_t start, std::int32_t edge) {
        std::vector<std::int32_t>& chain = made.emplace_back(1, start);
        while (edge >= 0) {
            used[index(edge)] = 1;
            const std::int32_t next = other(edge, chain.back());
            chain.push_back(next);
            edge = -1;
            if (is_end[index(next)] != 0) break;
            for (const std::int32_t e : at[index(next)]) {
                if (used[index(e)] == 0) edge = e;
            }
        }
    };
    for (const bool only_ends : {true, false}) {
        for (std::size_t p = 0; p < at.size(); ++p) {
            if (only_ends && is_end[p] == 0) continue;
            for (const std::int32_t e : at[p]) {
                if (used[index(e)] == 0) walk(static_cast<std::int32_t>(p), e);
            }
        }
    }
    return made;
}

std::vector<PlanPoint> line_anchors(const Traces& traces,
                                    const std::function<double(const PlanPoint&)>& spacing,
                                    Progress* progress) {
    if (traces.points.empty()) return {};
    std::vector<std::array<std::int32_t, 2>> edges;
    std::vector<TraceEdgeUse> uses;
    for (const auto equal : groups_of(traces.segments, &Traces::TraceSegment::ends)) {
        edges.push_back(equal[0].ends);
        TraceEdgeUse& use = uses.emplace_back();
        for (const Traces::TraceSegment& s : equal) {
            use.is_of_top = use.is_of_top || s.block == Traces::kOfTop;
            use.is_step = use.is_step || s.block < 0;
        }
    }
    const EdgeGraph graph(traces.points.size(), std::move(edges));
    double widest = 0;
    for (const PlanPoint& p : traces.points)
        widest = std::max(widest, spacing(p));
    spatial::HashGrid<2> anchors(widest);
    std::vector<std::int32_t> chain_of;  // of each anchor; -1 of corners
    // at least `spacing` from all before, from those of its own chain and corners `share` of it
    const auto add = [&](const PlanPoint& p, std::int32_t chain = -1, double share = 1) {
        const double apart = spacing(p);
        const bool is_near = anchors.any(p, apart, [&](std::size_t i) {
            const bool is_on_chain = chain_of[i] == chain || chain_of[i] < 0;
            return distance(anchors.points()[i], p) < (is_on_chain ? share : 1) * apart;
        });
        if (is_near) return;
        anchors.add(p);
        chain_of.push_back(chain);
    };

    std::vector<std::pair<double, std::int32_t>> corners;
    std::vector<std::uint8_t> is_end(traces.points.size(), 0);
    for (std::size_t p = 0; p < traces.points.size(); ++p) {
        const double turn = turn_of_steps(traces, graph, uses, static_cast<std::int32_t>(p));
        if (turn > kCornerTurn) corners.emplace_back(-turn, static_cast<std::int32_t>(p));
        is_end[p] = turn > kCornerTurn || graph.at[p].size() != 2;
    }
    std::sort(corners.begin(), corners.end());
    for (const auto& [turn, p] : corners)
        add(traces.points[index(p)]);

    const auto chains = graph.chains(is_end);
    std::vector<double> lengths(chains.size(), 0);
    std::vector<int> kinds(chains.size(), 2);
    for (std::size_t c = 0; c < chains.size(); ++c) {
        for (std::size_t i = 0; i + 1 < chains[c].size(); ++i) {
            const std::int32_t from = chains[c][i], to = chains[c][i + 1];
            for (const std::int32_t e : graph.at[index(from)]) {
                if (graph.other(e, from) != to) continue;
                const TraceEdgeUse& edge = uses[index(e)];
                kinds[c] = std::min(kinds[c], edge.is_of_top ? 0 : edge.is_step ? 1 : 2);
            }
            lengths[c] += distance(traces.points[index(from)], traces.points[index(to)]);
        }
    }
    // what bounds the model is followed first, other steps and walls next
    for (const int kind : {0, 1, 2}) {
        const bool steps = kind < 2;
        for (std::size_t c = 0; c < chains.size(); ++c) {
            poll(progress, c);
            if (kinds[c] != kind) continue;
            const auto& chain = chains[c];
            const double length = lengths[c];
            const double share = steps ? kNearerOnSteps : 1;
            const auto number = static_cast<std::int32_t>(c);
            add(traces.points[index(chain.front())], number, share);
            add(traces.points[index(chain.back())], number, share);
            // evenly, then as densely as it takes that none is far from an anchor
            const double apart = spacing(traces.points[index(chain[chain.size() / 2])]);
            const double pieces =
                steps ? std::ceil(length / (std::numbers::sqrt2 * apart))
                      : std::max(1.0, std::round(length / (std::numbers::sqrt2 * apart)));
            for (const double step : {length / pieces, apart / 4}) {
                double next = step, before = 0;
                for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
                    const PlanPoint &p = traces.points[index(chain[i])],
                                    &q = traces.points[index(chain[i + 1])];
                    const double segment_length = distance(p, q);
                    for (; next < before + segment_length; next += step) {
                        const double fraction = (next - before) / segment_length;
                        add(moved(p, fraction, minus(q, p)), number, share);
                    }
                    before += segment_length;
                }
            }
        }
    }
    return anchors.points();
}

}  // namespace realmodel::simulation
