// The judge of the distributed contact system: one ContactSystem of one process, whose parts are added in the order of
// keys.
#ifndef PLAIN_CONTACT_SYSTEM_HPP
#define PLAIN_CONTACT_SYSTEM_HPP

#include <algorithm>
#include <tuple>

#include "rubbing_bodies.hpp"

namespace rubbing {

class PlainSystem {
 public:
  explicit PlainSystem(const Host& host) {
    std::vector<double> masses;
    for (const auto& [key, body] : host)
      masses.insert(masses.end(), kind_of(body.number) == RIGID ? 0 : body.x.size() / 3, node_mass(body.number));
    node_count_ = masses.size();
    system_.set_node_masses(masses);
    // Numbers of bodies and of nodes run the other way round than keys.
    std::size_t node = masses.size();
    for (auto at = host.rbegin(); at != host.rend(); ++at) {
      const auto& [key, body] = *at;
      const Torus shape = shape_of(body.number);
      const uint32_t number = scene_.add({raycontact::vectors(shape.positions), shape.triangles}, key);
      if (keys_.size() <= number) keys_.resize(number + 1);
      keys_[number] = key;
      numbers_[key] = number;
      const auto count = static_cast<uint32_t>(body.x.size() / 3);
      node -= count;
      starts_[key] = 3 * node;
      const auto first = static_cast<uint32_t>(node);
      const Kind kind = kind_of(body.number);
      if (kind == SOFT) system_.add_deformable(scene_, number, first, count, material(body.number));
      if (kind == CAGED) {
        const Table table = table_of(body.number);
        system_.add_deformable(scene_, number, first, count, {table.offsets, table.nodes, table.weights},
                               material(body.number));
      }
      if (kind == RIGID) {
        starts_[key] = 3 * node_count_ + 6 * rigid_count_++;
        system_.add_rigid(scene_, number, rigid_mass, rigid_inertia, material(body.number));
      }
      if (kind == MOVED) system_.add_moved(scene_, number, material(body.number));
      sizes_[key] = body.unknown_count();
    }
    system_.add_half_space(floor_normal, floor_offset, material(1));
  }

  void set_motion(uint64_t key, const rayc_motion& motion) { system_.set_motion(numbers_.at(key), motion); }

  void begin(double seconds, const Numbers& x, const Numbers& v, const Numbers& free) {
    Numbers fields[3];
    const Numbers* const given[] = {&x, &v, &free};
    for (std::size_t k = 0; k < 3; ++k) {
      fields[k] = spread(*given[k]);
      fields[k].resize(3 * node_count_);
    }
    system_.begin(scene_, seconds, fields[0], fields[1], fields[2]);
    system_.copy_parts_to(all_);
    std::sort(all_.parts.begin(), all_.parts.end(), [this](const rayc_contact_part& a, const rayc_contact_part& b) {
      const auto order = [this](const rayc_contact_part& part) {
        return std::make_tuple(keys_[part.body], part.is_half_space,
                               part.is_half_space != 0 ? part.other : keys_[part.other]);
      };
      return order(a) < order(b);
    });
    for (const rayc_contact_part& part : all_.parts) {
      pushes += part.count == 98 ? 1 : 0;  // all nodes of a large body
      on_floor += part.is_half_space;
      between_bodies += part.is_half_space != 0 ? 0 : 1;
    }
  }

  void add_forces(const Numbers& v, Numbers& forces) {
    const Numbers own = spread(v);
    Numbers values(3 * all_.blocks.size());
    system_.part_forces(own, values);
    add(values, forces);
  }

  void add_product(double factor, const Numbers& change, Numbers& result) {
    const Numbers own = spread(change);
    Numbers values(3 * all_.blocks.size());
    system_.part_products(factor, own, values);
    add(values, result);
  }

  void linearise(const Numbers& v) { static_cast<void>(system_.linearise(spread(v))); }
  void finish(const Numbers& v) { system_.finish(spread(v)); }

  double dot(const Numbers& a, const Numbers& b) const {
    Numbers of_bodies;
    double largest = 0;
    std::size_t at = 0;
    for (const auto& [key, size] : sizes_) {
      double sum = 0;
      for (const std::size_t end = at + size; at < end; ++at) sum += a[at] * b[at];
      of_bodies.push_back(sum);
      largest = std::max(largest, std::fabs(sum));
    }
    raycontact::mpi_detail::FixedSum sum;
    for (double number : of_bodies) sum.add(number, largest);
    return sum.value(largest);
  }

  uint64_t pushes = 0, on_floor = 0, between_bodies = 0;

 private:
  /** From the host's order to the system's, and back. */
  Numbers spread(const Numbers& numbers) const {
    Numbers own(3 * node_count_ + 6 * rigid_count_);
    std::size_t at = 0;
    for (const auto& [key, size] : sizes_)
      for (std::size_t k = 0; k < size; ++k) own[starts_.at(key) + k] = numbers[at++];
    return own;
  }

  void add(const Numbers& values, Numbers& sums) const {
    Numbers own = spread(sums);
    for (const rayc_contact_part& part : all_.parts)
      for (std::size_t i = part.start; i < part.start + part.count; ++i)
        for (std::size_t axis = 0; axis < 3; ++axis)
          own[3 * std::size_t{all_.blocks[i]} + axis] += values[3 * i + axis];
    std::size_t at = 0;
    for (const auto& [key, size] : sizes_)
      for (std::size_t k = 0; k < size; ++k) sums[at++] = own[starts_.at(key) + k];
  }

  static rayc_contact_system_options options() {
    rayc_contact_system_options options = raycontact::default_contact_system_options();
    options.keeps_rigid_unknowns = 1;
    return options;
  }

  raycontact::Scene scene_;
  raycontact::ContactSystem system_{options()};
  std::vector<uint64_t> keys_;
  std::map<uint64_t, uint32_t> numbers_;
  std::map<uint64_t, std::size_t> starts_, sizes_;
  std::size_t node_count_ = 0, rigid_count_ = 0;
  raycontact::Parts all_;
};

}  // namespace rubbing

#endif
