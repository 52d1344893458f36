// SPDX-License-Identifier: MIT OR Apache-2.0
/** Messages as bytes: what is written in some order is read in the same. */
#ifndef RAYCONTACT_MPI_BYTES_HPP
#define RAYCONTACT_MPI_BYTES_HPP

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

namespace raycontact::mpi_detail {

using Bytes = std::vector<unsigned char>;

template <class Value>
void write(Bytes& bytes, const Value* values, std::size_t count) {
  static_assert(std::is_trivially_copyable<Value>::value, "values are sent as they lie in memory");
  const auto* first = reinterpret_cast<const unsigned char*>(values);
  bytes.insert(bytes.end(), first, first + count * sizeof(Value));
}

template <class Value>
void write(Bytes& bytes, const Value& value) {
  write(bytes, &value, 1);
}

/** A whole number, in fewer bytes the smaller it is: seven bits in each, the eighth says that more follow. */
inline void write_whole(Bytes& bytes, uint64_t number) {
  for (; number >= 0x80; number >>= 7) bytes.push_back(static_cast<unsigned char>(number | 0x80));
  bytes.push_back(static_cast<unsigned char>(number));
}

/** Numbers of a scene, in single precision where it has that: they are none but floats then. */
inline void write_numbers(Bytes& bytes, const double* numbers, std::size_t count, bool is_single) {
  if (!is_single) return write(bytes, numbers, count);
  for (std::size_t i = 0; i < count; ++i) write(bytes, static_cast<float>(numbers[i]));
}

class Reader {
 public:
  explicit Reader(const Bytes& bytes) : at_(bytes.data()), end_(bytes.data() + bytes.size()) {}
  bool is_at_end() const { return at_ == end_; }

  template <class Value>
  void read(Value* values, std::size_t count) {
    if (count != 0) std::memcpy(values, at_, count * sizeof(Value));
    at_ += count * sizeof(Value);
  }

  template <class Value>
  Value read() {
    Value value;
    read(&value, 1);
    return value;
  }

  uint64_t read_whole() {
    uint64_t number = 0;
    for (int shift = 0;; shift += 7) {
      const auto byte = read<unsigned char>();
      number |= uint64_t{byte & 0x7fu} << shift;
      if (byte < 0x80) return number;
    }
  }

  void read_numbers(double* numbers, std::size_t count, bool is_single) {
    if (!is_single) return read(numbers, count);
    for (std::size_t i = 0; i < count; ++i) numbers[i] = read<float>();
  }

  template <class Value>
  std::vector<Value> read_all(std::size_t count) {
    std::vector<Value> values(count);
    read(values.data(), count);
    return values;
  }

 private:
  const unsigned char *at_, *end_;
};

}  // namespace raycontact::mpi_detail

#endif  // RAYCONTACT_MPI_BYTES_HPP
