// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace realmodel::input {

/// What a text may stand for: one of these numbers, or one of these spellings.
struct Values {
    std::vector<double> numbers;  ///< compared as numbers; NaN stands for any NaN
    std::vector<std::string> texts;
};

/// A row counts only where this column holds one of the values.
struct RowFilter {
    std::size_t column;  ///< from 0
    Values values;
};

/// How a table of text is written, and what is wanted of it.
struct TableFormat {
    char separator = ' ';              ///< ' ': any number of blanks and tabs
    char decimal = '.';                ///< or ','
    std::vector<std::size_t> columns;  ///< those wanted, from 0
    std::vector<RowFilter> filters;    ///< a row must pass all of them
    Values missing;                    ///< what stands for no value: such a row is left out
};

struct NumberTable {
    std::vector<double> values;  ///< row after row, as many as there are columns wanted
    std::size_t lines = 0;       ///< of the text, blank ones and comments included
    std::size_t filtered = 0;    ///< rows that a filter kept out
    std::size_t missing = 0;     ///< rows without a value
};

/// The numbers of whole lines of text (any 8-bit superset of ASCII), the same doubles as Python's
/// float() makes of them, whatever the locale.
///
/// Blank lines do not count, nor do lines that begin with #, !, %, > or //; # ends a line where a
/// field begins with it or after a number. Fields may stand in double quotes, "" in them is a
/// quote. Columns beyond those wanted may hold anything, or be absent.
///
/// Throws InputError, items[0] the line from 0, and in items[1] to items[3] the column wanted (its
/// place in `columns`) and the bytes of the text where its entry begins and ends, of kind
/// - "too_few" (items: line, number of fields; the row ends too early),
/// - "not_a_number", "not_finite" (written as nan or inf), "too_large" (for a double).
/// The first such line counts, for any number of threads (0: all that there are).
NumberTable read_numbers(std::string_view text, const TableFormat& format, int threads = 0);

}  // namespace realmodel::input
