// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/column_filler.hpp"

#include <algorithm>
#include <cassert>
#include <tuple>
#include <utility>

#include "base/keep_single.hpp"
#include "base/parallel.hpp"
#include "base/parallel_counts.hpp"
#include "base/vectors.hpp"

namespace realmodel::simulation {

namespace {

/// @param corners  of a triangle the last is -1
void add_face(LayeredMesh& mesh, const std::array<std::int32_t, 4>& corners, std::int32_t surface) {
    if (corners[3] < 0) {
        mesh.triangles.corners.push_back({corners[0], corners[1], corners[2]});
        mesh.triangles.surface.push_back(surface);
    } else {
        mesh.quadrilaterals.corners.push_back(corners);
        mesh.quadrilaterals.surface.push_back(surface);
    }
}

class ColumnFiller {
public:
    ColumnFiller(const ColumnInput& input, const PostLevels& levels)
        : plan_(input.plan),
          blocks_(input.blocks),
          columns_(input.heights),
          levels_(levels),
          is_parted_(levels.level_count(), 0) {
        check_total(levels.height_count(), INT32_MAX);
        made_.mesh.volumes.assign(blocks_.rock.size(), 0);
        for (std::size_t r = 0; r < blocks_.count(); ++r) {
            const auto own = levels.layer_blocks(static_cast<std::int32_t>(r)).size();
            made_.mesh.layers = std::max(made_.mesh.layers, static_cast<std::int32_t>(own));
        }
    }

    FilledColumns run(Progress* progress) {
        find_parted();
        for (std::size_t t = 0; t < plan_.triangles(); ++t) {
            poll(progress, t);
            fill(t);
            made_.fronts.offset.push_back(made_.fronts.fronts.size());
        }
        return std::move(made_);
    }

private:
    /// The posts of a triangle; false where nothing stands on it.
    bool load(std::size_t t) {
        t_ = t;
        rock_ = plan_.rock(t);
        node_ = plan_.corners(t);
        for (std::size_t i = 0; i < 3; ++i) {
            post_[i] = plan_.post(t, i);
            own_[i] = levels_.levels(post_[i]);
            if (columns_.rock(post_[i]) != rock_ || rock_ < 0) return false;
            first_[i] = static_cast<std::int32_t>(levels_.node_offset(index(node_[i])));
        }
        area_ = twice_area(plan_.point(node_[0]), plan_.point(node_[1]), plan_.point(node_[2])) / 2;
        order_ = {0, 1, 2};
        std::ranges::sort(order_, {}, [&](std::size_t corner) { return node_[corner]; });
        find_step();
        return true;
    }

    /// The edge on a step, and the levels of the other side along it.
    void find_step() {
        has_step_ = has_open_edge_ = false;
        for (std::size_t i = 0; i < 3; ++i) {
            if (plan_.neighbor(t_, i) < 0) has_open_edge_ = true;
            if (!plan_.is_inner_step(t_, i)) continue;
            assert(!has_step_);
            has_step_ = true;
            step_ = {i, (i + 1) % 3};
            const auto posts = plan_.posts_beyond(t_, i);
            const auto u = levels_.levels(posts[0]), v = levels_.levels(posts[1]);
            lines_.clear();
            for (std::size_t l = 0; l < std::min(u.size(), v.size()); ++l)
                lines_.push_back({u[l], v[l]});
            sort_unique(lines_);
        }
    }

    /// A layer of a post beside a step is parted where the other side has heights within it. There
    /// the corner moves before the others, in all triangles at the post; so do both ends of an edge
    /// on a step, if one of them does. (No other edge has two such ends: adapt_plan.)
    void find_parted() {
        std::vector<std::array<std::size_t, 2>> pairs;  // levels of both ends
        for (std::size_t t = 0; t < plan_.triangles(); ++t) {
            const auto& nodes = plan_.corners(t);
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

    void fill(std::size_t t) {
        if (!load(t)) return;
        const auto layer_blocks = levels_.layer_blocks(rock_);
        for (std::size_t i = 0; i < 3; ++i)
            front_[i] = own_[i][0];
        last_block_ = -1;
        made_.fronts.fronts.push_back(front_);
        for (std::size_t l = 0; l < layer_blocks.size(); ++l) {
            block_ = layer_blocks[l];
            layer_ = static_cast<std::int32_t>(l);
            const Front top{own_[0][l + 1], own_[1][l + 1], own_[2][l + 1]};
            if (top == front_) continue;
            Front parted = front_;
            for (std::size_t i = 0; i < 3; ++i) {
                if (is_parted(i, l)) parted[i] = top[i];
            }
            if (has_step_ && parted != front_) pass_lines(parted);
            move(parted);
            move(top);
            assert(front_ == top);
        }
        made_.fronts.blocks.push_back(-1);
        if (last_block_ >= 0) add_flat_face(-1);
    }

    /// Moves along the levels of the other side of the step that lie between the front and its next
    /// position.
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
        for (const std::size_t c : order_) {
            while (front_[c] + 1 < to[c]) {
                Front next = front_;
                ++next[c];
                advance(next);
            }
        }
        advance(to);
    }

    /// Makes the element between the front and the next one.
    void advance(const Front& to) {
        if (to == front_) return;
        for (std::size_t i = 0; i < 3; ++i)
            assert(to[i] == front_[i] || to[i] == front_[i] + 1);
        if (last_block_ != block_) add_flat_face(block_);
        last_block_ = block_;
        add_element(to);
        if (has_step_ || has_open_edge_) add_sides(to);
        front_ = to;
        made_.fronts.fronts.push_back(to);
        made_.fronts.blocks.push_back(block_);
    }

    void add_element(const Front& to) {
        const Front low = points(front_), high = points(to);
        std::size_t moved = 0, still = 0, last_moved = 0;
        double rise = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const bool moves = to[i] != front_[i];
            moved += moves;
            (moves ? last_moved : still) = i;
            rise += height(i, to[i]) - height(i, front_[i]);
        }
        if (moved == 3) {
            add(made_.mesh.prisms, {low[0], low[1], low[2], high[0], high[1], high[2]});
        } else if (moved == 2) {
            const std::size_t a = (still + 1) % 3, b = (still + 2) % 3;
            add(made_.mesh.pyramids, {low[b], low[a], high[a], high[b], low[still]});
        } else {
            add(made_.mesh.tetrahedra, {low[0], low[1], low[2], high[last_moved]});
        }
        made_.mesh.volumes[index(block_)] += area_ * rise / 3;
    }

    /// The upright faces at the border and on steps.
    void add_sides(const Front& to) {
        const Front low = points(front_), high = points(to);
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t j = (i + 1) % 3;
            const bool outside = plan_.neighbor(t_, i) < 0;
            if (!outside && !plan_.is_inner_step(t_, i)) continue;
            if (low[i] == high[i] && low[j] == high[j]) continue;
            std::array<std::int32_t, 4> corners{low[i], low[j], high[j], high[i]};
            if (low[j] == high[j]) corners = {low[i], low[j], high[i], -1};
            if (low[i] == high[i]) corners = {low[i], low[j], high[j], -1};
            if (outside) {
                add_face(made_.mesh, corners, kWall);
                continue;
            }
            std::array<std::int32_t, 4> key = corners;
            std::sort(key.begin(), key.end());
            const double center = (height(i, front_[i]) + height(i, to[i]) + height(j, front_[j]) +
                                   height(j, to[j])) /
                                  4;
            made_.step_faces.push_back({key,
                                        corners,
                                        made_.step_faces.size(),
                                        {plan_.point(node_[i]), plan_.point(node_[j])},
                                        center,
                                        kWall});
        }
    }

    Front points(const Front& front) const {
        Front found;
        for (std::size_t i = 0; i < 3; ++i)
            found[i] = first_[i] + front[i];
        return found;
    }

    template <std::size_t N>
    void add(LayeredMesh::Elements<N>& elements, const std::array<std::int32_t, N>& corners) {
        elements.corners.push_back(corners);
        elements.block.push_back(block_);
        elements.column.push_back(static_cast<std::int32_t>(t_));
        elements.layer.push_back(made_.mesh.layers - 1 - layer_);
    }

    /// The face at the front between the last block and the next; -1: outside.
    void add_flat_face(std::int32_t next) {
        Front corners = points(front_);
        if (last_block_ < 0) std::swap(corners[1], corners[2]);
        add_face(made_.mesh, {corners[0], corners[1], corners[2], -1},
                 surface_between(last_block_, next));
    }

    /// The surface at the top of one block, as most corners have it where there is that block.
    std::int32_t surface_between(std::int32_t below, std::int32_t above) const {
        const auto first = blocks_.first[index(rock_)];
        const auto level = below < 0   ? std::size_t{0}
                           : above < 0 ? index(blocks_.blocks_of(rock_))
                                       : static_cast<std::size_t>(below - first) + 1;
        const auto surface = [&](std::size_t i) { return columns_.surfaces(post_[i])[level]; };
        if (surface(0) == surface(1) && surface(1) == surface(2)) return surface(0);
        std::int32_t best = -1, most = 0;
        for (const bool present_only : {true, false}) {
            const auto counts = [&](std::size_t i) {
                const auto z = columns_.levels(post_[i]);
                return !present_only || level == 0 || z[level] > z[level - 1];
            };
            for (std::size_t i = 0; i < 3; ++i) {
                const std::int32_t own = surface(i);
                std::int32_t votes = 0;
                for (std::size_t j = 0; j < 3; ++j)
                    votes += counts(j) && surface(j) == own ? 1 : 0;
                if (std::tie(votes, own) > std::tie(most, best)) {
                    most = votes;
                    best = own;
                }
            }
            if (most > 0) break;
        }
        return best;
    }

    bool is_parted(std::size_t corner, std::size_t layer) const {
        return is_parted_[levels_.level_offset(post_[corner]) + layer] != 0;
    }
    double height(std::size_t corner, std::int32_t at) const {
        return levels_.heights(node_[corner])[index(at)];
    }

    const PlanTopology& plan_;
    const RockBlocks& blocks_;
    const ColumnHeights& columns_;
    const PostLevels& levels_;
    FilledColumns made_;
    std::vector<std::uint8_t> is_parted_;  ///< of each layer of each post: find_parted()

    // of the triangle whose column is filled
    std::size_t t_ = 0;
    std::int32_t rock_ = -1, block_ = -1, last_block_ = -1, layer_ = 0;
    std::array<std::size_t, 3> post_{};
    std::array<std::int32_t, 3> node_{}, first_{};  ///< first_: number of the first height of each
    std::array<std::size_t, 3> order_{};            ///< its corners by their nodes
    double area_ = 0;
    std::array<std::span<const std::int32_t>, 3> own_;  ///< the levels of its posts
    Front front_{};
    bool has_step_ = false, has_open_edge_ = false;   ///< on an inner step, at the border
    std::array<std::size_t, 2> step_{};               ///< the corners of its edge on a step
    std::vector<std::array<std::int32_t, 2>> lines_;  ///< the levels of the other side there
};

}  // namespace

FilledColumns fill_columns(const ColumnInput& input, const PostLevels& levels, Progress* progress) {
    return ColumnFiller(input, levels).run(progress);
}

void add_step_faces(FilledColumns& columns, const VerticalFaults& faults) {
    using Face = FilledColumns::StepFace;
    std::vector<Face>& faces = columns.step_faces;
    std::ranges::sort(faces, {}, [](const Face& face) { return std::pair(face.key, face.number); });
    std::vector<const Face*> kept;
    for (std::size_t i = 0, end = 0; i < faces.size(); i = end) {
        while (end < faces.size() && faces[end].key == faces[i].key)
            ++end;
        assert(end - i <= 2);
        Face& face = faces[i];
        if (!faults.empty())
            face.surface = faults.fault_at(face.edge[0], face.edge[1], face.height);
        if (end == i + 1 || face.surface != kWall) kept.push_back(&face);
    }
    std::ranges::sort(kept, {}, &Face::number);
    for (const Face* face : kept)
        add_face(columns.mesh, face->corners, face->surface);
}

}  // namespace realmodel::simulation
