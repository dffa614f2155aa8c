// SPDX-License-Identifier: GPL-3.0-or-later
#include "debug/dump.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <limits>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/vectors.hpp"

// Named when a program is linked (native/cmake/Fuzzing.cmake), so that it contains this file
// although it never calls it.
extern "C" {
extern const int realmodel_dump;
const int realmodel_dump = 1;
}

namespace realmodel {
namespace {

/// A Wavefront OBJ file that is written. Coordinates have 17 digits.
/// @throws std::runtime_error where the file cannot be written
class ObjFile {
public:
    using Position = std::array<double, 3>;

    explicit ObjFile(const char* path) : file_(path) {
        if (!file_) throw std::runtime_error(std::string("cannot write ") + path);
        file_.precision(std::numeric_limits<double>::max_digits10);
    }

    void begin_group(const std::string& name) { file_ << "g " << name << '\n'; }
    void add_vertex(const Position& at) {
        file_ << "v " << at[0] << ' ' << at[1] << ' ' << at[2] << '\n';
        ++vertices_;
    }
    /// A face on vertices that were added before, counted from 0.
    void add_face(std::span<const std::int32_t> vertices) {
        file_ << 'f';
        for (const std::int32_t vertex : vertices)
            file_ << ' ' << vertex + 1;
        file_ << '\n';
    }
    /// A face, or a line of two corners, with vertices of its own.
    void add(char kind, std::span<const Position> corners) {
        const std::size_t first = vertices_ + 1;
        for (const Position& corner : corners)
            add_vertex(corner);
        file_ << kind;
        for (std::size_t i = 0; i < corners.size(); ++i)
            file_ << ' ' << first + i;
        file_ << '\n';
    }

private:
    std::ofstream file_;
    std::size_t vertices_ = 0;
};

}  // namespace
}  // namespace realmodel

namespace realmodel::strata {
namespace {

using exact::PlanArrangement;
using Position = std::array<double, 3>;

std::string group_name(std::int32_t surface) {
    if (surface >= 0) return "surface_" + std::to_string(surface);
    return surface == kWall ? "walls" : surface == kBase ? "base" : "cut";
}

/// Polygons of a pool, each in its plane, in groups by surface.
template <class Pool>
void dump_polygons(const PlanArrangement& geometry, const Pool& polygons,
                   const Array<PlaneId>& plane, const Array<std::int32_t>& surface,
                   const char* path) {
    std::map<std::int32_t, std::vector<std::size_t>> of_surface;
    for (std::size_t p = 0; p < plane.size(); ++p) {
        if (plane[p].has_value()) of_surface[surface[p]].push_back(p);
    }
    LocalArrangement local(geometry);
    ObjFile file(path);
    std::vector<Position> corners;
    for (const auto& [number, members] : of_surface) {
        file.begin_group(number < 0 ? group_name(kBase) : group_name(number));
        for (const std::size_t p : members) {
            corners.clear();
            const auto& polygon = polygons[p];
            for (const Corner& corner : polygon) {
                const auto [x, y] = local.rounded(corner.point);
                corners.push_back({x, y, local.rounded_height(plane[p], corner.point)});
            }
            file.add('f', corners);
        }
    }
}

/// Where a line enters and leaves the box of the input; the same position twice where it does not
/// cross it.
std::array<Position, 2> across_box(const PlanArrangement& geometry, LineId line) {
    const exact::LineFilter f = geometry.filter(line);
    const exact::PlanReach& box = geometry.reach();
    const double length = std::abs(f.a) + std::abs(f.b);
    if (length == 0) return {};
    // a position on the line, and the box's size along it in both directions
    const double square = f.a * f.a + f.b * f.b;
    const double x = f.x0 - f.a * f.c / square, y = f.y0 - f.b * f.c / square;
    const double ux = -f.b / std::sqrt(square), uy = f.a / std::sqrt(square);
    double from = -HUGE_VAL, to = HUGE_VAL;
    const auto keep_between = [&](double start, double step, double low, double high) {
        if (step == 0) return;
        const double first = (low - start) / step, last = (high - start) / step;
        from = std::max(from, std::min(first, last));
        to = std::min(to, std::max(first, last));
    };
    keep_between(x, ux, box.low_x, box.high_x);
    keep_between(y, uy, box.low_y, box.high_y);
    to = std::max(from, to);
    return {Position{x + from * ux, y + from * uy, 0}, Position{x + to * ux, y + to * uy, 0}};
}

}  // namespace

void dump_envelope(const PlanArrangement& geometry, const Envelope& envelope, const char* path) {
    dump_polygons(geometry, envelope.outlines, envelope.plane, envelope.surface, path);
}

void dump_faces(const PlanArrangement& geometry, const FaceList& faces, const char* path) {
    dump_polygons(geometry, faces.polygons, faces.plane, faces.surface, path);
}

void dump_arrangement(const PlanArrangement& geometry, const char* path) {
    ObjFile file(path);
    for (std::size_t p = 0; p < geometry.point_count(); ++p) {
        const exact::Point& point = geometry.point(static_cast<PointId>(p));
        file.add_vertex({point.x, point.y, 0});
    }
    for (const bool edges : {true, false}) {
        file.begin_group(edges ? "edges" : "traces");
        for (std::size_t l = 0; l < geometry.line_count(); ++l) {
            const auto line = static_cast<LineId>(l);
            if (geometry.line(line).is_edge() == edges) file.add('l', across_box(geometry, line));
        }
    }
}

void dump_complex(const CellComplex& cells, const char* path) {
    std::map<std::int32_t, std::vector<std::size_t>> of_surface;
    for (std::size_t f = 0; f < cells.face_surface.size(); ++f)
        of_surface[cells.face_surface[f]].push_back(f);
    ObjFile file(path);
    for (const Position& vertex : cells.vertices)
        file.add_vertex(vertex);
    for (const auto& [surface, faces] : of_surface) {
        file.begin_group(group_name(surface));
        for (const std::size_t f : faces) {
            const auto first = static_cast<std::size_t>(cells.face_offsets[f]);
            const auto end = static_cast<std::size_t>(cells.face_offsets[f + 1]);
            file.add_face({cells.face_vertices.data() + first, end - first});
        }
    }
}

}  // namespace realmodel::strata

namespace realmodel::arrangement {

void dump_regions(const exact::SpacePoints& points, const TriangleArrangement& arrangement,
                  const char* path) {
    ObjFile file(path);
    std::int32_t last = -1;
    for (std::size_t r = 0; r < arrangement.regions().size(); ++r) {
        const Region region = arrangement.regions()[r];
        if (region.triangle != last) {
            file.begin_group("triangle_" + std::to_string(region.triangle));
            last = region.triangle;
        }
        char kind = 'f';
        for (const auto loop : region.loops) {
            std::vector<Position> corners;
            for (const SpacePointId p : loop)
                corners.push_back(points.rounded(p));
            if (kind == 'l') corners.push_back(corners.front());
            file.add(kind, corners);
            kind = 'l';
        }
    }
}

}  // namespace realmodel::arrangement

namespace realmodel::booleans {

void dump_pieces(const TrianglePieces& pieces, const char* path) {
    ObjFile file(path);
    for (std::size_t p = 0; p < pieces.points.size(); ++p)
        file.add_vertex(pieces.points.rounded(SpacePointId(p)));
    for (const std::uint8_t source : {0, 1}) {
        for (const bool fresh : {false, true}) {
            file.begin_group(std::string(source == 0 ? "P" : "Q") + (fresh ? "_fresh" : ""));
            for (std::size_t i = 0; i < pieces.input_count(); ++i) {
                const auto input = static_cast<std::int32_t>(i);
                if (pieces.source(input) != source) continue;
                for (const TrianglePiece& piece : pieces.of(input)) {
                    if (piece.is_fresh != fresh) continue;
                    std::array<std::int32_t, 3> corners;
                    for (std::size_t k = 0; k < 3; ++k)
                        corners[k] = piece.corners[k].number();
                    file.add_face(corners);
                }
            }
        }
    }
}

}  // namespace realmodel::booleans

namespace realmodel::cutting {

void dump_parts(const RoundedParts& parts, const char* path) {
    ObjFile file(path);
    for (std::size_t n = 0; n < parts.vertices.size() + parts.new_positions.size(); ++n)
        file.add_vertex(parts.at(static_cast<NodeId>(n)));
    for (std::size_t part = 0; part < parts.half_cells.size(); ++part) {
        file.begin_group("part_" + std::to_string(part));
        for (std::size_t p = 0; p < parts.pieces.size(); ++p) {
            for (std::size_t k = 0; k < 2; ++k) {
                if (parts.pieces[p].parts[k] != static_cast<std::int32_t>(part)) continue;
                const auto polygon = parts.pieces.polygons[p];
                std::vector<NodeId> nodes(polygon.begin(), polygon.end());
                if (k == 1) std::ranges::reverse(nodes);
                file.add_face(nodes);
            }
        }
    }
}

}  // namespace realmodel::cutting

namespace realmodel::simulation {

namespace {

Vec3 at_height(const PlanPoint& p, double z) {
    return {p[0], p[1], z};
}

/// A front of a triangle in space.
std::array<Vec3, 3> corners_of(const PlanTopology& plan, const PillarLevels& levels, std::size_t t,
                               const Front& front) {
    std::array<Vec3, 3> found;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::int32_t node = plan.corners(t)[i];
        found[i] = at_height(plan.point(node), levels.heights(node)[index(front[i])]);
    }
    return found;
}

}  // namespace

void dump_plan(const PlanTopology& plan, const char* path) {
    ObjFile file(path);
    for (const PlanPoint& p : plan.mesh().points)
        file.add_vertex(at_height(p, 0));
    std::map<std::int32_t, std::vector<std::size_t>> of_rock;
    for (std::size_t t = 0; t < plan.triangles(); ++t)
        of_rock[plan.rock(t)].push_back(t);
    for (const auto& [rock, triangles] : of_rock) {
        file.begin_group(rock < 0 ? "outside" : "rock_" + std::to_string(rock));
        for (const std::size_t t : triangles)
            file.add_face(plan.corners(t));
    }
    for (const bool is_step : {true, false}) {
        file.begin_group(is_step ? "steps" : "lines");
        for (std::size_t t = 0; t < plan.triangles(); ++t) {
            for (std::size_t i = 0; i < 3; ++i) {
                if (plan.segment(t, i) < 0 || plan.is_inner_step(t, i) != is_step) continue;
                const auto end = [&](std::size_t k) {
                    return at_height(plan.point(plan.corners(t)[k % 3]), 0);
                };
                file.add('l', std::array{end(i), end(i + 1)});
            }
        }
    }
}

void dump_pillars(const PlanTopology& plan, const PillarLevels& levels, const char* path) {
    constexpr double kAside = 0.05;
    ObjFile file(path);
    for (std::size_t t = 0; t < plan.triangles(); ++t) {
        const auto [a, b, c] = plan.corners(t);
        const PlanPoint middle = middle_of(plan.point(a), plan.point(b), plan.point(c));
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t pillar = plan.pillar(t, i);
            const std::int32_t node = plan.corners(t)[i];
            const PlanPoint p = moved(plan.point(node), kAside, minus(middle, plan.point(node)));
            std::vector<Vec3> line;
            for (const std::int32_t level : levels.levels(pillar))
                line.push_back(at_height(p, levels.heights(node)[index(level)]));
            if (line.empty()) continue;
            file.begin_group("pillar_" + std::to_string(pillar));
            file.add('l', line);
        }
    }
}

void dump_columns(const PlanTopology& plan, const PillarLevels& levels, const ColumnFronts& columns,
                  const char* path) {
    ObjFile file(path);
    std::map<std::int32_t, std::vector<std::array<std::size_t, 2>>> of_block;
    for (std::size_t t = 0; t < plan.triangles(); ++t) {
        for (std::size_t e = columns.offset[t]; e < columns.offset[t] + columns.elements(t); ++e)
            of_block[columns.blocks[e]].push_back({t, e});
    }
    for (const auto& [block, elements] : of_block) {
        file.begin_group("block_" + std::to_string(block));
        for (const auto& [t, e] : elements) {
            for (const std::size_t front : {e, e + 1})
                file.add('f', corners_of(plan, levels, t, columns.fronts[front]));
        }
    }
}

void dump_change(const EditableComplex& complex, const Change& change, const char* path) {
    ObjFile file(path);
    const auto add = [&](std::span<const std::int32_t> loop) {
        std::vector<Vec3> corners;
        for (const std::int32_t v : loop)
            corners.push_back(complex.point(v));
        file.add('f', corners);
    };
    file.begin_group("before");
    for (const std::int32_t f : change.removed)
        add(complex.corners(f));
    for (std::size_t i = 0; i < change.added.size(); ++i) {
        file.begin_group("after_" + std::to_string(i));
        add(change.loop(change.added[i]));
    }
}

}  // namespace realmodel::simulation
