// SPDX-License-Identifier: MIT OR Apache-2.0
/** The rows' matrix in 3 x 3 blocks: what all ranks add to the unknowns of this one's bodies. */
#ifndef RAYCONTACT_MPI_MATRIX_BLOCKS_HPP
#define RAYCONTACT_MPI_MATRIX_BLOCKS_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "raycontact/mpi/system_state.hpp"

namespace raycontact {

/**
 * 3 x 3 blocks of a matrix over all ranks: the rows of this rank's unknowns. Each place stands once; by rows, then by
 * the keys of the bodies that columns belong to, then by columns.
 */
struct DistributedBlocks {
  std::vector<uint32_t> rows;     ///< in this rank's vectors, in blocks of three unknowns
  std::vector<uint64_t> keys;     ///< of each column's body, of any rank
  std::vector<uint32_t> columns;  ///< of that body's unknowns, in blocks of three
  std::vector<double> numbers;    ///< nine for each block, by rows
};

namespace mpi_detail {

/** What one pair adds to a block. */
struct PairBlock {
  uint64_t key, column_key;  // of the bodies of its row and its column
  uint32_t row, column;      // in blocks from the body's first
  uint64_t is_half_space, other;
  std::array<double, 9> numbers;

  auto place() const { return std::tie(key, row, column_key, column); }
  auto order() const { return std::tie(key, row, column_key, column, is_half_space, other); }
};
static_assert(sizeof(PairBlock) == 40 + 72, "no padding");

/** Those of this rank's system. */
inline std::vector<PairBlock> own_blocks(const SystemState& state, double factor, Fault& fault) {
  std::size_t count = 0;
  fault.check(rayc_contact_system_part_block_count(state.system(), &count), "blocks");
  std::vector<uint32_t> parts(count), rows(count), columns(count);
  std::vector<double> numbers(9 * count);
  if (!fault)
    fault.check(rayc_contact_system_copy_part_blocks(state.system(), factor, count, parts.data(), rows.data(),
                                                     columns.data(), numbers.data()),
                "blocks");
  std::vector<PairBlock> blocks;
  for (std::size_t i = 0; i < count && !fault; ++i) {
    const rayc_contact_part& part = state.parts.parts().at(parts[i]);
    PairBlock block{};
    block.key = block.column_key = state.scene.bodies.named.at(part.body).key;
    block.is_half_space = part.is_half_space;
    block.other = part.is_half_space != 0 ? part.other : state.scene.bodies.named.at(part.other).key;
    const auto start = static_cast<uint32_t>(state.bodies.start(block.key) / 3);
    const auto own = static_cast<uint32_t>(state.bodies.bodies().at(block.key).unknown_count() / 3);
    block.row = rows[i] - start;
    block.column = columns[i] - start;
    if (columns[i] < start || columns[i] >= start + own) {
      block.column_key = block.other;
      block.column = columns[i] - static_cast<uint32_t>(state.bodies.start(block.other) / 3);
    }
    std::copy_n(&numbers[9 * i], 9, block.numbers.begin());
    blocks.push_back(block);
  }
  return blocks;
}

/** Collective: replaces what `blocks` held. Pairs are added in the order of the other bodies' keys, half-spaces last.
 */
inline Fault copy_blocks(const SystemState& state, double factor, DistributedBlocks& blocks) {
  Fault fault;
  std::vector<PairBlock> all;
  std::map<int, Bytes> messages;
  for (const auto& [rank, keys] : state.scene.step.borrowed()) messages[rank];
  for (const PairBlock& block : own_blocks(state, factor, fault)) {
    const auto ghost = state.scene.bodies.ghosts.find(block.key);
    if (ghost == state.scene.bodies.ghosts.end())
      all.push_back(block);
    else
      write(messages[ghost->second.owner], block);
  }
  std::vector<Bytes> sent;
  for (auto& [rank, message] : messages) sent.push_back(std::move(message));
  const std::vector<int> from = ranks(state.scene.step.lent());
  for (const Bytes& message : state.comm().swap(ranks(state.scene.step.borrowed()), sent, from, TAG_PARTS, fault))
    for (Reader reader(message); !reader.is_at_end();) all.push_back(reader.read<PairBlock>());
  fault = state.comm().agree(fault);
  if (fault) return fault;
  std::sort(all.begin(), all.end(), [](const PairBlock& a, const PairBlock& b) { return a.order() < b.order(); });

  std::map<uint64_t, uint32_t> starts;
  uint32_t start = 0;
  for (const auto& [key, body] : state.bodies.bodies()) {
    if (!body.is_own) continue;
    starts[key] = start;
    start += static_cast<uint32_t>(body.unknown_count() / 3);
  }
  blocks = DistributedBlocks();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const PairBlock& block = all[i];
    if (i == 0 || block.place() != all[i - 1].place()) {
      blocks.rows.push_back(starts.at(block.key) + block.row);
      blocks.keys.push_back(block.column_key);
      blocks.columns.push_back(block.column);
      blocks.numbers.insert(blocks.numbers.end(), block.numbers.begin(), block.numbers.end());
      continue;
    }
    double* sums = blocks.numbers.data() + blocks.numbers.size() - 9;
    for (std::size_t k = 0; k < 9; ++k) sums[k] += block.numbers[k];
  }
  return fault;
}

}  // namespace mpi_detail
}  // namespace raycontact

#endif  // RAYCONTACT_MPI_MATRIX_BLOCKS_HPP
