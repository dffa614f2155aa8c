// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/base/errors.hpp"

#include <cstdio>
#include <utility>

namespace realmodel {

namespace {

std::string with_place(const std::string& invariant,
                       const std::optional<std::array<double, 3>>& where) {
    if (!where) return "this does not hold: " + invariant;
    std::array<char, 100> at{};
    std::snprintf(at.data(), at.size(), " at %.17g, %.17g, %.17g", (*where)[0], (*where)[1],
                  (*where)[2]);
    return "this does not hold: " + invariant + at.data();
}

}  // namespace

InputError::InputError(std::string error_kind, const std::string& message, int surface_index,
                       std::vector<std::int64_t> item_indices,
                       std::optional<std::array<double, 3>> where)
    : std::runtime_error(message),
      kind(std::move(error_kind)),
      surface(surface_index),
      items(std::move(item_indices)),
      place(where) {}

InternalError::InternalError(const std::string& invariant,
                             std::optional<std::array<double, 3>> where)
    : std::logic_error(with_place(invariant, where)) {}

const char* Cancelled::what() const noexcept {
    return "cancelled";
}

}  // namespace realmodel
