// SPDX-License-Identifier: GPL-3.0-or-later
// The exact overlay of a model's faces with the triangles of a cutter.
#include "cutting/cutter_overlay.hpp"

#include "base/algorithms.hpp"
#include "base/floating_point.hpp"
#include "base/parallel.hpp"
#include "base/parallel_sort.hpp"
#include "exact/orientation.hpp"

namespace realmodel::cutting {

using arrangement::EdgeUse;
using arrangement::TriangleArrangement;
using spatial::Box;
using spatial::BoxTree;

namespace {

double computed_ulps(double x) {
    return kComputedUlps * ulp(x);
}

}  // namespace

CutterOverlay::CutterOverlay(const ComplexView& model, const Cutter& cutter,
                             const Execution& execution, double least_rounding,
                             std::span<const std::int32_t> groups, const FarFaces& far)
    : model_(model),
      cutter_(cutter),
      far_(far),
      execution_(execution),
      arrangement_(points_),
      margin_(least_rounding) {
    find_same_faces(!groups.empty());
    find_active_faces(groups);
    name_cutter();
    divide_active_faces();
    overlay_all();
    name_nodes();
}

namespace {

/// How far a vertex may be from where it is meant to be, on each axis.
Position tolerance_of(const Position& p) {
    return {computed_ulps(p[0]), computed_ulps(p[1]), computed_ulps(p[2])};
}

bool is_within(const Position& p, const Position& q, const Position& tolerance, double times) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (std::abs(q[k] - p[k]) > times * tolerance[k]) return false;
    }
    return true;
}

}  // namespace

/// Where on an edge of the cutter a vertex may be but for its rounding.
std::optional<CutterOverlay::CutterFeature> CutterOverlay::edge_near(const Position& p,
                                                                     const Position& tolerance,
                                                                     const Position& a,
                                                                     const Position& b) {
    // the part of the edge that is within the tolerance on every axis, and the axis that has it
    // shortest: there the point keeps the vertex's coordinate
    double from = 0, to = 1, shortest = HUGE_VAL;
    std::size_t axis = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double change = b[k] - a[k], off = p[k] - a[k];
        if (change == 0) {
            if (std::abs(off) > tolerance[k]) return std::nullopt;
            continue;
        }
        const double one = (off - tolerance[k]) / change, other = (off + tolerance[k]) / change;
        from = std::max(from, std::min(one, other));
        to = std::min(to, std::max(one, other));
        if (tolerance[k] / std::abs(change) >= shortest) continue;
        shortest = tolerance[k] / std::abs(change);
        axis = k;
    }
    const double share = (p[axis] - a[axis]) / (b[axis] - a[axis]);
    if (from > to || !(share > 0 && share < 1)) return std::nullopt;
    return CutterFeature{2, axis, {a, b}};
}

/// The same within a triangle of the cutter.
std::optional<CutterOverlay::CutterFeature> CutterOverlay::triangle_near(
    const Position& p, const Position& tolerance, const std::array<Position, 3>& corners) {
    constexpr double kRounding = 0x1p-50;  // of the distance
    const Position normal = polygon_normal(corners);
    double off = 0, allowed = 0, size = 0;
    std::size_t axis = 0;  // along which the point may be off most
    for (std::size_t k = 0; k < 3; ++k) {
        off += normal[k] * (p[k] - corners[0][k]);
        size += std::abs(normal[k] * (p[k] - corners[0][k]));
        allowed += std::abs(normal[k]) * tolerance[k];
        if (std::abs(normal[k]) * tolerance[k] > std::abs(normal[axis]) * tolerance[axis]) axis = k;
    }
    if (!(std::abs(off) <= allowed + kRounding * size) || allowed == 0) return std::nullopt;
    const View view(normal);
    for (std::size_t i = 0; i < 3; ++i) {
        if (exact::orient2d(view(corners[i]), view(corners[(i + 1) % 3]), view(p)) <= 0)
            return std::nullopt;
    }
    return CutterFeature{3, axis, corners};
}

/// Where on the cutter a vertex may be but for its rounding: at a corner, or on edges, then in
/// triangles.
std::vector<CutterOverlay::CutterFeature> CutterOverlay::features_near(NodeId vertex) const {
    std::vector<std::int32_t> near;
    const Position p = model_.vertex(vertex);
    tree_->find(Box{p, p}, [&](std::int32_t t) {
        if (!is_beside({&vertex, 1}, t)) near.push_back(t);
    });
    std::sort(near.begin(), near.end());
    const Position tolerance = tolerance_of(p);
    for (const std::int32_t t : near) {
        for (std::size_t i = 0; i < 3; ++i) {
            if (is_within(p, corner(t, i), tolerance, 1)) return {{1, 0, {corner(t, i)}}};
        }
    }
    std::vector<CutterFeature> features;
    for (const std::int32_t t : near) {
        for (std::size_t i = 0; i < 3; ++i) {
            if (const auto feature = edge_near(p, tolerance, corner(t, i), corner(t, i + 1)))
                features.push_back(*feature);
        }
    }
    for (const std::int32_t t : near) {
        if (const auto feature = triangle_near(p, tolerance, cutter_.corners(index(t))))
            features.push_back(*feature);
    }
    return features;
}

/// The point on the first of some features that is indeed as near to a vertex; none where all are
/// farther.
std::optional<SpacePointId> CutterOverlay::point_on_cutter(
    const Position& p, std::span<const CutterFeature> features) {
    for (const CutterFeature& feature : features) {
        const auto& [count, axis, corners] = feature;
        if (count == 1) return points_.add(corners[0]);
        std::array<SpacePointId, 4> of{points_.add(p)};
        for (std::size_t i = 0; i < count; ++i)
            of[i + 1] = points_.add(corners[i]);
        const SpacePointId point = count == 2 ? points_.projected(axis, of[0], of[1], of[2])
                                              : points_.projected(axis, of[0], of[1], of[2], of[3]);
        if (is_within(p, points_.rounded(point), tolerance_of(p), 3)) return point;
    }
    return std::nullopt;
}

/// Gives the vertices of active faces exact points: where they are, or where they are but for their
/// rounding. No two share one.
void CutterOverlay::name_vertices_of(std::span<const std::int32_t> faces) {
    std::vector<std::uint8_t> is_new(vertex_point_.size(), 0);
    for (const std::int32_t f : faces) {
        for (const NodeId v : model_.face(index(f)))
            is_new[index(v)] = vertex_point_[index(v)] == kNone ? 1 : 0;
    }
    std::vector<NodeId> vertices;
    for (std::size_t v = 0; v < is_new.size(); ++v) {
        if (is_new[v] != 0) vertices.push_back(static_cast<NodeId>(v));
    }
    const auto is_taken = [this](SpacePointId p) -> std::uint8_t& {
        if (is_taken_.size() <= index(p)) is_taken_.resize(points_.size());
        return is_taken_[index(p)];
    };
    for (const NodeId v : vertices)
        is_taken(vertex_point_[index(v)] = points_.add(model_.vertex(v))) = 1;
    std::vector<std::vector<CutterFeature>> features(vertices.size());
    parallel_ranges(
        vertices.size(), 1 << 10, execution_,
        [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                features[i] = features_near(vertices[i]);
        },
        0.02);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        if (features[i].empty()) continue;
        poll(execution_.progress, 16 * i);
        SpacePointId& point = vertex_point_[index(vertices[i])];
        const auto on_cutter = point_on_cutter(model_.vertex(vertices[i]), features[i]);
        if (!on_cutter || *on_cutter == point || is_taken(*on_cutter) != 0) continue;
        is_taken(point) = 0;
        is_taken(*on_cutter) = 1;
        point = *on_cutter;
    }
}

void CutterOverlay::overlay_all() {
    add_triangles();
    // Which intersect is found out on all threads; where they do is entered in order.
    const auto count = index(first_cutter_) + divided_.size();
    std::vector<std::int32_t> number_of(cutter_.triangles.size(), -1);
    for (std::size_t i = 0; i < divided_.size(); ++i)
        number_of[index(divided_[i])] = first_cutter_ + static_cast<std::int32_t>(i);
    for (const CrossedFace& cut : division_.crossed)
        arrangement_.add_line(number_of[index(cut.triangle)], cut.ends[0], cut.ends[1]);
    begin_phase(execution_.progress, 0.08, 0.15, "finding where surface and faces meet");
    const auto positions_of = [this](std::int32_t t) {
        const auto& corners = arrangement_.corners(t);
        return std::array{points_.rounded(corners[0]), points_.rounded(corners[1]),
                          points_.rounded(corners[2])};
    };
    const auto box_of = [&](std::int32_t t) { return spatial::bounding_box(positions_of(t)); };
    // triangles of the cutter that cross each other beyond the model are left alone, unless one of
    // them reaches it
    std::vector<std::uint8_t> is_beyond(count, 0);
    for (std::size_t t = index(first_cutter_); t < count; ++t)
        is_beyond[t] = box_of(static_cast<std::int32_t>(t)).meets(model_box_) ? 0 : 1;
    using TriangleIntersection = TriangleArrangement::TriangleIntersection;
    const auto find = [&](std::size_t begin, std::size_t end,
                          std::vector<TriangleIntersection>& crossings) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto t = static_cast<std::int32_t>(i);
            const PlaneOutline outline(positions_of(t), margin_);
            tree_->find(box_of(t), [&](std::int32_t c) {
                const std::int32_t other = number_of[index(c)];  // -1 where nothing meets it
                if (other <= t || (is_beyond[i] != 0 && is_beyond[index(other)] != 0) ||
                    outline.is_surely_beside(positions_of(other)))
                    return;
                if (const auto met = arrangement_.intersection(t, other)) crossings.push_back(*met);
            });
        }
    };
    constexpr std::size_t kChunk = 1 << 8;
    const auto met = collect_ranges<TriangleIntersection>(count, kChunk, execution_, find);
    begin_phase(execution_.progress, 0.15, 0.3, "dividing faces and surface");
    points_.reserve_intersections(met.size());  // each is an end of two segments
    for (std::size_t i = 0; i < met.size(); ++i) {
        poll(execution_.progress, i << 8);  // points take time
        arrangement_.insert(met[i]);
    }
    arrangement_.divide(execution_);
}

/// The triangles of active faces, then those of the cutter.
void CutterOverlay::add_triangles() {
    std::vector<std::array<SpacePointId, 3>> corners;
    corners.reserve(division_.triangles.size() + divided_.size());
    for (const auto& t : division_.triangles) {
        corners.push_back(
            {vertex_point_[index(t[0])], vertex_point_[index(t[1])], vertex_point_[index(t[2])]});
    }
    division_.triangles = {};
    first_cutter_ = checked_number(corners.size(), "triangles");
    for (std::int32_t t = 0; index(t) < cutter_.triangles.size(); ++t) {
        if (undivided_.has(t)) continue;
        divided_.push_back(t);
        corners.push_back(cutter_points(t));
    }
    arrangement_.add_all(corners, execution_);
}

/// Numbers all nodes: the model's vertices keep theirs, the others follow.
void CutterOverlay::name_nodes() {
    std::vector<NodeId> out(points_.size(), -1);
    for (std::size_t v = 0; v < vertex_point_.size(); ++v) {
        if (vertex_point_[v] != kNone) out[index(vertex_point_[v])] = static_cast<NodeId>(v);
    }
    const auto node_of = [&](SpacePointId p) {
        NodeId& node = out[index(p)];
        if (node < 0) {
            node = add_node(points_.rounded(p));
            exact_of_new_.push_back(p);
        }
        return node;
    };
    const auto& of_points = arrangement_.regions().loops;
    loops_.loop_begins = of_points.loop_begins;
    loops_.region_begins = of_points.region_begins;
    loops_.nodes.resize(of_points.nodes.size());
    std::ranges::transform(of_points.nodes, loops_.nodes.begin(), node_of);
    cutter_nodes_.assign(cutter_.vertices.size(), -1);
    for (std::size_t component = 0; component < undivided_.components(); ++component) {
        for (const std::int32_t t : undivided_.triangles(component)) {
            for (const std::int32_t vertex : cutter_.triangles[index(t)])
                cutter_nodes_[index(vertex)] = node_of(cutter_point_[index(vertex)]);
        }
    }
    for (std::size_t i = 0; i < division_.beside.size(); ++i) {
        loops_.add_loop(division_.beside[i]);
        loops_.end_region();
    }
    division_.beside = {};
    for (std::size_t i = 0; i < division_.crossed.size(); ++i)
        add_halves(division_.crossed[i], arrangement_.within_line(static_cast<std::int32_t>(i)),
                   out);
    sort_new_nodes();
    // edges and sides number regions and then faces in one row
    checked_number(size() + model_.face_count() + cutter_.triangles.size(),
                   "faces and their parts");
}

/// Adds both halves of a crossed face as regions.
/// @param within  the points between its ends, from the lesser to the greater
void CutterOverlay::add_halves(const CrossedFace& cut, std::span<const SpacePointId> within,
                               std::span<const NodeId> node_of_point) {
    std::vector<SpacePointId> line{std::min(cut.ends[0], cut.ends[1])};
    line.insert(line.end(), within.begin(), within.end());
    line.push_back(std::max(cut.ends[0], cut.ends[1]));
    const auto corners = model_.face(index(cut.face));
    for (std::size_t k = 0; k < 2; ++k) {
        for (std::size_t i = cut.after[k]; i != cut.after[1 - k]; i = (i + 1) % corners.size())
            loops_.nodes.push_back(corners[i]);
        if (line[0] != cut.ends[1 - k]) std::ranges::reverse(line);
        for (const SpacePointId p : line)
            loops_.nodes.push_back(node_of_point[index(p)]);
        loops_.end_loop();
        loops_.end_region();
        division_.face_of_beside.push_back(cut.face);
    }
}

/// Numbers the new nodes in the order of their positions: whatever else there is elsewhere, what is
/// decided by numbers is decided alike.
void CutterOverlay::sort_new_nodes() {
    const auto first = static_cast<NodeId>(model_.vertex_count());
    std::vector<std::pair<Position, NodeId>> order;
    for (std::size_t i = 0; i < new_positions_.size(); ++i)
        order.push_back({new_positions_[i], static_cast<NodeId>(i)});
    parallel_sort(order, std::less<>(), execution_);
    std::vector<NodeId> number(order.size());
    std::vector<SpacePointId> exact(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        new_positions_[i] = order[i].first;
        exact[i] = exact_of_new_[index(order[i].second)];
        number[index(order[i].second)] = first + static_cast<NodeId>(i);
    }
    exact_of_new_ = std::move(exact);
    const auto renumber = [&](auto& nodes) {
        for (NodeId& node : nodes) {
            if (node >= first) node = number[index(node - first)];
        }
    };
    renumber(loops_.nodes);
    renumber(cutter_nodes_);
}

SpacePointId CutterOverlay::exact(NodeId node) {
    const auto vertices = static_cast<NodeId>(model_.vertex_count());
    if (node >= vertices) return exact_of_new_[index(node - vertices)];
    const SpacePointId known = vertex_point_[index(node)];
    return known != kNone ? known : points_.add(model_.vertex(node));
}

/// The corner of a polygon that is farthest from the line of one of its edges, as an exact point.
SpacePointId CutterOverlay::far_corner(std::span<const NodeId> polygon,
                                       const std::array<NodeId, 2>& edge) {
    const Position a = position(edge[0]), b = position(edge[1]);
    NodeId far_node = edge[0];
    double farthest = -1;
    for (const NodeId v : polygon) {
        const Position normal = polygon_normal(std::array{a, b, position(v)});
        const double away = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
        if (away > farthest) {
            farthest = away;
            far_node = v;
        }
    }
    return exact(far_node);
}

void CutterOverlay::find_fan(std::span<const EdgeUse> uses,
                             std::vector<arrangement::HalfPlane>& items,
                             arrangement::EdgeFan& fan) {
    const SpacePointId a = exact(uses[0].edge[0]), b = exact(uses[0].edge[1]);
    items.clear();
    for (const EdgeUse& use : uses) {
        const auto item = index(use.item);
        if (item >= size() + model_.face_count()) {
            const auto t = static_cast<std::int32_t>(item - size() - model_.face_count());
            items.push_back({far_corner(undivided_nodes(t), use.edge), -1, use.direction});
        } else if (item >= size()) {
            items.push_back({far_corner(model_.face(item - size()), use.edge), -1, use.direction});
        } else if (is_of_face(item)) {
            const auto loop = loops(item)[0];
            const auto beside = std::ranges::find_if(
                loop, [this](NodeId node) { return index(node) >= model_.vertex_count(); });
            items.push_back({far_corner({loop.begin(), beside}, use.edge), -1, use.direction});
        } else {
            const std::int32_t t = triangle(item);
            const bool ahead = use.direction > 0;
            items.push_back(
                {arrangement_.left_corner(t, ahead ? a : b, ahead ? b : a), t, use.direction});
        }
    }
    arrangement::find_fan(points_, a, b, items, fan);
}

std::pair<std::size_t, int> CutterOverlay::view_of(std::size_t region) const {
    if (!is_of_face(region)) return arrangement_.view_of(triangle(region));
    const View view(polygon_normal(
        transformed(loops_[region][0], [this](NodeId node) { return position(node); })));
    return {view.axis(), view.sign()};
}

/// Of a corner that turns left, the middle of the triangle that it cuts off; where the outline or a
/// hole reaches into that, the middle between the corner and what reaches in farthest.
SpacePointId CutterOverlay::inner_point(std::size_t region) {
    if (is_of_face(region)) return exact(loops_[region][0][0]);
    const auto [axis, facing] = view_of(region);
    const auto outline = loops_[region][0];
    const std::size_t k = (axis + 1) % 3, l = (axis + 2) % 3;
    const auto ring = transformed(outline, [this](NodeId node) { return exact(node); });
    std::size_t lowest = 0;
    for (std::size_t i = 1; i < ring.size(); ++i) {
        const int x = exact::compare(points_, k, ring[i], ring[lowest]);
        if (x < 0 || (x == 0 && exact::compare(points_, l, ring[i], ring[lowest]) < 0)) lowest = i;
    }
    // an outline may pass its lowest node twice: of the corners there, one that turns left
    SpacePointId a = kNone, c = kNone;
    const SpacePointId b = ring[lowest];
    for (std::size_t i = 0; i < ring.size(); ++i) {
        if (ring[i] != b) continue;
        a = ring[(i + ring.size() - 1) % ring.size()];
        c = ring[(i + 1) % ring.size()];
        if (facing * exact::orient2d(points_, axis, a, b, c) > 0) break;
    }
    SpacePointId farthest = kNone;
    for (const auto loop : loops_[region]) {
        for (const NodeId node : loop) {
            const SpacePointId p = exact(node);
            if (p == a || p == b || p == c) continue;
            if (facing * exact::orient2d(points_, axis, a, b, p) < 0 ||
                facing * exact::orient2d(points_, axis, b, c, p) < 0 ||
                facing * exact::orient2d(points_, axis, c, a, p) < 0)
                continue;
            if (farthest == kNone || exact::is_farther(points_, axis, c, a, p, farthest))
                farthest = p;
        }
    }
    return farthest == kNone ? points_.middle({a, b, c}) : points_.middle({b, b, farthest});
}

}  // namespace realmodel::cutting
