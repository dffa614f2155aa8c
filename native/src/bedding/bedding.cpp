// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/bedding/bedding.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "base/algorithms.hpp"
#include "base/checked_indices.hpp"
#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/parallel_sort.hpp"
#include "base/vectors.hpp"
#include "exact/orientation.hpp"
#include "realmodel/base/elementary.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/strata/stack.hpp"
#include "spatial/plan_tiles.hpp"

namespace realmodel::bedding {

namespace {

using spatial::PlanPosition;
using strata::meaning;
using strata::Rule;

constexpr std::uint32_t kNone = UINT32_MAX;
constexpr double kNear = 32 * 0x1p-52;     // of the largest coordinate: what rounding may do
constexpr double kBeside = 8 * kNear;      // of it: from an upright polygon to a position beside it
constexpr double kInwards = 1.0 / 64;      // of the way from a corner to the middle of its polygon
constexpr std::size_t kPolygons = 16'384;  // polygons that a thread takes at once
constexpr std::size_t kCorners = 16'384;   // corners, likewise
constexpr double kSame = 1e-6;             // of the heights of a sheet

enum class HeightState : std::uint8_t {
    kAbsent,  ///< no triangle is there
    kHeight,  ///< one height
    kBorder   ///< a border or a step of the sheet is there: a side has to be chosen
};

/// The triangles of a sheet in plan, kept by the tiles that their boxes meet. Sheets whose heights
/// alone differ share one, so that a position is located once for all of them.
class SheetPlan {
public:
    using Areas = std::array<double, 3>;
    struct SheetLocation {
        HeightState state = HeightState::kAbsent;
        std::int32_t triangle = -1;
        Areas areas{};  ///< twice those of the position with each edge of the triangle
    };

    /// @param near  what rounding may move a position by
    /// @throws InputError kind bad_index (items: the triangle)
    SheetPlan(const TriangleView& sheet, double near) : near_(near) {
        add_triangles(sheet);
        std::vector<spatial::PlanBox> boxes;
        boxes.reserve(triangles_.size());
        spatial::PlanBox frame = spatial::kNoBox;
        for (const SheetTriangle& triangle : triangles_) {
            boxes.push_back(spatial::box_around(triangle.corner).widened(near));
            frame = frame.united(boxes.back());
        }
        tiles_ = spatial::PlanTiles(frame, triangles_.size());
        triangles_at_ = bucketize<std::int32_t>(tiles_.size(), [&](const auto& put) {
            for (std::size_t t = 0; t < boxes.size(); ++t) {
                tiles_.for_each(tiles_.span(boxes[t]),
                                [&](std::size_t tile) { put(tile, static_cast<std::int32_t>(t)); });
            }
        });
    }

    /// The vertices of the triangles that have an area in plan, counter-clockwise.
    std::span<const std::array<std::int32_t, 3>> triangles() const { return numbers_; }
    SheetLocation at(const PlanPosition& position) const {
        SheetLocation location;
        if (triangles_.empty() || !tiles_.frame().contains(position)) return location;
        double best = -HUGE_VAL;
        for (const std::int32_t t : triangles_at_[tiles_.tile_at(position)]) {
            const SheetTriangle& triangle = triangles_[index(t)];
            const Areas areas = triangle.areas(position);
            const auto& slack = triangle.slack;
            if (!triangle.is_near(areas)) continue;
            if (areas[0] > slack[0] && areas[1] > slack[1] && areas[2] > slack[2])
                return {HeightState::kHeight, t, areas};
            if (triangle.has_border_near(position, areas, near_))
                return {HeightState::kBorder, t, areas};
            const double least =
                std::min({areas[0] / slack[0], areas[1] / slack[1], areas[2] / slack[2]});
            if (least > best) {
                best = least;
                location = {HeightState::kHeight, t, areas};
            }
        }
        return location;
    }
    /// A triangle that holds a position, or none: -1.
    std::int32_t holding(const PlanPosition& position) const {
        if (triangles_.empty() || !tiles_.frame().contains(position)) return -1;
        for (const std::int32_t t : triangles_at_[tiles_.tile_at(position)]) {
            const Areas signed_areas = areas(t, position);
            if (signed_areas[0] >= 0 && signed_areas[1] >= 0 && signed_areas[2] >= 0) return t;
        }
        return -1;
    }
    Areas areas(std::int32_t triangle, const PlanPosition& position) const {
        return triangles_[index(triangle)].areas(position);
    }
    /// Calls visit(triangle, areas) for those that hold a position or are near it.
    template <class Visit>
    void for_each_near(const PlanPosition& position, const Visit& visit) const {
        for (const std::int32_t t : triangles_at_[tiles_.tile_at(position)]) {
            const Areas signed_areas = areas(t, position);
            if (triangles_[index(t)].is_near(signed_areas)) visit(t, signed_areas);
        }
    }

private:
    struct SheetTriangle {
        std::array<PlanPosition, 3> corner;
        std::array<double, 3> slack;  ///< of the edge from a corner to the next: length times near
        std::uint8_t border_edges = 0, border_corners = 0;  ///< bits

        Areas areas(const PlanPosition& p) const {
            Areas signed_areas{};
            for (std::size_t i = 0; i < 3; ++i) {
                signed_areas[i] = twice_area(corner[i], corner[(i + 1) % 3], p);
            }
            return signed_areas;
        }
        bool is_near(const Areas& areas) const {
            return areas[0] >= -slack[0] && areas[1] >= -slack[1] && areas[2] >= -slack[2];
        }
        /// Whether a border passes within `near` of a position beside the triangle.
        bool has_border_near(const PlanPosition& p, const Areas& areas, double near) const {
            for (std::size_t i = 0; i < 3; ++i) {
                const unsigned bit = 1U << i;
                if ((border_edges & bit) != 0 && areas[i] <= slack[i]) return true;
                if ((border_corners & bit) != 0 && std::abs(p[0] - corner[i][0]) <= near &&
                    std::abs(p[1] - corner[i][1]) <= near)
                    return true;
            }
            return false;
        }
    };
    /// Those that have an area in plan.
    void add_triangles(const TriangleView& sheet) {
        const std::size_t vertices = sheet.vertices.size() / 3;
        for (std::size_t t = 0; t < sheet.triangles.size() / 3; ++t) {
            std::array<std::int32_t, 3> v{};
            SheetTriangle triangle;
            for (std::size_t i = 0; i < 3; ++i) {
                v[i] = sheet.triangles[3 * t + i];
            }
            require_vertices("triangle", t, v, vertices);
            const auto plan = [&](std::int32_t vertex) {
                const double* row = &sheet.vertices[3 * index(vertex)];
                return PlanPosition{row[0], row[1]};
            };
            const int way = exact::orient2d(plan(v[0]), plan(v[1]), plan(v[2]));
            if (way == 0) continue;
            if (way < 0) std::swap(v[1], v[2]);
            for (std::size_t i = 0; i < 3; ++i)
                triangle.corner[i] = plan(v[i]);
            for (std::size_t i = 0; i < 3; ++i) {
                const auto &a = triangle.corner[i], &b = triangle.corner[(i + 1) % 3];
                triangle.slack[i] = near_ * distance(a, b);
            }
            triangles_.push_back(triangle);
            numbers_.push_back(v);
        }
        find_borders(vertices);
    }
    /// A border is an edge that is not of two triangles.
    void find_borders(std::size_t vertices) {
        struct SheetEdge {
            std::int32_t low, high, triangle, slot;
        };
        std::vector<SheetEdge> edges;
        edges.reserve(3 * numbers_.size());
        for (std::size_t t = 0; t < numbers_.size(); ++t) {
            for (std::size_t i = 0; i < 3; ++i) {
                const auto [low, high] = std::minmax(numbers_[t][i], numbers_[t][(i + 1) % 3]);
                edges.push_back(
                    {low, high, static_cast<std::int32_t>(t), static_cast<std::int32_t>(i)});
            }
        }
        std::ranges::sort(edges, [](const SheetEdge& a, const SheetEdge& b) {
            return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
        });
        std::vector<std::uint8_t> is_border(vertices, 0);
        for (const auto uses :
             groups_of(edges, [](const SheetEdge& e) { return std::pair(e.low, e.high); })) {
            if (uses.size() == 2) continue;
            for (const SheetEdge& use : uses)
                triangles_[index(use.triangle)].border_edges |=
                    static_cast<std::uint8_t>(1U << static_cast<unsigned>(use.slot));
            is_border[index(uses[0].low)] = is_border[index(uses[0].high)] = 1;
        }
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            for (std::size_t i = 0; i < 3; ++i) {
                if (is_border[index(numbers_[t][i])] != 0)
                    triangles_[t].border_corners |= static_cast<std::uint8_t>(1U << i);
            }
        }
    }

    double near_;
    std::vector<SheetTriangle> triangles_;
    std::vector<std::array<std::int32_t, 3>> numbers_;
    spatial::PlanTiles tiles_;
    Buckets<std::int32_t> triangles_at_;  ///< of each tile
};

/// Heights of a sheet at plan positions.
class SheetHeights {
public:
    struct SheetHeight {
        HeightState state;
        double height;
    };

    /// @param plan  that of the sheet, which has to outlive this
    SheetHeights(const SheetPlan& plan, const TriangleView& sheet) : plan_(&plan) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        heights_.reserve(plan.triangles().size());
        for (const auto& corners : plan.triangles()) {
            auto& heights = heights_.emplace_back();
            for (std::size_t i = 0; i < 3; ++i) {
                heights[i] = sheet.vertices[3 * index(corners[i]) + 2];
                low = std::min(low, heights[i]);
                high = std::max(high, heights[i]);
            }
        }
        same_ = kSame * std::max(0.0, high - low);
    }

    SheetHeight at(const SheetPlan::SheetLocation& location) const {
        return {location.state, location.state == HeightState::kHeight
                                    ? height(location.triangle, location.areas)
                                    : 0.0};
    }
    /// The height at a border, on the side of a triangle that is there; -1: no triangle.
    SheetHeight beside(std::int32_t triangle, const PlanPosition& position) const {
        if (triangle < 0) return {HeightState::kAbsent, 0};
        const double guess = height(triangle, plan_->areas(triangle, position));
        // Of the triangles around the position the first at about that height: all polygons on one
        // side get the same.
        std::vector<double> heights;
        plan_->for_each_near(position, [&](std::int32_t t, const SheetPlan::Areas& areas) {
            heights.push_back(height(t, areas));
        });
        double nearest = guess, apart = HUGE_VAL;
        for (const double height : heights) {
            if (std::abs(height - guess) >= apart) continue;
            apart = std::abs(height - guess);
            nearest = height;
        }
        const auto first = std::ranges::find_if(
            heights, [&](double height) { return std::abs(height - nearest) <= same_; });
        return {HeightState::kHeight, first == heights.end() ? guess : *first};
    }

private:
    double height(std::int32_t triangle, const SheetPlan::Areas& areas) const {
        const auto& heights = heights_[index(triangle)];
        double sum = 0, weighted = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const double weight =
                std::max(0.0, areas[(i + 1) % 3]);  // of the corner across that edge
            sum += weight;
            weighted += weight * heights[i];
        }
        if (!(sum > 0)) return heights[0];
        const auto [low, high] = std::minmax({heights[0], heights[1], heights[2]});
        return std::clamp(weighted / sum, low, high);
    }

    const SheetPlan* plan_;
    double same_ = 0;  ///< heights that differ by less are one: a step that nobody sees
    std::vector<std::array<double, 3>> heights_;  ///< of the corners of each triangle
};

/// A corner of a polygon, by their numbers, and its vertex.
struct PolygonCorner {
    std::uint32_t number;
    std::int32_t polygon, vertex;
};

/// A history at one plan position, as far as it was replayed.
struct HistoryColumn {
    bool has_layer = false;   ///< the last sheet has deposited a layer
    bool has_top = false;     ///< some sheet is there
    bool has_floor = false;   ///< some sheet protects what is below it
    bool has_border = false;  ///< of some sheet: a side has to be chosen first
    double base = 0;          ///< of the layer
    double top = 0;           ///< of the layer, and of all
    double floor = 0;

    /// Lays a sheet on it.
    void lay(const History& history, std::size_t sheet, const SheetHeights::SheetHeight& height) {
        has_layer = false;
        has_border |= height.state == HeightState::kBorder;
        if (height.state != HeightState::kHeight) return;
        const auto rule = meaning(history.rules.empty() ? Rule::kErosional : history.rules[sheet]);
        double level = std::max(height.height, history.base_elevation.value_or(height.height));
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

class BeddingCorners {
public:
    BeddingCorners(const ComplexView& complex, std::span<const History> histories,
                   std::span<const BedPolygon> polygons,
                   std::span<const std::int32_t> histories_of_corners, const Execution& execution);
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
    std::int32_t vertex(const BedPolygon& polygon, std::size_t corner) const {
        const auto face = complex_.face(index(polygon.face));
        return polygon.reversed ? face[face.size() - 1 - corner] : face[corner];
    }

    /// What a polygon is turned to, not normalized, and the middle of its corners in plan.
    struct Facing {
        std::array<double, 3> normal;
        PlanPosition middle;
    };
    Facing facing(const BedPolygon& polygon) const;
    PlanPosition beside(const PlanPosition& position, const BedPolygon& polygon) const;

    double height_of(const PolygonCorner& corner) const {
        return complex_.vertex(corner.vertex)[2];
    }
    std::size_t position_of(const PolygonCorner& corner) const {
        return index(position_of_[index(corner.vertex)]);
    }

    std::span<const PolygonCorner> corners_of(std::size_t history) const {
        const std::size_t first = first_layer_[history], last = first_layer_[history + 1];
        return {corners_.values.data() + corners_.offsets[first],
                corners_.values.data() + corners_.offsets[last]};
    }
    void replay(std::size_t history, std::span<const std::size_t> used, Bedding& bedding) const;
    void set(const PolygonCorner& corner, const HistoryColumn& column, bool has_layer,
             Bedding& bedding) const;
    void set_at_borders(std::size_t history, std::vector<PolygonCorner> some,
                        Bedding& bedding) const;
    std::vector<HistoryColumn> columns_at(std::size_t history, const PlanPosition& position,
                                          std::span<const SheetPlan::SheetLocation> locations,
                                          std::span<const std::int32_t> triangles) const;

    const ComplexView& complex_;
    std::span<const History> histories_;
    std::span<const BedPolygon> polygons_;
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
    Buckets<PolygonCorner> corners_;  ///< by history and layer; those in no layer before all layers
};

BeddingCorners::BeddingCorners(const ComplexView& complex, std::span<const History> histories,
                               std::span<const BedPolygon> polygons,
                               std::span<const std::int32_t> histories_of_corners,
                               const Execution& execution)
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

void BeddingCorners::check() {
    for (std::size_t n = 0; n < polygons_.size(); ++n) {
        const auto refuse = [n](const char* what) { refuse_index("polygon", n, what); };
        const BedPolygon& polygon = polygons_[n];
        if (polygon.face < 0 || std::cmp_greater_equal(polygon.face, complex_.face_count()))
            refuse("is a face that does not exist");
        if (polygon.history < 0 || std::cmp_greater_equal(polygon.history, histories_.size()))
            refuse("has a history that does not exist");
        if (polygon.layer < -1 ||
            std::cmp_greater_equal(polygon.layer, histories_[index(polygon.history)].sheets.size()))
            refuse("lies in a layer that does not exist");
        require_vertices("polygon", n, complex_.face(index(polygon.face)), complex_.vertex_count());
    }
}

/// Each corner's history is there, and has the layer of its polygon.
void BeddingCorners::check_histories() const {
    if (histories_of_corners_.empty()) return;
    const auto refuse = [](std::size_t polygon) {
        refuse_index("polygon", polygon, "has a corner without a history");
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

void BeddingCorners::number_corners() {
    std::size_t count = 0;
    begin_.reserve(polygons_.size() + 1);
    for (const BedPolygon& polygon : polygons_) {
        begin_.push_back(static_cast<std::uint32_t>(count));
        count += complex_.face(index(polygon.face)).size();
        check_total(count, INT32_MAX);
    }
    begin_.push_back(static_cast<std::uint32_t>(count));
}

void BeddingCorners::make_sheets() {
    std::map<std::pair<const void*, const void*>, std::size_t> known;
    std::vector<const TriangleView*> distinct;
    for (const History& history : histories_) {
        auto& sheet_numbers = sheets_of_.emplace_back();
        for (const TriangleView& sheet : history.sheets) {
            const auto key =
                std::pair<const void*, const void*>(sheet.vertices.data(), sheet.triangles.data());
            const auto [entry, is_new] = known.try_emplace(key, distinct.size());
            if (is_new) distinct.push_back(&sheet);
            sheet_numbers.push_back(entry->second);
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
void BeddingCorners::sort_positions() {
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

void BeddingCorners::sort_corners() {
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
    corners_ = bucketize_in_order<PolygonCorner>(layers, chunks, produce, execution_);
}

Bedding BeddingCorners::bedding() {
    const std::size_t count = begin_.back();
    Bedding made{Array<float>(count), Array<float>(count), Array<float>(count)};
    column_of_.assign(positions_.size(), kNone);
    for (std::size_t history = 0; history < histories_.size(); ++history) {
        std::vector<std::size_t> used;  // positions
        for (const PolygonCorner& corner : corners_of(history)) {
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
void BeddingCorners::replay(std::size_t history, std::span<const std::size_t> used,
                            Bedding& bedding) const {
    const auto& sheets = sheets_of_[history];
    std::vector<HistoryColumn> columns(used.size());
    std::vector<std::vector<SheetPlan::SheetLocation>> locations(plans_.size());
    std::vector<std::size_t> last(plans_.size());  // the last sheet with each plan
    for (std::size_t k = 0; k < sheets.size(); ++k)
        last[plan_of_[sheets[k]]] = k;
    const auto for_corners = [&](std::span<const PolygonCorner> some, const auto& work) {
        parallel_ranges(some.size(), kCorners, execution_, [&](std::size_t begin, std::size_t end) {
            for (const PolygonCorner& corner : some.subspan(begin, end - begin))
                work(corner, columns[column_of_[position_of(corner)]]);
        });
    };
    const auto set_layer = [&](std::size_t layer) {
        for_corners(corners_[first_layer_[history] + layer],
                    [&](const PolygonCorner& corner, const HistoryColumn& column) {
                        set(corner, column, layer > 0 && column.has_layer, bedding);
                    });
    };
    set_layer(0);
    for (std::size_t k = 0; k < sheets.size(); ++k) {
        const SheetPlan& plan = *plans_[plan_of_[sheets[k]]];
        auto& at = locations[plan_of_[sheets[k]]];
        const bool is_new = at.empty();
        at.resize(used.size());
        parallel_for_each(used.size(), execution_, [&](std::size_t n) {
            if (is_new) at[n] = plan.at(positions_[used[n]]);
            columns[n].lay(histories_[history], k, sheets_[sheets[k]]->at(at[n]));
        });
        if (last[plan_of_[sheets[k]]] == k) at = {};
        set_layer(k + 1);
    }
    std::vector<PolygonCorner> at_borders;
    for (const PolygonCorner& corner : corners_of(history)) {
        if (columns[column_of_[position_of(corner)]].has_border) at_borders.push_back(corner);
    }
    for_corners(corners_of(history), [&](const PolygonCorner& corner, const HistoryColumn& column) {
        bedding.depth[corner.number] =
            static_cast<float>(std::max(0.0, column.top - height_of(corner)));
    });
    set_at_borders(history, std::move(at_borders), bedding);
}

/// At the border of a sheet each polygon has the column of its own side.
void BeddingCorners::set_at_borders(std::size_t history, std::vector<PolygonCorner> some,
                                    Bedding& bedding) const {
    std::ranges::sort(some, std::less<>(), [&](const PolygonCorner& corner) {
        return std::pair(position_of(corner), corner.number);
    });
    std::vector<std::span<const PolygonCorner>> groups;  // those of each position
    for (const auto corners :
         groups_of(some, [&](const PolygonCorner& c) { return position_of(c); }))
        groups.push_back(corners);
    parallel_chunks(groups.size(), execution_, [&](std::size_t n) {
        const std::span<const PolygonCorner> corners = groups[n];
        const PlanPosition& position = positions_[position_of(corners[0])];
        std::vector<SheetPlan::SheetLocation> locations;  // in each plan
        for (const auto& plan : plans_)
            locations.push_back(plan->at(position));
        std::map<std::vector<std::int32_t>, std::vector<HistoryColumn>> sides;
        for (const PolygonCorner& corner : corners) {
            const BedPolygon& polygon = polygons_[index(corner.polygon)];
            const PlanPosition inside = beside(position, polygon);
            std::vector<std::int32_t> triangles;  // in each plan, at borders
            for (std::size_t plan = 0; plan < plans_.size(); ++plan) {
                const bool is_border = locations[plan].state == HeightState::kBorder;
                triangles.push_back(is_border ? plans_[plan]->holding(inside) : -1);
            }
            auto& columns = sides[triangles];
            if (columns.empty()) columns = columns_at(history, position, locations, triangles);
            const auto layer = static_cast<std::size_t>(polygon.layer + 1);
            set(corner, columns[layer], layer > 0 && columns[layer].has_layer, bedding);
            bedding.depth[corner.number] =
                static_cast<float>(std::max(0.0, columns.back().top - height_of(corner)));
        }
    });
}

/// A column before all sheets and after each. triangles: in each plan, the one on whose side
/// heights are wanted at a border.
std::vector<HistoryColumn> BeddingCorners::columns_at(
    std::size_t history, const PlanPosition& position,
    std::span<const SheetPlan::SheetLocation> locations,
    std::span<const std::int32_t> triangles) const {
    const auto& sheets = sheets_of_[history];
    std::vector<HistoryColumn> columns(1);
    for (std::size_t k = 0; k < sheets.size(); ++k) {
        const SheetPlan::SheetLocation& location = locations[plan_of_[sheets[k]]];
        const SheetHeights& heights = *sheets_[sheets[k]];
        columns.push_back(columns.back());
        columns.back().lay(histories_[history], k,
                           location.state == HeightState::kBorder
                               ? heights.beside(triangles[plan_of_[sheets[k]]], position)
                               : heights.at(location));
    }
    return columns;
}

BeddingCorners::Facing BeddingCorners::facing(const BedPolygon& polygon) const {
    const auto face = complex_.face(index(polygon.face));
    const auto origin = complex_.vertex(face[0]);
    Facing facing{};
    for (std::size_t i = 0; i < face.size(); ++i) {
        auto a = complex_.vertex(face[i]), b = complex_.vertex(face[(i + 1) % face.size()]);
        for (std::size_t axis = 0; axis < 2; ++axis)
            facing.middle[axis] += a[axis] / static_cast<double>(face.size());
        for (std::size_t axis = 0; axis < 3; ++axis) {
            a[axis] -= origin[axis];
            b[axis] -= origin[axis];
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
            facing.normal[axis] += (a[u] * b[v] - a[v] * b[u]) * (polygon.reversed ? -0.5 : 0.5);
        }
    }
    return facing;
}

/// A position in plan that lies in the polygon, or inside of an upright one, near its corner.
PlanPosition BeddingCorners::beside(const PlanPosition& position, const BedPolygon& polygon) const {
    const auto [normal, middle] = facing(polygon);
    PlanPosition inner = moved(position, kInwards, minus({middle[0], middle[1]}, position));
    const double across = elementary::hypot(normal[0], normal[1]);
    if (across > 0 && std::abs(normal[2]) <= 1e-6 * across) {
        const double step = kBeside * largest_plan_ / across;
        inner[0] -= step * normal[0];
        inner[1] -= step * normal[1];
    }
    return inner;
}

/// Height and thickness of a corner. column: as far as the sheet over its layer.
void BeddingCorners::set(const PolygonCorner& corner, const HistoryColumn& column, bool has_layer,
                         Bedding& bedding) const {
    const BedPolygon& polygon = polygons_[index(corner.polygon)];
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
                   std::span<const BedPolygon> polygons,
                   std::span<const std::int32_t> histories_of_corners, const Execution& execution) {
    return BeddingCorners(complex, histories, polygons, histories_of_corners, execution).bedding();
}

}  // namespace realmodel::bedding
