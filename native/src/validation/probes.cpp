// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/probes.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/parallel_counts.hpp"
#include "base/vectors.hpp"
#include "exact/double_double_interval.hpp"
#include "exact/orientation.hpp"
#include "realmodel/base/elementary.hpp"
#include "spatial/plan_tiles.hpp"
#include "validation/findings.hpp"

namespace realmodel::validation {

using spatial::PlanBox;

namespace {

/// Random numbers by index, so that none depends on what was drawn before (splitmix64, Steele et
/// al. 2014).
class Random {
public:
    Random(std::uint64_t seed, std::uint64_t stream) : state_(mix(seed) ^ mix(~stream)) {}
    std::uint64_t next() { return mix(state_ += 0x9E3779B97F4A7C15u); }
    /// 0 <= value < 1
    double share() { return static_cast<double>(next() >> 11) * 0x1p-53; }
    std::size_t below(std::size_t count) {
        return std::min(static_cast<std::size_t>(share() * static_cast<double>(count)), count - 1);
    }

private:
    static std::uint64_t mix(std::uint64_t z) {
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
        return z ^ (z >> 31);
    }
    std::uint64_t state_;
};

const double* corner(std::span<const double> vertices, std::size_t columns, std::int32_t v) {
    return &vertices[static_cast<std::size_t>(v) * columns];
}

/// Around what a rock mass covers at most.
PlanBox rock_box(const strata::StackInput& rock) {
    PlanBox box = spatial::kNoBox, region = spatial::kNoBox;
    const auto include = [](const TriangleView& mesh, std::size_t columns, PlanBox& in) {
        for (const std::int32_t v : mesh.triangles) {
            const double* p = corner(mesh.vertices, columns, v);
            in = in.united({p[0], p[1], p[0], p[1]});
        }
    };
    for (const TriangleView& s : rock.surfaces)
        include(s, 3, box);
    if (!rock.region) return box;
    include(*rock.region, 2, region);
    return {std::max(box.low_x, region.low_x), std::max(box.low_y, region.low_y),
            std::min(box.high_x, region.high_x), std::min(box.high_y, region.high_y)};
}

PlanPosition place_in_triangle(const std::array<PlanPosition, 3>& p, double s, double t) {
    if (s + t > 1) {
        s = 1 - s;
        t = 1 - t;
    }
    PlanPosition place;
    for (std::size_t axis = 0; axis < 2; ++axis)
        place[axis] = p[0][axis] + s * (p[1][axis] - p[0][axis]) + t * (p[2][axis] - p[0][axis]);
    return place;
}

PlanPosition plan(const ComplexView& model, std::int32_t vertex) {
    const auto p = model.vertex(vertex);
    return {p[0], p[1]};
}

/// In the middle of the largest triangle of a face's fan: away from its edges as far as may be.
PlanPosition place_on_face(const ComplexView& model, std::size_t face) {
    const auto loop = model.face(face);
    std::array<PlanPosition, 3> largest{};
    double largest_area = -1;
    for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
        const std::array<PlanPosition, 3> p{plan(model, loop[0]), plan(model, loop[i]),
                                            plan(model, loop[i + 1])};
        const double area = std::abs(twice_area(p[0], p[1], p[2]));
        if (area > largest_area) {
            largest_area = area;
            largest = p;
        }
    }
    return place_in_triangle(largest, 1.0 / 3, 1.0 / 3);
}

/// The longest stretch of a wall between two neighboring places, and the middle of the widest
/// vertical chord there. Nothing where it is too short, or the wall has no area there.
std::optional<WallSample> point_in_wall(const ComplexView& model, std::size_t face,
                                        const PlanRounding& rounding) {
    std::vector<std::array<double, 3>> corners;
    for (const std::int32_t v : model.face(face))
        corners.push_back(model.vertex(v));
    std::array<double, 2> extent;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const auto [low, high] =
            std::minmax_element(corners.begin(), corners.end(),
                                [axis](const auto& a, const auto& b) { return a[axis] < b[axis]; });
        extent[axis] = (*high)[axis] - (*low)[axis];
    }
    const std::size_t axis = extent[0] >= extent[1] ? 0 : 1;
    auto along = corners;
    std::sort(along.begin(), along.end(),
              [axis](const auto& a, const auto& b) { return a[axis] < b[axis]; });
    std::size_t widest = 0;
    double gap = 0;
    for (std::size_t i = 0; i + 1 < along.size(); ++i) {
        if (along[i + 1][axis] - along[i][axis] > gap) {
            gap = along[i + 1][axis] - along[i][axis];
            widest = i;
        }
    }
    if (gap < 8 * rounding.step) return std::nullopt;
    WallSample sample;
    sample.face = static_cast<std::int32_t>(face);
    sample.from = {along[widest][0], along[widest][1]};
    sample.to = {along[widest + 1][0], along[widest + 1][1]};
    for (std::size_t i = 0; i < 2; ++i)
        sample.middle[i] = sample.from[i] + (sample.to[i] - sample.from[i]) / 2;
    const double at = sample.middle[axis];
    std::vector<double> heights;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const auto& p = corners[i];
        const auto& q = corners[i + 1 < corners.size() ? i + 1 : 0];
        if ((p[axis] > at) != (q[axis] > at))
            heights.push_back(p[2] + (at - p[axis]) / (q[axis] - p[axis]) * (q[2] - p[2]));
    }
    std::sort(heights.begin(), heights.end());
    for (std::size_t i = 0; i + 1 < heights.size(); i += 2) {
        const double half = (heights[i + 1] - heights[i]) / 2;
        if (half <= sample.half_width) continue;
        sample.half_width = half;
        sample.height = heights[i] + half;
    }
    if (sample.half_width <= 0) return std::nullopt;
    for (const auto& corner : corners)
        sample.highest = std::max(sample.highest, std::abs(corner[2]));
    return sample;
}

/// The way out of a wall's first cell, a unit vector.
PlanPosition outward(const ComplexView& model, const WallSample& wall) {
    const auto loop = model.face(static_cast<std::size_t>(wall.face));
    const Vec3 normal =
        polygon_normal(loop.size(), [&](std::size_t i) { return model.vertex(loop[i]); });
    const PlanPosition way = minus(wall.to, wall.from);
    const double length = distance(wall.from, wall.to),
                 sign = cross(PlanPosition{normal[0], normal[1]}, way) >= 0 ? 1 : -1;
    return {sign * way[1] / length, -sign * way[0] / length};
}

class ProbeChoice {
public:
    ProbeChoice(const ComplexView& model, const ModelInput& input, std::uint64_t seed,
                const PlanRounding& rounding)
        : model_(model), input_(input), seed_(seed), rounding_(rounding) {}

    void evenly(std::size_t count) {
        for (std::size_t r = 0; r < input_.rocks.size(); ++r) {
            const PlanBox box = rock_box(input_.rocks[r]);
            if (!(box.low_x <= box.high_x)) continue;
            for (std::size_t i = 0; i < std::max<std::size_t>(count / input_.rocks.size(), 1);
                 ++i) {
                Random random = draw(1 + r, i);
                const double x = box.low_x + random.share() * box.width();
                add({x, box.low_y + random.share() * box.height()});
            }
        }
    }

    void in_triangles(std::size_t count) {
        std::vector<std::pair<std::size_t, const TriangleView*>> surfaces;
        std::size_t total = 0;
        for (const strata::StackInput& rock : input_.rocks) {
            for (const TriangleView& s : rock.surfaces) {
                total += s.triangles.size() / 3;
                surfaces.emplace_back(total, &s);
            }
        }
        for (std::size_t i = 0; i < count && total > 0; ++i) {
            Random random = draw(1001, i);
            const std::size_t t = random.below(total);
            const auto at = std::upper_bound(
                surfaces.begin(), surfaces.end(), t,
                [](std::size_t value, const auto& entry) { return value < entry.first; });
            const TriangleView& s = *at->second;
            const std::size_t triangle = t - (at->first - s.triangles.size() / 3);
            std::array<PlanPosition, 3> p;
            for (std::size_t c = 0; c < 3; ++c) {
                const double* row = corner(s.vertices, 3, s.triangles[3 * triangle + c]);
                p[c] = {row[0], row[1]};
            }
            const double one = random.share();
            add(place_in_triangle(p, one, random.share()));
        }
    }

    void on_faces(std::size_t count, const std::vector<std::int32_t>& faces) {
        for (std::size_t i = 0; i < count && !faces.empty(); ++i) {
            const std::int32_t face = faces[draw(1002, i).below(faces.size())];
            add(place_on_face(model_, static_cast<std::size_t>(face)));
        }
    }

    void beside_walls(std::size_t count, const std::vector<std::int32_t>& walls) {
        for (std::size_t i = 0; i < count && !walls.empty(); ++i) {
            const std::int32_t face = walls[draw(1003, i).below(walls.size())];
            const auto wall = point_in_wall(model_, static_cast<std::size_t>(face), rounding_);
            if (!wall) {
                ++chosen.narrow_walls;
                continue;
            }
            const PlanPosition out = outward(model_, *wall);
            for (const std::int32_t side : {0, 1}) {
                const double way = side == 0 ? -rounding_.step : rounding_.step;
                chosen.probes.push_back(
                    {{wall->middle[0] + way * out[0], wall->middle[1] + way * out[1]},
                     static_cast<std::int32_t>(chosen.walls.size()),
                     side});
            }
            chosen.walls.push_back(*wall);
        }
    }

    Probes chosen;

private:
    Random draw(std::uint64_t kind, std::size_t i) const {
        return Random(seed_, kind << 40 | static_cast<std::uint64_t>(i));
    }
    void add(const PlanPosition& place) { chosen.probes.push_back({place}); }

    const ComplexView& model_;
    const ModelInput& input_;
    std::uint64_t seed_;
    const PlanRounding& rounding_;
};

}  // namespace

double largest_plan_coordinate(const ComplexView& model, const ModelInput& input) {
    double largest = 0;
    const auto look = [&](std::span<const double> vertices, std::size_t columns) {
        for (std::size_t i = 0; i + 1 < vertices.size(); i += columns)
            largest = std::max({largest, std::abs(vertices[i]), std::abs(vertices[i + 1])});
    };
    look(model.vertices, 3);
    for (const strata::StackInput& rock : input.rocks) {
        for (const TriangleView& s : rock.surfaces)
            look(s.vertices, 3);
        if (rock.region) look(rock.region->vertices, 2);
    }
    return largest;
}

Probes choose_probes(const ComplexView& model, const ModelInput& input, std::int64_t places,
                     std::uint64_t seed, const PlanRounding& rounding, Progress* progress) {
    std::vector<std::int32_t> walls, others;
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        poll(progress, f);
        (model.face_surface[f] == kWall ? walls : others).push_back(static_cast<std::int32_t>(f));
    }
    const auto count = static_cast<std::size_t>(std::max<std::int64_t>(places, 0));
    ProbeChoice choice(model, input, seed, rounding);
    choice.evenly(count / 4);
    choice.in_triangles(count / 4);
    choice.on_faces(count / 4, others);
    choice.beside_walls(count / 8, walls);  // two places each
    return std::move(choice.chosen);
}

namespace {

/// How often a closed loop winds round a place, counter-clockwise; exact. Loops that share an edge
/// agree about it, so that a vertical line meets the faces of closed cells in pairs.
int winding(std::span<const PlanPosition> loop, const PlanPosition& place) {
    int turns = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const PlanPosition& p = loop[i];
        const PlanPosition& q = loop[i + 1 < loop.size() ? i + 1 : 0];
        if (p[1] <= place[1]) {
            if (q[1] > place[1] && exact::orient2d(p, q, place) > 0) ++turns;
        } else if (q[1] <= place[1] && exact::orient2d(p, q, place) < 0) {
            --turns;
        }
    }
    return turns;
}

/// Whether a segment passes within `reach` of a place (a little more may count).
bool passes(const PlanPosition& from, const PlanPosition& to, const PlanPosition& place,
            double reach) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
        if (place[axis] < std::min(from[axis], to[axis]) - reach) return false;
        if (place[axis] > std::max(from[axis], to[axis]) + reach) return false;
    }
    return std::abs(twice_area(from, to, place)) <= 1.001 * reach * distance(from, to) + 1e-290;
}

bool contains(const std::array<PlanPosition, 3>& p, const PlanPosition& place) {
    const int turn = exact::orient2d(p[0], p[1], p[2]);
    if (turn == 0) return false;
    for (std::size_t i = 0; i < 3; ++i) {
        if (exact::orient2d(p[i], p[(i + 1) % 3], place) == -turn) return false;
    }
    return true;
}

}  // namespace

InputColumns::InputColumns(const ModelInput& input, const Probes& probes,
                           const PlanRounding& rounding, const Execution& execution)
    : near_edge_(probes.probes.size(), 0) {
    std::vector<PlanPosition> places;
    for (const Probe& probe : probes.probes)
        places.push_back(probe.place);
    const spatial::PointBins bins(places);
    const auto is_lower = [](std::int32_t t, std::int32_t known) { return known < 0 || t < known; };
    for (const strata::StackInput& rock : input.rocks)
        surfaces_ += rock.surfaces.size();
    triangle_.assign(places.size() * surfaces_, -1);

    /// Calls visit(probe, triangle) for all triangles of a mesh that contain a probe.
    const auto look = [&](std::span<const double> vertices, std::size_t columns,
                          std::span<const std::int32_t> triangles, const auto& visit) {
        parallel_for_each(triangles.size() / 3, execution, [&](std::size_t t) {
            std::array<PlanPosition, 3> p;
            for (std::size_t i = 0; i < 3; ++i) {
                const double* row = &vertices[index(triangles[3 * t + i]) * columns];
                p[i] = {row[0], row[1]};
            }
            const spatial::PlanBox box = spatial::box_around(p).widened(rounding.near);
            bins.within(box, [&](std::size_t i, const PlanPosition&) {
                for (std::size_t e = 0; e < 3; ++e) {
                    if (passes(p[e], p[(e + 1) % 3], places[i], rounding.near))
                        atomic_set(near_edge_[i]);
                }
                if (contains(p, places[i])) visit(i, static_cast<std::int32_t>(t));
            });
        });
    };
    std::size_t first = 0;
    for (const strata::StackInput& rock : input.rocks) {
        for (std::size_t k = 0; k < rock.surfaces.size(); ++k) {
            const TriangleView& s = rock.surfaces[k];
            look(s.vertices, 3, s.triangles, [&](std::size_t probe, std::int32_t t) {
                atomic_min_by(triangle_[probe * surfaces_ + first + k], t, is_lower);
            });
        }
        if (rock.region) {
            std::vector<std::uint8_t> inside(places.size(), 0);
            look(rock.region->vertices, 2, rock.region->triangles,
                 [&](std::size_t probe, std::int32_t) { atomic_set(inside[probe]); });
            for (std::size_t i = 0; i < places.size(); ++i) {
                if (inside[i] != 0) continue;
                std::fill_n(triangle_.begin() + static_cast<std::ptrdiff_t>(i * surfaces_ + first),
                            rock.surfaces.size(), -1);
            }
        }
        first += rock.surfaces.size();
    }
}

using exact::DoubleDoubleInterval;

namespace {

/// A face's corners, and its loop seen from above.
class FaceInPlan {
public:
    explicit FaceInPlan(const ComplexView& model) : model_(model) {}

    void load(std::size_t face) {
        const auto loop = model_.face(face);
        corners.resize(loop.size());
        plan.resize(loop.size());
        for (std::size_t i = 0; i < loop.size(); ++i) {
            corners[i] = model_.vertex(loop[i]);
            plan[i] = {corners[i][0], corners[i][1]};
        }
    }

    /// The height of the face at a place within it: of the triangle of its fan there.
    double height(const PlanPosition& place) const {
        for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
            const int a = exact::orient2d(plan[0], plan[i], place);
            const int b = exact::orient2d(plan[i], plan[i + 1], place);
            const int c = exact::orient2d(plan[i + 1], plan[0], place);
            if (exact::orient2d(plan[0], plan[i], plan[i + 1]) == 0) continue;
            if ((a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0))
                return triangle_height(i, place);
        }
        return corners[0][2];
    }

    std::vector<std::array<double, 3>> corners;
    std::vector<PlanPosition> plan;

private:
    // to twice the precision of doubles, for needles
    double triangle_height(std::size_t i, const PlanPosition& place) const {
        const auto &o = corners[0], &p = corners[i], &q = corners[i + 1];
        const auto d = [&](double a, double b) { return DoubleDoubleInterval::difference(a, b); };
        const DoubleDoubleInterval ux = d(p[0], o[0]), uy = d(p[1], o[1]), vx = d(q[0], o[0]),
                                   vy = d(q[1], o[1]);
        const DoubleDoubleInterval wx = d(place[0], o[0]), wy = d(place[1], o[1]);
        const DoubleDoubleInterval area = ux * vy - uy * vx;
        const DoubleDoubleInterval s = (wx * vy - wy * vx) / area, t = (ux * wy - uy * wx) / area;
        return (DoubleDoubleInterval(o[2]) + s * d(p[2], o[2]) + t * d(q[2], o[2])).high;
    }

    const ComplexView& model_;
};

bool same_stretch(const WallSample& wall, const PlanPosition& p, const PlanPosition& q) {
    return (wall.from == p && wall.to == q) || (wall.from == q && wall.to == p);
}

}  // namespace

ModelColumns::ModelColumns(const ComplexView& model, const Probes& probes,
                           const PlanRounding& rounding, const Execution& execution)
    : near_edge_(probes.probes.size(), 0), coincident_(probes.walls.size(), 0) {
    const std::size_t count = probes.probes.size();
    std::vector<PlanPosition> places;
    for (const Probe& probe : probes.probes)
        places.push_back(probe.place);
    for (const WallSample& wall : probes.walls)
        places.push_back(wall.middle);
    const spatial::PointBins bins(places);
    const double beside = rounding.step + rounding.near;
    std::vector<std::vector<Crossing>> crossings((model.face_count() + kItemsOfChunk - 1) /
                                                 kItemsOfChunk);
    parallel_ranges(
        model.face_count(), kItemsOfChunk, execution, [&](std::size_t begin, std::size_t end) {
            auto& chunk = crossings[begin / kItemsOfChunk];
            FaceInPlan face(model);
            const auto edge_passes = [&](std::size_t i, double reach, const auto& leave_out) {
                for (std::size_t k = 0; k < face.plan.size(); ++k) {
                    const PlanPosition& p = face.plan[k];
                    const PlanPosition& q = face.plan[k + 1 < face.plan.size() ? k + 1 : 0];
                    if (p != q && !leave_out(p, q) && passes(p, q, places[i], reach)) return true;
                }
                return false;
            };
            for (std::size_t f = begin; f < end; ++f) {
                face.load(f);
                const spatial::PlanBox box = spatial::box_around(face.plan).widened(beside);
                bins.within(box, [&](std::size_t i, const PlanPosition&) {
                    if (i >= count) {
                        const WallSample& wall = probes.walls[i - count];
                        const auto passes_edge = [&](const auto& p, const auto& q) {
                            return same_stretch(wall, p, q);
                        };
                        if (edge_passes(i, beside, passes_edge)) atomic_set(coincident_[i - count]);
                        return;
                    }
                    const auto none = [](const auto&, const auto&) { return false; };
                    if (edge_passes(i, rounding.near, none)) atomic_set(near_edge_[i]);
                    const int turns = winding(face.plan, places[i]);
                    if (turns == 0) return;
                    const bool up = turns > 0;
                    chunk.push_back({static_cast<std::int32_t>(i), static_cast<std::int32_t>(f),
                                     model.cell(f, up ? 0 : 1), model.cell(f, up ? 1 : 0),
                                     face.height(places[i])});
                });
            }
        });
    crossings_ = bucketize<Crossing>(count, [&](const auto& put) {
        for (const auto& hits_of_chunk : crossings) {
            for (const Crossing& c : hits_of_chunk)
                put(index(c.probe), c);
        }
    });
}

}  // namespace realmodel::validation
