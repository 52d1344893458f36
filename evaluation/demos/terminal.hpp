// SPDX-License-Identifier: MIT OR Apache-2.0
/** A progress bar on a terminal, nothing elsewhere; colour unless NO_COLOR is set. */
#ifndef RAYCONTACT_DEMOS_TERMINAL_HPP
#define RAYCONTACT_DEMOS_TERMINAL_HPP

#include <unistd.h>

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace demo {

class ProgressBar {
 public:
  ProgressBar() : shown_(isatty(STDERR_FILENO) == 1) {
    const char* no_color = std::getenv("NO_COLOR");
    colour_ = shown_ && (no_color == nullptr || *no_color == '\0');
  }

  ~ProgressBar() {
    if (shown_) std::fputs("\r\033[K", stderr);
  }

  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(double done, const std::string& note) const {
    if (!shown_) return;
    constexpr std::size_t width = 30;
    const std::size_t filled = static_cast<std::size_t>(width * (done < 0 ? 0 : done > 1 ? 1 : done));
    const std::string bar = std::string(filled, '#') + std::string(width - filled, '.');
    std::fprintf(stderr, "\r\033[K%s[%s]%s %s", colour_ ? "\033[36m" : "", bar.c_str(), colour_ ? "\033[0m" : "",
                 note.c_str());
    std::fflush(stderr);
  }

 private:
  bool shown_, colour_ = false;
};

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_TERMINAL_HPP
