// SPDX-License-Identifier: MIT OR Apache-2.0
/** What the host has said of pairs of bodies: known where either body is, and moves with both. */
#ifndef RAYCONTACT_MPI_PAIR_SETTINGS_HPP
#define RAYCONTACT_MPI_PAIR_SETTINGS_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "raycontact/mpi/communicator.hpp"

namespace raycontact::mpi_detail {

/** How a pair differs from others. */
struct PairSetting {
  enum What : uint64_t { COLLISION = 1, ESCAPE = 2, MATERIAL = 4 };

  uint64_t said = 0;  // of a change: which of these it sets
  uint32_t is_ignored = 0, is_bound = 0;
  uint64_t has_material = 0;
  rayc_material material{};

  bool is_default() const { return is_ignored == 0 && is_bound == 0 && has_material == 0; }

  /** Takes over what the other says. */
  void merge(const PairSetting& other) {
    if ((other.said & COLLISION) != 0) is_ignored = other.is_ignored;
    if ((other.said & ESCAPE) != 0) is_bound = other.is_bound;
    if ((other.said & MATERIAL) != 0) {
      has_material = other.has_material;
      material = other.material;
    }
    said |= other.said;
  }

  /** Whether both say the same where both say anything. */
  bool agrees_with(const PairSetting& other) const {
    PairSetting both = *this, merged = *this;
    PairSetting common = other;
    common.said &= said;
    merged.merge(common);
    return std::memcmp(&both, &merged, sizeof both) == 0;
  }
};
static_assert(sizeof(PairSetting) == 24 + sizeof(rayc_material), "no padding, so that bytes can be compared");

/** Whether a contact system takes it; notes what is wrong. */
inline bool is_material(const rayc_material& material, Fault& noted) {
  Fault fault;
  if (material.struct_size != sizeof material)
    fault.note(RAYC_STATUS_INVALID_STRUCT_SIZE, "struct_size of a material is " + std::to_string(material.struct_size) +
                                                    "; set it to sizeof(rayc_material)");
  const std::pair<const char*, double> numbers[] = {
      {"stiffness", material.stiffness}, {"damping_time", material.damping_time}, {"friction", material.friction}};
  for (const auto& [name, number] : numbers)
    if (!(std::isfinite(number) && number >= 0))
      fault.note(RAYC_STATUS_INVALID_MATERIAL,
                 std::string(name) + " is " + std::to_string(number) + "; give a number that is finite and at least 0");
  if (!(material.restitution >= 0 && material.restitution <= 1))
    fault.note(RAYC_STATUS_INVALID_MATERIAL,
               "restitution is " + std::to_string(material.restitution) + "; give a number from 0 to 1");
  if (!(material.depth_cap > 0))
    fault.note(RAYC_STATUS_INVALID_MATERIAL,
               "depth_cap is " + std::to_string(material.depth_cap) + "; give a number above 0");
  const bool is_one = !fault;
  if (!noted) noted = fault;
  return is_one;
}

/** A rank's part of all settings: those of pairs with a body of its own, under both keys. */
class PairSettings {
 public:
  using Pair = std::array<uint64_t, 2>;
  using OfBody = std::map<uint64_t, PairSetting>;

  /** The host says something of a pair, on any rank; it counts with the next tell(). */
  void change(uint64_t first, uint64_t second, const PairSetting& change) {
    changes_[in_order(first, second)].merge(change);
  }

  bool has_news() const { return !changes_.empty() || !forgotten_.empty(); }

  /** Collective, where any rank has news: those who have the bodies hear of it. Keys are looked up where key modulo the
   * number of ranks says. Where anything is wrong nothing of it counts, and all ranks say the same. */
  template <class Owns>
  Fault tell(const Communicator& comm, const Owns& own) {
    const auto size = static_cast<std::size_t>(comm.size());
    newly_bound_.clear();
    Fault fault;
    std::vector<Bytes> keys(size), changes(size), forgotten(size);
    for (const auto& [key, body] : own) write(keys[key % size], key);
    for (const auto& [pair, change] : std::exchange(changes_, {}))
      for (std::size_t side = 0; side < (pair[0] == pair[1] ? 1u : 2u); ++side) {
        Bytes& message = changes[pair[side] % size];
        write(message, Pair{pair[side], pair[1 - side]});
        write(message, change);
      }
    for (const Pair& pair : std::exchange(forgotten_, {})) write(forgotten[pair[0] % size], pair);
    std::map<uint64_t, std::size_t> owners;
    const std::vector<Bytes> all_keys = comm.swap_all(keys, TAG_SETTINGS, fault);
    for (std::size_t rank = 0; rank < size; ++rank)
      for (Reader reader(all_keys[rank]); !reader.is_at_end();) owners[reader.read<uint64_t>()] = rank;

    // What is gone goes on first: a key may come again.
    std::vector<Bytes> onward(size);
    for (const Bytes& message : comm.swap_all(forgotten, TAG_SETTINGS, fault))
      for (Reader reader(message); !reader.is_at_end();) {
        const auto pair = reader.read<Pair>();
        const auto owner = owners.find(pair[0]);
        if (owner != owners.end()) write(onward[owner->second], pair);
      }
    for (const Bytes& message : comm.swap_all(onward, TAG_SETTINGS, fault))
      for (Reader reader(message); !reader.is_at_end();) {
        const auto pair = reader.read<Pair>();
        set(pair, PairSetting());
      }

    std::map<Pair, PairSetting> said;
    for (const Bytes& message : comm.swap_all(changes, TAG_SETTINGS, fault))
      for (Reader reader(message); !reader.is_at_end();) {
        const auto pair = reader.read<Pair>();
        const auto change = reader.read<PairSetting>();
        const std::string what = "pair of keys " + std::to_string(pair[0]) + " and " + std::to_string(pair[1]) + ": ";
        const auto [known, is_first] = said.emplace(pair, change);
        if (owners.count(pair[0]) == 0)
          fault.note(RAYC_STATUS_UNKNOWN_BODY, what + "no rank has the body of key " + std::to_string(pair[0]));
        else if (!is_first && !known->second.agrees_with(change))
          fault.note(RAYC_STATUS_RANKS_DISAGREE,
                     what + "ranks say different things of it; let all say the same, or one");
        else if (!is_first)
          known->second.merge(change);
      }
    if (Fault agreed = comm.agree(fault)) return agreed;
    onward.assign(size, Bytes());
    for (const auto& [pair, change] : said) {
      Bytes& message = onward[owners.at(pair[0])];
      write(message, pair);
      write(message, change);
    }
    for (const Bytes& message : comm.swap_all(onward, TAG_SETTINGS, fault))
      for (Reader reader(message); !reader.is_at_end();) {
        const auto pair = reader.read<Pair>();
        PairSetting setting = find(pair[0], pair[1]);
        const bool was_bound = setting.is_bound != 0;
        setting.merge(reader.read<PairSetting>());
        if (setting.is_bound != 0 && !was_bound) newly_bound_.insert(in_order(pair[0], pair[1]));
        set(pair, setting);
      }
    return comm.agree(fault);
  }

  /** Pairs that the last tell() has forbidden to escape: what they remember is gone. */
  bool is_newly_bound(uint64_t first, uint64_t second) const {
    return newly_bound_.count(in_order(first, second)) != 0;
  }

  PairSetting find(uint64_t first, uint64_t second) const {
    const auto of_first = bodies_.find(first);
    if (of_first == bodies_.end()) return PairSetting();
    const auto found = of_first->second.find(second);
    return found == of_first->second.end() ? PairSetting() : found->second;
  }

  bool collides(uint64_t first, uint64_t second) const {
    return bodies_.empty() || find(first, second).is_ignored == 0;
  }

  /** The body is new in the rank's scene or system, which are to be told of its pairs. */
  void has_come(uint64_t key) {
    const auto found = bodies_.find(key);
    if (found == bodies_.end()) return;
    for (const auto& [other, setting] : found->second) untold_.insert({key, other});
  }

  /** Pairs of which the rank's scene and system are to be told, if they have both bodies. */
  std::set<Pair> take_untold() { return std::exchange(untold_, {}); }

  /** The host has removed a body of this rank's. */
  void forget(uint64_t key) {
    const auto found = bodies_.find(key);
    if (found != bodies_.end())
      for (const auto& [other, setting] : OfBody(found->second)) {
        forgotten_.insert({other, key});
        erase({key, other});
      }
    for (auto at = changes_.begin(); at != changes_.end();)
      at = at->first[0] == key || at->first[1] == key ? changes_.erase(at) : std::next(at);
  }

  /** All of a body that changes ranks. */
  void write_body(Bytes& message, uint64_t key) const {
    const auto found = bodies_.find(key);
    write(message, uint64_t{found == bodies_.end() ? 0 : found->second.size()});
    if (found == bodies_.end()) return;
    for (const auto& [other, setting] : found->second) {
      write(message, other);
      write(message, setting);
    }
  }

  void read_body(Reader& message, uint64_t key) {
    for (auto count = message.read<uint64_t>(); count > 0; --count) {
      const auto other = message.read<uint64_t>();
      set({key, other}, message.read<PairSetting>());
    }
  }

  /** A body has left: pairs of which no body is left here go too. */
  template <class Owns>
  void has_left(uint64_t key, const Owns& own) {
    const auto found = bodies_.find(key);
    if (found == bodies_.end()) return;
    for (const auto& [other, setting] : OfBody(found->second))
      if (own.count(other) == 0) erase({key, other});
  }

  /** A contact system is new: materials were another's. */
  void drop_materials() {
    PairSetting none;
    none.said = PairSetting::MATERIAL;
    for (auto& [pair, change] : changes_) {
      change.merge(none);
      change.said &= ~uint64_t{PairSetting::MATERIAL};
    }
    for (const auto& [key, of_body] : std::map<uint64_t, OfBody>(bodies_))
      for (auto [other, setting] : of_body) {
        setting.merge(none);
        set({key, other}, setting);
      }
  }

 private:
  static Pair in_order(uint64_t first, uint64_t second) { return {std::min(first, second), std::max(first, second)}; }

  void set(const Pair& pair, PairSetting setting) {
    untold_.insert(pair);
    setting.said = 0;
    if (setting.is_default()) return erase(pair);
    bodies_[pair[0]][pair[1]] = setting;
    bodies_[pair[1]][pair[0]] = setting;
  }

  void erase(const Pair& pair) {
    for (std::size_t side = 0; side < 2; ++side) {
      const auto of_body = bodies_.find(pair[side]);
      if (of_body == bodies_.end()) continue;
      of_body->second.erase(pair[1 - side]);
      if (of_body->second.empty()) bodies_.erase(of_body);
    }
  }

  std::map<uint64_t, OfBody> bodies_;
  std::map<Pair, PairSetting> changes_;
  std::set<Pair> forgotten_;  // another's key, and that of a body that is gone
  std::set<Pair> untold_, newly_bound_;
};

}  // namespace raycontact::mpi_detail

#endif  // RAYCONTACT_MPI_PAIR_SETTINGS_HPP
