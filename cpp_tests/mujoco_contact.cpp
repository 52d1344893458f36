// The adapter in MuJoCo itself: what it foresees is what MuJoCo's step does, its nodes move as MuJoCo's, its skins are
// MuJoCo's, rigid geoms stay MuJoCo's, and what it cannot do it refuses without ending the program.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "expect.hpp"
#include "raycontact/mujoco.hpp"

using namespace raycontact::mujoco;

namespace {

struct Free {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
  void operator()(mjData* d) const { mj_deleteData(d); }
};
using Model = std::unique_ptr<mjModel, Free>;
using Data = std::unique_ptr<mjData, Free>;

std::string warnings;

Model load(const std::string& xml) {
  char message[1000] = "";
  mjSpec* spec = mj_parseXMLString(xml.c_str(), nullptr, message, sizeof message);
  mjModel* m = spec == nullptr ? nullptr : mj_compile(spec, nullptr);
  if (m == nullptr) std::fprintf(stderr, "%s%s\n", message, spec == nullptr ? "" : mjs_getError(spec));
  mj_deleteSpec(spec);
  if (m == nullptr) std::exit(1);
  return Model(m);
}

std::string block(const std::string& name, const std::string& place, const std::string& more = "",
                  const std::string& contact = "contype=\"0\"") {
  return "<flexcomp name=\"" + name +
         "\" type=\"grid\" dim=\"3\" count=\"4 4 4\" spacing=\"0.1 0.1 0.1\" mass=\"10\" radius=\"0.001\" pos=\"" +
         place + "\" " + more +
         "<elasticity young=\"1e5\" poisson=\"0.3\" damping=\"0.005\"/><contact selfcollide=\"none\" " + contact + "/>";
}

std::string model(const std::string& bodies, const std::string& more = "",
                  const std::string& option = "integrator=\"discrete\"") {
  return "<mujoco>" + more + "<option timestep=\"0.005\" tolerance=\"1e-12\" iterations=\"1000\" " + option +
         "/><worldbody>" + bodies + "</worldbody></mujoco>";
}

// A block on a hinged arm, one side of it pinned to the arm, and a free block that falls onto it.
std::string arm_and_block() {
  return model(
      "<body name=\"arm\"><joint name=\"hinge\" axis=\"0 1 0\"/><geom type=\"capsule\" size=\"0.02\" fromto=\"-1 0 0 "
      "-0.3 0 0\" "
      "mass=\"3\" contype=\"0\" conaffinity=\"0\"/>" +
      block("held", "0 0 0", "><pin grid=\"0 0 0 0 1 0 0 2 0 0 3 0 0 0 1 0 1 1 0 2 1 0 3 1\"/>") +
      "</flexcomp></body>" + block("free", "0.05 0.02 0.32", ">") + "</flexcomp>");
}

std::string skins(const char* dof) {
  const std::string common =
      std::string(
          "\" type=\"grid\" dim=\"3\" count=\"7 7 7\" spacing=\"0.1 0.1 0.1\" cellcount=\"2 3 2\" mass=\"10\" "
          "radius=\"0.001\" dof=\"") +
      dof +
      "\"><elasticity young=\"1e5\" poisson=\"0.3\" damping=\"0.005\"/><contact contype=\"0\" "
      "selfcollide=\"none\"/></flexcomp>";
  return model("<flexcomp name=\"a\" pos=\"0 0 0" + common + "<flexcomp name=\"b\" pos=\"0.1 0.05 0.4" + common);
}

// Cells whose inner nodes follow those of the shell.
std::string shells() {
  return model(
      "<flexcomp name=\"a\" type=\"grid\" dim=\"3\" count=\"7 7 7\" spacing=\"0.1 0.1 0.1\" cellcount=\"4 3 3\" "
      "mass=\"10\" radius=\"0.001\" dof=\"trilinear\"><elasticity young=\"1e4\" poisson=\"0.3\" elastic2d=\"bend\" "
      "thickness=\"0.02\"/>"
      "<edge equality=\"strain\"/><contact contype=\"0\" selfcollide=\"none\"/></flexcomp>", "", "");
}

/** Positions at the end of a run. */
std::vector<double> run(const mjModel* m, mjData* d, int steps) {
  for (int step = 0; step < steps; ++step) mj_step(m, d);
  return {d->qpos, d->qpos + m->nq};
}

/** Velocities that bend all there is. */
void stir(const mjModel* m, mjData* d, double size) {
  for (int k = 0; k < m->nv; ++k) d->qvel[k] = size * std::sin(1.7 * k);
}

void velocities_are_those_of_mujoco(const char* test, const std::string& xml) {
  const Model m = load(xml);
  const Data d(mj_makeData(m.get()));
  ContactOptions options;
  options.tolerance = 1e-9;
  const AttachedContact attached(m.get(), d.get(), options);
  int touched = 0;
  for (int step = 0; step < 60; ++step) {
    // A force of the program's own is foreseen too.
    d->qfrc_applied[m->nv - 1] = 0.3;
    d->xfrc_applied[6 * (m->nbody - 1)] = 0.2;
    mj_step(m.get(), d.get());
    if (attached.contact().last_step().solves == 0) continue;
    ++touched;
    double wrong = 0, size = 0;
    for (int k = 0; k < m->nv; ++k) {
      wrong = std::max(wrong,
                       std::fabs(attached.contact().foreseen_velocities()[static_cast<std::size_t>(k)] - d->qvel[k]));
      size = std::max(size, std::fabs(d->qvel[k]));
    }
    expect(wrong < 1e-6 * size, test, "foresees velocities; they are wrong by " + std::to_string(wrong / size));
  }
  expect(touched > 5, test, "touches, in " + std::to_string(touched) + " steps");
  expect(attached.error().empty(), test, attached.error());
}

// A node's velocity is the difference of its places, whatever joints are above it.
void nodes_move_as_in_mujoco() {
  const char* test = "nodes";
  const Model m = load(arm_and_block());
  const Data d(mj_makeData(m.get()));
  stir(m.get(), d.get(), 0.3);
  for (int step = 0; step < 20; ++step) mj_step(m.get(), d.get());
  NodeMotion motion;
  for (int flex = 0; flex < m->nflex; ++flex) {
    const FlexNodes nodes = nodes_of(m.get(), flex);
    for (std::size_t n = 0; n < nodes.count; ++n) motion.add(m.get(), nodes.bodies[n], nodes.places + 3 * n);
  }
  const std::vector<double> velocity(d->qvel, d->qvel + m->nv), start(d->qpos, d->qpos + m->nq);
  std::vector<double> moved(3 * motion.size()), places[2];
  const double small = 1e-6;
  for (int side = 0; side < 2; ++side) {
    std::copy(start.begin(), start.end(), d->qpos);
    mj_integratePos(m.get(), d->qpos, velocity.data(), side == 0 ? -small : small);
    mj_kinematics(m.get(), d.get());
    mj_comPos(m.get(), d.get());
    motion.renew(m.get(), d.get());
    places[side] = motion.positions();
  }
  std::copy(start.begin(), start.end(), d->qpos);
  mj_kinematics(m.get(), d.get());
  mj_comPos(m.get(), d.get());
  motion.renew(m.get(), d.get());
  motion.to_nodes(velocity, moved);
  double fastest = 0;
  for (std::size_t k = 0; k < moved.size(); ++k) {
    expect_near(moved[k], (places[1][k] - places[0][k]) / (2 * small), 1e-7, test, "a node's velocity");
    fastest = std::max(fastest, std::fabs(moved[k]));
  }
  expect(fastest > 0.1, test, "moves");
  // Forces have the power that they have on the nodes.
  std::vector<double> force(moved.size()), dofs(velocity.size());
  for (std::size_t k = 0; k < force.size(); ++k) force[k] = std::cos(2.3 * static_cast<double>(k));
  motion.add_to_dofs(force, dofs);
  double on_nodes = 0, on_dofs = 0;
  for (std::size_t k = 0; k < force.size(); ++k) on_nodes += force[k] * moved[k];
  for (std::size_t k = 0; k < dofs.size(); ++k) on_dofs += dofs[k] * velocity[k];
  expect_near(on_nodes, on_dofs, 1e-10 * (1 + std::fabs(on_nodes)), test, "power");
}

// Skins are where MuJoCo has them, in any deformation.
void surfaces_are_those_of_mujoco(const std::string& xml) {
  const char* test = "surfaces";
  const Model m = load(xml);
  const Data d(mj_makeData(m.get()));
  stir(m.get(), d.get(), 1);
  for (int step = 0; step < 5; ++step) mj_step(m.get(), d.get());
  mj_forward(m.get(), d.get());
  for (int flex = 0; flex < m->nflex; ++flex) {
    const FlexSurface surface = surface_of(m.get(), flex);
    const FlexNodes nodes = nodes_of(m.get(), flex);
    NodeMotion motion;
    for (std::size_t n = 0; n < nodes.count; ++n) motion.add(m.get(), nodes.bodies[n], nodes.places + 3 * n);
    motion.renew(m.get(), d.get());
    for (std::size_t v = 0; v < surface.vertices.size(); ++v)
      for (std::size_t k = 0; k < 3; ++k) {
        double x = 0;
        for (uint32_t e = surface.offsets[v]; e < surface.offsets[v + 1]; ++e)
          x += surface.weights[e] * motion.positions()[3 * surface.nodes[e] + k];
        expect_near(x,
                    d->flexvert_xpos[3 * (static_cast<std::size_t>(m->flex_vertadr[flex]) + surface.vertices[v]) + k],
                    1e-12, test, "a vertex");
      }
    expect(!surface.vertices.empty(), test, "has vertices");
  }
}

// Young's modulus is that of the XML, to within what its description says.
void elasticity_is_found() {
  for (const std::string& xml : {arm_and_block(), skins("trilinear"), skins("quadratic")}) {
    const Model m = load(xml);
    for (int flex = 0; flex < m->nflex; ++flex)
      expect_near(moduli_of(m.get(), flex).youngs(), 1e5, 2e4, "elasticity", "Young's modulus");
  }
  // E / (3 (1 - 2 nu)): near incompressibility the bulk decides.
  for (const char* poisson : {"0.3", "0.45"}) {
    const double bulk = 1e5 / (3 * (1 - 2 * std::atof(poisson)));
    for (std::string xml : {arm_and_block(), skins("trilinear"), skins("quadratic")}) {
      for (std::size_t at = 0; (at = xml.find("poisson=\"0.3\"", at)) != std::string::npos; at += 5)
        xml.replace(at + 9, 3, poisson);
      const Model m = load(xml);
      for (int flex = 0; flex < m->nflex; ++flex) {
        expect_near(moduli_of(m.get(), flex).bulk, bulk, 0.05 * bulk, "elasticity", "bulk modulus");
        expect_near(moduli_of(m.get(), flex).pressure(), std::max(1e5, bulk), 2e4, "elasticity", "pressure");
      }
    }
  }
}

// A bar whose edges are held is pulled at one end: it gives way as the modulus says that was found from its edges.
void held_edges_are_a_stiffness() {
  const char* test = "held edges";
  std::string pins;
  for (int y = 0; y < 4; ++y)
    for (int z = 0; z < 4; ++z) pins += "0 " + std::to_string(y) + " " + std::to_string(z) + " ";
  const Model m = load(
      "<mujoco><option timestep=\"0.002\" iterations=\"200\" gravity=\"0 0 0\"/><worldbody><flexcomp "
      "name=\"bar\" type=\"grid\" dim=\"3\" count=\"9 4 4\" spacing=\"0.1 0.1 0.1\" mass=\"10\" radius=\"0.001\"><edge "
      "equality=\"true\"/><contact contype=\"0\" selfcollide=\"none\"/><pin grid=\"" +
      pins + "\"/></flexcomp></worldbody></mujoco>");
  const Data d(mj_makeData(m.get()));
  mj_forward(m.get(), d.get());
  const std::vector<mjtNum> start(d->flexvert_xpos, d->flexvert_xpos + 3 * m->nflexvert);
  // Ends of the bar: its corners pull as far as they stand for its cross section, which is all that bears.
  const double stress = 100, area = 0.09;
  std::vector<std::pair<int, double>> pulled;
  double shares = 0;
  for (int v = 0; v < m->nflexvert; ++v) {
    if (start[3 * std::size_t(v)] < 0.4 - 1e-9) continue;
    double share = 1;
    for (int k = 1; k < 3; ++k)
      if (std::fabs(start[3 * std::size_t(v) + std::size_t(k)]) > 0.15 - 1e-9) share /= 2;
    pulled.emplace_back(m->flex_vertbodyid[v], share), shares += share;
  }
  for (const auto& [body, share] : pulled) d->xfrc_applied[6 * body] = stress * area * share / shares;
  for (int step = 0; step < 2000; ++step) mj_step(m.get(), d.get());
  double longer = 0;
  for (int v = 0; v < m->nflexvert; ++v)
    if (start[3 * std::size_t(v)] > 0.4 - 1e-9)
      longer += (d->flexvert_xpos[3 * v] - start[3 * std::size_t(v)]) / double(pulled.size());
  const double measured = stress / (longer / 0.8), found = moduli_of(m.get(), 0).youngs();
  expect(found > measured / 1.4 && found < measured * 1.4, test,
         "found " + std::to_string(found) + " Pa, measured " + std::to_string(measured));
}

std::string sheet(const std::string& name, const std::string& place, const std::string& more = "",
                  const std::string& pins = "",
                  const std::string& contact = "contype=\"2\" conaffinity=\"3\"") {
  return "<flexcomp name=\"" + name +
         "\" type=\"grid\" dim=\"2\" count=\"13 13 1\" spacing=\"0.05 0.05 0.05\" mass=\"1\" "
         "radius=\"0.001\" pos=\"" +
         place +
         "\" " + more +
         "><elasticity young=\"1e6\" poisson=\"0.3\" thickness=\"1e-3\" elastic2d=\"both\" damping=\"0.01\"/>" + pins +
         "<contact selfcollide=\"none\" " + contact + "/></flexcomp>";
}

// A net that is held at its border catches a block, whichever side of it was written first.
void sheets_meet_solids_on_their_front() {
  const char* test = "sheets";
  std::string border;
  for (int i = 0; i < 13; ++i)
    for (int k = 0; k < 13; ++k)
      if (i == 0 || k == 0 || i == 12 || k == 12) border += std::to_string(i) + " " + std::to_string(k) + " 0 ";
  std::vector<double> heights;
  for (const char* more : {"", "euler=\"180 0 0\""}) {
    const Model m = load(model(block("a", "0.01 0.02 0.2", ">") + "</flexcomp>" +
                               sheet("net", "0 0 0", more, "<pin grid=\"" + border + "\"/>")));
    const Data d(mj_makeData(m.get()));
    const AttachedContact attached(m.get(), d.get());
    expect(!attached.contact().is_sheet(0) && attached.contact().is_sheet(1), test, "which is open");
    run(m.get(), d.get(), 600);
    expect(attached.error().empty(), test, attached.error());
    std::array<double, 2> lowest{{1, 1}};
    for (std::size_t flex = 0; flex < 2; ++flex)
      for (int v = 0; v < m->flex_vertnum[flex]; ++v)
        lowest[flex] = std::min(lowest[flex], d->flexvert_xpos[3 * (m->flex_vertadr[flex] + v) + 2]);
    // It sags under 10 kg, and carries the block on its front.
    expect(lowest[1] > -0.25 && lowest[1] < -0.02, test, "sags to " + std::to_string(lowest[1]));
    expect_near(lowest[0], lowest[1], 0.01, test, "the block's lowest vertex beside the net's");
    double fastest = 0;
    for (int k = 0; k < m->nv; ++k) fastest = std::max(fastest, std::fabs(d->qvel[k]));
    expect(fastest < 0.1, test, "rests, but for " + std::to_string(fastest) + " m/s");
    heights.push_back(lowest[0]);
  }
  expect_near(heights[0], heights[1], 2e-3, test, "heights with either side up");
}

// A run begun anew, a forward pass in between, another mjData and the plugin: all the same bits.
void results_repeat() {
  const char* test = "repeats";
  const Model m = load(arm_and_block());
  const Data d(mj_makeData(m.get())), other(mj_makeData(m.get()));
  std::vector<double> first;
  {
    const AttachedContact attached(m.get(), d.get()), beside(m.get(), other.get());
    expect_refusal([&] { AttachedContact(m.get(), d.get()); }, test, "has a contact already");
    first = run(m.get(), d.get(), 80);
    mj_resetData(m.get(), d.get());
    expect(run(m.get(), d.get(), 80) == first, test, "after a reset");
    for (int step = 0; step < 80; ++step) {
      mj_forward(m.get(), other.get());
      mj_step(m.get(), other.get());
    }
    // mj_forward leaves a warm start of its own, from which the solver ends within its tolerance.
    double wrong = 0;
    for (int k = 0; k < m->nq; ++k)
      wrong = std::max(wrong, std::fabs(other->qpos[k] - first[static_cast<std::size_t>(k)]));
    expect(wrong < 1e-3, test, "with forward passes between, within " + std::to_string(wrong));
  }
  expect(mjcb_passive == nullptr, test, "leaves the callback as it was");

  register_plugin();
  const Model switched = load(arm_and_block().insert(
      8, "<extension><plugin plugin=\"raycontact.flex_contact\"><instance name=\"c\"/></plugin></extension>"));
  const Data from_xml(mj_makeData(switched.get()));
  expect(run(switched.get(), from_xml.get(), 80) == first, test, "by the plugin");
  mj_resetData(switched.get(), from_xml.get());
  expect(run(switched.get(), from_xml.get(), 80) == first, test, "by the plugin after a reset");
}

// A block lies on MuJoCo's floor, and another on it; friction holds it on a floor that leans.
void rigid_geoms_stay_with_mujoco() {
  const char* test = "floor";
  const Model m = load(model("<geom type=\"plane\" size=\"2 2 1\" euler=\"0 5 0\"/>" + block("a", "0 0 0.2", ">") +
                             "</flexcomp>" + block("b", "0 0 0.52", ">") + "</flexcomp>"));
  const Data d(mj_makeData(m.get()));
  const AttachedContact attached(m.get(), d.get());
  run(m.get(), d.get(), 400);
  expect(d->ncon > 0, test, "has contacts of MuJoCo's");
  for (int c = 0; c < d->ncon; ++c)
    expect(d->contact[c].geom[0] >= 0 || d->contact[c].geom[1] >= 0, test, "has a geom in each of them");
  expect(attached.contact().last_step().solves > 0, test, "has contact of flexes");
  const auto centre = [&](int flex) {
    std::array<double, 3> sum{};
    for (int v = 0; v < m->flex_vertnum[flex]; ++v)
      for (std::size_t k = 0; k < 3; ++k)
        sum[k] += d->flexvert_xpos[3 * static_cast<std::size_t>(m->flex_vertadr[flex] + v) + k] / m->flex_vertnum[flex];
    return sum;
  };
  const std::array<double, 3> before = centre(1);
  expect(before[2] > 0.35 && before[2] < 0.5, test, "carries the upper block at " + std::to_string(before[2]));
  run(m.get(), d.get(), 200);
  const std::array<double, 3> after = centre(1);
  expect_near(std::hypot(after[0] - before[0], after[1] - before[1], after[2] - before[2]), 0, 0.01, test,
              "way in a second");
}

void bad_input_is_refused() {
  const char* test = "refusals";
  const auto refused = [&](const std::string& xml, const ContactOptions& options, const std::string& part) {
    const Model m = load(xml);
    const Data d(mj_makeData(m.get()));
    expect_refusal([&] { AttachedContact(m.get(), d.get(), options); }, test, part);
    expect(mjcb_passive == nullptr, test, "leaves the callback alone");
  };
  const std::string one = block("a", "0 0 0", ">") + "</flexcomp>";
  const std::string rope =
      "<flexcomp name=\"rope\" type=\"grid\" dim=\"1\" count=\"5 1 1\" spacing=\"0.1 0.1 0.1\" radius=\"0.01\"/>";
  const std::string cloth =
      "<flexcomp name=\"cloth\" type=\"grid\" dim=\"2\" count=\"5 5 1\" spacing=\"0.1 0.1 0.1\" radius=\"0.01\"/>";
  refused(model("<geom size=\"1\"/>"), {}, "no flexes");
  refused(model(one + rope), {}, "flex 'rope' is of dim 1");
  ContactOptions options;
  options.pressure = 1e4;
  // Sheets meet solids on one side, and one another by MuJoCo's contact alone.
  refused(model(one + cloth), {}, "open sheets contype=\"2\" conaffinity=\"3\"");
  refused(model(one + block("b", "0 0 2", ">") + "</flexcomp>" + sheet("curtain", "0 0 1")), {},
          "flex 'curtain' is an open sheet with flex");
  refused(model(one + sheet("c", "0 0 1", "", "", "contype=\"0\"") + sheet("d", "0 0 2", "", "", "contype=\"0\"")), {},
          "flex 'c' and flex 'd' are open sheets, whose contact is MuJoCo's own");
  // A hole is closed where it is small enough; cloth is none.
  ContactOptions closing = options;
  closing.close_holes = 0.2;
  ContactOptions closing_alone;
  closing_alone.close_holes = 0.2;
  refused(model(one + cloth), closing, "close_holes is 0.2");
  refused(model(one + cloth), closing, "is taken as one where close_holes is 0");
  const std::string holed =
      "<flexcomp name=\"holed\" type=\"direct\" dim=\"2\" radius=\"0.01\" mass=\"1\" pos=\"0 0 1\" "
      "point=\"1 0 0 -1 0 0 0 1 0 0 -1 0 0 0 1 0 0 -1\" "
      "element=\"0 2 4 2 1 4 1 3 4 3 0 4 2 0 5 1 2 5 3 1 5\"><contact contype=\"0\"/></flexcomp>";
  {
    const Model m = load(model(holed));
    const Data d(mj_makeData(m.get()));
    expect(!AttachedContact(m.get(), d.get(), closing).contact().is_sheet(0), test, "closes a hole");
    expect(AttachedContact(m.get(), d.get()).contact().is_sheet(0), test, "is a sheet where no hole is to be closed");
  }
  {
    // What cells carry is a solid: an opening is a fault, or is closed.
    std::string celled = holed;
    celled.insert(celled.find(" radius"), " dof=\"trilinear\"");
    refused(model(celled), options, "set close_holes, to 0.1 say");
    const Model m = load(model(celled));
    const Data d(mj_makeData(m.get()));
    expect(!AttachedContact(m.get(), d.get(), closing).contact().is_sheet(0), test, "closes a hole of a skin");
  }
  std::string shell = holed;
  shell.insert(shell.find("<contact"), "<edge equality=\"true\"/>");
  refused(model(shell), closing_alone,
          "is no elastic solid from which a stiffness follows, and meets none; set `pressure`");
  options.flexes = {"a", "c"};
  refused(model(one), options, "no flex 'c'");
  options.flexes = {"a", "a"};
  refused(model(one), options, "named twice");
  options = {};
  options.damping_time = -1;
  refused(model(one), options, "damping_time is -1");
  options = {};
  options.sampling_value = -0.5;
  refused(model(one), options, "sampling_value");
  refused(model(block("a", "0 0 0", ">", "") + "</flexcomp>" + block("b", "0 0 0", ">", "") + "</flexcomp>"), {},
          "contype=\"0\"");
  refused(model(one, "", "integrator=\"RK4\""), {}, "RK4");
  refused(model(one + "<geom size=\"1\"/>", "<option><flag sleep=\"enable\"/></option>"), {}, "sleep");
  expect_refusal([] { check_version(3012001); }, test, "MuJoCo 3.12.1 is running");
  check_version(mj_version());

  // What is well can be named.
  options = {};
  options.flexes = {"a"};
  const Model m = load(model(one + rope));
  const Data d(mj_makeData(m.get()));
  const AttachedContact attached(m.get(), d.get(), options);
  run(m.get(), d.get(), 3);
  expect(attached.error().empty(), test, attached.error());

  // In XML: a warning, and the program goes on.
  for (const auto& [config, part] : {std::array<std::string, 2>{"<config key=\"flexes\" value=\"c\"/>", "no flex 'c'"},
                                     {"<config key=\"friction\" value=\"much\"/>", "friction=\"much\" is no number"},
                                     {"<config key=\"threads\" value=\"1.5\"/>", "threads must be a whole number"},
                                     {"", "flex 'rope' is of dim 1"}}) {
    warnings.clear();
    const Model from_xml =
        load(model(one + rope, "<extension><plugin plugin=\"raycontact.flex_contact\"><instance name=\"c\">" + config +
                                   "</instance></plugin></extension>"));
    const Data data(mj_makeData(from_xml.get()));
    run(from_xml.get(), data.get(), 3);
    expect(warnings.find(part) != std::string::npos, test,
           "the plugin warns \"" + warnings + "\", not \"" + part + "\"");
  }
}

// Positions that are no numbers: MuJoCo starts anew, and so does the contact.
void broken_states_are_told() {
  const char* test = "broken";
  const Model m = load(arm_and_block());
  const Data d(mj_makeData(m.get()));
  FlexContact contact(m.get());
  run(m.get(), d.get(), 1);
  mj_forward(m.get(), d.get());
  d->qvel[m->nv - 1] = std::nan("");
  std::vector<double> forces(static_cast<std::size_t>(m->nv));
  expect_refusal([&] { contact.add_forces(m.get(), d.get(), forces.data()); }, test, "of flex 'free' is not finite");
  expect(std::all_of(forces.begin(), forces.end(), [](double f) { return f == 0; }), test, "adds nothing");
  d->qvel[m->nv - 1] = 0;
  contact.add_forces(m.get(), d.get(), forces.data());
}

}  // namespace

int main() {
  mju_user_warning = [](const char* text) { warnings += text; };
  velocities_are_those_of_mujoco("arm", arm_and_block());
  velocities_are_those_of_mujoco("trilinear", skins("trilinear"));
  velocities_are_those_of_mujoco("quadratic", skins("quadratic"));
  nodes_move_as_in_mujoco();
  for (const char* dof : {"trilinear", "quadratic"}) surfaces_are_those_of_mujoco(skins(dof));
  surfaces_are_those_of_mujoco(arm_and_block());
  surfaces_are_those_of_mujoco(shells());
  held_edges_are_a_stiffness();
  sheets_meet_solids_on_their_front();
  elasticity_is_found();
  rigid_geoms_stay_with_mujoco();
  results_repeat();
  bad_input_is_refused();
  broken_states_are_told();
  return failures == 0 ? 0 : 1;
}
