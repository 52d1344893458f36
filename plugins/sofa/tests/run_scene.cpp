// SPDX-License-Identifier: MIT OR Apache-2.0
// Runs a scene of SOFA without a window, and says how fast it went and what became of the bodies.
#include <sofa/component/collision/geometry/TriangleCollisionModel.h>
#include <sofa/core/ObjectFactory.h>
#include <sofa/core/behavior/BaseMechanicalState.h>
#include <sofa/core/objectmodel/Event.h>
#include <sofa/defaulttype/VecTypes.h>
#include <sofa/helper/system/PluginManager.h>
#include <sofa/simulation/CollisionBeginEvent.h>
#include <sofa/simulation/CollisionEndEvent.h>
#include <sofa/simulation/Node.h>
#include <sofa/simulation/Simulation.h>
#include <sofa/simulation/common/init.h>
#include <sofa/simulation/graph/init.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>
#include <vector>

#include "inverted_cells.hpp"

namespace {

using State = sofa::core::behavior::MechanicalState<sofa::defaulttype::Vec3Types>;
using sofa::simulation::Node;

const char* const usage =
    "Usage: run_scene [options] scene.scn\n"
    "Runs a scene of SOFA without a window. Prints one line: steps per second of processor time, milliseconds of a "
    "step and\n"
    "of the collision pipeline in it, the inverted hexahedra and tetrahedra of all steps, the box of the moving "
    "bodies'\n"
    "centres and the fastest node at the end, and a hash of all positions.\n"
    "  --steps N       how many (default 400)\n"
    "  --dt S          in place of the scene's own step\n"
    "  --load FILE     a plugin's library; may be given more than once\n"
    "  --set PATH=VALUE  a Data of a component, as in /Contact.stiffness=165; may be given more than once\n"
    "  --every N       prints the line every N steps too\n"
    "  --reset         runs twice, with a reset between; the second line is to equal the first\n"
    "  --obj FILE      writes the collision models at the end as a Wavefront file\n"
    "Exit status: 0 ran to its end; 1 a position was not finite, or the scene could not be loaded; 2 wrong usage.\n";

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

/** How long the collision pipeline works. */
class Stopwatch : public sofa::core::objectmodel::BaseComponent {
 public:
  SOFA_CLASS(Stopwatch, sofa::core::objectmodel::BaseComponent);
  double seconds = 0;
  Stopwatch() { f_listening.setValue(true); }
  void handleEvent(sofa::core::objectmodel::Event* event) override {
    if (sofa::simulation::CollisionBeginEvent::checkEventType(event)) begin_ = cpu_seconds();
    if (sofa::simulation::CollisionEndEvent::checkEventType(event)) seconds += cpu_seconds() - begin_;
  }

 private:
  double begin_ = 0;
};

struct Options {
  std::string scene, obj;
  int steps = 400, every = 0;
  double dt = 0;
  bool resets = false;
  std::vector<std::string> plugins, settings;
};

bool read(int count, char** arguments, Options& options) {
  for (int i = 1; i < count; ++i) {
    const std::string argument = arguments[i];
    const auto value = [&]() -> std::string { return i + 1 < count ? arguments[++i] : ""; };
    if (argument == "--steps")
      options.steps = std::atoi(value().c_str());
    else if (argument == "--every")
      options.every = std::atoi(value().c_str());
    else if (argument == "--dt")
      options.dt = std::atof(value().c_str());
    else if (argument == "--load")
      options.plugins.push_back(value());
    else if (argument == "--set")
      options.settings.push_back(value());
    else if (argument == "--obj")
      options.obj = value();
    else if (argument == "--reset")
      options.resets = true;
    else if (argument[0] != '-' && options.scene.empty())
      options.scene = argument;
    else {
      std::fprintf(stderr, "run_scene: unknown option or second scene '%s'\n", argument.c_str());
      return false;
    }
  }
  if (options.scene.empty()) std::fputs("run_scene: no scene\n", stderr);
  if (options.steps <= 0) std::fputs("run_scene: --steps takes a number above 0\n", stderr);
  return !options.scene.empty() && options.steps > 0;
}

bool set(Node* root, const std::string& setting) {
  const std::size_t equals = setting.find('='), dot = setting.rfind('.', equals);
  if (equals == std::string::npos || dot == std::string::npos) return false;
  std::string path = setting.substr(0, dot), data = setting.substr(dot + 1, equals - dot - 1);
  sofa::core::objectmodel::Base* component = nullptr;
  for (auto* candidate : root->getTreeObjects<sofa::core::objectmodel::BaseComponent>())
    if (candidate->getPathName() == path) component = candidate;
  auto* field = component != nullptr ? component->findData(data) : nullptr;
  return field != nullptr && field->read(setting.substr(equals + 1));
}

struct Summary {
  sofa::type::BoundingBox centres;
  double fastest = 0;
  uint64_t hash = 14695981039346656037u;
  bool is_finite = true;
};

/** Unmapped states are the bodies that move. */
Summary summary_of(Node* root) {
  Summary summary;
  for (auto* state : root->getTreeObjects<State>()) {
    const auto& x = state->read(sofa::core::vec_id::read_access::position)->getValue();
    const auto& v = state->read(sofa::core::vec_id::read_access::velocity)->getValue();
    for (const auto& point : x)
      for (int axis = 0; axis < 3; ++axis) {
        uint64_t bits;
        const double number = point[axis];
        summary.is_finite = summary.is_finite && std::isfinite(number);
        std::memcpy(&bits, &number, sizeof bits);
        summary.hash = (summary.hash ^ bits) * 1099511628211u;
      }
    const auto* node = dynamic_cast<Node*>(state->getContext());
    if (node->mechanicalMapping != nullptr || node->mass == nullptr) continue;
    sofa::type::Vec3 centre(0, 0, 0);
    for (const auto& point : x) centre += point / double(x.size());
    summary.centres.include(centre);
    for (const auto& velocity : v) summary.fastest = std::max(summary.fastest, double(velocity.norm()));
  }
  return summary;
}

void write_obj(Node* root, const std::string& path) {
  FILE* file = std::fopen(path.c_str(), "w");
  if (file == nullptr) return;
  std::size_t first = 1;
  using Model = sofa::component::collision::geometry::TriangleCollisionModel<sofa::defaulttype::Vec3Types>;
  for (auto* model : root->getTreeObjects<Model>()) {
    std::fprintf(file, "o %s\n", model->getContext()->getName().c_str());
    for (const auto& p : model->getX()) std::fprintf(file, "v %.9g %.9g %.9g\n", p[0], p[1], p[2]);
    for (const auto& t : model->getTriangles())
      std::fprintf(file, "f %zu %zu %zu\n", first + t[0], first + t[1], first + t[2]);
    first += model->getX().size();
  }
  std::fclose(file);
}

bool run(Node* root, Stopwatch& stopwatch, const Options& options) {
  const double dt = options.dt > 0 ? options.dt : double(root->getDt());
  root->setDt(dt);
  double seconds = 0;
  long inverted = 0;
  stopwatch.seconds = 0;
  for (int step = 1; step <= options.steps; ++step) {
    const double before = cpu_seconds();
    sofa::simulation::node::animate(root, dt);
    seconds += cpu_seconds() - before;
    inverted += inverted_cells(root);
    const bool is_last = step == options.steps;
    if (!is_last && (options.every == 0 || step % options.every != 0)) continue;
    const Summary summary = summary_of(root);
    const auto low = summary.centres.minBBox(), high = summary.centres.maxBBox();
    std::printf(
        "%d steps, %.1f/s, %.2f ms, collision %.2f ms, inverted %ld, centres %.3g..%.3g %.3g..%.3g %.3g..%.3g, "
        "fastest %.3g, hash %016llx\n",
        step, step / seconds, 1e3 * seconds / step, 1e3 * stopwatch.seconds / step, inverted, low[0], high[0], low[1],
        high[1], low[2], high[2], summary.fastest, static_cast<unsigned long long>(summary.hash));
    std::fflush(stdout);
    if (!summary.is_finite) {
      std::fprintf(stderr, "run_scene: a position is not finite after %d steps\n", step);
      return false;
    }
  }
  return true;
}

}  // namespace

int main(int count, char** arguments) {
  for (int i = 1; i < count; ++i)
    if (std::strcmp(arguments[i], "--help") == 0) return std::fputs(usage, stdout) < 0;
  Options options;
  if (!read(count, arguments, options)) {
    std::fputs(usage, stderr);
    return 2;
  }
  sofa::simulation::common::init();
  sofa::simulation::graph::init();
  for (const std::string& plugin : options.plugins)
    if (sofa::helper::system::PluginManager::getInstance().loadPluginByPath(plugin) !=
        sofa::helper::system::PluginManager::PluginLoadStatus::SUCCESS) {
      std::fprintf(stderr, "run_scene: cannot load %s\n", plugin.c_str());
      return 1;
    }
  for (auto& [path, plugin] : sofa::helper::system::PluginManager::getInstance().getPluginMap())
    sofa::core::ObjectFactory::getInstance()->registerObjectsFromPlugin(plugin.getModuleName());
  const Node::SPtr root = sofa::simulation::node::load(options.scene);
  if (root == nullptr) {
    std::fprintf(stderr, "run_scene: cannot load %s\n", options.scene.c_str());
    return 1;
  }
  for (const std::string& setting : options.settings)
    if (!set(root.get(), setting)) {
      std::fprintf(stderr, "run_scene: %s sets nothing\n", setting.c_str());
      return 2;
    }
  const auto stopwatch = sofa::core::objectmodel::New<Stopwatch>();
  root->addObject(stopwatch);
  sofa::simulation::node::initRoot(root.get());
  bool is_well = run(root.get(), *stopwatch, options);
  if (options.resets) {
    sofa::simulation::node::reset(root.get());
    is_well = run(root.get(), *stopwatch, options) && is_well;
  }
  if (!options.obj.empty()) write_obj(root.get(), options.obj);
  sofa::simulation::node::unload(root);
  return is_well ? 0 : 1;
}
