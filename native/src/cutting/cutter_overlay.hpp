// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "arrangement/edge_fan.hpp"
#include "arrangement/triangle_arrangement.hpp"
#include "base/counting_sort.hpp"
#include "cutting/cutter.hpp"
#include "cutting/near_model.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::cutting {

using arrangement::Loops;
using exact::SpacePointId;

/// Planes along the edges of a triangle, at right angles to it.
class PlaneOutline {
public:
    /// @param margin  what its corners and others may be off by
    PlaneOutline(const std::array<Position, 3>& triangle, double margin)
        : corners_(triangle), margin_(4 * margin) {
        const Position normal = polygon_normal(triangle);
        for (std::size_t i = 0; i < 3; ++i)
            outward_[i] = cross(minus(triangle[(i + 1) % 3], triangle[i]), normal);
    }
    /// Whether other corners surely are beyond one of these planes.
    bool is_surely_beside(std::span<const Position> others) const {
        constexpr double kRounding = 0x1p-40;
        for (std::size_t i = 0; i < 3; ++i) {
            const Position& out = outward_[i];
            const double size = std::abs(out[0]) + std::abs(out[1]) + std::abs(out[2]);
            // rounding may have turned the plane itself, so that its own corners are beyond it
            double reach = -HUGE_VAL, least = HUGE_VAL, farthest = 0;
            for (const Position& corner : corners_) {
                const Position offset = minus(corner, corners_[i]);
                reach = std::max(reach, dot(out, offset));
                farthest = std::max(farthest, length(offset));
            }
            for (const Position& other : others) {
                const Position beyond = minus(other, corners_[i]);
                least = std::min(least, dot(out, beyond));
                farthest = std::max(farthest, length(beyond));
            }
            if (least > reach + size * (margin_ + kRounding * farthest)) return true;
        }
        return false;
    }

private:
    std::array<Position, 3> corners_, outward_{};
    double margin_;
};

/// Triangles of a cutter that no face of a model comes near, and that meet other triangles only at
/// corners and edges that they share: nothing divides them. Those that are connected by edges make
/// a component, on each side of which the same is everywhere. Each component has an edge at a
/// triangle that is none of them, which stands for all of it.
class UndividedTriangles {
public:
    UndividedTriangles() = default;
    /// @param tree   of boxes around the triangles
    /// @param meets   of triangles: 1 where a face may be near
    /// @param groups  of triangles: those of a component are of one
    UndividedTriangles(const Cutter& cutter, const spatial::BoxTree& tree,
                       std::vector<std::uint8_t> meets, std::span<const std::int32_t> groups,
                       const Execution& execution);

    bool has(std::int32_t triangle) const { return component(triangle) >= 0; }
    /// The component of a triangle, -1 none.
    std::int32_t component(std::int32_t triangle) const {
        return component_.empty() ? -1 : component_[index(triangle)];
    }
    /// Those of a component, in order.
    std::span<const std::int32_t> triangles(std::size_t component) const {
        return triangles_[component];
    }
    std::size_t components() const { return triangles_.size(); }

    /// An edge between a triangle of a component and one that is none, as the former runs.
    struct Border {
        std::int32_t triangle, neighbor;
        std::array<std::int32_t, 2> edge;
    };
    std::span<const Border> borders(std::size_t component) const { return borders_[component]; }

private:
    std::vector<std::int32_t> component_;  ///< of triangles, -1 none
    Buckets<std::int32_t> triangles_;      ///< of components
    Buckets<Border> borders_;              ///< likewise
};

/// Whether two triangles, by vertices of a cutter, surely have nothing in common beside corners
/// and the edge that they share. What doubles do not tell is not sure.
bool are_surely_apart(const Cutter& cutter, const std::array<std::int32_t, 3>& one,
                      const std::array<std::int32_t, 3>& other);

/// A model's faces near a cutter, and the cutter, divided along one another exactly. Nodes are
/// the model's vertices, then the points where they meet.
///
/// Vertices of the model that are on the cutter but for their own rounding are taken to lie on it:
/// the model's cells may then overlap by as much, and callers must accept that.
class CutterOverlay {
public:
    /// @param least_rounding  what coordinates may be off by at least, where the model is a piece
    ///                        of one with larger coordinates
    /// @param groups  of triangles of the cutter: of one group those that meet nothing are left
    ///                undivided, and are no regions; none at all: there are no such triangles, and
    ///                no two faces of the model are the same
    /// @param far     faces that were left out of the model
    CutterOverlay(const ComplexView& model, const Cutter& cutter, const Execution& execution,
                  double least_rounding = 0, std::span<const std::int32_t> groups = {},
                  const FarFaces& far = kNoFarFaces);

    const ComplexView& model() const { return model_; }
    const FarFaces& far() const { return far_; }
    /// Whether a face is divided that stands for some that were left out: these had to be there.
    bool reaches_far_faces() const {
        return std::ranges::any_of(active_faces_,
                                   [this](std::int32_t f) { return far_.group(index(f)) >= 0; });
    }
    const Cutter& cutter() const { return cutter_; }
    int threads() const { return execution_.threads; }
    std::size_t size() const { return loops_.size(); }
    bool of_cutter(std::size_t region) const {
        return !is_of_face(region) && triangle(region) >= first_cutter_;
    }
    /// The triangle of the cutter that a region is part of.
    std::int32_t cutter_triangle(std::size_t region) const {
        return divided_[index(triangle(region) - first_cutter_)];
    }
    /// The face that a region is part of. Of faces with the same corners in the same order, as
    /// several models in one have them, the first stands for all.
    std::size_t face_of(std::size_t region) const {
        return index(is_of_face(region) ? division_.face_of_beside[region - of_triangles()]
                                        : division_.face_of_triangle[index(triangle(region))]);
    }
    /// All faces that a region is part of.
    std::span<const std::int32_t> faces_of(std::size_t region) const {
        return same_faces_[face_of(region)];
    }
    std::int32_t first_same(std::size_t face) const { return first_same_[face]; }
    /// The region's outline, then its holes, in nodes.
    Loops<NodeId> loops(std::size_t region) const { return loops_[region]; }
    /// Whether a face has regions; the others are away from the cutter.
    bool is_active(std::size_t face) const { return active_[face] != 0; }
    /// Of those that are the same the first.
    const std::vector<std::int32_t>& active_faces() const { return active_faces_; }

    Position position(NodeId node) const {
        const auto vertices = static_cast<NodeId>(model_.vertex_count());
        return node < vertices ? model_.vertex(node) : new_positions_[index(node - vertices)];
    }
    Position middle_of(std::span<const NodeId> nodes) const {
        Position middle{0, 0, 0};
        for (const NodeId node : nodes) {
            for (std::size_t k = 0; k < 3; ++k)
                middle[k] += position(node)[k] / static_cast<double>(nodes.size());
        }
        return middle;
    }
    std::size_t node_count() const { return model_.vertex_count() + new_positions_.size(); }
    std::vector<Position>& new_positions() { return new_positions_; }
    /// A new node, of which no exact point is known.
    NodeId add_node(const Position& p) {
        new_positions_.push_back(p);
        return checked_number(model_.vertex_count() + new_positions_.size(), "nodes") - 1;
    }

    /// Triangles of the cutter that have no regions.
    const UndividedTriangles& undivided() const { return undivided_; }
    std::array<NodeId, 3> undivided_nodes(std::int32_t triangle) const {
        const auto& corners = cutter_.triangles[index(triangle)];
        return {cutter_nodes_[index(corners[0])], cutter_nodes_[index(corners[1])],
                cutter_nodes_[index(corners[2])]};
    }
    /// The node of a corner of such a triangle, by its number in the cutter.
    NodeId cutter_node(std::int32_t vertex) const { return cutter_nodes_[index(vertex)]; }
    /// The number of such a triangle as the item of an edge's use: after all regions and faces.
    std::int32_t undivided_item(std::int32_t triangle) const {
        return static_cast<std::int32_t>(size() + model_.face_count()) + triangle;
    }

    /// The exact point of a node. Those of regions have one already: of them several threads may
    /// ask at once.
    SpacePointId exact(NodeId node);
    exact::SpacePoints& points() { return points_; }
    /// The corners, as exact points, of the triangle that a region is part of.
    const std::array<SpacePointId, 3>& corners(std::size_t region) const {
        return arrangement_.corners(triangle(region));
    }
    /// The fan of an edge's uses by regions and whole faces, in nodes, of many edges one after
    /// another in memory that they share.
    void find_fan(std::span<const arrangement::EdgeUse> uses,
                  std::vector<arrangement::HalfPlane>& scratch, arrangement::EdgeFan& fan);
    /// A point within a region, on none of its edges; of a polygon one of its corners that is
    /// beside the cutter.
    SpacePointId inner_point(std::size_t region);
    /// The axis along which a region is seen best, and which way it turns seen along it.
    std::pair<std::size_t, int> view_of(std::size_t region) const;
    /// Around all faces, and what vertices may have moved by; then around those left out.
    Array<spatial::Box> face_boxes() const;
    /// One of these.
    struct BoxedFace {
        std::array<std::int32_t, 2> cells;  ///< on its sides
        std::vector<std::array<SpacePointId, 3>> triangles;
    };
    BoxedFace boxed_face(std::size_t face);
    /// Around the whole model, and a little wider.
    const spatial::Box& model_box() const { return model_box_; }

private:
    using LoopTriangle = std::array<LoopCorner, 3>;
    /// A face that one triangle of the cutter passes, and nothing else of it, from one edge to
    /// another: a line of that triangle cuts it in two, so that it needs no triangles of its own.
    struct CrossedFace {
        std::int32_t face, triangle;
        std::array<std::size_t, 2> after{};  ///< the corners after its ends
        std::array<SpacePointId, 2> ends{};  ///< on the edges before these
    };
    /// What faces near the cutter are divided into: triangles, which may pass it, polygons beside
    /// it, which do not, and faces in two.
    struct FaceDivision {
        std::vector<std::array<NodeId, 3>> triangles;
        std::vector<std::int32_t> face_of_triangle;
        Polygons beside;
        std::vector<std::int32_t> face_of_beside;
        std::vector<CrossedFace> crossed;  ///< their halves follow what is beside

        void add(std::int32_t face, std::span<const LoopTriangle> more);
        void add_beside(std::int32_t face, std::span<const NodeId> polygon);
        void add(const FaceDivision& other);
    };

    /// A corner of the cutter, the line of an edge or the plane of a triangle, by as many corners.
    /// A vertex near it is moved along `axis` into the plane; on the line it keeps that coordinate.
    struct CutterFeature {
        std::size_t count, axis;
        std::array<Position, 3> corners;
    };

    std::size_t of_triangles() const { return arrangement_.regions().size(); }
    /// Whether a region is a polygon of a face, beside the cutter or half of a crossed face: its
    /// corners beside the cutter first. These regions come last.
    bool is_of_face(std::size_t region) const { return region >= of_triangles(); }
    std::int32_t triangle(std::size_t region) const {
        return arrangement_.regions().triangles[region];
    }
    class RoundedPlane;
    void find_same_faces(bool may_repeat);
    void find_active_faces(std::span<const std::int32_t> groups);
    bool is_beside(std::span<const NodeId> polygon, std::int32_t triangle) const;
    template <class Visit>
    void for_each_near(std::span<const NodeId> polygon, const Visit& visit) const;
    std::int32_t first_passed(std::span<const NodeId> polygon) const;
    void name_cutter();
    std::optional<CrossedFace> crossed(std::int32_t face) const;
    bool passes_within(NodeId a, NodeId b, const std::array<SpacePointId, 3>& triangle) const;
    template <class Which>
    void divide_crossed(const Which& which);
    void add_halves(const CrossedFace& cut, std::span<const SpacePointId> within,
                    std::span<const NodeId> node_of_point);
    void divide(std::int32_t face, std::span<const NodeId> polygon, FaceDivision& division) const;
    template <class Which>
    void triangulate_polygons(FaceDivision& division, const Which& which) const;
    void divide_all(std::span<const std::int32_t> faces);
    std::vector<std::array<NodeId, 2>> edges_of_flat_triangles(std::size_t first) const;
    void divide_active_faces();
    void name_vertices_of(std::span<const std::int32_t> faces);
    SpacePointId far_corner(std::span<const NodeId> polygon, const std::array<NodeId, 2>& edge);
    std::array<SpacePointId, 3> cutter_points(std::int32_t triangle) const {
        const auto& corners = cutter_.triangles[index(triangle)];
        return {cutter_point_[index(corners[0])], cutter_point_[index(corners[1])],
                cutter_point_[index(corners[2])]};
    }
    Position corner(std::int32_t triangle, std::size_t i) const {
        return cutter_.vertices[index(cutter_.triangles[index(triangle)][i % 3])];
    }
    static std::optional<CutterFeature> edge_near(const Position& p, const Position& tolerance,
                                                  const Position& a, const Position& b);
    static std::optional<CutterFeature> triangle_near(const Position& p, const Position& tolerance,
                                                      const std::array<Position, 3>& corners);
    std::vector<CutterFeature> features_near(NodeId vertex) const;
    std::optional<SpacePointId> point_on_cutter(const Position& p,
                                                std::span<const CutterFeature> features);
    void add_triangles();
    void overlay_all();
    void name_nodes();
    void sort_new_nodes();

    const ComplexView& model_;
    const Cutter& cutter_;
    const FarFaces& far_;
    Execution execution_;

    exact::SpacePoints points_;
    arrangement::TriangleArrangement arrangement_;
    std::vector<Position> normals_;  ///< of the cutter's triangles
    std::unique_ptr<spatial::BoxTree> tree_;
    double margin_;
    spatial::Box model_box_;
    std::vector<std::int32_t> first_same_;  ///< of faces
    Buckets<std::int32_t> same_faces_;      ///< of the first of those that are the same
    std::vector<std::uint8_t> active_;      ///< of faces
    std::vector<std::int32_t> active_faces_;
    std::vector<SpacePointId>
        vertex_point_;                    ///< of the model's vertices, none away from the cutter
    std::vector<std::uint8_t> is_taken_;  ///< of exact points: a vertex is there
    FaceDivision division_;               ///< of active faces
    UndividedTriangles undivided_;
    std::vector<std::int32_t> divided_;       ///< the other triangles of the cutter
    std::vector<SpacePointId> cutter_point_;  ///< of the cutter's vertices that triangles have
    std::vector<NodeId> cutter_nodes_;        ///< of those of undivided triangles, the others -1
    std::int32_t first_cutter_ = 0;           ///< the overlay's first triangle of the cutter
    std::vector<SpacePointId> exact_of_new_;  ///< the exact point of each new node
    std::vector<Position> new_positions_;
    arrangement::LoopTable<NodeId> loops_;  ///< of regions, in nodes
};

}  // namespace realmodel::cutting
