// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/meshing/ear_clipping.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "meshing/check.hpp"
#include "meshing/ear_ring.hpp"
#include "meshing/plan_predicates.hpp"
#include "realmodel/base/progress.hpp"
#include "realmodel/meshing/rings.hpp"

namespace realmodel::meshing {

namespace {

using Triangles = std::vector<std::array<std::int32_t, 3>>;

/// Spreads the lower 16 bits of a number over its even bits.
std::uint32_t spread(std::uint32_t bits) {
    bits = (bits | bits << 8) & 0x00ff00ff;
    bits = (bits | bits << 4) & 0x0f0f0f0f;
    bits = (bits | bits << 2) & 0x33333333;
    return (bits | bits << 1) & 0x55555555;
}

/// Cuts ears off a ring until a triangle is left.
class Clipping {
public:
    Clipping(EarRing& ring, std::span<const PlanPoint> corners, const Check& check)
        : ring_(ring), check_(check) {
        mesh_.points.assign(corners.begin(), corners.end());
    }

    /// False where no ear is left.
    bool run() {
        lay_curve();
        Ticker tick(check_);
        std::int32_t tip = ring_.first(), failed = 0;
        while (left_ > 3) {
            tick(0);
            const EarNode& node = ring_.nodes[tip];
            if (!is_ear(tip)) {
                tip = node.next;
                if (++failed > left_) return false;
                continue;
            }
            // Going on after the next corner spreads the ears, which keeps triangles from becoming
            // slivers that flips must mend.
            const std::int32_t after = ring_.nodes[node.next].next;
            cut(tip);
            tip = after;
            failed = 0;
        }
        const EarNode& node = ring_.nodes[tip];
        if (side_of_line(ring_.place(node.previous), ring_.place(tip), ring_.place(node.next)) <=
            0) {
            return false;
        }
        const std::int32_t t = add(node.previous, tip, node.next);
        place({t, 2}, node.next);
        return true;
    }

    Triangles swapped() {
        std::vector<Side> doubtful;
        const auto count = static_cast<std::int32_t>(mesh_.corners.size());
        for (std::int32_t t = 0; t < count; ++t) {
            for (int i = 0; i < 3; ++i) {
                const Side side(t, i);
                if (mesh_.is_border(side)) {
                    mesh_.fix(side);
                } else if (mesh_.behind(side).triangle() > t) {
                    doubtful.push_back(side);
                }
            }
        }
        std::reverse(doubtful.begin(), doubtful.end());
        mesh_.legalise(doubtful);
        return std::move(mesh_.corners);
    }

private:
    void lay_curve() {
        const std::size_t count = ring_.nodes.size();
        PlanPoint low = ring_.place(0), high = low;
        for (std::size_t n = 0; n < count; ++n) {
            for (int k = 0; k < 2; ++k) {
                low[k] = std::min(low[k], ring_.place(static_cast<std::int32_t>(n))[k]);
                high[k] = std::max(high[k], ring_.place(static_cast<std::int32_t>(n))[k]);
            }
        }
        low_ = low;
        const double width = std::max(high[0] - low[0], high[1] - low[1]);
        scale_ = width > 0 ? 65535 / width : 0;
        curve_.resize(count);
        before_.assign(count, -1);
        after_.assign(count, -1);
        std::vector<std::pair<std::uint32_t, std::int32_t>> order;
        std::int32_t node = ring_.first();
        do {
            curve_[node] = on_curve(ring_.place(node));
            order.emplace_back(curve_[node], node);
            node = ring_.nodes[node].next;
        } while (node != ring_.first());
        left_ = static_cast<std::int32_t>(order.size());
        std::sort(order.begin(), order.end());
        for (std::size_t i = 0; i + 1 < order.size(); ++i) {
            after_[order[i].second] = order[i + 1].second;
            before_[order[i + 1].second] = order[i].second;
        }
    }

    std::uint32_t on_curve(const PlanPoint& p) const {
        const auto cell = [&](int k) {
            return static_cast<std::uint32_t>(std::clamp((p[k] - low_[k]) * scale_, 0.0, 65535.0));
        };
        return spread(cell(0)) | spread(cell(1)) << 1;
    }

    bool is_ear(std::int32_t tip) const {
        const EarNode& node = ring_.nodes[tip];
        const PlanPoint &a = ring_.place(node.previous), &b = ring_.place(tip),
                        &c = ring_.place(node.next);
        if (side_of_line(a, b, c) <= 0) return false;
        const PlanPoint low{std::min({a[0], b[0], c[0]}), std::min({a[1], b[1], c[1]})},
            high{std::max({a[0], b[0], c[0]}), std::max({a[1], b[1], c[1]})};
        const std::uint32_t from = on_curve(low), to = on_curve(high);
        const auto blocks = [&](std::int32_t n) {
            const PlanPoint& p = ring_.place(n);
            if (p[0] < low[0] || p[0] > high[0] || p[1] < low[1] || p[1] > high[1]) return false;
            if (p == a || p == b || p == c) return false;
            return side_of_line(a, b, p) >= 0 && side_of_line(b, c, p) >= 0 &&
                   side_of_line(c, a, p) >= 0;
        };
        std::int32_t up = after_[tip], down = before_[tip];
        while (true) {
            const bool goes_up = up >= 0 && curve_[up] <= to;
            const bool goes_down = down >= 0 && curve_[down] >= from;
            if (!goes_up && !goes_down) return true;
            if (goes_up) {
                if (blocks(up)) return false;
                up = after_[up];
            }
            if (goes_down) {
                if (blocks(down)) return false;
                down = before_[down];
            }
        }
    }

    /// Makes a triangle whose first two sides are the edges of nodes a and b.
    std::int32_t add(std::int32_t a, std::int32_t b, std::int32_t c) {
        const auto& nodes = ring_.nodes;
        const std::int32_t t =
            mesh_.add_triangle({nodes[a].corner, nodes[b].corner, nodes[c].corner});
        place({t, 0}, a);
        place({t, 1}, b);
        return t;
    }

    /// A side is the edge of a node: it gets what lies behind that.
    void place(Side side, std::int32_t node) {
        EarNode& edge = ring_.nodes[node];
        if (edge.twin >= 0) {
            edge.placed = side;
            const Side other = ring_.nodes[edge.twin].placed;
            if (!other.is_outside()) mesh_.join(side, other);
        } else if (!edge.behind.is_outside()) {
            mesh_.join(side, edge.behind);
        }
    }

    void cut(std::int32_t tip) {
        const std::int32_t a = ring_.nodes[tip].previous, c = ring_.nodes[tip].next;
        const std::int32_t t = add(a, tip, c);
        // The edge from a now is the diagonal, no longer the bridge that it may have been.
        EarNode& from = ring_.nodes[a];
        if (from.twin >= 0) keep_twin(from.twin, from.placed);
        from.twin = -1;
        from.behind = {t, 2};
        from.next = c;
        ring_.nodes[c].previous = a;
        if (before_[tip] >= 0) after_[before_[tip]] = after_[tip];
        if (after_[tip] >= 0) before_[after_[tip]] = before_[tip];
        --left_;
    }

    /// The twin of a bridge that has been placed knows from now on what lies behind it.
    void keep_twin(std::int32_t twin, Side placed) {
        EarNode& other = ring_.nodes[twin];
        if (!other.placed.is_outside()) return;  // both are placed and joined
        other.twin = -1;
        other.behind = placed;
    }

    EarRing& ring_;
    const Check& check_;
    FlatMesh mesh_;
    std::vector<std::uint32_t> curve_;
    std::vector<std::int32_t> before_, after_;
    PlanPoint low_{};
    double scale_ = 0;
    std::int32_t left_ = 0;
};

/// The same by constrained Delaunay triangulation, corners named by their first appearance.
Triangles by_region(std::span<const Ring> rings, std::span<const PlanPoint> corners,
                    const Progress* progress) {
    const RingTriangulation region = triangulate_region(rings, progress);
    std::vector<std::int32_t> order(corners.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        order[i] = static_cast<std::int32_t>(i);
    std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
        return corners[a] != corners[b] ? corners[a] < corners[b] : a < b;
    });
    std::vector<std::int32_t> corner_of;
    corner_of.reserve(region.graph.points.size());
    for (const PlanPoint& p : region.graph.points) {
        corner_of.push_back(
            *std::lower_bound(order.begin(), order.end(), p,
                              [&](std::int32_t a, const PlanPoint& q) { return corners[a] < q; }));
    }
    Triangles triangles;
    for (std::size_t t = 0; t < region.inside.size(); ++t) {
        if (!region.inside[t]) continue;
        const auto& [a, b, c] = region.triangulation.triangles[t];
        triangles.push_back({corner_of[a], corner_of[b], corner_of[c]});
    }
    return triangles;
}

/// Whether ear clipping can begin: three distinct corners in each ring, all of them finite.
bool is_plain(std::span<const Ring> rings) {
    if (rings.empty()) return false;
    return std::all_of(rings.begin(), rings.end(), [](const Ring& ring) {
        if (ring.size() < 3) return false;
        const bool is_finite = std::all_of(ring.begin(), ring.end(), [](const PlanPoint& p) {
            return std::isfinite(p[0]) && std::isfinite(p[1]);
        });
        const auto other = std::find_if(ring.begin(), ring.end(),
                                        [&](const PlanPoint& p) { return p != ring[0]; });
        return is_finite && other != ring.end() &&
               std::any_of(other, ring.end(), [&](const PlanPoint& p) {
                   return side_of_line(ring[0], *other, p) != 0;
               });
    });
}

}  // namespace

Triangles triangulate_polygon(std::span<const Ring> rings, const Progress* progress) {
    const Check check = [progress](double) {
        if (progress != nullptr) progress->check();
    };
    std::vector<PlanPoint> corners;
    for (const Ring& ring : rings)
        corners.insert(corners.end(), ring.begin(), ring.end());
    if (is_plain(rings)) {
        EarRing ring(rings, corners);
        if (ring.join_holes()) {
            Clipping clipping(ring, corners, check);
            if (clipping.run()) return clipping.swapped();
        }
    }
    return by_region(rings, corners, progress);
}

}  // namespace realmodel::meshing
