// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/conform/interval_curves.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "base/parallel_counts.hpp"

namespace realmodel::strata {

/// Asks for what is known of the edges after one.
[[gnu::always_inline]] inline void IntervalCurves::prefetch_edge(const LineEdge* edge) const {
    const std::ptrdiff_t left = collinear_.edges.end() - 1 - edge;
    const LineEdge& far = edge[std::min<std::ptrdiff_t>(24, left)];
    const auto face = static_cast<std::size_t>(far.face);
    prefetch(&conformed_.face_offsets[face]);
    prefetch(&faces_.above[face]);
    prefetch(&faces_.below[face]);
    const LineEdge& near = edge[std::min<std::ptrdiff_t>(8, left)];
    prefetch(&conformed_.vertices[near.begin]);
}

/// Ascending; where two curves start at one vertex the lower end comes first, and of equal
/// curves on one side the younger is the upper.
bool IntervalCurves::before(const IntervalCurve& a, const IntervalCurve& b) const {
    if (a.start != b.start) return a.start < b.start;
    if (a.end != b.end) return a.end < b.end;
    if (a.left != b.left) return b.left;
    const auto surface = [&](const IntervalCurve& curve) {
        return faces_.surface[static_cast<std::size_t>(curve.face)];
    };
    return std::pair(surface(a), a.face) < std::pair(surface(b), b.face);
}

void IntervalCurves::collect(std::size_t number) {
    const auto first = collinear_.edges.begin() + collinear_.edge_offsets[number];
    const auto last = collinear_.edges.begin() + collinear_.edge_offsets[number + 1];
    begins_.clear();
    for (auto edge = first; edge != last; ++edge) {
        const auto [low, high] = std::minmax(edge->from, edge->to);
        if (begins_.size() < static_cast<std::size_t>(high) + 1)
            begins_.resize(static_cast<std::size_t>(high) + 1, 0);
        for (std::int32_t i = low; i < high; ++i)
            ++begins_[static_cast<std::size_t>(i)];
    }
    std::uint32_t total = 0;
    for (std::uint32_t& begin : begins_)
        total += std::exchange(begin, total);
    curves_.resize(total);
    free_.assign(begins_.begin(), begins_.end());
    for (auto edge = first; edge != last; ++edge) {
        prefetch_edge(edge);
        add_curves(*edge);
    }
    for (std::size_t i = 0; i + 1 < begins_.size(); ++i) {
        const auto begin = curves_.begin() + begins_[i], end = curves_.begin() + begins_[i + 1];
        if (end - begin == 2) {
            if (before(begin[1], begin[0])) std::swap(begin[0], begin[1]);
        } else {
            std::sort(begin, end,
                      [&](const IntervalCurve& a, const IntervalCurve& b) { return before(a, b); });
        }
    }
}

void IntervalCurves::add_curves(const LineEdge& edge) {
    const auto face = static_cast<std::size_t>(edge.face);
    const bool left = edge.from < edge.to;
    IntervalCurve curve{0,   0, edge.face, cell_of(faces_.above[face]), cell_of(faces_.below[face]),
                        left};
    const std::int32_t steps = std::abs(edge.to - edge.from);
    std::uint32_t entry = edge.begin;
    std::int32_t vertex = conformed_.vertices[entry];
    std::int32_t interval = left ? edge.from : edge.from - 1;
    for (std::int32_t s = 0; s < steps; ++s) {
        ++entry;
        if (entry == conformed_.face_offsets[face + 1]) entry = conformed_.face_offsets[face];
        const std::int32_t next = conformed_.vertices[entry];
        curve.start = left ? vertex : next;
        curve.end = left ? next : vertex;
        assert(curve.start >= 0 && curve.end >= 0);
        curves_[free_[static_cast<std::size_t>(interval)]++] = curve;
        vertex = next;
        interval += left ? 1 : -1;
    }
}

std::int32_t below_all(std::span<const IntervalCurve> curves, bool left) {
    const auto lowest = std::find_if(curves.begin(), curves.end(), [&](const IntervalCurve& curve) {
        return curve.left == left;
    });
    return lowest == curves.end() ? kOutsideCell : lowest->below;
}

void IntervalCurves::find_crossings(std::size_t number, std::span<const IntervalCurve> curves,
                                    LocalArrangement& scope,
                                    std::vector<ExtraPoint>& missing) const {
    const auto plane = [&](const IntervalCurve& curve) {
        return faces_.plane[static_cast<std::size_t>(curve.face)];
    };
    for (std::size_t i = 0; i < curves.size(); ++i) {
        for (std::size_t j = i + 1; j < curves.size(); ++j) {
            const IntervalCurve &a = curves[i], &b = curves[j];
            if (a.start >= b.start || a.end <= b.end) continue;
            const LineId line = collinear_.representative[number];
            const LineId trace = scope.trace(plane(a), plane(b)).id();
            missing.push_back({line, scope.crossing(line, trace)});
        }
    }
}

}  // namespace realmodel::strata
