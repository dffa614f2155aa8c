// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/boundary_faces.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "base/algorithms.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/vectors.hpp"
#include "meshing/size_field.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/cutting/cut.hpp"
#include "simulation/column_heights.hpp"
#include "simulation/traces.hpp"
#include "spatial/hash_grid.hpp"
#include "spatial/plan_tiles.hpp"

namespace realmodel::simulation {

namespace {

using MeshEdge = std::array<std::int32_t, 2>;

constexpr double kSharp = 0.64;       ///< cosine of the angle between normals: 50 degrees
constexpr double kStraight = -0.7;    ///< cosine at a vertex of a line that goes on
constexpr double kNearest = 0.7;      ///< of the edge length, between points on sharp edges
constexpr double kShareOfLine = 0.9;  ///< of the edge length, between points of one line

double length_at(meshing::SizeField& lengths, const Vec3& p) {
    return lengths.at({p[0], p[1]});
}

/// Points far enough from one another: one grid for all spacings from one power of 2 to the next.
class SpacedPoints {
public:
    /// Whether it was far enough from all before.
    /// @param spacing  may change from point to point by less than half of their distance
    bool add(const Vec3& p, double spacing) {
        const int level = std::ilogb(spacing);
        // The spacing of a point that is nearer than this one's differs by less than factor 2.
        for (auto at = grids_.lower_bound(level - 1); at != grids_.end() && at->first <= level + 1;
             ++at) {
            const auto& grid = at->second;
            if (grid.any(p, spacing, [&](std::size_t i) {
                    return length(minus(p, grid.points()[i])) < spacing;
                }))
                return false;
        }
        // cells are as wide as the largest spacing of the next level
        grids_.try_emplace(level, std::ldexp(1.0, level + 2)).first->second.add(p);
        return true;
    }

private:
    std::map<int, spatial::HashGrid<3>> grids_;
};

struct InnerFace {
    std::size_t face;
    std::int32_t behind, in_front, surface;
    /// What faces of one patch have in common.
    std::tuple<std::int32_t, std::int32_t, std::int32_t> patch() const {
        return {std::min(behind, in_front), std::max(behind, in_front), surface};
    }
};

std::vector<MeshEdge> sharp_edges(const ComplexView& model, const std::vector<InnerFace>& faces) {
    struct FaceEdgeUse {
        MeshEdge edge;
        std::int32_t face;
    };
    std::vector<FaceEdgeUse> uses;
    std::vector<Vec3> normals;
    for (const InnerFace& face : faces) {
        const auto loop = model.face(face.face);
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const std::int32_t a = loop[i], b = loop[(i + 1) % loop.size()];
            uses.push_back({unordered(a, b), static_cast<std::int32_t>(&face - faces.data())});
        }
        // turned the same way all over a patch
        const auto at = [&](std::size_t i) { return model.vertex(loop[i]); };
        normals.push_back(
            times(face.behind > face.in_front ? -1 : 1, unit(polygon_normal(loop.size(), at))));
    }
    std::ranges::sort(uses, {},
                      [](const FaceEdgeUse& use) { return std::pair(use.edge, use.face); });
    std::vector<MeshEdge> sharp;
    for (const auto around : groups_of(uses, &FaceEdgeUse::edge)) {
        const std::size_t first = index(around.front().face), last = index(around.back().face);
        if (around.size() != 2 || faces[first].patch() != faces[last].patch() ||
            dot(normals[first], normals[last]) < kSharp)
            sharp.push_back(around[0].edge);
    }
    return sharp;
}

}  // namespace

BoundaryFaces boundary_faces(const ComplexView& model, std::span<const std::int32_t> cell_region,
                             std::span<const std::uint8_t> embedded, const Execution& execution) {
    if (cell_region.size() != model.cell_count())
        throw InputError("bad_index", "there must be one region for each cell");
    const auto region = [&](std::int32_t cell) {
        if (cell < -1 || std::cmp_greater_equal(cell, cell_region.size()))
            throw InputError("bad_index", "a face has a cell that does not exist");
        return cell < 0 ? 0 : cell_region[index(cell)] + 1;
    };
    const auto triangles = cutting::triangulate_faces(model.vertices, model.face_offsets,
                                                      model.face_vertices, execution);
    std::vector<InnerFace> faces;
    BoundaryFaces boundary;
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        poll(execution.progress, f);
        const std::int32_t behind = region(model.cell(f, 0)), in_front = region(model.cell(f, 1));
        const std::int32_t surface = model.face_surface[f];
        const bool matters = surface >= 0 && std::cmp_less(surface, embedded.size()) &&
                             embedded[index(surface)] != 0;
        if (behind == in_front && !matters) continue;
        faces.push_back({f, behind, in_front, surface});
        for (auto t = triangles.offsets[f]; t < triangles.offsets[f + 1]; ++t) {
            const auto& corners = triangles.triangles[static_cast<std::size_t>(t)];
            const Vec3 normal = triangle_normal(model.vertex(corners[0]), model.vertex(corners[1]),
                                                model.vertex(corners[2]));
            if (dot(normal, normal) > 0)
                boundary.triangles.push_back({corners, behind, in_front, surface});
        }
    }
    boundary.sharp_edges = sharp_edges(model, faces);
    return boundary;
}

namespace {

/// A piece of a line; its size is its length where edges are as long as anywhere, and more where
/// they are shorter.
struct LinePiece {
    Vec3 from, way;
    double size;
};

std::vector<LinePiece> pieces_of(const ComplexView& model, const std::vector<std::int32_t>& line,
                                 meshing::SizeField& lengths) {
    std::vector<LinePiece> pieces;
    for (std::size_t i = 1; i < line.size(); ++i) {
        const Vec3 from = model.vertex(line[i - 1]);
        const Vec3 way = minus(model.vertex(line[i]), from);
        const double step = length(way);
        for (double at = 0; at < step;) {
            const Vec3 here = moved(from, at / step, way);
            const double edge = length_at(lengths, here);
            const double next = lengths.is_uniform() ? step : std::min(step, at + edge / 2);
            pieces.push_back({here, moved(Vec3{}, (next - at) / step, way),
                              (next - at) * (lengths.largest() / edge)});
            at = next;
        }
    }
    return pieces;
}

/// Points that divide a line into pieces of about equal size, in order.
std::vector<Vec3> divided_line(const ComplexView& model, const std::vector<std::int32_t>& line,
                               meshing::SizeField& lengths) {
    const std::vector<LinePiece> pieces = pieces_of(model, line, lengths);
    double size = 0;
    for (const LinePiece& piece : pieces)
        size += piece.size;
    const double divisions = std::max(1.0, std::round(size / (kShareOfLine * lengths.largest())));
    std::vector<Vec3> points;
    double at = 0, number = line.front() == line.back() ? 0 : 1;
    for (const LinePiece& piece : pieces) {
        for (; number < divisions && at + piece.size >= number * size / divisions; ++number)
            points.push_back(moved(
                piece.from, std::max(0.0, number * size / divisions - at) / piece.size, piece.way));
        at += piece.size;
    }
    return points;
}

}  // namespace

std::vector<Vec3> points_on_edges(const ComplexView& model, std::span<const MeshEdge> sharp_edges,
                                  meshing::SizeField& lengths) {
    SpacedPoints spaced;
    std::vector<Vec3> points;
    const auto add = [&](const Vec3& p) {
        if (spaced.add(p, kNearest * length_at(lengths, p))) points.push_back(p);
    };
    std::vector<std::int32_t> vertices;
    for (const MeshEdge& edge : sharp_edges)
        vertices.insert(vertices.end(), edge.begin(), edge.end());
    sort_unique(vertices);
    const auto number = [&](std::int32_t v) {
        return static_cast<std::int32_t>(std::ranges::lower_bound(vertices, v) - vertices.begin());
    };
    const EdgeGraph graph(vertices.size(), transformed(sharp_edges, [&](const MeshEdge& edge) {
                              return MeshEdge{number(edge[0]), number(edge[1])};
                          }));
    // corners where no line goes straight on, then those where lines meet
    std::array<std::vector<std::int32_t>, 2> corners;
    std::vector<std::uint8_t> is_corner;
    for (std::size_t p = 0; p < vertices.size(); ++p) {
        const auto edges = graph.at[p];
        const auto way = [&](std::size_t i) {
            const auto end = index(graph.other(edges[i], static_cast<std::int32_t>(p)));
            return minus(model.vertex(vertices[end]), model.vertex(vertices[p]));
        };
        bool goes_on = false;
        for (std::size_t i = 0; i < edges.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                const Vec3 u = way(i), w = way(j);
                goes_on = goes_on || dot(u, w) < kStraight * length(u) * length(w);
            }
        }
        is_corner.push_back(edges.size() != 2 || !goes_on);
        if (is_corner[p] != 0) corners[goes_on || edges.size() < 2 ? 1 : 0].push_back(vertices[p]);
    }
    for (const auto& some : corners)
        for (const std::int32_t v : some)
            add(model.vertex(v));
    std::vector<std::pair<double, std::vector<std::int32_t>>> lines;
    for (const auto& chain : graph.chains(is_corner)) {
        auto& [size, line] = lines.emplace_back();
        line = transformed(chain, [&](std::int32_t p) { return vertices[index(p)]; });
        for (std::size_t i = 1; i < line.size(); ++i)
            size += length(minus(model.vertex(line[i]), model.vertex(line[i - 1])));
    }
    std::ranges::stable_sort(lines, std::greater<>(), [](const auto& line) { return line.first; });
    for (const auto& [size, line] : lines)
        for (const Vec3& p : divided_line(model, line, lengths))
            add(p);
    return points;
}

std::vector<SurfaceSeed> surface_seeds(const ComplexView& model,
                                       std::span<const BoundaryTriangle> triangles,
                                       std::span<const Vec3> others, meshing::SizeField& lengths,
                                       double share) {
    SpacedPoints spaced;
    const auto add = [&](const Vec3& p) { return spaced.add(p, share * length_at(lengths, p)); };
    for (const Vec3& p : others)
        add(p);
    std::vector<SurfaceSeed> seeds;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (const std::int32_t v : triangles[t].corners) {
            const Vec3 p = model.vertex(v);
            if (add(p)) seeds.push_back({p, static_cast<std::int32_t>(t)});
        }
    }
    return seeds;
}

namespace {

constexpr double kMostLeaves = 1e7;  ///< of the field, and pieces that its lines are divided into
constexpr double kAlike = 3;  ///< edge lengths: in a square as wide edges are about alike in length

[[noreturn]] void refuse_lengths() {
    throw InputError("too_large",
                     "the local lengths are so short that the mesh would be too large; "
                     "use longer ones");
}

}  // namespace

meshing::SizeField edge_lengths(const ComplexView& model, const BoundaryFaces& faces,
                                double edge_length, double tolerance,
                                std::span<const meshing::LocalLength> sizes) {
    if (sizes.empty()) return meshing::SizeField(edge_length);
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        if (sizes[i].length < tolerance) {
            throw InputError("size",
                             "size " + std::to_string(i) +
                                 ": its length must not be below the minimum thickness",
                             -1, {static_cast<std::int64_t>(i)});
        }
    }
    meshing::RegionGraph graph;
    for (const auto& [a, b] : faces.sharp_edges) {
        const auto first = static_cast<std::int32_t>(graph.points.size());
        graph.points.push_back(plan_of(model, a));
        graph.points.push_back(plan_of(model, b));
        graph.border.push_back({first, first + 1});
    }
    meshing::MeshRequest request;
    request.sizes.assign(sizes.begin(), sizes.end());
    std::vector<meshing::SizeSource> sources =
        meshing::requested_sources(graph, request, edge_length, 1);
    spatial::PlanBox box = spatial::kNoBox;
    for (const BoundaryTriangle& t : faces.triangles) {
        const auto [a, b, c] = t.corners;
        box = box.united(spatial::box_around(
            std::array{plan_of(model, a), plan_of(model, b), plan_of(model, c)}));
    }
    const meshing::PlanPoint low{box.low_x, box.low_y}, high{box.high_x, box.high_y};
    if (meshing::pieces_along(sources, low, high) > kMostLeaves) refuse_lengths();
    return {edge_length, meshing::kGradation, std::move(sources), low, high, kMostLeaves};
}

double cubes_in(meshing::SizeField& lengths, const std::array<double, 3>& low,
                const std::array<double, 3>& high, double most, Progress* progress) {
    const double height = high[2] - low[2];
    if (lengths.is_uniform()) {
        const double edge = lengths.largest();
        return (high[0] - low[0]) * (high[1] - low[1]) * height / (edge * edge * edge);
    }
    struct Square {
        double x, y, width;
    };
    double cubes = 0;
    std::vector<Square> open{{low[0], low[1], std::max(high[0] - low[0], high[1] - low[1])}};
    for (std::size_t count = 0; !open.empty(); ++count) {
        poll(progress, count);
        const auto [x, y, width] = open.back();
        open.pop_back();
        if (x >= high[0] || y >= high[1]) continue;
        const double half = width / 2, edge = lengths.at({x + half, y + half});
        if (width > kAlike * edge) {
            for (const double right : {0.0, half})
                for (const double upper : {0.0, half})
                    open.push_back({x + right, y + upper, half});
            continue;
        }
        const double area = (std::min(x + width, high[0]) - x) * (std::min(y + width, high[1]) - y);
        cubes += area / (edge * edge) * std::max(1.0, height / edge);
        if (cubes > most) refuse_lengths();
    }
    return cubes;
}

}  // namespace realmodel::simulation
