// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/meshing/region_mesh.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "base/algorithms.hpp"
#include "base/vectors.hpp"
#include "meshing/edge_cutting.hpp"
#include "meshing/improvement.hpp"
#include "meshing/lattice.hpp"
#include "meshing/plan_predicates.hpp"
#include "meshing/region_graph.hpp"
#include "meshing/size_field.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/memory.hpp"
#include "realmodel/base/progress.hpp"

namespace realmodel::meshing {

namespace {

// In edge lengths. Lattice points nearer to the border than the kClearance would make flat
// triangles with it; the longest edge lets pass what the band between lattice and border needs.
constexpr double kClearance = 0.6;
constexpr double kLongestEdge = 1.6;
constexpr double kShortestEdge = 1e-3;
/// How many times as fine as elsewhere a mesh becomes around points of constraints.
constexpr double kMostRefined = 64;
constexpr double kLeastAngle = 27.0 / 180 * std::numbers::pi;

// The same for grids: nodes stay where they are as far as slivers allow it.
constexpr double kGridClearance = 0.35;
constexpr double kLongestGridEdge = 2.2;
constexpr double kLeastGridAngle = 20.0 / 180 * std::numbers::pi;

// Measured at 4 million triangles (native/benchmarks/meshing_benchmark.cpp), with a reserve.
constexpr double kBytesPerTriangle = 220;
constexpr double kMostTriangles = kMostFlatTriangles;

std::string number_text(double number) {
    char text[40];
    std::snprintf(text, sizeof text, "%.6g", number);
    return text;
}

struct GraphExtent {
    double reach = 0;  // largest coordinate in absolute value
    double width = 0;  // of the bounding box, the longer side
    PlanPoint low{}, high{};
};

GraphExtent extent_of(const RegionGraph& graph) {
    GraphExtent extent;
    extent.low = extent.high = graph.points[graph.border.front()[0]];
    for (const auto& [from, to] : graph.border) {
        const PlanPoint& p = graph.points[from];
        for (int i = 0; i < 2; ++i) {
            extent.low[i] = std::min(extent.low[i], p[i]);
            extent.high[i] = std::max(extent.high[i], p[i]);
            extent.reach = std::max(extent.reach, std::abs(p[i]));
        }
    }
    extent.width = std::max(extent.high[0] - extent.low[0], extent.high[1] - extent.low[1]);
    return extent;
}

void require_length(double edge_length) {
    if (edge_length > 0 && std::isfinite(edge_length)) return;
    throw InputError("edge_length", "the edge length is " + number_text(edge_length) +
                                        "; it must be a positive finite number");
}

[[maybe_unused]] bool is_upright(const PlanarMesh& mesh) {
    return std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
        return orient2d(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]) > 0;
    });
}

/// The triangles that are not dead, and the points that they use, in their order.
PlanarMesh collected(FlatMesh&& flat, const Check& check) {
    Ticker tick(check);
    PlanarMesh mesh{std::move(flat.points), std::move(flat.corners)};
    flat.twins = {};
    std::erase_if(mesh.triangles, [](const auto& t) { return t[0] < 0; });
    std::vector<bool> used(mesh.vertices.size(), false);
    for (const auto& t : mesh.triangles) {
        tick(0.1);
        for (const std::int32_t v : t)
            used[v] = true;
    }
    if (std::find(used.begin(), used.end(), false) == used.end()) return mesh;
    std::vector<std::int32_t> number(used.size());
    std::int32_t used_count = 0;
    for (std::size_t i = 0; i < used.size(); ++i) {
        number[i] = used_count;
        if (used[i]) mesh.vertices[used_count++] = mesh.vertices[i];
    }
    mesh.vertices.resize(used_count);
    for (auto& t : mesh.triangles) {
        tick(0.5);
        for (std::int32_t& v : t)
            v = number[v];
    }
    return mesh;
}

/// Of each point of a mesh whether it is one of constraints that no edge ends at.
std::vector<bool> marked_loners(const RegionGraph& graph, const FlatMesh& flat) {
    std::vector<bool> is_loner(flat.points.size(), false);
    for (const std::int32_t v : graph.loners)
        is_loner[v] = true;
    return is_loner;
}

/// How near to points of constraints other vertices and fixed edges are: angles there are improved
/// down to that, since these points were asked for, and not drawn with an outline.
double room_at_loners(const RegionGraph& graph, const FlatMesh& flat) {
    if (graph.loners.empty()) return HUGE_VAL;
    const std::vector<bool> is_loner = marked_loners(graph, flat);
    double least = HUGE_VAL;
    flat.for_each_edge([&](HalfEdge edge) {
        const PlanPoint &a = flat.origin_point(edge), &b = flat.target_point(edge),
                        &c = flat.apex_point(edge);
        if (is_loner[flat.from(edge)] || is_loner[flat.to(edge)])
            least = std::min(least, squared_distance(a, b));
        if (is_loner[flat.apex(edge)] && flat.is_fixed(edge)) {
            const double area = twice_area(a, b, c);
            least = std::min(least, area * area / squared_distance(a, b));
        }
    });
    return std::sqrt(least);
}

// Where detail is everywhere (combs, coasts), sizes follow it only so far: what is finer is left to
// the refinement of angles, which needs no field that is as fine as the detail.
constexpr std::size_t kManySources = 50'000;
constexpr double kFinestOfMany = 64;

// Beside outlines that are all detail most triangles are where lengths grow: the slower they do,
// the better they are, and the more (15 % more than with a kGrowth of a quarter).
constexpr double kGrowth = 0.2;

/// How long edges should be at a fixed edge. Refinement halves lengths; where the region is a strip
/// between the edge and the border opposite, its width tells how far.
double length_at(const FlatMesh& mesh, HalfEdge edge, const std::vector<bool>& is_fixed) {
    const PlanPoint &a = mesh.origin_point(edge), &b = mesh.target_point(edge);
    const double length = std::sqrt(squared_distance(a, b));
    const bool is_strip =
        is_fixed[mesh.apex(edge)] && !mesh.is_fixed(edge.next()) && !mesh.is_fixed(edge.prev());
    if (!is_strip) return length;
    const double width = twice_area(a, b, mesh.apex_point(edge)) / length;
    return std::clamp(2 / std::numbers::sqrt3 * width, 0.25 * length, 1.5 * length);
}

/// No source finer than `finest`, and of those one in each square of that edge.
void thin_out(std::vector<SizeSource>& sources, double finest) {
    std::vector<SizeSource> thinned;
    std::ranges::stable_sort(sources, std::greater<>(), &SizeSource::least);
    using GridSquare = std::pair<std::array<double, 2>, std::size_t>;
    std::vector<GridSquare> squares;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        if (sources[i].least >= finest) {
            thinned.push_back(sources[i]);
            continue;
        }
        const PlanPoint m = middle(sources[i].a, sources[i].b);
        squares.push_back({{std::floor(m[0] / finest), std::floor(m[1] / finest)}, i});
    }
    std::sort(squares.begin(), squares.end());
    for (const auto group : groups_of(squares, &GridSquare::first)) {
        SizeSource source = sources[group[0].second];
        source.start = source.least = finest;
        thinned.push_back(source);
    }
    sources = std::move(thinned);
}

/// Where border, inner lines and points are too close to one another for edges as long as `size`
/// wants: the short pieces that a coarse refinement without regard to size leaves there, whose
/// lengths follow the local feature size (Ruppert 1995, theorem 1).
std::vector<SizeSource> border_detail(const RegionGraph& graph, SizeField& size, double least_angle,
                                      double shortest_edge, std::size_t most_vertices,
                                      const Check& check) {
    constexpr double kShortShare = 0.7;  // cut_border's own pieces are hardly shorter than that
    FlatMesh mesh = mesh_without_lattice(graph, cut_border(graph, size, shortest_edge, check),
                                         shortest_edge, check);
    refine(mesh,
           {least_angle, std::numeric_limits<double>::infinity(), shortest_edge, most_vertices},
           size, 0, {}, check);
    const std::vector<bool> is_loner = marked_loners(graph, mesh);
    std::vector<SizeSource> sources;
    std::vector<bool> is_fixed(mesh.points.size(), false);
    mesh.for_each_edge([&](HalfEdge edge) {
        if (mesh.is_fixed(edge)) is_fixed[mesh.from(edge)] = is_fixed[mesh.to(edge)] = true;
    });
    mesh.for_each_edge([&](HalfEdge edge) {
        const bool is_first = mesh.is_border(edge) || mesh.twin(edge).triangle() > edge.triangle();
        if (!is_first) return;
        const PlanPoint &a = mesh.origin_point(edge), &b = mesh.target_point(edge);
        const double length = std::sqrt(squared_distance(a, b));
        if (length >= kShortShare * size.at(middle(a, b))) return;
        // Refinement passes over triangles with the shortest edges: leave it room above them.
        const double least = std::max(length, 4 * shortest_edge);
        if (mesh.is_fixed(edge)) {
            const double here = std::max(length_at(mesh, edge, is_fixed), 4 * shortest_edge);
            sources.push_back({a, b, here, here, kGrowth});
        }
        for (const std::int32_t v : {mesh.from(edge), mesh.to(edge)}) {
            const PlanPoint& p = mesh.points[v];
            if (is_loner[v]) sources.push_back({p, p, least, least, kGrowth});
        }
    });
    if (sources.size() > kManySources) thin_out(sources, size.largest() / kFinestOfMany);
    return sources;
}

/// A request at work: the region, and what to tell and to ask while it is meshed.
class Meshing {
public:
    Meshing(std::span<const Ring> rings, const MeshRequest& request, Progress* progress)
        : request_(request), progress_(progress) {
        if (request.mesher == Mesher::kGrid &&
            !(request.sizes.empty() && request.density.empty())) {
            throw InputError("size",
                             "a grid has one edge length everywhere; use mesher \"delaunay\" "
                             "or \"frontal\" for local ones");
        }
        if (request.triangles > 0) {
            if (!std::isfinite(request.triangles)) {
                throw InputError("triangles", "the number of triangles must be finite");
            }
        } else if (request.density.empty() || request.edge_length != 0) {
            require_length(request.edge_length);
        }
        step(0, 0.01, "checking the outlines")(0);
        graph_ = region_graph(rings, request.constraints, progress);
        extent_ = extent_of(graph_);
        fitting_ =
            std::min(kMostTriangles, static_cast<double>(available_memory()) / kBytesPerTriangle);
    }

    PlanarMesh run() {
        if (request_.triangles > 0) return run_for_count();
        const double length = longest();
        return mesh(field(length, 1), 0.01, 1);
    }

    MeshEstimate estimate() {
        fitting_ = kMostTriangles;  // it is the caller who asks whether it fits
        double triangles = request_.triangles;
        if (triangles <= 0) {
            SizeField size = unchecked_field(longest(), 1);
            triangles = triangles_of(size);
        }
        return {triangles, triangles * kBytesPerTriangle};
    }

private:
    Check step(double begin, double end, const char* text) const {
        Progress* progress = progress_;
        return [=](double share) {
            if (progress == nullptr) return;
            progress->report(begin + (end - begin) * share, text);
            progress->check();
        };
    }

    double longest() const {
        if (request_.density.empty()) return request_.edge_length;
        const double by_density = longest_by_density(graph_, request_);
        return request_.edge_length > 0 ? std::min(by_density, request_.edge_length) : by_density;
    }

    /// What may be wanted where, for a longest edge. Throws "too_large", "edge_length", "size".
    SizeField field(double length, double scale) const {
        require_room(length);
        SizeField size = unchecked_field(length, scale);
        if (!size.is_uniform()) {
            const double need = triangles_of(size);
            if (need > fitting_) refuse_size(need);
            require_precision(size.smallest());
        }
        if (request_.mesher == Mesher::kFrontal) size = graded_to_detail(std::move(size), scale);
        return size;
    }

    SizeField unchecked_field(double length, double scale) const {
        const std::vector<SizeSource> sources = requested_sources(graph_, request_, length, scale);
        const double pieces = pieces_along(sources, extent_.low, extent_.high);
        if (pieces > fitting_) refuse_size(2 * pieces);
        return {length, kGradation, sources, extent_.low, extent_.high, fitting_};
    }

    /// Also fine where the border has detail, as far as doubles can tell points apart: triangles
    /// there grow more gently than refinement of angles alone would let them.
    SizeField graded_to_detail(SizeField&& size, double scale) const {
        std::vector<SizeSource> sources =
            border_detail(graph_, size, kLeastAngle, kShortestEdge * size.largest(),
                          most_vertices(), step(0.01, 0.01, "looking for detail"));
        for (SizeSource& source : sources) {
            source.start = std::max(source.start, finest_length());
            source.least = std::max(source.least, finest_length());
        }
        if (sources.empty()) return std::move(size);
        const std::vector<SizeSource> wanted =
            requested_sources(graph_, request_, size.largest(), scale);
        sources.insert(sources.end(), wanted.begin(), wanted.end());
        return {size.largest(), kGradation,   std::move(sources),
                extent_.low,    extent_.high, fitting_};
    }

    std::size_t most_vertices() const { return static_cast<std::size_t>(fitting_ / 2); }

    double triangles_of(SizeField& size) const {
        return triangles_in(graph_, size, step(0.01, 0.01, "sizing the triangles")) +
               2 * estimate_pieces(graph_, size.largest());
    }

    /// Refuses before anything large is taken.
    void require_room(double edge_length) const {
        const auto need_at = [&](double length) {
            return graph_.area / (std::numbers::sqrt3 / 4 * length * length) +
                   2 * estimate_pieces(graph_, length);
        };
        const double need = need_at(edge_length);
        if (need > fitting_) {
            double fits = edge_length;
            while (need_at(fits) > fitting_ && fits < extent_.width)
                fits *= 1.01;
            throw InputError("too_large",
                             "edge length " + number_text(edge_length) + " would need about " +
                                 number_text(need) + " triangles (" +
                                 number_text(need * kBytesPerTriangle / 1e9) +
                                 " GB); there is room for " + number_text(fitting_) +
                                 ": use an edge length of at least " + number_text(fits));
        }
        require_precision(edge_length);
    }

    /// The shortest length at which doubles tell points of a mesh apart.
    double finest_length() const {
        return 16 * extent_.reach * std::numeric_limits<double>::epsilon() / kShortestEdge;
    }

    void require_precision(double edge_length) const {
        if (edge_length >= finest_length()) return;
        throw InputError("edge_length",
                         "edge length " + number_text(edge_length) +
                             " is too small for coordinates as large as " +
                             number_text(extent_.reach) +
                             ": doubles cannot tell the points apart; use at least " +
                             number_text(17.0 / 16 * finest_length()) +
                             ", or move the region nearer to the origin");
    }

    [[noreturn]] void refuse_size(double need) const {
        throw InputError("too_large", "the local lengths would need about " + number_text(need) +
                                          " triangles (" +
                                          number_text(need * kBytesPerTriangle / 1e9) +
                                          " GB); there is room for " + number_text(fitting_) +
                                          ": use longer ones, or shorter distances");
    }

    /// Border, lattices and the band between them.
    BandedMesh first_mesh(SizeField& size, double finest, const Check& cutting,
                          const Check& placing, const Check& joining) const {
        BorderPieces border;
        std::vector<TriangleLattice> lattices;
        if (request_.mesher == Mesher::kGrid) {
            const double spacing = size.largest();
            border =
                cut_border_by_grid(graph_, extent_.low, spacing, kGridClearance, finest, cutting);
            lattices.push_back(lattice_inside(border, graph_.loners,
                                              {extent_.low, {1, 0}, spacing, spacing, true}, size,
                                              spacing, kGridClearance, placing));
        } else {
            border = cut_border(graph_, size, finest, cutting);
            for (const double length : lattice_lengths(request_, size)) {
                lattices.push_back(lattice_inside(border, graph_.loners,
                                                  fitting_frame(graph_, length), size, length,
                                                  kClearance, placing));
            }
        }
        const bool has_lattice =
            std::any_of(lattices.begin(), lattices.end(),
                        [](const TriangleLattice& l) { return !l.points.empty(); });
        if (request_.mesher == Mesher::kFrontal && !has_lattice)
            return {mesh_without_lattice(graph_, border, finest, joining), 0, {}};
        return join_band(std::move(border), graph_.loners, std::move(lattices), joining);
    }

    PlanarMesh mesh(SizeField size, double begin, double end) const {
        const auto phase = [&](double from, double to, const char* text) {
            return step(begin + (end - begin) * from, begin + (end - begin) * to, text);
        };
        const bool is_grid = request_.mesher == Mesher::kGrid;
        const bool is_frontal = request_.mesher == Mesher::kFrontal;
        const double finest = kShortestEdge * size.largest();
        BandedMesh banded =
            first_mesh(size, finest, phase(0, 0.05, "cutting the border"),
                       phase(0.05, 0.3, "placing the points"), phase(0.3, 0.5, "triangulating"));
        FlatMesh& flat = banded.mesh;
        if (!size.is_uniform()) {
            advance_front(flat, size, banded.first_of_band, most_vertices(),
                          phase(0.5, 0.75, "filling"));
        }
        // Nearer ones are left as they are: where lines come as close, all of these would be
        // divided as finely.
        const double room = room_at_loners(graph_, flat) / 2;
        const double shortest = room < finest / kMostRefined ? finest : std::min(finest, room);
        const RefinementTarget target{is_grid ? kLeastGridAngle : kLeastAngle,
                                      is_grid ? kLongestGridEdge : kLongestEdge, shortest,
                                      most_vertices()};
        refine(flat, target, size, banded.first_of_band, banded.rim_triangles,
               phase(0.75, 0.8, "improving the border"));
        if (is_frontal) {
            const Check check = phase(0.8, 0.9, "smoothing");
            smooth(flat, size, banded.first_of_band, banded.rim_triangles,
                   static_cast<std::int32_t>(graph_.points.size()), graph_.loners, check);
            flat.compact();
            refine(flat, target, size, 0, {}, check);
        }
        const Check finish = phase(0.9, 1, "collecting the mesh");
        PlanarMesh mesh = collected(std::move(flat), finish);
        assert(is_upright(mesh));
        return mesh;
    }

    PlanarMesh run_for_count() {
        constexpr double kGoodEnough = 0.02;
        constexpr int kMostRounds = 8;
        // The area of a triangle of side 1, or half a square.
        const double equilateral = request_.mesher == Mesher::kGrid ? 0.5 : std::numbers::sqrt3 / 4;
        const double wanted = request_.triangles;
        // With densities both bounds and points are scaled alike.
        double scale = 1;
        const double unit =
            request_.density.empty() ? std::sqrt(graph_.area / (equilateral * wanted)) : longest();
        PlanarMesh best;
        double best_miss = std::numeric_limits<double>::infinity();
        for (int round = 0; round < kMostRounds; ++round) {
            const double begin = 1 - std::ldexp(1.0, -round), end = 1 - std::ldexp(1.0, -round - 1);
            PlanarMesh made = mesh(field(scale * unit, scale), begin, end);
            const auto count = static_cast<double>(made.triangles.size());
            const double miss = std::abs(count / wanted - 1);
            if (miss < best_miss) {
                best = std::move(made);
                best_miss = miss;
            }
            if (miss <= kGoodEnough) break;
            scale *= std::sqrt(count / wanted);
            if (scale * unit > 4 * extent_.width) break;
        }
        if (best_miss > 0.05) {
            throw InputError("triangles", "this region cannot be meshed with about " +
                                              number_text(wanted) +
                                              " triangles; the nearest found is " +
                                              std::to_string(best.triangles.size()));
        }
        return best;
    }

    const MeshRequest& request_;
    Progress* progress_;
    RegionGraph graph_;
    GraphExtent extent_;
    double fitting_ = 0;
};

}  // namespace

MeshEstimate estimate_region_mesh(std::span<const Ring> rings, const MeshRequest& request,
                                  Progress* progress) {
    return Meshing(rings, request, progress).estimate();
}

PlanarMesh mesh_region(std::span<const Ring> rings, const MeshRequest& request,
                       Progress* progress) {
    return Meshing(rings, request, progress).run();
}

}  // namespace realmodel::meshing
