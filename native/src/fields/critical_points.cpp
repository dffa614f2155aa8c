// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/fields/critical_points.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/algorithms.hpp"
#include "base/disjoint_sets.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "fields/refined_lattice.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::fields {

namespace {

constexpr std::size_t kNeighbors = 14;

/// The link of an inner node: its neighbors, as steps, and for each the set of those that an edge
/// of the link joins it to.
struct NodeLink {
    std::array<std::array<int, 3>, kNeighbors> steps{};
    std::array<std::uint16_t, kNeighbors> joined{};

    NodeLink() {
        std::size_t count = 0;
        for (int code = 1; code < 8; ++code) {
            for (const int sign : {1, -1}) {
                steps[count++] = {sign * (code & 1), sign * (code >> 1 & 1), sign * (code >> 2)};
            }
        }
        for (std::size_t a = 0; a < kNeighbors; ++a) {
            for (std::size_t b = 0; b < kNeighbors; ++b) {
                if (a != b && is_edge(steps[a], steps[b]))
                    joined[a] |= static_cast<std::uint16_t>(1U << b);
            }
        }
        assert(edges() == 3 * (kNeighbors - 2));  // a sphere of triangles
    }

    std::size_t edges() const {
        std::size_t ends = 0;
        for (const std::uint16_t of : joined)
            ends += static_cast<std::size_t>(std::popcount(of));
        return ends / 2;
    }

    /// Edges of the lattice go up along some of the axes, or down along some.
    static bool is_edge(const std::array<int, 3>& a, const std::array<int, 3>& b) {
        bool up = true, down = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const int step = b[axis] - a[axis];
            up = up && (step == 0 || step == 1);
            down = down && (step == 0 || step == -1);
        }
        return up || down;
    }

    /// Whether some of the neighbors are one connected component; none are not.
    bool connected(std::uint32_t some) const {
        std::uint32_t reached = some & (~some + 1), last = 0;
        while (reached != last) {
            last = reached;
            for (std::size_t a = 0; a < kNeighbors; ++a) {
                if ((reached >> a & 1) != 0) reached |= joined[a] & some;
            }
        }
        return some != 0 && reached == some;
    }
};

}  // namespace

std::vector<CriticalPoint> critical_points(const Lattice& lattice, std::span<const double> values,
                                           const Execution& execution) {
    if (values.size() != lattice.nodes()) {
        throw InputError("option", std::to_string(values.size()) + " values for " +
                                       std::to_string(lattice.nodes()) + " nodes");
    }
    static const NodeLink link;
    const auto [nx, ny, nz] = lattice.counts;
    std::array<std::ptrdiff_t, kNeighbors> offsets{};
    for (std::size_t a = 0; a < kNeighbors; ++a) {
        const auto& [i, j, k] = link.steps[a];
        offsets[a] =
            i + static_cast<std::ptrdiff_t>(nx) * (j + static_cast<std::ptrdiff_t>(ny) * k);
    }
    std::vector<std::vector<CriticalPoint>> layers(static_cast<std::size_t>(nz));
    parallel_chunks(layers.size(), execution, [&, nx = nx, ny = ny, nz = nz](std::size_t layer) {
        const int k = static_cast<int>(layer);
        if (k == 0 || k == nz - 1) return;
        for (int j = 1; j < ny - 1; ++j) {
            for (int i = 1; i < nx - 1; ++i) {
                const auto node =
                    i + static_cast<std::ptrdiff_t>(nx) * (j + static_cast<std::ptrdiff_t>(ny) * k);
                std::uint32_t higher = 0;
                for (std::size_t a = 0; a < kNeighbors; ++a) {
                    const double other = values[node + offsets[a]], here = values[node];
                    if (other > here || (other == here && offsets[a] > 0)) higher |= 1U << a;
                }
                const std::uint32_t lower = ~higher & ((1U << kNeighbors) - 1);
                if (link.connected(higher) && link.connected(lower)) continue;
                const CriticalKind kind = lower == 0    ? CriticalKind::kMinimum
                                          : higher == 0 ? CriticalKind::kMaximum
                                                        : CriticalKind::kSaddle;
                layers[layer].push_back({node, kind});
            }
        }
    });
    return concatenated(layers);
}

namespace {

// The mean is taken over so many cells to all sides, or twice as many and so on, if a field rises
// along one direction there: if it does so by this share of its mean steepness.
constexpr int kLeastAround = 3, kMostAround = 12;
constexpr double kOneWay = 0.25;
// What is asked for in each tetrahedron, as a share of the mean, and as a share of this what is
// enough.
constexpr double kRise = 0.1, kEnough = 0.5;
constexpr int kMostProjections = 100;  // of each projection
// Of each critical point: in so many rounds those that are made beside it, and at so many corners.
constexpr int kGrowth = 12;
constexpr std::size_t kMostAsked = 40;
// All are tried so often, unless so many have failed.
constexpr int kTries = 2;
constexpr std::size_t kMostFailed = 150;

/// How a field rises in a tetrahedron along a direction, or what it is at a place: a sum of its
/// values.
struct Rise {
    LatticeTetrahedron corners;
    std::array<double, 4> weights;
    double least;       ///< it is to be as much
    double square = 0;  ///< of the weights of corners that are free to change
    double force = 0;
};

/// How a field rises around a place.
struct MeanRise {
    Vec3 gradient;
    double steepness;
};

class Rising {
public:
    Rising(const LatticeField& field, const HeldData& held, const Execution& execution)
        : lattice_(field, {}), field_(field), execution_(execution) {
        const std::size_t nodes = field.lattice.nodes(), points = field.point_values.size();
        if (held.fixed.size() != nodes + points || held.dips.size() != held.normals.size() ||
            held.bounds.size() != held.signs.size() || held.bounds.size() != held.levels.size())
            throw InputError("option", "what is held of a field: one for each");
        fixed_.assign(held.fixed.begin(), held.fixed.end());
        for (std::size_t n = 0; n < nodes + points; ++n)
            values_.push_back(lattice_.value(static_cast<std::int64_t>(n)));
        for (std::size_t p = 0; p < points; ++p)
            fixed_[index(lattice_.corner_of(p))] |= held.fixed[nodes + p];
        for (std::size_t n = 0; n < held.dips.size(); ++n) {
            const auto at = lattice_.located(held.dips[n]);
            const auto polarity = at ? rise(at->corners, held.normals[n], 0) : std::nullopt;
            if (polarity && holds(*polarity)) held_.push_back(*polarity);
        }
        for (std::size_t n = 0; n < held.bounds.size(); ++n) {
            const auto at = lattice_.located(held.bounds[n]);
            if (!at) continue;
            Rise bound{at->corners, at->weights, held.signs[n] * held.levels[n]};
            for (double& weight : bound.weights)
                weight *= held.signs[n];
            if (holds(bound)) held_.push_back(bound);
        }
        find_critical();
    }

    RisingField made() {
        std::size_t failed = 0;
        bool any = true;
        for (int round = 0; round < kTries && any; ++round) {
            any = false;
            for (const std::int64_t corner : std::vector(critical_.begin(), critical_.end())) {
                if (failed == kMostFailed) break;
                if (!critical_.contains(corner)) continue;
                if (execution_.progress != nullptr) execution_.progress->check();
                const bool removed = remove(corner);
                any |= removed;
                failed += removed ? 0 : 1;
            }
        }
        RisingField out;
        const auto nodes = static_cast<std::ptrdiff_t>(field_.lattice.nodes());
        out.values.assign(values_.begin(), values_.begin() + nodes);
        for (std::size_t p = 0; p < field_.point_values.size(); ++p)
            out.point_values.push_back(values_[index(lattice_.corner_of(p))]);
        for (const std::int64_t corner : critical_)
            out.critical.push_back(lattice_.position(corner));
        return out;
    }

private:
    void find_critical() {
        const std::vector<std::int64_t> divided = lattice_.divided_corners();
        const std::span<const double> nodes(values_.data(), field_.lattice.nodes());
        for (const CriticalPoint& point : critical_points(field_.lattice, nodes, execution_)) {
            if (!std::ranges::binary_search(divided, point.node)) critical_.insert(point.node);
        }
        for (const std::int64_t corner : divided) {
            if (is_critical(corner)) critical_.insert(corner);
        }
    }

    bool is_less(std::int64_t a, std::int64_t b) const {
        return std::pair(values_[index(a)], a) < std::pair(values_[index(b)], b);
    }

    /// As critical_points() has it, of any corner.
    bool is_critical(std::int64_t corner) const {
        if (lattice_.box_faces(corner) != 0) return false;
        std::vector<std::int64_t> others;
        const auto number = [&](std::int64_t other) {
            const auto place = std::ranges::find(others, other) - others.begin();
            if (place == std::ssize(others)) others.push_back(other);
            return static_cast<std::int32_t>(place);
        };
        std::vector<std::array<std::int32_t, 2>> joined;
        lattice_.for_each_around(corner, [&](const LatticeTetrahedron& tetrahedron) {
            std::array<std::int32_t, 2> last{-1, -1};  // of those that are greater, of those less
            for (const std::int64_t other : tetrahedron) {
                if (other == corner) continue;
                std::int32_t& before = last[is_less(other, corner) ? 1 : 0];
                const std::int32_t neighbor = number(other);
                if (before >= 0) joined.push_back({before, neighbor});
                before = neighbor;
            }
        });
        DisjointSets sets(others.size());
        for (const auto& [a, b] : joined)
            sets.join(a, b);
        std::array<int, 2> components{};
        for (std::size_t n = 0; n < others.size(); ++n) {
            const auto neighbor = static_cast<std::int32_t>(n);
            if (sets.find(neighbor) == neighbor) ++components[is_less(others[n], corner) ? 1 : 0];
        }
        return components != std::array{1, 1};
    }

    /// Whether there are fewer critical points then; else all is as before.
    bool remove(std::int64_t corner) {
        const auto mean = mean_rise(corner);
        if (!mean) return false;
        rises_.clear();
        before_.clear();
        std::set<std::int64_t> asked;
        std::vector<std::int64_t> critical{corner}, near;
        for (int round = 0; round < kGrowth && asked.size() < kMostAsked; ++round) {
            bool any = false;
            for (const std::int64_t vertex : critical)
                any |= asked.insert(vertex).second && ask_around(vertex);
            if (!any) break;
            project();
            near = near_changes();
            critical.clear();
            std::ranges::copy_if(near, std::back_inserter(critical),
                                 [&](std::int64_t vertex) { return is_critical(vertex); });
        }
        const auto had = static_cast<std::size_t>(std::ranges::count_if(
            near, [&](std::int64_t vertex) { return critical_.contains(vertex); }));
        const auto value_of = [this](std::int64_t vertex) { return values_[index(vertex)]; };
        const bool is_lost = std::ranges::any_of(near, [&](std::int64_t vertex) {
            return fixed_[index(vertex)] != 0 && lattice_.box_faces(vertex) == 0 &&
                   !lattice_.is_between(vertex, value_of);
        });
        if (critical.size() >= had || is_lost || !is_allowed(mean->steepness)) {
            for (const auto& [changed, value] : before_)
                values_[index(changed)] = value;
            return false;
        }
        for (const std::int64_t vertex : near)
            critical_.erase(vertex);
        critical_.insert(critical.begin(), critical.end());
        return true;
    }

    /// Whether changes are small, and polarities and bounds hold.
    bool is_allowed(double steepness) const {
        const double most = steepness * *std::ranges::min_element(field_.lattice.spacing);
        return std::ranges::all_of(
                   before_,
                   [&](const auto& change) {
                       return std::abs(values_[index(change.first)] - change.second) < most;
                   }) &&
               std::ranges::all_of(held_, [&](const Rise& rise) { return holds(rise); });
    }

    bool ask_around(std::int64_t corner) {
        const auto mean = mean_rise(corner);
        if (!mean) return false;
        const double least = kRise * dot(mean->gradient, mean->gradient);
        lattice_.for_each_around(corner, [&](const LatticeTetrahedron& tetrahedron) {
            const auto asked = rise(tetrahedron, mean->gradient, least);
            if (asked && asked->square > 0) rises_.push_back(*asked);
        });
        return true;
    }

    /// Nothing in a tetrahedron that is flat but for rounding.
    std::optional<Rise> rise(const LatticeTetrahedron& corners, const Vec3& along,
                             double least) const {
        std::array<Vec3, 4> at{};
        for (std::size_t i = 0; i < 4; ++i)
            at[i] = lattice_.position(corners[i]);
        const Vec3 a = minus(at[1], at[0]), b = minus(at[2], at[0]), c = minus(at[3], at[0]);
        const double volume = dot(a, cross(b, c));
        const auto& spacing = field_.lattice.spacing;
        if (!(std::abs(volume) > 1e-9 * spacing[0] * spacing[1] * spacing[2])) return std::nullopt;
        Rise derivative{corners, {}, least};
        auto& weights = derivative.weights;
        weights[1] = dot(along, cross(b, c)) / volume;
        weights[2] = dot(along, cross(c, a)) / volume;
        weights[3] = dot(along, cross(a, b)) / volume;
        weights[0] = -(weights[1] + weights[2] + weights[3]);
        for (std::size_t i = 0; i < 4; ++i) {
            if (fixed_[index(corners[i])] == 0) derivative.square += weights[i] * weights[i];
        }
        return derivative;
    }

    bool holds(const Rise& rise) const { return of(rise) >= rise.least; }

    double of(const Rise& rise) const {
        double sum = 0;
        for (std::size_t i = 0; i < 4; ++i)
            sum += rise.weights[i] * values_[index(rise.corners[i])];
        return sum;
    }

    /// How the field that was given rises around a corner, if along one direction.
    std::optional<MeanRise> mean_rise(std::int64_t corner) const {
        const auto& [origin, spacing, counts] = field_.lattice;
        const Vec3 at = lattice_.position(corner);
        for (int around = kLeastAround; around <= kMostAround; around *= 2) {
            CellIndex low{}, high{}, cell{};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const auto near =
                    static_cast<int>(std::lround((at[axis] - origin[axis]) / spacing[axis]));
                low[axis] = std::max(near - around, 0);
                high[axis] = std::min(near + around, counts[axis] - 1);
            }
            Vec3 sum{};
            double steepness = 0, cells = 0;
            for (cell[2] = low[2]; cell[2] < high[2]; ++cell[2]) {
                for (cell[1] = low[1]; cell[1] < high[1]; ++cell[1]) {
                    for (cell[0] = low[0]; cell[0] < high[0]; ++cell[0]) {
                        const Vec3 gradient = gradient_in(cell);
                        sum = plus(sum, gradient);
                        steepness += length(gradient);
                        ++cells;
                    }
                }
            }
            if (length(sum) > kOneWay * steepness)
                return MeanRise{times(1 / cells, sum), steepness / cells};
        }
        return std::nullopt;
    }

    /// Along the edges from the lowest corner of a cell.
    Vec3 gradient_in(const CellIndex& cell) const {
        const std::span<const double> values = field_.values;
        Vec3 gradient{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            CellIndex next = cell;
            ++next[axis];
            gradient[axis] =
                (values[index(lattice_.node(next))] - values[index(lattice_.node(cell))]) /
                field_.lattice.spacing[axis];
        }
        return gradient;
    }

    /// Onto the values nearest to those before that rise as is asked (C. Hildreth 1957, "A
    /// quadratic programming procedure"), nearly.
    void project() {
        bool any = true;
        for (int step = 0; step < kMostProjections && any; ++step) {
            any = false;
            for (Rise& rise : rises_) {
                const double lack = rise.least - of(rise);
                any |= lack > kEnough * rise.least;
                const double more = std::max(lack / rise.square, -rise.force);
                if (more == 0) continue;
                rise.force += more;
                for (std::size_t i = 0; i < 4; ++i) {
                    const std::int64_t corner = rise.corners[i];
                    if (fixed_[index(corner)] != 0) continue;
                    before_.try_emplace(corner, values_[index(corner)]);
                    values_[index(corner)] += more * rise.weights[i];
                }
            }
        }
    }

    /// The corners of tetrahedra around those that have changed.
    std::vector<std::int64_t> near_changes() const {
        std::vector<std::int64_t> near;
        for (const auto& [corner, value] : before_) {
            lattice_.for_each_around(corner, [&](const LatticeTetrahedron& tetrahedron) {
                near.insert(near.end(), tetrahedron.begin(), tetrahedron.end());
            });
        }
        sort_unique(near);
        return near;
    }

    RefinedLattice lattice_;
    const LatticeField& field_;
    const Execution& execution_;
    std::vector<double> values_;  // of nodes, then of points
    std::vector<std::uint8_t> fixed_;
    std::vector<Rise> held_;
    std::set<std::int64_t> critical_;
    // of the critical point that is being removed
    std::vector<Rise> rises_;
    std::map<std::int64_t, double> before_;  // what corners had that have changed
};

}  // namespace

RisingField without_critical_points(const LatticeField& field, const HeldData& held,
                                    const Execution& execution) {
    return Rising(field, held, execution).made();
}

}  // namespace realmodel::fields
