// SPDX-License-Identifier: GPL-3.0-or-later
// A prototype: the columns of an erosional stack in one pass over the facets of its envelope,
// beside the library's steps (overlay, conform, cells) in the same process. docs/dev/log/stacks.md
// has what came of it.
//
//   one_pass_benchmark [SURFACES [QUADS [PAIRS [SPACING]]]]
//
// The surfaces are stack_benchmark's; SPACING 0.4 instead of 0.05 keeps them apart. PAIRS 0 runs
// the pass alone, for its memory. Processor time of the one thread is measured, in alternating
// order, and every cell is compared: its faces, in both the same cycles of the same positions, in
// any order.
//
// Facets that lie above the surface by far more than rounding, or not below it, are generic. They
// hand each other crossings, vertices and walls: nothing is looked for again by position, line or
// name, and faces are written once. What is left, where surfaces meet and at the border, is
// special: the library's overlay and conforming make it, and vertices in one position are joined at
// the end.
//
// An edge is special, and so are all faces that have a part of it, if on either side of it is
//   - a facet that is cut, or a triangle of the surface that is eroded somewhere;
//   - a triangle beneath a facet that is cut, whose faces are cut along it;
// and if a triangle that it crosses beneath is eroded somewhere, as what is left has edges along
// it.
#include <time.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <random>
#include <unordered_map>
#include <utility>
#include <vector>

#include "exact/rounding.hpp"
#include "facet_walk.hpp"
#include "realmodel/strata/stack.hpp"
#include "strata/cells/assembly.hpp"
#include "strata/cells/distinct_positions.hpp"
#include "strata/cells/volumes.hpp"
#include "strata/conform/walls.hpp"
#include "strata/overlay/facet_overlay.hpp"
#include "strata/repair/border_joining.hpp"
#include "strata/repair/plan_context.hpp"
#include "strata/repair/plan_snapping.hpp"

namespace {

using namespace realmodel;
using namespace realmodel::strata;
using exact::PlanArrangement;

double now() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Surface {
    std::vector<double> vertices;
    std::vector<std::int32_t> triangles;
};

/// A surface as stack_benchmark makes it.
Surface make_surface(int quads, int number, double spacing, std::mt19937_64& random) {
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const double p = uniform(0, 6), q = uniform(0, 6), r = uniform(0, 6);
    Surface s;
    for (int i = 0; i <= quads; ++i) {
        for (int j = 0; j <= quads; ++j) {
            const auto place = [&](int n) {
                const bool inside = n > 0 && n < quads;
                return (n + (inside ? uniform(-0.2, 0.2) : 0.0)) / quads;
            };
            const double x = place(i), y = place(j);
            const double z = spacing * number + 0.1 * std::sin(3 * x + p) * std::cos(4 * y + q) +
                             0.03 * std::sin(9 * x + r + 5 * y);
            s.vertices.insert(s.vertices.end(), {x, y, z});
        }
    }
    for (int i = 0; i < quads; ++i) {
        for (int j = 0; j < quads; ++j) {
            const std::int32_t a = i * (quads + 1) + j, b = a + quads + 1, c = b + 1, d = a + 1;
            s.triangles.insert(s.triangles.end(), {a, b, c, a, c, d});
        }
    }
    return s;
}

/// A triangle above which faces lie.
struct FacetOutline {
    std::array<Corner, 3> corner;
};

class OnePass : FacetWalk {
public:
    OnePass(PlanContext& context, const Execution& execution, std::array<double, 6>& seconds)
        : FacetWalk(context.geometry),
          context_(context),
          execution_(execution),
          seconds_(seconds),
          lower_(geometry_.vertex_count()) {}

    CellComplex run() {
        LoadedRock& rock = context_.rocks[0];
        const auto count = static_cast<std::int32_t>(rock.surfaces.size());
        construction_.may_lack_nodes = false;
        for (std::int32_t k = count - 1; k >= 0; --k) {
            double start = now();
            const SurfaceTiling surface = make_surface_tiling(
                geometry_, rock.surfaces[index(k)], std::move(rock.plans[index(k)]), k, execution_);
            rock.surfaces[index(k)] = {};
            context_.surface_of_plane.resize(geometry_.plane_count(), k);
            seconds_[1] += now() - start;
            start = now();
            begin_layer(surface, k);
            if (k == count - 1) {
                begin_envelope(surface);
            } else {
                overlay(surface);
            }
            seconds_[2] += now() - start;
        }
        double start = now();
        for (Facet& f : envelope_) {
            if (is_touched(f.corner)) f.state = Facet::kSpecial;
        }
        add_to_special();
        finish(special_, std::nullopt, false, construction_);
        for (std::size_t f = 0; f < pending_.size(); ++f) {
            if (pending_.below[f] != kDead)
                construction_.faces.add(pending_.polygons[f], pending_.plane[f],
                                        pending_.surface[f], pending_.above[f], pending_.below[f]);
        }
        leave_out_open_nodes();
        divide_walls();
        const CellComplex rest = conform_special();
        seconds_[4] += now() - start;
        start = now();
        join(rest);
        seconds_[5] += now() - start;
        start = now();
        complex_.volumes = block_volumes(complex_, static_cast<std::size_t>(count), execution_);
        seconds_[3] += now() - start;
        return std::move(complex_);
    }

    std::size_t facets = 0, closed = 0, stayed = 0, special = 0, special_faces = 0;

private:
    static constexpr std::int32_t kDead = -3;

    std::int32_t add_vertex(double x, double y, double z) {
        complex_.vertices.push_back({x, y, z});
        return static_cast<std::int32_t>(complex_.vertices.size()) - 1;
    }
    /// A vertex of the surface.
    std::int32_t surface_vertex(const SurfaceTiling& s, std::int32_t t, std::uint32_t corner) {
        const exact::VertexId id = geometry_.vertex(triangle(s, t)[corner].point);
        std::int32_t& v = lower_[index(id)];
        if (v >= 0) return v;
        const exact::Point& p = geometry_.point(id);
        return v = add_vertex(p.x, p.y,
                              geometry_.space(geometry_.plane(s.plane[index(t)]).above(id)).z);
    }
    /// A vertex beneath a corner of a facet.
    std::int32_t projected_vertex(LocalArrangement& scope, const SurfaceTiling& s, PointId id) {
        Location& at = location_[index(id)];
        if (at.vertex >= 0) return at.vertex;
        const exact::Point& p = geometry_.point(id);
        const PlaneId plane = s.plane[index(at.triangle)];
        return at.vertex = add_vertex(p.x, p.y,
                                      scope.rounded_height(plane, exact::HeightName(plane), id,
                                                           scope.approximate(id)));
    }
    std::int32_t crossing_vertex(LocalArrangement& scope, const SurfaceTiling& s,
                                 exact::LineId line, std::uint32_t number) {
        Crossing& c = crossings_[number];
        if (c.vertex >= 0) return c.vertex;
        const auto crossed = triangle(s, c.left)[c.left_corner].line.id();
        const PlaneId plane = s.plane[index(c.left)];
        const auto name = geometry_.plane(plane).above(geometry_.line(crossed));
        const exact::NearPoint near = scope.approximate_crossing(line, crossed);
        const exact::Point& from = geometry_.point(near.origin);
        const auto x = exact::nearest_sum(from.x, near.x), y = exact::nearest_sum(from.y, near.y),
                   z = exact::near_edge_height(geometry_, name.from(), name.to(), near);
        if (x && y && z) {
            c.vertex = add_vertex(*x, *y, *z);
        } else {
            const PointId point = scope.crossing_between_ends(line, crossed);
            const exact::Point& at = scope.point(point);
            c.vertex = add_vertex(
                at.x, at.y, scope.rounded_height(plane, name, point, scope.approximate(point)));
        }
        std::int32_t& last = chains_[index(crossed)];
        chain_nodes_.push_back({c.vertex, last});
        last = static_cast<std::int32_t>(chain_nodes_.size()) - 1;
        return c.vertex;
    }

    template <class Corners>
    void add_face(const Corners& corners, std::int32_t below, std::int32_t above,
                  std::int32_t surface) {
        complex_.face_offsets.push_back(static_cast<std::int64_t>(complex_.face_vertices.size()));
        complex_.face_vertices.append(corners.begin(), corners.end());
        complex_.face_surface.push_back(surface);
        next_above_.push_back(-1);
        if (surface != kWall && below >= 0) {
            const auto face = static_cast<std::int32_t>(complex_.face_cells.size());
            next_above_.back() = std::exchange(faces_above_[index(below)], face);
        }
        if (below >= 0) {
            complex_.face_cells.push_back({below, above});
        } else {
            complex_.face_cells.push_back({above, -1});
            std::reverse(complex_.face_vertices.end() - static_cast<std::ptrdiff_t>(corners.size()),
                         complex_.face_vertices.end());
        }
    }

    /// The walls on its edges are made with the special faces.
    void touch(PolygonView polygon) {
        for (const Corner& corner : polygon)
            edge_is_special_[index(corner.line.id())] = 1;
    }
    bool is_touched(PolygonView polygon) const {
        return std::any_of(polygon.begin(), polygon.end(), [&](const Corner& c) {
            return edge_is_special_[index(c.line.id())] != 0;
        });
    }
    /// Whether the one pass makes the wall on a line.
    bool is_generic(exact::LineId id) const {
        return geometry_.line(id).is_edge() && edge_is_special_[index(id)] == 0;
    }

    void begin_layer(const SurfaceTiling& s, std::int32_t k) {
        k_ = k;
        std::fill(lower_.begin(), lower_.end(), -1);
        std::fill(location_.begin(), location_.end(), Location{});
        resize_lines();
        for (std::size_t t = 0; t < s.plane.size(); ++t) {
            if (!s.plane[t].has_value()) touch(s.polygons[t]);
        }
        crossings_.clear();
        divided_.assign(s.plane.size(), 0);
    }
    void resize_lines() {
        chains_.resize(geometry_.line_count(), -1);
        edges_.resize(geometry_.line_count());
        edge_is_special_.resize(geometry_.line_count());
        wall_of_.resize(geometry_.line_count(), -1);
    }

    Facet facet_of(const SurfaceTiling& s, std::size_t t, std::int32_t cell) {
        Facet f;
        for (std::uint32_t i = 0; i < 3; ++i) {
            f.corner[i] = s.polygons[t][i];
            f.vertex[i] = surface_vertex(s, static_cast<std::int32_t>(t), i);
        }
        f.plane = s.plane[t];
        f.surface = k_;
        f.cell = cell;
        f.block = k_;
        f.heights = s.heights[t];
        f.state = Facet::kCloses;
        return f;
    }
    void resize_nodes() {
        outlines_.resize(construction_.node_block.size());
        is_open_.resize(construction_.node_block.size(), 0);
        faces_above_.resize(construction_.node_block.size(), -1);
    }
    std::int32_t add_node(std::int32_t block) {
        const std::int32_t node = construction_.add_node(block, true);
        resize_nodes();
        is_open_[index(node)] = 1;
        return node;
    }

    void begin_envelope(const SurfaceTiling& s) {
        special_ = {};
        for (std::size_t t = 0; t < s.plane.size(); ++t) {
            const PlaneId plane = s.plane[t];
            if (!plane.has_value()) {
                special_.add_facet(s.polygons[t], kSky, -1, -1);
                continue;
            }
            const Facet f = facet_of(s, t, add_node(k_));
            add_face(f.vertex, f.cell, -1, k_);
            envelope_.push_back(f);
        }
    }

    /// Puts facets that are special now with the others that are, with the faces above them, which
    /// are dead.
    Envelope give_up_special() {
        Envelope given_up;
        std::vector<const Facet*> given;
        std::unordered_map<std::int32_t, std::size_t> number;  // of each node beneath
        for (const Facet& f : envelope_) {
            if (f.state != Facet::kSpecial) continue;
            number.emplace(f.cell, given.size());
            given.push_back(&f);
        }
        std::vector<std::vector<std::size_t>> pieces(given.size());
        for (std::size_t f = 0; f < pending_.size(); ++f) {
            if (pending_.below[f] < 0) continue;
            const auto at = number.find(pending_.below[f]);
            if (at == number.end()) continue;
            pieces[at->second].push_back(f);
            pending_.below[f] = kDead;
        }
        LocalArrangement scope(geometry_);
        Clipper clipper(scope);
        Envelope added;
        for (std::size_t i = 0; i < given.size(); ++i) {
            const Facet& f = *given[i];
            added.add_facet(f.corner, f.plane, f.surface, f.block);
            for (std::int32_t face = faces_above_[index(f.cell)]; face >= 0;
                 face = next_above_[index(face)]) {
                auto& cells = complex_.face_cells[index(face)];
                const std::int32_t node = std::exchange(cells, {kDead, kDead})[1];
                if (node < 0) {
                    added.add_face(f.corner, node);
                    continue;
                }
                clipper.begin(outlines_[index(node)].corner);
                added.add_face(clipper.intersect(f.corner), node);
            }
            for (const std::size_t piece : pieces[i])
                added.add_face(pending_.polygons[piece], pending_.above[piece]);
            is_open_[index(f.cell)] = 2;  // not a cell any more
        }
        mark_used(scope, added.face_polygons);
        scope.commit(geometry_);
        share(scope, added.face_polygons);
        for (std::size_t i = 0; i < added.size(); ++i)
            given_up.add_facet_of(added, i, added.block_beneath[i]);
        resize_lines();
        std::erase_if(envelope_, [](const Facet& f) { return f.state == Facet::kSpecial; });
        return given_up;
    }

    void add_to_special() {
        const Envelope more = give_up_special();
        for (std::size_t i = 0; i < more.size(); ++i)
            special_.add_facet_of(more, i, more.block_beneath[i]);
    }

    /// What is left of a triangle that is eroded somewhere has edges along those of facets above
    /// it.
    void touch_above_divided(const Facet& f) {
        for (std::size_t i = 0; i < 3; ++i) {
            const auto is_divided_at = [&](std::size_t corner) {
                return divided_[index(location_[index(f.corner[corner].point)].triangle)] != 0;
            };
            bool is_divided = is_divided_at(i) || is_divided_at(i < 2 ? i + 1 : 0);
            for_each_crossing(f.corner[i].line, [&](std::uint32_t number, bool) {
                is_divided |= divided_[index(crossings_[number].left)] != 0 ||
                              divided_[index(crossings_[number].entered)] != 0;
            });
            if (is_divided) edge_is_special_[index(f.corner[i].line.id())] = 1;
        }
    }
    Overlaid overlay_special(const SurfaceTiling& s, const Envelope& envelope) {
        special += envelope.size();
        const std::size_t first_face = construction_.faces.size();
        Overlaid overlaid = overlay_facets(geometry_, envelope, {s, k_}, nullptr, nullptr,
                                           construction_, execution_);
        resize_nodes();
        resize_lines();
        name_nodes_beneath(first_face);
        return overlaid;
    }

    void overlay(const SurfaceTiling& s) {
        facets += envelope_.size() + special_.size();
        // what becomes of each facet
        constexpr std::size_t kFacets = 1024;
        for (std::size_t begin = 0; begin < envelope_.size(); begin += kFacets) {
            LocalArrangement scope(geometry_);
            for (std::size_t f = begin; f < std::min(begin + kFacets, envelope_.size()); ++f) {
                envelope_[f].state = classify(scope, envelope_[f], s);
                if (envelope_[f].state == Facet::kSpecial) touch(envelope_[f].corner);
            }
        }
        for (Facet& f : envelope_) {
            if (f.state != Facet::kStays) continue;
            // eroded beneath
            find_stretches(f);
            find_met(s);
            for_each_met([&](std::int32_t t) { divided_[index(t)] = 1; });
        }
        add_to_special();
        Overlaid overlaid = overlay_special(s, special_);
        // which triangles of the surface are divided, and what is above them
        for (std::size_t t = 0; t < s.plane.size(); ++t) {
            divided_[t] |= overlaid.is_divided[t];
            if (divided_[t] != 0) touch(s.polygons[t]);
        }
        // faces of divided facets have edges along those beneath
        for (std::size_t i = 0; i < overlaid.below.polygon.size(); ++i) {
            const std::int32_t node = overlaid.below.node_above[i];
            if (node >= 0 && construction_.node_is_thick[index(node)] == 0)
                touch(s.polygons[index(overlaid.below.polygon[i])]);
        }
        for (const Facet& f : envelope_) {
            if (f.state == Facet::kCloses) touch_above_divided(f);
        }
        for (Facet& f : envelope_) {
            if (f.state == Facet::kCloses && is_touched(f.corner)) f.state = Facet::kSpecial;
        }
        {
            const Overlaid more = overlay_special(s, give_up_special());
            if (more.remaining.size() > 0) std::abort();  // they close as a whole
            for (std::size_t i = 0; i < more.below.polygon.size(); ++i) {
                overlaid.below.outlines.add(more.below.outlines[i]);
                overlaid.below.polygon.push_back(more.below.polygon[i]);
                overlaid.below.node_above.push_back(more.below.node_above[i]);
            }
        }
        std::vector<std::uint8_t> use(s.plane.size(), kElsewhere);
        node_of_.assign(s.plane.size(), -1);
        for (std::size_t t = 0; t < s.plane.size(); ++t) {
            if (!s.plane[t].has_value()) continue;
            if (divided_[t] != 0) {
                use[t] = kDivided;
            } else {
                node_of_[t] = add_node(k_);
            }
        }
        for (std::size_t begin = 0; begin < envelope_.size(); begin += kFacets) {
            LocalArrangement scope(geometry_);

            Clipper clipper(scope);
            PolygonPool outlines;
            for (std::size_t f = begin; f < std::min(begin + kFacets, envelope_.size()); ++f) {
                if (envelope_[f].state == Facet::kCloses)
                    close(scope, clipper, envelope_[f], s, outlines, overlaid.below);
            }
            if (outlines.size() == 0) continue;
            mark_used(scope, outlines);
            scope.commit(geometry_);
            share(scope, outlines);
            for (std::size_t i = 0; i < outlines.size(); ++i)
                overlaid.below.outlines.add(outlines[i]);
        }
        resize_lines();
        // special pieces of triangles that are not
        {
            LocalArrangement scope(geometry_);
            const PiecesBelow& below = overlaid.below;
            for (std::size_t i = 0; i < below.polygon.size(); ++i) {
                const std::size_t t = index(below.polygon[i]);
                add_to_chains(scope, s, t, below.outlines[i]);
                if (use[t] == kElsewhere)
                    pending_.add(below.outlines[i], s.plane[t], k_, below.node_above[i],
                                 node_of_[t]);
            }
        }
        const PiecesOfPolygons pieces = sort_by_polygon(overlaid.below, s.plane.size(), execution_);
        add_surface_facets({s, k_}, use, overlaid.below, pieces, overlaid.remaining, execution_);
        special_ = std::move(overlaid.remaining);
        std::erase_if(envelope_, [](const Facet& f) { return f.state == Facet::kCloses; });
        for (Facet& f : envelope_)
            f.block = k_;
        for (std::size_t t = 0; t < s.plane.size(); ++t) {
            if (node_of_[t] < 0) continue;
            envelope_.push_back(facet_of(s, t, node_of_[t]));
        }
    }

    /// Special facets that were closed as a whole: their nodes, for the walls to others.
    void name_nodes_beneath(std::size_t first_face) {
        const FaceList& faces = construction_.faces;
        for (std::size_t f = first_face; f < faces.size(); ++f) {
            if (faces.below[f] < 0) continue;
            const PlaneId plane = faces.plane[f];
            const auto& v = geometry_.plane(plane).plan;
            for (std::size_t i = 0; i < 3; ++i) {
                const std::size_t to = i < 2 ? i + 1 : 0;
                const auto line = geometry_.add_edge(v[i], v[to]);
                if (!is_generic(line.id())) continue;
                FacetEdge& way = edges_[index(line.id())];
                if (way.layer != k_ || way.cell == faces.below[f]) continue;
                if (way.cell >= 0)
                    edge_is_special_[index(line.id())] = 1;  // both of its facets are
                way.cell = faces.below[f];
            }
        }
    }

    /// Corners of a special piece that lie on edges of the surface whose walls are made here.
    void add_to_chains(LocalArrangement& scope, const SurfaceTiling& s, std::size_t t,
                       PolygonView outline) {
        for (std::size_t i = 0; i < outline.size(); ++i) {
            const PointId id = outline[i].point;
            if (geometry_.is_vertex(id)) continue;
            for (const auto line :
                 {outline[i].line.id(), outline[i > 0 ? i - 1 : outline.size() - 1].line.id()}) {
                const exact::Line& edge = geometry_.line(line);
                if (!edge.is_edge() || !is_generic(line)) continue;
                const auto name = geometry_.plane(s.plane[t]).above(edge);
                if (!name.is_edge()) continue;
                const exact::Point& p = geometry_.point(id);
                bool is_known = false;
                for (std::int32_t c = chains_[index(line)]; c >= 0 && !is_known;
                     c = chain_nodes_[index(c)].next) {
                    const auto& at = complex_.vertices[index(chain_nodes_[index(c)].vertex)];
                    is_known = at[0] == p.x && at[1] == p.y;
                }
                if (is_known) continue;
                const double z = scope.rounded_height(s.plane[t], name, id, scope.approximate(id));
                chain_nodes_.push_back({add_vertex(p.x, p.y, z), chains_[index(line)]});
                chains_[index(line)] = static_cast<std::int32_t>(chain_nodes_.size()) - 1;
            }
        }
    }

    void leave_out_open_nodes() {
        const auto is_left = [&](std::int32_t node) {
            return node >= 0 && is_open_[index(node)] != 0;
        };
        for (auto* nodes : {&construction_.faces.above, &construction_.faces.below}) {
            for (std::int32_t& node : *nodes) {
                if (is_left(node)) node = kOutsideCell;
            }
        }
        for (std::size_t f = 0; f < complex_.face_cells.size(); ++f) {
            auto& cells = complex_.face_cells[f];
            if (cells[0] == kDead || !is_left(cells[0])) continue;
            if (cells[1] < 0) {
                cells = {kDead, kDead};
                continue;
            }
            cells = {cells[1], -1};
            const std::size_t end = f + 1 < complex_.face_offsets.size()
                                        ? static_cast<std::size_t>(complex_.face_offsets[f + 1])
                                        : complex_.face_vertices.size();
            std::reverse(complex_.face_vertices.begin() + complex_.face_offsets[f],
                         complex_.face_vertices.begin() + end);
        }
    }

    /// Special faces may have got corners on edges above, whose walls were made: these get them.
    void divide_walls() {
        struct Corner {
            std::int32_t line, face;
            PointId point;
        };
        resize_lines();
        const FaceList& faces = construction_.faces;
        std::vector<Corner> corners;
        for (std::size_t f = 0; f < faces.size(); ++f) {
            const std::size_t begin = faces.polygons.offsets[f],
                              end = faces.polygons.offsets[f + 1];
            for (std::size_t c = begin; c < end; ++c) {
                const auto line = faces.polygons.lines[c].id();
                if (wall_of_[index(line)] < 0 ||
                    geometry_.plane(faces.plane[f]).above(geometry_.line(line)).is_edge())
                    continue;
                for (const std::size_t i : {c, c + 1 < end ? c + 1 : begin}) {
                    const PointId point = faces.polygons.points[i];
                    if (!geometry_.is_vertex(point))
                        corners.push_back({line.number(), static_cast<std::int32_t>(f), point});
                }
            }
        }
        std::ranges::sort(corners, [](const Corner& a, const Corner& b) {
            return std::pair(a.line, a.point) < std::pair(b.line, b.point);
        });
        LocalArrangement scope(geometry_);
        for (std::size_t begin = 0, end = 0; begin < corners.size(); begin = end) {
            while (end < corners.size() && corners[end].line == corners[begin].line)
                ++end;
            const std::size_t wall = index(wall_of_[index(corners[begin].line)]);
            const auto from = complex_.face_vertices.begin() + complex_.face_offsets[wall];
            const auto to = wall + 1 < complex_.face_offsets.size()
                                ? complex_.face_vertices.begin() + complex_.face_offsets[wall + 1]
                                : complex_.face_vertices.end();
            const auto at = [&](std::int32_t v) -> const auto& {
                return complex_.vertices[index(v)];
            };
            const auto is_above = [&](std::int32_t a, std::int32_t b) {
                return at(a)[0] == at(b)[0] && at(a)[1] == at(b)[1];
            };
            face_.assign(from, to);
            std::size_t lower = 1;
            while (!is_above(face_[lower - 1], face_[lower]))
                ++lower;
            const std::size_t known = lower;
            for (std::size_t i = begin; i < end; ++i) {
                const exact::Point& p = geometry_.point(corners[i].point);
                const auto is_there = [&](std::int32_t v) {
                    return at(v)[0] == p.x && at(v)[1] == p.y;
                };
                if (std::any_of(face_.begin(), face_.begin() + static_cast<std::ptrdiff_t>(lower),
                                is_there))
                    continue;
                const PlaneId plane = construction_.faces.plane[index(corners[i].face)];
                const double z = scope.rounded_height(plane, corners[i].point);
                face_.insert(face_.begin() + static_cast<std::ptrdiff_t>(lower++),
                             add_vertex(p.x, p.y, z));
            }
            if (lower == known) continue;
            const auto p = at(face_[0]), q = at(face_[known - 1]);
            const std::size_t axis = std::abs(q[0] - p[0]) > std::abs(q[1] - p[1]) ? 0 : 1;
            const double sign = q[axis] > p[axis] ? 1 : -1;
            std::sort(face_.begin(), face_.begin() + static_cast<std::ptrdiff_t>(lower),
                      [&](std::int32_t a, std::int32_t b) {
                          return sign * at(a)[axis] < sign * at(b)[axis];
                      });
            const auto cells = complex_.face_cells[wall];
            complex_.face_cells[wall] = {kDead, kDead};
            add_face(face_, cells[0], cells[1], kWall);
        }
    }

    /// Faces that are special, with the walls on their lines.
    CellComplex conform_special() {
        geometry_.forget_names();
        std::vector<std::uint8_t> left_out(geometry_.line_count());
        for (std::size_t l = 0; l < left_out.size(); ++l)
            left_out[l] = is_generic(exact::LineId(l)) ? 1 : 0;
        FaceList& faces = construction_.faces;
        special_faces = faces.size();
        PlanVertices plan_vertices;
        ConformedFaces conformed;
        WallLists walls;
        std::vector<ExtraPoint> crossings;
        for (;;) {
            plan_vertices = find_plan_vertices(geometry_, faces, crossings, execution_);
            CollinearEdges lines =
                find_collinear_edges(geometry_, faces, plan_vertices, crossings,
                                     &construction_.node_is_thick, execution_, &left_out);
            conformed = conform_faces(geometry_, faces, plan_vertices, lines, execution_,
                                      &faces.polygons.points);
            walls = find_walls(geometry_, faces, lines, conformed, nullptr, execution_);
            if (walls.missing.empty()) break;
            faces.polygons.points = points_of_corners(plan_vertices, conformed, execution_);
            crossings.insert(crossings.end(), walls.missing.begin(), walls.missing.end());
            left_out.resize(geometry_.line_count());
        }
        set_plan_positions(geometry_, plan_vertices, execution_);
        set_vertex_positions(plan_vertices, conformed, execution_);
        make_distinct(geometry_, faces, plan_vertices, conformed, nullptr, execution_);
        return assemble(faces, context_.surface_of_plane, std::move(conformed),
                        std::move(walls.walls), {}, execution_);
    }

    static std::uint64_t hash_of(const std::array<double, 3>& p) {
        std::array<std::uint64_t, 3> bits;
        std::memcpy(bits.data(), p.data(), sizeof bits);
        std::uint64_t h = bits[0] * 0x9E3779B97F4A7C15u ^ bits[1] * 0xC2B2AE3D27D4EB4Fu ^
                          bits[2] * 0x165667B19E3779F9u;
        return h ^ h >> 32;
    }

    /// Puts the special faces behind the others. Vertices in one position are one.
    void join(const CellComplex& rest) {
        std::size_t size = 64;
        while (size < 2 * rest.vertices.size())
            size *= 2;
        std::vector<std::int32_t> table(size, -1), number(rest.vertices.size(), -1);
        for (std::size_t v = 0; v < rest.vertices.size(); ++v) {
            std::size_t at = hash_of(rest.vertices[v]) & (size - 1);
            while (table[at] >= 0)
                at = (at + 1) & (size - 1);
            table[at] = static_cast<std::int32_t>(v);
        }
        std::vector<std::uint64_t> bits(size / 16);  // most are in none of these positions
        for (const auto& p : rest.vertices) {
            const std::uint64_t h = hash_of(p) >> 20 & (size * 4 - 1);
            bits[h / 64] |= std::uint64_t{1} << h % 64;
        }
        for (std::size_t v = 0; v < complex_.vertices.size(); ++v) {
            const auto& p = complex_.vertices[v];
            const std::uint64_t h = hash_of(p) >> 20 & (size * 4 - 1);
            if ((bits[h / 64] >> h % 64 & 1) == 0) continue;
            for (std::size_t at = hash_of(p) & (size - 1); table[at] >= 0;
                 at = (at + 1) & (size - 1)) {
                if (rest.vertices[index(table[at])] != p) continue;
                if (number[index(table[at])] < 0)
                    number[index(table[at])] = static_cast<std::int32_t>(v);
                break;
            }
        }
        for (std::size_t v = 0; v < number.size(); ++v) {
            if (number[v] < 0)
                number[v] =
                    add_vertex(rest.vertices[v][0], rest.vertices[v][1], rest.vertices[v][2]);
        }
        // nodes that are cells
        std::vector<std::int32_t> cell(construction_.node_block.size(), -1);
        for (std::size_t n = 0; n < cell.size(); ++n) {
            if (is_open_[n] != 0) continue;
            cell[n] = static_cast<std::int32_t>(complex_.cell_block.size());
            complex_.cell_block.push_back(construction_.node_block[n]);
        }
        const auto cell_at = [&](std::int32_t node) { return node < 0 ? -1 : cell[index(node)]; };
        complex_.face_offsets.push_back(static_cast<std::int64_t>(complex_.face_vertices.size()));
        std::size_t face = 0;
        std::int64_t corner = 0;
        for (std::size_t f = 0; f < complex_.face_cells.size(); ++f) {
            const auto cells = complex_.face_cells[f];
            if (cells[0] == kDead) continue;
            const std::int64_t begin = complex_.face_offsets[f], end = complex_.face_offsets[f + 1];
            if (corner != begin)
                std::copy(complex_.face_vertices.begin() + begin,
                          complex_.face_vertices.begin() + end,
                          complex_.face_vertices.begin() + corner);
            complex_.face_offsets[face] = corner;
            complex_.face_surface[face] = complex_.face_surface[f];
            complex_.face_cells[face++] = {cell_at(cells[0]), cell_at(cells[1])};
            corner += end - begin;
        }
        complex_.face_vertices.resize(static_cast<std::size_t>(corner));
        complex_.face_offsets.resize(face);
        complex_.face_cells.resize(face);
        complex_.face_surface.resize(face);
        for (std::size_t f = 0; f < rest.face_cells.size(); ++f) {
            complex_.face_offsets.push_back(
                static_cast<std::int64_t>(complex_.face_vertices.size()));
            for (std::int64_t i = rest.face_offsets[f]; i < rest.face_offsets[f + 1]; ++i)
                complex_.face_vertices.push_back(
                    number[index(rest.face_vertices[static_cast<std::size_t>(i)])]);
            complex_.face_cells.push_back(
                {cell_at(rest.face_cells[f][0]), cell_at(rest.face_cells[f][1])});
            complex_.face_surface.push_back(rest.face_surface[f]);
        }
        complex_.face_offsets.push_back(static_cast<std::int64_t>(complex_.face_vertices.size()));
    }

    decltype(Facet::state) classify(LocalArrangement& scope, const Facet& facet,
                                    const SurfaceTiling& s) {
        if (!walk_around(scope, s, facet)) return Facet::kSpecial;
        find_stretches(facet);
        if (!find_met(s)) return Facet::kSpecial;
        std::size_t below = 0, above = 0, all = 0;
        for_each_met([&](std::int32_t t) {
            const int at = compare(scope, s, t, facet);
            below += at > 0 ? 1 : 0;
            above += at < 0 ? 1 : 0;
            ++all;
        });
        return below == all ? Facet::kCloses : (above == all ? Facet::kStays : Facet::kSpecial);
    }

    void close(LocalArrangement& scope, Clipper& clipper, const Facet& facet,
               const SurfaceTiling& s, PolygonPool& outlines, PiecesBelow& special_pieces) {
        ++closed;
        construction_.node_block[index(facet.cell)] = facet.block;
        is_open_[index(facet.cell)] = 0;
        outlines_[index(facet.cell)] = {facet.corner};
        for (std::size_t i = 0; i < 3; ++i)
            corner_[i] = projected_vertex(scope, s, facet.corner[i].point);
        find_stretches(facet);
        find_met(s);
        const auto face_beneath = [&](std::int32_t t) {
            if (node_of_[index(t)] >= 0) {
                add_face(face_, node_of_[index(t)], facet.cell, k_);
                return;
            }
            clipper.begin(facet.corner);
            outlines.add(clipper.intersect(triangle(s, t)));
            special_pieces.polygon.push_back(t);
            special_pieces.node_above.push_back(facet.cell);
        };
        const auto vertex = [&](std::uint32_t crossing, std::uint32_t edge) {
            return crossing_vertex(scope, s, facet.corner[edge].line.id(), crossing);
        };
        for (const Met& met : met_) {
            face_.clear();
            if (stretches_.size() == 1) face_.assign(corner_.begin(), corner_.end());
            for (std::size_t o = met.first; o < met.end && stretches_.size() > 1; ++o) {
                const Stretch& part = stretch(o);
                if (part.first_corner > 0)
                    face_.push_back(vertex(part.crossing_in, part.first_corner - 1));
                face_.insert(face_.end(), corner_.begin() + part.first_corner,
                             corner_.begin() + part.end_corner);
                if (part.out.triangle < 0) continue;
                face_.push_back(vertex(part.crossing_out, part.end_corner - 1));
                const std::uint32_t in = next_in(met, o);
                for (std::uint32_t c = part.out.corner; c != in;) {
                    c = after(c);
                    face_.push_back(surface_vertex(s, met.triangle, c));
                }
            }
            face_beneath(met.triangle);
        }
        for (const std::int32_t t : inside_) {
            face_.clear();
            for (std::uint32_t c = 0; c < 3; ++c)
                face_.push_back(surface_vertex(s, t, c));
            face_beneath(t);
        }
        for (std::size_t i = 0; i < 3; ++i)
            add_wall(scope, facet, s, i);
    }

    /// The wall beneath an edge, once both facets are closed.
    void add_wall(LocalArrangement& scope, const Facet& facet, const SurfaceTiling& s,
                  std::size_t i) {
        const DirectedLine line = facet.corner[i].line;
        if (!is_generic(line.id())) return;
        FacetEdge& way = edges_[index(line.id())];
        if (way.cell < 0) {
            way.cell = facet.cell;
            return;
        }
        // the lower edge forward, then the upper one back
        const std::size_t to = i < 2 ? i + 1 : 0;
        face_.clear();
        face_.push_back(corner_[i]);
        for_each_crossing(line, [&](std::uint32_t number, bool) {
            face_.push_back(crossing_vertex(scope, s, line.id(), number));
        });
        face_.push_back(corner_[to]);
        face_.push_back(facet.vertex[to]);
        const std::size_t first = face_.size();
        for (std::int32_t c = chains_[index(line.id())]; c >= 0; c = chain_nodes_[index(c)].next)
            face_.push_back(chain_nodes_[index(c)].vertex);
        if (face_.size() > first + 1) {
            const auto &p = complex_.vertices[index(facet.vertex[i])],
                       &q = complex_.vertices[index(facet.vertex[to])];
            const std::size_t axis = std::abs(q[0] - p[0]) > std::abs(q[1] - p[1]) ? 0 : 1;
            const double sign = q[axis] > p[axis] ? -1 : 1;
            std::sort(face_.begin() + static_cast<std::ptrdiff_t>(first), face_.end(),
                      [&](std::int32_t a, std::int32_t b) {
                          return sign * complex_.vertices[index(a)][axis] <
                                 sign * complex_.vertices[index(b)][axis];
                      });
        }
        face_.push_back(facet.vertex[i]);
        wall_of_[index(line.id())] = static_cast<std::int32_t>(complex_.face_cells.size());
        add_face(face_, facet.cell, way.cell, kWall);
    }

    struct ChainNode {
        std::int32_t vertex, next;
    };

    PlanContext& context_;
    Execution execution_;
    std::array<double, 6>& seconds_;
    CellComplex complex_;
    std::vector<Facet> envelope_;  ///< of it what is not special
    Envelope special_;
    Construction construction_;
    FaceList pending_;                       ///< special faces above facets that are not
    std::vector<FacetOutline> outlines_;     ///< of each node that was closed here
    std::vector<std::uint8_t> is_open_;      ///< of each node
    std::vector<std::int32_t> faces_above_;  ///< of each node: the last one
    Array<std::int32_t> next_above_;         ///< of each face: the one before it above its node
    std::vector<std::int32_t> node_of_;
    std::vector<std::int32_t> lower_;            ///< of each plan vertex: its vertex on the surface
    std::vector<std::int32_t> wall_of_;          ///< of each line: a face
    std::vector<std::uint8_t> edge_is_special_;  ///< of each line
    std::vector<std::uint8_t> divided_;
    std::vector<std::int32_t>
        chains_;  ///< of each line: the last vertex that faces above have on it
    std::vector<ChainNode> chain_nodes_;
    std::vector<std::int32_t> face_;
    std::array<std::int32_t, 3> corner_{};
};

struct Built {
    CellComplex complex;
    std::array<std::size_t, 4> counts;
};
Built build_in_one_pass(std::span<const StackInput> input, const Execution& execution,
                        std::array<double, 6>& seconds) {
    const double start = now();
    const PlanSnapping snapping = find_snapping(input, execution);
    const BorderChains chains = find_chains(input, snapping, execution);
    std::vector<Warning> warnings;
    const auto context = load_input(input, {}, warnings, execution);
    context->geometry.expect_lines(4 * context->geometry.point_count());
    seconds[0] += now() - start;
    OnePass pass(*context, execution, seconds);
    CellComplex complex = pass.run();
    return {std::move(complex), {pass.facets, pass.closed, pass.special, pass.special_faces}};
}

std::uint64_t mix(std::uint64_t h) {
    h ^= h >> 31;
    h *= 0x9E3779B97F4A7C15u;
    h ^= h >> 29;
    return h * 0xBF58476D1CE4E5B9u;
}

/// Of each cell a number that no order of faces and vertices changes.
std::vector<std::uint64_t> cell_numbers(const CellComplex& complex) {
    std::vector<std::uint64_t> vertex(complex.vertices.size());
    for (std::size_t v = 0; v < vertex.size(); ++v) {
        std::uint64_t h = 1;
        for (const double c : complex.vertices[v]) {
            std::uint64_t bits = 0;
            std::memcpy(&bits, &c, sizeof bits);
            h = mix(h + bits);
        }
        vertex[v] = h;
    }
    std::vector<std::uint64_t> cell(complex.cell_block.size());
    for (std::size_t f = 0; f < complex.face_cells.size(); ++f) {
        std::array<std::uint64_t, 2> sum{};
        const auto begin = static_cast<std::size_t>(complex.face_offsets[f]),
                   end = static_cast<std::size_t>(complex.face_offsets[f + 1]);
        for (std::size_t i = begin; i < end; ++i) {
            const std::uint64_t a = vertex[index(complex.face_vertices[i])];
            const std::uint64_t b =
                vertex[index(complex.face_vertices[i + 1 < end ? i + 1 : begin])];
            sum[0] += mix(a + 3 * b);
            sum[1] += mix(b + 3 * a);
        }
        for (std::size_t side = 0; side < 2; ++side) {
            const std::int32_t c = complex.face_cells[f][side];
            const auto surface = static_cast<std::uint64_t>(complex.face_surface[f] + 7);
            if (c >= 0) cell[index(c)] += mix(sum[side] + mix(surface));
        }
    }
    for (std::size_t c = 0; c < cell.size(); ++c)
        cell[c] = mix(cell[c] + static_cast<std::uint64_t>(complex.cell_block[c]));
    return cell;
}

}  // namespace

int main(int count, char** arguments) {
    const auto number = [&](int i, int otherwise) {
        return count > i ? std::atoi(arguments[i]) : otherwise;
    };
    const int surfaces = number(1, 10), quads = number(2, 60), pairs = number(3, 3);
    const double spacing = count > 4 ? std::atof(arguments[4]) : 0.05;
    std::mt19937_64 random(1);
    std::vector<Surface> made;
    for (int k = 0; k < surfaces; ++k)
        made.push_back(make_surface(quads, k, spacing, random));
    std::vector<StackInput> input(1);
    for (const Surface& surface : made)
        input[0].surfaces.push_back({surface.vertices, surface.triangles});
    input[0].rules.assign(made.size(), Rule::kErosional);
    const Execution execution{1, nullptr};
    for (int pair = 0; pair < std::max(pairs, 1); ++pair) {
        std::array<double, 6> seconds{};
        std::array<double, 2> all{};
        std::vector<std::uint64_t> known, finished;
        std::array<std::size_t, 4> counts{};
        for (int turn = 0; turn < 2; ++turn) {
            const double start = now();
            if (pairs == 0 && turn == 0) continue;
            if ((turn + pair) % 2 == 0) {
                const CellComplex complex = build_rock_masses(input, execution);
                all[0] = now() - start;
                known = cell_numbers(complex);
                std::ranges::sort(known);
                std::printf("library:  %zu vertices, %zu faces, %zu corners, %zu cells\n",
                            complex.vertices.size(), complex.face_cells.size(),
                            complex.face_vertices.size(), complex.cell_block.size());
            } else {
                const Built built = build_in_one_pass(input, execution, seconds);
                all[1] = now() - start;
                finished = cell_numbers(built.complex);
                counts = built.counts;
                std::printf("one pass: %zu vertices, %zu faces, %zu corners, %zu cells\n",
                            built.complex.vertices.size(), built.complex.face_cells.size(),
                            built.complex.face_vertices.size(), built.complex.cell_block.size());
            }
        }
        const auto same = std::ranges::count_if(
            finished, [&](std::uint64_t cell) { return std::ranges::binary_search(known, cell); });
        std::printf("%zu facets: %zu closed, %zu special; %zu special faces\n", counts[0],
                    counts[1], counts[2], counts[3]);
        std::printf(
            "library %.3f s, one pass %.3f s (input %.3f, tilings %.3f, pass %.3f, special faces "
            "%.3f, joining %.3f, volumes %.3f): %.3f of the time; %zu cells, %td of %zu the "
            "library's\n",
            all[0], all[1], seconds[0], seconds[1], seconds[2], seconds[4], seconds[5], seconds[3],
            all[1] / all[0], finished.size(), same, known.size());
    }
    return 0;
}
