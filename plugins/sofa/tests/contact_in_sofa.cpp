// SPDX-License-Identifier: MIT OR Apache-2.0
// The plugin in SOFA itself: forces against finite differences, the matrix against the product, energy, momentum,
// friction, ten tori in a bowl, the same bits after a reset, and what bad scenes are told. The other files: threads,
// topologies that change, self-collision.
#include <sofa/core/MechanicalParams.h>
#include <sofa/core/ObjectFactory.h>
#include <sofa/core/behavior/BaseLocalForceFieldMatrix.h>
#include <sofa/helper/system/PluginManager.h>
#include <sofa/simulation/common/init.h>
#include <sofa/simulation/graph/init.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "harness.hpp"

namespace {

const char* const usage =
    "Usage: contact_in_sofa [--load FILE]... folder\n"
    "Tests the plugin in SOFA. folder: the plugin's examples; FILE: a plugin's library to load before.\n"
    "Exit status: 0 all is well; 1 a check failed; 2 wrong usage.\n";

using Field = std::vector<Vectors>;  // of each state that contact pushes

Field read(Scene& scene, sofa::core::ConstVecDerivId id) {
  Field all;
  for (State* state : scene.pushed()) {
    const auto& values = state->read(id)->getValue();
    all.emplace_back(values.begin(), values.end());
  }
  return all;
}

void write(Scene& scene, sofa::core::VecDerivId id, const Field& values) {
  const auto states = scene.pushed();
  for (std::size_t k = 0; k < states.size(); ++k) {
    auto* vectors = states[k]->write(id)->beginEdit();
    vectors->assign(values[k].begin(), values[k].end());
    states[k]->write(id)->endEdit();
  }
}

Field filled(const Field& like, const std::function<double(int)>& number) {
  Field result = like;
  int k = 0;
  for (Vectors& vectors : result)
    for (auto& vector : vectors)
      for (int axis = 0; axis < 3; ++axis) vector[axis] = number(k++);
  return result;
}

double inner(const Field& a, const Field& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    for (std::size_t i = 0; i < a[k].size(); ++i) sum += dot(a[k][i], b[k][i]);
  return sum;
}

Field sum(const Field& a, double factor, const Field& b) {
  Field result = a;
  for (std::size_t k = 0; k < a.size(); ++k)
    for (std::size_t i = 0; i < a[k].size(); ++i) result[k][i] += b[k][i] * factor;
  return result;
}

sofa::core::MechanicalParams implicit_params() {
  sofa::core::MechanicalParams params;
  params.setImplicit(true);
  params.setX(vec_id::read_access::position);
  params.setV(vec_id::read_access::velocity);
  params.setDx(vec_id::read_access::dx);
  return params;
}

Field forces_at(Scene& scene, const Field& v) {
  write(scene, vec_id::write_access::velocity, v);
  write(scene, vec_id::write_access::force, filled(v, [](int) { return 0.0; }));
  const auto params = implicit_params();
  scene.field()->addForce(&params, vec_id::write_access::force);
  return read(scene, vec_id::read_access::force);
}

/** Adds to a dense matrix. */
class Dense : public sofa::core::behavior::DampingMatrixAccumulator {
 public:
  std::map<std::pair<long, long>, double> entries;
  using sofa::core::MatrixAccumulatorInterface::add;
  void add(sofa::SignedIndex row, sofa::SignedIndex column, float value) override { entries[{row, column}] += value; }
  void add(sofa::SignedIndex row, sofa::SignedIndex column, double value) override { entries[{row, column}] += value; }
};

void derivatives(const std::string& folder, const std::string& folds) {
  Scene scene(scene_of(two_cubes(folder), "stiffness='1e5' friction='0.4' foldMappings='" + folds + "'"));
  scene.run(2);
  const Field v = read(scene, vec_id::read_access::velocity);
  const Field d = filled(v, [](int k) { return 0.01 * std::sin(1.0 + 7.0 * k); });
  const Field f = forces_at(scene, v);
  const double h = 1e-3, dt = scene.root->getDt();
  const Field after = forces_at(scene, sum(v, h, d));
  const double high = scene.field()->getPotentialEnergy(nullptr);
  const Field before = forces_at(scene, sum(v, -h, d));
  const double low = scene.field()->getPotentialEnergy(nullptr);
  const double work = inner(f, d);
  check(std::abs((low - high) / (2 * h * dt) - work) < 1e-6 * std::abs(work), "force against the energy's difference",
        (low - high) / (2 * h * dt), work);

  write(scene, vec_id::write_access::dx, d);
  write(scene, vec_id::write_access::force, filled(v, [](int) { return 0.0; }));
  auto params = implicit_params();
  params.setBFactor(1);
  scene.field()->addMBKdx(&params, vec_id::write_access::force);
  const Field product = read(scene, vec_id::read_access::force);
  const double size = std::sqrt(inner(product, product));
  const Field wrong = sum(sum(after, -1, before), -2 * h, product);
  check(size > 0.1 && std::sqrt(inner(wrong, wrong)) < 1e-8 * size, "product against the forces' difference",
        std::sqrt(inner(wrong, wrong)), size);
  check(inner(product, d) < 0, "product is dissipative", inner(product, d));

  const auto states = scene.pushed();
  std::map<std::pair<State*, State*>, Dense> parts;
  sofa::core::behavior::DampingMatrix matrix;
  for (State* a : states)
    for (State* b : states) matrix.setMatrixAccumulator(&parts[{a, b}], a, b);
  scene.field()->buildDampingMatrix(&matrix);
  Field by_matrix = filled(v, [](int) { return 0.0; });
  for (std::size_t a = 0; a < states.size(); ++a)
    for (std::size_t b = 0; b < states.size(); ++b)
      for (const auto& [place, value] : parts[{states[a], states[b]}].entries)
        by_matrix[a][place.first / 3][place.first % 3] += value * d[b][place.second / 3][place.second % 3];
  const Field rest = sum(by_matrix, -1, product);
  check(std::sqrt(inner(rest, rest)) < 1e-11 * size, "matrix against the product", std::sqrt(inner(rest, rest)), size);
}

/** Past the mappings or through them, bodies go the same way, also where springs hold their skins. */
void the_same_past_mappings(const std::string& folder, const std::string& on_skins) {
  const auto scene_with = [&](const std::string& option) {
    std::string text = scene_of(two_cubes(folder), "stiffness='1e5' friction='0.4' " + option);
    for (std::size_t at = 0; (at = text.find("<TriangleCollisionModel/>", at)) != std::string::npos; at += 1)
      text.insert(at, on_skins), at += on_skins.size();
    return text;
  };
  Scene past(scene_with("")), through(scene_with("foldMappings='0'"));
  past.run(30), through.run(30);
  double apart = 0;
  for (int body = 0; body < 2; ++body) {
    const auto& a = past.bodies()[body]->read(vec_id::read_access::position)->getValue();
    const auto& b = through.bodies()[body]->read(vec_id::read_access::position)->getValue();
    for (std::size_t k = 0; k < a.size(); ++k) apart = std::max(apart, (a[k] - b[k]).norm());
  }
  check(apart < 1e-8, "past mappings as through them", apart, 1e-8);
}

void momentum_and_energy(const std::string& folder) {
  Scene scene(
      scene_of(cube(folder, "A", "0 0 0") + cube(folder, "B", "0.41 0.13 0.07"), "stiffness='1e5' friction='0.3'"));
  auto* first = scene.bodies()[0];
  auto* v = first->write(vec_id::write_access::velocity)->beginEdit();
  for (auto& velocity : *v) velocity = sofa::type::Vec3(1, 0, 0);
  first->write(vec_id::write_access::velocity)->endEdit();
  double highest = 0;
  sofa::type::Vec3 momentum(0, 0, 0);
  for (int step = 0; step < 60; ++step) {
    scene.run(1);
    double kinetic = 0;
    momentum.clear();
    for (State* body : scene.bodies())
      for (const auto& velocity : body->read(vec_id::read_access::velocity)->getValue()) {
        kinetic += 0.5 * 10.0 / 64 * velocity.norm2();
        momentum += velocity * (10.0 / 64);
      }
    highest = std::max(highest, kinetic);
  }
  check(highest <= 5 * (1 + 1e-9), "an impact brings in no energy", highest, 5);
  check((momentum - sofa::type::Vec3(10, 0, 0)).norm() < 1e-9, "momentum after an impact", momentum[0], 10);
  const auto& hit = scene.bodies()[1]->read(vec_id::read_access::velocity)->getValue();
  check(hit[0][0] > 0.2, "the body that was hit moves", hit[0][0]);
}

void friction(const std::string& folder, const char* coefficient, bool holds) {
  Scene scene(scene_of(cube(folder, "Box", "0 0.199 0") + floor_of(folder),
                       std::string("stiffness='1e5' friction='") + coefficient + "'", "1.94895 -9.61445 0"));
  const auto place = [&] {
    double mean = 0;
    const auto& x = scene.bodies()[0]->read(vec_id::read_access::position)->getValue();
    for (const auto& point : x) mean += point[0] / double(x.size());
    return mean;
  };
  scene.run(100);
  const double at_one = place();
  scene.run(100);
  const double way = place() - at_one;
  // From 1 s to 2 s: g (sin - mu cos) (2² - 1²) / 2.
  const double expected = holds ? 0 : (1.94895 - 0.1 * 9.61445) * 1.5;
  check(std::abs(way - expected) < (holds ? 0.002 : 0.1 * expected),
        holds ? "friction holds" : "it slides as it should", way, expected);
}

void ten_tori(const std::string& folder) {
  const std::string path = folder + "/ten_tori_common_solver.scn";
  const Node::SPtr root = sofa::simulation::node::load(path);
  sofa::simulation::node::initRoot(root.get());
  for (int step = 0; step < 300; ++step) sofa::simulation::node::animate(root.get(), 0.02);
  double fastest = 0, lowest = 1e9, furthest = 0;
  for (auto* mass : root->getTreeObjects<sofa::core::behavior::BaseMass>()) {
    auto* state = dynamic_cast<State*>(mass->getContext()->getMechanicalState());
    for (const auto& v : state->read(vec_id::read_access::velocity)->getValue())
      fastest = std::max(fastest, double(v.norm()));
    for (const auto& x : state->read(vec_id::read_access::position)->getValue()) {
      lowest = std::min(lowest, double(x[1]));
      furthest = std::max({furthest, std::abs(double(x[0])), std::abs(double(x[2]))});
    }
  }
  check(fastest < 30, "ten tori settle: the fastest node after 6 s", fastest, 30);
  check(lowest > -13 && furthest < 37.5, "ten tori stay in the bowl", lowest, furthest);
  sofa::simulation::node::unload(root);
}

void the_same_bits(const std::string& folder) {
  const std::string text = scene_of(two_cubes(folder), "stiffness='1e5' friction='0.4'");
  Scene scene(text), other(text);
  scene.run(30);
  other.run(30);
  const uint64_t first = bits_of(scene);
  check(first == bits_of(other), "two runs have the same bits");
  scene.run(7);
  sofa::simulation::node::reset(scene.root.get());
  scene.run(30);
  check(first == bits_of(scene), "a run after a reset has the same bits");
}

void bad_scenes(const std::string& folder) {
  const auto log_of = [](const std::string& text, const std::function<void(Scene&)>& spoil) {
    the_log.errors.clear(), the_log.warnings.clear();
    Scene scene(text);
    scene.run(1);
    spoil(scene);
    scene.run(2);
  };
  const auto nothing = [](Scene&) {};
  std::string text = scene_of(two_cubes(folder), "");
  const auto replaced = [](std::string all, const std::string& part, const std::string& by) {
    return all.replace(all.find(part), part.size(), by);
  };
  log_of(replaced(text, "<MeshTopology src='@file'/>", "<MeshTopology/>"), nothing);
  check(Log::has(the_log.errors, "has no triangles"), "a model without triangles is told");
  log_of(replaced(text, "<RaycontactNarrowPhase name='narrowPhase'/>", "<RayTraceNarrowPhase/>"), nothing);
  check(Log::has(the_log.errors, "links to nothing"), "a link to nothing is told");
  log_of(replaced(text, "name='narrowPhase'", "name='narrowPhase' publishContacts='1'"), nothing);
  check(Log::has(the_log.warnings, "SOFA's own response pushes too"), "two responses at once are told");
  log_of(replaced(text, "/meshes/box.obj", "/meshes/floor.obj"), nothing);
  check(Log::has(the_log.warnings, "open surface that moves"), "an open surface that moves is told");
  log_of(text, [](Scene& scene) {
    auto* state = scene.bodies()[1];
    (*state->write(vec_id::write_access::velocity)->beginEdit())[5][1] = std::numeric_limits<double>::quiet_NaN();
    state->write(vec_id::write_access::velocity)->endEdit();
  });
  check(Log::has(the_log.errors, "is not finite"), "NaN is told");
  std::string explicit_text = replaced(text, "<RaycontactForceField name='contact' />", "");
  explicit_text =
      replaced(explicit_text, "<Node name='Bodies'>", "<RaycontactForceField name='contact'/><Node name='Bodies'>");
  log_of(explicit_text, nothing);
  check(Log::has(the_log.warnings, "the response is explicit"), "an explicit response is told");
}

}  // namespace

int main(int count, char** arguments) {
  std::string folder;
  std::vector<std::string> plugins;
  for (int i = 1; i < count; ++i) {
    const std::string argument = arguments[i];
    if (argument == "--help") return std::fputs(usage, stdout) < 0;
    if (argument == "--load" && i + 1 < count)
      plugins.push_back(arguments[++i]);
    else if (argument[0] != '-' && folder.empty())
      folder = argument;
    else {
      std::fprintf(stderr, "contact_in_sofa: unknown option or second folder '%s'\n", argument.c_str());
      folder.clear(), i = count;
    }
  }
  if (folder.empty()) {
    std::fputs(usage, stderr);
    return 2;
  }
  sofa::simulation::common::init();
  sofa::simulation::graph::init();
  for (const std::string& plugin : plugins) sofa::helper::system::PluginManager::getInstance().loadPluginByPath(plugin);
  for (auto& [path, plugin] : sofa::helper::system::PluginManager::getInstance().getPluginMap())
    sofa::core::ObjectFactory::getInstance()->registerObjectsFromPlugin(plugin.getModuleName());
  sofa::helper::logging::MessageDispatcher::addHandler(&the_log);
  derivatives(folder, "1");
  derivatives(folder, "0");
  the_same_past_mappings(folder, "");
  the_same_past_mappings(folder, "<RestShapeSpringsForceField points='0 1 2' stiffness='1e4'/>");
  momentum_and_energy(folder);
  friction(folder, "0.5", true);
  friction(folder, "0.1", false);
  the_same_bits(folder);
  threads(folder);
  bad_scenes(folder);
  ten_tori(folder);
  self_collision(folder);
  topology_changes(folder);
  std::printf("%d checks failed\n", failures);
  return failures == 0 ? 0 : 1;
}
