// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/dsi/roughness.hpp"

#include <algorithm>
#include <cmath>

namespace realmodel::interpolation {

namespace {

using Triangle = std::array<std::int32_t, 3>;

constexpr double flat = 1e-12;  // of the squared edge: triangles of less area have no slope

/// A side of a triangle, kept with the lower of its ends.
struct Side {
    std::int32_t other_end, opposite, triangle;
};

/// Height of p over the line from a to b, and where its foot divides a to b.
struct Foot {
    double height, share;
};
Foot foot(const Place& a, const Place& b, const Place& p) {
    const double ux = b[0] - a[0], uy = b[1] - a[1], vx = p[0] - a[0], vy = p[1] - a[1];
    const double squared = ux * ux + uy * uy;
    return {std::abs(ux * vy - uy * vx) / std::sqrt(squared), (ux * vx + uy * vy) / squared};
}

bool has_area(const Place& a, const Place& b, const Place& c) {
    const double ux = b[0] - a[0], uy = b[1] - a[1], vx = c[0] - a[0], vy = c[1] - a[1];
    const double longest = std::max(
        {ux * ux + uy * uy, vx * vx + vy * vy, (ux - vx) * (ux - vx) + (uy - vy) * (uy - vy)});
    return std::abs(ux * vy - uy * vx) > flat * longest;
}

Hinge hinge(std::span<const Place> nodes, const std::array<std::int32_t, 4>& of) {
    const auto at = [&](int k) { return nodes[static_cast<std::size_t>(of[k])]; };
    const Place a = at(0), b = at(1), c = at(2), d = at(3);
    const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
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

std::vector<Hinge> hinges(std::span<const Place> nodes, std::span<const Triangle> triangles) {
    std::vector<std::size_t> first(nodes.size() + 1, 0);
    const auto for_sides = [&](auto&& visit) {
        for (std::size_t number = 0; number < triangles.size(); ++number) {
            const Triangle& t = triangles[number];
            if (!has_area(nodes[static_cast<std::size_t>(t[0])],
                          nodes[static_cast<std::size_t>(t[1])],
                          nodes[static_cast<std::size_t>(t[2])])) {
                continue;
            }
            for (int k = 0; k < 3; ++k) {
                const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
                visit(static_cast<std::size_t>(low),
                      Side{high, t[(k + 2) % 3], static_cast<std::int32_t>(number)});
            }
        }
    };
    for_sides([&](std::size_t low, const Side&) { ++first[low + 1]; });
    for (std::size_t v = 1; v < first.size(); ++v)
        first[v] += first[v - 1];
    std::vector<Side> sides(first.back());
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for_sides([&](std::size_t low, const Side& side) { sides[next[low]++] = side; });

    std::vector<Hinge> out;
    out.reserve(sides.size() / 2);
    std::vector<char> hinged(triangles.size(), 0);
    for (std::size_t v = 0; v < nodes.size(); ++v) {
        const auto begin = sides.begin() + static_cast<std::ptrdiff_t>(first[v]),
                   end = sides.begin() + static_cast<std::ptrdiff_t>(first[v + 1]);
        std::stable_sort(begin, end,
                         [](const Side& a, const Side& b) { return a.other_end < b.other_end; });
        for (auto side = begin; side != end && side + 1 != end; ++side) {
            if (side->other_end != (side + 1)->other_end ||
                side->opposite == (side + 1)->opposite) {
                continue;  // a border, or one triangle given twice
            }
            out.push_back(hinge(nodes, {static_cast<std::int32_t>(v), side->other_end,
                                        side->opposite, (side + 1)->opposite}));
            hinged[static_cast<std::size_t>(side->triangle)] = 1;
            hinged[static_cast<std::size_t>((side + 1)->triangle)] = 1;
        }
    }
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const auto& [a, b, c] = triangles[t];
        if (hinged[t] == 0)
            out.push_back({{a, b, c, c}, {}, nodes[static_cast<std::size_t>(a)], {}});
    }
    return out;
}

SparseRows::SparseRows(std::size_t nodes, std::span<const Hinge> hinges, int threads)
    : size_(nodes),
      first_((nodes + kSideBySide - 1) / kSideBySide + 1, 0),
      diagonal_(nodes),
      rough_diagonal_(nodes) {
    // The hinges of each node, then its row from them.
    std::vector<std::size_t> begin(nodes + 1, 0);
    for (const Hinge& h : hinges) {
        for (const std::int32_t v : h.nodes)
            ++begin[static_cast<std::size_t>(v) + 1];
    }
    for (std::size_t v = 1; v < begin.size(); ++v)
        begin[v] += begin[v - 1];
    std::vector<std::int32_t> of(begin.back());
    std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
    for (std::size_t h = 0; h < hinges.size(); ++h) {
        for (const std::int32_t v : hinges[h].nodes)
            of[next[static_cast<std::size_t>(v)]++] = static_cast<std::int32_t>(h);
    }
    struct Entry {
        std::int32_t column;
        double value;
    };
    const auto row_of = [&](std::size_t row, std::vector<Entry>& entries) {
        entries.clear();
        entries.push_back({static_cast<std::int32_t>(row), 0.0});
        for (std::size_t k = begin[row]; k < begin[row + 1]; ++k) {
            const Hinge& h = hinges[static_cast<std::size_t>(of[k])];
            int mine = 0;
            while (h.nodes[mine] != static_cast<std::int32_t>(row))
                ++mine;
            for (int other = 0; other < 4; ++other) {
                const double value = h.g[mine] * h.g[other];
                const auto found =
                    std::find_if(entries.begin(), entries.end(),
                                 [&](const Entry& e) { return e.column == h.nodes[other]; });
                if (found == entries.end()) {
                    entries.push_back({h.nodes[other], value});
                } else {
                    found->value += value;
                }
            }
        }
        std::sort(entries.begin(), entries.end(),
                  [](const Entry& a, const Entry& b) { return a.column < b.column; });
    };
    const std::size_t slices = first_.size() - 1;
    in_pieces(slices, threads, [&](std::size_t from, std::size_t to) {
        std::vector<Entry> entries;
        for (std::size_t slice = from; slice < to; ++slice) {
            std::size_t longest = 0;
            for (std::size_t row = kSideBySide * slice;
                 row < std::min(kSideBySide * (slice + 1), nodes); ++row) {
                row_of(row, entries);
                longest = std::max(longest, entries.size());
            }
            first_[slice + 1] = kSideBySide * longest;
        }
    });
    for (std::size_t slice = 0; slice < slices; ++slice)
        first_[slice + 1] += first_[slice];
    column_.resize(first_.back());
    value_.resize(first_.back());
    in_pieces(slices, threads, [&](std::size_t from, std::size_t to) {
        std::vector<Entry> entries;
        for (std::size_t slice = from; slice < to; ++slice) {
            for (std::size_t side = 0; side < kSideBySide; ++side) {
                const std::size_t row = std::min(kSideBySide * slice + side, nodes - 1);
                std::size_t k = first_[slice] + side;
                if (row == kSideBySide * slice + side) {
                    row_of(row, entries);
                    for (const Entry& e : entries) {
                        if (e.column == static_cast<std::int32_t>(row)) {
                            diagonal_[row] = k;
                            rough_diagonal_[row] = e.value;
                        }
                        column_[k] = e.column;
                        value_[k] = e.value;
                        k += kSideBySide;
                    }
                }
                for (; k < first_[slice + 1]; k += kSideBySide)
                    column_[k] = static_cast<std::int32_t>(row);
            }
        }
    });
    make_sweep();
}

void SparseRows::make_sweep() {
    constexpr std::size_t piece = kMostRows;
    std::vector<StagedSweep::Reach> reach;
    for (std::size_t begin = 0; begin < size(); begin += piece) {
        const auto from =
            column_.begin() + static_cast<std::ptrdiff_t>(first_[begin / kSideBySide]);
        const std::size_t end = std::min(begin + kMostRows, size());
        const auto to = column_.begin() + static_cast<std::ptrdiff_t>(
                                              first_[(end + kSideBySide - 1) / kSideBySide]);
        const auto [low, high] = std::minmax_element(from, to);
        reach.emplace_back(static_cast<std::size_t>(*low) / piece,
                           static_cast<std::size_t>(*high) / piece);
    }
    sweep_ = StagedSweep(std::move(reach));
}

void SparseRows::add(std::int32_t row, std::int32_t column, double value) {
    const auto number = static_cast<std::size_t>(row);
    std::size_t entry = first_[number / kSideBySide] + number % kSideBySide;
    while (column_[entry] != column)
        entry += kSideBySide;
    changed_.push_back({entry, value_[entry]});
    value_[entry] += value;
}

void SparseRows::take_back() {
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
