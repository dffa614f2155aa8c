// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cassert>
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
/// ways. Elements that are added without a value are not set: the threads that fill them are the
/// first to touch their memory. And it grows as realloc does it, which on Linux copies nothing of
/// large ones.
template <class Element>
class Array {
    static_assert(std::is_trivially_copyable_v<Element> &&
                  std::is_trivially_destructible_v<Element> &&
                  alignof(Element) <= alignof(std::max_align_t));

public:
    using value_type = Element;
    using iterator = Element*;
    using const_iterator = const Element*;

    Array() = default;
    explicit Array(std::size_t size) { resize(size); }
    Array(std::size_t size, const Element& value) : Array(size) {
        std::fill(begin(), end(), value);
    }
    Array(std::initializer_list<Element> elements) { append(elements.begin(), elements.end()); }
    Array(const Array& other) { append(other.begin(), other.end()); }
    Array(Array&& other) noexcept { swap(other); }
    Array& operator=(const Array& other) {
        if (this != &other) {
            clear();
            append(other.begin(), other.end());
        }
        return *this;
    }
    Array& operator=(Array&& other) noexcept {
        Array(std::move(other)).swap(*this);
        return *this;
    }
    ~Array() { std::free(data_); }

    std::size_t size() const { return size_; }
    std::size_t capacity() const { return capacity_; }
    bool empty() const { return size_ == 0; }
    Element* data() { return data_; }
    const Element* data() const { return data_; }
    Element& operator[](std::size_t i) { return data()[i]; }
    const Element& operator[](std::size_t i) const { return data()[i]; }
    Element* begin() { return data(); }
    Element* end() { return data() + size_; }
    const Element* begin() const { return data(); }
    const Element* end() const { return data() + size_; }
    Element& front() { return data()[0]; }
    const Element& front() const { return data()[0]; }
    Element& back() { return data()[size_ - 1]; }
    const Element& back() const { return data()[size_ - 1]; }

    void push_back(const Element& element) {
        if (size_ < capacity_) {
            data_[size_++] = element;
        } else {
            const Element copy = element;  // it may be one of these
            make_ready(size_ + 1);
            data_[size_++] = copy;
        }
    }
    void pop_back() {
        assert(size_ > 0);
        --size_;
    }
    /// @param first, last  not of this array
    template <class Iterator>
    void append(Iterator first, Iterator last) {
        const auto count = static_cast<std::size_t>(std::distance(first, last));
        make_ready(size_ + count);
        std::copy(first, last, end());
        size_ += count;
    }
    /// New elements are not set.
    void resize(std::size_t size) {
        make_ready(size);
        size_ = size;
    }
    void resize(std::size_t size, const Element& value) {
        const Element copy = value;
        const std::size_t before = size_;
        resize(size);
        if (size > before) std::fill(begin() + before, end(), copy);
    }
    void assign(std::size_t size, const Element& value) {
        const Element copy = value;
        clear();
        resize(size, copy);
    }
    /// Elements stay where they are while there are no more than `capacity`.
    void reserve(std::size_t capacity) {
        if (capacity > capacity_) change_capacity(std::max<std::size_t>(capacity, 4));
    }
    /// Makes memory ready for elements that are set before resize() counts them.
    void make_ready(std::size_t size) {
        if (size > capacity_)
            change_capacity(std::max({size, 2 * capacity_, 64 / sizeof(Element)}));
    }
    void clear() { size_ = 0; }
    void swap(Array& other) noexcept {
        std::swap(data_, other.data_);
        std::swap(capacity_, other.capacity_);
        std::swap(size_, other.size_);
    }

    friend bool operator==(const Array& a, const Array& b) {
        return std::equal(a.begin(), a.end(), b.begin(), b.end());
    }

private:
    void change_capacity(std::size_t capacity) {
        if (capacity > PTRDIFF_MAX / 4 / sizeof(Element)) throw std::bad_alloc();
        void* const data = std::realloc(data_, capacity * sizeof(Element));
        if (data == nullptr) throw std::bad_alloc();
        data_ = static_cast<Element*>(data);
        capacity_ = capacity;
    }

    Element* data_ = nullptr;
    std::size_t capacity_ = 0;
    std::size_t size_ = 0;
};

}  // namespace realmodel
