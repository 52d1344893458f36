// SPDX-License-Identifier: MIT OR Apache-2.0
/**
 * @file
 * The caller's arrays, as they are: nothing here copies or owns.
 */
#ifndef RAYCONTACT_SPAN_HPP
#define RAYCONTACT_SPAN_HPP

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "../raycontact.h"

namespace raycontact {

/** A row of values in the caller's memory, as std::span of C++20. */
template <class T>
class Span {
 public:
  Span() = default;                                              ///< No values.
  Span(T* data, std::size_t size) : data_(data), size_(size) {}  ///< So many from here on.
  template <std::size_t N>
  Span(T (&values)[N]) : data_(values), size_(N) {}  ///< An array.
  /** Anything with data() and size(): std::vector, std::array, QVector, Eigen's vectors. */
  template <class Container,
            class = std::enable_if_t<std::is_convertible<decltype(std::declval<Container&>().data()), T*>::value>>
  Span(Container&& values) : data_(values.data()), size_(static_cast<std::size_t>(values.size())) {}

  T* data() const noexcept { return data_; }                 ///< The first.
  std::size_t size() const noexcept { return size_; }        ///< How many.
  T& operator[](std::size_t at) const { return data_[at]; }  ///< Unchecked.
  T* begin() const noexcept { return data_; }                ///< For loops.
  T* end() const noexcept { return data_ + size_; }          ///< For loops.

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

/// @cond internal
namespace detail {

template <class Scalar>
constexpr uint32_t scalar_code() {
  static_assert(std::is_same<Scalar, float>::value || std::is_same<Scalar, double>::value,
                "raycontact reads arrays of float or of double");
  return static_cast<uint32_t>(std::is_same<Scalar, float>::value ? RAYC_SCALAR_F32 : RAYC_SCALAR_F64);
}

template <class View, class Scalar, class Pointer>
View view(Pointer data, std::size_t count, std::size_t stride) {
  View view{};
  view.data = data;
  view.count = count;
  view.stride = stride;
  view.scalar = scalar_code<Scalar>();
  return view;
}

/** Numbers in threes, or vectors that have operator[]. */
template <class View, class Container>
View view_of(Container& values) {
  using Element = std::remove_cv_t<std::remove_reference_t<decltype(*values.data())>>;
  const std::size_t size = static_cast<std::size_t>(values.size());
  if constexpr (std::is_arithmetic<Element>::value) {
    // How many numbers are left over, 1 or 2, is a stride that every call refuses, and by which its message knows.
    return view<View, Element>(values.data(), size / 3, size % 3);
  } else {
    using Scalar = std::remove_cv_t<std::remove_reference_t<decltype((*values.data())[0])>>;
    static_assert(sizeof(Element) >= 3 * sizeof(Scalar), "the elements are vectors of three numbers or more");
    const auto first = size == 0 ? nullptr : &(*values.data())[0];
    return view<View, Scalar>(first, size, sizeof(Element));
  }
}

}  // namespace detail
/// @endcond

/** `count` 3-vectors of float or double; `stride` in bytes, 0 = packed. The memory stays the caller's. */
template <class Scalar>
rayc_vectors vectors(const Scalar* data, std::size_t count, std::size_t stride = 0) {
  return detail::view<rayc_vectors, Scalar>(data, count, stride);
}

/** As vectors(), for memory the library writes to. */
template <class Scalar>
rayc_vectors_mut vectors_mut(Scalar* data, std::size_t count, std::size_t stride = 0) {
  return detail::view<rayc_vectors_mut, Scalar>(data, count, stride);
}

/**
 * A container with data() and size(): of numbers, three for each vector, or of vectors whose numbers operator[] gives
 * (std::array, Eigen::Vector3d, btVector3, SOFA's Vec3). The memory stays the container's. Numbers that are not a
 * multiple of three give a view that every call refuses with RAYC_STATUS_INVALID_STRIDE.
 */
template <class Container>
rayc_vectors vectors(const Container& values) {
  return detail::view_of<rayc_vectors>(values);
}

/** As vectors(), for memory the library writes to. */
template <class Container>
rayc_vectors_mut vectors_mut(Container& values) {
  return detail::view_of<rayc_vectors_mut>(values);
}

}  // namespace raycontact

#endif  // RAYCONTACT_SPAN_HPP
