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

constexpr std::uint32_t kNone = UINT32_MAX;
constexpr double kNear = 32 * 0x1p-52;     // of the largest coordinate: what rounding may do
constexpr double kBeside = 8 * kNear;      // of it: from an upright polygon to a position beside it
constexpr double kInwards = 1.0 / 64;      // of the way from a corner to the middle of its polygon
constexpr std::size_t kPolygons = 16'384;  // polygons that a thread takes at once
constexpr std::size_t kCorners = 16'384;   // corners, likewise

/// A corner of a polygon, by their numbers, and its vertex.
struct Corner {
    std::uint32_t number;
    std::int32_t polygon, vertex;
};

/// A history at one plan position, as far as it was replayed.
struct Column {
    bool has_layer = false;   ///< the last sheet has deposited a layer
    bool has_top = false;     ///< some sheet is there
    bool has_floor = false;   ///< some sheet protects what is below it
    bool has_border = false;  ///< of some sheet: a side has to be chosen first
    double base = 0;          ///< of the layer
    double top = 0;           ///< of the layer, and of all
    double floor = 0;

    /// Lays a sheet on it.
    void lay(const History& history, std::size_t sheet, const SheetHeights::Found& found) {
        has_layer = false;
        has_border |= found.state == State::kBorder;
        if (found.state != State::kHeight) return;
        const auto rule = meaning(history.rules.empty() ? Rule::kErosional : history.rules[sheet]);
        double level = std::max(found.height, history.base_elevation.value_or(found.height));
        if (!rule.cuts && has_top) level = std::max(level, top);
        if (has_floor) level = std::max(level, floor);
        has_layer = sheet == 0 ? history.base_elevation.has_value() : has_top;
        base = sheet == 0 ? history.base_elevation.value_or(0.0) : top;
        top = level;
        has_top = true;
        if (rule.protects) floor = level;
        has_floor |= rule.protects;
    }
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
    void sort_corners();

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

    double height_of(const Corner& corner) const { return complex_.vertex(corner.vertex)[2]; }
    std::size_t position_of(const Corner& corner) const {
        return index(position_of_[index(corner.vertex)]);
    }

    std::span<const Corner> corners_of(std::size_t history) const {
        const std::size_t first = first_layer_[history], last = first_layer_[history + 1];
        return {corners_.values.data() + corners_.offsets[first],
                corners_.values.data() + corners_.offsets[last]};
    }
    void replay(std::size_t history, std::span<const std::size_t> used, Bedding& bedding) const;
    void set(const Corner& corner, const Column& column, bool has_layer, Bedding& bedding) const;
    void set_at_borders(std::size_t history, std::vector<Corner> some, Bedding& bedding) const;
    std::vector<Column> columns_at(std::size_t history, const PlanPosition& position,
                                   std::span<const SheetPlan::Place> places,
                                   std::span<const std::int32_t> triangles) const;

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
    std::vector<PlanPosition> positions_;
    std::vector<std::uint32_t> column_of_;  ///< of each position, in the history that is replayed
    std::vector<std::size_t> first_layer_;  ///< of each history, among the buckets of corners
    Buckets<Corner> corners_;  ///< by history and layer; those in no layer before all layers
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
    sort_corners();
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
    for (const auto& [position, vertex] : order) {
        if (positions_.empty() || position != positions_.back()) positions_.push_back(position);
        position_of_[index(vertex)] = static_cast<std::int32_t>(positions_.size() - 1);
    }
}

void Corners::sort_corners() {
    std::size_t layers = 0;
    for (const History& history : histories_) {
        first_layer_.push_back(layers);
        layers += history.sheets.size() + 1;
    }
    first_layer_.push_back(layers);
    const auto produce = [&](std::size_t chunk, const auto& put) {
        const std::size_t end = std::min(polygons_.size(), (chunk + 1) * kPolygons);
        for (std::size_t n = chunk * kPolygons; n < end; ++n) {
            const auto layer = static_cast<std::size_t>(polygons_[n].layer + 1);
            for (std::uint32_t corner = begin_[n]; corner < begin_[n + 1]; ++corner) {
                const std::size_t history =
                    index(histories_of_corners_.empty() ? polygons_[n].history
                                                        : histories_of_corners_[corner]);
                put(first_layer_[history] + layer, {corner, static_cast<std::int32_t>(n),
                                                    vertex(polygons_[n], corner - begin_[n])});
            }
        }
    };
    const std::size_t chunks = (polygons_.size() + kPolygons - 1) / kPolygons;
    corners_ = bucketize_in_order<Corner>(layers, chunks, produce, execution_);
}

Bedding Corners::bedding() {
    const std::size_t count = begin_.back();
    Bedding made{Array<float>(count), Array<float>(count), Array<float>(count)};
    column_of_.assign(positions_.size(), kNone);
    for (std::size_t history = 0; history < histories_.size(); ++history) {
        std::vector<std::size_t> used;  // positions
        for (const Corner& corner : corners_of(history)) {
            const std::size_t position = position_of(corner);
            if (column_of_[position] != kNone) continue;
            column_of_[position] = static_cast<std::uint32_t>(used.size());
            used.push_back(position);
        }
        replay(history, used, made);
        for (const std::size_t position : used)
            column_of_[position] = kNone;
    }
    return made;
}

/// Sheet by sheet over all positions, and then the corners of the layer beneath it: what is read at
/// once stays in the caches, where columns of all sheets at each position would not.
void Corners::replay(std::size_t history, std::span<const std::size_t> used,
                     Bedding& bedding) const {
    const auto& sheets = sheets_of_[history];
    std::vector<Column> columns(used.size());
    std::vector<std::vector<SheetPlan::Place>> places(plans_.size());
    std::vector<std::size_t> last(plans_.size());  // the last sheet with each plan
    for (std::size_t k = 0; k < sheets.size(); ++k)
        last[plan_of_[sheets[k]]] = k;
    const auto for_corners = [&](std::span<const Corner> some, const auto& work) {
        parallel_ranges(some.size(), kCorners, execution_, [&](std::size_t begin, std::size_t end) {
            for (const Corner& corner : some.subspan(begin, end - begin))
                work(corner, columns[column_of_[position_of(corner)]]);
        });
    };
    const auto set_layer = [&](std::size_t layer) {
        for_corners(corners_[first_layer_[history] + layer],
                    [&](const Corner& corner, const Column& column) {
                        set(corner, column, layer > 0 && column.has_layer, bedding);
                    });
    };
    set_layer(0);
    for (std::size_t k = 0; k < sheets.size(); ++k) {
        const SheetPlan& plan = *plans_[plan_of_[sheets[k]]];
        auto& at = places[plan_of_[sheets[k]]];
        const bool is_new = at.empty();
        at.resize(used.size());
        parallel_each(used.size(), execution_, [&](std::size_t n) {
            if (is_new) at[n] = plan.at(positions_[used[n]]);
            columns[n].lay(histories_[history], k, sheets_[sheets[k]]->at(at[n]));
        });
        if (last[plan_of_[sheets[k]]] == k) at = {};
        set_layer(k + 1);
    }
    std::vector<Corner> at_borders;
    for (const Corner& corner : corners_of(history)) {
        if (columns[column_of_[position_of(corner)]].has_border) at_borders.push_back(corner);
    }
    for_corners(corners_of(history), [&](const Corner& corner, const Column& column) {
        bedding.depth[corner.number] =
            static_cast<float>(std::max(0.0, column.top - height_of(corner)));
    });
    set_at_borders(history, std::move(at_borders), bedding);
}

/// At the border of a sheet each polygon has the column of its own side.
void Corners::set_at_borders(std::size_t history, std::vector<Corner> some,
                             Bedding& bedding) const {
    std::ranges::sort(some, std::less<>(), [&](const Corner& corner) {
        return std::pair(position_of(corner), corner.number);
    });
    std::vector<std::size_t> begins;  // of the corners of each position
    for (std::size_t n = 0; n < some.size(); ++n) {
        if (n == 0 || position_of(some[n]) != position_of(some[n - 1])) begins.push_back(n);
    }
    begins.push_back(some.size());
    parallel_chunks(begins.size() - 1, execution_, [&](std::size_t n) {
        const auto corners =
            std::span<const Corner>(some).subspan(begins[n], begins[n + 1] - begins[n]);
        const PlanPosition& position = positions_[position_of(corners[0])];
        std::vector<SheetPlan::Place> places;  // in each plan
        for (const auto& plan : plans_)
            places.push_back(plan->at(position));
        std::map<std::vector<std::int32_t>, std::vector<Column>> sides;
        for (const Corner& corner : corners) {
            const Polygon& polygon = polygons_[index(corner.polygon)];
            const PlanPosition inside = beside(position, polygon);
            std::vector<std::int32_t> triangles;  // in each plan, at borders
            for (std::size_t plan = 0; plan < plans_.size(); ++plan) {
                const bool is_border = places[plan].state == State::kBorder;
                triangles.push_back(is_border ? plans_[plan]->holding(inside) : -1);
            }
            auto& columns = sides[triangles];
            if (columns.empty()) columns = columns_at(history, position, places, triangles);
            const auto layer = static_cast<std::size_t>(polygon.layer + 1);
            set(corner, columns[layer], layer > 0 && columns[layer].has_layer, bedding);
            bedding.depth[corner.number] =
                static_cast<float>(std::max(0.0, columns.back().top - height_of(corner)));
        }
    });
}

/// A column before all sheets and after each. triangles: in each plan, the one on whose side
/// heights are wanted at a border.
std::vector<Column> Corners::columns_at(std::size_t history, const PlanPosition& position,
                                        std::span<const SheetPlan::Place> places,
                                        std::span<const std::int32_t> triangles) const {
    const auto& sheets = sheets_of_[history];
    std::vector<Column> found(1);
    for (std::size_t k = 0; k < sheets.size(); ++k) {
        const SheetPlan::Place& place = places[plan_of_[sheets[k]]];
        const SheetHeights& heights = *sheets_[sheets[k]];
        found.push_back(found.back());
        found.back().lay(histories_[history], k,
                         place.state == State::kBorder
                             ? heights.beside(triangles[plan_of_[sheets[k]]], position)
                             : heights.at(place));
    }
    return found;
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

/// Height and thickness of a corner. column: as far as the sheet over its layer.
void Corners::set(const Corner& corner, const Column& column, bool has_layer,
                  Bedding& bedding) const {
    const Polygon& polygon = polygons_[index(corner.polygon)];
    const double rounding = kNear * largest_height_, z = height_of(corner);
    const double thickness = has_layer ? std::max(0.0, column.top - column.base) : 0.0;
    bedding.thickness[corner.number] = static_cast<float>(thickness);
    float& height = bedding.height[corner.number];
    if (thickness > rounding) {
        height = static_cast<float>(z >= column.top - rounding    ? 1.0
                                    : z <= column.base + rounding ? 0.0
                                                                  : (z - column.base) / thickness);
        return;
    }
    const auto normal = facing(polygon).normal;
    const double across = elementary::hypot(normal[0], normal[1]);
    const bool is_upright = std::abs(normal[2]) <= 1e-6 * across;
    height = is_upright ? 0.5F : normal[2] > 0 ? 1.0F : 0.0F;
}

}  // namespace

Bedding bedding_of(const ComplexView& complex, std::span<const History> histories,
                   std::span<const Polygon> polygons,
                   std::span<const std::int32_t> histories_of_corners, const Execution& execution) {
    return Corners(complex, histories, polygons, histories_of_corners, execution).bedding();
}

}  // namespace realmodel::bedding
