// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/smoothing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "meshing/plan_predicates.hpp"
#include "meshing/point_insertion.hpp"

namespace realmodel::meshing {

namespace {

constexpr int rounds = 8;
constexpr int moves_per_round = 2;
constexpr int last_moves = 4;
constexpr double least_ratio_of_flips = 0.35;
constexpr double longest_after_collapse = 1.55;  // lengths wanted
constexpr double moved_enough = 1e-3;            // of an edge: less is not worth another visit

/// 4 sqrt(3) / mean ratio of a triangle over base a-b, as a function of its apex, with derivatives:
/// convex for apexes left of the base.
struct Shape {
    double value = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;

    /// False where the apex is not left of the base.
    bool add(const PlanPoint& a, const PlanPoint& b, const PlanPoint& apex) {
        const double bx = b[0] - a[0], by = b[1] - a[1];
        const double base = std::sqrt(bx * bx + by * by);
        const double ux = bx / base, uy = by / base;
        const double px = apex[0] - 0.5 * (a[0] + b[0]), py = apex[1] - 0.5 * (a[1] + b[1]);
        const double s = px * ux + py * uy, h = py * ux - px * uy;
        if (!(h > 0)) return false;
        const double over = 1 / (base * h);
        const double ds = 8 * s * over, dh = (4 * h * h - 3 * base * base - 4 * s * s) * over / h;
        const double dss = 8 * over, dsh = -ds / h,
                     dhh = (8 * s * s + 6 * base * base) * over / (h * h);
        value += (3 * base * base + 4 * s * s + 4 * h * h) * over;
        x += ds * ux - dh * uy;
        y += ds * uy + dh * ux;
        xx += dss * ux * ux - 2 * dsh * ux * uy + dhh * uy * uy;
        xy += dss * ux * uy + dsh * (ux * ux - uy * uy) - dhh * ux * uy;
        yy += dss * uy * uy + 2 * dsh * ux * uy + dhh * ux * ux;
        return true;
    }
};

double mean_ratio(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c) {
    const double squares = squared_distance(a, b) + squared_distance(b, c) + squared_distance(c, a);
    return 2 * std::numbers::sqrt3 * twice_area(a, b, c) / squares;
}

class Smoothing {
public:
    Smoothing(FlatMesh& mesh, const SizeField& size, std::int32_t first,
              std::span<const std::int32_t> also, std::int32_t corners,
              std::span<const std::int32_t> kept)
        : mesh_(mesh), size_(size) {
        const std::size_t points = mesh.points.size();
        leaving_.resize(points);
        triangles_.assign(points, 0);
        wanted_.assign(points, 6);
        is_still_.assign(points, true);
        is_fixed_.assign(points, false);
        line_.assign(points, none);
        find_active(first, also, corners);
        for (const std::int32_t v : kept)
            is_still_[v] = is_fixed_[v] = true;
    }

    void run(const Check& check) {
        Ticker tick(check);
        for (int round = 0; round < rounds; ++round) {
            flip_towards_six(tick);
            collapse_towards_six(tick);
            for (int i = 0; i < moves_per_round; ++i)
                move_all(tick);
            make_delaunay(tick);
        }
        for (int i = 0; i < last_moves; ++i)
            move_all(tick);
        make_delaunay(tick);
        move_all(tick);
        make_delaunay(tick);
    }

private:
    static constexpr std::int32_t none = -1;

    void find_active(std::int32_t first, std::span<const std::int32_t> also, std::int32_t corners) {
        const auto count = static_cast<std::int32_t>(mesh_.corners.size());
        std::vector<double> angles(mesh_.points.size(), 0.0);
        std::vector<bool> near(mesh_.points.size(), false);
        const auto take = [&](std::int32_t t) {
            for (const std::int32_t v : mesh_.corners[t])
                near[v] = true;
        };
        for (std::int32_t t = first; t < count; ++t)
            if (!mesh_.is_dead(t)) take(t);
        for (const std::int32_t t : also)
            take(t);
        for (int ring = 0; ring < 2; ++ring) {
            std::vector<std::int32_t> more;
            for (std::int32_t t = 0; t < first; ++t) {
                const auto& c = mesh_.corners[t];
                if (near[c[0]] || near[c[1]] || near[c[2]]) more.push_back(t);
            }
            for (const std::int32_t t : more)
                take(t);
        }
        for (std::int32_t t = 0; t < count; ++t) {
            if (mesh_.is_dead(t)) continue;
            for (int i = 0; i < 3; ++i) {
                const Side side(t, i);
                const std::int32_t v = mesh_.from(side);
                leaving_[v] = side;
                ++triangles_[v];
                if (mesh_.is_fixed(side)) is_fixed_[v] = is_fixed_[mesh_.to(side)] = true;
            }
        }
        // Of one length pieces stay even: regions side by side meet in them.
        if (!size_.is_uniform()) find_sliding(corners);
        for (std::size_t v = 0; v < near.size(); ++v) {
            if (!near[v] || triangles_[v] == 0) continue;
            if (line_[v] != none) active_.push_back(static_cast<std::int32_t>(v));
            if (is_fixed_[v]) continue;
            is_still_[v] = false;
            active_.push_back(static_cast<std::int32_t>(v));
        }
        want_on_lines();
    }

    /// Vertices added between two corners of the border may slide between them.
    void find_sliding(std::int32_t corners) {
        const std::size_t points = mesh_.points.size();
        std::vector<Side> border(points, Side::outside());  // of each added vertex: from it
        std::vector<Side> begins;
        const auto count = static_cast<std::int32_t>(mesh_.corners.size());
        for (std::int32_t t = 0; t < count; ++t) {
            if (mesh_.is_dead(t)) continue;
            for (int i = 0; i < 3; ++i) {
                const Side side(t, i);
                if (!mesh_.is_border(side)) continue;
                if (mesh_.from(side) >= corners) {
                    border[mesh_.from(side)] = side;
                } else if (mesh_.to(side) >= corners) {
                    begins.push_back(side);
                }
            }
        }
        for (const Side begin : begins) {
            const auto line = static_cast<std::int32_t>(lines_.size());
            std::int32_t v = mesh_.to(begin);
            for (; v >= corners; v = mesh_.to(border[v])) {
                line_[v] = line;
            }
            lines_.push_back({mesh_.point_from(begin), mesh_.points[v]});
        }
    }

    /// On fixed lines each sector between two fixed sides wants triangles of 60 degrees.
    void want_on_lines() {
        std::vector<bool> seen(mesh_.points.size(), false);
        const auto count = static_cast<std::int32_t>(mesh_.corners.size());
        for (std::int32_t t = 0; t < count; ++t) {
            if (mesh_.is_dead(t)) continue;
            for (int i = 0; i < 3; ++i) {
                const Side begin(t, i);
                if (!mesh_.is_fixed(begin)) continue;
                const std::int32_t v = mesh_.from(begin);
                if (!seen[v]) {
                    seen[v] = true;
                    wanted_[v] = 0;
                }
                double angle = 0;
                Side side = begin;
                while (true) {
                    angle += angle_at(side);
                    const Side last = side.previous();
                    if (mesh_.is_fixed(last)) break;
                    side = mesh_.turn_left(side);
                }
                wanted_[v] +=
                    std::max(1, static_cast<int>(std::lround(angle * 3 / std::numbers::pi)));
            }
        }
    }

    double angle_at(Side side) const {
        const PlanPoint &p = mesh_.point_from(side), &a = mesh_.point_to(side),
                        &b = mesh_.point_apex(side);
        const double ux = a[0] - p[0], uy = a[1] - p[1], vx = b[0] - p[0], vy = b[1] - p[1];
        return std::atan2(ux * vy - uy * vx, ux * vx + uy * vy);
    }

    int strain(std::int32_t vertex, int more) const {
        const int off = triangles_[vertex] + more - wanted_[vertex];
        return off * off;
    }

    Side flip(Side side) {
        const std::int32_t a = mesh_.from(side), b = mesh_.to(side);
        const Side diagonal = mesh_.flip(side);
        const Side other = mesh_.behind(diagonal);
        --triangles_[a];
        --triangles_[b];
        ++triangles_[mesh_.from(diagonal)];
        ++triangles_[mesh_.to(diagonal)];
        for (const Side s : {diagonal, diagonal.next(), diagonal.previous(), other.previous()})
            leaving_[mesh_.from(s)] = s;
        return diagonal;
    }

    template <class Visit>
    void around(std::int32_t vertex, Visit&& visit) {
        Side begin = leaving_[vertex];
        if (line_[vertex] != none) {  // half a star, from the border to the border
            while (!mesh_.is_border(begin))
                begin = mesh_.turn_right(begin);
        }
        Side side = begin;
        do {
            visit(side);
            side = mesh_.turn_left(side);
        } while (!side.is_outside() && side != begin);
    }

    void flip_towards_six(Ticker& tick) {
        for (const std::int32_t v : active_) {
            tick(0.2);
            if (is_gone(v)) continue;
            sides_.clear();
            around(v, [&](Side side) { sides_.push_back(side); });
            for (const Side side : sides_) {
                if (mesh_.from(side) != v || mesh_.is_fixed(side)) continue;
                const Side other = mesh_.behind(side);
                const std::int32_t a = v, b = mesh_.to(side), c = mesh_.apex(side),
                                   d = mesh_.apex(other);
                if (strain(a, -1) + strain(b, -1) + strain(c, 1) + strain(d, 1) >=
                    strain(a, 0) + strain(b, 0) + strain(c, 0) + strain(d, 0)) {
                    continue;
                }
                if ((triangles_[a] <= 3 && !is_fixed_[a]) ||
                    (triangles_[b] <= 3 && !is_fixed_[b])) {
                    continue;
                }
                const PlanPoint &p = mesh_.points[a], &q = mesh_.points[b], &l = mesh_.points[c],
                                &r = mesh_.points[d];
                if (mean_ratio(r, l, p) < least_ratio_of_flips ||
                    mean_ratio(l, r, q) < least_ratio_of_flips) {
                    continue;
                }
                if (side_of_line(r, l, p) <= 0 || side_of_line(l, r, q) <= 0) continue;
                flip(side);
                break;  // the star has changed
            }
        }
    }

    bool is_gone(std::int32_t vertex) const { return triangles_[vertex] == 0; }

    void collapse_towards_six(Ticker& tick) {
        for (const std::int32_t v : active_) {
            tick(0.4);
            if (is_gone(v)) continue;
            if (line_[v] != none) pass_by(v);
            if (is_still_[v] || triangles_[v] > 5) continue;
            sides_.clear();
            around(v, [&](Side side) { sides_.push_back(side); });
            Side best = Side::outside();
            int best_gain = 0;
            for (const Side side : sides_) {
                const std::int32_t u = mesh_.to(side), c = mesh_.apex(side),
                                   d = mesh_.apex(mesh_.behind(side));
                const int gain = strain(v, 0) + strain(u, 0) + strain(c, 0) + strain(d, 0) -
                                 strain(u, triangles_[v] - 4) - strain(c, -1) - strain(d, -1);
                if (gain <= best_gain) continue;
                if ((!is_fixed_[c] && triangles_[c] <= 4) ||
                    (!is_fixed_[d] && triangles_[d] <= 4)) {
                    continue;
                }
                if (!can_collapse_to(u)) continue;
                best = side;
                best_gain = gain;
            }
            if (!best.is_outside()) collapse(best);
        }
    }

    /// Takes a vertex with two triangles out of the border where that helps the one opposite.
    void pass_by(std::int32_t v) {
        if (triangles_[v] != 2) return;
        Side side = leaving_[v];
        if (!mesh_.is_border(side)) side = mesh_.turn_right(side);
        const std::int32_t next = mesh_.to(side), opposite = mesh_.apex(side),
                           last = mesh_.apex(mesh_.behind(side.previous()));
        if (strain(v, 0) + strain(opposite, 0) <= strain(opposite, -1)) return;
        const PlanPoint &p = mesh_.points[last], &q = mesh_.points[next],
                        &r = mesh_.points[opposite];
        const double longest = longest_after_collapse * size_.at(mesh_.points[v]);
        if (squared_distance(p, q) > longest * longest) return;
        if (mean_ratio(p, q, r) < least_ratio_of_flips || side_of_line(p, q, r) <= 0) return;
        mesh_.pass_by(side);
        triangles_[v] = 0;
        --triangles_[opposite];
        leaving_[last] = side;
        leaving_[next] = side.next();
        leaving_[opposite] = side.previous();
    }

    /// Whether no triangle turns over or gets too long or thin if the vertex that `sides_` leave
    /// goes to where u is.
    bool can_collapse_to(std::int32_t u) const {
        const PlanPoint& to = mesh_.points[u];
        const double longest = longest_after_collapse * size_.at(to);
        for (const Side side : sides_) {
            const std::int32_t a = mesh_.to(side), b = mesh_.apex(side);
            if (a == u || b == u) continue;
            const PlanPoint &p = mesh_.points[a], &q = mesh_.points[b];
            if (side_of_line(p, q, to) <= 0) return false;
            if (mean_ratio(p, q, to) < least_ratio_of_flips) return false;
            if (squared_distance(p, to) > longest * longest) return false;
        }
        return true;
    }

    void collapse(Side side) {
        const std::int32_t v = mesh_.from(side), u = mesh_.to(side), c = mesh_.apex(side),
                           d = mesh_.apex(mesh_.behind(side));
        triangles_[u] += triangles_[v] - 4;
        --triangles_[c];
        --triangles_[d];
        triangles_[v] = 0;
        const auto [left, right] = mesh_.collapse(side);
        leaving_[u] = left;         // from u to c
        leaving_[c] = left.next();  // a triangle of what was the star of v
        leaving_[d] = right;        // from d to u
    }

    void move_all(Ticker& tick) {
        for (const std::int32_t v : active_) {
            tick(0.6);
            if (is_gone(v)) continue;
            if (line_[v] != none) {
                slide(v);
            } else if (!is_still_[v]) {
                move(v);
            }
        }
    }

    void move(std::int32_t v) {
        const PlanPoint& p = mesh_.points[v];
        const Shape now = shape_of_star(v);
        const double determinant = now.xx * now.yy - now.xy * now.xy;
        const double dx = -(now.yy * now.x - now.xy * now.y) / determinant;
        const double dy = -(now.xx * now.y - now.xy * now.x) / determinant;
        step(v, now, std::hypot(dx, dy), [&](double share) {
            return PlanPoint{p[0] + share * dx, p[1] + share * dy};
        });
    }

    /// The same along the line between two corners of the border.
    void slide(std::int32_t v) {
        const PlanPoint& p = mesh_.points[v];
        const auto& line = lines_[line_[v]];
        const PlanPoint &a = line[0], &b = line[1];
        const double length = std::sqrt(squared_distance(a, b));
        const double ux = (b[0] - a[0]) / length, uy = (b[1] - a[1]) / length;
        const Shape now = shape_of_star(v);
        const double bend = ux * ux * now.xx + 2 * ux * uy * now.xy + uy * uy * now.yy;
        const double along = -(ux * now.x + uy * now.y) / bend;
        const double from = (p[0] - a[0]) * ux + (p[1] - a[1]) * uy;
        step(v, now, std::abs(along), [&](double share) {
            const double where = (from + share * along) / length;  // from the corners, rounded once
            return PlanPoint{a[0] + where * (b[0] - a[0]), a[1] + where * (b[1] - a[1])};
        });
    }

    Shape shape_of_star(std::int32_t v) {
        base_.clear();
        around(v, [&](Side side) { base_.push_back({mesh_.to(side), mesh_.apex(side)}); });
        return shape_at(mesh_.points[v]);
    }

    /// Of the star that base_ bounds; its value is infinite where a triangle would be turned over.
    Shape shape_at(const PlanPoint& place) const {
        Shape shape;
        for (const auto& [a, b] : base_) {
            if (shape.add(mesh_.points[a], mesh_.points[b], place)) continue;
            shape.value = std::numeric_limits<double>::infinity();
            break;
        }
        return shape;
    }

    /// Goes as large a share of a way as makes the star better.
    template <class Place>
    void step(std::int32_t v, const Shape& now, double way, const Place& place_at) {
        PlanPoint& p = mesh_.points[v];
        if (!std::isfinite(now.value) || !std::isfinite(way)) return;
        const double least =
            moved_enough * std::sqrt(squared_distance(p, mesh_.points[base_[0][0]]));
        double share = 1;
        for (int halving = 0; halving < 6; ++halving, share /= 2) {
            if (share * way < least) return;
            const PlanPoint place = place_at(share);
            if (!(shape_at(place).value < now.value)) continue;
            const bool is_upright = std::all_of(base_.begin(), base_.end(), [&](const auto& base) {
                return side_of_line(mesh_.points[base[0]], mesh_.points[base[1]], place) > 0;
            });
            if (!is_upright) continue;
            p = place;
            return;
        }
    }

    void make_delaunay(Ticker& tick) {
        std::vector<Side>& open = sides_;
        for (const std::int32_t v : active_) {
            tick(0.8);
            if (is_gone(v)) continue;
            open.clear();
            around(v, [&](Side side) {
                open.push_back(side);
                open.push_back(side.next());
            });
            while (!open.empty()) {
                const Side side = open.back();
                open.pop_back();
                if (!mesh_.should_flip(side)) continue;
                const Side diagonal = flip(side), other = mesh_.behind(diagonal);
                for (const Side s :
                     {diagonal.next(), diagonal.previous(), other.next(), other.previous()})
                    open.push_back(s);
            }
        }
    }

    FlatMesh& mesh_;
    const SizeField& size_;
    std::vector<Side> leaving_;            ///< of each vertex: a side from it
    std::vector<std::int32_t> triangles_;  ///< of each vertex: how many it has; 0: it is gone
    std::vector<std::int32_t> wanted_;     ///< and how many it should have
    std::vector<bool> is_still_, is_fixed_;
    std::vector<std::int32_t> line_;  ///< of each vertex: which of the lines it slides on, or none
    std::vector<std::array<PlanPoint, 2>> lines_;
    std::vector<std::int32_t> active_;
    std::vector<Side> sides_;
    std::vector<std::array<std::int32_t, 2>> base_;
};

}  // namespace

void smooth(FlatMesh& mesh, const SizeField& size, std::int32_t first,
            std::span<const std::int32_t> also, std::int32_t corners,
            std::span<const std::int32_t> kept, const Check& check) {
    Smoothing(mesh, size, first, also, corners, kept).run(check);
}

}  // namespace realmodel::meshing
