// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/repair/plan_snapping.hpp"

#include <algorithm>
#include <array>
#include <boost/sort/spreadsort/float_sort.hpp>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>
#include <vector>

#include "base/algorithms.hpp"
#include "base/parallel.hpp"
#include "exact/orientation.hpp"

namespace realmodel::strata {

namespace {

using PlanPosition = std::array<double, 2>;
using SpacePosition = std::array<double, 3>;

PlanPosition position(const PlanMesh& mesh, std::size_t v) {
    return {mesh.vertices[v * mesh.columns], mesh.vertices[v * mesh.columns + 1]};
}

SpacePosition corner(const PlanMesh& mesh, std::size_t v) {
    const auto [x, y] = position(mesh, v);
    return {x, y, mesh.columns < 3 ? 0.0 : mesh.vertices[v * mesh.columns + 2]};
}

template <class Position>
bool is_finite(const Position& p) {
    return std::all_of(p.begin(), p.end(), [](double c) { return std::isfinite(c); });
}

/// What orients a triangle: in plan, or where it has no area there whether it has none in space.
int orientation(const std::array<SpacePosition, 3>& p) {
    const int in_plan = exact::orient2d({p[0][0], p[0][1]}, {p[1][0], p[1][1]}, {p[2][0], p[2][1]});
    constexpr int kUpright = 2;
    return in_plan != 0 || exact::in_one_line(p[0], p[1], p[2]) ? in_plan : kUpright;
}

/// Calls visit(position) for all vertices; what the builder refuses later (numbers that are not
/// finite) is passed over.
template <class Visit>
void for_each_vertex(std::span<const StackInput> rocks, Progress* progress, const Visit& visit) {
    for (const PlanMesh& mesh : meshes_of(rocks)) {
        for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
            poll(progress, v);
            const PlanPosition p = position(mesh, v);
            if (is_finite(p)) visit(p);
        }
    }
}

/// Calls visit(corners) for all triangles; what the builder refuses later is passed over.
template <class Visit>
void for_each_triangle(std::span<const StackInput> rocks, Progress* progress, const Visit& visit) {
    for (const PlanMesh& mesh : meshes_of(rocks)) {
        for (std::size_t t = 0; t + 2 < mesh.triangles.size(); t += 3) {
            poll(progress, t);
            std::array<SpacePosition, 3> corners;
            bool sound = true;
            for (std::size_t i = 0; i < 3; ++i) {
                const std::int32_t v = mesh.triangles[t + i];
                sound = sound && v >= 0 && static_cast<std::size_t>(v) < mesh.vertex_count();
                if (!sound) break;
                corners[i] = corner(mesh, static_cast<std::size_t>(v));
                sound = is_finite(corners[i]);
            }
            if (sound) visit(corners);
        }
    }
}

constexpr std::size_t kBins = std::size_t{1} << 16;  // of a pass that counts

void sort_doubles(std::vector<double>& values) {
    // apart: Boost takes the difference of the bits of the least and of the greatest one
    const auto middle =
        std::partition(values.begin(), values.end(), [](double value) { return value < 0; });
    boost::sort::spreadsort::float_sort(values.begin(), middle);
    boost::sort::spreadsort::float_sort(middle, values.end());
}

/// Runs of different values, ascending, each no further from the next one than rounding.
struct CloseValues {
    struct Value {
        double value;
        std::size_t count;
    };
    std::vector<Value> values;
    std::vector<std::size_t> ends;  ///< of each run, in `values`
};

/// Finds the runs among more values than there is memory for: whoever has them goes through all of
/// them until that is done. Where there are many, some of these passes count how many are where;
/// each of the others takes a slice of them.
class CloseValueSearch {
public:
    /// @param least, most  of all values
    /// @param count        of all values
    /// @param reach        how far values of a run may be apart
    /// @param at_once      values in a slice
    CloseValueSearch(double least, double most, std::size_t count, double reach,
                     std::size_t at_once)
        : reach_(reach), at_once_(at_once), waiting_{{least, most, count}} {
        begin_pass();
    }

    bool is_done() const { return is_done_; }
    /// To be called in each pass for all values, in any order.
    void see(double value) {
        if (value < slice_.least || value > slice_.most) return;
        if (bins_.empty()) {
            seen_.push_back(value);
        } else {
            bins_[bin_of(value)].add(value);
        }
    }
    void end_pass() {
        if (is_done_) return;
        if (bins_.empty()) {
            look_at_seen();
        } else {
            divide();
        }
        begin_pass();
    }
    CloseValues take() { return std::move(close_values_); }

private:
    /// All values from one to another.
    struct Slice {
        double least, most;
        std::size_t count = 0;

        void add(double value) {
            least = count == 0 ? value : std::min(least, value);
            most = count == 0 ? value : std::max(most, value);
            ++count;
        }
    };

    /// Ascends with the value, and the first and the last bin have some.
    std::size_t bin_of(double value) const {
        const double half = std::isinf(slice_.most - slice_.least) ? 0.5 : 1.0;
        const double low = half * slice_.least;
        const double share = (half * value - low) / (half * slice_.most - low);
        return std::min(bins_.size() - 1,
                        static_cast<std::size_t>(share * static_cast<double>(bins_.size())));
    }
    void begin_pass() {
        while (!waiting_.empty() && waiting_.back().least == waiting_.back().most) {
            add(waiting_.back().least, waiting_.back().count);
            waiting_.pop_back();
        }
        if (waiting_.empty()) {
            end_run();
            slice_ = {HUGE_VAL, -HUGE_VAL};
            seen_ = {};
            is_done_ = true;
            return;
        }
        slice_ = waiting_.back();
        waiting_.pop_back();
        if (slice_.count > at_once_) {
            bins_.resize(std::min(kBins, slice_.count));
        } else {
            seen_.reserve(slice_.count);
        }
    }
    void divide() {
        std::vector<Slice> slices;
        for (const Slice& bin : bins_) {
            if (bin.count == 0) continue;
            if (slices.empty() || slices.back().count + bin.count > at_once_) {
                slices.push_back(bin);
            } else {
                slices.back().most = bin.most;
                slices.back().count += bin.count;
            }
        }
        waiting_.insert(waiting_.end(), slices.rbegin(), slices.rend());
        bins_ = {};
    }
    void look_at_seen() {
        sort_doubles(seen_);
        for (const auto equal : groups_of(seen_))
            add(equal[0], equal.size());
        seen_.clear();
    }
    /// Values come ascending. A run may go on in the next slice.
    void add(double value, std::size_t count) {
        if (!run_.empty() && !(value - run_.back().value <= reach_)) end_run();
        run_.push_back({value, count});
    }
    void end_run() {
        if (run_.size() > 1) {
            close_values_.values.insert(close_values_.values.end(), run_.begin(), run_.end());
            close_values_.ends.push_back(close_values_.values.size());
        }
        run_.clear();
    }

    double reach_;
    std::size_t at_once_;
    std::vector<Slice> waiting_;  // the least one last
    Slice slice_;
    std::vector<Slice> bins_;   // of equal width; empty where the slice is small enough
    std::vector<double> seen_;  // else its values
    std::vector<CloseValues::Value> run_;
    CloseValues close_values_;
    bool is_done_ = false;
};

/// Each value of a run becomes the most frequent of them (of equally frequent ones the lowest),
/// unless one of them is to be left alone.
AxisSnapping join_close(const CloseValues& close, const std::set<double>& left_alone) {
    std::vector<std::pair<double, double>> changes;
    auto begin = close.values.begin();
    for (const std::size_t run_end : close.ends) {
        const auto end = close.values.begin() + static_cast<std::ptrdiff_t>(run_end);
        const double common = std::max_element(begin, end, [](const auto& a, const auto& b) {
                                  return a.count < b.count;
                              })->value;
        const bool alone =
            std::any_of(begin, end, [&](const auto& v) { return left_alone.contains(v.value); });
        for (; begin != end; ++begin) {
            if (!alone && begin->value != common) changes.emplace_back(begin->value, common);
        }
    }
    return AxisSnapping(std::move(changes));
}

/// Runs of x, and of y, no further apart than rounding.
std::array<CloseValues, 2> close_values(std::span<const StackInput> rocks,
                                        const Execution& execution, std::size_t at_once) {
    std::array<double, 2> least{HUGE_VAL, HUGE_VAL}, most{-HUGE_VAL, -HUGE_VAL};
    std::size_t count = 0;
    for_each_vertex(rocks, execution.progress, [&](const PlanPosition& p) {
        for (std::size_t axis = 0; axis < 2; ++axis) {
            least[axis] = std::min(least[axis], p[axis]);
            most[axis] = std::max(most[axis], p[axis]);
        }
        ++count;
    });
    if (count == 0) return {};
    const auto search_along = [&](std::size_t axis) {
        const double largest = std::max(std::abs(least[axis]), std::abs(most[axis]));
        const double reach = largest * 0x1p-51;  // two to four units in the last place
        return CloseValueSearch(least[axis], most[axis], count, reach, at_once);
    };
    std::array searches{search_along(0), search_along(1)};
    while (!searches[0].is_done() || !searches[1].is_done()) {
        for_each_vertex(rocks, execution.progress, [&](const PlanPosition& p) {
            for (std::size_t axis = 0; axis < 2; ++axis)
                searches[axis].see(p[axis] + 0.0);  // -0 becomes 0
        });
        parallel_chunks(2, execution, [&](std::size_t axis) { searches[axis].end_pass(); });
    }
    return {searches[0].take(), searches[1].take()};
}

}  // namespace

std::vector<PlanMesh> meshes_of(std::span<const StackInput> rocks) {
    std::vector<PlanMesh> meshes;
    for (const StackInput& rock : rocks) {
        for (const TriangleView& s : rock.surfaces)
            meshes.push_back({s.vertices, s.triangles, 3});
        if (rock.region) meshes.push_back({rock.region->vertices, rock.region->triangles, 2});
    }
    return meshes;
}

bool share_one_plan(std::span<const StackInput> rocks) {
    const std::vector<PlanMesh> meshes = meshes_of(rocks);
    return std::all_of(meshes.begin(), meshes.end(), [&](const PlanMesh& mesh) {
        const PlanMesh& first = meshes.front();
        if (first.vertex_count() != mesh.vertex_count()) return false;
        for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
            if (position(first, v) != position(mesh, v)) return false;
        }
        return true;
    });
}

double AxisSnapping::changed(double value) const {
    const auto at = std::lower_bound(changes_.begin(), changes_.end(), value,
                                     [](const auto& change, double v) { return change.first < v; });
    return at != changes_.end() && at->first == value ? at->second : value;
}

PlanSnapping find_snapping(std::span<const StackInput> rocks, const Execution& execution,
                           std::size_t at_once) {
    const auto close = close_values(rocks, execution, at_once);
    // Values whose joining would turn a triangle are left alone, until none is turned. Input so
    // fine that this does not settle soon is taken as it is.
    constexpr int kRounds = 8;
    std::array<std::set<double>, 2> left_alone;
    for (int round = 0; round < kRounds; ++round) {
        PlanSnapping snapping{join_close(close[0], left_alone[0]),
                              join_close(close[1], left_alone[1])};
        if (snapping.empty()) return snapping;
        bool turned = false;
        for_each_triangle(rocks, execution.progress, [&](const std::array<SpacePosition, 3>& p) {
            std::array<SpacePosition, 3> q;
            for (std::size_t i = 0; i < 3; ++i)
                q[i] = {snapping.x(p[i][0]), snapping.y(p[i][1]), p[i][2]};
            if (p == q || orientation(p) == orientation(q)) return;
            turned = true;
            for (std::size_t i = 0; i < 3; ++i) {
                for (std::size_t axis = 0; axis < 2; ++axis)
                    left_alone[axis].insert(p[i][axis]);
            }
        });
        if (!turned) return snapping;
    }
    return {};
}

}  // namespace realmodel::strata
