// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact_volumes.hpp"

#include <gmpxx.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace realmodel::fuzz {

namespace {

/// A plan point x / w, y / w with w > 0.
struct Corner {
    mpz_class x, y, w;
};

using Polygon = std::vector<Corner>;  // convex, counter-clockwise

/// Positive to the left of it: a x + b y + c w.
struct Line {
    mpz_class a, b, c;
    int side(const Corner& p) const { return sgn(value(p)); }
    mpz_class value(const Corner& p) const { return a * p.x + b * p.y + c * p.w; }
};

/// z = (a x + b y + c) / d, d > 0.
struct Plane {
    mpz_class a, b, c, d;
};

struct ExactTriangle {
    Polygon outline;
    std::array<Line, 3> lines;
    Plane plane;
};

/// A convex polygon and for every surface so far its plane there, or none.
struct Column {
    Polygon outline;
    std::vector<const Plane*> planes;
};

/// Whole numbers in the place of doubles: multiplied by a power of two.
class Scale {
public:
    void include(double value) {
        const auto [mantissa, exponent] = parts(value);
        if (mantissa != 0) power_ = std::max(power_, -exponent - std::countr_zero(mantissa));
    }
    mpz_class integer(double value) const {
        const auto [mantissa, exponent] = parts(value);
        mpz_class whole(static_cast<double>(static_cast<std::int64_t>(mantissa)));
        const int shift = exponent + power_;
        if (shift >= 0) return whole << static_cast<unsigned long>(shift);
        return whole >> static_cast<unsigned long>(-shift);  // only zeros go
    }
    int power() const { return power_; }

private:
    static std::pair<std::uint64_t, int> parts(double value) {
        int exponent = 0;
        const double fraction = std::frexp(value, &exponent);
        return {static_cast<std::uint64_t>(static_cast<std::int64_t>(std::ldexp(fraction, 53))),
                exponent - 53};
    }

    int power_ = 0;
};

Corner crossing(const Corner& p, const mpz_class& sp, const Corner& q, const mpz_class& sq) {
    // sp and sq have opposite signs
    Corner c{sp * q.x - sq * p.x, sp * q.y - sq * p.y, sp * q.w - sq * p.w};
    mpz_class common = gcd(gcd(c.x, c.y), c.w);
    if (sgn(c.w) < 0) common = -common;
    mpz_divexact(c.x.get_mpz_t(), c.x.get_mpz_t(), common.get_mpz_t());
    mpz_divexact(c.y.get_mpz_t(), c.y.get_mpz_t(), common.get_mpz_t());
    mpz_divexact(c.w.get_mpz_t(), c.w.get_mpz_t(), common.get_mpz_t());
    return c;
}

/// The parts of a convex polygon left and right of a line, empty where they have no area.
std::pair<Polygon, Polygon> split(const Polygon& polygon, const Line& line) {
    std::vector<mpz_class> side;
    bool left_of = false, right_of = false;
    for (const Corner& corner : polygon) {
        side.push_back(line.value(corner));
        left_of |= sgn(side.back()) > 0;
        right_of |= sgn(side.back()) < 0;
    }
    if (!right_of) return {polygon, {}};
    if (!left_of) return {{}, polygon};
    Polygon left, right;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const std::size_t before = (i + polygon.size() - 1) % polygon.size();
        if (sgn(side[before]) * sgn(side[i]) < 0) {
            left.push_back(crossing(polygon[before], side[before], polygon[i], side[i]));
            right.push_back(left.back());
        }
        if (sgn(side[i]) >= 0) left.push_back(polygon[i]);
        if (sgn(side[i]) <= 0) right.push_back(polygon[i]);
    }
    return {left, right};
}

/// Appends what of the polygon lies outside of a triangle, and returns what lies inside.
Polygon part_inside(const Polygon& polygon, const ExactTriangle& triangle,
                    std::vector<Polygon>& outside) {
    for (const Line& line : triangle.lines) {
        if (std::none_of(polygon.begin(), polygon.end(),
                         [&](const Corner& p) { return line.side(p) > 0; })) {
            outside.push_back(polygon);
            return {};
        }
    }
    Polygon inside = polygon;
    std::vector<Polygon> cut;
    for (const Line& line : triangle.lines) {
        auto [left, right] = split(inside, line);
        if (left.empty()) {
            outside.push_back(polygon);
            return {};
        }
        if (!right.empty()) cut.push_back(std::move(right));
        inside = std::move(left);
    }
    outside.insert(outside.end(), cut.begin(), cut.end());
    return inside;
}

/// Planes over a convex polygon, compared where their order is the same all over it. Where it is
/// not the line on which it changes is kept.
class Order {
public:
    explicit Order(const Polygon& polygon) : polygon_(polygon) {}

    /// -1, 0, 1: p lies below, on, above q.
    int of(const Plane& p, const Plane& q) {
        if (&p == &q) return 0;
        Line line{p.a * q.d - q.a * p.d, p.b * q.d - q.b * p.d, p.c * q.d - q.c * p.d};
        int low = 0, high = 0;
        for (const Corner& corner : polygon_) {
            const int side = line.side(corner);
            low = std::min(low, side);
            high = std::max(high, side);
        }
        if (low < 0 && high > 0) changes_ = std::move(line);
        return high > 0 ? 1 : low;
    }
    const Plane* higher(const Plane* p, const Plane* q) { return of(*p, *q) >= 0 ? p : q; }
    const Plane* lower(const Plane* p, const Plane* q) { return of(*p, *q) <= 0 ? p : q; }
    const std::optional<Line>& changes() const { return changes_; }

private:
    const Polygon& polygon_;
    std::optional<Line> changes_;
};

struct Block {
    std::size_t surface;
    const Plane *under, *over;
};

/// The blocks over a polygon, or a line on which it must be divided first.
std::vector<Block> blocks_of(Order& order, const std::vector<const Plane*>& planes,
                             const RockCase& rock, const Plane* base) {
    const Plane *top = nullptr, *floor = nullptr;
    std::vector<const Plane*> level, before;
    for (std::size_t k = 0; k < planes.size(); ++k) {
        before.push_back(top);
        level.push_back(planes[k]);
        if (planes[k] == nullptr) continue;
        const strata::RuleMeaning& rule = strata::meaning(rock.rule(k));
        if (!rule.cuts && top != nullptr) level[k] = order.higher(level[k], top);
        if (floor != nullptr) level[k] = order.higher(level[k], floor);
        top = level[k];
        if (rule.protects) floor = level[k];
        if (order.changes()) return {};
    }
    std::vector<Block> blocks;
    const Plane* envelope = nullptr;
    for (std::size_t k = planes.size(); k-- > 0;) {
        if (level[k] == nullptr) continue;
        envelope = envelope == nullptr ? level[k] : order.lower(envelope, level[k]);
        const Plane* under = k == 0 ? base : before[k];
        if (under != nullptr && order.of(*under, *envelope) < 0)
            blocks.push_back({k, under, envelope});
        if (order.changes()) return {};
    }
    return blocks;
}

/// Twice the area, six times the integrals of x and of y.
struct Moments {
    mpq_class area, x, y;
    explicit Moments(const Polygon& polygon) {
        const Corner& p = polygon[0];
        for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
            const Corner &q = polygon[i], &r = polygon[i + 1];
            mpq_class doubled(p.x * (q.y * r.w - r.y * q.w) - q.x * (p.y * r.w - r.y * p.w) +
                                  r.x * (p.y * q.w - q.y * p.w),
                              p.w * q.w * r.w);
            doubled.canonicalize();
            area += doubled;
            x += doubled * (ratio(p.x, p.w) + ratio(q.x, q.w) + ratio(r.x, r.w));
            y += doubled * (ratio(p.y, p.w) + ratio(q.y, q.w) + ratio(r.y, r.w));
        }
    }
    /// The integral of a plane's height.
    mpq_class under(const Plane& plane) const {
        return (plane.a * x + plane.b * y + 3 * plane.c * area) / mpq_class(6 * plane.d);
    }

private:
    static mpq_class ratio(const mpz_class& n, const mpz_class& d) {
        mpq_class q(n, d);
        q.canonicalize();
        return q;
    }
};

class Integral {
public:
    Integral(const RockCase& rock, std::size_t most) : rock_(rock), most_(most) {
        const auto plan = [&](const auto& mesh) {
            for (const auto& vertex : mesh.vertices) {
                plan_.include(vertex[0]);
                plan_.include(vertex[1]);
            }
        };
        for (const Mesh& surface : rock.surfaces) {
            plan(surface);
            for (const Point& vertex : surface.vertices)
                height_.include(vertex[2]);
        }
        if (rock.region) plan(*rock.region);
        if (rock.base_elevation) height_.include(*rock.base_elevation);
    }

    /// Volumes of the rock mass's blocks; nothing where that would take too many polygons.
    std::optional<std::vector<double>> volumes() {
        std::vector<Column> columns;
        for (Polygon& outline : start())
            columns.push_back({std::move(outline), {}});
        std::vector<std::vector<ExactTriangle>> sheets;
        for (const Mesh& surface : rock_.surfaces) {
            sheets.push_back(triangles_of(surface));
            columns = overlaid(columns, sheets.back());
            if (columns.size() > most_) return std::nullopt;
        }
        const Plane base{0, 0, height_.integer(rock_.base_elevation.value_or(0)), 1};
        std::vector<mpq_class> sums(rock_.surfaces.size());
        for (const Column& column : columns)
            integrate(column, rock_.base_elevation ? &base : nullptr, sums);
        std::vector<double> volumes;
        for (mpq_class& sum : sums) {
            mpq_div_2exp(sum.get_mpq_t(), sum.get_mpq_t(),
                         static_cast<mp_bitcnt_t>(2 * plan_.power() + height_.power()));
            const double rounded = sum.get_d();
            // what is not zero must not become zero
            volumes.push_back(rounded == 0 ? sgn(sum) * std::numeric_limits<double>::denorm_min()
                                           : rounded);
        }
        return volumes;
    }

private:
    template <class M>
    std::array<Corner, 3> corners_of(const M& mesh, const Triangle& triangle) const {
        const std::array<PlanPoint, 3> plan = plan_corners(mesh, triangle);
        std::array<Corner, 3> corners;
        for (std::size_t i = 0; i < 3; ++i)
            corners[i] = {plan_.integer(plan[i][0]), plan_.integer(plan[i][1]), 1};
        return corners;
    }

    static Line through(const Corner& p, const Corner& q) {
        return {p.y - q.y, q.x - p.x, p.x * q.y - p.y * q.x};
    }

    std::vector<ExactTriangle> triangles_of(const Mesh& mesh) const {
        std::vector<ExactTriangle> result;
        for (const Triangle& t : mesh.triangles) {
            if (is_flat(plan_corners(mesh, t))) continue;
            const std::array<Corner, 3> p = corners_of(mesh, t);
            ExactTriangle exact;
            exact.outline.assign(p.begin(), p.end());
            exact.lines = {through(p[0], p[1]), through(p[1], p[2]), through(p[2], p[0])};
            exact.plane.d = exact.lines[0].value(p[2]);
            // the weight of a corner is the line opposite of it; corners may have been turned round
            for (std::size_t i = 0; i < 3; ++i) {
                const Line& weight = exact.lines[(i + 1) % 3];
                const mpz_class z = height_at(mesh, t, p[i]);
                exact.plane.a += weight.a * z;
                exact.plane.b += weight.b * z;
                exact.plane.c += weight.c * z;
            }
            result.push_back(std::move(exact));
        }
        return result;
    }

    mpz_class height_at(const Mesh& mesh, const Triangle& triangle, const Corner& corner) const {
        for (const std::int32_t v : triangle) {
            const Point& vertex = mesh.vertices[static_cast<std::size_t>(v)];
            if (plan_.integer(vertex[0]) == corner.x && plan_.integer(vertex[1]) == corner.y)
                return height_.integer(vertex[2]);
        }
        return 0;
    }

    /// The region's triangles, or a rectangle round everything.
    std::vector<Polygon> start() const {
        std::vector<Polygon> polygons;
        if (rock_.region) {
            for (const Triangle& t : rock_.region->triangles) {
                if (is_flat(plan_corners(*rock_.region, t))) continue;
                const auto corners = corners_of(*rock_.region, t);
                polygons.emplace_back(corners.begin(), corners.end());
            }
            return polygons;
        }
        std::optional<std::array<double, 4>> box;
        for (const Mesh& surface : rock_.surfaces) {
            for (const auto& [x, y, z] : surface.vertices) {
                if (!box) box = {x, y, x, y};
                box = {std::min((*box)[0], x), std::min((*box)[1], y), std::max((*box)[2], x),
                       std::max((*box)[3], y)};
            }
        }
        if (!box || (*box)[0] == (*box)[2] || (*box)[1] == (*box)[3]) return polygons;
        const auto [x0, y0, x1, y1] =
            std::array{plan_.integer((*box)[0]), plan_.integer((*box)[1]), plan_.integer((*box)[2]),
                       plan_.integer((*box)[3])};
        polygons.push_back({{x0, y0, 1}, {x1, y0, 1}, {x1, y1, 1}, {x0, y1, 1}});
        return polygons;
    }

    /// The columns divided by one more surface.
    static std::vector<Column> overlaid(const std::vector<Column>& columns,
                                        const std::vector<ExactTriangle>& sheet) {
        std::vector<Column> result;
        const auto add = [&](Polygon outline, const Column& from, const Plane* plane) {
            result.push_back({std::move(outline), from.planes});
            result.back().planes.push_back(plane);
        };
        for (const Column& column : columns) {
            std::vector<Polygon> remaining{column.outline}, rest;
            for (const ExactTriangle& triangle : sheet) {
                rest.clear();
                for (const Polygon& polygon : remaining) {
                    Polygon inside = part_inside(polygon, triangle, rest);
                    if (!inside.empty()) add(std::move(inside), column, &triangle.plane);
                }
                remaining.swap(rest);
            }
            for (Polygon& polygon : remaining)
                add(std::move(polygon), column, nullptr);
        }
        return result;
    }

    void integrate(const Column& column, const Plane* base, std::vector<mpq_class>& sums) const {
        std::vector<Polygon> waiting{column.outline};
        while (!waiting.empty()) {
            const Polygon polygon = std::move(waiting.back());
            waiting.pop_back();
            Order order(polygon);
            const std::vector<Block> blocks = blocks_of(order, column.planes, rock_, base);
            if (order.changes()) {
                auto [left, right] = split(polygon, *order.changes());
                waiting.push_back(std::move(left));
                waiting.push_back(std::move(right));
                continue;
            }
            if (blocks.empty()) continue;
            const Moments moments(polygon);
            for (const Block& block : blocks)
                sums[block.surface] += moments.under(*block.over) - moments.under(*block.under);
        }
    }

    const RockCase& rock_;
    std::size_t most_;
    Scale plan_, height_;
};

}  // namespace

std::optional<std::vector<double>> exact_volumes(const StackCase& stack, std::size_t most) {
    std::vector<double> all;
    for (const RockCase& rock : stack.rocks) {
        const auto volumes = Integral(rock, most).volumes();
        if (!volumes) return std::nullopt;
        all.insert(all.end(), volumes->begin(), volumes->end());
    }
    return all;
}

}  // namespace realmodel::fuzz
