// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/outside_test.hpp"

#include <algorithm>
#include <vector>

#include "base/parallel_sort.hpp"
#include "validation/chunked.hpp"

namespace realmodel::validation {

namespace {

struct OuterFace {
    std::uint64_t corners;  ///< the same for faces of the same corners, in whatever order
    std::int32_t face;
    friend bool operator<(const OuterFace& a, const OuterFace& b) {
        return a.corners != b.corners ? a.corners < b.corners : a.face < b.face;
    }
};

std::uint64_t corners_in_any_order(std::span<const std::int32_t> loop) {
    std::uint64_t sum = loop.size();
    for (const std::int32_t v : loop) {
        std::uint64_t h = (static_cast<std::uint64_t>(v) + 1) * 0x9E3779B97F4A7C15u;
        h ^= h >> 29;
        sum += h * 0xBF58476D1CE4E5B9u;
    }
    return sum;
}

bool same_corners(std::span<const std::int32_t> a, std::span<const std::int32_t> b) {
    std::vector<std::int32_t> one(a.begin(), a.end()), other(b.begin(), b.end());
    std::sort(one.begin(), one.end());
    std::sort(other.begin(), other.end());
    return one == other;
}

}  // namespace

Findings check_outside(const ComplexView& model, const Execution& execution) {
    std::vector<OuterFace> outer;
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        poll(execution.progress, f);
        if (model.cell(f, 1) < 0)
            outer.push_back({corners_in_any_order(model.face(f)), static_cast<std::int32_t>(f)});
    }
    parallel_sort(outer, std::less<>(), execution);
    Findings found;
    found.examined = static_cast<std::int64_t>(outer.size());
    for (std::size_t i = 1; i < outer.size(); ++i) {
        if (outer[i].corners != outer[i - 1].corners) continue;
        const auto one = static_cast<std::size_t>(outer[i - 1].face);
        const auto other = static_cast<std::size_t>(outer[i].face);
        if (!same_corners(model.face(one), model.face(other))) continue;
        found.fail([&] {
            return Offender{.text = "face " + std::to_string(other) + " has one cell, but face " +
                                    std::to_string(one) + " of cell " +
                                    std::to_string(model.cell(one, 0)) +
                                    " lies at the same position",
                            .cell = model.cell(other, 0),
                            .face = static_cast<std::int64_t>(other),
                            .place = model.vertex(model.face(other)[0])};
        });
    }
    return found;
}

}  // namespace realmodel::validation
