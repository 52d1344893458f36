/* A test is a program: every CHECK that fails prints where and what, and check_result() is the exit status. */
#ifndef CHECK_H
#define CHECK_H

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "raycontact.h"

static int check_failures = 0;

#define CHECK(condition)                                                      \
  do {                                                                        \
    if (!(condition)) {                                                       \
      fprintf(stderr, "%s:%d: failed: %s\n", __FILE__, __LINE__, #condition); \
      ++check_failures;                                                       \
    }                                                                         \
  } while (0)

/* NaN is never near. */
#define CHECK_NEAR(actual, expected, tolerance)                                                                    \
  do {                                                                                                             \
    const double actual_ = (actual), expected_ = (expected);                                                       \
    if (!(fabs(actual_ - expected_) <= (tolerance))) {                                                             \
      fprintf(stderr, "%s:%d: failed: %s is %.17g, not %.17g\n", __FILE__, __LINE__, #actual, actual_, expected_); \
      ++check_failures;                                                                                            \
    }                                                                                                              \
  } while (0)

#define CHECK_OK(call) CHECK_STATUS(call, RAYC_STATUS_OK, NULL)

/* The call returns this status, and its message contains `part` (NULL: any message). */
#define CHECK_STATUS(call, expected, part) \
  check_status((uint32_t)(call), (uint32_t)(expected), part, #call, __FILE__, __LINE__)

static inline void check_status(uint32_t actual, uint32_t expected, const char* part, const char* call,
                                const char* file, int line) {
  const char* message = rayc_last_error_message();
  if (actual != expected) {
    fprintf(stderr, "%s:%d: %s\n  returned %s (\"%s\"), not %s\n", file, line, call, rayc_status_name(actual), message,
            rayc_status_name(expected));
    ++check_failures;
  } else if (actual == RAYC_STATUS_OK ? message[0] != '\0' : strlen(message) < 20) {
    fprintf(stderr, "%s:%d: %s\n  returned %s with the message \"%s\"\n", file, line, call, rayc_status_name(actual),
            message);
    ++check_failures;
  } else if (part != NULL && strstr(message, part) == NULL) {
    fprintf(stderr, "%s:%d: %s\n  the message \"%s\" does not say \"%s\"\n", file, line, call, message, part);
    ++check_failures;
  }
}

static inline int check_result(void) {
  if (check_failures != 0) {
    fprintf(stderr, "%d checks failed\n", check_failures);
  }
  return check_failures == 0 ? 0 : 1;
}

#endif
