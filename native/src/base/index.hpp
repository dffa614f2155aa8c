// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>

#include "realmodel/base/errors.hpp"

namespace realmodel {

/// The number of a thing of some kind, such as a line, by which arrays have it: ids of different
/// kinds are different types. Where a kind is derived from another, its ids are that one's, too.
template <class Kind>
class Id {
public:
    Id() = default;
    template <std::integral Number>
    constexpr explicit Id(Number number) : number_(static_cast<std::int32_t>(number)) {
        assert(std::in_range<std::int32_t>(number));
    }
    template <class Other>
    requires std::is_convertible_v<Other*, Kind*>
    constexpr Id(Id<Other> other) : number_(other.number()) {}

    constexpr std::int32_t number() const { return number_; }
    /// Whether it is of a thing: neither kNone nor another constant below 0.
    constexpr bool has_value() const { return number_ >= 0; }
    constexpr Id& operator++() {
        ++number_;
        return *this;
    }
    friend constexpr auto operator<=>(Id, Id) = default;
    /// The id of the thing so many further on.
    friend constexpr Id operator+(Id id, std::integral auto count) {
        return Id(id.number_ + static_cast<std::int32_t>(count));
    }
    friend constexpr std::int32_t operator-(Id to, Id from) { return to.number_ - from.number_; }

private:
    std::int32_t number_;
};

/// The id of nothing, of any kind.
struct NoId {
    template <class Kind>
    constexpr operator Id<Kind>() const {
        return Id<Kind>(-1);
    }
};
inline constexpr NoId kNone;

/// A number or an id of something, such as a vertex, as an index into an array.
template <std::signed_integral Number>
constexpr std::size_t index(Number number) {
    assert(number >= 0);
    return static_cast<std::size_t>(number);
}
template <class Kind>
constexpr std::size_t index(Id<Kind> id) {
    return index(id.number());
}

/// Two numbers or ids, such as the ends of an edge, the lesser first.
template <class Number>
constexpr std::array<Number, 2> unordered(Number a, Number b) {
    return {std::min(a, b), std::max(a, b)};
}

/// The number of the thing that is added to so many others.
/// @throws InputError kind too_large where it has none of 32 bits
inline std::int32_t checked_number(std::size_t count, const char* things) {
    if (count >= INT32_MAX)
        throw InputError("too_large", std::string("more than 2147 million ") + things +
                                          "; use a smaller part of the model or coarser surfaces");
    return static_cast<std::int32_t>(count);
}

/// Two numbers of at least 0 as one, which sorts as they do, the first one before the second, but
/// faster.
constexpr std::uint64_t packed_pair(std::int32_t first, std::int32_t second) {
    return std::uint64_t{static_cast<std::uint32_t>(first)} << 32 |
           static_cast<std::uint32_t>(second);
}

constexpr std::array<std::int32_t, 2> unpacked_pair(std::uint64_t packed) {
    return {static_cast<std::int32_t>(packed >> 32),
            static_cast<std::int32_t>(packed & UINT32_MAX)};
}

}  // namespace realmodel
