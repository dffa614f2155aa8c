// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/dsi/roughness.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/counting_sort.hpp"
#include "base/vectors.hpp"

namespace realmodel::interpolation {

using realmodel::dot;

namespace {

using Triangle = std::array<std::int32_t, 3>;

constexpr double kFlat = 1e-12;  // of the squared edge: triangles of less area have no slope

/// A side of a triangle, in the group of the lower of its ends.
struct TriangleEdge {
    std::int32_t high_end, opposite, triangle;
};

/// Height of p over the line from a to b, and where its foot divides a to b.
struct Foot {
    double height, share;
};
Foot foot(const PlanPosition& a, const PlanPosition& b, const PlanPosition& p) {
    const PlanPosition u = minus(b, a), v = minus(p, a);
    return {std::abs(cross(u, v)) / length(u), dot(u, v) / dot(u, u)};
}

bool has_area(const PlanPosition& a, const PlanPosition& b, const PlanPosition& c) {
    const PlanPosition u = minus(b, a), v = minus(c, a);
    const double longest = std::max({dot(u, u), dot(v, v), squared_distance(u, v)});
    return std::abs(cross(u, v)) > kFlat * longest;
}

Hinge hinge(std::span<const PlanPosition> nodes, const std::array<std::int32_t, 4>& of) {
    const auto at = [&](int k) { return nodes[of[k]]; };
    const PlanPosition a = at(0), b = at(1), c = at(2), d = at(3);
    const double length = distance(a, b);
    const Foot left = foot(a, b, c), right = foot(a, b, d);
    // L^2 / (A + B), and the areas are L h / 2.
    const double scale = std::sqrt(2 * length / (left.height + right.height));
    Hinge out{of,
              {-scale * ((1 - left.share) / left.height + (1 - right.share) / right.height),
               -scale * (left.share / left.height + right.share / right.height),
               scale / left.height, scale / right.height},
              {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2},
              {}};
    for (int k = 0; k < 4; ++k) {
        const double x = at(k)[0] - out.middle[0], y = at(k)[1] - out.middle[1];
        out.bending[0] += out.g[k] * x * x / 2;
        out.bending[1] += out.g[k] * x * y;
        out.bending[2] += out.g[k] * y * y / 2;
    }
    return out;
}

}  // namespace

std::vector<Hinge> hinges(std::span<const PlanPosition> nodes,
                          std::span<const Triangle> triangles) {
    auto by_low_end = bucketize<TriangleEdge>(nodes.size(), [&](const auto& visit) {
        for (std::size_t number = 0; number < triangles.size(); ++number) {
            const Triangle& t = triangles[number];
            if (!has_area(nodes[t[0]], nodes[t[1]], nodes[t[2]])) continue;
            for (int k = 0; k < 3; ++k) {
                const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
                visit(low, TriangleEdge{high, t[(k + 2) % 3], static_cast<std::int32_t>(number)});
            }
        }
    });
    std::vector<Hinge> out;
    out.reserve(by_low_end.values.size() / 2);
    std::vector<char> hinged(triangles.size(), 0);
    for (std::size_t v = 0; v < nodes.size(); ++v) {
        const std::span<TriangleEdge> edges = by_low_end[v];
        std::ranges::stable_sort(edges, {}, &TriangleEdge::high_end);
        for (std::size_t i = 1; i < edges.size(); ++i) {
            const TriangleEdge &one = edges[i - 1], &other = edges[i];
            // Else a border, or one triangle given twice.
            if (one.high_end != other.high_end || one.opposite == other.opposite) continue;
            out.push_back(hinge(
                nodes, {static_cast<std::int32_t>(v), one.high_end, one.opposite, other.opposite}));
            hinged[one.triangle] = hinged[other.triangle] = 1;
        }
    }
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const auto& [a, b, c] = triangles[t];
        if (hinged[t] == 0) out.push_back({{a, b, c, c}, {}, nodes[a], {}});
    }
    return out;
}

/// The row of a node from its hinges, by columns.
void SparseRows::find_row(std::size_t row, std::span<const Hinge> hinges, const HingesOfNodes& of,
                          std::vector<MatrixEntry>& entries) {
    entries.assign(1, {static_cast<std::int32_t>(row), 0.0});
    for (const std::int32_t number : of[row]) {
        const Hinge& h = hinges[number];
        int mine = 0;
        while (h.nodes[mine] != static_cast<std::int32_t>(row))
            ++mine;
        for (int other = 0; other < 4; ++other) {
            const double value = h.g[mine] * h.g[other];
            const auto entry =
                std::find_if(entries.begin(), entries.end(),
                             [&](const MatrixEntry& e) { return e.column == h.nodes[other]; });
            if (entry == entries.end()) {
                entries.push_back({h.nodes[other], value});
            } else {
                entry->value += value;
            }
        }
    }
    std::ranges::sort(entries, {}, &MatrixEntry::column);
}

SparseRows::SparseRows(std::size_t nodes, std::span<const Hinge> hinges, int threads)
    : size_(nodes),
      first_((nodes + kRowsAtOnce - 1) / kRowsAtOnce + 1, 0),
      diagonal_(nodes),
      rough_diagonal_(nodes) {
    const auto of = bucketize<std::int32_t>(nodes, [&](const auto& visit) {
        for (std::size_t h = 0; h < hinges.size(); ++h) {
            for (const std::int32_t v : hinges[h].nodes)
                visit(v, static_cast<std::int32_t>(h));
        }
    });
    const std::size_t slices = first_.size() - 1;
    in_pieces(slices, threads, [&](std::size_t from, std::size_t to) {
        std::vector<MatrixEntry> entries;
        for (std::size_t slice = from; slice < to; ++slice) {
            std::size_t longest = 0;
            const std::size_t end = std::min(kRowsAtOnce * (slice + 1), nodes);
            for (std::size_t row = kRowsAtOnce * slice; row < end; ++row) {
                find_row(row, hinges, of, entries);
                longest = std::max(longest, entries.size());
            }
            first_[slice + 1] = kRowsAtOnce * longest;
        }
    });
    for (std::size_t slice = 0; slice < slices; ++slice)
        first_[slice + 1] += first_[slice];
    column_.resize(first_.back());
    value_.resize(first_.back());
    in_pieces(slices, threads, [&](std::size_t from, std::size_t to) {
        std::vector<MatrixEntry> entries;
        for (std::size_t slice = from; slice < to; ++slice)
            fill_slice(slice, hinges, of, entries);
    });
    make_sweep();
}

/// Rows that are shorter than the longest of the slice, or beyond the last, end with zeros.
void SparseRows::fill_slice(std::size_t slice, std::span<const Hinge> hinges,
                            const HingesOfNodes& of, std::vector<MatrixEntry>& entries) {
    for (std::size_t lane = 0; lane < kRowsAtOnce; ++lane) {
        const std::size_t row = kRowsAtOnce * slice + lane;
        const auto padding = static_cast<std::int32_t>(std::min(row, size_ - 1));
        std::size_t k = first_[slice] + lane;
        entries.clear();
        if (row < size_) find_row(row, hinges, of, entries);
        for (const MatrixEntry& e : entries) {
            if (e.column == padding) {
                diagonal_[row] = k;
                rough_diagonal_[row] = e.value;
            }
            column_[k] = e.column;
            value_[k] = e.value;
            k += kRowsAtOnce;
        }
        for (; k < first_[slice + 1]; k += kRowsAtOnce)
            column_[k] = padding;
    }
}

void SparseRows::make_sweep() {
    std::vector<WavefrontSweep::Reach> reach;
    for (std::size_t begin = 0; begin < size(); begin += kMostRows) {
        const auto from =
            column_.begin() + static_cast<std::ptrdiff_t>(first_[begin / kRowsAtOnce]);
        const std::size_t end = std::min(begin + kMostRows, size());
        const auto to = column_.begin() +
                        static_cast<std::ptrdiff_t>(first_[(end + kRowsAtOnce - 1) / kRowsAtOnce]);
        const auto [low, high] = std::minmax_element(from, to);
        reach.emplace_back(static_cast<std::size_t>(*low) / kMostRows,
                           static_cast<std::size_t>(*high) / kMostRows);
    }
    sweep_ = WavefrontSweep(std::move(reach));
}

void SparseRows::add(std::int32_t row, std::int32_t column, double value) {
    std::size_t entry = first_[row / kRowsAtOnce] + row % kRowsAtOnce;
    while (column_[entry] != column) {
        entry += kRowsAtOnce;
        assert(entry < first_[row / kRowsAtOnce + 1]);
    }
    changed_.push_back({entry, value_[entry]});
    value_[entry] += value;
}

void SparseRows::remove_added() {
    while (!changed_.empty()) {
        value_[changed_.back().entry] = changed_.back().before;
        changed_.pop_back();
    }
}

double SparseRows::magnitude(std::size_t row) const {
    double sum = 0;
    for_entries(row, [&](std::int32_t, double value) { sum += std::abs(value); });
    return sum;
}

}  // namespace realmodel::interpolation
