// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/traces.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "base/keep_single.hpp"
#include "base/parallel.hpp"
#include "simulation/column_heights.hpp"

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
    std::vector<VertexTrace> found;
    std::vector<BoundaryEdge> own;
    for (std::size_t v = 0; v < edges.size(); ++v) {
        poll(progress, v);
        own.assign(edges[v].begin(), edges[v].end());
        std::ranges::sort(own, {}, [](const BoundaryEdge& e) { return std::pair(e.to, e.key); });
        BoundaryEdge open{-1, -1, 0};  // the last
        for (std::size_t i = 0, end = 0; i < own.size(); i = end) {
            std::int32_t sum = 0;
            for (; end < own.size() && own[end].to == own[i].to && own[end].key == own[i].key;
                 ++end)
                sum += own[end].direction;
            if (sum == 0) continue;
            const auto [to, key, direction] = own[i];
            VertexTrace trace{static_cast<std::int32_t>(v), to, -1};
            if (key == top_of_all) trace.block = Traces::kOfTop;
            if (key % 2 == 1 && open.key == key - 1 && open.to == to) {
                trace.block = key / 2;
                found.pop_back();  // the step that the top alone would be
            }
            found.push_back(trace);
            open = own[i];
        }
    }
    return found;
}

}  // namespace

Traces traces_of(const ComplexView& model, Progress* progress) {
    const std::vector<VertexTrace> found = open_edges(model, progress);
    Traces traces;
    for (const VertexTrace& trace : found) {
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
    for (const VertexTrace& trace : found) {
        const auto ends = unordered(number(trace.from), number(trace.to));
        if (ends[0] != ends[1]) traces.segments.push_back({ends, trace.block});
    }
    sort_unique(traces.segments);
    return traces;
}

}  // namespace realmodel::simulation
