// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <exception>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace realmodel {

/// The input cannot be used. The message (what()) says what is wrong; the fields say where, so that
/// a caller who knows names and files can put them into the message.
struct InputError : std::runtime_error {
    /// @param error_kind     what is wrong in one word, e.g. "double_valued"; callers may branch on
    /// it
    /// @param message        one line for a person
    /// @param surface_index  index of the surface in the list that was passed, -1 where none is
    /// meant
    /// @param item_indices   indices of the triangles, points or rings concerned
    /// @param where          x, y, z in model units
    InputError(std::string error_kind, const std::string& message, int surface_index = -1,
               std::vector<std::int64_t> item_indices = {},
               std::optional<std::array<double, 3>> where = std::nullopt);

    std::string kind;
    int surface;
    std::vector<std::int64_t> items;
    std::optional<std::array<double, 3>> place;
};

/// An invariant of the library does not hold: a defect of it, not of the input. what() says which
/// one and where, for a report that carries the input with it.
struct InternalError : std::logic_error {
    /// @param invariant  what does not hold, e.g. "a facet lies beneath each facet of a block"
    /// @param where      x, y, z in model units
    explicit InternalError(const std::string& invariant,
                           std::optional<std::array<double, 3>> where = std::nullopt);
};

/// The caller asked to stop (Progress::cancel). Nothing of the result exists.
struct Cancelled : std::exception {
    const char* what() const noexcept override;
};

}  // namespace realmodel
