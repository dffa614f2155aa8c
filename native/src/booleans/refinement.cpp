// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/refinement.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "arrangement/triangle_arrangement.hpp"
#include "base/parallel.hpp"
#include "cutting/triangulate.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::booleans {

using arrangement::Region;
using arrangement::TriangleArrangement;
using arrangement::View;
using exact::SpacePointId;
using spatial::Box;
using spatial::BoxTree;

namespace {

constexpr std::size_t kChunk = 1 << 8;
/// In the first round points become the nearest doubles. In those that follow they and the corners
/// of what is divided become multiples of a step, which is some units in the last place and gets
/// longer each time: so what is nearer than that comes together.
constexpr int kMostRounds = 16, kFirstStep = 4, kLonger = 4;

using Triangle = std::array<std::int32_t, 3>;
using LoopCorner = cutting::LoopCorner;

/// Turns of exact points, which loop corners number as nodes.
class PointTurns : public cutting::CornerTurns {
public:
    PointTurns(const exact::SpacePoints& points, const View& view) : points_(points), view_(view) {}
    int operator()(const LoopCorner& a, const LoopCorner& b, const LoopCorner& c) const override {
        return view_.sign() * exact::orient2d(points_, view_.axis(), SpacePointId(a.node),
                                              SpacePointId(b.node), SpacePointId(c.node));
    }

private:
    const exact::SpacePoints& points_;
    const View& view_;
};

/// Vertices by their doubles; -0 is 0.
class VertexTable {
public:
    explicit VertexTable(std::vector<Position>& vertices) : vertices_(vertices) {}
    std::int32_t number(Position p) {
        for (double& x : p)
            x += 0.0;
        const auto [found, is_new] = number_.try_emplace(p, 0);
        if (is_new) {
            found->second = checked_number(vertices_.size(), "vertices");
            vertices_.push_back(p);
        }
        return found->second;
    }

private:
    std::vector<Position>& vertices_;
    std::map<Position, std::int32_t> number_;
};

/// The parts of one round: which of them the last round has moved or made.
struct Round {
    std::vector<Position> vertices;
    std::vector<Part> parts;
    std::vector<std::uint8_t> is_fresh;
};

class Refiner {
public:
    Refiner(Round&& round, double step, int threads, Progress* progress)
        : in_(std::move(round)), step_(step), threads_(threads), progress_(progress) {}

    /// One round; whether it has moved anything.
    bool run(Round& out);

private:
    Box box_of(const Part& part) const {
        Box box;
        for (const std::int32_t v : part.corners)
            box.include(in_.vertices[index(v)]);
        return box;
    }
    void find_active();
    void intersect();
    std::vector<Triangle> divided(const Region& region) const;
    Position rounded(Position p) const;
    /// Whether an active part is not divided.
    bool is_whole(std::size_t i) const {
        if (begins_[i + 1] != begins_[i] + 1) return false;
        const auto& loops = arrangement_.regions()[begins_[i]].loops;
        return loops.size() == 1 && loops[0].size() == 3;
    }
    void find_restless();

    Round in_;
    double step_;  ///< vertices that are moved become multiples of it; 0: the nearest doubles
    int threads_;
    Progress* progress_;
    exact::SpacePoints points_;
    TriangleArrangement arrangement_{points_};
    std::vector<Box> boxes_;
    std::vector<std::int32_t> active_;  ///< parts that are fresh or may meet one that is
    std::vector<std::uint8_t> is_active_;
    std::vector<std::size_t> begins_;        ///< of the regions of each active part, and their end
    std::vector<std::uint8_t> is_restless_;  ///< of vertices: they move to a multiple of the step
    std::vector<std::int32_t> vertex_of_point_;  ///< of exact points that are vertices
};

void Refiner::find_active() {
    const std::size_t count = in_.parts.size();
    boxes_.resize(count);
    is_active_.assign(count, 0);
    parallel_ranges(count, kChunk, threads_, progress_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            boxes_[i] = box_of(in_.parts[i]);
    });
    std::vector<Box> fresh;
    for (std::size_t i = 0; i < count; ++i) {
        if (in_.is_fresh[i] != 0) fresh.push_back(boxes_[i]);
    }
    if (fresh.size() == count) {
        std::fill(is_active_.begin(), is_active_.end(), 1);
    } else {
        const BoxTree tree(std::move(fresh));
        parallel_ranges(count, kChunk, threads_, progress_,
                        [&](std::size_t begin, std::size_t end) {
                            for (std::size_t i = begin; i < end; ++i)
                                is_active_[i] = tree.any(boxes_[i]) ? 1 : 0;
                        });
    }
    for (std::size_t i = 0; i < count; ++i) {
        if (is_active_[i] != 0) active_.push_back(static_cast<std::int32_t>(i));
    }
}

void Refiner::intersect() {
    for (const std::int32_t part : active_) {
        std::array<SpacePointId, 3> corners;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t v = in_.parts[index(part)].corners[k];
            corners[k] = points_.add(in_.vertices[index(v)]);
            vertex_of_point_.resize(points_.size(), -1);
            vertex_of_point_[index(corners[k])] = v;
        }
        arrangement_.add(corners);
    }
    std::vector<Box> boxes;
    for (const std::int32_t part : active_)
        boxes.push_back(boxes_[index(part)]);
    const BoxTree tree(boxes);
    const std::size_t count = active_.size();
    std::vector<std::vector<TriangleArrangement::Intersection>> found((count + kChunk - 1) /
                                                                      kChunk);
    const auto is_fresh = [&](std::size_t i) { return in_.is_fresh[index(active_[i])] != 0; };
    parallel_ranges(count, kChunk, threads_, progress_, [&](std::size_t begin, std::size_t end) {
        std::vector<std::int32_t> near;
        for (std::size_t i = begin; i < end; ++i) {
            if (!is_fresh(i)) continue;
            near.clear();
            tree.find(boxes[i], [&](std::int32_t other) {
                if (other > static_cast<std::int32_t>(i) || !is_fresh(index(other)))
                    near.push_back(other);
            });
            std::sort(near.begin(), near.end());
            for (const std::int32_t other : near) {
                if (const auto met = arrangement_.intersection(static_cast<std::int32_t>(i), other))
                    found[begin / kChunk].push_back(*met);
            }
        }
    });
    for (const auto& intersections : found) {
        if (progress_ != nullptr) progress_->check();
        for (const auto& met : intersections)
            arrangement_.insert(met);
    }
    arrangement_.divide(threads_, progress_);
}

/// A region in triangles of its nodes. Regions that coincide are given to it in the same way.
std::vector<Triangle> Refiner::divided(const Region& region) const {
    std::vector<cutting::Loop> loops;
    std::vector<Position> positions;
    const auto [axis, facing] = arrangement_.view_of(region.triangle);
    Position normal{0, 0, 0};
    normal[axis] = facing;
    const View view(normal);
    for (const auto& nodes : region.loops) {
        cutting::Loop& loop = loops.emplace_back();
        for (const SpacePointId p : nodes) {
            positions.push_back(points_.rounded(p));
            loop.push_back({p.number(), view(positions.back())});
        }
    }
    std::vector<std::array<LoopCorner, 3>> found;
    cutting::triangulate(loops, view.rounding(positions), found, PointTurns(points_, view));
    std::vector<Triangle> triangles;
    for (const auto& t : found)
        triangles.push_back({t[0].node, t[1].node, t[2].node});
    return triangles;
}

/// A loop from its least node on, in the direction of the lesser of that node's neighbors.
std::vector<SpacePointId> canonical(const std::vector<SpacePointId>& loop) {
    std::vector<SpacePointId> best;
    for (const bool backward : {false, true}) {
        std::vector<SpacePointId> turned(loop);
        if (backward) std::reverse(turned.begin(), turned.end());
        const SpacePointId least = *std::min_element(turned.begin(), turned.end());
        for (std::size_t i = 0; i < turned.size(); ++i) {
            if (turned[i] != least) continue;
            std::vector<SpacePointId> rotated(turned);
            std::rotate(rotated.begin(), rotated.begin() + static_cast<std::ptrdiff_t>(i),
                        rotated.end());
            if (best.empty() || rotated < best) best = std::move(rotated);
        }
    }
    return best;
}

Position Refiner::rounded(Position p) const {
    if (step_ > 0) {
        for (double& x : p)
            x = std::round(x / step_) * step_;
    }
    return p;
}

/// Where rounding is coarse, the corners of all parts that are divided move.
void Refiner::find_restless() {
    is_restless_.assign(in_.vertices.size(), 0);
    if (step_ == 0) return;
    for (std::size_t i = 0; i < active_.size(); ++i) {
        if (is_whole(i)) continue;
        for (const std::int32_t v : in_.parts[index(active_[i])].corners)
            is_restless_[index(v)] = 1;
    }
}

bool Refiner::run(Round& out) {
    find_active();
    intersect();
    const auto& regions = arrangement_.regions();
    begins_.assign(active_.size() + 1, regions.size());
    for (std::size_t r = regions.size(); r-- > 0;)
        begins_[index(regions[r].triangle)] = r;
    for (std::size_t i = active_.size(); i-- > 0;)
        begins_[i] = std::min(begins_[i], begins_[i + 1]);
    find_restless();
    out = Round{};
    VertexTable table(out.vertices);
    // vertices and points are numbered in the order in which they are met
    struct Place {
        std::int32_t number = -1;
        bool is_moved = false;
    };
    std::vector<Place> of_vertex(in_.vertices.size()), of_point(points_.size());
    vertex_of_point_.resize(points_.size(), -1);
    const auto place_vertex = [&](std::int32_t v) -> const Place& {
        Place& place = of_vertex[index(v)];
        if (place.number < 0) {
            const Position& old = in_.vertices[index(v)];
            const Position p = is_restless_[index(v)] != 0 ? rounded(old) : old;
            place = {table.number(p), p != old};
        }
        return place;
    };
    const auto place_point = [&](std::int32_t node) -> const Place& {
        const SpacePointId p(node);
        if (const std::int32_t v = vertex_of_point_[index(p)]; v >= 0) return place_vertex(v);
        Place& place = of_point[index(p)];
        if (place.number < 0) {
            const Position at = rounded(points_.rounded(p));
            place = {table.number(at), !points_.is_double(p) || at != points_.rounded(p)};
        }
        return place;
    };
    // the first of regions that coincide is divided, the others as that one
    std::map<std::vector<SpacePointId>, std::size_t> outlines;
    std::vector<std::int32_t> as(regions.size(), -1);
    std::vector<std::uint8_t> is_reversed(regions.size(), 0);
    for (std::size_t r = 0; r < regions.size(); ++r) {
        const auto& outline = regions[r].loops[0];
        if (outline.size() == 3 && regions[r].loops.size() == 1) continue;
        const auto [found, is_new] = outlines.try_emplace(canonical(outline), r);
        as[r] = static_cast<std::int32_t>(found->second);
        if (is_new) continue;
        const auto& first = regions[found->second];
        const auto view = arrangement_.view_of(regions[r].triangle);
        const auto& corners = arrangement_.corners(first.triangle);
        is_reversed[r] =
            exact::orient2d(points_, view.first, corners[0], corners[1], corners[2]) != view.second;
    }
    std::vector<std::vector<Triangle>> triangles(regions.size());
    parallel_ranges(regions.size(), kChunk, threads_, progress_,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t r = begin; r < end; ++r) {
                            if (as[r] == static_cast<std::int32_t>(r))
                                triangles[r] = divided(regions[r]);
                        }
                    });
    bool moved = false;
    const auto add = [&](const Part& of, const std::array<Place, 3>& places) {
        const Part part{
            {places[0].number, places[1].number, places[2].number}, of.origin, of.source};
        const bool fresh = places[0].is_moved || places[1].is_moved || places[2].is_moved;
        moved = moved || fresh;
        const auto& [a, b, c] = part.corners;
        if (a == b || b == c || c == a) return;  // its other two edges have become one
        out.parts.push_back(part);
        out.is_fresh.push_back(fresh ? 1 : 0);
    };
    const auto add_nodes = [&](const Part& of, const Triangle& nodes) {
        add(of, {place_point(nodes[0]), place_point(nodes[1]), place_point(nodes[2])});
    };
    std::size_t active = 0;
    for (std::size_t i = 0; i < in_.parts.size(); ++i) {
        const Part& part = in_.parts[i];
        if (is_active_[i] == 0) {
            add(part, {place_vertex(part.corners[0]), place_vertex(part.corners[1]),
                       place_vertex(part.corners[2])});
            continue;
        }
        for (std::size_t r = begins_[active]; r < begins_[active + 1]; ++r) {
            if (as[r] < 0) {
                const auto& own = regions[r].loops[0];
                add_nodes(part, {own[0].number(), own[1].number(), own[2].number()});
                continue;
            }
            for (Triangle t : triangles[index(as[r])]) {
                if (is_reversed[r] != 0) std::swap(t[1], t[2]);
                add_nodes(part, t);
            }
        }
        ++active;
    }
    return moved;
}

/// @throws InputError kinds not_finite, bad_index, no_triangles
void check(const TriangleMesh& mesh, int surface) {
    if (mesh.triangle_count() == 0)
        throw InputError("no_triangles", "the surface has no triangles", surface);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        if (!std::isfinite(mesh.vertices[i]))
            throw InputError("not_finite", "a coordinate is not finite", surface,
                             {static_cast<std::int64_t>(i / 3)});
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const std::int32_t v = mesh.triangles[i];
        if (v < 0 || static_cast<std::size_t>(v) >= mesh.vertex_count())
            throw InputError("bad_index", "a triangle has a vertex that is not there", surface,
                             {static_cast<std::int64_t>(i / 3)});
    }
}

}  // namespace

Parts refine(const std::array<TriangleMesh, 2>& surfaces, int threads, Progress* progress) {
    Round round;
    {
        VertexTable table(round.vertices);
        for (std::uint8_t source = 0; source < 2; ++source) {
            const TriangleMesh& mesh = surfaces[source];
            check(mesh, source);
            std::vector<std::int32_t> number(mesh.vertex_count(), -1);
            checked_number(round.parts.size() + mesh.triangle_count(), "triangles");
            for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
                Part part{{}, static_cast<std::int32_t>(t), source};
                for (std::size_t k = 0; k < 3; ++k) {
                    const std::size_t v = index(mesh.triangles[3 * t + k]);
                    if (number[v] < 0)
                        number[v] = table.number({mesh.vertices[3 * v], mesh.vertices[3 * v + 1],
                                                  mesh.vertices[3 * v + 2]});
                    part.corners[k] = number[v];
                }
                const auto& [a, b, c] = part.corners;
                if (a != b && b != c && c != a) round.parts.push_back(part);
            }
        }
    }
    round.is_fresh.assign(round.parts.size(), 1);
    double largest = 0;
    for (const Position& p : round.vertices) {
        for (const double x : p)
            largest = std::max(largest, std::abs(x));
    }
    const double unit = std::nextafter(largest, HUGE_VAL) - largest;
    for (int n = 0; n < kMostRounds; ++n) {
        const double share = 0.8 * n / (n + 1.0);
        if (progress != nullptr)
            progress->begin(share, 0.8 * (n + 1) / (n + 2.0), "intersecting triangles");
        const double step = n == 0 ? 0.0 : unit * kFirstStep * std::pow(kLonger, n - 1);
        Round next;
        const bool moved = Refiner(std::move(round), step, threads, progress).run(next);
        round = std::move(next);
        if (!moved) return {std::move(round.vertices), std::move(round.parts)};
    }
    throw InputError(
        "too_close",
        "the surfaces come so close to each other, again and again, that rounding does "
        "not keep them apart; move one of them a little");
}

}  // namespace realmodel::booleans
