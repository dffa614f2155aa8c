// SPDX-License-Identifier: GPL-3.0-or-later
// read_numbers, decode_lzw.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "arrays.hpp"
#include "execution.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/input/lzw.hpp"
#include "realmodel/input/number_table.hpp"

namespace py = pybind11;

namespace realmodel::bindings {

namespace {

using ValuesTuple = std::tuple<std::vector<double>, std::vector<std::string>>;
using FilterTuple = std::tuple<std::size_t, ValuesTuple>;

input::Values values_of(const ValuesTuple& values) {
    return {std::get<0>(values), std::get<1>(values)};
}

std::tuple<NumpyArray<double>, std::size_t, std::size_t, std::size_t> read_numbers(
    const py::bytes& text, const std::pair<char, char>& marks,
    const std::vector<std::size_t>& columns, const std::vector<FilterTuple>& filters,
    const ValuesTuple& missing, WatchedExecution* execution) {
    if (columns.empty()) throw InputError("bad_range", "no columns");
    const std::string_view whole = text;
    input::TableFormat format{marks.first, marks.second, columns, {}, values_of(missing)};
    for (const auto& [column, values] : filters)
        format.filters.push_back({column, values_of(values)});
    auto table = unlocked(  // bytes do not change
        [&] { return input::read_numbers(whole, format, run(execution).threads); });
    return {to_array(std::move(table.values), columns.size()), table.lines, table.filtered,
            table.missing};
}

py::bytes decode_lzw(const py::bytes& encoded, std::size_t most) {
    const std::string_view encoded_text = encoded;
    auto decoded = unlocked([&] {
        return input::decode_lzw(
            {reinterpret_cast<const std::uint8_t*>(encoded_text.data()), encoded_text.size()},
            most);
    });
    return {reinterpret_cast<const char*>(decoded.data()), decoded.size()};
}

}  // namespace

void bind_input(py::module_& module) {
    module.def("read_numbers", &read_numbers, py::arg("text"), py::arg("marks"), py::arg("columns"),
               py::arg("filters"), py::arg("missing"), py::arg("execution") = py::none(),
               R"(Numbers of whole lines of a table of text.

text       bytes in any encoding that keeps ASCII
marks      (separator, decimal): one character between the fields, " ": any number of blanks and
           tabs; "." or ","
columns    numbers from 0 of the columns wanted
filters    [(column, (numbers, texts as bytes)), ...]: rows that hold none of these are left out
missing    (numbers, texts): rows that hold one of these in a wanted column are left out

Returns (values (N, len(columns)) float64, lines of the text, rows kept out by filters, rows
without a value). The numbers are those of Python's float(). It takes a few milliseconds for each
megabyte and cannot be stopped: pass large texts in pieces.

Raises InputError of kind "too_few" (items: line from 0, fields there), or "not_a_number",
"not_finite", "too_large" (items: line, place in `columns`, begin and end of the entry, counted
from `begin`).)");
    module.def("decode_lzw", &decode_lzw, py::arg("encoded"), py::arg("most"),
               R"(Bytes of a strip or tile of a TIFF file compressed by LZW, at most `most`.

Raises InputError of kind "damaged".)");
}

}  // namespace realmodel::bindings
