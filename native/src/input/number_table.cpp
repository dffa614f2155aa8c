// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/input/number_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "base/parallel.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::input {

namespace {

enum class Spelling { kNumber, kNotANumber, kNotFinite, kTooLarge };

struct ParsedNumber {
    Spelling spelling = Spelling::kNotANumber;
    double value = 0.0;      ///< the nearest double; NaN or infinity where it is not finite
    std::size_t length = 0;  ///< of what was read, from the beginning of the text
};

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// Whether a text begins with a word (small letters), in any case.
bool begins_with(std::string_view text, std::string_view word) {
    return text.size() >= word.size() &&
           std::equal(word.begin(), word.end(), text.begin(),
                      [](char a, char b) { return a == static_cast<char>(b | 0x20); });
}

ParsedNumber not_finite(std::string_view text, std::size_t sign) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const double signed_infinity = sign > 0 && text[0] == '-' ? -infinity : infinity;
    const std::string_view word = text.substr(sign);
    if (begins_with(word, "infinity")) return {Spelling::kNotFinite, signed_infinity, sign + 8};
    if (begins_with(word, "inf")) return {Spelling::kNotFinite, signed_infinity, sign + 3};
    if (begins_with(word, "nan")) {
        return {Spelling::kNotFinite, std::numeric_limits<double>::quiet_NaN(), sign + 3};
    }
    return {};
}

/// Where the digits of a number, its decimal mark and its exponent end.
std::size_t extent_of(std::string_view text, std::size_t begin, char decimal) {
    std::size_t at = begin;
    const auto skip_digits = [&] {
        while (at < text.size() && is_digit(text[at]))
            ++at;
    };
    skip_digits();
    if (at < text.size() && text[at] == decimal) {
        ++at;
        skip_digits();
    }
    if (at < text.size() && (text[at] | 0x20) == 'e') {
        std::size_t exponent = at + 1;
        if (exponent < text.size() && (text[exponent] == '+' || text[exponent] == '-')) ++exponent;
        if (exponent < text.size() && is_digit(text[exponent])) {
            at = exponent;
            skip_digits();
        }
    }
    return at;
}

/// A number that from_chars finds to lie beyond the range of doubles: zero, or too large. The
/// position of the first significant digit decides, as the exponent may be of any length.
ParsedNumber beyond_range(std::string_view digits, bool negative, std::size_t length) {
    // Below the least double where the exponent says so or the zeros before the first digit do.
    const std::size_t e = std::min(digits.find_first_of("eE"), digits.size());
    const std::size_t first = digits.find_first_of("123456789");
    const std::size_t point = std::min(digits.find('.'), e);
    const auto leading =
        first < point ? static_cast<double>(point - first) : -static_cast<double>(first - point);
    double exponent = 0;
    for (std::size_t i = e + 1; i < digits.size(); ++i) {
        if (is_digit(digits[i])) exponent = std::min(10 * exponent + (digits[i] - '0'), 1e15);
    }
    if (e + 1 < digits.size() && digits[e + 1] == '-') exponent = -exponent;
    if (leading + exponent > 0) return {Spelling::kTooLarge, 0.0, length};
    return {Spelling::kNumber, negative ? -0.0 : 0.0, length};
}

/// The number at the beginning of a text: sign, digits with a decimal mark, exponent (no blanks
/// before, no hexadecimal, no marks between thousands), or nan, inf, infinity in any case.
ParsedNumber parse_number(std::string_view text, char decimal) {
    if (text.empty()) return {};
    const std::size_t sign = text[0] == '+' || text[0] == '-' ? 1 : 0;
    if (sign == text.size()) return {};
    const char first = text[sign];
    if (!is_digit(first) && first != decimal) return not_finite(text, sign);
    const bool negative = text[0] == '-';
    const std::size_t end = extent_of(text, sign, decimal);
    std::string_view digits = text.substr(sign, end - sign);
    std::string with_point;  // from_chars knows no other decimal mark
    if (decimal != '.') {
        with_point = digits;
        std::replace(with_point.begin(), with_point.end(), decimal, '.');
        digits = with_point;
    }
    double value = 0.0;
    const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::invalid_argument) return {};  // a decimal mark alone
    if (error == std::errc::result_out_of_range) return beyond_range(digits, negative, end);
    if (stop != digits.data() + digits.size()) return {};
    return {Spelling::kNumber, negative ? -value : value, end};
}

constexpr std::size_t kBytesAtOnce = 1 << 16;  // the least that a thread reads

/// Bytes of the text, without blanks around them and without quotes.
struct TextField {
    std::size_t begin, end;
    bool quoted = false;
};

/// What is wrong with a line of a piece of the text; `items` as read_numbers says.
struct Wrong {
    std::string kind;
    std::vector<std::int64_t> items;
};

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r';
}

/// The lines of a part of the text, one after another.
class TextLines {
public:
    TextLines(std::string_view text, const TableFormat& format) : text_(text), format_(format) {
        for (const std::size_t column : format.columns)
            most_ = std::max(most_, column + 1);
        for (const RowFilter& filter : format.filters)
            most_ = std::max(most_, filter.column + 1);
    }

    /// Reads the lines that begin in [begin, end) into `out`; stops at the first that is wrong.
    std::optional<Wrong> read(std::size_t begin, std::size_t end, NumberTable& out) {
        while (begin < end) {
            const std::size_t newline = std::min(text_.find('\n', begin), text_.size());
            split(begin, newline);
            if (!fields_.empty()) {
                if (std::optional<Wrong> wrong = row(out)) {
                    wrong->items[0] = static_cast<std::int64_t>(out.lines);
                    return wrong;
                }
            }
            ++out.lines;
            begin = newline + 1;
        }
        return std::nullopt;
    }

private:
    std::string_view text_;
    const TableFormat& format_;
    std::size_t most_ = 1;           // fields of a line that matter
    std::vector<TextField> fields_;  // of the present line
    std::string unquoted_;

    void skip_blanks(std::size_t& at, std::size_t end) const {
        while (at < end && is_blank(text_[at]) && text_[at] != format_.separator)
            ++at;
        if (format_.separator != ' ') return;
        while (at < end && is_blank(text_[at]))
            ++at;
    }

    bool is_comment(std::size_t at, std::size_t end) const {
        const char c = text_[at];
        return c == '#' || c == '!' || c == '%' || c == '>' ||
               (c == '/' && at + 1 < end && text_[at + 1] == '/');
    }

    /// The first fields of the line [at, end); none where it is blank or a comment.
    void split(std::size_t at, std::size_t end) {
        fields_.clear();
        std::size_t first = at;
        while (first < end && is_blank(text_[first]))
            ++first;
        if (first == end || is_comment(first, end)) return;
        bool more = true;
        while (more && fields_.size() < most_) {
            skip_blanks(at, end);
            if (at == end && format_.separator == ' ') return;
            if (at < end && text_[at] == '#') return;
            more = at < end && text_[at] == '"' ? quoted(at, end) : plain(at, end);
        }
    }

    /// A field in quotes; moves `at` behind its separator.
    /// @return whether there may be another
    bool quoted(std::size_t& at, std::size_t end) {
        std::size_t close = at + 1;
        while (close < end && (text_[close] != '"' || (close + 1 < end && text_[close + 1] == '"')))
            close += text_[close] == '"' ? 2 : 1;
        close = std::min(close, end);
        fields_.push_back({at + 1, close, true});
        at = std::min(close + 1, end);
        while (at < end && !is_separator(text_[at]))
            ++at;
        return at < end ? (++at, true) : false;
    }

    bool is_separator(char c) const {
        return format_.separator == ' ' ? is_blank(c) : c == format_.separator;
    }

    bool plain(std::size_t& at, std::size_t end) {
        const std::size_t begin = at;
        bool ends_here = false;
        while (at < end && !is_separator(text_[at])) {
            if (text_[at] == '#' && is_number(trimmed(begin, at))) {
                ends_here = true;
                break;
            }
            ++at;
        }
        fields_.push_back(trimmed(begin, at));
        return !ends_here && at < end ? (++at, true) : false;
    }

    TextField trimmed(std::size_t begin, std::size_t end) const {
        while (end > begin && is_blank(text_[end - 1]))
            --end;
        return {begin, end};
    }

    ParsedNumber number_of(const TextField& field) const {
        std::size_t begin = field.begin, end = field.end;
        if (field.quoted) {
            while (begin < end && is_blank(text_[begin]))
                ++begin;
            while (end > begin && is_blank(text_[end - 1]))
                --end;
        }
        ParsedNumber number = parse_number(text_.substr(begin, end - begin), format_.decimal);
        if (number.length != end - begin) number.spelling = Spelling::kNotANumber;
        return number;
    }

    bool is_number(const TextField& field) const {
        return number_of(field).spelling != Spelling::kNotANumber;
    }

    bool is_one_of(const TextField& field, const Values& values) {
        if (!values.numbers.empty()) {
            const ParsedNumber number = number_of(field);
            if (number.spelling == Spelling::kNumber || number.spelling == Spelling::kNotFinite) {
                for (const double value : values.numbers) {
                    if (value == number.value || (std::isnan(value) && std::isnan(number.value)))
                        return true;
                }
            }
        }
        if (values.texts.empty()) return false;
        std::string_view entry = text_.substr(field.begin, field.end - field.begin);
        if (field.quoted && entry.find("\"\"") != std::string_view::npos) {
            unquoted_.clear();
            for (std::size_t i = 0; i < entry.size(); ++i) {
                unquoted_.push_back(entry[i]);
                if (entry[i] == '"') ++i;
            }
            entry = unquoted_;
        }
        return std::find(values.texts.begin(), values.texts.end(), entry) != values.texts.end();
    }

    /// Adds the present line.
    std::optional<Wrong> row(NumberTable& out) {
        if (fields_.size() < most_) {
            return Wrong{"too_few", {0, static_cast<std::int64_t>(fields_.size())}};
        }
        for (const RowFilter& filter : format_.filters) {
            if (is_one_of(fields_[filter.column], filter.values)) continue;
            ++out.filtered;
            return std::nullopt;
        }
        if (!format_.missing.numbers.empty() || !format_.missing.texts.empty()) {
            for (const std::size_t column : format_.columns) {
                if (!is_one_of(fields_[column], format_.missing)) continue;
                ++out.missing;
                return std::nullopt;
            }
        }
        for (std::size_t i = 0; i < format_.columns.size(); ++i) {
            const TextField& field = fields_[format_.columns[i]];
            const ParsedNumber number = number_of(field);
            if (number.spelling == Spelling::kNumber) {
                out.values.push_back(number.value);
                continue;
            }
            const char* const kind = number.spelling == Spelling::kNotFinite  ? "not_finite"
                                     : number.spelling == Spelling::kTooLarge ? "too_large"
                                                                              : "not_a_number";
            return Wrong{kind,
                         {0, static_cast<std::int64_t>(i), static_cast<std::int64_t>(field.begin),
                          static_cast<std::int64_t>(field.end)}};
        }
        return std::nullopt;
    }
};

[[noreturn]] void refuse(Wrong wrong, std::size_t lines_before) {
    wrong.items[0] += static_cast<std::int64_t>(lines_before);
    const std::string line = "line " + std::to_string(wrong.items[0]);
    throw InputError(wrong.kind, line + " cannot be read: " + wrong.kind, -1,
                     std::move(wrong.items));
}

}  // namespace

NumberTable read_numbers(std::string_view text, const TableFormat& format, int threads) {
    std::vector<std::size_t> begins{0};  // of the parts: lines are kept whole
    while (begins.back() + kBytesAtOnce < text.size()) {
        const std::size_t newline = text.find('\n', begins.back() + kBytesAtOnce);
        if (newline == std::string_view::npos) break;
        begins.push_back(newline + 1);
    }
    begins.push_back(text.size());
    std::vector<NumberTable> tables(begins.size() - 1);
    std::vector<std::optional<Wrong>> wrong(tables.size());
    parallel_chunks(tables.size(), {threads, nullptr}, [&](std::size_t chunk) {
        wrong[chunk] =
            TextLines(text, format).read(begins[chunk], begins[chunk + 1], tables[chunk]);
    });
    NumberTable all;
    std::size_t count = 0;
    for (const NumberTable& table : tables)
        count += table.values.size();
    all.values.reserve(count);
    for (std::size_t chunk = 0; chunk < tables.size(); ++chunk) {
        if (wrong[chunk]) refuse(std::move(*wrong[chunk]), all.lines);
        const NumberTable& table = tables[chunk];
        all.values.insert(all.values.end(), table.values.begin(), table.values.end());
        all.lines += table.lines;
        all.filtered += table.filtered;
        all.missing += table.missing;
    }
    return all;
}

}  // namespace realmodel::input
