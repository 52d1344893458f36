// SPDX-License-Identifier: MIT OR Apache-2.0
/** Messages as bytes: what is written in some order is read in the same. */
#ifndef RAYCONTACT_MPI_BYTES_HPP
#define RAYCONTACT_MPI_BYTES_HPP

#include <cstddef>
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
