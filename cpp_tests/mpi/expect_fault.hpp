// What the tests of bad input over ranks share.
#ifndef EXPECT_FAULT_HPP
#define EXPECT_FAULT_HPP

#include <string>

#include "expect.hpp"
#include "raycontact/mpi.hpp"

inline int rank_here = 0, rank_count = 1;

/** The call throws this status on all ranks, with one message, which says `part`. */
template <class Call>
void expect_fault(Call call, rayc_status status, const char* test, const std::string& part) {
  std::string message = "nothing";
  int found = RAYC_STATUS_OK;
  try {
    call();
  } catch (const raycontact::Error& error) {
    found = error.status();
    message = error.what();
  }
  expect(found == status, test, std::string("rank ") + std::to_string(rank_here) + " says " + message);
  expect(message.find(part) != std::string::npos, test, "\"" + message + "\" does not say \"" + part + "\"");
  int statuses[2] = {found, -found};
  MPI_Allreduce(MPI_IN_PLACE, statuses, 2, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  expect(statuses[0] == -statuses[1], test, "all ranks say the same");
}

#endif
