// SPDX-License-Identifier: MIT OR Apache-2.0
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>

#include "../terminal.hpp"
#include "drifters.hpp"
#include "frames.hpp"
#include "raycontact/mpi.hpp"

namespace {

struct Options {
  long bodies = 220, steps = 60, around = 24, apart = 100, rebalance = 10, every = 4;
  std::string out, csv;
};

const char* const usage =
    "usage: mpirun -n RANKS distributed [options]\n"
    "\n"
    "Tori drift through one another, spread over the ranks of a run; some have small ones inside that must escape. "
    "Prints\n"
    "a hash of every force of every step, which is the same for any number of ranks, and what the exchange took.\n"
    "\n"
    "  --bodies N      how many bodies (220)\n"
    "  --steps N       steps of 1/60 s (60)\n"
    "  --around N      quads around each torus, half as many across (24)\n"
    "  --apart N       how far apart bodies start, in per cent of the usual (100)\n"
    "  --rebalance N   steps between two divisions of the bodies among the ranks (10)\n"
    "  --out FOLDER    write distributed.pvd and its frames there, for ParaView\n"
    "  --every N       steps between two frames (4)\n"
    "  --csv FILE      append a row for each rank: what it had, sent and took, means of a step\n"
    "  --help          this text\n"
    "\n"
    "Exit status: 0 done, 1 something failed, 2 wrong usage.\n";

/** Gives -1 to go on, or the status to end with. */
int parse(int argc, char** argv, Options& options) {
  const std::map<std::string, long*> numbers = {{"--bodies", &options.bodies},
                                                {"--steps", &options.steps},
                                                {"--around", &options.around},
                                                {"--apart", &options.apart},
                                                {"--rebalance", &options.rebalance},
                                                {"--every", &options.every}};
  for (int i = 1; i < argc; ++i)
    if (std::string(argv[i]) == "--help") return std::fputs(usage, stdout), 0;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    const auto number = numbers.find(option);
    if (option != "--out" && option != "--csv" && number == numbers.end())
      return std::fprintf(stderr, "distributed: unknown option %s\n\n%s", argv[i], usage), 2;
    if (++i == argc) return std::fprintf(stderr, "distributed: %s needs a value\n\n%s", option.c_str(), usage), 2;
    if (option == "--out" || option == "--csv") {
      (option == "--out" ? options.out : options.csv) = argv[i];
      continue;
    }
    char* end = nullptr;
    *number->second = std::strtol(argv[i], &end, 10);
    const long least = option == "--around" ? 6 : 1;
    if (*end != '\0' || *number->second < least || *number->second > 1000000)
      return std::fprintf(stderr, "distributed: %s needs a whole number of at least %ld, not %s\n\n%s", option.c_str(),
                          least, argv[i], usage),
             2;
  }
  return -1;
}

class Run {
 public:
  Run(const Options& options, int rank, int size)
      : options_(options), rank_(rank), size_(size), scene_(MPI_COMM_WORLD, scene_options()) {
    const auto around = static_cast<uint32_t>(options.around);
    large_ = demo::torus(around, around / 2);
    small_ = demo::torus(8, 5);
    for (double& number : small_.positions) number *= 0.12;
    const auto count = static_cast<uint64_t>(options.bodies);
    for (uint64_t key = 0; key < count; ++key) {
      if (static_cast<int>(key * static_cast<uint64_t>(size) / count) != rank) continue;
      bodies_[key] = demo::drifter(key, count, static_cast<double>(options.apart) / 100);
      const demo::Surface& surface = shape(key);
      scene_.add(key, {raycontact::vectors(surface.positions), surface.triangles});
    }
    if (!options.out.empty()) frames_ = std::make_unique<demo::RankedFrames>(options.out, rank, size);
  }

  void run() {
    demo::ProgressBar progress;
    for (long step = 0; step < options_.steps; ++step) {
      if (step > 0 && step % options_.rebalance == 0) rebalance();
      place();
      scene_.step(demo::drift_step);
      uint64_t hash = 0;
      for (auto& [key, body] : bodies_) {
        const auto forces = scene_.forces(key);
        demo::drift(body, forces.data(), forces.size());
        hash += demo::bits_of(body, forces.data(), forces.size());
      }
      MPI_Allreduce(MPI_IN_PLACE, &hash, 1, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
      hash_ = (hash_ ^ hash) * 0x100000001b3ull;
      const rayc_statistics statistics = scene_.statistics();
      const rayc_statistics own = scene_.own_statistics();
      own_pairs_ += own.pairs;
      own_rays_ += own.rays;
      own_bodies_ += bodies_.size();
      contacts_ += statistics.contacts;
      pairs_ += statistics.pairs;
      escapes_ = statistics.escaping_pairs;
      if (frames_ && step % options_.every == 0) write_frame(step);
      if (rank_ == 0)
        progress.show(
            static_cast<double>(step + 1) / static_cast<double>(options_.steps),
            std::to_string(statistics.contacts) + " contacts, " + std::to_string(escapes_) + " pairs escaping");
    }
  }

  /** Sums over all ranks, and of times the longest. */
  void print() const {
    const raycontact::Traffic& own = scene_.traffic();
    uint64_t sums[] = {own.header_bytes, own.position_bytes, own.shape_bytes,
                       own.force_bytes,  own.ghosts,         own.new_ghosts};
    double seconds[] = {own.processor_seconds,
                        own.query_seconds,
                        own.sum_seconds,
                        own.ghost_seconds,
                        own.total_seconds - own.query_seconds - own.sum_seconds - own.ghost_seconds,
                        own.total_seconds};
    double all[6];
    if (!options_.csv.empty()) append_rows();
    MPI_Allreduce(MPI_IN_PLACE, sums, 6, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
    MPI_Allreduce(seconds, all, 6, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    MPI_Allreduce(MPI_IN_PLACE, seconds, 6, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    if (rank_ != 0) return;
    const double steps = static_cast<double>(options_.steps);
    std::printf(
        "%ld bodies on %d ranks, %ld steps: %.0f pairs and %.0f contacts a step, %llu pairs escaping at the end\n\n",
        options_.bodies, size_, options_.steps, static_cast<double>(pairs_) / steps,
        static_cast<double>(contacts_) / steps, static_cast<unsigned long long>(escapes_));
    std::printf("a step, all ranks together  %10s\n", "bytes");
    const char* const names[] = {"headers", "positions of ghosts", "meshes", "forces back"};
    for (int i = 0; i < 4; ++i) std::printf("  %-25s %10.0f\n", names[i], static_cast<double>(sums[i]) / steps);
    std::printf("  %-25s %10.1f, %.1f of them new\n\n", "ghosts", static_cast<double>(sums[4]) / steps,
                static_cast<double>(sums[5]) / steps);
    std::printf("a step, in ms               %10s %12s\n", "mean rank", "longest rank");
    const char* const parts[] = {"processor, query and sums", "query", "sums of forces", "ghosts",
                                 "exchange and waiting",      "all"};
    for (int i = 0; i < 6; ++i)
      std::printf("  %-25s %10.3f %12.3f\n", parts[i], 1e3 * all[i] / steps / size_, 1e3 * seconds[i] / steps);
    std::printf("\nhash=%016llx\n", static_cast<unsigned long long>(hash_));
  }

 private:
  /** Rank by rank. */
  void append_rows() const {
    const raycontact::Traffic& own = scene_.traffic();
    const double steps = static_cast<double>(options_.steps);
    const double numbers[] = {double(own_bodies_),      double(own_pairs_),          double(own_rays_),
                              double(own.ghost_pairs),  double(own.ghosts),          double(own.new_ghosts),
                              double(own.header_bytes), double(own.position_bytes),  double(own.shape_bytes),
                              double(own.force_bytes),  1e3 * own.processor_seconds, 1e3 * own.ghost_seconds};
    for (int rank = 0; rank < size_; ++rank) {
      MPI_Barrier(MPI_COMM_WORLD);
      if (rank != rank_) continue;
      std::FILE* file = std::fopen(options_.csv.c_str(), "a");
      if (file == nullptr) throw std::runtime_error("cannot write to " + options_.csv);
      std::fseek(file, 0, SEEK_END);
      if (std::ftell(file) == 0)
        std::fputs(
            "total_bodies,ranks,rank,bodies,pairs,rays,ghost_pairs,ghosts,new_ghosts,header_bytes,position_bytes,"
            "mesh_bytes,force_bytes,processor_ms,ghost_ms\n",
            file);
      std::fprintf(file, "%ld,%d,%d", options_.bodies, size_, rank_);
      for (double number : numbers) std::fprintf(file, ",%.6g", number / steps);
      std::fputc('\n', file);
      std::fclose(file);
    }
  }

  static raycontact::DistributedOptions scene_options() {
    raycontact::DistributedOptions options;
    options.response.stiffness = 500;
    return options;
  }

  const demo::Surface& shape(uint64_t key) const { return demo::is_small(key) ? small_ : large_; }

  void place() {
    for (const auto& [key, body] : bodies_) {
      positions_ = shape(key).positions;
      for (std::size_t i = 0; i < positions_.size(); ++i) positions_[i] += body.place[i % 3];
      scene_.set_positions(key, raycontact::vectors(positions_));
    }
  }

  void rebalance() {
    const auto pack = [this](uint64_t key) {
      std::vector<unsigned char> bytes(sizeof(demo::Drifter));
      std::memcpy(bytes.data(), &bodies_.at(key), bytes.size());
      bodies_.erase(key);
      return bytes;
    };
    const auto unpack = [this](uint64_t key, const std::vector<unsigned char>& bytes) {
      std::memcpy(&bodies_[key], bytes.data(), bytes.size());
    };
    scene_.rebalance(pack, unpack);
  }

  void write_frame(long step) {
    demo::VtpSurface surface;
    for (const auto& [key, body] : bodies_) {
      const auto first = static_cast<int32_t>(surface.points.size() / 3);
      const auto positions = scene_.positions(key), forces = scene_.forces(key);
      for (std::size_t i = 0; i < positions.size(); i += 3) {
        for (std::size_t axis = 0; axis < 3; ++axis) surface.points.push_back(static_cast<float>(positions[i + axis]));
        surface.body.push_back(static_cast<uint8_t>(key % 256));
        surface.inside.push_back(forces[i] != 0 || forces[i + 1] != 0 || forces[i + 2] != 0 ? 1 : 0);
      }
      for (uint32_t vertex : shape(key).triangles) surface.triangles.push_back(first + static_cast<int32_t>(vertex));
    }
    frames_->add(static_cast<int>(step / options_.every), static_cast<double>(step) * demo::drift_step, surface);
  }

  Options options_;
  int rank_, size_;
  raycontact::DistributedScene scene_;
  demo::Surface large_, small_;
  std::map<uint64_t, demo::Drifter> bodies_;
  std::vector<double> positions_;
  std::unique_ptr<demo::RankedFrames> frames_;
  uint64_t hash_ = 0, contacts_ = 0, pairs_ = 0, escapes_ = 0, own_pairs_ = 0, own_rays_ = 0, own_bodies_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  Options options;
  const int status = parse(argc, argv, options);
  if (status >= 0) return status;
  MPI_Init(&argc, &argv);
  int rank = 0, size = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  try {
    Run run(options, rank, size);
    run.run();
    run.print();
  } catch (const std::exception& error) {
    // What the scene says all ranks say; what one rank alone meets, such as a full disk, must end the others too.
    std::fprintf(stderr, "distributed, rank %d: %s\n", rank, error.what());
    MPI_Abort(MPI_COMM_WORLD, 1);
  }
  MPI_Finalize();
  return 0;
}
