// SPDX-License-Identifier: GPL-3.0-or-later
// By CGAL's Mesh_3 (L. Rineau, M. Yvinec, Meshing 3D domains bounded by piecewise smooth surfaces,
// 2007): Delaunay refinement of the surfaces and the volume at once, then its removal of slivers.
// Sharp edges are kept by balls (S.-W. Cheng et al., Delaunay refinement for piecewise smooth
// complexes, 2007) as large as the edge length asks for around points that are far enough from each
// other, so that nothing has to be divided further where such edges come near each other.
#include "realmodel/simulation/filled_mesh.hpp"

#include "exact/cgal_kernel.hpp"
// CGAL
// A table of 32 kB of each thread goes to the heap: a module that is loaded late has room for few
// thread-local bytes (realmodel_loaded_late). An exception, as where there is no memory, leaves
// entries in it, which the next insertion would take for its own.
#include <CGAL/Random.h>
#include <CGAL/tss.h>

#pragma push_macro("CGAL_STATIC_THREAD_LOCAL_VARIABLE_0")
#undef CGAL_STATIC_THREAD_LOCAL_VARIABLE_0
#define CGAL_STATIC_THREAD_LOCAL_VARIABLE_0(TYPE, VAR)                         \
    static thread_local const auto VAR##_of_thread = std::make_unique<TYPE>(); \
    TYPE& VAR = *VAR##_of_thread;                                              \
    for (auto left = VAR.begin(); left != VAR.end(); ++left)                   \
        VAR.clear(left);                                                       \
    VAR.clear()
#include <CGAL/Triangulation_data_structure_3.h>
#pragma pop_macro("CGAL_STATIC_THREAD_LOCAL_VARIABLE_0")

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Mesh_3/Mesher_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/exude_mesh_3.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "base/index.hpp"
#include "base/parallel.hpp"
#include "exact/triangle_distances.hpp"
#include "realmodel/base/errors.hpp"
#include "simulation/boundary_faces.hpp"
#include "simulation/tetrahedra_repair.hpp"

namespace realmodel::simulation {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

constexpr double kBall = 0.6;          ///< of the edge length: radius around points of sharp edges
constexpr double kSeeds = 1.5;         ///< of the edge length: between first points on surfaces
constexpr double kFacetAngle = 25;     ///< degrees: the least wanted in faces of boundaries
constexpr double kRadiusOverEdge = 2;  ///< the most wanted of a tetrahedron
constexpr double kReach = 1;           ///< of the edge length: outside faces from exact ones
constexpr double kSliver = 12;         ///< degrees: flatter tetrahedra are to go
constexpr std::uint64_t kQuestionsOfAPoint = 200;  ///< about the most asked of the model
constexpr std::uint64_t kStepsOfAPoint = 20;       ///< the most that may fail before one succeeds
constexpr int kTimes = 8;                          ///< the most that one thing is asked in a row
constexpr int kMostRays = 16;                      ///< that ask for one region
constexpr double kMostPoints = 2e7;
constexpr int kFirstSurface = 8;  ///< CGAL numbers surfaces from 1, we from kCutFace

Point point_of(const std::array<double, 3>& p) {
    return {p[0], p[1], p[2]};
}

[[noreturn]] void refuse_division() {
    throw InputError("endless",
                     "dividing into tetrahedra fails where boundaries meet at sharp angles; "
                     "use another edge length or a larger minimum thickness");
}

[[noreturn]] void refuse_nothing() {
    throw InputError("nothing", "the edge length is too large for the model");
}

struct InterfaceTriangle {
    Kernel::Triangle_3 triangle;
    std::int32_t behind, in_front, surface;
};

/// A row of faces, as CGAL's tree of boxes wants them.
struct FaceOfTree {
    using Id = std::size_t;
    using Point = Kernel::Point_3;
    using Datum = Kernel::Triangle_3;
    using Datum_reference = const Datum&;
    using Shared_data = const std::vector<InterfaceTriangle>*;

    FaceOfTree() = default;
    FaceOfTree(std::vector<std::size_t>::const_iterator row, Shared_data /*faces*/) : id_(*row) {}
    static Shared_data construct_shared_data(Shared_data faces) { return faces; }
    Id id() const { return id_; }
    Datum_reference datum(Shared_data faces) const { return (*faces)[id_].triangle; }
    Point reference_point(Shared_data faces) const { return (*faces)[id_].triangle[0]; }

private:
    Id id_ = 0;
};

/// What CGAL asks of the model (its concept MeshDomain_3): the region of a point, where a line
/// meets a boundary. Subdomains are regions from 1; surfaces of faces count from kFirstSurface.
class Domain {
public:
    using R = Kernel;
    using FT = Kernel::FT;
    using Point_3 = Kernel::Point_3;
    using Vector_3 = Kernel::Vector_3;
    using Segment_3 = Kernel::Segment_3;
    using Ray_3 = Kernel::Ray_3;
    using Line_3 = Kernel::Line_3;
    using Has_features = CGAL::Tag_false;
    using Subdomain_index = int;
    using Surface_patch_index = int;
    using Index = int;
    using Subdomain = boost::optional<Subdomain_index>;
    using Surface_patch = boost::optional<Surface_patch_index>;
    using Intersection = std::tuple<Point_3, Index, int>;

    Domain(const ComplexView& model, std::span<const BoundaryTriangle> triangles,
           Progress* progress)
        : progress_(progress) {
        for (const BoundaryTriangle& t : triangles) {
            faces_.push_back(
                {{point_of(model.vertex(t.corners[0])), point_of(model.vertex(t.corners[1])),
                  point_of(model.vertex(t.corners[2]))},
                 t.behind,
                 t.in_front,
                 t.surface});
        }
        std::vector<std::size_t> rows;
        for (std::size_t row = 0; row < faces_.size(); ++row)
            if (!faces_[row].triangle.is_degenerate()) rows.push_back(row);
        tree_.insert(rows.cbegin(), rows.cend(), &faces_);
        tree_.build();
    }

    /// So many more questions, then it is given up.
    void allow(std::uint64_t more) const { most_asked_ = asked_ + more; }

    CGAL::Bbox_3 bbox() const { return tree_.bbox(); }
    bool empty() const { return tree_.empty(); }

    /// 0 outside.
    int region(const Point& p) const {
        poll();
        const CGAL::Bbox_3 box = tree_.bbox();
        for (int axis = 0; axis < 3; ++axis)
            if (!(box.min(axis) <= p[axis] && p[axis] <= box.max(axis))) return 0;
        // A plane through the point has two of these rays at most, so few pass an edge. Where none
        // tells, faces lie on one another.
        double lean = 1;
        for (int rays = 1;; ++rays, lean /= 2) {
            // nearly upward, so that it passes between edges of walls and of regular grids
            const double rise = 1.01 * (box.zmax() - p.z()) + 1e-6 * (box.zmax() - box.zmin());
            const RayAnswer answer =
                ask_ray(p, {p.x() + 0.0123456 * lean * rise,
                            p.y() + 0.00789123 * lean * lean * rise, p.z() + rise});
            if (answer.is_certain || rays == kMostRays) return answer.region;
        }
    }

    std::int32_t nearest_surface(const Point& p) const {
        return faces_[tree_.closest_point_and_primitive(p).second].surface;
    }

    struct Is_in_domain {
        const Domain& domain;
        Subdomain operator()(const Point& p) const {
            const int region = domain.region(p);
            return region == 0 ? Subdomain() : Subdomain(region);
        }
    };
    struct Do_intersect_surface {
        const Domain& domain;
        template <class Query>
        Surface_patch operator()(const Query& query) const {
            domain.poll();
            const auto row = domain.tree_.any_intersected_primitive(query);
            return row ? Surface_patch(domain.patch(*row)) : Surface_patch();
        }
    };
    struct Construct_intersection {
        const Domain& domain;
        template <class Query>
        Intersection operator()(const Query& query) const {
            domain.poll();
            // A center that rounding puts outside the balls of its facet is asked for for ever.
            if (domain.is_asked_again(query.point(0), query.point(1))) return {};
            const auto row = domain.tree_.any_intersected_primitive(query);
            if (!row) return {};
            return {meeting(domain.faces_[*row], query.point(0), query.point(1)),
                    domain.patch(*row), 2};
        }
    };
    Is_in_domain is_in_domain_object() const { return {*this}; }
    Do_intersect_surface do_intersect_surface_object() const { return {*this}; }
    Construct_intersection construct_intersection_object() const { return {*this}; }

    Index index_from_surface_patch_index(Surface_patch_index surface) const { return surface; }
    Index index_from_subdomain_index(Subdomain_index region) const { return region; }
    Surface_patch_index surface_patch_index(Index index) const { return index; }
    Subdomain_index subdomain_index(Index index) const { return index; }

private:
    void poll() const {
        if ((++asked_ & 0xff) != 0) return;
        if (progress_ != nullptr) progress_->check();
        if (asked_ > most_asked_) refuse_division();
    }
    struct RayAnswer {
        int region = 0;
        bool is_certain = true;
    };
    /// The region at the beginning of a segment that leaves the model: what is before the nearest
    /// face that it meets. Not certain where several are nearest and do not agree, of which the
    /// first counts, or where one has the segment in its plane. A point on faces is before the
    /// first of them.
    RayAnswer ask_ray(const Point& from, const Point& to) const {
        hits_.clear();
        tree_.all_intersected_primitives(Segment_3(from, to), std::back_inserter(hits_));
        std::ranges::sort(hits_);
        RayAnswer answer;
        std::optional<std::size_t> nearest;
        bool is_along_face = false;
        for (const std::size_t row : hits_) {
            const InterfaceTriangle& face = faces_[row];
            const Kernel::Triangle_3& t = face.triangle;
            CGAL::Sign side = CGAL::orientation(t[0], t[1], t[2], from);
            const bool is_at_point = side == CGAL::ZERO;
            if (is_at_point) side = -CGAL::orientation(t[0], t[1], t[2], to);
            if (side == CGAL::ZERO) {
                is_along_face = true;
                continue;
            }
            const int before = side == CGAL::POSITIVE ? face.in_front : face.behind;
            if (is_at_point) return {before, !is_along_face};
            const int order = nearest ? compare(from, to, row, *nearest) : -1;
            if (order < 0) {
                nearest = row;
                answer = {before, true};
            } else if (order == 0 && answer.region != before) {
                answer.is_certain = false;
            }
        }
        if (is_along_face) answer.is_certain = false;
        return answer;
    }
    /// Which of two faces a segment meets first: -1, 1; 0 both in one point.
    int compare(const Point& from, const Point& to, std::size_t row, std::size_t other) const {
        return exact::compare_crossings(position_of(from), position_of(to), corners_of(row),
                                        corners_of(other));
    }
    static std::array<double, 3> position_of(const Point& p) { return {p.x(), p.y(), p.z()}; }
    std::array<std::array<double, 3>, 3> corners_of(std::size_t row) const {
        const Kernel::Triangle_3& t = faces_[row].triangle;
        return {position_of(t[0]), position_of(t[1]), position_of(t[2])};
    }
    int patch(std::size_t row) const { return faces_[row].surface + kFirstSurface; }
    bool is_asked_again(const Point& from, const Point& to) const {
        if (from == last_from_ && to == last_to_) return ++times_ > kTimes;
        last_from_ = from;
        last_to_ = to;
        times_ = 1;
        return false;
    }
    /// Where the line through two points meets the plane of a face. One of the points may be
    /// very far away (the center of four points that are nearly in one plane), so from the nearer.
    static Point meeting(const InterfaceTriangle& face, const Point& from, const Point& to) {
        const Kernel::Triangle_3& t = face.triangle;
        const double a = CGAL::volume(t[0], t[1], t[2], from);
        const double b = CGAL::volume(t[0], t[1], t[2], to);
        if (a == b) return CGAL::midpoint(from, to);
        return std::abs(a) <= std::abs(b) ? from + a / (a - b) * (to - from)
                                          : to + b / (b - a) * (from - to);
    }
    using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, FaceOfTree>>;
    std::vector<InterfaceTriangle> faces_;
    Tree tree_;
    Progress* progress_;
    mutable std::vector<std::size_t> hits_;
    mutable std::uint64_t asked_ = 0, most_asked_ = UINT64_MAX;
    mutable Point last_from_, last_to_;
    mutable int times_ = 0;
};

using Triangulation = CGAL::Mesh_triangulation_3<Domain, CGAL::Default, CGAL::Sequential_tag>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation, int, int>;

/// CGAL's criteria, which leave alone what is small enough already, or could only be divided by a
/// point too near to others.
template <class Criteria, class Bad>
class NotNearer : public Criteria {
public:
    NotNearer(const Criteria& criteria, double nearest)
        : Criteria(criteria), nearest_(nearest * nearest) {}

    template <class Simplex>
    Bad operator()(const Triangulation& triangulation, const Simplex& simplex) const {
        return is_near(triangulation, simplex) ? Bad()
                                               : Criteria::operator()(triangulation, simplex);
    }

private:
    bool is_near(const Triangulation& triangulation, const Triangulation::Facet& facet) const {
        return is_near(triangulation, facet.first, facet.second,
                       facet.first->get_facet_surface_center(facet.second));
    }
    bool is_near(const Triangulation& triangulation, Triangulation::Cell_handle cell) const {
        return is_near(triangulation, cell, -1, triangulation.dual(cell));
    }
    /// @param without  the corner of the cell that is no corner of the facet, or -1
    bool is_near(const Triangulation& triangulation, Triangulation::Cell_handle cell, int without,
                 const Point& added) const {
        // It will be as far from all corners, or from the balls around them.
        const auto& at = triangulation.point(cell, (without + 1) & 3);
        if (CGAL::squared_distance(at.point(), added) - at.weight() < nearest_) return true;
        for (int i = 0; i < 4; ++i) {
            for (int j = 0; j < i; ++j) {
                if (i != without && j != without &&
                    CGAL::squared_distance(triangulation.point(cell, i).point(),
                                           triangulation.point(cell, j).point()) > nearest_)
                    return false;
            }
        }
        return true;
    }
    double nearest_;
};

/// The edge length of a place, as CGAL asks for it.
struct EdgeLength {
    meshing::SizeField* lengths;
    double operator()(const Point& p, int /*dimension*/, int /*index*/) const {
        return lengths->at({p.x(), p.y()});
    }
};

using FacetBase = CGAL::Mesh_facet_criteria_3<Triangulation>;
using CellBase = CGAL::Mesh_cell_criteria_3<Triangulation>;

struct Criteria {
    using Facet_criteria = NotNearer<FacetBase, FacetBase::Is_facet_bad>;
    using Cell_criteria = NotNearer<CellBase, CellBase::Is_cell_bad>;

    Criteria(const EdgeLength& edge_length, double tolerance)
        : facets(FacetBase(kFacetAngle, edge_length, tolerance, CGAL::FACET_VERTICES_ON_SURFACE),
                 tolerance),
          cells(CellBase(kRadiusOverEdge, edge_length), tolerance) {}
    const Facet_criteria& facet_criteria_object() const { return facets; }
    const Cell_criteria& cell_criteria_object() const { return cells; }

    Facet_criteria facets;
    Cell_criteria cells;
};

/// The regions of the complex as arrays.
FilledMesh arrays_of(const Complex& complex, const Domain& domain,
                     std::span<const std::uint8_t> embedded) {
    const Triangulation& triangulation = complex.triangulation();
    FilledMesh mesh;
    std::unordered_map<Triangulation::Cell_handle, std::int32_t> numbers;
    std::unordered_map<Triangulation::Vertex_handle, std::int32_t> of_vertex;
    for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end();
         ++cell) {
        numbers.emplace(cell, checked_number(mesh.tetrahedra.size(), "tetrahedra"));
        auto& corners = mesh.tetrahedra.emplace_back();
        for (int i = 0; i < 4; ++i) {
            const auto [at, is_new] =
                of_vertex.emplace(cell->vertex(i), static_cast<std::int32_t>(mesh.points.size()));
            if (is_new) {
                const Point p = triangulation.point(cell, i).point();
                mesh.points.push_back({p.x(), p.y(), p.z()});
            }
            corners[static_cast<std::size_t>(i)] = at->second;
        }
        mesh.region.push_back(complex.subdomain_index(cell) - 1);
    }
    for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end();
         ++cell) {
        const std::int32_t number = numbers.at(cell);
        for (int i = 0; i < 4; ++i) {
            const auto other = numbers.find(cell->neighbor(i));
            const bool is_outside = other == numbers.end();
            if (!is_outside && other->second < number) continue;
            const int patch = complex.surface_patch_index(cell, i);
            std::int32_t surface = patch - kFirstSurface;
            if (!is_outside && mesh.region[index(other->second)] == mesh.region[index(number)]) {
                const bool matters = patch != 0 && surface >= 0 &&
                                     std::cmp_less(surface, embedded.size()) &&
                                     embedded[index(surface)] != 0;
                if (!matters) continue;
            }
            const auto& corners = mesh.tetrahedra[index(number)];
            std::array<std::int32_t, 3> face{};
            for (int j = 0; j < 3; ++j)
                face[static_cast<std::size_t>(j)] =
                    corners[static_cast<std::size_t>(Triangulation::vertex_triple_index(i, j))];
            if (patch == 0) {
                const auto at = [&](int j) {
                    return point_of(mesh.points[index(face[static_cast<std::size_t>(j)])]);
                };
                surface = domain.nearest_surface(CGAL::centroid(at(0), at(1), at(2)));
            }
            std::swap(face[0], face[1]);  // CGAL's is counter-clockwise seen from within
            mesh.triangles.push_back(face);
            mesh.surface.push_back(surface);
        }
    }
    return mesh;
}

void require_volume(const FilledMesh& mesh) {
    if (mesh.tetrahedra.empty()) refuse_nothing();
    for (const auto& corners : mesh.tetrahedra) {
        if (!(six_volumes(mesh, corners) > 0))
            throw InputError("flat", "an element has no volume", -1, {},
                             mesh.points[index(corners[0])]);
    }
}

/// More than any mesh of this size should need: Delaunay refinement is not proven to end where
/// boundaries meet at sharp angles.
std::size_t most_points(const ComplexView& model, const BoundaryFaces& faces,
                        meshing::SizeField& lengths, double tolerance, Progress* progress) {
    double area = 0;
    CGAL::Bbox_3 box;
    for (const BoundaryTriangle& t : faces.triangles) {
        const Point a = point_of(model.vertex(t.corners[0]));
        const Point b = point_of(model.vertex(t.corners[1]));
        const Point c = point_of(model.vertex(t.corners[2]));
        area += std::sqrt(CGAL::squared_area(a, b, c));
        box += a.bbox() + b.bbox() + c.bbox();
    }
    const double cubes = cubes_in(lengths, {box.xmin(), box.ymin(), box.zmin()},
                                  {box.xmax(), box.ymax(), box.zmax()}, kMostPoints, progress);
    const double most = 10000 + 8 * cubes + area / (tolerance * tolerance);
    return static_cast<std::size_t>(std::min(most, kMostPoints));
}

void insert(Complex& complex, const std::array<double, 3>& p, double radius, int dimension,
            int index) {
    const auto vertex =
        complex.triangulation().insert(Triangulation::Weighted_point(point_of(p), radius * radius));
    if (vertex == Triangulation::Vertex_handle()) return;
    complex.set_dimension(vertex, dimension);
    complex.set_index(vertex, index);
}

void refine(Complex& complex, const Domain& domain, const Criteria& criteria, std::size_t most,
            Progress* progress) {
    CGAL::Mesh_3::Mesher_3<Complex, Criteria, Domain> mesher(complex, domain, criteria);
    domain.allow(kQuestionsOfAPoint * most);
    mesher.initialize();
    std::size_t points = 0;
    std::uint64_t failed = 0;  // since the last new point
    for (std::size_t step = 0; !mesher.is_algorithm_done(); ++step) {
        if (progress != nullptr && (step & 0xff) == 0) progress->check();
        mesher.one_step();
        const std::size_t now = complex.triangulation().number_of_vertices();
        failed = now == points ? failed + 1 : 0;
        points = now;
        if (points > most || failed > kStepsOfAPoint * (1000 + points)) refuse_division();
    }
}

}  // namespace

FilledMesh filled_mesh(const ComplexView& model, std::span<const std::int32_t> cell_region,
                       std::span<const std::uint8_t> embedded, double edge_length, double tolerance,
                       std::span<const meshing::LocalLength> sizes, const Execution& execution) {
    begin_phase(execution.progress, 0.0, 0.2, "finding boundaries");
    const BoundaryFaces faces = boundary_faces(model, cell_region, embedded, execution);
    Domain domain(model, faces.triangles, execution.progress);
    if (domain.empty()) throw InputError("nothing", "the model has no boundary");
    auto lengths = edge_lengths(model, faces, edge_length, tolerance, sizes);
    const std::size_t most = most_points(model, faces, lengths, tolerance, execution.progress);
    const auto on_edges = points_on_edges(model, faces.sharp_edges, lengths);
    const auto seeds = surface_seeds(model, faces.triangles, on_edges, lengths, kSeeds);
    const EdgeLength length{&lengths};
    const Criteria criteria(length, tolerance);
    Complex complex;
    try {
        begin_phase(execution.progress, 0.2, 0.7, "dividing into tetrahedra");
        for (const auto& p : on_edges)
            insert(complex, p, kBall * length(point_of(p), 1, 1), 1, 1);
        for (const SurfaceSeed& seed : seeds)
            insert(complex, seed.point, 0, 2,
                   faces.triangles[index(seed.triangle)].surface + kFirstSurface);
        if (complex.triangulation().dimension() < 3) refuse_nothing();
        refine(complex, domain, criteria, most, execution.progress);
        begin_phase(execution.progress, 0.7, 1.0, "removing flat tetrahedra");
        CGAL::exude_mesh_3(complex, CGAL::parameters::sliver_bound = kSliver);
    } catch (const CGAL::Failure_exception&) {
        refuse_division();
    }
    FilledMesh mesh = arrays_of(complex, domain, embedded);
    require_volume(mesh);
    divide_corner_tetrahedra(mesh, execution.progress);
    sort_outside_faces(mesh, model, faces.triangles, kReach * lengths.largest(),
                       execution.progress);
    divide_corner_tetrahedra(mesh, execution.progress);  // what was covered at sharp edges
    thicken_flat_tetrahedra(mesh, tolerance, execution.progress);
    return mesh;
}

}  // namespace realmodel::simulation
