// SPDX-License-Identifier: MIT OR Apache-2.0
/** The host's communicator, duplicated: messages, and faults on which all ranks agree. */
#ifndef RAYCONTACT_MPI_COMMUNICATOR_HPP
#define RAYCONTACT_MPI_COMMUNICATOR_HPP

#include <mpi.h>

#include <climits>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "raycontact/mpi/bytes.hpp"
#include "raycontact/result.hpp"

namespace raycontact::mpi_detail {

/** What went wrong on a rank: the first of it counts. */
struct Fault {
  int status = RAYC_STATUS_OK;
  std::string message;

  explicit operator bool() const { return status != RAYC_STATUS_OK; }

  void note(rayc_status code, const std::string& text) {
    if (status != RAYC_STATUS_OK || code == RAYC_STATUS_OK) return;
    status = code;
    message = std::string(rayc_status_name(static_cast<uint32_t>(code))) + ": " + text;
  }

  /** Takes over what another has noted. */
  void take(Fault& other) {
    const Fault taken = std::exchange(other, Fault());
    if (status == RAYC_STATUS_OK) *this = taken;
  }

  /** Notes what a call of raycontact.h said, if anything; gives whether all went well. */
  bool check(rayc_status code, const std::string& what) {
    if (code != RAYC_STATUS_OK) note(code, what + ": " + rayc_last_error_message());
    return code == RAYC_STATUS_OK;
  }
};

enum Tag { TAG_HEADERS = 1, TAG_GHOSTS, TAG_FORCES, TAG_OWNERS, TAG_MIGRATION, TAG_KEYS, TAG_PARTS, TAG_SETTINGS };

class Communicator {
 public:
  /** Whether there is a group of ranks to work with; only then may one be made. */
  static Fault refusal(MPI_Comm host) {
    Fault fault;
    int has_begun = 0, has_ended = 0, joins_two = 0;
    MPI_Initialized(&has_begun);
    MPI_Finalized(&has_ended);
    if (has_begun == 0 || has_ended != 0) {
      fault.note(RAYC_STATUS_INVALID_COMMUNICATOR,
                 "MPI has not begun or has ended; call between MPI_Init and MPI_Finalize");
      return fault;
    }
    if (host == MPI_COMM_NULL) {
      fault.note(RAYC_STATUS_INVALID_COMMUNICATOR, "the communicator is MPI_COMM_NULL; pass one that this rank is in");
      return fault;
    }
    MPI_Comm_test_inter(host, &joins_two);
    if (joins_two != 0)
      fault.note(RAYC_STATUS_INVALID_COMMUNICATOR, "the communicator joins two groups; pass one of a single group");
    return fault;
  }

  explicit Communicator(MPI_Comm host) {
    MPI_Comm_dup(host, &comm_);
    MPI_Comm_rank(comm_, &rank_);
    MPI_Comm_size(comm_, &size_);
  }

  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;

  ~Communicator() {
    int has_ended = 0;
    MPI_Finalized(&has_ended);
    if (has_ended == 0) MPI_Comm_free(&comm_);
  }

  MPI_Comm get() const { return comm_; }
  int rank() const { return rank_; }
  int size() const { return size_; }

  /** The fault of the first rank that has one, the same on all ranks. */
  Fault agree(const Fault& own) const {
    int first = own ? rank_ : size_;
    MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, comm_);
    return first == size_ ? Fault() : tell(first, own);
  }

  /** What `teller` has to say, on all ranks. */
  Fault tell(int teller, const Fault& own) const {
    Fault told = own;
    if (rank_ == teller && size_ > 1) told.message = "rank " + std::to_string(rank_) + ": " + told.message;
    int numbers[2] = {told.status, static_cast<int>(told.message.size())};
    MPI_Bcast(numbers, 2, MPI_INT, teller, comm_);
    told.status = numbers[0];
    told.message.resize(static_cast<std::size_t>(numbers[1]));
    MPI_Bcast(&told.message[0], numbers[1], MPI_CHAR, teller, comm_);
    return told;
  }

  /** A message to each of some ranks, which expect them, and one from each of some others, in their order. */
  std::vector<Bytes> swap(const std::vector<int>& to, const std::vector<Bytes>& messages, const std::vector<int>& from,
                          int tag, Fault& fault) const {
    std::vector<MPI_Request> sent(to.size());
    for (std::size_t i = 0; i < to.size(); ++i)
      MPI_Isend(messages[i].data(), length(messages[i], fault), MPI_BYTE, to[i], tag, comm_, &sent[i]);
    std::vector<Bytes> received(from.size());
    for (std::size_t i = 0; i < from.size(); ++i) {
      MPI_Message message;
      MPI_Status status;
      int count = 0;
      MPI_Mprobe(from[i], tag, comm_, &message, &status);
      MPI_Get_count(&status, MPI_BYTE, &count);
      received[i].resize(static_cast<std::size_t>(count));
      MPI_Mrecv(received[i].data(), count, MPI_BYTE, &message, MPI_STATUS_IGNORE);
    }
    MPI_Waitall(static_cast<int>(sent.size()), sent.data(), MPI_STATUSES_IGNORE);
    return received;
  }

  /** A message to each rank, which does not know of it; gives one from each. Empty ones cost four bytes. */
  std::vector<Bytes> swap_all(const std::vector<Bytes>& messages, int tag, Fault& fault) const {
    std::vector<int> lengths, expected(messages.size()), to, from;
    for (const Bytes& message : messages) lengths.push_back(length(message, fault));
    MPI_Alltoall(lengths.data(), 1, MPI_INT, expected.data(), 1, MPI_INT, comm_);
    std::vector<Bytes> sent, received(messages.size());
    for (int rank = 0; rank < size_; ++rank) {
      const auto at = static_cast<std::size_t>(rank);
      if (lengths[at] > 0) {
        to.push_back(rank);
        sent.push_back(messages[at]);
      }
      if (expected[at] > 0) from.push_back(rank);
    }
    std::vector<Bytes> some = swap(to, sent, from, tag, fault);
    for (std::size_t i = 0; i < from.size(); ++i) received[static_cast<std::size_t>(from[i])] = std::move(some[i]);
    return received;
  }

 private:
  /** As MPI counts; what is too long is left out, and noted. */
  static int length(const Bytes& message, Fault& fault) {
    if (message.size() <= INT_MAX) return static_cast<int>(message.size());
    fault.note(RAYC_STATUS_MPI_FAILED, "a message of " + std::to_string(message.size()) +
                                           " bytes is longer than MPI counts; spread the bodies over more ranks");
    return 0;
  }

  MPI_Comm comm_ = MPI_COMM_NULL;
  int rank_ = 0, size_ = 1;
};

}  // namespace raycontact::mpi_detail

#endif  // RAYCONTACT_MPI_COMMUNICATOR_HPP
