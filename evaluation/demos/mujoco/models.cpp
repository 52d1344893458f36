// SPDX-License-Identifier: MIT OR Apache-2.0
// Models of MuJoCo's or of anyone's: which of them the adapter takes, and how one runs with either contact.
#include <time.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "raycontact/mujoco.hpp"

namespace {

using raycontact::mujoco::ContactOptions;
using raycontact::mujoco::FlexSurface;

struct Delete {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
  void operator()(mjData* d) const { mj_deleteData(d); }
};

struct Move {
  std::string flex;
  std::array<double, 3> by;
};

struct Options {
  std::vector<std::string> files;
  std::vector<Move> moves;
  ContactOptions contact;
  double seconds = 0, dt = 0;
};

void print_usage(FILE* out) {
  std::fputs(
      "usage: mujoco_models MODEL.xml... [--close-holes SHARE] [--pressure PASCALS]\n"
      "       mujoco_models MODEL.xml --run SECONDS [--dt SECONDS] [--move FLEX X Y Z]... [--depth METRES]\n"
      "                     [--damping-time SECONDS]\n\n"
      "Says of each model whether raycontact takes its flexes, and how many are taken. In the models as loaded,\n"
      "flexes are given contype=\"0\", and open sheets contype=\"2\" conaffinity=\"3\", as docs/mujoco.md asks for.\n"
      "With --run a model is stepped with MuJoCo's contact and with raycontact's, in turn, and a table compares them.\n"
      "--move shifts a flex first. Times are of the processor.\n"
      "Exit status: 0, or 1 where a run failed, 2 wrong usage or a model that does not load.\n",
      out);
}

std::unique_ptr<mjModel, Delete> load(const std::string& file, const Options& options) {
  char message[1000] = "";
  std::unique_ptr<mjModel, Delete> m(mj_loadXML(file.c_str(), nullptr, message, sizeof message));
  if (m == nullptr) throw std::runtime_error(std::string("MuJoCo does not load it: ") + message);
  if (options.dt > 0) m->opt.timestep = options.dt;
  for (const Move& move : options.moves) {
    const int flex = mj_name2id(m.get(), mjOBJ_FLEX, move.flex.c_str());
    if (flex < 0) throw std::runtime_error("there is no flex '" + move.flex + "'");
    const raycontact::mujoco::FlexNodes nodes = raycontact::mujoco::nodes_of(m.get(), flex);
    std::vector<int> bodies(nodes.bodies, nodes.bodies + nodes.count);
    std::sort(bodies.begin(), bodies.end());
    bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
    for (const int body : bodies) mju_addTo3(m->body_pos + 3 * body, move.by.data());
  }
  return m;
}

/** Leaves the contact of flexes to raycontact, but for that of two sheets. */
void separate(mjModel* m) {
  for (int flex = 0; flex < m->nflex; ++flex) {
    const bool is_sheet = m->flex_dim[flex] == 2 && m->flex_interp[flex] == 0;
    m->flex_contype[flex] = is_sheet ? 2 : 0;
    if (is_sheet) m->flex_conaffinity[flex] |= 2;
  }
}

double processor_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/** One model with one contact, and how deep its flexes are in one another. */
class Run {
 public:
  Run(const std::string& file, const Options& options, bool is_ours) : m_(load(file, options)) {
    if (is_ours) separate(m_.get());
    // A model that was written for raycontact has flexes that MuJoCo lets alone.
    for (int flex = 0; !is_ours && flex < m_->nflex; ++flex)
      if (m_->flex_contype[flex] == 0) m_->flex_contype[flex] = 1;
    d_.reset(mj_makeData(m_.get()));
    if (is_ours)
      contact_ = std::make_unique<raycontact::mujoco::AttachedContact>(m_.get(), d_.get(), options.contact);
    for (int flex = 0; flex < m_->nflex; ++flex) {
      Surface surface{flex, raycontact::mujoco::surface_of(m_.get(), flex), {}, nullptr, nullptr};
      try {
        rayc_mesh_options closing = raycontact::default_mesh_options();
        closing.close_holes = options.contact.close_holes;
        surface.mesh = std::make_unique<raycontact::Mesh>(raycontact::vectors(surface.flex.positions),
                                                          surface.flex.triangles, closing);
        surface.octree = std::make_unique<raycontact::Octree>(*surface.mesh);
      } catch (const raycontact::Error&) {
        // A sheet has no inside.
      }
      surfaces_.push_back(std::move(surface));
    }
  }

  double time() const { return d_->time; }

  void step() {
    const double start = processor_time();
    mj_step(m_.get(), d_.get());
    if (steps_++ > 0) taken_ += processor_time() - start;
    look();
  }

  void print(const char* who) const {
    std::printf("| %s | %.4f | %.4f | %d | %.2f |\n", who, deepest_, last_, inside_, 1e3 * taken_ / (steps_ - 1));
    if (contact_ != nullptr && !contact_->error().empty()) std::printf("%s\n", contact_->error().c_str());
  }

  bool has_failed() const { return contact_ != nullptr && !contact_->error().empty(); }

 private:
  struct Surface {
    int number;
    FlexSurface flex;
    std::vector<double> positions;
    std::unique_ptr<raycontact::Mesh> mesh;
    std::unique_ptr<raycontact::Octree> octree;
  };

  void look() {
    mj_kinematics(m_.get(), d_.get());
    mj_comPos(m_.get(), d_.get());
    mj_flex(m_.get(), d_.get());
    for (Surface& surface : surfaces_) {
      const mjtNum* first = d_->flexvert_xpos + 3 * m_->flex_vertadr[surface.number];
      surface.positions.clear();
      for (const uint32_t v : surface.flex.vertices)
        surface.positions.insert(surface.positions.end(), first + 3 * v, first + 3 * v + 3);
      if (surface.mesh == nullptr) continue;
      surface.mesh->set_positions(raycontact::vectors(surface.positions));
      surface.octree->update(*surface.mesh);
    }
    last_ = 0;
    inside_ = 0;
    std::vector<int32_t> turns;
    std::vector<rayc_closest_point> closest;
    for (const Surface& a : surfaces_)
      for (const Surface& b : surfaces_) {
        if (&a == &b || b.mesh == nullptr) continue;
        const rayc_vectors points = raycontact::vectors(a.positions);
        turns.resize(points.count);
        closest.resize(points.count);
        b.octree->winding_numbers(*b.mesh, points, turns);
        b.octree->closest_points(*b.mesh, points, closest);
        for (std::size_t v = 0; v < points.count; ++v)
          if (turns[v] != 0) ++inside_, last_ = std::max(last_, closest[v].distance);
      }
    deepest_ = std::max(deepest_, last_);
  }

  std::unique_ptr<mjModel, Delete> m_;
  std::unique_ptr<mjData, Delete> d_;
  std::unique_ptr<raycontact::mujoco::AttachedContact> contact_;
  std::vector<Surface> surfaces_;
  double taken_ = 0, deepest_ = 0, last_ = 0;
  int steps_ = 0, inside_ = 0;  // vertices, at the end
};

int compare(const Options& options) {
  Run theirs(options.files[0], options, false), ours(options.files[0], options, true);
  while (ours.time() < options.seconds) theirs.step(), ours.step();
  std::printf("| contact | deepest, m | at the end, m | inside at the end | ms a step |\n");
  std::printf("| --- | --- | --- | --- | --- |\n");
  ours.print("raycontact");
  theirs.print("mujoco");
  return ours.has_failed() ? 1 : 0;
}

int check(const Options& options) {
  int loaded = 0, taken = 0;
  for (const std::string& file : options.files) {
    std::string answer = "taken";
    try {
      const auto m = load(file, options);
      ++loaded;
      separate(m.get());
      raycontact::mujoco::FlexContact(m.get(), options.contact);
      ++taken;
    } catch (const std::exception& refused) {
      answer = refused.what();
    }
    std::printf("%s: %s\n", file.substr(file.rfind('/') + 1).c_str(), answer.c_str());
  }
  std::printf("%d of %zu load, %d are taken\n", loaded, options.files.size(), taken);
  return loaded > 0 ? 0 : 2;
}

double number(const char* text, const std::string& name) {
  char* end = nullptr;
  const double value = text == nullptr ? 0 : std::strtod(text, &end);
  if (text == nullptr || end == text || *end != '\0') throw std::invalid_argument(name + " needs numbers");
  return value;
}

}  // namespace

int main(int argc, char** argv) try {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const auto next = [&] { return number(++i < argc ? argv[i] : nullptr, argument); };
    if (argument == "--help" || argument == "-h") return print_usage(stdout), 0;
    if (argument == "--run") {
      options.seconds = next();
    } else if (argument == "--dt") {
      options.dt = next();
    } else if (argument == "--close-holes") {
      options.contact.close_holes = next();
    } else if (argument == "--pressure") {
      options.contact.pressure = next();
    } else if (argument == "--depth") {
      options.contact.depth = next();
    } else if (argument == "--damping-time") {
      options.contact.damping_time = next();
    } else if (argument == "--move") {
      Move move;
      if (++i < argc) move.flex = argv[i];
      for (double& by : move.by) by = next();
      options.moves.push_back(move);
    } else if (argument[0] == '-') {
      throw std::invalid_argument("unknown argument '" + argument + "'");
    } else {
      options.files.push_back(argument);
    }
  }
  if (options.files.empty()) throw std::invalid_argument("name a model");
  if (options.seconds > 0 && options.files.size() > 1) throw std::invalid_argument("name one model alone to run");
  return options.seconds > 0 ? compare(options) : check(options);
} catch (const std::invalid_argument& wrong) {
  std::fprintf(stderr, "mujoco_models: %s\n\n", wrong.what());
  print_usage(stderr);
  return 2;
} catch (const std::exception& error) {
  std::fprintf(stderr, "mujoco_models: %s\n", error.what());
  return 2;
}
