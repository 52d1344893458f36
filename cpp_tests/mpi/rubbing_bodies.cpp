// The contact system over several ranks: friction, cages, rigid and moved bodies, a floor, escapes and an implicit
// step's products have the bits of one process, while bodies change ranks every five steps. With --drop-memory they
// change ranks without what their pairs remember, and the bits must be others. With --all bodies are faster, contacts
// are looked for again within a step, pairs have materials of their own, do not collide or may not escape, and the bits
// of the energy and of the matrix's blocks count too. With --all-but WHAT the ranks do without one of these, and the
// bits must be others. With --explicit steps are short and explicit.
#include "rubbing_bodies.hpp"

#include <algorithm>
#include <cstdio>
#include <string>

#include "plain_contact_system.hpp"

namespace {

using namespace rubbing;

constexpr int step_count = 40, steps_between_migrations = 5;

void write(std::vector<unsigned char>& bytes, const void* from, std::size_t count) {
  const auto* first = static_cast<const unsigned char*>(from);
  bytes.insert(bytes.end(), first, first + count);
}

std::vector<unsigned char> bytes_of(const Body& body) {
  std::vector<unsigned char> bytes;
  write(bytes, &body.number, sizeof body.number);
  write(bytes, &body.motion, sizeof body.motion);
  write(bytes, body.x.data(), body.x.size() * sizeof(double));
  write(bytes, body.v.data(), body.v.size() * sizeof(double));
  return bytes;
}

Body body_of(const std::vector<unsigned char>& bytes) {
  Body body;
  const unsigned char* at = bytes.data();
  std::memcpy(&body.number, at, sizeof body.number);
  std::memcpy(&body.motion, at += sizeof body.number, sizeof body.motion);
  at += sizeof body.motion;
  const std::size_t count = static_cast<std::size_t>(bytes.data() + bytes.size() - at) / (2 * sizeof(double));
  body.x.resize(count);
  body.v.resize(count);
  if (count == 0) return body;
  std::memcpy(body.x.data(), at, count * sizeof(double));
  std::memcpy(body.v.data(), at + count * sizeof(double), count * sizeof(double));
  return body;
}

/** Counts the ghosts that join within a step. */
struct Watched : raycontact::DistributedContactSystem {
  explicit Watched(raycontact::DistributedScene& of_scene)
      : raycontact::DistributedContactSystem(of_scene), scene(of_scene) {}

  bool detect_again(const Numbers& v) {
    const uint64_t before = scene.traffic().new_ghosts;
    const bool is_more = raycontact::DistributedContactSystem::detect_again(v);
    joined += scene.traffic().new_ghosts - before;
    return is_more;
  }

  raycontact::DistributedScene& scene;
  uint64_t joined = 0;
};

struct Ranks {
  raycontact::DistributedScene scene{MPI_COMM_WORLD};
  Watched system{scene};
  Host host;
  int rank = 0, size = 1;
  uint64_t moved = 0, turns = 0;

  Ranks() {
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    system.add_half_space(floor_normal, floor_offset, material(1));
    for (uint32_t number = 0; number < body_count; ++number)
      if (static_cast<int>(number * static_cast<uint32_t>(size) / body_count) == rank) add(first_state(number));
  }

  void add(const Body& body) {
    const uint64_t key = key_of(body.number);
    const Torus shape = shape_of(body.number);
    scene.add(key, {raycontact::vectors(shape.positions), shape.triangles});
    const std::vector<double> masses(body.x.size() / 3, node_mass(body.number));
    switch (kind_of(body.number)) {
      case SOFT:
        system.add_deformable(key, masses, material(body.number));
        break;
      case CAGED: {
        const Table table = table_of(body.number);
        system.add_deformable(key, masses, {table.offsets, table.nodes, table.weights}, material(body.number));
        break;
      }
      case RIGID:
        system.add_rigid(key, rigid_mass, rigid_inertia, material(body.number));
        break;
      case MOVED:
        system.add_moved(key, material(body.number));
    }
    host[key] = body;
  }

  /** Of pairs any one rank says it, of its own bodies or not. */
  bool is_my_turn() { return static_cast<int>(turns++ % static_cast<uint64_t>(size)) == rank; }
  void set_pair_material(uint64_t first, uint64_t second, const rayc_material* material) {
    if (is_my_turn()) system.set_pair_material(first, second, material);
  }
  void set_half_space_material(uint64_t key, uint32_t half_space, const rayc_material* material) {
    if (host.count(key) != 0) system.set_half_space_material(key, half_space, material);
  }
  void set_pair_collision(uint64_t first, uint64_t second, bool is_on) {
    if (is_my_turn()) scene.set_pair_collision(first, second, is_on);
  }
  void allow_escape(uint64_t first, uint64_t second, bool is_allowed) {
    if (is_my_turn()) scene.allow_escape(first, second, is_allowed);
  }

  int new_owner(uint64_t key, int step) const {
    return static_cast<int>((key + static_cast<uint64_t>(step)) % static_cast<uint64_t>(size));
  }

  void change_ranks(int step) {
    const auto pack = [this](uint64_t key) {
      const std::vector<unsigned char> bytes = bytes_of(host.at(key));
      host.erase(key);
      ++moved;
      return bytes;
    };
    const auto unpack = [this](uint64_t key, const std::vector<unsigned char>& bytes) { host[key] = body_of(bytes); };
    if (step % (2 * steps_between_migrations) != 0) {
      scene.rebalance(pack, unpack);
      return;
    }
    std::vector<int> owners;
    for (uint64_t key : scene.keys()) owners.push_back(new_owner(key, step));
    scene.migrate(owners, pack, unpack);
  }

  /** To other ranks as a host would do it that knows nothing of pairs: each body is added anew where it goes. */
  void add_anew() {
    // All ranks hear of all bodies.
    std::vector<unsigned char> own;
    for (const auto& [key, body] : host) {
      const std::vector<unsigned char> bytes = bytes_of(body);
      const uint64_t length = bytes.size();
      write(own, &length, sizeof length);
      write(own, bytes.data(), bytes.size());
    }
    for (const auto& [key, body] : host) scene.remove(key);
    host.clear();
    for (int from = 0; from < size; ++from) {
      uint64_t length = own.size();
      MPI_Bcast(&length, 1, MPI_UINT64_T, from, MPI_COMM_WORLD);
      std::vector<unsigned char> bytes = own;
      bytes.resize(length);
      MPI_Bcast(bytes.data(), static_cast<int>(length), MPI_BYTE, from, MPI_COMM_WORLD);
      for (std::size_t at = 0; at < bytes.size();) {
        uint64_t of_body = 0;
        std::memcpy(&of_body, &bytes[at], sizeof of_body);
        at += sizeof of_body;
        const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(at);
        const Body body = body_of({first, first + static_cast<std::ptrdiff_t>(of_body)});
        at += of_body;
        if (static_cast<int>(body.number % static_cast<uint32_t>(size)) == rank) add(body);
      }
    }
  }
};

Uses uses_without(const std::string& left_out) {
  Uses uses;
  uses.looks_again = left_out != "looks";
  uses.has_materials = left_out != "materials";
  uses.has_half_spaces = left_out != "half-spaces";
  uses.has_collision = left_out != "collision";
  uses.has_escape = left_out != "escape";
  uses.has_energy = true;
  return uses;
}

/** What only some steps do. */
Uses in_step(int number, Uses uses) {
  uses.has_blocks = uses.has_energy && number % 4 == 1;
  uses.has_ropes = uses.has_energy && number % 3 == 2;
  return uses;
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  const std::string mode = argc > 1 ? argv[1] : "", left_out = argc > 2 ? argv[2] : "";
  const bool drops_memory = mode == "--drop-memory", is_explicit = mode == "--explicit";
  Uses uses, own_uses;
  if (mode == "--all" || mode == "--all-but") {
    uses = uses_without("");
    own_uses = uses_without(left_out);
    first_speed = 3;
    depth_cap = 0.004;
  }
  int failures = 0;
  {
    Ranks ranks;
    std::vector<uint64_t> found;
    double longest = 0;
    for (int number = 0; number < step_count; ++number) {
      if (number % steps_between_migrations == 0 && number > 0) {
        if (drops_memory)
          ranks.add_anew();
        else
          ranks.change_ranks(number);
      }
      say(number, own_uses, ranks);
      uint64_t bits = is_explicit ? explicit_step(ranks.host, ranks.system, &longest)
                                  : step(ranks.host, ranks.system, in_step(number, own_uses));
      MPI_Allreduce(MPI_IN_PLACE, &bits, 1, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
      found.push_back(bits);
    }
    uint64_t counts[] = {ranks.moved, ranks.system.joined};
    MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
    if (ranks.rank == 0) {
      Host host;
      for (uint32_t number = 0; number < body_count; ++number) host[key_of(number)] = first_state(number);
      PlainSystem plain(host);
      Looks looks;
      int first_other = step_count;
      double shortest = 1;
      for (int number = 0; number < step_count; ++number) {
        say(number, uses, plain);
        const uint64_t bits =
            is_explicit ? explicit_step(host, plain, &longest) : step(host, plain, in_step(number, uses), &looks);
        if (bits != found[static_cast<std::size_t>(number)] && first_other == step_count) first_other = number;
        shortest = std::min(shortest, longest);
      }
      std::printf(
          "%d ranks: the last step's bits are %016llx, equal up to step %d of %d; %llu bodies moved, in all steps %llu "
          "parts between bodies, %llu on the floor, %llu of whole bodies\n",
          ranks.size, static_cast<unsigned long long>(found.back()), first_other, step_count,
          static_cast<unsigned long long>(counts[0]), static_cast<unsigned long long>(plain.between_bodies),
          static_cast<unsigned long long>(plain.on_floor), static_cast<unsigned long long>(plain.pushes));
      if (uses.looks_again)
        std::printf("%llu second looks found more; %llu ghosts joined within steps\n",
                    static_cast<unsigned long long>(looks.more), static_cast<unsigned long long>(counts[1]));
      if (is_explicit) std::printf("the shortest of the longest stable steps: %.3g s\n", shortest);
      const auto expect = [&failures](bool condition, const char* what) {
        if (!condition) std::fprintf(stderr, "failed: %s\n", what), ++failures;
      };
      expect(plain.on_floor > 0 && plain.between_bodies > 1000 && plain.pushes > 0,
             "bodies touch one another and the floor, and some escape");
      expect(plain.wrong_sums == 0 && looks.wrong_products == 0, "parts add up to energy and products");
      if (drops_memory) {
        expect(first_other == steps_between_migrations, "without the memory of pairs the bits are others from then on");
      } else if (mode == "--all-but") {
        expect(first_other < step_count, "the bits are others");
      } else {
        expect(first_other == step_count, "the bits of one process");
        expect(ranks.size == 1 || counts[0] > body_count, "bodies move");
      }
      if (mode == "--all") {
        expect(looks.more > 0, "a second look finds more");
        expect(ranks.size == 1 || counts[1] > 0, "ghosts join within a step");
      }
      if (is_explicit) expect(shortest < 1, "contacts limit the step");
    }
  }
  MPI_Bcast(&failures, 1, MPI_INT, 0, MPI_COMM_WORLD);
  MPI_Finalize();
  return failures;
}
