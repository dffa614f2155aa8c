// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/simulation/clean_cells.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>

#include "base/algorithms.hpp"
#include "base/parallel.hpp"
#include "base/vectors.hpp"
#include "simulation/cleaning/editable_complex.hpp"

namespace realmodel::simulation {

namespace {

constexpr int kRounds = 6;
/// Volume changes that differ by less than this share are alike: then the height decides.
constexpr double kAlike = 1e-3;

class Cleaning {
public:
    Cleaning(const ComplexView& model, std::span<const std::int32_t> surface_kind, double tolerance,
             const Execution& execution)
        : complex_(model, execution),
          check_(complex_, surface_kind),
          tolerance_(tolerance),
          progress_(execution.progress),
          moved_(model.vertex_count(), 0.0) {}

    CleanedCells run() {
        const std::vector<double> volumes = complex_.block_volumes();
        const ComplexCounts before = complex_.counts();
        for (int round = 0; round < kRounds; ++round) {
            changes_ = 0;
            queue_ = EdgeQueue(std::greater<>(), short_edges());
            join_short_edges();
            give_up_thin_faces();
            join_short_edges();
            join_thin_cells();
            if (changes_ == 0) break;
        }
        divide_cells_of_few_faces();
        CleanedCells made = complex_.taken();
        made.volumes_before = volumes;
        made.before = before;
        made.after = complex_.counts();
        made.short_edges = short_edges().size();
        made.thin_cells = thin_cells().size();
        made.largest_move = moved_.empty() ? 0.0 : std::ranges::max(moved_);
        return made;
    }

private:
    struct ShortEdge {
        double length;
        std::int32_t from, to;
        auto operator<=>(const ShortEdge&) const = default;
    };
    using EdgeQueue = std::priority_queue<ShortEdge, std::vector<ShortEdge>, std::greater<>>;
    struct ThinCell {
        double width;
        std::int32_t cell;
        auto operator<=>(const ThinCell&) const = default;
    };

    /// Adds the short edges of a loop, or only those at one of its corners.
    void list_edges_of(std::span<const std::int32_t> loop, std::int32_t only,
                       std::vector<ShortEdge>& listed) const {
        std::int32_t from = loop.back();
        for (const std::int32_t to : loop) {
            const auto [low, high] = unordered(from, to);
            from = to;
            if (only >= 0 && low != only && high != only) continue;
            const double length = complex_.distance(low, high);
            if (length < tolerance_) listed.push_back({length, low, high});
        }
    }

    /// All short edges, each once.
    std::vector<ShortEdge> short_edges() const {
        std::vector<ShortEdge> edges;
        for (std::int32_t f = 0; f < complex_.face_count(); ++f) {
            if (complex_.has_face(f)) list_edges_of(complex_.corners(f), -1, edges);
        }
        sort_unique(edges);
        return edges;
    }

    bool is_edge(std::int32_t from, std::int32_t to) const {
        for (const std::int32_t f : complex_.vertex_faces(from)) {
            if (next_to(complex_.corners(f), from, to)) return true;
        }
        return false;
    }

    static bool next_to(std::span<const std::int32_t> loop, std::int32_t u, std::int32_t v) {
        const auto neighbors = beside(loop, u);
        return neighbors && contains(*neighbors, v);
    }

    void join_short_edges() {
        ShortEdge last{-1, -1, -1};
        for (std::size_t round = 0; !queue_.empty(); ++round) {
            poll(progress_, round);
            const ShortEdge edge = queue_.top();
            queue_.pop();
            if (edge == last) continue;
            last = edge;
            if (is_edge(edge.from, edge.to)) join(edge);
        }
    }

    /// Joins one end with the other, whichever changes volumes less.
    void join(const ShortEdge& edge) {
        const bool forward = moves(edge.from, edge.to, change_);
        const double cost = check_.volume_change();
        const bool backward = moves(edge.to, edge.from, other_);
        if (!forward && !backward) return;
        bool takes_other = !forward;
        if (forward && backward) {
            const double difference = cost - check_.volume_change();
            const double least = kAlike * std::max(cost, check_.volume_change());
            const Vec3 a = complex_.point(edge.from), b = complex_.point(edge.to);
            takes_other = std::abs(difference) > least
                              ? difference > 0
                              : std::tie(a[2], a[0], a[1]) > std::tie(b[2], b[0], b[1]);
        }
        const std::int32_t gone = takes_other ? edge.to : edge.from;
        const std::int32_t target = takes_other ? edge.from : edge.to;
        moved_[index(target)] = std::max(moved_[index(target)], moved_[index(gone)] + edge.length);
        apply(takes_other ? other_ : change_, target);
    }

    /// The change that brings a vertex to another one.
    bool moves(std::int32_t gone, std::int32_t target, Change& change) {
        if (moved_[index(gone)] + complex_.distance(gone, target) > tolerance_) return false;
        change.clear();
        beside_edge_.clear();
        for (const std::int32_t f : complex_.vertex_faces(gone)) {
            const auto loop = complex_.corners(f);
            loop_.assign(loop.begin(), loop.end());
            if (contains(loop_, target)) {
                const auto& cells = complex_.cells(f);
                std::vector<std::int32_t>& of =
                    next_to(loop, gone, target) ? beside_edge_ : change.tested;
                of.insert(of.end(), cells.begin(), cells.end());
            }
            std::replace(loop_.begin(), loop_.end(), gone, target);
            change.removed.push_back(f);
            change.add(loop_, f, complex_.cells(f), complex_.surface(f));
        }
        // cells with both vertices, but not with the edge
        target_cells_.clear();
        for (const std::int32_t f : complex_.vertex_faces(target))
            target_cells_.insert(target_cells_.end(), complex_.cells(f).begin(),
                                 complex_.cells(f).end());
        for (const std::int32_t f : change.removed) {
            for (const std::int32_t c : complex_.cells(f)) {
                if (!contains(beside_edge_, c) && contains(target_cells_, c))
                    change.tested.push_back(c);
            }
        }
        return check_.settle(change, target);
    }

    void apply(const Change& change, std::int32_t vertex) {
        complex_.apply(change);
        ++changes_;
        if (vertex < 0) return;
        fresh_edges_.clear();
        for (const std::int32_t f : complex_.vertex_faces(vertex))
            list_edges_of(complex_.corners(f), vertex, fresh_edges_);
        sort_unique(fresh_edges_);
        for (const ShortEdge& edge : fresh_edges_)
            queue_.push(edge);
    }

    void give_up_thin_faces() {
        for (std::int32_t f = 0; f < complex_.face_count(); ++f) {
            poll(progress_, index(f));
            if (complex_.has_face(f)) give_up_thin(f);
        }
    }

    /// Brings the longest edge of a thin face to a vertex across from it: the face is divided there
    /// into thinner ones, triangles vanish.
    void give_up_thin(std::int32_t face) {
        const auto loop = complex_.corners(face);
        const std::size_t n = loop.size();
        std::size_t longest = 0;
        double most = -1;
        for (std::size_t i = 0; i < n; ++i) {
            const double length = complex_.distance(loop[i], loop[(i + 1) % n]);
            if (length > most) {
                most = length;
                longest = i;
            }
        }
        // a polygon is at least as wide as its area over its longest edge is
        if (!(length(complex_.shape(face).area) < tolerance_ * most)) return;
        const std::int32_t from = loop[longest], to = loop[(longest + 1) % n];
        const Vec3 start = complex_.point(from);
        const Vec3 way = times(1 / most, minus(complex_.point(to), start));
        std::int32_t nearest = -1;
        double least = tolerance_, widest = 0;
        for (const std::int32_t v : loop) {
            if (v == from || v == to) continue;
            const Vec3 arm = minus(complex_.point(v), start);
            const double along = dot(arm, way);
            const double across = length(minus(arm, times(along, way)));
            widest = std::max(widest, across);
            if (along > 0 && along < most && across < least) {
                least = across;
                nearest = v;
            }
        }
        if (nearest < 0 || !(widest < tolerance_)) return;
        change_.clear();
        for (const std::int32_t f : complex_.vertex_faces(from)) {
            const auto corners = complex_.corners(f);
            if (!next_to(corners, from, to)) continue;
            loop_.clear();
            for (std::size_t i = 0; i < corners.size(); ++i) {
                loop_.push_back(corners[i]);
                const std::int32_t after = corners[(i + 1) % corners.size()];
                if ((corners[i] == from && after == to) || (corners[i] == to && after == from))
                    loop_.push_back(nearest);
            }
            change_.removed.push_back(f);
            for (const std::int32_t c : complex_.cells(f))
                change_.tested.push_back(c);
            change_.add(loop_, f, complex_.cells(f), complex_.surface(f));
        }
        if (check_.settle(change_, nearest)) apply(change_, nearest);
    }

    /// How far its vertices lie from the plane of one of its faces: of the one where that is least.
    double width(std::int32_t cell) {
        std::vector<std::int32_t>& vertices = loop_;
        vertices.clear();
        for (const std::int32_t f : complex_.cell_faces(cell)) {
            const auto loop = complex_.corners(f);
            vertices.insert(vertices.end(), loop.begin(), loop.end());
        }
        double least = tolerance_;
        for (const std::int32_t f : complex_.cell_faces(cell)) {
            const FaceVectors& face = complex_.shape(f);
            const double area = length(face.area);
            if (!(area > 0)) continue;
            double most = 0;
            for (std::size_t i = 0; i < vertices.size() && most < least; ++i) {
                const Vec3 arm = minus(complex_.point(vertices[i]), face.center);
                most = std::max(most, std::abs(dot(arm, face.area)) / area);
            }
            least = std::min(least, most);
        }
        return least;
    }

    /// Cells of three faces with bent sides: solvers refuse them.
    bool has_few_faces(std::int32_t cell) const { return complex_.cell_faces(cell).size() < 4; }

    std::vector<ThinCell> thin_cells() {
        std::vector<ThinCell> cells;
        for (std::int32_t c = 0; c < complex_.cell_count(); ++c) {
            poll(progress_, index(c));
            // a cell is at least as wide as twice its volume over its area
            if (!complex_.has_cell(c)) continue;
            if (has_few_faces(c)) {
                cells.push_back({0, c});
                continue;
            }
            if (!(2 * complex_.cell(c).volume < tolerance_ * complex_.cell(c).area)) continue;
            const double cell_width = width(c);
            if (cell_width < tolerance_) cells.push_back({cell_width, c});
        }
        std::sort(cells.begin(), cells.end());
        return cells;
    }

    void join_thin_cells() {
        std::size_t round = 0;
        for (const ThinCell& thin : thin_cells()) {
            poll(progress_, round++);
            if (complex_.has_cell(thin.cell) &&
                (has_few_faces(thin.cell) || width(thin.cell) < tolerance_))
                join_with_neighbor(thin.cell);
        }
    }

    /// Divides a bent face of cells that have three and found no neighbor to join.
    void divide_cells_of_few_faces() {
        for (std::int32_t c = 0; c < complex_.cell_count(); ++c) {
            if (!complex_.has_cell(c) || !has_few_faces(c)) continue;
            for (const std::int32_t f : complex_.cell_faces(c)) {
                if (divides(f)) break;
            }
        }
    }

    /// Divides a face by the first of its diagonals that can be.
    bool divides(std::int32_t face) {
        const auto corners = complex_.corners(face);
        const std::vector<std::int32_t> loop(corners.begin(), corners.end());
        for (std::size_t i = 0; i < loop.size(); ++i) {
            for (std::size_t j = i + 2; j < loop.size() && j - i + 1 < loop.size(); ++j) {
                const auto at = [&](std::size_t k) {
                    return loop.begin() + static_cast<std::ptrdiff_t>(k);
                };
                change_.clear();
                change_.removed.push_back(face);
                change_.tested.assign(complex_.cells(face).begin(), complex_.cells(face).end());
                loop_.assign(at(i), at(j) + 1);
                change_.add(loop_, face, complex_.cells(face), complex_.surface(face));
                loop_.assign(at(j), loop.end());
                loop_.insert(loop_.end(), loop.begin(), at(i) + 1);
                change_.add(loop_, face, complex_.cells(face), complex_.surface(face));
                if (!check_.settle(change_, loop[i])) continue;
                complex_.apply(change_);
                return true;
            }
        }
        return false;
    }

    struct NeighborCell {
        double area = 0;
        std::int32_t cell = -1;
        bool has_fault = false;
    };

    void join_with_neighbor(std::int32_t cell) {
        std::vector<NeighborCell> neighbors;
        for (const std::int32_t f : complex_.cell_faces(cell)) {
            const auto [a, b] = complex_.cells(f);
            const std::int32_t other = a == cell ? b : a;
            if (other < 0) continue;
            auto match = std::find_if(neighbors.begin(), neighbors.end(),
                                      [&](const NeighborCell& n) { return n.cell == other; });
            if (match == neighbors.end()) match = neighbors.insert(match, {0, other, false});
            match->area += length(complex_.shape(f).area);
            match->has_fault = match->has_fault || check_.is_fault(complex_.surface(f));
        }
        double most = 0;
        for (const NeighborCell& n : neighbors)
            most = std::max(most, n.area);
        // of neighbors across its flat sides one of the same block loses nothing
        const auto rank = [&](const NeighborCell& n) {
            const bool is_same_block = complex_.block(n.cell) == complex_.block(cell);
            return std::tuple(!(is_same_block && n.area > most / 2), -n.area, n.cell);
        };
        std::ranges::sort(neighbors, {}, rank);
        for (const NeighborCell& n : neighbors) {
            if (n.has_fault || n.area < most / 4) continue;
            change_.clear();
            change_.tested.push_back(n.cell);
            for (const std::int32_t f : complex_.cell_faces(cell)) {
                auto cells = complex_.cells(f);
                change_.removed.push_back(f);
                if (cells[0] == n.cell || cells[1] == n.cell) continue;
                (cells[0] == cell ? cells[0] : cells[1]) = n.cell;
                change_.add(complex_.corners(f), f, cells, complex_.surface(f));
            }
            if (!check_.settle(change_, -1)) continue;
            apply(change_, -1);
            return;
        }
    }

    EditableComplex complex_;
    ChangeCheck check_;
    double tolerance_;
    Progress* progress_;
    std::vector<double> moved_;  // how far what was joined in each vertex has moved
    std::vector<ShortEdge> fresh_edges_;
    EdgeQueue queue_;  // short edges, the shortest first; some are gone since, or twice there
    Change change_, other_;
    std::vector<std::int32_t> loop_, beside_edge_, target_cells_;
    std::size_t changes_ = 0;
};

}  // namespace

CleanedCells clean_cells(const ComplexView& model, std::span<const std::int32_t> surface_kind,
                         double tolerance, const Execution& execution) {
    return Cleaning(model, surface_kind, tolerance, execution).run();
}

}  // namespace realmodel::simulation
