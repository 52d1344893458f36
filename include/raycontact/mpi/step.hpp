// SPDX-License-Identifier: MIT OR Apache-2.0
/** One step: boxes, headers, positions of ghosts, the query, and forces back. */
#ifndef RAYCONTACT_MPI_STEP_HPP
#define RAYCONTACT_MPI_STEP_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "raycontact/mpi/bodies.hpp"
#include "raycontact/mpi/keys.hpp"
#include "raycontact/mpi/pair_forces.hpp"
#include "raycontact/mpi/traffic.hpp"

namespace raycontact {

namespace mpi_detail {

/** A body as its neighbours first hear of it. */
struct Header {
  uint64_t key;
  Box box;
};
static_assert(sizeof(Header) == 56, "headers have no padding");

class Step {
 public:
  Step(const Communicator& comm, Bodies& bodies, const rayc_response_options& response, bool is_single,
       Traffic& traffic)
      : comm_(comm),
        bodies_(bodies),
        response_(response),
        is_single_(is_single),
        traffic_(traffic),
        forces_(comm, bodies, response, is_single, traffic) {}

  const Keys& lent() const { return lent_; }
  const Keys& borrowed() const { return borrowed_; }

  /** What all pairs of this rank remember, by keys; behind what `memories` holds. */
  void copy_memories(std::vector<KeyedMemory>& memories, Fault& fault) const {
    std::size_t count = 0;
    fault.check(rayc_scene_pair_memory_count(bodies_.scene.get(), &count), "memories of pairs");
    std::vector<rayc_pair_memory> copied(count);
    fault.check(rayc_scene_copy_pair_memories(bodies_.scene.get(), 0, count, sizeof(rayc_pair_memory), copied.data()),
                "memories of pairs");
    for (const rayc_pair_memory& memory : copied)
      memories.push_back(KeyedMemory{bodies_.named.at(memory.first).key, bodies_.named.at(memory.second).key, memory});
  }

  /** All ranks do: the next step makes them anew. */
  void drop_ghosts() {
    while (!bodies_.ghosts.empty()) bodies_.remove_ghost(bodies_.ghosts.begin());
    forget();
  }

  /** Forgets who has which ghosts. */
  void forget() {
    lent_.clear();
    borrowed_.clear();
  }

  /** Gives the fault on which all ranks agree, if there is one; then no contacts have been looked for. */
  Fault run(double seconds, std::vector<KeyedMemory>& waiting) {
    const double start = MPI_Wtime();
    if (Fault fault = meet(seconds, waiting)) return fault;
    Fault fault;
    const double before = MPI_Wtime();
    const std::clock_t processor = std::clock();
    fault.check(rayc_scene_query(bodies_.scene.get(), bodies_.contacts.get()), "query");
    const double after = MPI_Wtime();
    forces_.sum(fault);
    count_query(std::clock() - processor);
    traffic_.query_seconds += after - before;
    traffic_.sum_seconds += MPI_Wtime() - after;
    forces_.send_back(lent_, borrowed_, fault);
    fault = comm_.agree(fault);
    if (!fault) forces_.add();
    traffic_.total_seconds += MPI_Wtime() - start;
    return fault;
  }

  /** What a query took, in the processor's time, which waiting for others is no part of. */
  void count_query(std::clock_t time) {
    const double seconds = static_cast<double>(time) / CLOCKS_PER_SEC;
    traffic_.processor_seconds += seconds;
    seconds_ += seconds;
  }

  /** Collective: seconds for each unit of bodies' cost since the last call; of all ranks, where this one had none. */
  double seconds_per_cost(double last_cost) {
    const double own[] = {std::exchange(seconds_, 0), std::exchange(cost_, 0) + last_cost};
    double all[2];
    MPI_Allreduce(own, all, 2, MPI_DOUBLE, MPI_SUM, comm_.get());
    if (own[0] > 0 && own[1] > 0) return own[0] / own[1];
    return all[0] > 0 && all[1] > 0 ? all[0] / all[1] : 1;
  }

  /** All of a step before its query: this rank then has the ghosts whose contacts it is to find. */
  Fault meet(double seconds, std::vector<KeyedMemory>& waiting) {
    if (Fault fault = find_neighbours(seconds)) return fault;
    if (any_new_)
      if (Fault fault = check_keys(comm_, bodies_, TAG_KEYS)) return fault;
    if (any_settings_) {
      if (Fault fault = bodies_.settings.tell(comm_, bodies_.own)) return fault;
      const auto is_gone = [this](const KeyedMemory& keyed) {
        return bodies_.settings.is_newly_bound(keyed.first, keyed.second);
      };
      waiting.erase(std::remove_if(waiting.begin(), waiting.end(), is_gone), waiting.end());
    }
    find_pairs(swap_headers());
    Fault fault;
    fault.check(rayc_scene_find_self_contacts(bodies_.scene.get()), "contacts of bodies with themselves");
    swap_bodies(fault);
    bodies_.apply_settings();
    fault.take(bodies_.fault);
    for (const KeyedMemory& keyed : waiting) put_back(keyed, fault);
    fault = comm_.agree(fault);
    tells_all_ = bool(fault);
    if (!fault) waiting.clear();
    return fault;
  }

  /** The same within a step, where bodies are elsewhere now: ghosts that are needed now too join the others. */
  Fault meet_again(double seconds) {
    const Keys lent = lent_, borrowed = borrowed_;
    if (Fault fault = find_neighbours(seconds)) return fault;
    find_pairs(swap_headers());
    for (const auto& [rank, keys] : lent) lent_[rank].insert(keys.begin(), keys.end());
    for (const auto& [rank, keys] : borrowed) borrowed_[rank].insert(keys.begin(), keys.end());
    Fault fault;
    fault.check(rayc_scene_find_self_contacts(bodies_.scene.get()), "contacts of bodies with themselves");
    swap_bodies(fault);
    bodies_.apply_settings();
    fault.take(bodies_.fault);
    return comm_.agree(fault);
  }

 private:
  /** What each rank tells all others: its fault, whether it has new bodies (1) or something has been said of pairs (2),
   * the step, what the attachment must have in common, and the box around its bodies. */
  struct Greeting {
    int32_t status, news;
    double seconds;
    uint64_t attachment;
    Box box;
  };

  Fault find_neighbours(double seconds) {
    Greeting own{};
    own.seconds = seconds;
    own.attachment = bodies_.attachment != nullptr ? bodies_.attachment->checksum() : 0;
    Fault fault = std::exchange(bodies_.fault, Fault());
    for (auto& [key, body] : bodies_.own) {
      rayc_body_state state{};
      fault.check(rayc_scene_body_state(bodies_.scene.get(), body.number, sizeof state, &state), "box of a body");
      std::copy_n(state.lower, 3, body.box.lower);
      std::copy_n(state.upper, 3, body.box.upper);
      cost_ += state.cost;
      own.box.include(body.box);
    }
    own.status = fault.status;
    own.news = (bodies_.has_new ? 1 : 0) | (bodies_.settings.has_news() ? 2 : 0);
    greetings_.resize(static_cast<std::size_t>(comm_.size()));
    MPI_Allgather(&own, sizeof own, MPI_BYTE, greetings_.data(), sizeof own, MPI_BYTE, comm_.get());
    neighbours_.clear();
    any_new_ = any_settings_ = false;
    for (int rank = 0; rank < comm_.size(); ++rank) {
      const Greeting& greeting = greetings_[static_cast<std::size_t>(rank)];
      if (greeting.status != RAYC_STATUS_OK) return comm_.tell(rank, fault);
      any_new_ = any_new_ || (greeting.news & 1) != 0;
      any_settings_ = any_settings_ || (greeting.news & 2) != 0;
      if (rank != comm_.rank() && greeting.box.overlaps(own.box)) neighbours_.push_back(rank);
    }
    // All ranks see the same numbers here, and need not agree.
    for (const Greeting& greeting : greetings_)
      if (greeting.attachment != greetings_[0].attachment)
        fault.note(RAYC_STATUS_RANKS_DISAGREE,
                   "half-spaces of the contact system differ from rank to rank; add the same on all, in one order");
    for (const Greeting& greeting : greetings_)
      if (greeting.seconds != greetings_[0].seconds)
        fault.note(RAYC_STATUS_RANKS_DISAGREE, "the step is " + std::to_string(greetings_[0].seconds) +
                                                   " s long on rank 0 and " + std::to_string(greeting.seconds) +
                                                   " s on another; give all ranks the same");
    return fault;
  }

  std::vector<std::vector<Header>> swap_headers() {
    std::vector<Bytes> messages;
    for (int rank : neighbours_) {
      Bytes message;
      for (const auto& [key, body] : bodies_.own)
        if (body.box.overlaps(greetings_[static_cast<std::size_t>(rank)].box)) write(message, Header{key, body.box});
      traffic_.header_bytes += message.size();
      messages.push_back(std::move(message));
    }
    Fault fault;
    std::vector<std::vector<Header>> headers;
    for (const Bytes& message : comm_.swap(neighbours_, messages, neighbours_, TAG_HEADERS, fault))
      headers.push_back(Reader(message).read_all<Header>(message.size() / sizeof(Header)));
    return headers;
  }

  /** Which bodies overlap, and who finds the contacts of each pair: both ranks come to the same without a reply. */
  void find_pairs(const std::vector<std::vector<Header>>& headers) {
    std::vector<Box> boxes;
    std::vector<std::pair<uint64_t, Own*>> owns;
    std::vector<std::pair<uint64_t, int>> others;
    for (auto& [key, body] : bodies_.own) {
      body.neighbours = 0;
      boxes.push_back(body.box);
      owns.emplace_back(key, &body);
    }
    for (std::size_t i = 0; i < headers.size(); ++i)
      for (const Header& header : headers[i]) {
        boxes.push_back(header.box);
        others.emplace_back(header.key, neighbours_[i]);
      }
    lent_before_ = std::move(lent_);
    forget();
    for_each_overlap(boxes, [&](std::size_t i, std::size_t j) {
      if (i > j) std::swap(i, j);
      if (i >= owns.size()) return;
      const uint64_t key = owns[i].first, other_key = j < owns.size() ? owns[j].first : others[j - owns.size()].first;
      if (!bodies_.settings.collides(key, other_key)) return;
      ++owns[i].second->neighbours;
      if (j < owns.size()) {
        ++owns[j].second->neighbours;
        return;
      }
      const auto& [other, rank] = others[j - owns.size()];
      uint32_t is_found_here = 0;
      static_cast<void>(rayc_finds_pair(owns[i].first, other, &is_found_here));
      if (is_found_here != 0) {
        borrowed_[rank].insert(other);
        ++traffic_.ghost_pairs;
      } else {
        lent_[rank].insert(owns[i].first);
      }
    });
    for (auto& [key, body] : bodies_.own)
      bodies_.fault.check(rayc_scene_share_body(bodies_.scene.get(), body.number, 0, body.neighbours, 0), "own body");
  }

  void swap_bodies(Fault& fault) {
    const bool has_damping = response_.damping_time > 0;
    std::vector<Bytes> messages;
    for (const auto& [rank, keys] : lent_) {
      Bytes message;
      for (uint64_t key : keys) {
        const Own& body = bodies_.own.at(key);
        rayc_body_state state{};
        fault.check(rayc_scene_body_state(bodies_.scene.get(), body.number, sizeof state, &state), "state of a body");
        const std::size_t before = message.size();
        write(message, key);
        bodies_.write_shape(message, body.shape, rank);
        traffic_.shape_bytes += message.size() - before - 24;
        write(message, body.neighbours);
        write(message, state.overlaps_itself);
        write(message, uint64_t{body.vertex_count});
        const std::size_t head = message.size();
        if (bodies_.attachment != nullptr) {
          const auto known = lent_before_.find(rank);
          const bool is_known = known != lent_before_.end() && known->second.count(key) != 0;
          bodies_.attachment->write_ghost(message, key, is_known && !tells_all_);
          traffic_.position_bytes += message.size() - head;
          continue;
        }
        write_numbers(message, body.positions.data(), body.positions.size(), is_single_);
        if (has_damping) write_numbers(message, body.velocities.data(), body.velocities.size(), is_single_);
        traffic_.position_bytes += message.size() - head;
      }
      messages.push_back(std::move(message));
    }
    const std::vector<int> from = ranks(borrowed_);
    const std::vector<Bytes> received = comm_.swap(ranks(lent_), messages, from, TAG_GHOSTS, fault);
    const std::clock_t start = std::clock();
    // Ghosts come and go without end.
    fault.check(rayc_scene_release_body_numbers(bodies_.scene.get()), "numbers of bodies that have left");
    for (auto& [key, ghost] : bodies_.ghosts) ghost.is_current = false;
    for (std::size_t i = 0; i < from.size(); ++i)
      for (Reader reader(received[i]); !reader.is_at_end();)
        if (!renew_ghost(reader, from[i], has_damping, fault)) break;
    std::set<uint32_t> gone;
    for (const auto& [key, ghost] : bodies_.ghosts)
      if (!ghost.is_current) gone.insert(ghost.number);
    if (bodies_.attachment != nullptr && !gone.empty()) bodies_.attachment->keep_memories(gone, fault);
    for (auto at = bodies_.ghosts.begin(); at != bodies_.ghosts.end();) {
      const auto ghost = at++;
      if (!ghost->second.is_current) bodies_.remove_ghost(ghost);
    }
    traffic_.ghosts += bodies_.ghosts.size();
    traffic_.ghost_seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  }

  /** False where the rest of the message cannot be read. */
  bool renew_ghost(Reader& reader, int from, bool has_damping, Fault& fault) {
    const auto key = reader.read<uint64_t>();
    const uint64_t shape = bodies_.read_shape(reader, from);
    const auto neighbours = reader.read<uint32_t>();
    const auto overlaps_itself = reader.read<uint32_t>();
    const auto count = reader.read<uint64_t>();
    const bool has_positions = bodies_.attachment == nullptr;
    std::vector<double> positions(has_positions ? 3 * count : 0), velocities(has_damping ? positions.size() : 0);
    reader.read_numbers(positions.data(), positions.size(), is_single_);
    reader.read_numbers(velocities.data(), velocities.size(), is_single_);
    const std::string what = "ghost of key " + std::to_string(key);
    auto found = bodies_.ghosts.find(key);
    if (found == bodies_.ghosts.end()) {
      Ghost ghost;
      if (!bodies_.add_received(key, shape, &ghost.number)) {
        fault.take(bodies_.fault);
        return false;
      }
      ghost.shape = shape;
      found = bodies_.ghosts.emplace(key, std::move(ghost)).first;
      bodies_.named[found->second.number] = Named{key, nullptr, &found->second};
      bodies_.settings.has_come(key);
      ++traffic_.new_ghosts;
    }
    Ghost& ghost = found->second;
    ghost.is_current = true;
    if (ghost.shape != shape) {
      fault.note(RAYC_STATUS_OTHER_MESH, "body of key " + std::to_string(key) +
                                             " has another mesh than in the step before; give other bodies other keys");
      return false;
    }
    ghost.owner = from;
    ghost.velocities = std::move(velocities);
    const rayc_vectors view = vectors(positions);
    fault.check(rayc_scene_share_body(bodies_.scene.get(), ghost.number, 1, neighbours, overlaps_itself), what);
    bool is_told_anew = false;
    if (!has_positions)
      is_told_anew = bodies_.attachment->read_ghost(reader, key, ghost.number, fault);
    else
      fault.check(rayc_scene_set_positions(bodies_.scene.get(), ghost.number, &view), what);
    if (is_told_anew) bodies_.settings.has_come(key);
    return true;
  }

  /** A pair whose bodies do not meet any more has forgotten. */
  void put_back(const KeyedMemory& keyed, Fault& fault) {
    rayc_pair_memory memory = keyed.memory;
    if (bodies_.number(keyed.first, &memory.first) && bodies_.number(keyed.second, &memory.second))
      fault.check(rayc_scene_set_pair_memory(bodies_.scene.get(), sizeof memory, &memory), "memory of a pair");
  }

  const Communicator& comm_;
  Bodies& bodies_;
  const rayc_response_options& response_;
  bool is_single_;
  Traffic& traffic_;
  PairForces forces_;
  std::vector<Greeting> greetings_;
  std::vector<int> neighbours_;
  bool any_new_ = false, any_settings_ = false;
  bool tells_all_ = false;         // some ranks may not have heard of ghosts in the step before
  double seconds_ = 0, cost_ = 0;  // of queries since bodies were last divided
  Keys lent_, borrowed_, lent_before_;
};

}  // namespace mpi_detail
}  // namespace raycontact

#endif  // RAYCONTACT_MPI_STEP_HPP
