// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/simulation/layered_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/parallel_counts.hpp"
#include "realmodel/base/errors.hpp"
#include "simulation/column_heights.hpp"
#include "simulation/narrow_strips.hpp"
#include "simulation/plan_topology.hpp"
#include "simulation/post_columns.hpp"
#include "simulation/post_levels.hpp"
#include "simulation/vertical_faults.hpp"

namespace realmodel::simulation {

namespace {

constexpr double kWeakDeterminant = 0.0011;  ///< of a cube it is 1; its limit is 0.001
constexpr double kMostLean = 0.36;           ///< cosine of 69 degrees; its limit is 70
constexpr double kSteepFace = 0.5;           ///< cosine: of 60 degrees
constexpr double kNoDeterminant = 1e-8;      ///< inner faces in two directions only
constexpr double kThickEnd = 3;  ///< minimum thicknesses: no block gives up an end as thick
constexpr int kRepairs = 30;
constexpr double kEasedFace = 0.8;  ///< cosine: flatter faces are not what makes lines lean
constexpr double kEasedShare = 0.1;
constexpr int kEasings = 40;

using Front = std::array<std::int32_t, 3>;  ///< of each corner of a triangle: a height of its node

/// Fills the columns of all triangles from the bottom up. A front, one height at each corner, moves
/// up step by step; what lies between two fronts is an element. All three corners move by one
/// height each: a prism; two: a pyramid; one: a tetrahedron.
class ColumnFiller {
public:
    ColumnFiller(const PlanTopology& plan, const RockBlocks& blocks, const ColumnHeights& columns,
                 const PostLevels& levels, double minimum_thickness, LayeredMesh& mesh)
        : plan_(plan),
          blocks_(blocks),
          columns_(columns),
          levels_(levels),
          minimum_thickness_(minimum_thickness),
          mesh_(mesh),
          elements_(plan.triangles(), 0),
          is_parted_(levels.level_count(), 0) {
        find_parted();
    }

    /// @return whether anything stands on the triangle
    bool fill(std::size_t t) {
        if (!load(t)) return false;
        const auto layer_blocks = levels_.layer_blocks(rock_);
        for (std::size_t i = 0; i < 3; ++i)
            front_[i] = own_[i][0];
        last_block_ = -1;
        fronts_.assign(1, front_);
        front_blocks_.clear();
        for (std::size_t l = 0; l < layer_blocks.size(); ++l) {
            block_ = layer_blocks[l];
            layer_ = static_cast<std::int32_t>(l);
            const Front top{own_[0][l + 1], own_[1][l + 1], own_[2][l + 1]};
            if (top == front_) continue;
            Front parted = front_;
            for (std::size_t i = 0; i < 3; ++i) {
                if (is_parted_[levels_.level_offset(post_[i]) + l] != 0) parted[i] = top[i];
            }
            if (has_step_ && parted != front_) pass_lines(parted);
            move(parted);
            move(top);
        }
        if (last_block_ >= 0) add_flat_face(-1);
        elements_[t] = static_cast<std::int32_t>(fronts_.size()) - 1;
        find_weak();
        return true;
    }

    /// Faces on steps that only one side has belong to the outside; those that both have are told
    /// of where a fault is.
    void finish_steps(const VerticalFaults& faults) {
        std::sort(step_faces_.begin(), step_faces_.end(), [](const SideFace& a, const SideFace& b) {
            return std::tie(a.key, a.number) < std::tie(b.key, b.number);
        });
        std::vector<const SideFace*> told;
        for (std::size_t i = 0; i < step_faces_.size();) {
            std::size_t j = i + 1;
            while (j < step_faces_.size() && step_faces_[j].key == step_faces_[i].key)
                ++j;
            SideFace& face = step_faces_[i];
            if (!faults.empty())
                face.surface = faults.fault_at(face.edge[0], face.edge[1], face.height);
            if (j == i + 1 || face.surface != kWall) told.push_back(&face);
            i = j;
        }
        std::sort(told.begin(), told.end(),
                  [](const SideFace* a, const SideFace* b) { return a->number < b->number; });
        for (const SideFace* face : told)
            add_side(face->corners, face->surface);
    }

    /// Of each steep face that the line between the centers of its elements crosses at too small an
    /// angle: by how much its corners would move to make it less steep. @pre fill(t) was the last
    void find_steep(std::vector<PostLevels::Move>& moves) const {
        for (std::size_t e = 0; e + 2 < fronts_.size(); ++e) {
            if (!leans_at(e, kEasedFace, true)) continue;
            const Front& face = fronts_[e + 1];
            double mean = 0;
            for (std::size_t i = 0; i < 3; ++i)
                mean += position(i, face[i])[2] / 3;
            for (std::size_t i = 0; i < 3; ++i)
                moves.push_back(
                    {node_[i], face[i], kEasedShare * (mean - position(i, face[i])[2])});
        }
    }

    /// How many elements each column has.
    std::span<const std::int32_t> elements() const { return elements_; }

    /// Heights to give up, so that no element is left that solvers call under-determined.
    /// @param is_narrow  narrow_strips()
    std::vector<PostLevels::Removal>& weak(std::span<const std::uint8_t> is_narrow) {
        for (const auto& [t, removal] : weak_alone_) {
            if (is_narrow[t] != 0) weak_.push_back(removal);
        }
        if (weak_.empty()) add_spare();
        return weak_;
    }

private:
    /// Heights of weak_last_ as long as no column around them has less than two elements then: one
    /// alone in its column would have no neighbor above, which is worse.
    void add_spare() {
        if (weak_last_.empty()) return;
        const auto around = bucketize<std::int32_t>(plan_.nodes(), [&](const auto& put) {
            for (std::size_t t = 0; t < plan_.triangles(); ++t) {
                for (const std::int32_t n : plan_.mesh().triangles[t])
                    put(index(n), static_cast<std::int32_t>(t));
            }
        });
        std::sort(weak_last_.begin(), weak_last_.end());
        std::int32_t done = -1;
        for (const PostLevels::Removal& removal : weak_last_) {
            const auto triangles = around[index(removal.node)];
            if (removal.node == done ||
                std::any_of(triangles.begin(), triangles.end(), [&](std::int32_t t) {
                    return elements_[index(t)] == 1 || elements_[index(t)] == 2;
                }))
                continue;
            done = removal.node;
            for (const std::int32_t t : triangles)
                --elements_[index(t)];
            weak_.push_back(removal);
        }
    }

    struct SideFace {
        std::array<std::int32_t, 4> key, corners;  // of a triangle the last corner is -1
        std::size_t number;
        std::array<PlanPoint, 2> edge;
        double height;  ///< of its center
        std::int32_t surface;
    };

    std::int32_t point(std::size_t corner, std::int32_t at) const {
        return static_cast<std::int32_t>(levels_.node_offset(index(node_[corner]))) + at;
    }
    Front points(const Front& front) const {
        return {point(0, front[0]), point(1, front[1]), point(2, front[2])};
    }

    /// The posts of a triangle; false where nothing stands on it.
    bool load(std::size_t t) {
        t_ = t;
        rock_ = plan_.rock(t);
        for (std::size_t i = 0; i < 3; ++i) {
            post_[i] = index(plan_.posts()[3 * t + i]);
            node_[i] = plan_.mesh().triangles[t][i];
            own_[i] = levels_.levels(post_[i]);
            if (columns_.rock(post_[i]) != rock_ || rock_ < 0) return false;
        }
        find_step();
        return true;
    }

    /// A layer of a post beside a step is parted where the other side has heights within it. There
    /// the corner moves before the others, in all triangles at the post; so do both ends of an edge
    /// on a step, if one of them does. (No other edge has two such ends: PlanTopology.)
    void find_parted() {
        std::vector<std::array<std::size_t, 2>> pairs;  // levels of both ends
        for (std::size_t t = 0; t < plan_.triangles(); ++t) {
            const auto& nodes = plan_.mesh().triangles[t];
            if (std::none_of(nodes.begin(), nodes.end(),
                             [&](std::int32_t n) { return plan_.is_divided(n); }) ||
                !load(t))
                continue;
            for (std::size_t i = 0; i < 3; ++i) {
                for (std::size_t l = 0; l + 1 < own_[i].size(); ++l) {
                    if (own_[i][l + 1] > own_[i][l] + 1)
                        is_parted_[levels_.level_offset(post_[i]) + l] = 1;
                }
            }
            if (!has_step_) continue;
            const auto [u, v] = step_;
            for (std::size_t l = 0; l + 1 < own_[u].size(); ++l) {
                const std::size_t at_u = levels_.level_offset(post_[u]) + l,
                                  at_v = levels_.level_offset(post_[v]) + l;
                pairs.push_back({at_u, at_v});
                const std::array<std::int32_t, 2> low{own_[u][l], own_[v][l]},
                    high{own_[u][l + 1], own_[v][l + 1]};
                const bool parted =
                    std::any_of(lines_.begin(), lines_.end(), [&](const auto& line) {
                        return line[0] >= low[0] && line[1] >= low[1] && line[0] <= high[0] &&
                               line[1] <= high[1] && line != low && line != high;
                    });
                if (parted) is_parted_[at_u] = is_parted_[at_v] = 1;
            }
        }
        for (bool any = true; any;) {
            any = false;
            for (const auto& [u, v] : pairs) {
                if (is_parted_[u] == is_parted_[v]) continue;
                is_parted_[u] = is_parted_[v] = 1;
                any = true;
            }
        }
    }

    /// The edge on a step, and the levels of the other side along it.
    void find_step() {
        has_step_ = false;
        for (std::size_t i = 0; i < 3; ++i) {
            if (!plan_.is_step(t_, i) || plan_.neighbor(t_, i) < 0) continue;
            has_step_ = true;
            step_ = {i, (i + 1) % 3};
            const auto other = index(plan_.neighbor(t_, i));
            std::array<std::span<const std::int32_t>, 2> beyond;
            for (std::size_t k = 0; k < 2; ++k) {
                for (std::size_t j = 0; j < 3; ++j) {
                    if (plan_.mesh().triangles[other][j] == node_[step_[k]])
                        beyond[k] = levels_.levels(index(plan_.posts()[3 * other + j]));
                }
            }
            lines_.clear();
            for (std::size_t l = 0; l < beyond[0].size(); ++l)
                lines_.push_back({beyond[0][l], beyond[1][l]});
            std::sort(lines_.begin(), lines_.end());
            lines_.erase(std::unique(lines_.begin(), lines_.end()), lines_.end());
        }
    }

    /// Moves along the levels of the other side of the step that lie between the front and its next
    /// place.
    void pass_lines(const Front& top) {
        const auto [u, v] = step_;
        for (const auto& [to_u, to_v] : lines_) {
            if (to_u < front_[u] || to_v < front_[v] || to_u > top[u] || to_v > top[v]) continue;
            if ((to_u == front_[u] && to_v == front_[v]) || (to_u == top[u] && to_v == top[v]))
                continue;
            Front next = front_;
            next[u] = to_u;
            next[v] = to_v;
            move(next);
        }
    }

    /// Moves the front; corners that have heights in between go alone first, in the order of their
    /// nodes, so that both triangles at an edge do the same.
    void move(const Front& to) {
        std::array<std::size_t, 3> corners{0, 1, 2};
        std::sort(corners.begin(), corners.end(),
                  [&](std::size_t a, std::size_t b) { return node_[a] < node_[b]; });
        for (const std::size_t c : corners) {
            while (front_[c] + 1 < to[c]) {
                Front next = front_;
                ++next[c];
                advance(next);
            }
        }
        advance(to);
    }

    void advance(const Front& to) {
        if (to == front_) return;
        if (last_block_ != block_) add_flat_face(block_);
        last_block_ = block_;
        const Front low = points(front_), high = points(to);
        std::size_t moved = 0;
        for (std::size_t i = 0; i < 3; ++i)
            moved += to[i] != front_[i];
        if (moved == 3) {
            add(mesh_.prisms, {low[0], low[1], low[2], high[0], high[1], high[2]});
        } else if (moved == 2) {
            std::size_t c = 0;
            while (to[c] != front_[c])
                ++c;
            const std::size_t a = (c + 1) % 3, b = (c + 2) % 3;
            add(mesh_.pyramids, {low[b], low[a], high[a], high[b], low[c]});
        } else {
            std::size_t a = 0;
            while (to[a] == front_[a])
                ++a;
            add(mesh_.tetrahedra, {low[0], low[1], low[2], high[a]});
        }
        const PlanPoint &o = plan_.mesh().vertices[index(node_[0])],
                        &p = plan_.mesh().vertices[index(node_[1])],
                        &q = plan_.mesh().vertices[index(node_[2])];
        const double area = ((p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0])) / 2;
        double rise = 0;
        for (std::size_t i = 0; i < 3; ++i)
            rise += levels_.heights(node_[i])[index(to[i])] -
                    levels_.heights(node_[i])[index(front_[i])];
        mesh_.volumes[index(block_)] += area * rise / 3;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t j = (i + 1) % 3;
            const bool outside = plan_.neighbor(t_, i) < 0;
            if (!outside && !plan_.is_step(t_, i)) continue;
            if (low[i] == high[i] && low[j] == high[j]) continue;
            std::array<std::int32_t, 4> corners{low[i], low[j], high[j], high[i]};
            if (low[j] == high[j]) corners = {low[i], low[j], high[i], -1};
            if (low[i] == high[i]) corners = {low[i], low[j], high[j], -1};
            if (outside) {
                add_side(corners, kWall);
            } else {
                std::array<std::int32_t, 4> key = corners;
                std::sort(key.begin(), key.end());
                const auto &a = plan_.mesh().vertices[index(node_[i])],
                           &b = plan_.mesh().vertices[index(node_[j])];
                const double height = (position(i, front_[i])[2] + position(i, to[i])[2] +
                                       position(j, front_[j])[2] + position(j, to[j])[2]) /
                                      4;
                step_faces_.push_back({key, corners, step_faces_.size(), {a, b}, height, kWall});
            }
        }
        front_ = to;
        fronts_.push_back(to);
        front_blocks_.push_back(block_);
    }

    /// The elements of a column that solvers do badly with, as OpenFOAM's checkMesh measures it:
    /// inner faces in too few directions to compute a gradient with (its cell determinant), or a
    /// line to the center of the next element that hardly crosses the face between the two. These
    /// are thin ends of layers. Their upright edges are given up.
    void find_weak() {
        const bool at_border =
            plan_.neighbor(t_, 0) < 0 || plan_.neighbor(t_, 1) < 0 || plan_.neighbor(t_, 2) < 0;
        const std::size_t count = fronts_.size() - 1;
        for (std::size_t e = 0; e < count; ++e) {
            const bool is_first = e == 0, is_last = e + 1 == count;
            const Front &low = fronts_[e], &high = fronts_[e + 1];
            if (moved_corners(e) == 3) {
                // a prism may become one with the next layer of its block, no more
                if (!at_border && !is_first && !is_last) continue;
                if (is_first == is_last || count < 3 ||
                    front_blocks_[e] != front_blocks_[is_first ? e + 1 : e - 1])
                    continue;
            }
            const double independence = determinant(low, high, is_first, is_last);
            const bool is_weak = independence < kWeakDeterminant,
                       leans = moved_corners(e) < 3 &&
                               ((!is_first && leans_at(e - 1, kSteepFace, false)) ||
                                (!is_last && leans_at(e, kSteepFace, false)));
            if (!is_weak && !leans) continue;
            for (std::size_t i = 0; i < 3; ++i) {
                if (low[i] == high[i]) continue;
                const bool upper = is_first && !is_last;  // which of its heights goes
                const std::int32_t gone = upper ? high[i] : low[i];
                const double rise = position(i, high[i])[2] - position(i, low[i])[2];
                // one alone in its column would only make its neighbor the end
                if ((independence > kNoDeterminant || (is_first && is_last)) &&
                    divides_blocks(i, gone) && rise >= kThickEnd * minimum_thickness_)
                    continue;
                const PostLevels::Removal removal{node_[i], gone, upper ? low[i] : high[i]};
                if (is_first && is_last)
                    weak_alone_.emplace_back(t_, removal);
                else if (!is_weak && own_[i].back() - own_[i].front() == 2)
                    weak_last_.push_back(removal);
                else
                    weak_.push_back(removal);
            }
        }
    }

    /// Whether a height is not just one between layers of one block: without it a block would lose
    /// volume.
    bool divides_blocks(std::size_t corner, std::int32_t height) const {
        const auto own = own_[corner];
        const auto blocks = levels_.layer_blocks(rock_);
        std::int32_t below = -1, above = -1;
        for (std::size_t l = 0; l + 1 < own.size(); ++l) {
            if (own[l] == own[l + 1]) continue;
            if (own[l + 1] == height) below = blocks[l];
            if (own[l] == height) above = blocks[l];
        }
        return below != above;
    }

    std::size_t moved_corners(std::size_t e) const {
        std::size_t moved = 0;
        for (std::size_t i = 0; i < 3; ++i)
            moved += fronts_[e][i] != fronts_[e + 1][i];
        return moved;
    }

    /// Whether the line between the centers of an element and the next one leans by more than
    /// kMostLean from the direction across the face between them. Asked of faces that are steeper,
    /// or flatter, than an angle of this cosine.
    bool leans_at(std::size_t e, double cosine, bool steeper) const {
        const auto below = center(e), above = center(e + 1), area = flat_area(fronts_[e + 1]);
        double dot = 0, line = 0, across = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            dot += (above[k] - below[k]) * area[k];
            line += (above[k] - below[k]) * (above[k] - below[k]);
            across += area[k] * area[k];
        }
        if ((area[2] < cosine * std::sqrt(across)) != steeper) return false;
        return dot < kMostLean * std::sqrt(line * across);
    }

    /// The center of an element's volume: its upright edges weigh as they are long.
    std::array<double, 3> center(std::size_t e) const {
        const Front &low = fronts_[e], &high = fronts_[e + 1];
        std::array<std::array<double, 3>, 3> from;
        std::array<double, 3> rise;
        double total = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            from[i] = position(i, low[i]);
            rise[i] = position(i, high[i])[2] - from[i][2];
            total += rise[i];
        }
        // integrals over a triangle of two linear functions: 1/12 of their products at different
        // corners, 1/6 at the same
        std::array<double, 3> made{};
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
                const double weight = (i == j ? 2 : 1) * rise[j] / (4 * total);
                made[0] += weight * from[i][0];
                made[1] += weight * from[i][1];
                made[2] += weight * (from[i][2] + rise[i] / 2);
            }
        }
        return made;
    }

    std::array<double, 3> flat_area(const Front& front) const {
        const auto a = position(0, front[0]), b = position(1, front[1]), c = position(2, front[2]);
        std::array<double, 3> u, v;
        for (std::size_t k = 0; k < 3; ++k) {
            u[k] = b[k] - a[k];
            v[k] = c[k] - a[k];
        }
        return {(u[1] * v[2] - u[2] * v[1]) / 2, (u[2] * v[0] - u[0] * v[2]) / 2,
                (u[0] * v[1] - u[1] * v[0]) / 2};
    }

    std::array<double, 3> position(std::size_t corner, std::int32_t at) const {
        const PlanPoint& p = plan_.mesh().vertices[index(node_[corner])];
        return {p[0], p[1], levels_.heights(node_[corner])[index(at)]};
    }

    double determinant(const Front& low, const Front& high, bool is_first, bool is_last) const {
        std::array<std::array<double, 3>, 5> areas;
        std::size_t count = 0;
        const auto add_flat = [&](const Front& front) { areas[count++] = flat_area(front); };
        if (!is_first) add_flat(low);
        if (!is_last) add_flat(high);
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t j = (i + 1) % 3;
            if (plan_.neighbor(t_, i) < 0 || (low[i] == high[i] && low[j] == high[j])) continue;
            const auto a = position(i, low[i]), b = position(j, low[j]);
            const double rise =
                (position(i, high[i])[2] - a[2] + position(j, high[j])[2] - b[2]) / 2;
            areas[count++] = {(b[1] - a[1]) * rise, -(b[0] - a[0]) * rise, 0};
        }
        double mean = 0;
        for (std::size_t f = 0; f < count; ++f)
            mean += std::sqrt(areas[f][0] * areas[f][0] + areas[f][1] * areas[f][1] +
                              areas[f][2] * areas[f][2]);
        if (!(mean > 0)) return 0;
        mean /= static_cast<double>(count);
        double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
        for (std::size_t f = 0; f < count; ++f) {
            const double x = areas[f][0] / mean, y = areas[f][1] / mean, z = areas[f][2] / mean;
            xx += x * x;
            xy += x * y;
            xz += x * z;
            yy += y * y;
            yz += y * z;
            zz += z * z;
        }
        return std::abs(xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) +
                        xz * (xy * yz - yy * xz)) /
               8;
    }

    template <std::size_t N>
    void add(LayeredMesh::Elements<N>& elements, const std::array<std::int32_t, N>& corners) {
        elements.corners.push_back(corners);
        elements.block.push_back(block_);
        elements.column.push_back(static_cast<std::int32_t>(t_));
        elements.layer.push_back(mesh_.layers - 1 - layer_);
    }

    void add_side(const std::array<std::int32_t, 4>& corners, std::int32_t surface) {
        if (corners[3] < 0) {
            mesh_.triangles.corners.push_back({corners[0], corners[1], corners[2]});
            mesh_.triangles.surface.push_back(surface);
        } else {
            mesh_.quadrilaterals.corners.push_back(corners);
            mesh_.quadrilaterals.surface.push_back(surface);
        }
    }

    /// The face at the front between the last block and the next; -1: outside.
    void add_flat_face(std::int32_t next) {
        Front corners = points(front_);
        if (last_block_ < 0) std::swap(corners[1], corners[2]);
        mesh_.triangles.corners.push_back(corners);
        mesh_.triangles.surface.push_back(surface_between(last_block_, next));
    }

    /// The surface at the top of one block, as most corners have it where there is that block.
    std::int32_t surface_between(std::int32_t below, std::int32_t above) const {
        const auto first = blocks_.first[index(rock_)];
        const auto level = below < 0   ? std::size_t{0}
                           : above < 0 ? index(blocks_.blocks_of(rock_))
                                       : static_cast<std::size_t>(below - first) + 1;
        std::int32_t best = -1, most = 0;
        for (const bool present_only : {true, false}) {
            const auto counts = [&](std::size_t i) {
                const auto z = columns_.levels(post_[i]);
                return !present_only || level == 0 || z[level] > z[level - 1];
            };
            for (std::size_t i = 0; i < 3; ++i) {
                const std::int32_t own = columns_.surfaces(post_[i])[level];
                std::int32_t votes = 0;
                for (std::size_t j = 0; j < 3; ++j)
                    votes += counts(j) && columns_.surfaces(post_[j])[level] == own ? 1 : 0;
                if (std::tie(votes, own) > std::tie(most, best)) {
                    most = votes;
                    best = own;
                }
            }
            if (most > 0) break;
        }
        return best;
    }

    const PlanTopology& plan_;
    const RockBlocks& blocks_;
    const ColumnHeights& columns_;
    const PostLevels& levels_;
    const double minimum_thickness_;
    LayeredMesh& mesh_;

    std::size_t t_ = 0;
    std::int32_t rock_ = -1, block_ = -1, last_block_ = -1, layer_ = 0;
    std::array<std::size_t, 3> post_{};
    std::array<std::int32_t, 3> node_{};
    std::array<std::span<const std::int32_t>, 3> own_;
    Front front_{};
    std::vector<Front> fronts_;               ///< of the column, upward
    std::vector<std::int32_t> front_blocks_;  ///< of what lies above each
    std::vector<PostLevels::Removal> weak_, weak_last_;
    std::vector<std::pair<std::size_t, PostLevels::Removal>> weak_alone_;  ///< with their triangles
    std::vector<std::int32_t> elements_;                                   ///< of each column
    bool has_step_ = false;
    std::array<std::size_t, 2> step_{};
    std::vector<std::array<std::int32_t, 2>> lines_;
    std::vector<SideFace> step_faces_;
    std::vector<std::uint8_t> is_parted_;  ///< of each layer of each post
};

/// Faces that are steep, so that the centers of neighbors lie far from the direction across them,
/// are made less steep, by moves of less than the minimum thickness. @return whether there were any
bool ease_steep(const PlanTopology& plan, const RockBlocks& blocks, const ColumnHeights& columns,
                double minimum_thickness, PostLevels& levels, Progress* progress) {
    const PostLevels before = levels;
    std::vector<std::uint8_t> is_moved(plan.nodes(), 1), has_flat_base(plan.nodes(), 0);
    for (std::size_t p = 0; p < plan.post_count(); ++p) {
        if (columns.rock(p) >= 0 && columns.surfaces(p)[0] == kBase)
            has_flat_base[index(plan.post_node(p))] = 1;
    }
    LayeredMesh scratch;
    for (int round = 0; round < kEasings; ++round) {
        std::vector<PostLevels::Move> moves;
        scratch = {};
        scratch.volumes.assign(blocks.rock.size(), 0);
        ColumnFiller filler(plan, blocks, columns, levels, minimum_thickness, scratch);
        for (std::size_t t = 0; t < plan.triangles(); ++t) {
            const auto& nodes = plan.mesh().triangles[t];
            poll(progress, t);
            if (std::none_of(nodes.begin(), nodes.end(),
                             [&](std::int32_t n) { return is_moved[index(n)] != 0; }))
                continue;
            if (filler.fill(t)) filler.find_steep(moves);
        }
        is_moved.assign(plan.nodes(), 0);
        if (!levels.ease(moves, before, minimum_thickness, has_flat_base, is_moved))
            return round > 0;
    }
    return true;
}

/// Calls visit(corner) for the corners of all elements and faces.
template <class Visit>
void for_corners(LayeredMesh& mesh, const Visit& visit) {
    const auto all = [&](auto& rows) {
        for (auto& row : rows) {
            for (std::int32_t& corner : row)
                visit(corner);
        }
    };
    all(mesh.tetrahedra.corners);
    all(mesh.pyramids.corners);
    all(mesh.prisms.corners);
    all(mesh.triangles.corners);
    all(mesh.quadrilaterals.corners);
}

}  // namespace

LayeredMesh layered_mesh(const ComplexView& model, std::span<const std::int32_t> block_rock,
                         const PlanLines& lines, meshing::PlanarMesh mesh, const Layering& layering,
                         int threads, Progress* progress) {
    const RockBlocks blocks(block_rock);
    PlanTopology plan(lines, std::move(mesh));
    const ColumnHeights columns = post_columns(model, blocks, lines, plan, threads, progress);
    PostLevels levels(plan, lines, blocks, columns, layering);
    LayeredMesh made;
    std::vector<std::uint8_t> is_narrow;
    bool is_eased = false;
    for (int repair = 0;; ++repair) {
        check_total(levels.height_count(), INT32_MAX);
        made = {};
        made.volumes.assign(blocks.rock.size(), 0);
        for (std::size_t r = 0; r < blocks.count(); ++r) {
            made.layers = std::max(made.layers,
                                   static_cast<std::int32_t>(
                                       levels.layer_blocks(static_cast<std::int32_t>(r)).size()));
        }
        ColumnFiller filler(plan, blocks, columns, levels, layering.minimum_thickness, made);
        for (std::size_t t = 0; t < plan.triangles(); ++t) {
            poll(progress, t);
            filler.fill(t);
        }
        if (repair == 0) is_narrow = narrow_strips(plan, filler.elements());
        if (repair < kRepairs && !is_eased && levels.remove(plan, filler.weak(is_narrow)) > 0)
            continue;
        if (!is_eased &&
            ease_steep(plan, blocks, columns, layering.minimum_thickness, levels, progress)) {
            is_eased = true;
            continue;
        }
        filler.finish_steps(VerticalFaults(model, lines.steps));
        break;
    }
    std::vector<std::int32_t> number(levels.height_count(), -1);
    for_corners(made, [&](std::int32_t& corner) { number[index(corner)] = 0; });
    for (std::size_t n = 0, at = 0; n < plan.nodes(); ++n) {
        for (const double z : levels.heights(static_cast<std::int32_t>(n))) {
            if (number[at] == 0) {
                number[at] = static_cast<std::int32_t>(made.points.size());
                made.points.push_back({plan.mesh().vertices[n][0], plan.mesh().vertices[n][1], z});
            }
            ++at;
        }
    }
    for_corners(made, [&](std::int32_t& corner) { corner = number[index(corner)]; });
    made.plan = plan.take_mesh();
    return made;
}

}  // namespace realmodel::simulation
