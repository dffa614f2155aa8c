// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/conform/collinear_lines.hpp"

#include <bit>
#include <tuple>

#include "base/bucket_sort.hpp"
#include "base/parallel_counts.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

constexpr std::size_t kLinesAtOnce = 1 << 13, kMostLineChunks = 64;

/// A line with a number that is equal for lines that run through the same plan vertices, and hardly
/// ever for others.
struct Keyed {
    std::uint64_t key;
    LineId line;
};

/// A line and the lowest one that runs through the same plan vertices.
struct Follower {
    LineId line, leader;
};

std::uint64_t mixed(const std::array<double, 3>& key) {
    std::uint64_t h = 0;
    for (const double part : key) {
        h = (h ^ std::bit_cast<std::uint64_t>(part + 0.0)) * 0x9E3779B97F4A7C15u;  // -0 is 0
        h ^= h >> 29;
    }
    return h * 0xBF58476D1CE4E5B9u;
}

Array<Keyed> lines_in_use(const PlanArrangement& geometry, const FaceList& faces,
                          const Execution& execution) {
    auto used = zeros<std::uint8_t>(geometry.line_count(), execution);
    const auto& of_edges = faces.polygons.lines;
    parallel_each(of_edges.size(), execution,
                  [&](std::size_t c) { mark(used[index(of_edges[c].id())]); });
    Array<Keyed> lines;
    number_in_order(
        used.size(), execution, [&](std::size_t l) { return used[l] != 0; },
        [&](std::size_t count) { lines = Array<Keyed>(count); },
        [&](std::size_t l, std::size_t number) { lines[number].line = static_cast<LineId>(l); });
    parallel_ranges(lines.size(), kLinesAtOnce, execution, [&](std::size_t begin, std::size_t end) {
        LocalArrangement scope(geometry);
        for (std::size_t i = begin; i < end; ++i)
            lines[i].key = mixed(scope.line_key(lines[i].line));
    });
    return lines;
}

/// The lines that run where a lower one does; rounded slope and offset are equal for them, and
/// among lines with equal ones the exact test decides.
std::vector<Follower> find_followers(const PlanArrangement& geometry, Array<Keyed> lines,
                                     const Execution& execution) {
    const auto in_order = [](const Keyed& a, const Keyed& b) {
        return std::tie(a.key, a.line) < std::tie(b.key, b.line);
    };
    // Keys are spread evenly.
    const auto share = [](const Keyed& line) { return static_cast<double>(line.key) * 0x1p-64; };
    {
        const std::size_t chunks =
            std::clamp<std::size_t>(lines.size() / kLinesAtOnce, 1, kMostLineChunks);
        const auto produce = [&](std::size_t chunk, const auto& take) {
            const std::size_t end = lines.size() * (chunk + 1) / chunks;
            for (std::size_t i = lines.size() * chunk / chunks; i < end; ++i)
                take(lines[i]);
        };
        lines = BucketSort<Keyed, decltype(share), decltype(in_order)>(share, in_order)
                    .sorted(chunks, lines.size(), produce, execution);
    }
    std::vector<std::vector<Follower>> found((lines.size() + kLinesAtOnce - 1) / kLinesAtOnce);
    parallel_ranges(lines.size(), kLinesAtOnce, execution, [&](std::size_t begin, std::size_t end) {
        LocalArrangement scope(geometry);
        std::vector<LineId> leaders;
        for (std::size_t i = begin; i < end; ++i) {
            if (i > 0 && lines[i].key == lines[i - 1].key) continue;  // not the first of a group
            leaders.assign(1, lines[i].line);
            for (std::size_t j = i + 1; j < lines.size() && lines[j].key == lines[i].key; ++j) {
                const LineId line = lines[j].line;
                const auto leader = std::find_if(leaders.begin(), leaders.end(), [&](LineId other) {
                    return scope.same_line(line, other);
                });
                if (leader == leaders.end()) {
                    leaders.push_back(line);
                } else {
                    found[begin / kLinesAtOnce].push_back({line, *leader});
                }
            }
        }
    });
    std::vector<Follower> all;
    for (const auto& some : found)
        all.insert(all.end(), some.begin(), some.end());
    return all;
}

}  // namespace

CollinearLines join_lines(const PlanArrangement& geometry, const FaceList& faces,
                          const Execution& execution) {
    Array<Keyed> lines = lines_in_use(geometry, faces, execution);
    CollinearLines joined;
    joined.of_line = Array<std::int32_t>(geometry.line_count());
    std::fill(joined.of_line.begin(), joined.of_line.end(), -1);
    for (const Keyed& line : lines)
        joined.of_line[index(line.line)] = 0;
    const auto followers = find_followers(geometry, std::move(lines), execution);
    for (const Follower& follower : followers)
        joined.of_line[index(follower.line)] = -1;

    number_in_order(
        joined.of_line.size(), execution, [&](std::size_t l) { return joined.of_line[l] >= 0; },
        [&](std::size_t count) { joined.representative = Array<LineId>(count); },
        [&](std::size_t l, std::size_t number) {
            joined.of_line[l] = static_cast<std::int32_t>(number);
            joined.representative[number] = static_cast<LineId>(l);
        });
    for (const Follower& follower : followers) {
        joined.of_line[index(follower.line)] = joined.of_line[index(follower.leader)];
    }
    return joined;
}

}  // namespace realmodel::strata
