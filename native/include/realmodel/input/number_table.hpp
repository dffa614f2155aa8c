// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace realmodel::input {

/// One of these numbers, or one of these texts.
struct Values {
    std::vector<double> numbers;  ///< compared as numbers; NaN stands for any NaN
    std::vector<std::string> texts;
};

/// Rows are used only where this column holds one of the values.
struct RowFilter {
    std::size_t column;  ///< from 0
    Values values;
};

/// The format of a table of text, and the columns wanted of it.
struct TableFormat {
    char separator = ' ';              ///< ' ': any number of blanks and tabs
    char decimal = '.';                ///< or ','
    std::vector<std::size_t> columns;  ///< those wanted, from 0
    std::vector<RowFilter> filters;    ///< a row must pass all of them
    Values missing;                    ///< no-data values: rows with one of them are left out
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
/// Blank lines are skipped, and so are lines that begin with #, !, %, > or //; # ends a line where
/// a field begins with it or after a number. Fields may be in double quotes, "" in them is a quote.
/// Columns beyond those wanted may hold anything, or be absent.
///
/// @param threads  0: as many as there are
/// @throws InputError, always for the first wrong line, of kind
///         - "too_few", where a row ends too early (items: line from 0, number of fields),
///         - "not_a_number", "not_finite" (written as nan or inf) or "too_large" for a double
///         (items:
///           line from 0, index in `columns`, begin and end of the entry in bytes of the text)
NumberTable read_numbers(std::string_view text, const TableFormat& format, int threads = 0);

}  // namespace realmodel::input
