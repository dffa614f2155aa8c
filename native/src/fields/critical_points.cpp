// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/fields/critical_points.hpp"

#include <array>
#include <bit>
#include <cassert>
#include <string>

#include "base/parallel.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::fields {

namespace {

constexpr std::size_t kNeighbors = 14;

/// The link of an inner node: its neighbors, as steps, and for each the set of those that an edge
/// of the link joins it to.
struct Link {
    std::array<std::array<int, 3>, kNeighbors> steps{};
    std::array<std::uint16_t, kNeighbors> joined{};

    Link() {
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

    /// Whether some of the neighbors are one connected part; none are not.
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
    static const Link link;
    const auto [nx, ny, nz] = lattice.counts;
    std::array<std::ptrdiff_t, kNeighbors> offsets{};
    for (std::size_t a = 0; a < kNeighbors; ++a) {
        const auto& [i, j, k] = link.steps[a];
        offsets[a] =
            i + static_cast<std::ptrdiff_t>(nx) * (j + static_cast<std::ptrdiff_t>(ny) * k);
    }
    std::vector<std::vector<CriticalPoint>> found(static_cast<std::size_t>(nz));
    parallel_chunks(found.size(), execution, [&, nx = nx, ny = ny, nz = nz](std::size_t layer) {
        const int k = static_cast<int>(layer);
        if (k == 0 || k == nz - 1) return;
        for (int j = 1; j < ny - 1; ++j) {
            for (int i = 1; i < nx - 1; ++i) {
                const auto node =
                    i + static_cast<std::ptrdiff_t>(nx) * (j + static_cast<std::ptrdiff_t>(ny) * k);
                std::uint32_t higher = 0;
                for (std::size_t a = 0; a < kNeighbors; ++a) {
                    const double there = values[node + offsets[a]], here = values[node];
                    if (there > here || (there == here && offsets[a] > 0)) higher |= 1U << a;
                }
                const std::uint32_t lower = ~higher & ((1U << kNeighbors) - 1);
                if (link.connected(higher) && link.connected(lower)) continue;
                const CriticalKind kind = lower == 0    ? CriticalKind::kMinimum
                                          : higher == 0 ? CriticalKind::kMaximum
                                                        : CriticalKind::kSaddle;
                found[layer].push_back({node, kind});
            }
        }
    });
    std::vector<CriticalPoint> all;
    for (const auto& of_layer : found)
        all.insert(all.end(), of_layer.begin(), of_layer.end());
    return all;
}

}  // namespace realmodel::fields
