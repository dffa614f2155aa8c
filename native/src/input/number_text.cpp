// SPDX-License-Identifier: GPL-3.0-or-later
#include "input/number_text.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <string>
#include <system_error>

namespace realmodel::input {

namespace {

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

}  // namespace

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

}  // namespace realmodel::input
