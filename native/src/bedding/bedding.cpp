// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/bedding/bedding.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/parallel_sort.hpp"
#include "base/vectors.hpp"
#include "bedding/sheet_heights.hpp"
#include "realmodel/base/elementary.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::bedding {

namespace {

using strata::meaning;
using strata::Rule;

constexpr double kNear = 32 * 0x1p-52;   // of the largest coordinate: what rounding may do
constexpr double kBeside = 8 * kNear;    // of it: from an upright polygon to a position beside it
constexpr double kInwards = 1.0 / 64;    // of the way from a corner to the middle of its polygon
constexpr std::size_t kPositions = 512;  // plan positions that a thread takes at once

/// A corner of a polygon, by their numbers.
struct Corner {
    std::uint32_t number;
    std::int32_t polygon;
};

/// A history at one plan position.
struct Column {
    struct Layer {
        bool is_there = false;
        double base = 0, top = 0;
    };
    std::vector<Layer> layers;
    double top = 0;           ///< of the youngest
    bool has_border = false;  ///< a side has to be chosen first
};

/// Whether two sheets differ in heights at most.
bool has_plan_of(const TriangleView& a, const TriangleView& b) {
    if (a.vertices.size() != b.vertices.size() || !std::ranges::equal(a.triangles, b.triangles))
        return false;
    for (std::size_t at = 0; at < a.vertices.size(); at += 3) {
        if (a.vertices[at] != b.vertices[at] || a.vertices[at + 1] != b.vertices[at + 1])
            return false;
    }
    return true;
}

class Corners {
public:
    Corners(const ComplexView& complex, std::span<const History> histories,
            std::span<const Polygon> polygons, std::span<const std::int32_t> histories_of_corners,
            const Execution& execution);
    Bedding bedding();

private:
    void check();
    void check_histories() const;
    void number_corners();
    void make_sheets();
    void sort_positions();

    PlanPosition plan(std::int32_t vertex) const {
        const auto at = complex_.vertex(vertex);
        return {at[0], at[1]};
    }
    /// The vertex of a corner, counted from the first of its polygon.
    std::int32_t vertex(const Polygon& polygon, std::size_t corner) const {
        const auto face = complex_.face(index(polygon.face));
        return polygon.reversed ? face[face.size() - 1 - corner] : face[corner];
    }

    /// What a polygon is turned to, not normalized, and the middle of its corners in plan.
    struct Facing {
        std::array<double, 3> normal;
        PlanPosition middle;
    };
    Facing facing(const Polygon& polygon) const;
    PlanPosition beside(const PlanPosition& position, const Polygon& polygon) const;

    /// What a thread has of one plan position.
    struct Scratch {
        std::vector<std::optional<SheetPlan::Place>> places;  ///< in each plan, where known
        std::vector<Column> columns;                          ///< of each history; empty: not known
        Column beside;                                        ///< the one of a polygon at a border
    };
    template <class HeightOf>
    void replay(const History& history, const HeightOf& height_of, Column& column) const;
    void set(std::uint32_t corner, const Polygon& polygon, const Column& column, double z,
             Bedding& bedding) const;
    void set_position(std::span<const Corner> corners, const PlanPosition& position,
                      Scratch& scratch, Bedding& bedding) const;

    const ComplexView& complex_;
    std::span<const History> histories_;
    std::span<const Polygon> polygons_;
    std::span<const std::int32_t> histories_of_corners_;
    Execution execution_;
    double largest_plan_ = 0, largest_height_ = 0;
    std::vector<std::uint32_t> begin_;                   ///< of each polygon's corners
    std::vector<std::unique_ptr<SheetPlan>> plans_;      ///< that differ
    std::vector<std::size_t> plan_of_;                   ///< of each sheet
    std::vector<std::unique_ptr<SheetHeights>> sheets_;  ///< that differ
    std::vector<std::vector<std::size_t>> sheets_of_;    ///< of each history
    std::vector<std::int32_t> position_of_;              ///< of each vertex: its plan position
    std::size_t positions_ = 0;
};

Corners::Corners(const ComplexView& complex, std::span<const History> histories,
                 std::span<const Polygon> polygons,
                 std::span<const std::int32_t> histories_of_corners, const Execution& execution)
    : complex_(complex),
      histories_(histories),
      polygons_(polygons),
      histories_of_corners_(histories_of_corners),
      execution_(execution) {
    check();
    number_corners();
    check_histories();
    for (std::size_t at = 0; at < complex_.vertices.size(); ++at) {
        double& largest = at % 3 == 2 ? largest_height_ : largest_plan_;
        largest = std::max(largest, std::abs(complex_.vertices[at]));
    }
    make_sheets();
    sort_positions();
}

void Corners::check() {
    const auto refuse = [](std::size_t polygon, const char* what) {
        throw InputError("bad_index", "polygon " + std::to_string(polygon) + " " + what, -1,
                         {static_cast<std::int64_t>(polygon)});
    };
    for (std::size_t n = 0; n < polygons_.size(); ++n) {
        const Polygon& polygon = polygons_[n];
        if (polygon.face < 0 || std::cmp_greater_equal(polygon.face, complex_.face_count()))
            refuse(n, "is a face that does not exist");
        if (polygon.history < 0 || std::cmp_greater_equal(polygon.history, histories_.size()))
            refuse(n, "has a history that does not exist");
        if (polygon.layer < -1 ||
            std::cmp_greater_equal(polygon.layer, histories_[index(polygon.history)].sheets.size()))
            refuse(n, "lies in a layer that does not exist");
        for (const std::int32_t v : complex_.face(index(polygon.face))) {
            if (v < 0 || std::cmp_greater_equal(v, complex_.vertex_count()))
                refuse(n, "refers to a vertex that does not exist");
        }
    }
}

/// Each corner's history is there, and has the layer of its polygon.
void Corners::check_histories() const {
    if (histories_of_corners_.empty()) return;
    const auto refuse = [](std::size_t polygon) {
        throw InputError("bad_index",
                         "polygon " + std::to_string(polygon) + " has a corner without a history",
                         -1, {static_cast<std::int64_t>(polygon)});
    };
    if (histories_of_corners_.size() != begin_.back()) refuse(polygons_.size());
    for (std::size_t n = 0; n < polygons_.size(); ++n) {
        for (std::uint32_t corner = begin_[n]; corner < begin_[n + 1]; ++corner) {
            const std::int32_t history = histories_of_corners_[corner];
            if (history < 0 || std::cmp_greater_equal(history, histories_.size()) ||
                std::cmp_greater_equal(polygons_[n].layer,
                                       histories_[index(history)].sheets.size()))
                refuse(n);
        }
    }
}

void Corners::number_corners() {
    std::size_t count = 0;
    begin_.reserve(polygons_.size() + 1);
    for (const Polygon& polygon : polygons_) {
        begin_.push_back(static_cast<std::uint32_t>(count));
        count += complex_.face(index(polygon.face)).size();
        check_total(count, INT32_MAX);
    }
    begin_.push_back(static_cast<std::uint32_t>(count));
}

void Corners::make_sheets() {
    std::map<std::pair<const void*, const void*>, std::size_t> known;
    std::vector<const TriangleView*> distinct;
    for (const History& history : histories_) {
        auto& own = sheets_of_.emplace_back();
        for (const TriangleView& sheet : history.sheets) {
            const auto key =
                std::pair<const void*, const void*>(sheet.vertices.data(), sheet.triangles.data());
            const auto [entry, is_new] = known.try_emplace(key, distinct.size());
            if (is_new) distinct.push_back(&sheet);
            own.push_back(entry->second);
        }
    }
    std::vector<const TriangleView*> first;  // of the sheets of each plan
    for (const TriangleView* sheet : distinct) {
        const auto same = std::ranges::find_if(
            first, [&](const TriangleView* other) { return has_plan_of(*sheet, *other); });
        plan_of_.push_back(static_cast<std::size_t>(same - first.begin()));
        if (same == first.end()) first.push_back(sheet);
    }
    plans_.resize(first.size());
    parallel_chunks(first.size(), execution_, [&](std::size_t n) {
        plans_[n] = std::make_unique<SheetPlan>(*first[n], kNear * largest_plan_);
    });
    sheets_.resize(distinct.size());
    parallel_chunks(distinct.size(), execution_, [&](std::size_t n) {
        sheets_[n] = std::make_unique<SheetHeights>(*plans_[plan_of_[n]], *distinct[n]);
    });
}

/// Vertices above one another share a plan position.
void Corners::sort_positions() {
    std::vector<std::pair<PlanPosition, std::int32_t>> order(complex_.vertex_count());
    for (std::size_t v = 0; v < order.size(); ++v) {
        const auto vertex = static_cast<std::int32_t>(v);
        order[v] = {plan(vertex), vertex};
    }
    parallel_sort(order, std::less<>(), execution_);
    position_of_.resize(order.size());
    for (std::size_t at = 0; at < order.size(); ++at) {
        if (at > 0 && order[at].first != order[at - 1].first) ++positions_;
        position_of_[index(order[at].second)] = static_cast<std::int32_t>(positions_);
    }
    positions_ = order.empty() ? 0 : positions_ + 1;
}

Bedding Corners::bedding() {
    const auto at = bucketize<Corner>(positions_, [&](const auto& put) {
        for (std::size_t n = 0; n < polygons_.size(); ++n) {
            for (std::uint32_t corner = begin_[n]; corner < begin_[n + 1]; ++corner) {
                put(index(position_of_[index(vertex(polygons_[n], corner - begin_[n]))]),
                    {corner, static_cast<std::int32_t>(n)});
            }
        }
    });
    const std::size_t count = begin_.back();
    Bedding made{Array<float>(count), Array<float>(count), Array<float>(count)};
    const std::size_t chunks = (positions_ + kPositions - 1) / kPositions;
    parallel_workers(chunks, execution_, [&] {
        Scratch own{{}, std::vector<Column>(histories_.size()), {}};
        return [&, scratch = std::move(own)](std::size_t chunk) mutable {
            const std::size_t end = std::min(positions_, (chunk + 1) * kPositions);
            for (std::size_t position = chunk * kPositions; position < end; ++position) {
                const auto corners = at[position];
                if (corners.empty()) continue;
                const Polygon& polygon = polygons_[index(corners[0].polygon)];
                const std::uint32_t first = begin_[index(corners[0].polygon)];
                set_position(corners, plan(vertex(polygon, corners[0].number - first)), scratch,
                             made);
            }
        };
    });
    return made;
}

void Corners::set_position(std::span<const Corner> corners, const PlanPosition& position,
                           Scratch& scratch, Bedding& bedding) const {
    for (Column& column : scratch.columns)
        column.layers.clear();
    scratch.places.assign(plans_.size(), std::nullopt);
    const auto at = [&](std::size_t sheet) {
        auto& place = scratch.places[plan_of_[sheet]];
        if (!place) place = plans_[plan_of_[sheet]]->at(position);
        return sheets_[sheet]->at(*place);
    };
    for (const Corner& corner : corners) {
        const Polygon& polygon = polygons_[index(corner.polygon)];
        const std::size_t number = index(
            histories_of_corners_.empty() ? polygon.history : histories_of_corners_[corner.number]);
        const History& history = histories_[number];
        const auto& sheets = sheets_of_[number];
        Column* column = &scratch.columns[number];
        if (column->layers.empty()) {
            replay(
                history, [&](std::size_t k) { return at(sheets[k]); }, *column);
        }
        if (column->has_border) {
            const PlanPosition inside = beside(position, polygon);
            const auto chosen = [&](std::size_t k) {
                const SheetHeights::Found found = at(sheets[k]);
                return found.state == State::kBorder ? sheets_[sheets[k]]->beside(inside, position)
                                                     : found;
            };
            replay(history, chosen, scratch.beside);
            column = &scratch.beside;
        }
        const std::int32_t own = vertex(polygon, corner.number - begin_[index(corner.polygon)]);
        set(corner.number, polygon, *column, complex_.vertex(own)[2], bedding);
    }
}

template <class HeightOf>
void Corners::replay(const History& history, const HeightOf& height_of, Column& column) const {
    column.layers.assign(history.sheets.size(), {});
    column.has_border = false;
    std::optional<double> top, floor;
    for (std::size_t k = 0; k < history.sheets.size(); ++k) {
        const SheetHeights::Found found = height_of(k);
        if (found.state == State::kBorder) column.has_border = true;
        if (found.state != State::kHeight) continue;
        const auto rule = meaning(history.rules.empty() ? Rule::kErosional : history.rules[k]);
        double level = found.height;
        if (!rule.cuts && top) level = std::max(level, *top);
        if (floor) level = std::max(level, *floor);
        const std::optional<double> base = k == 0 ? history.base_elevation : top;
        if (base) column.layers[k] = {true, *base, level};
        top = level;
        if (rule.protects) floor = level;
    }
    column.top = top.value_or(0.0);
}

Corners::Facing Corners::facing(const Polygon& polygon) const {
    const auto face = complex_.face(index(polygon.face));
    const auto origin = complex_.vertex(face[0]);
    Facing found{};
    for (std::size_t i = 0; i < face.size(); ++i) {
        auto a = complex_.vertex(face[i]), b = complex_.vertex(face[(i + 1) % face.size()]);
        for (std::size_t axis = 0; axis < 2; ++axis)
            found.middle[axis] += a[axis] / static_cast<double>(face.size());
        for (std::size_t axis = 0; axis < 3; ++axis) {
            a[axis] -= origin[axis];
            b[axis] -= origin[axis];
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
            found.normal[axis] += (a[u] * b[v] - a[v] * b[u]) * (polygon.reversed ? -0.5 : 0.5);
        }
    }
    return found;
}

/// A position in plan that lies in the polygon, or inside of an upright one, near its corner.
PlanPosition Corners::beside(const PlanPosition& position, const Polygon& polygon) const {
    const auto [normal, middle] = facing(polygon);
    PlanPosition found = moved(position, kInwards, minus({middle[0], middle[1]}, position));
    const double across = elementary::hypot(normal[0], normal[1]);
    if (across > 0 && std::abs(normal[2]) <= 1e-6 * across) {
        const double step = kBeside * largest_plan_ / across;
        found[0] -= step * normal[0];
        found[1] -= step * normal[1];
    }
    return found;
}

void Corners::set(std::uint32_t corner, const Polygon& polygon, const Column& column, double z,
                  Bedding& bedding) const {
    const double rounding = kNear * largest_height_;
    bedding.depth[corner] = static_cast<float>(std::max(0.0, column.top - z));
    const Column::Layer layer =
        polygon.layer < 0 ? Column::Layer{} : column.layers[index(polygon.layer)];
    const double thickness = layer.is_there ? std::max(0.0, layer.top - layer.base) : 0.0;
    bedding.thickness[corner] = static_cast<float>(thickness);
    if (thickness > rounding) {
        const double height = (z - layer.base) / thickness;
        bedding.height[corner] = static_cast<float>(z >= layer.top - rounding    ? 1.0
                                                    : z <= layer.base + rounding ? 0.0
                                                                                 : height);
        return;
    }
    const auto normal = facing(polygon).normal;
    const double across = elementary::hypot(normal[0], normal[1]);
    const bool is_upright = std::abs(normal[2]) <= 1e-6 * across;
    bedding.height[corner] = is_upright ? 0.5F : normal[2] > 0 ? 1.0F : 0.0F;
}

}  // namespace

Bedding bedding_of(const ComplexView& complex, std::span<const History> histories,
                   std::span<const Polygon> polygons,
                   std::span<const std::int32_t> histories_of_corners, const Execution& execution) {
    return Corners(complex, histories, polygons, histories_of_corners, execution).bedding();
}

}  // namespace realmodel::bedding
