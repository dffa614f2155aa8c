// SPDX-License-Identifier: GPL-3.0-or-later
// Which faces of a model come near a cutter, and what of them does.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "base/algorithms.hpp"
#include "base/key_table.hpp"
#include "base/parallel.hpp"
#include "cutting/cutter_overlay.hpp"
#include "exact/orientation.hpp"

namespace realmodel::cutting {

using spatial::Box;
using spatial::BoxTree;

/// A plane, from which rounding may have moved what is in it.
class CutterOverlay::RoundedPlane {
public:
    /// @param margin  how far coordinates may be off
    RoundedPlane(const Position& origin, const Position& normal, double margin)
        : origin_(origin), normal_(normal), margin_(margin) {}
    /// The plane of a face.
    RoundedPlane(const ComplexView& model, std::span<const NodeId> polygon, double margin)
        : origin_(model.vertex(polygon[0])),
          normal_(polygon_normal(positions_of(model, polygon))),
          margin_(2 * margin) {
        for (const NodeId v : polygon) {
            const Position p = model.vertex(v);
            reach_ = std::max(reach_, std::abs(distance(p)) + rounding(p));
        }
    }
    /// Whether some corners surely are all on one side of it, farther than the face's are.
    template <class Corners, class PositionOf>
    bool is_beside(const Corners& corners, const PositionOf& position_of) const {
        int side = 0;
        for (const auto& corner : corners) {
            const Position& p = position_of(corner);
            const double off = distance(p), allowed = reach_ + rounding(p);
            const int side_here = off > allowed ? 1 : off < -allowed ? -1 : 0;
            if (side_here == 0 || side_here == -side) return false;
            side = side_here;
        }
        return true;
    }

private:
    double distance(const Position& p) const { return dot(normal_, minus(p, origin_)); }
    double rounding(const Position& p) const {
        constexpr double kRounding = 0x1p-46;  // of the normal, and of the distances
        double allowed = 0;
        for (std::size_t k = 0; k < 3; ++k)
            allowed += std::abs(normal_[k]) * (margin_ + kRounding * std::abs(p[k] - origin_[k]));
        return allowed;
    }

    Position origin_, normal_;
    double margin_, reach_ = 0;
};

void CutterOverlay::find_same_faces(bool may_repeat) {
    first_same_.resize(model_.face_count());
    std::iota(first_same_.begin(), first_same_.end(), 0);
    KeyTable first;
    for (std::int32_t f = 0; may_repeat && index(f) < model_.face_count(); ++f) {
        const auto face = model_.face(index(f));
        const auto entry =
            first.find_or_add(arrangement::loop_hash(face), f, [&](std::int32_t other) {
                return std::ranges::equal(face, model_.face(index(other)));
            });
        first_same_[index(f)] = entry.number;
    }
    same_faces_ = bucketize<std::int32_t>(model_.face_count(), [this](const auto& put) {
        for (std::size_t f = 0; f < first_same_.size(); ++f)
            put(index(first_same_[f]), static_cast<std::int32_t>(f));
    });
}

/// The faces that come near the cutter: near the box of one of its triangles, and not all to one
/// side of the triangle's plane. And the triangles that nothing meets.
void CutterOverlay::find_active_faces(std::span<const std::int32_t> groups) {
    margin_ = std::max(margin_, rounding_of(cutter_.vertices));
    model_box_ = far_.box();
    for (std::size_t v = 0; v < model_.vertex_count(); ++v)
        model_box_.include(model_.vertex(static_cast<NodeId>(v)));
    if (model_.vertex_count() > 0)
        margin_ = std::max(margin_, 4 * rounding_of(std::array{model_box_.low, model_box_.high}));
    model_box_.widen(margin_);
    std::vector<Box> boxes;
    for (std::size_t t = 0; t < cutter_.triangles.size(); ++t) {
        const auto corners = cutter_.corners(t);
        boxes.push_back(spatial::bounding_box(corners));
        boxes.back().widen(margin_);
        normals_.push_back(polygon_normal(corners));
    }
    tree_ = std::make_unique<BoxTree>(std::move(boxes), execution_);
    active_.assign(model_.face_count(), 0);
    std::vector<std::uint8_t> meets(groups.size(), 0);  // of triangles: whether a face may
    parallel_ranges(active_.size(), 1 << 12, execution_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f) {
            if (index(first_same_[f]) != f) continue;
            if (groups.empty()) {
                active_[f] = first_passed(model_.face(f)) >= 0 ? 1 : 0;
                continue;
            }
            std::optional<RoundedPlane> plane;
            for_each_near(model_.face(f), [&](std::int32_t t) {
                if (is_beside(model_.face(f), t)) return;
                active_[f] = 1;
                if (!plane) plane.emplace(model_, model_.face(f), margin_);
                if (!plane->is_beside(cutter_.corners(index(t)), std::identity()))
                    std::atomic_ref(meets[index(t)]).store(1, std::memory_order_relaxed);
            });
        }
    });
    if (!groups.empty())
        undivided_ = UndividedTriangles(cutter_, *tree_, std::move(meets), groups, execution_);
    for (std::size_t f = 0; f < active_.size(); ++f) {
        active_[f] = active_[index(first_same_[f])];
        if (active_[f] != 0 && index(first_same_[f]) == f)
            active_faces_.push_back(static_cast<std::int32_t>(f));
    }
}

/// Whether all corners of a polygon are on one side of the plane of a triangle, farther from it
/// than rounding may put them.
bool CutterOverlay::is_beside(std::span<const NodeId> polygon, std::int32_t t) const {
    return RoundedPlane(corner(t, 0), normals_[index(t)], margin_)
        .is_beside(polygon, [this](NodeId v) { return model_.vertex(v); });
}

/// Calls visit(triangle) for those whose boxes a polygon's meets.
template <class Visit>
void CutterOverlay::for_each_near(std::span<const NodeId> polygon, const Visit& visit) const {
    tree_->find(box_of(model_, polygon), visit);
}

/// The first triangle of the cutter that a polygon may pass, -1 none.
std::int32_t CutterOverlay::first_passed(std::span<const NodeId> polygon) const {
    std::int32_t first = INT32_MAX;
    for_each_near(polygon, [&](std::int32_t t) {
        if (t < first && !is_beside(polygon, t)) first = t;
    });
    return first == INT32_MAX ? -1 : first;
}

void CutterOverlay::FaceDivision::add(std::int32_t face, std::span<const LoopTriangle> more) {
    for (const auto& t : more) {
        triangles.push_back({t[0].node, t[1].node, t[2].node});
        face_of_triangle.push_back(face);
    }
}

void CutterOverlay::FaceDivision::add_beside(std::int32_t face, std::span<const NodeId> polygon) {
    beside.add(polygon);
    face_of_beside.push_back(face);
}

void CutterOverlay::FaceDivision::add(const FaceDivision& other) {
    triangles.insert(triangles.end(), other.triangles.begin(), other.triangles.end());
    face_of_triangle.insert(face_of_triangle.end(), other.face_of_triangle.begin(),
                            other.face_of_triangle.end());
    for (std::size_t i = 0; i < other.beside.size(); ++i)
        add_beside(other.face_of_beside[i], other.beside[i]);
    crossed.insert(crossed.end(), other.crossed.begin(), other.crossed.end());
}

/// Gives the corners of the cutter's triangles exact points.
void CutterOverlay::name_cutter() {
    cutter_point_.assign(cutter_.vertices.size(), kNone);
    for (const auto& triangle : cutter_.triangles) {
        for (const std::int32_t vertex : triangle) {
            SpacePointId& known = cutter_point_[index(vertex)];
            if (!known.has_value()) known = points_.add(cutter_.vertices[index(vertex)]);
        }
    }
}

/// Whether the line of an edge of a face passes through a triangle, beside its edges.
bool CutterOverlay::passes_within(NodeId a, NodeId b,
                                  const std::array<SpacePointId, 3>& triangle) const {
    std::array<int, 3> sides{};
    for (std::size_t i = 0; i < 3; ++i)
        sides[i] = exact::orient3d(points_, vertex_point_[index(a)], vertex_point_[index(b)],
                                   triangle[i], triangle[(i + 1) % 3]);
    return sides[0] != 0 && sides[1] == sides[0] && sides[2] == sides[0];
}

/// A face as a crossed one, without its ends; none where more meets it than that. Its corners are
/// all beside the plane of the triangle, which two of its edges pass: whatever its shape, that is
/// one line within it.
std::optional<CutterOverlay::CrossedFace> CutterOverlay::crossed(std::int32_t face) const {
    const auto polygon = model_.face(index(face));
    const auto corners = positions_of(model_, polygon);
    CrossedFace cut{face, -1};
    bool is_one = true;
    for_each_near(polygon, [&](std::int32_t t) {
        if (!is_one || is_beside(polygon, t) ||
            PlaneOutline(cutter_.corners(index(t)), margin_).is_surely_beside(corners))
            return;
        is_one = cut.triangle < 0;
        cut.triangle = t;
    });
    if (!is_one || cut.triangle < 0) return std::nullopt;
    const auto triangle = cutter_points(cut.triangle);
    const exact::SidesOfPlane side_of(points_, triangle);
    std::size_t changes = 0;
    NodeId before = polygon.back();
    int side_before = side_of(vertex_point_[index(before)]);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const int side = side_of(vertex_point_[index(polygon[i])]);
        if (side == 0) return std::nullopt;
        if (side != side_before) {
            if (changes == 2 || !passes_within(before, polygon[i], triangle)) return std::nullopt;
            cut.after[changes++] = i;
        }
        before = polygon[i];
        side_before = side;
    }
    return changes == 2 ? std::optional(cut) : std::nullopt;
}

/// Divides some of the crossed faces as other ones.
template <class Which>
void CutterOverlay::divide_crossed(const Which& which) {
    std::erase_if(division_.crossed, [&](CrossedFace& cut) {
        if (!which(cut)) return false;
        divide(cut.face, model_.face(index(cut.face)), division_);
        return true;
    });
}

/// Divides a polygon of a face: of a convex one that passes a triangle of the cutter once, what is
/// on either side of that is cut off by one edge, and a strip of two triangles is left.
void CutterOverlay::divide(std::int32_t face, std::span<const NodeId> polygon,
                           FaceDivision& division) const {
    const std::int32_t passed = first_passed(polygon);
    if (passed < 0) {
        division.add_beside(face, polygon);
        return;
    }
    auto [loop, rounding] = loop_of(model_, polygon);
    std::vector<LoopTriangle> triangles;
    if (loop.size() == 3) {
        const LoopTriangle triangle{loop[0], loop[1], loop[2]};
        division.add(face, std::span(&triangle, 1));
        return;
    }
    const Position a = corner(passed, 0);
    const Position& normal = normals_[index(passed)];
    std::vector<std::int8_t> sides;
    for (const NodeId v : polygon)
        sides.push_back(dot(normal, minus(model_.vertex(v), a)) > 0 ? kAbove : kBelow);
    std::vector<std::size_t> changes;  // the first corners on another side
    for (std::size_t i = 0; i < sides.size(); ++i) {
        if (sides[i] != sides[i == 0 ? sides.size() - 1 : i - 1]) changes.push_back(i);
    }
    if (changes.size() != 2 || !is_convex(loop, rounding)) {
        triangulate(std::span(&loop, 1), rounding, triangles);
        division.add(face, triangles);
        return;
    }
    std::rotate(loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(changes[0]), loop.end());
    const std::size_t half = changes[1] - changes[0];
    Loop strip{loop[0]};
    if (half > 1) strip.push_back(loop[half - 1]);
    strip.push_back(loop[half]);
    if (half + 1 < loop.size()) strip.push_back(loop.back());
    triangulate(std::span(&strip, 1), rounding, triangles);
    division.add(face, triangles);
    const std::vector<NodeId> nodes = transformed(loop, &LoopCorner::node);
    for (const auto& half_polygon :
         {std::span(nodes).first(half), std::span(nodes).subspan(half)}) {
        if (half_polygon.size() > 2) divide(face, half_polygon, division);
    }
}

/// Divides some polygons beside the cutter into triangles, as polygons of their own.
template <class Which>
void CutterOverlay::triangulate_polygons(FaceDivision& division, const Which& which) const {
    const Polygons beside = std::exchange(division.beside, {});
    const std::vector<std::int32_t> faces = std::exchange(division.face_of_beside, {});
    for (std::size_t i = 0; i < beside.size(); ++i) {
        if (!which(beside[i])) {
            division.add_beside(faces[i], beside[i]);
            continue;
        }
        const auto [loop, rounding] = loop_of(model_, beside[i]);
        std::vector<LoopTriangle> triangles;
        triangulate(std::span(&loop, 1), rounding, triangles);
        division.add(faces[i], triangles);
    }
}

Array<Box> CutterOverlay::face_boxes() const {
    const std::size_t faces = model_.face_count();
    Array<Box> boxes(faces + far_.faces().size());
    parallel_for_each(boxes.size(), execution_, [&](std::size_t f) {
        boxes[f] = f < faces
                       ? box_of(model_, model_.face(f))
                       : box_of(far_.model(), far_.model().face(index(far_.faces()[f - faces])));
        boxes[f].widen(margin_);
    });
    return boxes;
}

CutterOverlay::BoxedFace CutterOverlay::boxed_face(std::size_t face) {
    if (face >= model_.face_count()) {
        const std::size_t number = face - model_.face_count();
        const std::int32_t left_out = far_.faces()[number];
        const auto first = index(far_.first(far_.groups_of_faces()[number]));
        const std::size_t side = far_.is_reversed(left_out) ? 1 : 0;
        std::vector<std::array<NodeId, 3>> corners;
        triangulate_face(far_.model(), index(left_out), corners);
        return {{model_.cell(first, side), model_.cell(first, 1 - side)},
                transformed(corners, [this](const auto& t) {
                    const auto point = [&](NodeId v) {
                        return points_.add(far_.model().vertex(v));
                    };
                    return std::array{point(t[0]), point(t[1]), point(t[2])};
                })};
    }
    FaceDivision division;
    const std::int32_t first = first_same_[face];
    const auto crossed = std::ranges::lower_bound(division_.crossed, first, {}, &CrossedFace::face);
    if (crossed != division_.crossed.end() && crossed->face == first) {
        // round a corner of each half; where such triangles overlap they turn against each other
        const auto half = 2 * static_cast<std::size_t>(division_.crossed.end() - crossed);
        for (const std::size_t region : {size() - half, size() - half + 1}) {
            const auto loop = loops_[region][0];
            for (std::size_t i = 2; i < loop.size(); ++i)
                division.triangles.push_back({loop[0], loop[i - 1], loop[i]});
        }
    } else if (is_active(face)) {
        divide(first, model_.face(face), division);
    } else {
        division.add_beside(first, model_.face(face));
    }
    triangulate_polygons(division, [](std::span<const NodeId>) { return true; });
    return {{model_.cell(face, 0), model_.cell(face, 1)},
            transformed(division.triangles, [this](auto& t) {
                return std::array{exact(t[0]), exact(t[1]), exact(t[2])};
            })};
}

/// Divides more faces, on all threads.
void CutterOverlay::divide_all(std::span<const std::int32_t> faces) {
    constexpr std::size_t kFaces = 1 << 9;  // at a time
    std::vector<FaceDivision> divisions((faces.size() + kFaces - 1) / kFaces);
    parallel_ranges(
        faces.size(), kFaces, execution_,
        [&](std::size_t begin, std::size_t end) {
            FaceDivision& division = divisions[begin / kFaces];
            for (std::size_t i = begin; i < end; ++i) {
                if (const auto line = crossed(faces[i])) {
                    division.crossed.push_back(*line);
                } else {
                    divide(faces[i], model_.face(index(faces[i])), division);
                }
            }
        },
        0.02);
    for (const FaceDivision& division : divisions)
        division_.add(division);
}

/// The edges of the divided faces' triangles without area, from one on, in order; the vertices have
/// exact points.
std::vector<std::array<NodeId, 2>> CutterOverlay::edges_of_flat_triangles(std::size_t first) const {
    constexpr std::size_t kTriangles = 1 << 11;  // at a time
    const std::size_t count = division_.triangles.size() - first;
    const auto find = [&](std::size_t begin, std::size_t end, auto& flat_edges) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto& t = division_.triangles[first + i];
            bool flat = true;
            for (std::size_t axis = 0; axis < 3 && flat; ++axis) {
                flat = exact::orient2d(points_, axis, vertex_point_[index(t[0])],
                                       vertex_point_[index(t[1])], vertex_point_[index(t[2])]) == 0;
            }
            for (std::size_t k = 0; flat && k < 3; ++k)
                flat_edges.push_back(unordered(t[k], t[(k + 1) % 3]));
        }
    };
    auto edges = collect_ranges<std::array<NodeId, 2>>(count, kTriangles, execution_, find);
    std::sort(edges.begin(), edges.end());
    return edges;
}

/// Divides active faces, in two where that will do. A triangle without area has no region in the
/// overlay: the corner in its middle comes to lie on its long edge, and so on an edge of the face,
/// or the polygon, beyond, which must know it.
void CutterOverlay::divide_active_faces() {
    vertex_point_.assign(model_.vertex_count(), kNone);
    name_vertices_of(active_faces_);
    divide_all(active_faces_);
    divide_crossed([this](CrossedFace& cut) {
        const auto corners = model_.face(index(cut.face));
        const auto plane = cutter_points(cut.triangle);
        for (std::size_t k = 0; k < 2; ++k) {
            const std::size_t to = cut.after[k], from = (to + corners.size() - 1) % corners.size();
            cut.ends[k] = points_.intersection(vertex_point_[index(corners[from])],
                                               vertex_point_[index(corners[to])], plane[0],
                                               plane[1], plane[2]);
        }
        return cut.ends[0] == cut.ends[1];  // of a face without an extent there
    });
    for (std::size_t first = 0; first < division_.triangles.size();) {
        const auto edges = edges_of_flat_triangles(first);
        first = division_.triangles.size();
        if (edges.empty()) break;
        const auto has_edge = [&edges](std::span<const NodeId> polygon) {
            for (std::size_t i = 0; i < polygon.size(); ++i) {
                const NodeId a = polygon[i], b = polygon[i + 1 < polygon.size() ? i + 1 : 0];
                if (std::ranges::binary_search(edges, unordered(a, b))) return true;
            }
            return false;
        };
        std::vector<std::int32_t> fresh;
        for (std::size_t f = 0; f < model_.face_count(); ++f) {
            if (active_[f] != 0 || !has_edge(model_.face(f))) continue;
            for (const std::int32_t same : same_faces_[f])
                active_[index(same)] = 1;
            fresh.push_back(static_cast<std::int32_t>(f));
        }
        name_vertices_of(fresh);
        divide_all(fresh);
        active_faces_.insert(active_faces_.end(), fresh.begin(), fresh.end());
        divide_crossed(
            [&](const CrossedFace& cut) { return has_edge(model_.face(index(cut.face))); });
        triangulate_polygons(division_, has_edge);
    }
    std::sort(active_faces_.begin(), active_faces_.end());
}

}  // namespace realmodel::cutting
