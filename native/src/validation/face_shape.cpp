// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/face_shape.hpp"

#include <algorithm>
#include <cmath>

#include "base/vectors.hpp"
#include "exact/double_double_interval.hpp"
#include "realmodel/strata/stack.hpp"
#include "validation/findings.hpp"

namespace realmodel::validation {

using exact::DoubleDoubleInterval;

namespace {

constexpr double kTiny = 1e-290;

/// Moving both ends of both edges by the allowance changes their cross product by this much.
double cross_allowance(const std::array<double, 2>& u, const std::array<double, 2>& v,
                       const std::array<double, 2>& allowance) {
    return 2 * (allowance[0] * (std::abs(u[1]) + std::abs(v[1]) + allowance[1]) +
                allowance[1] * (std::abs(u[0]) + std::abs(v[0]) + allowance[0]));
}

}  // namespace

std::optional<std::string> FaceShape::fault() {
    const std::int32_t surface = model_.face_surface[face_];
    if (surface == kWall) {
        const PlanPosition way = way_of_wall();
        if (way == PlanPosition{0, 0}) return "is a wall, but has no extent in plan";
        if (!is_upright(way)) return "is a wall but is not vertical";
        project(std::abs(way[0]) >= std::abs(way[1]) ? 0 : 1, 2);
        return crosses_itself() ? std::optional<std::string>("crosses itself") : std::nullopt;
    }
    if (surface == kBase) {
        if (auto text = fault_of_base()) return text;
    }
    if (!is_flat()) return "is bent: its corners lie in no plane";
    // all but the caps of a cut have an extent in plan
    const auto steepest = static_cast<std::size_t>(
        std::max_element(area_.begin(), area_.end(),
                         [](double a, double b) { return std::abs(a) < std::abs(b); }) -
        area_.begin());
    const std::size_t across = surface == kCutFace ? steepest : 2;
    project((across + 1) % 3, (across + 2) % 3);
    if (is_convex()) return std::nullopt;
    return crosses_itself() ? "crosses itself" : "is not convex";
}

void FaceShape::load(std::size_t face) {
    face_ = face;
    const auto loop = model_.face(face);
    corners_.resize(loop.size());
    Position largest{0, 0, 0};
    // vertices lie all over the memory: those of some faces ahead are sent for
    constexpr std::size_t kAhead = 64;
    const auto begin = static_cast<std::size_t>(model_.face_offsets[face]);
    const std::size_t corners = model_.face_vertices.size();
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const std::size_t ahead = std::min(begin + i + kAhead, corners - 1);
        __builtin_prefetch(
            &model_.vertices[static_cast<std::size_t>(model_.face_vertices[ahead]) * 3]);
        corners_[i] = model_.vertex(loop[i]);
        for (std::size_t axis = 0; axis < 3; ++axis)
            largest[axis] = std::max(largest[axis], std::abs(corners_[i][axis]));
    }
    for (std::size_t axis = 0; axis < 3; ++axis)
        allowance_[axis] = kRoundingSteps * last_place(largest[axis]) + kTiny;
    area_ = polygon_normal(corners_);
}

std::optional<std::string> FaceShape::fault_of_base() const {
    const std::int32_t block = model_.block(model_.cell(face_, 0));
    const double base = model_.block_base.empty()
                            ? corners_.front()[2]  // not known: level at least
                            : model_.block_base[static_cast<std::size_t>(block)];
    if (std::isnan(base)) return "names the flat base, but its block stands on none";
    if (model_.cell(face_, 1) >= 0) return "names the flat base, but lies between two cells";
    const bool level = std::all_of(corners_.begin(), corners_.end(),
                                   [&](const Position& p) { return p[2] == base; });
    return level ? std::nullopt : std::optional<std::string>("is not level with the flat base");
}

// The area vector stands on the plane that fits the corners; rounding moves a corner off it by no
// more than the sum of what it moves each coordinate. Where all corners lie on one line in plan, up
// to rounding, they lie in the upright plane through it: the area of such needles is nothing but
// rounding and does not say in which plane they were.
bool FaceShape::is_flat() const {
    if (corners_.size() == 3) return true;
    const double allowed = std::abs(area_[0]) * allowance_[0] + std::abs(area_[1]) * allowance_[1] +
                           std::abs(area_[2]) * allowance_[2];
    const Position& o = corners_.front();
    for (const Position& p : corners_) {
        if (std::abs(dot(area_, minus(p, o))) > allowed)
            return is_flat_precisely() || is_upright(way_of_wall());
    }
    return true;
}

// The area of a needle is a small difference of large products.
bool FaceShape::is_flat_precisely() const {
    const Position& o = corners_.front();
    const auto from_first = [&](const Position& p) {
        return std::array<DoubleDoubleInterval, 3>{DoubleDoubleInterval::difference(p[0], o[0]),
                                                   DoubleDoubleInterval::difference(p[1], o[1]),
                                                   DoubleDoubleInterval::difference(p[2], o[2])};
    };
    std::array<DoubleDoubleInterval, 3> area{};
    for (std::size_t i = 2; i < corners_.size(); ++i) {
        const auto u = from_first(corners_[i - 1]), v = from_first(corners_[i]);
        area[0] = area[0] + (u[1] * v[2] - u[2] * v[1]);
        area[1] = area[1] + (u[2] * v[0] - u[0] * v[2]);
        area[2] = area[2] + (u[0] * v[1] - u[1] * v[0]);
    }
    double allowed = kTiny;
    for (std::size_t axis = 0; axis < 3; ++axis)
        allowed += area[axis].magnitude() * allowance_[axis];
    return std::all_of(corners_.begin(), corners_.end(), [&](const Position& p) {
        const auto d = from_first(p);
        const DoubleDoubleInterval off = area[0] * d[0] + area[1] * d[1] + area[2] * d[2];
        return std::abs(off.high) - off.error <= allowed;
    });
}

// From the first corner to the one farthest from it.
FaceShape::PlanPosition FaceShape::way_of_wall() const {
    const Position& o = corners_.front();
    PlanPosition way{0, 0};
    for (const Position& p : corners_) {
        const PlanPosition d{p[0] - o[0], p[1] - o[1]};
        if (std::abs(d[0]) + std::abs(d[1]) > std::abs(way[0]) + std::abs(way[1])) way = d;
    }
    return way;
}

bool FaceShape::is_upright(const PlanPosition& way) const {
    const Position& o = corners_.front();
    const PlanPosition allowance{allowance_[0], allowance_[1]};
    return std::all_of(corners_.begin(), corners_.end(), [&](const Position& p) {
        const PlanPosition d{p[0] - o[0], p[1] - o[1]};
        return std::abs(cross(way, d)) <= cross_allowance(way, d, allowance);
    });
}

void FaceShape::project(std::size_t first_axis, std::size_t second_axis) {
    flat_.resize(corners_.size());
    for (std::size_t i = 0; i < corners_.size(); ++i)
        flat_[i] = {corners_[i][first_axis], corners_[i][second_axis]};
    flat_allowance_ = {allowance_[first_axis], allowance_[second_axis]};
}

// Rounding keeps the order of coordinates on each axis. So a convex polygon still turns one way (up
// to rounding), and rises and falls once along either axis.
bool FaceShape::is_convex() const {
    if (flat_.size() == 3) return true;
    return turns_one_way() && rises_and_falls_once(0) && rises_and_falls_once(1);
}

bool FaceShape::turns_one_way() const {
    const std::size_t n = flat_.size();
    bool left = true, right = true;
    PlanPosition before = minus(flat_[0], flat_[n - 1]);
    for (std::size_t i = 0; i < n; ++i) {
        const PlanPosition after = minus(flat_[i + 1 < n ? i + 1 : 0], flat_[i]);
        const double turn = cross(before, after);
        if (turn < 0 && left) left = -turn <= cross_allowance(before, after, flat_allowance_);
        if (turn > 0 && right) right = turn <= cross_allowance(before, after, flat_allowance_);
        before = after;
    }
    return left || right;
}

bool FaceShape::rises_and_falls_once(std::size_t axis) const {
    const std::size_t n = flat_.size();
    int changes = 0, way = 0, first_way = 0;
    double last = flat_[n - 1][axis];
    for (const PlanPosition& p : flat_) {
        const int now = (p[axis] > last) - (p[axis] < last);
        last = p[axis];
        if (now == 0) continue;
        changes += way != 0 && now != way ? 1 : 0;
        if (way == 0) first_way = now;
        way = now;
    }
    changes += way != first_way ? 1 : 0;
    if (changes <= 2) return true;
    // corners that were moved apart may be out of order by a little
    std::size_t lowest = 0, highest = 0;
    for (std::size_t i = 1; i < n; ++i) {
        if (flat_[i][axis] < flat_[lowest][axis]) lowest = i;
        if (flat_[i][axis] > flat_[highest][axis]) highest = i;
    }
    const double allowed = 2 * flat_allowance_[axis];
    double reached = flat_[lowest][axis];
    for (std::size_t i = lowest; i != highest; i = i + 1 < n ? i + 1 : 0) {
        if (reached - flat_[i][axis] > allowed) return false;
        reached = std::max(reached, flat_[i][axis]);
    }
    reached = flat_[highest][axis];
    for (std::size_t i = highest; i != lowest; i = i + 1 < n ? i + 1 : 0) {
        if (flat_[i][axis] - reached > allowed) return false;
        reached = std::min(reached, flat_[i][axis]);
    }
    return true;
}

bool FaceShape::crosses_itself() const {
    if (flat_.size() == 3) return false;
    if (rises_and_falls_once(0) && !chains_cross()) return false;
    const std::size_t n = flat_.size();
    const auto at = [&](std::size_t i) -> const PlanPosition& { return flat_[i < n ? i : i - n]; };
    // whether the ends of the other edge lie on different sides of an edge, beyond rounding
    const auto separates = [&](std::size_t edge, std::size_t other) {
        const PlanPosition way = minus(at(edge + 1), at(edge));
        const PlanPosition p = minus(at(other), at(edge)), q = minus(at(other + 1), at(edge));
        const double one = cross(way, p), two = cross(way, q);
        return (one < 0) != (two < 0) && std::abs(one) > cross_allowance(way, p, flat_allowance_) &&
               std::abs(two) > cross_allowance(way, q, flat_allowance_);
    };
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 2; j < n; ++j) {
            if (i == 0 && j + 1 == n) continue;
            if (separates(i, j) && separates(j, i)) return true;
        }
    }
    return false;
}

// A loop that goes there and back along the first axis consists of two chains, and can cross itself
// only where vertices of the one lie on both sides of the other.
bool FaceShape::chains_cross() const {
    const std::size_t n = flat_.size();
    std::size_t lowest = 0, highest = 0;
    for (std::size_t i = 1; i < n; ++i) {
        if (flat_[i] < flat_[lowest]) lowest = i;
        if (flat_[i] > flat_[highest]) highest = i;
    }
    const auto next = [n](std::size_t i) { return i + 1 < n ? i + 1 : 0; };
    const auto before = [n](std::size_t i) { return i > 0 ? i - 1 : n - 1; };
    bool left = false, right = false;
    // the side of a vertex as seen along an edge that runs to growing values of the first axis
    const auto look = [&](std::size_t vertex, std::size_t from, std::size_t to) {
        const PlanPosition way = minus(flat_[to], flat_[from]);
        const PlanPosition d = minus(flat_[vertex], flat_[from]);
        const double side = cross(way, d);
        if (std::abs(side) <= cross_allowance(way, d, flat_allowance_)) return;
        (side > 0 ? left : right) = true;
    };
    std::size_t ahead = lowest, back = lowest;
    while (ahead != highest || back != highest) {
        const std::size_t a = next(ahead), b = before(back);
        if (ahead != highest && (back == highest || flat_[a][0] < flat_[b][0])) {
            if (back != highest && a != highest) look(a, back, b);
            ahead = a;
        } else {
            // seen from `ahead`, what is on the left of back is on its right
            if (ahead != highest && b != highest) {
                std::swap(left, right);
                look(b, ahead, a);
                std::swap(left, right);
            }
            back = b;
        }
    }
    return left && right;
}

namespace {

using Position = std::array<double, 3>;

/// A corner of each cell.
std::vector<std::int32_t> cell_origins(const ComplexView& model, const FacesByCell& sides,
                                       const Execution& execution) {
    std::vector<std::int32_t> origin(model.cell_count());
    parallel_for_each(origin.size(), execution, [&](std::size_t c) {
        origin[c] = model.face(face_of(sides[c].front())).front();
    });
    return origin;
}

/// A unit in the last place of the largest coordinate on each axis.
Position coordinate_steps(const ComplexView& model) {
    Position largest{0, 0, 0};
    for (std::size_t i = 0; i < model.vertices.size(); i += 3) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            largest[axis] = std::max(largest[axis], std::abs(model.vertices[i + axis]));
    }
    return {last_place(largest[0]), last_place(largest[1]), last_place(largest[2])};
}

}  // namespace

FaceMeasures::FaceMeasures(const ComplexView& model, const FacesByCell& sides,
                           const Execution& execution)
    : measures_(model.face_count()) {
    const auto origin = cell_origins(model, sides, execution);
    const Position step = coordinate_steps(model);
    findings_ = in_chunks(
        model.face_count(), execution, [&](std::size_t begin, std::size_t end, Findings& findings) {
            FaceShape shape(model);
            for (std::size_t f = begin; f < end; ++f) {
                shape.load(f);
                const Position& area = shape.doubled_area();
                const Position& first = shape.corner(0);
                FaceMeasure& measure = measures_[f];
                for (std::size_t side = 0; side < 2; ++side) {
                    const std::int32_t cell = model.cell(f, side);
                    if (cell < 0) continue;
                    const Position o = model.vertex(origin[static_cast<std::size_t>(cell)]);
                    const double volume = dot(minus(first, o), area) / 6;
                    measure.volume[side] = side == 0 ? volume : -volume;
                }
                measure.rounding = (std::abs(area[0]) * step[0] + std::abs(area[1]) * step[1] +
                                    std::abs(area[2]) * step[2]) /
                                   2;
                const auto fault = shape.fault();
                if (!fault) continue;
                findings.fail([&] {
                    return Offender{.text = "face " + std::to_string(f) + " " + *fault,
                                    .cell = model.cell(f, 0),
                                    .face = static_cast<std::int64_t>(f),
                                    .place = first};
                });
            }
        });
    findings_.examined = static_cast<std::int64_t>(model.face_count());
}

}  // namespace realmodel::validation
