// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <initializer_list>
#include <iterator>
#include <new>
#include <type_traits>
#include <utility>

namespace realmodel {

/// A vector of numbers, or of what is nothing but numbers, that differs from std::vector in two
/// ways where it is large. Elements that resize() adds are not set: the threads that fill them are
/// the first to touch their memory. And it grows by realloc, so the system moves pages of memory
/// rather than bytes, and what is reserved but never filled takes none.
template <class Element>
class GrowingArray {
    static_assert(std::is_trivially_copyable_v<Element> &&
                  std::is_trivially_destructible_v<Element> &&
                  alignof(Element) <= alignof(std::max_align_t));

public:
    using value_type = Element;
    using iterator = Element*;
    using const_iterator = const Element*;

    GrowingArray() = default;
    explicit GrowingArray(std::size_t size) { resize(size); }
    GrowingArray(std::size_t size, const Element& value) { resize(size, value); }
    GrowingArray(std::initializer_list<Element> elements) {
        append(elements.begin(), elements.end());
    }
    GrowingArray(const GrowingArray& other) { append(other.begin(), other.end()); }
    GrowingArray(GrowingArray&& other) noexcept { swap(other); }
    GrowingArray& operator=(const GrowingArray& other) {
        if (this != &other) {
            clear();
            append(other.begin(), other.end());
        }
        return *this;
    }
    GrowingArray& operator=(GrowingArray&& other) noexcept {
        GrowingArray(std::move(other)).swap(*this);
        return *this;
    }
    ~GrowingArray() { std::free(elements_); }

    std::size_t size() const { return size_; }
    std::size_t capacity() const { return capacity_; }
    bool empty() const { return size_ == 0; }
    Element* data() { return elements_; }
    const Element* data() const { return elements_; }
    Element& operator[](std::size_t i) { return elements_[i]; }
    const Element& operator[](std::size_t i) const { return elements_[i]; }
    Element* begin() { return elements_; }
    Element* end() { return elements_ + size_; }
    const Element* begin() const { return elements_; }
    const Element* end() const { return elements_ + size_; }
    Element& front() { return elements_[0]; }
    const Element& front() const { return elements_[0]; }
    Element& back() { return elements_[size_ - 1]; }
    const Element& back() const { return elements_[size_ - 1]; }

    void push_back(const Element& element) {
        if (size_ == capacity_) {
            const Element own = element;  // it may be one of these
            grow(size_ + 1);
            elements_[size_++] = own;
        } else {
            elements_[size_++] = element;
        }
    }
    void pop_back() { --size_; }
    template <class Iterator>
    void append(Iterator first, Iterator last) {
        const auto count = static_cast<std::size_t>(std::distance(first, last));
        if (size_ + count > capacity_) grow(size_ + count);
        std::copy(first, last, elements_ + size_);
        size_ += count;
    }
    /// New elements are not set.
    void resize(std::size_t size) {
        if (size > capacity_) grow(size);
        size_ = size;
    }
    void resize(std::size_t size, const Element& value) {
        const Element own = value;
        const std::size_t before = size_;
        resize(size);
        if (size > before) std::fill(elements_ + before, elements_ + size, own);
    }
    void assign(std::size_t size, const Element& value) {
        const Element own = value;
        clear();
        resize(size, own);
    }
    void reserve(std::size_t capacity) {
        if (capacity > capacity_) move_to(capacity);
    }
    void clear() { size_ = 0; }
    void swap(GrowingArray& other) noexcept {
        std::swap(elements_, other.elements_);
        std::swap(size_, other.size_);
        std::swap(capacity_, other.capacity_);
    }

    friend bool operator==(const GrowingArray& a, const GrowingArray& b) {
        return std::equal(a.begin(), a.end(), b.begin(), b.end());
    }

private:
    void grow(std::size_t least) { move_to(std::max({least, capacity_ * 2, std::size_t{4}})); }
    void move_to(std::size_t capacity) {
        if (capacity > PTRDIFF_MAX / sizeof(Element)) throw std::bad_alloc();
        void* moved = std::realloc(static_cast<void*>(elements_), capacity * sizeof(Element));
        if (moved == nullptr) throw std::bad_alloc();
        elements_ = static_cast<Element*>(moved);
        capacity_ = capacity;
    }

    Element* elements_ = nullptr;
    std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace realmodel
