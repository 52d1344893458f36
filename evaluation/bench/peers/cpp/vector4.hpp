// SPDX-License-Identifier: MIT OR Apache-2.0
// Three coordinates in the four lanes of one register; the fourth holds whatever lies behind in memory.
#pragma once

#include <cmath>
#include <cstring>

namespace bench {

// Sixteen bytes of floats, thirty-two of doubles.
template <typename T>
struct Lanes;
template <>
struct Lanes<float> {
  typedef float Vector __attribute__((vector_size(16)));
  typedef int Index __attribute__((vector_size(16)));
};
template <>
struct Lanes<double> {
  typedef double Vector __attribute__((vector_size(32)));
  typedef long long Index __attribute__((vector_size(32)));
};
template <typename T>
using Vector4 = typename Lanes<T>::Vector;

template <typename T>
inline Vector4<T> load(const T* xyz) {
  Vector4<T> v;
  std::memcpy(&v, xyz, sizeof v);
  return v;
}

template <typename T>
inline Vector4<T> yzx(Vector4<T> v) {
  return __builtin_shuffle(v, typename Lanes<T>::Index{1, 2, 0, 3});
}

/// The cross product before its last yzx, which sums can share.
template <typename T>
inline Vector4<T> turned_cross(Vector4<T> a, Vector4<T> b) {
  return a * yzx<T>(b) - yzx<T>(a) * b;
}

template <typename V>
inline V lower(V a, V b) {
  return a < b ? a : b;
}

template <typename V>
inline V upper(V a, V b) {
  return a > b ? a : b;
}

template <typename T>
inline T dot(Vector4<T> a, Vector4<T> b) {
  const Vector4<T> c = a * b;
  return c[0] + c[1] + c[2];
}

}  // namespace bench
