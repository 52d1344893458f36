// The judge of the distributed contact system: one ContactSystem of one process, whose parts are added in the order of
// keys.
#ifndef PLAIN_CONTACT_SYSTEM_HPP
#define PLAIN_CONTACT_SYSTEM_HPP

#include <algorithm>
#include <iterator>
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
    std::size_t at = 0;
    for (const auto& [key, size] : sizes_) {
      host_starts_[key] = at;
      at += size;
      if (size != 0) by_start_[starts_.at(key)] = key;
    }
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
    find_parts();
  }

  void find_parts() {
    system_.copy_parts_to(all_);
    // Where they stand before they are put in order, by which blocks and energies are named.
    as_given_ = all_.parts;
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

  void set_pair_material(uint64_t first, uint64_t second, const rayc_material* material) {
    system_.set_pair_material(numbers_.at(first), numbers_.at(second), material);
  }
  void set_half_space_material(uint64_t key, uint32_t half_space, const rayc_material* material) {
    system_.set_half_space_material(numbers_.at(key), half_space, material);
  }
  void set_pair_collision(uint64_t first, uint64_t second, bool is_on) {
    scene_.set_pair_collision(numbers_.at(first), numbers_.at(second), is_on);
  }
  void allow_escape(uint64_t first, uint64_t second, bool is_allowed) {
    scene_.allow_escape(numbers_.at(first), numbers_.at(second), is_allowed);
  }

  bool detect_again(const Numbers& v) {
    const bool is_more = system_.detect_again(scene_, spread(v));
    find_parts();
    return is_more;
  }

  double energy(const Numbers& v) {
    Numbers joules(as_given_.size());
    const Numbers own = spread(v);
    system_.part_energies(own, joules);
    const double sum = sum_of(joules), whole = system_.energy(own);
    if (!(std::fabs(sum - whole) <= 1e-12 * whole)) ++wrong_sums;
    return sum;
  }

  void copy_blocks_to(double factor, raycontact::DistributedBlocks& blocks) {
    raycontact::PartBlocks own;
    system_.copy_part_blocks_to(factor, own);
    // By row, the column's body and column, then by what the body touches.
    using Place = std::tuple<std::size_t, uint64_t, std::size_t>;
    std::map<Place, std::map<std::pair<uint32_t, uint64_t>, const double*>> places;
    for (std::size_t i = 0; i < own.rows.size(); ++i) {
      const rayc_contact_part& part = as_given_[own.parts[i]];
      const auto [row_key, row] = place_of(own.rows[i]);
      const auto [column_key, column] = place_of(own.columns[i]);
      const uint64_t other = part.is_half_space != 0 ? part.other : keys_[part.other];
      places[{host_starts_.at(row_key) / 3 + row, column_key, column}][{part.is_half_space, other}] =
          &own.numbers[9 * i];
    }
    blocks = raycontact::DistributedBlocks();
    for (const auto& [place, pairs] : places) {
      blocks.rows.push_back(static_cast<uint32_t>(std::get<0>(place)));
      blocks.keys.push_back(std::get<1>(place));
      blocks.columns.push_back(static_cast<uint32_t>(std::get<2>(place)));
      Numbers sum;
      for (const auto& [other, numbers] : pairs) {
        if (sum.empty())
          sum.assign(numbers, numbers + 9);
        else
          for (std::size_t k = 0; k < 9; ++k) sum[k] += numbers[k];
      }
      blocks.numbers.insert(blocks.numbers.end(), sum.begin(), sum.end());
    }
  }

  double explicit_step(double seconds, const Numbers& x, const Numbers& v, Numbers& forces) {
    Numbers fields[2] = {spread(x), spread(v)};
    for (Numbers& field : fields) field.resize(3 * node_count_);
    system_.begin_explicit(scene_, seconds, fields[0], fields[1]);
    find_parts();
    add_forces(v, forces);
    Numbers couplings(all_.blocks.size()), sums((3 * node_count_ + 6 * rigid_count_) / 3);
    system_.part_couplings(couplings);
    for (const rayc_contact_part& part : all_.parts)
      for (std::size_t i = part.start; i < part.start + part.count; ++i) sums[all_.blocks[i]] += couplings[i];
    const std::array<double, 2> largest = system_.largest_coupling(sums);
    finish(v);
    return raycontact::mpi_detail::longest_step(largest[0], largest[1]);
  }

  double dot(const Numbers& a, const Numbers& b) const {
    Numbers of_bodies;
    std::size_t at = 0;
    for (const auto& [key, size] : sizes_) {
      double sum = 0;
      for (const std::size_t end = at + size; at < end; ++at) sum += a[at] * b[at];
      of_bodies.push_back(sum);
    }
    return sum_of(of_bodies);
  }

  uint64_t pushes = 0, on_floor = 0, between_bodies = 0, wrong_sums = 0;

 private:
  static double sum_of(const Numbers& numbers) {
    double largest = 0;
    for (double number : numbers) largest = std::max(largest, std::fabs(number));
    raycontact::mpi_detail::FixedSum sum;
    for (double number : numbers) sum.add(number, largest);
    return sum.value(largest);
  }

  /** The body of a block of the system's unknowns, and its place there. */
  std::pair<uint64_t, std::size_t> place_of(std::size_t block) const {
    const auto [start, key] = *std::prev(by_start_.upper_bound(3 * block));
    return {key, block - start / 3};
  }

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
  std::map<uint64_t, std::size_t> starts_, sizes_, host_starts_;
  std::map<std::size_t, uint64_t> by_start_;
  std::size_t node_count_ = 0, rigid_count_ = 0;
  raycontact::Parts all_;
  std::vector<rayc_contact_part> as_given_;
};

}  // namespace rubbing

#endif
