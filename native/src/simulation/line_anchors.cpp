// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/line_anchors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/vectors.hpp"
#include "realmodel/base/elementary.hpp"

namespace realmodel::simulation {

namespace {

constexpr double kNearerOnSteps = 0.7;
constexpr double kCornerTurn = 0.35;  ///< radians: a wall that turns by more has a corner

/// Points in a grid of squares, at least `spacing` apart; those of one chain, `share` of it.
class SparsePoints {
public:
    SparsePoints(const PlanPoint& origin, double side) : origin_(origin), side_(side) {}

    bool add(const PlanPoint& p, double spacing, std::int32_t chain, double share) {
        const auto [column, row] = square(p);
        const auto reach = static_cast<std::int64_t>(std::ceil(spacing / side_));
        for (std::int64_t c = column - reach; c <= column + reach; ++c) {
            for (std::int64_t r = row - reach; r <= row + reach; ++r) {
                const auto found = squares_.find(key(c, r));
                if (found == squares_.end()) continue;
                for (const std::int32_t i : found->second) {
                    const bool is_own = chains_[index(i)] == chain || chains_[index(i)] < 0;
                    if (distance(points[index(i)], p) < (is_own ? share : 1) * spacing)
                        return false;
                }
            }
        }
        squares_[key(column, row)].push_back(static_cast<std::int32_t>(points.size()));
        points.push_back(p);
        chains_.push_back(chain);
        return true;
    }
    std::vector<PlanPoint> points;

private:
    std::array<std::int64_t, 2> square(const PlanPoint& p) const {
        return {static_cast<std::int64_t>(std::floor((p[0] - origin_[0]) / side_)),
                static_cast<std::int64_t>(std::floor((p[1] - origin_[1]) / side_))};
    }
    static std::int64_t key(std::int64_t column, std::int64_t row) {
        return column * 4294967291 + row;
    }
    PlanPoint origin_;
    double side_;
    std::vector<std::int32_t> chains_;  ///< of each point; -1 of corners
    std::unordered_map<std::int64_t, std::vector<std::int32_t>> squares_;
};

/// The traces as a graph: each pair of ends is one edge, whatever ends or steps there.
struct Graph {
    struct Edge {
        std::int32_t from, to;
        bool is_step, is_of_top;
    };
    std::vector<Edge> edges;
    Buckets<std::int32_t> at;  ///< the edges at each point

    explicit Graph(const Traces& traces) {
        for (const Traces::Segment& s : traces.segments) {
            if (edges.empty() || edges.back().from != s.ends[0] || edges.back().to != s.ends[1])
                edges.push_back({s.ends[0], s.ends[1], false, false});
            edges.back().is_of_top = edges.back().is_of_top || s.block == Traces::kOfTop;
            edges.back().is_step = edges.back().is_step || s.block < 0;
        }
        at = bucketize<std::int32_t>(traces.points.size(), [&](const auto& put) {
            for (std::size_t e = 0; e < edges.size(); ++e) {
                put(index(edges[e].from), static_cast<std::int32_t>(e));
                put(index(edges[e].to), static_cast<std::int32_t>(e));
            }
        });
    }
    std::int32_t other(std::int32_t edge, std::int32_t point) const {
        const Edge& e = edges[index(edge)];
        return e.from == point ? e.to : e.from;
    }
};

/// How sharply the steps and walls at a point turn: pi at an end, 0 where they go straight on or
/// there are none.
double turn_of_steps(const Traces& traces, const Graph& graph, std::int32_t point) {
    std::vector<std::array<double, 2>> directions;
    for (const std::int32_t e : graph.at[index(point)]) {
        if (!graph.edges[index(e)].is_step) continue;
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

/// A run of edges between two points where lines begin, end or meet.
std::vector<std::vector<std::int32_t>> chains_of(const Graph& graph,
                                                 const std::vector<std::uint8_t>& ends) {
    std::vector<std::vector<std::int32_t>> chains;
    std::vector<std::uint8_t> used(graph.edges.size(), 0);
    const auto walk = [&](std::int32_t start, std::int32_t edge) {
        std::vector<std::int32_t> chain{start};
        while (edge >= 0) {
            used[index(edge)] = 1;
            const std::int32_t next = graph.other(edge, chain.back());
            chain.push_back(next);
            edge = -1;
            if (ends[index(next)]) break;
            for (const std::int32_t e : graph.at[index(next)]) {
                if (!used[index(e)]) edge = e;
            }
        }
        chains.push_back(std::move(chain));
    };
    for (const bool only_ends : {true, false}) {
        for (std::size_t p = 0; p < graph.at.size(); ++p) {
            if (only_ends && !ends[p]) continue;
            for (const std::int32_t e : graph.at[p]) {
                if (!used[index(e)]) walk(static_cast<std::int32_t>(p), e);
            }
        }
    }
    return chains;
}

}  // namespace

std::vector<PlanPoint> line_anchors(const Traces& traces,
                                    const std::function<double(const PlanPoint&)>& spacing,
                                    Progress* progress) {
    if (traces.points.empty()) return {};
    const Graph graph(traces);
    double widest = 0;
    for (const PlanPoint& p : traces.points)
        widest = std::max(widest, spacing(p));
    SparsePoints anchors(traces.points.front(), widest);
    const auto add = [&](const PlanPoint& p, std::int32_t chain = -1, double share = 1) {
        anchors.add(p, spacing(p), chain, share);
    };

    std::vector<std::pair<double, std::int32_t>> corners;
    std::vector<std::uint8_t> is_end(traces.points.size(), 0);
    for (std::size_t p = 0; p < traces.points.size(); ++p) {
        const double turn = turn_of_steps(traces, graph, static_cast<std::int32_t>(p));
        if (turn > kCornerTurn) corners.emplace_back(-turn, static_cast<std::int32_t>(p));
        is_end[p] = turn > kCornerTurn || graph.at[p].size() != 2;
    }
    std::sort(corners.begin(), corners.end());
    for (const auto& [turn, p] : corners)
        add(traces.points[index(p)]);

    const auto chains = chains_of(graph, is_end);
    std::vector<double> lengths(chains.size(), 0);
    std::vector<int> kinds(chains.size(), 2);
    for (std::size_t c = 0; c < chains.size(); ++c) {
        for (std::size_t i = 0; i + 1 < chains[c].size(); ++i) {
            const std::int32_t from = chains[c][i], to = chains[c][i + 1];
            for (const std::int32_t e : graph.at[index(from)]) {
                if (graph.other(e, from) != to) continue;
                const Graph::Edge& edge = graph.edges[index(e)];
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
                    const double own = distance(p, q);
                    for (; next < before + own; next += step) {
                        const double part = (next - before) / own;
                        add(moved(p, part, minus(q, p)), number, share);
                    }
                    before += own;
                }
            }
        }
    }
    return std::move(anchors.points);
}

}  // namespace realmodel::simulation
