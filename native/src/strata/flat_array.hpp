// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

namespace realmodel::strata {

/// An array of numbers whose size is set once. Its elements are not set when it is made, so that
/// the threads that fill it touch its memory first, and what is never filled takes none.
template <class Element>
class FlatArray {
    static_assert(std::is_trivially_copyable_v<Element> &&
                  std::is_trivially_default_constructible_v<Element>);

public:
    FlatArray() = default;
    explicit FlatArray(std::size_t size)
        : elements_(std::make_unique_for_overwrite<Element[]>(size)), size_(size) {}

    FlatArray(const FlatArray& other) : FlatArray(other.size_) {
        std::copy(other.begin(), other.end(), begin());
    }
    FlatArray(FlatArray&& other) noexcept
        : elements_(std::move(other.elements_)), size_(std::exchange(other.size_, 0)) {}
    FlatArray& operator=(FlatArray other) noexcept {
        std::swap(elements_, other.elements_);
        std::swap(size_, other.size_);
        return *this;
    }

    std::size_t size() const { return size_; }
    Element& operator[](std::size_t i) { return elements_[i]; }
    const Element& operator[](std::size_t i) const { return elements_[i]; }
    Element* begin() { return elements_.get(); }
    Element* end() { return elements_.get() + size_; }
    const Element* begin() const { return elements_.get(); }
    const Element* end() const { return elements_.get() + size_; }

private:
    std::unique_ptr<Element[]> elements_;
    std::size_t size_ = 0;
};

}  // namespace realmodel::strata
