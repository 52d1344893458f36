// What the C++ tests share: a condition that fails is printed and counted.
#ifndef EXPECT_HPP
#define EXPECT_HPP

#include <cmath>
#include <cstdio>
#include <exception>
#include <string>

inline int failures = 0;

inline void expect(bool condition, const char* test, const std::string& what) {
  if (condition) return;
  std::fprintf(stderr, "%s: failed: %s\n", test, what.c_str());
  ++failures;
}

// NaN is never near.
inline void expect_near(double actual, double expected, double tolerance, const char* test, const std::string& what) {
  expect(std::fabs(actual - expected) <= tolerance, test,
         what + " is " + std::to_string(actual) + ", not " + std::to_string(expected));
}

// The call throws, and its message contains `part`.
template <class Function>
void expect_refusal(Function function, const char* test, const std::string& part) {
  try {
    function();
  } catch (const std::exception& error) {
    expect(std::string(error.what()).find(part) != std::string::npos, test,
           "the message \"" + std::string(error.what()) + "\" does not say \"" + part + "\"");
    return;
  }
  expect(false, test, "nothing was refused where \"" + part + "\" should have been");
}

#endif
