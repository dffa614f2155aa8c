// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/conform/plan_vertices.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cassert>
#include <cmath>
#include <tuple>

#include "base/algorithms.hpp"
#include "base/parallel_counts.hpp"
#include "base/parallel_sort.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

constexpr std::size_t kVerticesAtOnce = 1 << 14, kMostVertexChunks = 64;

/// A point with its rounded position.
struct Rounded {
    double x, y;
    PointId point;

    bool in_position_of(const Rounded& other) const { return x == other.x && y == other.y; }
};

/// A range of x.
struct XRange {
    double low = HUGE_VAL, high = -HUGE_VAL, scale = 0;

    void include(double x) {
        low = std::min(low, x);
        high = std::max(high, x);
    }
    /// How much of it lies before x, from 0 to 1.
    double share(double x) const { return std::clamp((x - low) * scale, 0.0, 1.0); }
};

/// Where the vertices in use are, and nearly all points with them.
XRange range_of_vertices(const PlanArrangement& geometry, const Array<std::uint8_t>& used,
                         const Execution& execution) {
    const auto vertices = geometry.vertex_count();
    std::vector<XRange> ranges((vertices + kVerticesAtOnce - 1) / kVerticesAtOnce);
    parallel_ranges(vertices, kVerticesAtOnce, execution, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            if (used[v] != 0)
                ranges[begin / kVerticesAtOnce].include(geometry.point(static_cast<PointId>(v)).x);
        }
    });
    XRange all;
    for (const XRange& range : ranges) {
        all.include(range.low);
        all.include(range.high);
    }
    const double width = all.high - all.low;
    if (!std::isfinite(width) || !std::isnormal(1 / width)) return {0, 0, 0};  // nothing is known
    all.scale = 1 / width;
    return all;
}

/// The points that faces use and the extra ones, in order of position.
Array<Rounded> points_in_use(const PlanArrangement& geometry, const FaceList& faces,
                             const std::vector<ExtraPoint>& extra, const Execution& execution) {
    auto used = zeros<std::uint8_t>(geometry.point_count(), execution);
    const auto& points = faces.polygons.points;
    parallel_for_each(points.size(), execution,
                      [&](std::size_t c) { atomic_set(used[index(points[c])]); });
    for (const ExtraPoint& e : extra)
        used[index(e.point)] = 1;
    const XRange range = range_of_vertices(geometry, used, execution);
    const auto share = [range](const Rounded& p) { return range.share(p.x); };
    const auto in_order = [](const Rounded& a, const Rounded& b) {
        return std::tie(a.x, a.y, a.point) < std::tie(b.x, b.y, b.point);
    };
    const std::size_t chunks =
        std::clamp<std::size_t>(used.size() / kVerticesAtOnce, 1, kMostVertexChunks);
    const auto produce = [&](std::size_t chunk, const auto& take) {
        const std::size_t end = used.size() * (chunk + 1) / chunks;
        for (std::size_t p = used.size() * chunk / chunks; p < end; ++p) {
            if (used[p] == 0) continue;
            const auto id = static_cast<PointId>(p);
            take(Rounded{geometry.point(id).x, geometry.point(id).y, id});
        }
    };
    // input vertices have the lowest ids
    return BucketSort<Rounded, decltype(share), decltype(in_order)>(share, in_order)
        .sorted(chunks, used.size(), produce, execution);
}

/// Calls visit(begin, end) for the groups of points in equal positions that begin in a range.
template <class Visit>
void for_each_position(const Array<Rounded>& points, std::size_t begin, std::size_t end,
                       const Visit& visit) {
    while (begin < end && begin > 0 && points[begin].in_position_of(points[begin - 1]))
        ++begin;
    while (begin < end) {
        std::size_t next = begin + 1;
        while (next < points.size() && points[next].in_position_of(points[begin]))
            ++next;
        visit(begin, next);
        begin = next;
    }
}

/// The first points of different positions that round to one.
class FirstPoints {
public:
    FirstPoints(const PlanArrangement& geometry, const Array<Rounded>& points)
        : scope_(geometry), points_(points) {}

    void clear() { first_.clear(); }
    /// How many positions there are.
    std::size_t size() const { return first_.size(); }
    /// The first point in the position of one, which may be itself.
    std::uint32_t of(std::uint32_t point) {
        const auto in_order = [&](std::uint32_t i, std::uint32_t j) { return is_before(i, j); };
        // A few are asked one by one; more are put in order, or each would be asked about all.
        const bool are_few = first_.size() < kLinearSearch;
        const auto at =
            are_few ? std::ranges::find_if(first_,
                                           [&](std::uint32_t other) {
                                               return scope_.same_place(id(point), id(other));
                                           })
                    : std::ranges::lower_bound(first_, point, in_order);
        if (at != first_.end() && (are_few || !is_before(point, *at))) return *at;
        first_.insert(at, point);
        if (first_.size() == kLinearSearch) std::ranges::sort(first_, in_order);
        return point;
    }

private:
    static constexpr std::size_t kLinearSearch = 16;

    PointId id(std::uint32_t point) const { return points_[point].point; }
    bool is_before(std::uint32_t i, std::uint32_t j) {
        const int x = scope_.compare(0, id(i), id(j));
        return x != 0 ? x > 0 : scope_.compare(1, id(i), id(j)) > 0;
    }

    LocalArrangement scope_;
    const Array<Rounded>& points_;
    std::vector<std::uint32_t> first_;  ///< from kLinearSearch on in order of position
};

/// Finds which points are in the same position. Rounded coordinates are the same for every way to
/// name a point, so only points with equal ones can be; among those the exact test decides.
/// @param before  how many positions begin in each range of kVerticesAtOnce points
/// @return for each point, the first one in its position
Array<std::uint32_t> find_first_in_position(const PlanArrangement& geometry,
                                            const Array<Rounded>& points,
                                            std::vector<std::size_t>& before,
                                            const Execution& execution) {
    Array<std::uint32_t> first_in_position(points.size());
    before.assign((points.size() + kVerticesAtOnce - 1) / kVerticesAtOnce, 0);
    parallel_ranges(points.size(), kVerticesAtOnce, execution,
                    [&](std::size_t range_begin, std::size_t range_end) {
                        FirstPoints first(geometry, points);
                        for_each_position(points, range_begin, range_end,
                                          [&](std::size_t begin, std::size_t end) {
                                              first.clear();
                                              for (std::size_t i = begin; i < end; ++i)
                                                  first_in_position[i] =
                                                      first.of(static_cast<std::uint32_t>(i));
                                              before[range_begin / kVerticesAtOnce] += first.size();
                                          });
                    });
    return first_in_position;
}

/// Room for so many plan vertices, none of which is set.
PlanVertices empty_vertices(std::size_t count, std::size_t points, const Execution& execution) {
    PlanVertices vertices;
    vertices.representative = Array<PointId>(count);
    vertices.same_x_bits = zeros<std::uint64_t>(count / 64 + 1, execution);
    vertices.of_point = Array<PlanVertexId>(points);
    parallel_ranges(points, 1 << 18, execution, [&](std::size_t begin, std::size_t end) {
        std::fill(vertices.of_point.begin() + begin, vertices.of_point.begin() + end, -1);
    });
    return vertices;
}

}  // namespace

PlanVertices find_plan_vertices(const PlanArrangement& geometry, const FaceList& faces,
                                const std::vector<ExtraPoint>& extra, const Execution& execution) {
    const Array<Rounded> points = points_in_use(geometry, faces, extra, execution);
    std::vector<std::size_t> before;
    const auto first_in_position = find_first_in_position(geometry, points, before, execution);
    const std::size_t count = exclusive_scan(before);
    PlanVertices vertices = empty_vertices(count, geometry.point_count(), execution);
    std::vector<std::vector<PlanVertexId>> coincident(before.size());
    const auto of_point = [&](std::size_t i) -> PlanVertexId& {
        return vertices.of_point[index(points[i].point)];
    };
    parallel_ranges(points.size(), kVerticesAtOnce, execution,
                    [&](std::size_t range_begin, std::size_t range_end) {
                        const std::size_t chunk = range_begin / kVerticesAtOnce;
                        std::size_t next = before[chunk];
                        for_each_position(
                            points, range_begin, range_end,
                            [&](std::size_t begin, std::size_t end) {
                                for (std::size_t i = begin; i < end; ++i) {
                                    if (first_in_position[i] != i) {
                                        of_point(i) = of_point(first_in_position[i]);
                                        continue;
                                    }
                                    of_point(i) = static_cast<PlanVertexId>(next);
                                    vertices.representative[next] = points[i].point;
                                    if (next > 0 && points[i - 1].x == points[i].x) {
                                        std::atomic_ref(vertices.same_x_bits[(next - 1) / 64])
                                            .fetch_or(std::uint64_t{1} << (next - 1) % 64,
                                                      std::memory_order_relaxed);
                                    }
                                    if (i > begin) coincident[chunk].push_back(of_point(i));
                                    ++next;
                                }
                            });
                        assert(next == (chunk + 1 < before.size() ? before[chunk + 1] : count));
                    });
    vertices.coincident = concatenated(coincident);
    return vertices;
}

void set_plan_positions(const PlanArrangement& geometry, PlanVertices& plan_vertices,
                        const Execution& execution) {
    plan_vertices.position = Array<PlanPosition>(plan_vertices.size());
    parallel_for_each(plan_vertices.size(), execution, [&](std::size_t p) {
        const auto& point = geometry.point(plan_vertices.representative[p]);
        plan_vertices.position[p] = {point.x, point.y};
    });
}

namespace {

constexpr std::size_t kLinesAtOnce = 1 << 13, kMostLineChunks = 64;

/// A line with a number that is equal for lines that run through the same plan vertices, and hardly
/// ever for others.
struct KeyedLine {
    std::uint64_t key;
    LineId line;
};

/// A line and the lowest one that runs through the same plan vertices.
struct Follower {
    LineId line, leader;
};

std::uint64_t mixed(const std::array<double, 3>& key) {
    std::uint64_t h = 0;
    for (const double coordinate : key) {
        h = (h ^ std::bit_cast<std::uint64_t>(coordinate + 0.0)) * 0x9E3779B97F4A7C15u;  // -0 is 0
        h ^= h >> 29;
    }
    return h * 0xBF58476D1CE4E5B9u;
}

Array<KeyedLine> lines_in_use(const PlanArrangement& geometry, const FaceList& faces,
                              const Execution& execution,
                              const std::vector<std::uint8_t>* left_out) {
    auto used = zeros<std::uint8_t>(geometry.line_count(), execution);
    const auto& of_edges = faces.polygons.lines;
    parallel_for_each(of_edges.size(), execution, [&](std::size_t c) {
        const std::size_t line = index(of_edges[c].id());
        if (left_out == nullptr || (*left_out)[line] == 0) atomic_set(used[line]);
    });
    Array<KeyedLine> lines;
    number_in_order(
        used.size(), execution, [&](std::size_t l) { return used[l] != 0; },
        [&](std::size_t count) { lines = Array<KeyedLine>(count); },
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
std::vector<Follower> find_followers(const PlanArrangement& geometry, Array<KeyedLine> lines,
                                     const Execution& execution) {
    const auto in_order = [](const KeyedLine& a, const KeyedLine& b) {
        return std::tie(a.key, a.line) < std::tie(b.key, b.line);
    };
    // Keys are spread evenly.
    const auto share = [](const KeyedLine& line) {
        return static_cast<double>(line.key) * 0x1p-64;
    };
    {
        const std::size_t chunks =
            std::clamp<std::size_t>(lines.size() / kLinesAtOnce, 1, kMostLineChunks);
        const auto produce = [&](std::size_t chunk, const auto& take) {
            const std::size_t end = lines.size() * (chunk + 1) / chunks;
            for (std::size_t i = lines.size() * chunk / chunks; i < end; ++i)
                take(lines[i]);
        };
        lines = BucketSort<KeyedLine, decltype(share), decltype(in_order)>(share, in_order)
                    .sorted(chunks, lines.size(), produce, execution);
    }
    const auto find = [&](std::size_t begin, std::size_t end, std::vector<Follower>& followers) {
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
                    followers.push_back({line, *leader});
                }
            }
        }
    };
    return collect_ranges<Follower>(lines.size(), kLinesAtOnce, execution, find);
}

}  // namespace

CollinearLines join_lines(const PlanArrangement& geometry, const FaceList& faces,
                          const Execution& execution, const std::vector<std::uint8_t>* left_out) {
    Array<KeyedLine> lines = lines_in_use(geometry, faces, execution, left_out);
    CollinearLines joined;
    joined.of_line = Array<std::int32_t>(geometry.line_count());
    std::fill(joined.of_line.begin(), joined.of_line.end(), -1);
    for (const KeyedLine& line : lines)
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
