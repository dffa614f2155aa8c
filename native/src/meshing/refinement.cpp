// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/refinement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <queue>
#include <string>
#include <vector>

#include "realmodel/base/errors.hpp"

namespace realmodel::meshing {

namespace {

using Face = Cdt::Face_handle;
using Vertex = Cdt::Vertex_handle;
using Point = Kernel::Point_2;

double squared(const Point& a, const Point& b) {
    const double dx = b.x() - a.x(), dy = b.y() - a.y();
    return dx * dx + dy * dy;
}

Point middle(const Point& a, const Point& b) {
    return {a.x() + 0.5 * (b.x() - a.x()), a.y() + 0.5 * (b.y() - a.y())};
}

bool left_turn(const Point& a, const Point& b, const Point& c) {
    return CGAL::orientation(a, b, c) == CGAL::LEFT_TURN;
}

/// A face that misses the target, worst first. It may have changed since: then it is passed over.
struct BadFace {
    double sine2;  ///< squared sine of its least angle
    std::uint64_t order;
    Face face;
    std::array<std::int32_t, 3> corners;

    bool operator<(const BadFace& other) const {
        return sine2 != other.sine2 ? sine2 > other.sine2 : order > other.order;
    }
};

/// Where a straight walk through the domain ended.
struct Arrival {
    enum Kind { inside, behind_border, nowhere } kind;
    Face face;
    int edge;  ///< behind_border: the border edge met; inside: the edge it lies on, or -1
};

class Refinement {
public:
    Refinement(Cdt& cdt, const RefinementTarget& target, std::int32_t first_number,
               const Check& check)
        : cdt_(cdt),
          target_(target),
          least_sine2_(std::pow(std::sin(target.least_angle), 2)),
          number_(first_number),
          check_(check) {}

    void run() {
        Ticker tick(check_);
        for (const Face face : cdt_.finite_face_handles()) {
            tick(0);
            enqueue_if_bad(face);
        }
        std::size_t steps = 0;
        while (!queue_.empty()) {
            if (++steps % 256 == 0) check_(0.5);
            const BadFace bad = queue_.top();
            queue_.pop();
            if (bad.corners == numbers(bad.face) && improve(bad.face)) enqueue_if_bad(bad.face);
        }
    }

private:
    static std::array<std::int32_t, 3> numbers(Face face) {
        return {face->vertex(0)->number, face->vertex(1)->number, face->vertex(2)->number};
    }

    void enqueue_if_bad(Face face) {
        if (!face->is_in_domain()) return;
        std::array<double, 3> opposite;  // squared edge lengths
        for (int i = 0; i < 3; ++i) {
            opposite[i] =
                squared(face->vertex(Cdt::ccw(i))->point(), face->vertex(Cdt::cw(i))->point());
        }
        const auto [shortest, longest] = std::minmax_element(opposite.begin(), opposite.end());
        if (*shortest <= target_.shortest_edge * target_.shortest_edge) return;
        const Point &a = face->vertex(0)->point(), &b = face->vertex(1)->point(),
                    &c = face->vertex(2)->point();
        const double twice_area =
            (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
        double sine2 = 1;
        for (int i = 0; i < 3; ++i) {
            // An angle between two border edges is given: no vertex can widen it.
            if (face->is_constrained(Cdt::ccw(i)) && face->is_constrained(Cdt::cw(i))) continue;
            sine2 = std::min(
                sine2, twice_area * twice_area / (opposite[Cdt::ccw(i)] * opposite[Cdt::cw(i)]));
        }
        if (sine2 >= least_sine2_ && *longest <= target_.longest_edge * target_.longest_edge) {
            return;
        }
        queue_.push({sine2, order_++, face, numbers(face)});
    }

    /// Adds one vertex for the sake of a bad face; false if there is none to add.
    bool improve(Face face) {
        const std::optional<Point> centre = circumcentre(face);
        if (!centre) return false;
        const Arrival at = walk_to(face, *centre);
        if (at.kind == Arrival::nowhere) return false;
        if (at.kind == Arrival::behind_border) return cut_border(at.face, at.edge);

        conflict_border_.clear();
        cdt_.get_boundary_of_conflicts(*centre, std::back_inserter(conflict_border_), at.face);
        for (const Cdt::Edge& edge : conflict_border_) {
            if (edge.first->is_constrained(edge.second) && encroaches(*centre, edge)) {
                return cut_border(edge.first, edge.second);
            }
        }
        const Vertex vertex = at.edge < 0 ? cdt_.insert(*centre, Cdt::FACE, at.face, 0)
                                          : cdt_.insert(*centre, Cdt::EDGE, at.face, at.edge);
        name(vertex);
        Cdt::Face_circulator around = cdt_.incident_faces(vertex), first = around;
        do
            around->set_in_domain(true);
        while (++around != first);
        enqueue_star(vertex);
        return true;
    }

    static std::optional<Point> circumcentre(Face face) {
        const Point& a = face->vertex(0)->point();
        const double bx = face->vertex(1)->point().x() - a.x(),
                     by = face->vertex(1)->point().y() - a.y(),
                     cx = face->vertex(2)->point().x() - a.x(),
                     cy = face->vertex(2)->point().y() - a.y();
        const double twice_area = bx * cy - by * cx;
        const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
        const double x = (cy * b2 - by * c2) / (2 * twice_area),
                     y = (bx * c2 - cx * b2) / (2 * twice_area);
        if (!std::isfinite(x) || !std::isfinite(y)) return std::nullopt;
        return Point(a.x() + x, a.y() + y);
    }

    /// Goes from a face straight to its circumcentre, and stops at the first border edge.
    Arrival walk_to(Face face, const Point& goal) const {
        int edge = -1;  // the edge to leave through
        int on_edge = -1;
        int zeros = 0;
        for (int i = 0; i < 3; ++i) {
            const auto side = CGAL::orientation(face->vertex(Cdt::ccw(i))->point(),
                                                face->vertex(Cdt::cw(i))->point(), goal);
            if (side == CGAL::RIGHT_TURN) edge = i;
            if (side == CGAL::COLLINEAR) {
                on_edge = i;
                ++zeros;
            }
        }
        if (edge < 0) return arrival_in(face, on_edge, zeros);

        const Point start = face->vertex(edge)->point();
        if (left_turn(start, goal, face->vertex(Cdt::ccw(edge))->point()) ||
            left_turn(goal, start, face->vertex(Cdt::cw(edge))->point())) {
            return {Arrival::nowhere, {}, -1};  // rounded to beyond two edges: too thin to judge
        }
        while (true) {
            if (face->is_constrained(edge)) return {Arrival::behind_border, face, edge};
            const Face next = face->neighbor(edge);
            if (cdt_.is_infinite(next)) return {Arrival::nowhere, {}, -1};
            const int apex = next->index(face) /* the corner opposite the shared edge */;
            const int right = Cdt::ccw(apex), left = Cdt::cw(apex);  // edges to leave through
            zeros = 0;
            on_edge = -1;
            bool within = true;
            std::array<bool, 3> beyond{};
            for (const int i : {right, left}) {
                const auto side = CGAL::orientation(next->vertex(Cdt::ccw(i))->point(),
                                                    next->vertex(Cdt::cw(i))->point(), goal);
                beyond[i] = side == CGAL::RIGHT_TURN;
                within = within && !beyond[i];
                if (side == CGAL::COLLINEAR) {
                    on_edge = i;
                    ++zeros;
                }
            }
            if (within) return arrival_in(next, on_edge, zeros);
            const auto apex_side = CGAL::orientation(start, goal, next->vertex(apex)->point());
            if (apex_side == CGAL::COLLINEAR) {
                edge = beyond[right] ? right : left;
            } else {
                edge = apex_side == CGAL::LEFT_TURN ? right : left;
            }
            face = next;
        }
    }

    static Arrival arrival_in(Face face, int on_edge, int zeros) {
        if (zeros > 1) return {Arrival::nowhere, {}, -1};  // a vertex is there already
        if (on_edge >= 0 && face->is_constrained(on_edge)) {
            return {Arrival::behind_border, face, on_edge};
        }
        return {Arrival::inside, face, on_edge};
    }

    /// Whether a point sees a border edge under more than 120 degrees (the lens of 30 degrees).
    static bool encroaches(const Point& p, const Cdt::Edge& edge) {
        const Point& a = edge.first->vertex(Cdt::ccw(edge.second))->point();
        const Point& b = edge.first->vertex(Cdt::cw(edge.second))->point();
        const double dot = (a.x() - p.x()) * (b.x() - p.x()) + (a.y() - p.y()) * (b.y() - p.y());
        return dot < 0 && dot * dot > 0.25 * squared(a, p) * squared(b, p);
    }

    /// Cuts a border edge in two; false where it is as short as it may get, or where the rounded
    /// middle would turn a triangle over.
    bool cut_border(Face face, int i) {
        const Vertex a = face->vertex(Cdt::ccw(i)), b = face->vertex(Cdt::cw(i));
        if (squared(a->point(), b->point()) <= 4 * target_.shortest_edge * target_.shortest_edge) {
            return false;
        }
        const Point m = middle(a->point(), b->point());
        const Face across = face->neighbor(i);
        const Point& left = face->vertex(i)->point();
        const Point& right = across->vertex(across->index(face))->point();
        if (!left_turn(left, a->point(), m) || !left_turn(left, m, b->point()) ||
            !left_turn(right, b->point(), m) || !left_turn(right, m, a->point())) {
            return false;
        }
        const bool left_inside = face->is_in_domain(), right_inside = across->is_in_domain();
        const Vertex vertex = cdt_.insert(m, Cdt::EDGE, face, i);
        name(vertex);
        // Counter-clockwise from b to a the faces lie left of the border, from a to b right of it.
        Cdt::Face_circulator around = cdt_.incident_faces(vertex);
        while (around->vertex(Cdt::ccw(around->index(vertex))) != b)
            ++around;
        const Cdt::Face_circulator first = around;
        bool inside = left_inside;
        do {
            around->set_in_domain(inside);
            if (around->vertex(Cdt::cw(around->index(vertex))) == a) inside = right_inside;
        } while (++around != first);
        enqueue_star(vertex);
        return true;
    }

    void name(Vertex vertex) {
        vertex->number = number_++;
        if (cdt_.number_of_vertices() <= target_.most_vertices) return;
        const Point& p = vertex->point();
        throw InputError("too_large",
                         "the mesh needs more than " + std::to_string(target_.most_vertices) +
                             " vertices, because of fine detail of the outlines; simplify them or "
                             "use a larger edge length",
                         -1, {}, std::array{p.x(), p.y(), 0.0});
    }

    void enqueue_star(Vertex vertex) {
        Cdt::Face_circulator around = cdt_.incident_faces(vertex), first = around;
        do
            enqueue_if_bad(around);
        while (++around != first);
    }

    Cdt& cdt_;
    RefinementTarget target_;
    double least_sine2_;
    std::int32_t number_;
    const Check& check_;
    std::priority_queue<BadFace> queue_;
    std::uint64_t order_ = 0;
    std::vector<Cdt::Edge> conflict_border_;
};

}  // namespace

void refine(Cdt& cdt, const RefinementTarget& target, std::int32_t first_number,
            const Check& check) {
    Refinement(cdt, target, first_number, check).run();
}

}  // namespace realmodel::meshing
