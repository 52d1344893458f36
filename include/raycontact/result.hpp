// SPDX-License-Identifier: MIT OR Apache-2.0
/**
 * @file
 * How raycontact.hpp reports errors: as exceptions, or as results for builds without them.
 *
 * Define RAYCONTACT_NO_EXCEPTIONS before the first include to have every function that can fail return a
 * raycontact::Result instead of throwing a raycontact::Error. It defines itself where the compiler has exceptions
 * switched off. Files of one program may differ.
 */
#ifndef RAYCONTACT_RESULT_HPP
#define RAYCONTACT_RESULT_HPP

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "../raycontact.h"

#if !defined(RAYCONTACT_NO_EXCEPTIONS) && !defined(__cpp_exceptions) && !defined(_CPPUNWIND)
#define RAYCONTACT_NO_EXCEPTIONS
#endif

namespace raycontact {

// Two kinds of the same classes in one program need two names for the linker.
#ifdef RAYCONTACT_NO_EXCEPTIONS
inline namespace with_results {
#else
inline namespace with_exceptions {
#endif

/** What a call of the library refused: its status number, and its message, which says what was wrong and what to do. */
class Error : public std::runtime_error {
 public:
  /** @param status other than RAYC_STATUS_OK  @param message for a person */
  Error(rayc_status status, const std::string& message) : std::runtime_error(message), status_(status) {}
  /** The number to decide by. */
  rayc_status status() const noexcept { return status_; }

 private:
  rayc_status status_;
};

/** A value, or the Error that stands in its place: what functions return with RAYCONTACT_NO_EXCEPTIONS. */
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : held_(std::in_place_index<0>, std::move(value)) {}      ///< Success.
  Result(Error error) : held_(std::in_place_index<1>, std::move(error)) {}  ///< Failure.
  /** Whether there is a value. */
  explicit operator bool() const noexcept { return held_.index() == 0; }
  /** The value; ends the program where there is none. */
  T& value() & { return std::get<0>(held_); }
  const T& value() const& { return std::get<0>(held_); }    ///< @copydoc value()
  T&& value() && { return std::get<0>(std::move(held_)); }  ///< @copydoc value()
  /** The error; ends the program where there is none. */
  const Error& error() const { return std::get<1>(held_); }

 private:
  std::variant<T, Error> held_;
};

/** Success, or an Error. */
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;                                                       ///< Success.
  Result(Error error) : held_(std::in_place_index<1>, std::move(error)) {}  ///< Failure.
  /** Whether all went well. */
  explicit operator bool() const noexcept { return held_.index() == 0; }
  /** The error; ends the program where there is none. */
  const Error& error() const { return std::get<1>(held_); }

 private:
  std::variant<std::monostate, Error> held_;
};

/** What a function that can fail returns: T itself, after an exception if need be, or Result<T>. */
#ifdef RAYCONTACT_NO_EXCEPTIONS
template <class T>
using Outcome = Result<T>;
#else
template <class T>
using Outcome = T;
#endif

/// @cond internal
namespace detail {

/** The error of this thread's last call. */
inline Error last_error(rayc_status status) {
  if (status == RAYC_STATUS_OTHER_ABI) {
    return Error(status, "RAYC_STATUS_OTHER_ABI: the headers are of ABI " + std::to_string(RAYC_ABI_VERSION) +
                             ", the library is of ABI " + std::to_string(rayc_abi_version()) +
                             "; build with the headers of the library that is linked");
  }
  const char* message = rayc_last_error_message();
  std::string text = rayc_status_name(static_cast<uint32_t>(status));
  if (message != nullptr && *message != '\0') text += std::string(": ") + message;
  return Error(status, text);
}

template <class T>
Outcome<T> failure(const Error& error) {
#ifdef RAYCONTACT_NO_EXCEPTIONS
  return error;
#else
  throw error;
#endif
}

/** `value` where the call went well. */
template <class T>
Outcome<T> outcome(rayc_status status, T value) {
  if (status != RAYC_STATUS_OK) return failure<T>(last_error(status));
  return value;
}

inline Outcome<void> outcome(rayc_status status) {
  if (status != RAYC_STATUS_OK) return failure<void>(last_error(status));
  return Outcome<void>();
}

/** Asked before anything is made: nothing else may be asked of a library of another ABI. */
inline rayc_status check_abi() {
  return rayc_abi_version() == RAYC_ABI_VERSION ? RAYC_STATUS_OK : RAYC_STATUS_OTHER_ABI;
}

}  // namespace detail
/// @endcond

/** Turns the status of a call of raycontact.h into an exception or a result. On the thread that made the call. */
inline Outcome<void> check(rayc_status status) { return detail::outcome(status); }

}  // inline namespace
}  // namespace raycontact

#endif  // RAYCONTACT_RESULT_HPP
