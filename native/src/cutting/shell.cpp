// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/shell.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "base/algorithms.hpp"
#include "base/vectors.hpp"
#include "exact/space_points.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::cutting {

namespace {

/// Takes a polygon and the set that is its shell.
using VisitOfShell =
    std::function<void(std::int32_t shell, std::span<const Position> corners, int sign)>;

/// One connected boundary of a part of a cell. Around a hollow it has a negative volume.
struct PartShell {
    double sixfold_volume = 0;
    spatial::Box box;
};
using Shells = std::map<std::int32_t, PartShell>;

/// How often a shell goes round a corner of a hollow.
struct Question {
    std::int32_t around;
    Position corner;
    std::int32_t hollow;
    std::size_t number;  ///< of the corner
    int turns = 0;
    bool is_on = false;  ///< it may be: then the turns do not tell

    bool operator<(const Question& other) const {
        return std::tie(around, corner, hollow, number) <
               std::tie(other.around, other.corner, other.hollow, other.number);
    }
};

/// Counts where a vertical ray from the corner passes through a polygon, as often as through its
/// triangles around its first corner: all polygons bound something in space, and so do these.
void ask(Question& question, std::span<const Position> corners, int sign, bool is_in_box) {
    exact::SpacePoints points;
    const exact::SpacePointId p = points.add(question.corner);
    std::vector<exact::SpacePointId> of;
    for (const Position& corner : corners)
        of.push_back(points.add(corner));
    for (std::size_t i = 2; i < of.size(); ++i) {
        if (of[i] == of[i - 1] || of[i] == of[0] || of[i - 1] == of[0]) continue;
        question.turns += sign * exact::ray_crosses(points, 2, p, {of[0], of[i - 1], of[i]}, false);
        if (is_in_box && exact::orient3d(points, of[0], of[i - 1], of[i], p) == 0)
            question.is_on = true;
    }
}

void ask_all(std::vector<Question>& questions,
             const std::function<void(const VisitOfShell&)>& for_each_polygon) {
    std::sort(questions.begin(), questions.end());
    for_each_polygon([&](std::int32_t shell, std::span<const Position> corners, int sign) {
        spatial::Box box;
        for (const Position& corner : corners)
            box.include(corner);
        auto question =
            std::partition_point(questions.begin(), questions.end(), [&](const Question& q) {
                return std::tie(q.around, q.corner[0]) < std::tie(shell, box.low[0]);
            });
        for (; question != questions.end() && question->around == shell &&
               question->corner[0] <= box.high[0];
             ++question) {
            const Position& p = question->corner;
            if (p[1] >= box.low[1] && p[1] <= box.high[1] && p[2] <= box.high[2])
                ask(*question, corners, sign, box.contains(p));
        }
    });
}

}  // namespace

void join_hollows(
    std::span<const std::int32_t> items, DisjointSets& sets,
    const std::function<void(std::int32_t item, const VisitShellPolygon&)>& polygons_of) {
    if (std::ranges::all_of(items,
                            [&](std::int32_t i) { return sets.find(i) == sets.find(items[0]); }))
        return;
    const auto for_each_polygon = [&](const VisitOfShell& visit) {
        for (const std::int32_t item : items) {
            polygons_of(item, [&](std::span<const Position> corners, int sign) {
                visit(sets.find(item), corners, sign);
            });
        }
    };
    Shells shells;
    std::optional<Position> origin;  // near them
    for_each_polygon([&](std::int32_t of, std::span<const Position> corners, int sign) {
        if (!origin) origin = corners[0];
        PartShell& shell = shells[of];
        for (std::size_t i = 0; i < corners.size(); ++i) {
            shell.box.include(corners[i]);
            if (i > 1) {
                shell.sixfold_volume +=
                    sign * sixfold_volume(*origin, corners[0], corners[i - 1], corners[i]);
            }
        }
    });
    const auto is_around = [](const PartShell& shell, const PartShell& hollow) {
        return shell.sixfold_volume > -hollow.sixfold_volume;
    };
    // where the boxes of several contain a hollow, some of its corners are asked for: one of them
    // may touch another shell
    constexpr std::size_t kCorners = 8;
    std::map<std::int32_t, std::vector<std::int32_t>> asked;  // of each hollow
    for (const auto& [inner, hollow] : shells) {
        if (hollow.sixfold_volume > 0) continue;
        std::vector<std::int32_t> around;
        for (const auto& [outer, shell] : shells) {
            if (outer != inner && is_around(shell, hollow) && shell.box.contains(hollow.box))
                around.push_back(outer);
        }
        if (around.size() > 1) asked.emplace(inner, std::move(around));
    }
    std::vector<Question> questions;
    if (!asked.empty()) {
        std::map<std::int32_t, std::size_t> taken;
        for_each_polygon([&](std::int32_t of, std::span<const Position> corners, int) {
            const auto hollow = asked.find(of);
            if (hollow == asked.end()) return;
            std::size_t& number = taken[of];
            for (std::size_t i = 0; i < corners.size() && number < kCorners; ++i, ++number) {
                for (const std::int32_t around : hollow->second)
                    questions.push_back({around, corners[i], of, number});
            }
        });
        ask_all(questions, for_each_polygon);
        std::sort(questions.begin(), questions.end(), [](const Question& a, const Question& b) {
            return std::tie(a.hollow, a.number, a.around) < std::tie(b.hollow, b.number, b.around);
        });
    }
    for (const auto& shell : shells) {
        const std::int32_t inner = shell.first;
        const PartShell& hollow = shell.second;
        if (hollow.sixfold_volume > 0) continue;
        // what contains the first of its corners that touches none
        std::vector<std::int32_t> containing;
        const auto of_hollow = items_with_key(questions, inner, &Question::hollow);
        for (const auto of_corner : groups_of(of_hollow, &Question::number)) {
            if (std::ranges::any_of(of_corner, &Question::is_on)) continue;
            for (const Question& question : of_corner) {
                if (question.turns != 0) containing.push_back(question.around);
            }
            if (!containing.empty()) break;
        }
        const Shells::value_type* around = nullptr;
        const auto rank = [&](const Shells::value_type& of) {
            return std::tuple(std::ranges::find(containing, of.first) == containing.end(),
                              !of.second.box.contains(hollow.box), of.second.sixfold_volume);
        };
        for (const auto& other : shells) {
            if (other.first == inner || !is_around(other.second, hollow)) continue;
            if (around == nullptr || rank(other) < rank(*around)) around = &other;
        }
        if (around != nullptr) sets.join(around->first, inner);
    }
}

}  // namespace realmodel::cutting
