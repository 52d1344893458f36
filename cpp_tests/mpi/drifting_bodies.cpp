// Bodies that drift through one another over several ranks, and change ranks every five steps: every force of every
// step has the bits of a plain scene's. With --drop-memory bodies change ranks without what their pairs remember, and
// the bits must be others. With --kill one rank is killed, and the run must end. With --single the scenes are of single
// precision. With --pairs some pairs are switched off and on, or may not escape, as any rank says; with --silent the
// ranks are not told, and the bits must be others.
#include "drifting_bodies.hpp"

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstring>
#include <map>
#include <string>

#include "raycontact/mpi.hpp"

namespace {

using Host = std::map<uint64_t, Body>;
using Rests = std::map<uint64_t, Torus>;

rayc_scalar precision = RAYC_SCALAR_F64;
constexpr uint32_t body_count = 45;
constexpr int step_count = 45, steps_between_migrations = 5;

std::vector<unsigned char> bytes_of(const Body& body) {
  std::vector<unsigned char> bytes(sizeof body);
  std::memcpy(bytes.data(), &body, sizeof body);
  return bytes;
}

void add(raycontact::DistributedScene& scene, const Body& body, const Torus& rest) {
  scene.add(key_of(body.number), mesh_of(rest, precision), is_folded(body));
}

/** To other ranks as a host would do it that knows nothing of pairs. */
void add_anew(raycontact::DistributedScene& scene, Host& host, const Rests& rests, int step, int rank, int size) {
  std::vector<double> states(7 * body_count);
  for (const auto& [key, body] : host) {
    double* state = &states[7 * body.number];
    state[0] = body.steps;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      state[1 + axis] = body.offset[axis];
      state[4 + axis] = body.velocity[axis];
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, states.data(), static_cast<int>(states.size()), MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  for (const auto& [key, body] : host) scene.remove(key);
  host.clear();
  for (uint32_t number = 0; number < body_count; ++number) {
    if (static_cast<int>((number + static_cast<uint32_t>(step)) % static_cast<uint32_t>(size)) != rank) continue;
    const double* state = &states[7 * number];
    Body body;
    body.number = number;
    body.steps = static_cast<int32_t>(state[0]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      body.offset[axis] = state[1 + axis];
      body.velocity[axis] = state[4 + axis];
    }
    host[key_of(number)] = body;
    add(scene, body, rests.at(key_of(number)));
  }
}

Outcome run_distributed(bool drops_memory, bool kills, bool says, uint64_t* moved) {
  int rank = 0, size = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  raycontact::DistributedOptions options;
  options.response = response();
  options.scene = scene_options(precision);
  raycontact::DistributedScene scene(MPI_COMM_WORLD, options);
  Host host;
  Rests rests;
  for (uint32_t number = 0; number < body_count; ++number) {
    const Body body = first_state(number);
    rests[key_of(number)] = rest_shape(body);
    if (static_cast<int>(number * static_cast<uint32_t>(size) / body_count) != rank) continue;
    host[key_of(number)] = body;
    add(scene, body, rests[key_of(number)]);
  }
  Outcome outcome;
  std::vector<double> positions, velocities;
  const auto pack = [&](uint64_t key) {
    std::vector<unsigned char> bytes = bytes_of(host.at(key));
    host.erase(key);
    ++*moved;
    return bytes;
  };
  const auto unpack = [&](uint64_t key, const std::vector<unsigned char>& bytes) {
    std::memcpy(&host[key], bytes.data(), sizeof(Body));
  };
  for (int step = 0; step < step_count; ++step) {
    if (kills && step == 3) {
      if (rank == size - 1) std::raise(SIGKILL);
      alarm(10);  // the run ends before
    }
    if (step % steps_between_migrations == 0 && step > 0) {
      if (drops_memory) {
        add_anew(scene, host, rests, step, rank, size);
      } else if (step % (2 * steps_between_migrations) == 0) {
        std::vector<int> owners;
        for (uint64_t key : scene.keys())
          owners.push_back(static_cast<int>((key + static_cast<uint64_t>(step)) % static_cast<uint64_t>(size)));
        scene.migrate(owners, pack, unpack);
      } else {
        scene.rebalance(pack, unpack);
      }
    }
    int turn = 0;
    const auto is_my_turn = [&] { return turn++ % size == rank; };
    if (says)
      say(
          step, body_count,
          [&](uint32_t a, uint32_t b, bool is_on) {
            if (is_my_turn()) scene.set_pair_collision(key_of(a), key_of(b), is_on);
          },
          [&](uint32_t a, uint32_t b, bool is_allowed) {
            if (is_my_turn()) scene.allow_escape(key_of(a), key_of(b), is_allowed);
          });
    for (const auto& [key, body] : host) {
      place(body, rests.at(key), positions, velocities);
      scene.set_positions(key, raycontact::vectors(positions));
      scene.set_velocities(key, raycontact::vectors(velocities));
    }
    scene.step(step_length);
    uint64_t hash = 0;
    for (auto& [key, body] : host) {
      const raycontact::Span<const double> forces = scene.forces(key);
      move(body, forces.data(), forces.size());
      hash += digest(body, forces.data(), forces.size());
    }
    MPI_Allreduce(MPI_IN_PLACE, &hash, 1, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
    outcome.add(hash, scene.statistics());
  }
  MPI_Allreduce(MPI_IN_PLACE, moved, 1, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
  uint64_t ghosts = scene.traffic().ghosts;
  MPI_Allreduce(MPI_IN_PLACE, &ghosts, 1, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
  if (rank == 0)
    std::printf("%d ranks: hash=%016llx, %llu bodies moved, %llu ghosts in %d steps\n", size,
                static_cast<unsigned long long>(outcome.hash), static_cast<unsigned long long>(*moved),
                static_cast<unsigned long long>(ghosts), step_count);
  return outcome;
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  const std::string mode = argc > 1 ? argv[1] : "";
  int rank = 0, size = 1, failures = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  uint64_t moved = 0;
  if (mode == "--single") precision = RAYC_SCALAR_F32;
  const Outcome found = run_distributed(mode == "--drop-memory", mode == "--kill", mode == "--pairs", &moved);
  if (rank == 0) {
    const Outcome expected = run_plain(body_count, step_count, precision, mode == "--pairs" || mode == "--silent");
    std::printf(
        "plain:   hash=%016llx, %llu contacts, %llu of escaping pairs' steps, %llu with themselves, %llu crowded\n",
        static_cast<unsigned long long>(expected.hash), static_cast<unsigned long long>(expected.contacts),
        static_cast<unsigned long long>(expected.escapes), static_cast<unsigned long long>(expected.self_contacts),
        static_cast<unsigned long long>(expected.crowded));
    const auto expect = [&failures](bool condition, const char* what) {
      if (!condition) std::fprintf(stderr, "failed: %s\n", what), ++failures;
    };
    expect(expected.escapes > 0 && expected.self_contacts > 0, "the scene has escapes and self-collision");
    if (mode == "--drop-memory" || mode == "--silent") {
      expect(found.hash != expected.hash, "without the memory of pairs, or what is said of them, the bits are others");
    } else {
      expect(found.hash == expected.hash, "the bits of a plain scene");
      expect(size == 1 || moved > body_count, "bodies move");
    }
  }
  MPI_Bcast(&failures, 1, MPI_INT, 0, MPI_COMM_WORLD);
  MPI_Finalize();
  return failures;
}
