// SPDX-License-Identifier: MIT OR Apache-2.0
/** Numbers on a command line, and what is said where one is wrong. */
#ifndef RAYCONTACT_DEMOS_COMMAND_LINE_HPP
#define RAYCONTACT_DEMOS_COMMAND_LINE_HPP

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <stdexcept>
#include <string>

namespace demo {

/** What to say before the usage. */
struct WrongUsage : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/** If argument `i` is one of these, takes the number behind it too; else false. Throws WrongUsage. */
inline bool take_number(const std::map<std::string, double*>& numbers, int argc, char** argv, int& i) {
  const auto number = numbers.find(argv[i]);
  if (number == numbers.end()) return false;
  char* end = nullptr;
  const char* text = ++i < argc ? argv[i] : "";
  *number->second = std::strtod(text, &end);
  if (*text == '\0' || *end != '\0' || !(*number->second >= 0) || !std::isfinite(*number->second))
    throw WrongUsage(number->first + " needs a number, 0 or more");
  return true;
}

/** In a catch block: says what ended a program, after wrong usage the usage too. Returns its exit status: 2 then, else 1. */
inline int report_failure(const char* program, void (*print_usage)(std::FILE*)) {
  try {
    throw;
  } catch (const WrongUsage& error) {
    std::fprintf(stderr, "%s: %s\n\n", program, error.what());
    print_usage(stderr);
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", program, error.what());
    return 1;
  }
}

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_COMMAND_LINE_HPP
