// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/traces.hpp"

#include <algorithm>
#include <tuple>

#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "simulation/column_heights.hpp"

namespace realmodel::simulation {

namespace {

/// An edge of the top (even key) or bottom (odd key) of a block, kept at its lesser end.
struct BorderEdge {
    std::int32_t to, key, direction;
};

}  // namespace

Traces traces_of(const ComplexView& model, Progress* progress) {
    const auto top_of_all = static_cast<std::int32_t>(2 * model.blocks);
    const auto edges = bucketize<BorderEdge>(model.vertex_count(), [&](const auto& put) {
        for (std::size_t f = 0; f < model.face_count(); ++f) {
            poll(progress, f);
            const std::int32_t first = model.block(model.cell(f, 0)),
                               second = model.block(model.cell(f, 1));
            if (first == second || is_vertical(model, f)) continue;
            const bool first_below = faces_up(model, f);
            const auto loop = model.face(f);
            std::int32_t from = loop.back();
            for (const std::int32_t to : loop) {
                for (const bool is_top : {true, false}) {
                    const std::int32_t block = is_top == first_below ? first : second;
                    if (block >= 0)
                        put(index(std::min(from, to)),
                            BorderEdge{std::max(from, to), 2 * block + (is_top ? 0 : 1),
                                       (from < to) == first_below ? 1 : -1});
                }
                const std::int32_t below = first_below ? first : second,
                                   above = first_below ? second : first;
                if (below >= 0 && above < 0)
                    put(index(std::min(from, to)), BorderEdge{std::max(from, to), top_of_all,
                                                              (from < to) == first_below ? 1 : -1});
                from = to;
            }
        }
    });
    std::vector<std::tuple<std::int32_t, std::int32_t, std::int32_t>> found;  // ends, block
    std::vector<BorderEdge> own;
    for (std::size_t v = 0; v < edges.size(); ++v) {
        poll(progress, v);
        own.assign(edges[v].begin(), edges[v].end());
        std::sort(own.begin(), own.end(), [](const BorderEdge& a, const BorderEdge& b) {
            return std::tie(a.to, a.key) < std::tie(b.to, b.key);
        });
        std::int32_t open = -1;  // the key of the last open edge
        std::int32_t open_to = -1;
        for (std::size_t i = 0; i < own.size();) {
            std::int32_t sum = 0;
            std::size_t j = i;
            for (; j < own.size() && own[j].to == own[i].to && own[j].key == own[i].key; ++j)
                sum += own[j].direction;
            if (sum != 0) {
                const std::int32_t key = own[i].key;
                if (key == top_of_all) {
                    found.emplace_back(static_cast<std::int32_t>(v), own[i].to, Traces::kOfTop);
                } else if (key % 2 == 1 && open == key - 1 && open_to == own[i].to) {
                    found.back() = {static_cast<std::int32_t>(v), own[i].to, key / 2};
                } else {
                    found.emplace_back(static_cast<std::int32_t>(v), own[i].to, -1);
                }
                open = key;
                open_to = own[i].to;
            }
            i = j;
        }
    }
    Traces traces;
    const auto plan = [&](std::int32_t v) {
        const auto p = model.vertex(v);
        return PlanPoint{p[0], p[1]};
    };
    for (const auto& [from, to, block] : found) {
        traces.points.push_back(plan(from));
        traces.points.push_back(plan(to));
    }
    std::sort(traces.points.begin(), traces.points.end());
    traces.points.erase(std::unique(traces.points.begin(), traces.points.end()),
                        traces.points.end());
    const auto number = [&](std::int32_t v) {
        const auto at = std::lower_bound(traces.points.begin(), traces.points.end(), plan(v));
        return static_cast<std::int32_t>(at - traces.points.begin());
    };
    for (const auto& [from, to, block] : found) {
        const std::int32_t a = number(from), b = number(to);
        if (a != b) traces.segments.push_back({{std::min(a, b), std::max(a, b)}, block});
    }
    std::sort(traces.segments.begin(), traces.segments.end());
    traces.segments.erase(std::unique(traces.segments.begin(), traces.segments.end()),
                          traces.segments.end());
    return traces;
}

}  // namespace realmodel::simulation
