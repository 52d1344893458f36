// SPDX-License-Identifier: MIT OR Apache-2.0
/**
 * raycontact over MPI: the contacts of one scene whose bodies are spread over the ranks of a communicator, to the bit.
 *
 * Header-only; link raycontact::mpi in CMake, which brings MPI and Zoltan. Include this one file; the parts below
 * `mpi/` are its chapters. In short, on every rank:
 *
 *     raycontact::DistributedScene scene(MPI_COMM_WORLD);      // after MPI_Init, which stays the host's
 *     scene.add(key, mesh);                                    // for each of this rank's bodies; keys are the host's
 *     scene.set_positions(key, positions);                     // each step
 *     scene.step(seconds);
 *     scene.forces(key);                                       // of this rank's bodies, in N
 *     scene.rebalance(pack, unpack);                           // now and then: bodies change ranks
 *
 * A raycontact::DistributedContactSystem over the scene adds friction, rigid bodies and implicit steps.
 */
#ifndef RAYCONTACT_MPI_HPP
#define RAYCONTACT_MPI_HPP

#include "raycontact.hpp"
#include "raycontact/distributed.h"
#include "raycontact/mpi/distributed_contact_system.hpp"
#include "raycontact/mpi/distributed_scene.hpp"

#endif  // RAYCONTACT_MPI_HPP
