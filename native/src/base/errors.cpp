// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/base/errors.hpp"

#include <utility>

namespace realmodel {

InputError::InputError(std::string error_kind, const std::string& message, int surface_index,
                       std::vector<std::int64_t> item_indices,
                       std::optional<std::array<double, 3>> where)
    : std::runtime_error(message),
      kind(std::move(error_kind)),
      surface(surface_index),
      items(std::move(item_indices)),
      place(where) {}

const char* Cancelled::what() const noexcept {
    return "cancelled";
}

}  // namespace realmodel
