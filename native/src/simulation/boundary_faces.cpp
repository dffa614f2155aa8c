// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/boundary_faces.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/cutting/cut.hpp"

namespace realmodel::simulation {

namespace {

using Point = std::array<double, 3>;
using Edge = std::array<std::int32_t, 2>;

constexpr double kSharp = 0.64;       ///< cosine of the angle between normals: 50 degrees
constexpr double kStraight = -0.7;    ///< cosine at a vertex of a line that goes on
constexpr double kNearest = 0.7;      ///< of the edge length, between points on sharp edges
constexpr double kPartOfALine = 0.9;  ///< of the edge length, between points of one line

Point minus(const Point& a, const Point& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double dot(const Point& a, const Point& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Point& a) {
    return std::sqrt(dot(a, a));
}

/// Points in a grid of cubes.
class SpacedPoints {
public:
    explicit SpacedPoints(double spacing) : spacing_(spacing) {}

    /// Whether it was far enough from all before.
    bool add(const Point& p) {
        const Cube at = cube(p);
        const auto [x, y, z] = at;
        for (std::int64_t i = x - 1; i <= x + 1; ++i) {
            for (std::int64_t j = y - 1; j <= y + 1; ++j) {
                for (std::int64_t k = z - 1; k <= z + 1; ++k) {
                    const auto found = cubes_.find({i, j, k});
                    if (found == cubes_.end()) continue;
                    for (const Point& other : found->second)
                        if (length(minus(p, other)) < spacing_) return false;
                }
            }
        }
        cubes_[at].push_back(p);
        return true;
    }

private:
    using Cube = std::tuple<std::int64_t, std::int64_t, std::int64_t>;
    Cube cube(const Point& p) const {
        const auto of = [&](double x) {
            return static_cast<std::int64_t>(std::floor(x / spacing_));
        };
        return {of(p[0]), of(p[1]), of(p[2])};
    }
    double spacing_;
    std::map<Cube, std::vector<Point>> cubes_;
};

/// The normal of a polygon, of length 1, or 0 where it has no area.
Point unit_normal(const ComplexView& model, std::span<const std::int32_t> loop) {
    Point sum{};
    const Point origin = model.vertex(loop[0]);
    for (std::size_t i = 2; i < loop.size(); ++i) {
        const Point part =
            cross(minus(model.vertex(loop[i - 1]), origin), minus(model.vertex(loop[i]), origin));
        for (int axis = 0; axis < 3; ++axis)
            sum[static_cast<std::size_t>(axis)] += part[static_cast<std::size_t>(axis)];
    }
    const double size = length(sum);
    if (size > 0)
        for (double& x : sum)
            x /= size;
    return sum;
}

struct KeptFace {
    std::size_t face;
    std::int32_t behind, in_front, surface;
    /// What faces of one patch have in common.
    std::tuple<std::int32_t, std::int32_t, std::int32_t> patch() const {
        return {std::min(behind, in_front), std::max(behind, in_front), surface};
    }
};

std::vector<Edge> sharp_edges(const ComplexView& model, const std::vector<KeptFace>& faces) {
    struct Use {
        Edge edge;
        std::int32_t face;
    };
    std::vector<Use> uses;
    std::vector<Point> normals;
    for (const KeptFace& kept : faces) {
        const auto loop = model.face(kept.face);
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const std::int32_t a = loop[i], b = loop[(i + 1) % loop.size()];
            uses.push_back({{std::min(a, b), std::max(a, b)},
                            static_cast<std::int32_t>(&kept - faces.data())});
        }
        // turned the same way all over a patch
        Point normal = unit_normal(model, loop);
        if (kept.behind > kept.in_front)
            for (double& x : normal)
                x = -x;
        normals.push_back(normal);
    }
    std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
        return std::tie(a.edge, a.face) < std::tie(b.edge, b.face);
    });
    std::vector<Edge> found;
    for (std::size_t i = 0, end = 0; i < uses.size(); i = end) {
        while (end < uses.size() && uses[end].edge == uses[i].edge)
            ++end;
        const std::size_t first = index(uses[i].face), last = index(uses[end - 1].face);
        if (end - i != 2 || faces[first].patch() != faces[last].patch() ||
            dot(normals[first], normals[last]) < kSharp)
            found.push_back(uses[i].edge);
    }
    return found;
}

}  // namespace

BoundaryFaces boundary_faces(const ComplexView& model, std::span<const std::int32_t> cell_region,
                             std::span<const std::uint8_t> kept, int threads, Progress* progress) {
    if (cell_region.size() != model.cell_count())
        throw InputError("bad_index", "there must be one region for each cell");
    const auto region = [&](std::int32_t cell) {
        if (cell < -1 || std::cmp_greater_equal(cell, cell_region.size()))
            throw InputError("bad_index", "a face has a cell that does not exist");
        return cell < 0 ? 0 : cell_region[index(cell)] + 1;
    };
    const auto triangles = cutting::triangulate_faces(model.vertices, model.face_offsets,
                                                      model.face_vertices, threads, progress);
    std::vector<KeptFace> faces;
    BoundaryFaces found;
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        poll(progress, f);
        const std::int32_t behind = region(model.cell(f, 0)), in_front = region(model.cell(f, 1));
        const std::int32_t surface = model.face_surface[f];
        const bool matters =
            surface >= 0 && std::cmp_less(surface, kept.size()) && kept[index(surface)] != 0;
        if (behind == in_front && !matters) continue;
        faces.push_back({f, behind, in_front, surface});
        for (auto t = triangles.offsets[f]; t < triangles.offsets[f + 1]; ++t) {
            const auto& corners = triangles.triangles[static_cast<std::size_t>(t)];
            const Point a = model.vertex(corners[0]);
            const Point normal =
                cross(minus(model.vertex(corners[1]), a), minus(model.vertex(corners[2]), a));
            if (dot(normal, normal) > 0)
                found.triangles.push_back({corners, behind, in_front, surface});
        }
    }
    found.sharp_edges = sharp_edges(model, faces);
    return found;
}

namespace {

/// Edges that meet, taken apart into lines.
class EdgeGraph {
public:
    EdgeGraph(const ComplexView& model, std::span<const Edge> edges) : model_(model) {
        for (const auto& [a, b] : edges) {
            neighbors_[a].push_back(b);
            neighbors_[b].push_back(a);
        }
    }

    /// Corners where no line goes straight on, then those where lines meet; each by number.
    std::array<std::vector<std::int32_t>, 2> corners() {
        std::array<std::vector<std::int32_t>, 2> found;
        for (const auto& [v, others] : neighbors_) {
            bool goes_on = false;
            for (std::size_t i = 0; i < others.size(); ++i)
                for (std::size_t j = 0; j < i; ++j)
                    goes_on = goes_on || is_straight(v, others[i], others[j]);
            if (others.size() == 2 && goes_on) continue;
            found[goes_on || others.size() < 2 ? 1 : 0].push_back(v);
            corners_[v] = true;
        }
        return found;
    }

    /// Lines from corner to corner, or closed, the longest first.
    std::vector<std::vector<std::int32_t>> lines() {
        std::vector<std::pair<double, std::vector<std::int32_t>>> found;
        for (const bool from_corners : {true, false}) {
            for (const auto& [v, others] : neighbors_) {
                if (corners_.contains(v) != from_corners) continue;
                for (const std::int32_t next : others)
                    if (take({v, next})) found.push_back(walk(v, next));
            }
        }
        std::stable_sort(found.begin(), found.end(),
                         [](const auto& a, const auto& b) { return a.first > b.first; });
        std::vector<std::vector<std::int32_t>> lines;
        for (auto& [size, line] : found)
            lines.push_back(std::move(line));
        return lines;
    }

private:
    bool is_straight(std::int32_t v, std::int32_t a, std::int32_t b) const {
        const Point u = minus(model_.vertex(a), model_.vertex(v));
        const Point w = minus(model_.vertex(b), model_.vertex(v));
        return dot(u, w) < kStraight * length(u) * length(w);
    }
    bool take(const Edge& edge) {
        return taken_.emplace(Edge{std::min(edge[0], edge[1]), std::max(edge[0], edge[1])}, true)
            .second;
    }
    std::pair<double, std::vector<std::int32_t>> walk(std::int32_t from, std::int32_t to) {
        std::vector<std::int32_t> line{from, to};
        while (!corners_.contains(line.back()) && line.back() != from) {
            const auto& others = neighbors_.at(line.back());
            const std::int32_t next = others[0] == line[line.size() - 2] ? others[1] : others[0];
            if (!take({line.back(), next})) break;
            line.push_back(next);
        }
        double size = 0;
        for (std::size_t i = 1; i < line.size(); ++i)
            size += length(minus(model_.vertex(line[i]), model_.vertex(line[i - 1])));
        return {size, std::move(line)};
    }

    const ComplexView& model_;
    std::map<std::int32_t, std::vector<std::int32_t>> neighbors_;
    std::map<std::int32_t, bool> corners_;
    std::map<Edge, bool> taken_;
};

/// Points that divide a line into equal parts, in order.
std::vector<Point> parts_of(const ComplexView& model, const std::vector<std::int32_t>& line,
                            double part) {
    double size = 0;
    for (std::size_t i = 1; i < line.size(); ++i)
        size += length(minus(model.vertex(line[i]), model.vertex(line[i - 1])));
    const double parts = std::max(1.0, std::round(size / part));
    std::vector<Point> found;
    double at = 0, number = line.front() == line.back() ? 0 : 1;
    for (std::size_t i = 1; i < line.size(); ++i) {
        const Point from = model.vertex(line[i - 1]);
        const Point way = minus(model.vertex(line[i]), from);
        const double step = length(way);
        for (; number < parts && at + step >= number * size / parts; ++number) {
            const double share = step > 0 ? std::max(0.0, number * size / parts - at) / step : 0;
            found.push_back(
                {from[0] + share * way[0], from[1] + share * way[1], from[2] + share * way[2]});
        }
        at += step;
    }
    return found;
}

}  // namespace

std::vector<Point> points_on_edges(const ComplexView& model, std::span<const Edge> sharp_edges,
                                   double edge_length) {
    SpacedPoints spaced(kNearest * edge_length);
    std::vector<Point> found;
    const auto add = [&](const Point& p) {
        if (spaced.add(p)) found.push_back(p);
    };
    EdgeGraph graph(model, sharp_edges);
    for (const auto& corners : graph.corners())
        for (const std::int32_t v : corners)
            add(model.vertex(v));
    for (const auto& line : graph.lines())
        for (const Point& p : parts_of(model, line, kPartOfALine * edge_length))
            add(p);
    return found;
}

std::vector<SurfaceSeed> surface_seeds(const ComplexView& model,
                                       std::span<const BoundaryTriangle> triangles,
                                       std::span<const Point> others, double spacing) {
    SpacedPoints spaced(spacing);
    for (const Point& p : others)
        spaced.add(p);
    std::vector<SurfaceSeed> found;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (const std::int32_t v : triangles[t].corners) {
            const Point p = model.vertex(v);
            if (spaced.add(p)) found.push_back({p, static_cast<std::int32_t>(t)});
        }
    }
    return found;
}

}  // namespace realmodel::simulation
