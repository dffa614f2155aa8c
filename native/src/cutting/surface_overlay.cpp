// SPDX-License-Identifier: GPL-3.0-or-later
// The exact overlay of a model's faces with the triangles of a surface.
#include <algorithm>
#include <cmath>

#include "realmodel/base/errors.hpp"
#include "strata/parallel_chunks.hpp"
#include "surface_cut.hpp"

namespace realmodel::cutting {

namespace {

constexpr double kUnits = 4;  // as PlaneDistance::rounding

double last_places(double x) {
    const double size = std::abs(x);
    return kUnits * (std::nextafter(size, HUGE_VAL) - size);
}

}  // namespace

/// The faces that come near the surface.
void SurfaceCut::find_active_faces() {
    std::vector<Box> boxes;
    margin_ = rounding_of(surface_.vertices);
    for (const auto& t : surface_.triangles) {
        Box box;
        for (const NodeId v : t)
            box.include(surface_.vertices[index(v)]);
        boxes.push_back(box);
    }
    Box whole;
    for (const Box& box : boxes)
        whole.include(box);
    for (std::size_t v = 0; v < model_.vertex_count(); ++v) {
        for (const double x : model_.vertex(static_cast<NodeId>(v)))
            margin_ = std::max(margin_, 4 * last_places(x));
    }
    for (Box& box : boxes)
        box.widen(margin_);
    whole.widen(margin_);
    tree_ = std::make_unique<BoxTree>(std::move(boxes));
    active_.assign(model_.face_count(), 0);
    constexpr std::size_t kChunk = 1 << 12;
    strata::parallel_chunks(
        (model_.face_count() + kChunk - 1) / kChunk, threads_, progress_, [&](std::size_t c) {
            for (std::size_t f = c * kChunk; f < std::min(active_.size(), (c + 1) * kChunk); ++f) {
                Box box;
                for (const NodeId v : model_.face(f))
                    box.include(model_.vertex(v));
                active_[f] = box.meets(whole) && tree_->any(box) ? 1 : 0;
            }
        });
    for (std::size_t f = 0; f < active_.size(); ++f) {
        if (active_[f] != 0) active_faces_.push_back(static_cast<std::int32_t>(f));
    }
}

/// The place on the surface that a vertex is at but for its rounding; none where it is elsewhere.
/// Corners of the surface come first, then its edges, then its triangles.
std::optional<NodeId> SurfaceCut::place_on_surface(const Position& p) {
    Position reach;
    for (std::size_t k = 0; k < 3; ++k)
        reach[k] = last_places(p[k]);
    const auto same = [&](const Position& q) {
        for (std::size_t k = 0; k < 3; ++k) {
            if (std::abs(q[k] - p[k]) > reach[k]) return false;
        }
        return true;
    };
    Box box;
    box.include(p);
    std::vector<std::int32_t> near;
    tree_->find(box, [&near](std::int32_t t) { near.push_back(t); });
    std::sort(near.begin(), near.end());
    const auto corner = [this](std::int32_t t, std::size_t i) {
        return surface_.vertices[index(surface_.triangles[index(t)][i % 3])];
    };
    for (const std::int32_t t : near) {
        for (std::size_t i = 0; i < 3; ++i) {
            if (same(corner(t, i))) return points_.add(corner(t, i));
        }
    }
    const auto widest = [](const Position& d) {
        std::size_t axis = 0;
        for (std::size_t k = 1; k < 3; ++k) {
            if (std::abs(d[k]) > std::abs(d[axis])) axis = k;
        }
        return axis;
    };
    for (const std::int32_t t : near) {
        for (std::size_t i = 0; i < 3; ++i) {
            const Position a = corner(t, i), b = corner(t, i + 1);
            const Position way{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
            const std::size_t axis = widest(way);
            const double share = (p[axis] - a[axis]) / way[axis];
            if (!(share > 0 && share < 1)) continue;
            if (same({a[0] + share * way[0], a[1] + share * way[1], a[2] + share * way[2]}))
                return points_.dropped(axis, points_.add(p), points_.add(a), points_.add(b));
        }
    }
    for (const std::int32_t t : near) {
        const std::array corners{corner(t, 0), corner(t, 1), corner(t, 2)};
        const Position normal = polygon_normal(corners);
        double off = 0, allowed = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            off += normal[k] * (p[k] - corners[0][k]);
            allowed += std::abs(normal[k]) * reach[k];
        }
        if (!(std::abs(off) <= allowed) || allowed == 0) continue;
        const View view(normal);
        bool inside = true;
        const PlanePosition at = view(p);
        for (std::size_t i = 0; i < 3; ++i) {
            const PlanePosition a = view(corner(t, i)), b = view(corner(t, i + 1));
            inside = inside && (b[0] - a[0]) * (at[1] - a[1]) - (b[1] - a[1]) * (at[0] - a[0]) > 0;
        }
        if (!inside) continue;
        return points_.dropped(widest(normal), points_.add(p), points_.add(corners[0]),
                               points_.add(corners[1]), points_.add(corners[2]));
    }
    return std::nullopt;
}

/// Exact points for the vertices of faces near the surface: where they are, or where they are but
/// for their rounding. No two share one.
void SurfaceCut::name_vertices() {
    std::vector<NodeId> vertices;
    for (const std::int32_t f : active_faces_) {
        for (const NodeId v : model_.face(index(f)))
            vertices.push_back(v);
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    std::map<NodeId, NodeId> owner;
    for (const NodeId v : vertices) {
        vertex_node_[index(v)] = points_.add(model_.vertex(v));
        owner[vertex_node_[index(v)]] = v;
    }
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        strata::poll(progress_, i);
        const NodeId v = vertices[i];
        const auto place = place_on_surface(model_.vertex(v));
        if (!place || *place == vertex_node_[index(v)] || owner.contains(*place)) continue;
        owner.erase(vertex_node_[index(v)]);
        owner[*place] = v;
        vertex_node_[index(v)] = *place;
    }
}

void SurfaceCut::overlay_all() {
    std::vector<std::array<std::int32_t, 3>> triangles;
    for (const std::int32_t f : active_faces_) {
        triangulate_face(model_, index(f), triangles);
        for (const auto& t : triangles) {
            overlay_.add(
                {vertex_node_[index(t[0])], vertex_node_[index(t[1])], vertex_node_[index(t[2])]});
            face_of_.push_back(f);
        }
    }
    first_cutter_ = static_cast<std::int32_t>(face_of_.size());
    for (const auto& t : surface_.triangles) {
        std::array<NodeId, 3> corners;
        for (std::size_t i = 0; i < 3; ++i)
            corners[i] = points_.add(surface_.vertices[index(t[i])]);
        overlay_.add(corners);
    }
    for (std::int32_t t = 0; t < first_cutter_; ++t) {
        if (progress_ != nullptr && (t & 0xff) == 0) {
            progress_->check();
            progress_->report(0.1 + 0.4 * t / first_cutter_,
                              "finding where surface and faces meet");
        }
        Box box;
        for (const NodeId p : overlay_.corners(t))
            box.include(points_.rounded(p));
        tree_->find(box, [&](std::int32_t c) { overlay_.meet(t, first_cutter_ + c); });
    }
    overlay_.divide(progress_);
}

/// Numbers all nodes: the model's vertices keep theirs, the others follow.
void SurfaceCut::name_nodes() {
    out_.assign(points_.size(), -1);
    for (std::size_t v = 0; v < vertex_node_.size(); ++v) {
        if (vertex_node_[v] >= 0) out_[index(vertex_node_[v])] = static_cast<NodeId>(v);
    }
    const auto vertices = static_cast<NodeId>(model_.vertex_count());
    for (const Region& region : regions()) {
        auto& loops = loops_.emplace_back(region.loops);
        for (auto& loop : loops) {
            for (NodeId& p : loop) {
                NodeId& out = out_[index(p)];
                if (out < 0) {
                    out = vertices + static_cast<NodeId>(new_positions_.size());
                    new_positions_.push_back(points_.rounded(p));
                    exact_of_new_.push_back(p);
                }
                p = out;
            }
        }
    }
}

}  // namespace realmodel::cutting
