// SPDX-License-Identifier: MIT OR Apache-2.0
/** Contact between the flexes of a model: the force of a step, from an implicit solve in MuJoCo's own metric. */
#ifndef RAYCONTACT_MUJOCO_FLEX_CONTACT_HPP
#define RAYCONTACT_MUJOCO_FLEX_CONTACT_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "raycontact/mujoco/elasticity.hpp"
#include "raycontact/mujoco/flex_surface.hpp"
#include "raycontact/mujoco/implicit_metric.hpp"
#include "raycontact/mujoco/node_motion.hpp"
#include "raycontact/mujoco/options.hpp"
#include "raycontact/mujoco/sheet_front.hpp"

namespace raycontact::mujoco {

/** What the last step took. */
struct StepFigures {
  int solves = 0;             ///< 0: nothing touches
  int iterations = 0;         ///< of conjugate gradients, in all solves
  bool has_converged = true;  ///< false: a solve ended without its tolerance, and the force is rougher than that
};

/**
 * Contact between flexes of one model, for one mjData at a time: it remembers from step to step what friction holds on
 * to. Detection is where bodies would be at the end of the step, and the force is that at the step's end: it solves (M
 * + h D + h^2 K + h C) change = h force, with the stiffness K that MuJoCo's discrete integrator steps with and C that
 * of the contacts.
 */
class FlexContact {
 public:
  /** Throws std::invalid_argument, std::runtime_error or raycontact::Error saying what in the model is not supported.
   */
  explicit FlexContact(const mjModel* m, ContactOptions options = {}) : options_(std::move(options)), metric_(m) {
    check_version(mj_version());
    check_options(options_);
    check_model(m);
    for (const int flex : chosen_flexes(m)) {
      FlexSurface surface = surface_of(m, flex);
      bool is_sheet = false;
      Mesh mesh = mesh_of(m, flex, surface, is_sheet);
      Body body{flex, std::move(surface), std::move(mesh), {}, nodes_.size(), 0, is_sheet};
      const FlexNodes nodes = nodes_of(m, flex);
      for (std::size_t n = 0; n < nodes.count; ++n) nodes_.add(m, nodes.bodies[n], nodes.places + 3 * n);
      body.node_count = nodes.count;
      bodies_.push_back(std::move(body));
    }
    for (Body& body : bodies_)
      if (body.is_sheet) turn_to_solids(m, body);
    check_doubled_contact(m);
    choose_materials(m);
    sampling_value_ = sampling_value_of(m);
    const auto dofs = static_cast<std::size_t>(m->nv);
    for (Numbers* numbers : {&velocity_, &free_, &end_, &force_, &outer_, &smooth_, &residual_, &product_, &change_})
      numbers->assign(dofs, 0);
    for (Numbers* numbers : {&node_velocity_, &node_free_, &node_change_, &node_force_})
      numbers->assign(3 * nodes_.size(), 0);
    reset();
  }

  /** Forgets what is remembered from step to step: to be called where the state jumps. */
  void reset() {
    rayc_scene_options scene_options = default_scene_options();
    scene_options.threads = options_.threads;
    scene_ = std::make_unique<Scene>(scene_options);
    rayc_detection_options detection = default_detection_options();
    detection.sampling = options_.sampling;
    detection.sampling_value = sampling_value_;
    scene_->set_detection_options(detection);
    system_ = std::make_unique<ContactSystem>();
    system_->set_node_masses(nodes_.masses());
    for (const Body& body : bodies_) {
      const uint32_t number = scene_->add(body.mesh);
      system_->add_deformable(*scene_, number, static_cast<uint32_t>(body.first_node),
                              static_cast<uint32_t>(body.node_count),
                              Carriers{body.surface.offsets, body.surface.nodes, body.surface.weights}, body.material);
      if (options_.self_collision && !body.is_sheet) scene_->set_self_collision(number, true);
    }
    is_known_ = has_touched_ = false;
  }

  /**
   * Adds the contact forces to `qfrc`, nv numbers: mjData::qfrc_passive, from within mjcb_passive or a plugin's
   * compute. Asked again in the same state it adds the same forces. Throws raycontact::Error where positions are not
   * finite.
   */
  void add_forces(const mjModel* m, mjData* d, mjtNum* qfrc) {
    if (!is_same_state(m, d)) {
      // Time that has not gone on is another run.
      if (is_known_ && d->time <= time_) reset();
      is_known_ = false;
      std::fill(force_.begin(), force_.end(), 0.0);
      figures_ = StepFigures();
      find_forces(m, d);
      time_ = d->time;
      known_positions_.assign(d->qpos, d->qpos + m->nq);
      known_velocities_.assign(d->qvel, d->qvel + m->nv);
      is_known_ = true;
    }
    for (std::size_t k = 0; k < force_.size(); ++k) qfrc[k] += force_[k];
  }

  /** What the last step took. */
  const StepFigures& last_step() const { return figures_; }
  /** By degree of freedom, the velocities at the end of the last step as foreseen; a guess where nothing touched. */
  const std::vector<double>& foreseen_velocities() const { return figures_.solves > 0 ? end_ : free_; }
  /** How many flexes touch one another. */
  std::size_t flex_count() const { return bodies_.size(); }
  /** Whether flex `index` of those is an open sheet, which meets closed ones on its front. */
  bool is_sheet(std::size_t index) const { return bodies_[index].is_sheet; }
  /** The material of flex `index` of those, as given or as found. */
  const rayc_material& material(std::size_t index) const { return bodies_[index].material; }

 private:
  struct Body {
    int flex;
    FlexSurface surface;
    Mesh mesh;
    rayc_material material;
    std::size_t first_node, node_count;
    bool is_sheet;  // open: it meets closed bodies on its front
  };

  static void check_model(const mjModel* m) {
    const auto refuse = [](const std::string& what) { throw std::invalid_argument("raycontact: " + what); };
    if (m->nflex == 0) refuse("the model has no flexes; contact of rigid geoms is MuJoCo's own");
    if (m->opt.integrator == mjINT_RK4) refuse("the integrator RK4 asks for forces four times a step; take discrete");
    if ((m->opt.enableflags & mjENBL_SLEEP) != 0)
      refuse("flexes that sleep would not be woken; switch the flag sleep off");
    if ((m->opt.disableflags & mjDSBL_SPRING) != 0 && (m->opt.disableflags & mjDSBL_DAMPER) != 0)
      refuse("with the flags spring and damper both disabled MuJoCo asks for no passive forces; enable one");
  }

  std::vector<int> chosen_flexes(const mjModel* m) const {
    std::vector<int> flexes;
    for (const std::string& name : options_.flexes) {
      const int flex = mj_name2id(m, mjOBJ_FLEX, name.c_str());
      if (flex < 0) throw std::invalid_argument("raycontact: the model has no flex '" + name + "'");
      if (std::find(flexes.begin(), flexes.end(), flex) != flexes.end())
        throw std::invalid_argument("raycontact: flex '" + name + "' is named twice");
      flexes.push_back(flex);
    }
    if (options_.flexes.empty())
      for (int flex = 0; flex < m->nflex; ++flex) flexes.push_back(flex);
    return flexes;
  }

  Mesh mesh_of(const mjModel* m, int flex, const FlexSurface& surface, bool& is_sheet) const {
    rayc_mesh_options mesh_options = default_mesh_options();
    mesh_options.close_holes = options_.close_holes;
    const auto make = [&] { return Mesh(vectors(surface.positions), surface.triangles, mesh_options); };
    try {
      try {
        return make();
      } catch (const Error& error) {
        // What cells carry is the skin of a solid.
        const bool may_be_sheet = m->flex_dim[flex] == 2 && m->flex_interp[flex] == 0 && options_.close_holes == 0;
        if (error.status() != RAYC_STATUS_MESH_OPEN || !may_be_sheet) throw;
        mesh_options.open = is_sheet = true;
        return make();
      }
    } catch (const Error& error) {
      const char* advice = error.status() != RAYC_STATUS_MESH_OPEN ? ""
                           : options_.close_holes > 0 && m->flex_interp[flex] == 0
                               ? ". A sheet, such as cloth, is taken as one where close_holes is 0"
                               : ". Cells carry the skin of a solid: set close_holes, to 0.1 say, or mend the mesh";
      throw Error(error.status(), "raycontact: " + title_of(m, flex) + ": " + error.what() + advice);
    }
  }

  /** A sheet's front is the side on which closed flexes stand at first. */
  void turn_to_solids(const mjModel* m, Body& sheet) const {
    const std::vector<double> places = starting_positions(m, sheet.flex, sheet.surface);
    const Body *before = nullptr, *behind = nullptr;
    for (const Body& body : bodies_) {
      if (body.is_sheet) continue;
      std::array<double, 3> centre{};
      const std::vector<double> points = starting_positions(m, body.flex, body.surface);
      for (std::size_t k = 0; k < points.size(); ++k) centre[k % 3] += 3 * points[k] / double(points.size());
      (angle_of_sheet(places, sheet.surface.triangles, centre) > 0 ? before : behind) = &body;
    }
    if (before != nullptr && behind != nullptr)
      throw std::invalid_argument("raycontact: " + title_of(m, sheet.flex) + " is an open sheet with " +
                                  title_of(m, before->flex) + " on one side and " + title_of(m, behind->flex) +
                                  " on the other; name it with those on one side in `flexes`, and leave its contact "
                                  "with others to MuJoCo");
    if (behind == nullptr) return;
    sheet.surface.turn();
    rayc_mesh_options mesh_options = default_mesh_options();
    mesh_options.open = true;
    sheet.mesh = Mesh(vectors(sheet.surface.positions), sheet.surface.triangles, mesh_options);
  }

  /** Two answers to one contact do not add up, and sheets that meet want one. */
  void check_doubled_contact(const mjModel* m) const {
    for (const Body& a : bodies_)
      for (const Body& b : bodies_) {
        const bool is_looked_at =
            !a.is_sheet && options_.self_collision && m->flex_selfcollide[a.flex] != mjFLEXSELF_NONE;
        if (a.flex == b.flex && !is_looked_at) continue;
        const auto meet = [&](int from, int to) { return (m->flex_contype[from] & m->flex_conaffinity[to]) != 0; };
        if (a.is_sheet && b.is_sheet) {
          if (!meet(a.flex, b.flex) && !meet(b.flex, a.flex))
            throw std::invalid_argument("raycontact: " + title_of(m, a.flex) + " and " + title_of(m, b.flex) +
                                        " are open sheets, whose contact is MuJoCo's own; give both contype=\"2\" "
                                        "conaffinity=\"3\", or name only one of them in `flexes`");
        } else if (meet(a.flex, b.flex)) {
          throw std::invalid_argument(
              "raycontact: MuJoCo would make contact between " + title_of(m, a.flex) + " and " +
              (a.flex == b.flex ? "itself" : title_of(m, b.flex)) +
              " too; give flexes contype=\"0\", which leaves their contact with geoms to MuJoCo, and open sheets "
              "contype=\"2\" conaffinity=\"3\"");
        }
      }
  }

  double sampling_value_of(const mjModel* m) const {
    if (options_.sampling != RAYC_SAMPLING_SPACING || options_.sampling_value != 0) return options_.sampling_value;
    double smallest = mjMAXVAL;
    for (const Body& body : bodies_) smallest = std::min(smallest, element_edge_of(m, body.flex));
    return smallest / 4;
  }

  void choose_materials(const mjModel* m) {
    double stiffest = 0, edge_of_stiffest = 1;
    bool has_solid = false;
    std::vector<double> pressures;
    for (const Body& body : bodies_) {
      pressures.push_back(options_.pressure > 0 ? options_.pressure : moduli_of(m, body.flex).pressure());
      if (pressures.back() > stiffest) stiffest = pressures.back(), edge_of_stiffest = element_edge_of(m, body.flex);
      has_solid = has_solid || !body.is_sheet;
    }
    if (!has_solid) stiffest = 1;  // sheets alone touch nothing here
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      Body& body = bodies_[b];
      // Sheets and shells resist no pressure of their own: they bear what the solids bear that they meet.
      const double edge = pressures[b] == 0 ? edge_of_stiffest : element_edge_of(m, body.flex);
      if (pressures[b] == 0) pressures[b] = stiffest;
      if (!(pressures[b] > 0))
        throw std::invalid_argument("raycontact: " + title_of(m, body.flex) +
                                    " is no elastic solid from which a stiffness follows, and meets none; set "
                                    "`pressure`");
      if (options_.depth > 0) {
        body.material = bearing_material(pressures[b], options_.depth);
      } else {
        body.material = elastic_material(pressures[b], 0, edge);  // the larger modulus is known
        // Bodies that start deep part by the cap over the damping time. Cells are coarse beside what they carry.
        body.material.depth_cap = edge / (m->flex_interp[body.flex] != 0 ? 4 : 16);
      }
      body.material.damping_time = options_.damping_time;
      body.material.friction = options_.friction >= 0 ? options_.friction : m->flex_friction[3 * body.flex];
    }
  }

  bool is_same_state(const mjModel* m, const mjData* d) const {
    return is_known_ && d->time == time_ && std::equal(known_positions_.begin(), known_positions_.end(), d->qpos) &&
           std::equal(known_velocities_.begin(), known_velocities_.end(), d->qvel) &&
           known_positions_.size() == static_cast<std::size_t>(m->nq);
  }

  /** Whether boxes around the surfaces meet where they are, or where they would be a step later. */
  bool may_touch(const mjModel* m, const mjData* d) {
    if (options_.self_collision) return true;
    boxes_.resize(6 * bodies_.size());
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      double* box = &boxes_[6 * b];
      double fastest = 0;
      const Body& body = bodies_[b];
      for (std::size_t k = 3 * body.first_node; k < 3 * (body.first_node + body.node_count); ++k)
        fastest = std::max(fastest, std::max(std::fabs(node_velocity_[k]), std::fabs(node_free_[k])));
      for (std::size_t k = 0; k < 3; ++k) box[k] = mjMAXVAL, box[3 + k] = -mjMAXVAL;
      const mjtNum* first = d->flexvert_xpos + 3 * static_cast<std::size_t>(m->flex_vertadr[body.flex]);
      for (const uint32_t v : body.surface.vertices)
        for (std::size_t k = 0; k < 3; ++k) {
          box[k] = std::min(box[k], first[3 * v + k]);
          box[3 + k] = std::max(box[3 + k], first[3 * v + k]);
        }
      const double way = 2 * m->opt.timestep * fastest;
      for (std::size_t k = 0; k < 3; ++k) box[k] -= way, box[3 + k] += way;
    }
    for (std::size_t a = 0; a < bodies_.size(); ++a)
      for (std::size_t b = a + 1; b < bodies_.size(); ++b) {
        bool meet = !bodies_[a].is_sheet || !bodies_[b].is_sheet;
        for (std::size_t k = 0; k < 3; ++k)
          meet = meet && boxes_[6 * a + k] <= boxes_[6 * b + 3 + k] && boxes_[6 * b + k] <= boxes_[6 * a + 3 + k];
        if (meet) return true;
      }
    return false;
  }

  void find_forces(const mjModel* m, mjData* d) {
    const double h = m->opt.timestep;
    std::copy(d->qvel, d->qvel + m->nv, velocity_.begin());
    gather_outer_forces(m, d);
    // Where bodies would be without contact: their own stiffness hardly moves them within one step.
    mj_solveM(m, d, free_.data(), outer_.data(), 1);
    for (std::size_t k = 0; k < free_.size(); ++k) free_[k] = velocity_[k] + h * free_[k];
    nodes_.renew(m, d);
    nodes_.to_nodes(velocity_, node_velocity_);
    nodes_.to_nodes(free_, node_free_);
    check_finite(m);
    // What touched in the last step is looked at once more, so that what is remembered of it ends.
    if (!may_touch(m, d) && !std::exchange(has_touched_, false)) return;
    system_->begin(*scene_, h, nodes_.positions(), node_velocity_, node_free_);
    try {
      end_ = free_;
      find_contact_force();
      has_touched_ = std::any_of(force_.begin(), force_.end(), [](double force) { return force != 0; });
      if (has_touched_) solve(m, d);
      nodes_.to_nodes(end_, node_change_);
      system_->finish(node_change_);
    } catch (...) {
      system_->cancel();
      throw;
    }
  }

  void check_finite(const mjModel* m) const {
    for (const Body& body : bodies_)
      for (std::size_t k = 3 * body.first_node; k < 3 * (body.first_node + body.node_count); ++k)
        if (!std::isfinite(nodes_.positions()[k] + node_velocity_[k] + node_free_[k]))
          throw Error(RAYC_STATUS_NOT_FINITE,
                      "raycontact: a position or velocity of node " + std::to_string(k / 3 - body.first_node) + " of " +
                          title_of(m, body.flex) + " is not finite; take a smaller step or reset the state");
  }

  /** Gravity, rotation and what the program applies. */
  void gather_outer_forces(const mjModel* m, mjData* d) {
    mj_rne(m, d, 0, outer_.data());
    for (std::size_t k = 0; k < outer_.size(); ++k) outer_[k] = d->qfrc_applied[k] - outer_[k];
    for (int body = 1; body < m->nbody; ++body) {
      const mjtNum* applied = d->xfrc_applied + 6 * body;
      if (std::any_of(applied, applied + 6, [](mjtNum force) { return force != 0; }))
        mj_applyFT(m, d, applied, applied + 3, d->xipos + 3 * body, body, outer_.data());
    }
  }

  /** The step's solves for velocities at its end: metric (end - velocity) = h (smooth + contact force at the end). */
  void solve(const mjModel* m, mjData* d) {
    const double h = m->opt.timestep;
    for (std::size_t k = 0; k < smooth_.size(); ++k) smooth_[k] = outer_[k] + d->qfrc_passive[k];
    metric_.renew(m, d);
    metric_.subtract_shift(m, d, velocity_, smooth_, product_);
    for (std::size_t k = 0; k < end_.size(); ++k) residual_[k] = h * (smooth_[k] + force_[k]);
    const double reference = metric_.norm(residual_, product_);
    // The last step's acceleration is a good guess.
    for (std::size_t k = 0; k < end_.size(); ++k) end_[k] = velocity_[k] + h * d->qacc_warmstart[k];
    for (int solve = 1;; ++solve) {
      figures_.solves = solve;
      find_contact_force();
      for (std::size_t k = 0; k < end_.size(); ++k) change_[k] = end_[k] - velocity_[k];
      metric_.product(m, d, change_, product_);
      for (std::size_t k = 0; k < end_.size(); ++k) residual_[k] = h * (smooth_[k] + force_[k]) - product_[k];
      const bool has_converged = solver_.solve(
          end_, residual_, options_.tolerance, reference, iterations,
          [&](const Numbers& change, Numbers& result) {
            metric_.product(m, d, change, result);
            nodes_.to_nodes(change, node_change_);
            std::fill(node_force_.begin(), node_force_.end(), 0.0);
            system_->add_product(h, node_change_, node_force_);
            nodes_.add_to_dofs(node_force_, result);
          },
          [&](const Numbers& from, Numbers& to) { metric_.precondition(from, to); });
      figures_.iterations += solver_.iterations();
      figures_.has_converged = figures_.has_converged && has_converged;
      // What MuJoCo's step is to add: the force as the rows are held, before they are held anew.
      find_contact_force();
      const bool is_wrong = system_->linearise(node_change_) > 0.01;
      if (solve == options_.solves || (!system_->detect_again(*scene_, node_change_) && !is_wrong)) return;
    }
  }

  /** force_ = J^T contact forces at end_, as the rows are held. */
  void find_contact_force() {
    nodes_.to_nodes(end_, node_change_);
    std::fill(node_force_.begin(), node_force_.end(), 0.0);
    system_->add_forces(node_change_, node_force_);
    std::fill(force_.begin(), force_.end(), 0.0);
    nodes_.add_to_dofs(node_force_, force_);
  }

  static constexpr int iterations = 1000;

  ContactOptions options_;
  ImplicitMetric metric_;
  NodeMotion nodes_;
  ConjugateGradients solver_;
  std::vector<Body> bodies_;
  std::unique_ptr<Scene> scene_;
  std::unique_ptr<ContactSystem> system_;
  StepFigures figures_;
  // By degree of freedom, and by node.
  Numbers velocity_, free_, end_, force_, outer_, smooth_, residual_, product_, change_;
  Numbers node_velocity_, node_free_, node_change_, node_force_;
  Numbers boxes_, known_positions_, known_velocities_;
  double sampling_value_ = 0, time_ = 0;
  bool is_known_ = false, has_touched_ = false;
};

}  // namespace raycontact::mujoco

#endif  // RAYCONTACT_MUJOCO_FLEX_CONTACT_HPP
