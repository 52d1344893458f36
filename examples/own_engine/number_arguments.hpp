// SPDX-License-Identifier: MIT OR Apache-2.0
/** Numbers on a command line. */
#ifndef RAYCONTACT_DEMOS_NUMBER_ARGUMENTS_HPP
#define RAYCONTACT_DEMOS_NUMBER_ARGUMENTS_HPP

#include <cmath>
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

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_NUMBER_ARGUMENTS_HPP
