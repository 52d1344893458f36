// SPDX-License-Identifier: MIT OR Apache-2.0
// Threads that stay awake between the phases of a step, since waking one costs more than many a step.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace bench {

class Workers {
 public:
  explicit Workers(unsigned count) {
    for (unsigned worker = 1; worker < count; ++worker) threads_.emplace_back([this, worker] { serve(worker); });
  }

  ~Workers() {
    stop_ = true;
    run([](unsigned) {});
    for (auto& thread : threads_) thread.join();
  }

  size_t count() const { return threads_.size() + 1; }

  /// Calls `work(index, worker)` for each index below `count`, in any order, and returns when all are done.
  template <typename Work>
  void for_each(size_t count, Work&& work) {
    if (threads_.empty()) {
      for (size_t index = 0; index < count; ++index) work(index, 0u);
      return;
    }
    std::atomic<size_t> next{0};
    run([&](unsigned worker) {
      for (size_t index = next++; index < count; index = next++) work(index, worker);
    });
  }

 private:
  void run(const std::function<void(unsigned)>& job) {
    job_ = &job;
    running_ = unsigned(threads_.size());
    {
      std::lock_guard<std::mutex> lock(mutex_);
      ++ticket_;
    }
    if (sleepers_ > 0) wake_.notify_all();
    job(0);
    for (unsigned spins = 1; running_ > 0; ++spins) wait(spins);
  }

  void serve(unsigned worker) {
    for (uint64_t seen = 0;;) {
      await(seen);
      seen = ticket_;
      (*job_)(worker);
      // Read before the count falls: the next job may be the last.
      const bool last = stop_;
      --running_;
      if (last) return;
    }
  }

  // Spins for a while, then sleeps: the other core belongs to others between steps.
  void await(uint64_t seen) {
    const auto start = std::chrono::steady_clock::now();
    for (unsigned spins = 1; ticket_ == seen; ++spins) {
      wait(spins);
      if (spins % 1024 == 0 && std::chrono::steady_clock::now() - start > std::chrono::milliseconds(2)) {
        std::unique_lock<std::mutex> lock(mutex_);
        ++sleepers_;
        wake_.wait(lock, [&] { return ticket_ != seen; });
        --sleepers_;
      }
    }
  }

  // Now and then lets others run, lest a thread waits for one that has no core.
  static void wait(unsigned spins) {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
    if (spins % 256 == 0) std::this_thread::yield();
  }

  std::vector<std::thread> threads_;
  std::mutex mutex_;
  std::condition_variable wake_;
  const std::function<void(unsigned)>* job_ = nullptr;
  std::atomic<uint64_t> ticket_{0};
  std::atomic<unsigned> running_{0}, sleepers_{0};
  std::atomic<bool> stop_{false};
};

}  // namespace bench
