// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace realmodel::input {

enum class Spelling { kNumber, kNotANumber, kNotFinite, kTooLarge };

struct ParsedNumber {
    Spelling spelling = Spelling::kNotANumber;
    double value = 0.0;      ///< the nearest double; NaN or infinity where it is not finite
    std::size_t length = 0;  ///< of what was read, from the beginning of the text
};

/// The number at the beginning of a text: sign, digits with a decimal mark, exponent (no blanks
/// before, no hexadecimal, no marks between thousands), or nan, inf, infinity in any case.
ParsedNumber parse_number(std::string_view text, char decimal);

}  // namespace realmodel::input
