// SPDX-License-Identifier: MIT OR Apache-2.0
/**
 * @file
 * The contact system (raycontact/contact_system.hpp) as a force field on the models of a CollisionStage. It includes
 * nothing of SOFA. The plugin is plugins/sofa, its manual docs/sofa.md.
 */
#ifndef RAYCONTACT_SOFA_RESPONSE_HPP
#define RAYCONTACT_SOFA_RESPONSE_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "contact_system.hpp"
#include "free_points.hpp"
#include "sofa.hpp"

namespace raycontact {

/** What a contact between two collision models is made of; the same for all models of a response. */
struct ContactLaw {
  double stiffness = 1;        ///< Pressure per depth of two surfaces in contact, in N/m³; finite and >= 0.
  double damping_time = 0.05;  ///< Damping over stiffness, in s; finite and >= 0.
  double friction = 0;         ///< Coulomb's coefficient; finite and >= 0.
  /// The depth, in m, beyond which one step asks for no more force than there: > 0.
  double depth_cap = std::numeric_limits<double>::infinity();
};

/**
 * How nodes that the host's solvers move carry a model: a skin in a cage. Vertex v is the sum of `weights[e]` times
 * node `nodes[e]` over e from `offsets[v]` up to `offsets[v + 1]`; the weights of a vertex sum to 1.
 */
struct SurfaceCarriers {
  std::vector<double> node_masses;  ///< in kg, one for each node: > 0, infinity for one that the solver does not move
  std::vector<uint32_t> offsets;    ///< one more than the model has vertices
  std::vector<uint32_t> nodes;      ///< those that carry each vertex, one vertex after the other
  std::vector<double> weights;      ///< one for each of `nodes`
};

/**
 * Contact forces between the collision models of a stage, for a host that asks for forces and for products with their
 * derivative, as SOFA's solvers do.
 *
 * One step of an implicit solver: addSurface() for models that are new; begin(), then addForce() with the velocities
 * that the host starts from, addDForce() for each iteration or blocks() for a matrix; finish() with the velocities it
 * ended with. The forces are those at the end of the step, so they depend on velocities alone and all of their
 * derivative is a damping matrix. Where bodies have solvers of their own: addSeparateForce() in place of begin() and
 * addForce().
 *
 * Arrays have one entry for each number that the stage has given out, NULL for a model that was removed. A v of NULL is
 * a model at rest, an f of NULL one whose forces nobody wants. For a model with SurfaceCarriers they are its nodes'.
 *
 * Threads: one call at a time, for the stage too. Errors are exceptions of type raycontact::Error.
 */
template <class DataTypes>
class ContactResponse {
 public:
  using VecCoord = typename DataTypes::VecCoord;  ///< Positions of a model.
  using VecDeriv = typename DataTypes::VecDeriv;  ///< Velocities, changes of velocity or forces of a model.

  /** @param precision that of the stage's scene, a rayc_scalar */
  explicit ContactResponse(uint32_t precision = RAYC_SCALAR_F64) : system_(options(precision)), precision_(precision) {}

  /** Forgets all models and steps. */
  void clear() { *this = ContactResponse(precision_); }

  /** How many of the stage's models are known. */
  std::size_t surfaceCount() const { return firsts_.empty() ? 0 : firsts_.size() - 1; }

  /**
   * Makes the next of the stage's models known; a step under way ends as if it had not begun.
   * @param stage the stage that has the model
   * @param vertex_mass what each vertex weighs, in kg: > 0, infinity for a model that the solver does not move. It
   * decides how escapes share their push among the vertices, and what addSeparateForce() expects of them
   * @param law what contacts are made of
   */
  void addSurface(CollisionStage<DataTypes>& stage, double vertex_mass, const ContactLaw& law) {
    const std::size_t count = stage.vertexCount(static_cast<ModelId>(surfaceCount()));
    add(std::vector<double>(count, vertex_mass), [&](ModelId model, uint32_t first) {
      if (count > 0) system_.add_deformable(stage.scene(), model, first, static_cast<uint32_t>(count), material(law));
    });
  }

  /** The same for a model that other nodes carry. Forces and products are then of these nodes. */
  void addSurface(CollisionStage<DataTypes>& stage, const SurfaceCarriers& carriers, const ContactLaw& law) {
    add(carriers.node_masses, [&](ModelId model, uint32_t first) {
      system_.add_deformable(stage.scene(), model, first, static_cast<uint32_t>(carriers.node_masses.size()),
                             Carriers{carriers.offsets, carriers.nodes, carriers.weights}, material(law));
    });
  }

  /**
   * Begins a step of dt seconds: moves all models to where they would be at its end, looks for contacts among the pairs
   * that the stage lets collide, and holds them for the solver. A step under way ends as if it had not begun.
   * @param stage the stage that has the models
   * @param dt in s
   * @param x positions at the start, one for each model
   * @param v velocities at the start
   * @param gravity its acceleration, three numbers in m/s²: where models that the solver moves are thought to go
   */
  void begin(CollisionStage<DataTypes>& stage, double dt, const std::vector<const VecCoord*>& x,
             const std::vector<const VecDeriv*>& v, const double* gravity) {
    require_one_for_each_model(stage.modelCount(), x.size(), v.size());
    system_.cancel();
    gather(positions_, x, "position");
    gather(velocities_, v, "velocity");
    free_ = velocities_;
    for (std::size_t k = 0; k < free_.size(); ++k)
      if (std::isfinite(masses_[k / 3])) free_[k] += dt * gravity[k % 3];
    is_under_way_ = false;
    system_.begin(stage.scene(), dt, positions_, velocities_, free_);
    is_under_way_ = true;
  }

  /** Whether a step has begun and not ended. */
  bool isUnderWay() const { return is_under_way_; }

  /** Adds the forces, in N, where the step ends with these velocities. */
  void addForce(const std::vector<VecDeriv*>& f, const std::vector<const VecDeriv*>& v) {
    require_one_for_each_model(surfaceCount(), f.size(), v.size());
    gather(velocities_, v, "velocity");
    forces_.assign(velocities_.size(), 0);
    system_.add_forces(velocities_, forces_);
    energy_ = system_.energy(velocities_);
    scatter(forces_, f);
  }

  /** Adds bFactor * (df/dv) dv. */
  void addDForce(const std::vector<VecDeriv*>& df, const std::vector<const VecDeriv*>& dv, double bFactor) {
    require_one_for_each_model(surfaceCount(), df.size(), dv.size());
    gather(changes_, dv, "change of velocity");
    products_.assign(changes_.size(), 0);
    system_.add_product(-bFactor, changes_, products_);
    scatter(products_, df);
  }

  /** The derivative df/dv in 3 x 3 blocks of nodes, numbered through all models; until the next call. */
  const Blocks& blocks() {
    system_.copy_blocks_to(-1, blocks_);
    return blocks_;
  }

  /** The model that has a node numbered through all models, and its number there. */
  std::pair<ModelId, uint32_t> place(uint32_t node) const {
    const auto next = std::upper_bound(firsts_.begin(), firsts_.end(), node);
    return {static_cast<ModelId>(next - firsts_.begin() - 1), node - *(next - 1)};
  }

  /** The potential of the contacts, in J, at the velocities of the last addForce(): it grows with the depth at the
   * step's end. */
  double getPotentialEnergy() const { return energy_; }

  /** The force on a vertex or node, in N, at the last addForce() or addSeparateForce(). */
  std::array<double, 3> lastForce(ModelId model, std::size_t node) const {
    const std::size_t at = 3 * (firsts_[model] + node);
    if (at + 3 > forces_.size()) return {0, 0, 0};
    return {forces_[at], forces_[at + 1], forces_[at + 2]};
  }

  /**
   * Ends a step with the velocities that the solver found; nothing where none is under way.
   * @return the part of all force, 0 to 1, that was held wrongly: springs that would have pulled, or pushed more
   */
  double finish(const std::vector<const VecDeriv*>& v) {
    if (!is_under_way_) return 0;
    is_under_way_ = false;
    gather(velocities_, v, "velocity");
    const double wrong = system_.linearise(velocities_);
    system_.finish(velocities_);
    return wrong;
  }

  /**
   * A step of a host whose solvers do not ask for the derivative, or ask body by body: begin(), then adds the forces,
   * in N, that there would be at the step's end if each vertex were a free point of its mass. Where those masses,
   * carried over to what the vertices are mapped from, are no larger than what the solvers move, these forces never
   * push a body back faster than it came, however long the step. finish() as for begin().
   * @return iterations of conjugate gradients; as many as most_iterations where they did not come to their end
   */
  int addSeparateForce(CollisionStage<DataTypes>& stage, double dt, const std::vector<VecDeriv*>& f,
                       const std::vector<const VecCoord*>& x, const std::vector<const VecDeriv*>& v,
                       const double* gravity) {
    require_one_for_each_model(stage.modelCount(), f.size(), v.size());
    begin(stage, dt, x, v, gravity);
    velocities_ = free_;
    const int iterations = points_.solve(system_, dt, masses_, velocities_);
    forces_.assign(velocities_.size(), 0);
    system_.add_forces(velocities_, forces_);
    energy_ = system_.energy(velocities_);
    scatter(forces_, f);
    return iterations;
  }

  static constexpr int most_iterations = FreePoints::most_iterations;  ///< Of addSeparateForce().

 private:
  /** `add_body(model, first)` makes it known to the system. */
  template <class AddBody>
  void add(const std::vector<double>& node_masses, AddBody add_body) {
    const auto model = static_cast<ModelId>(surfaceCount());
    if (firsts_.empty()) firsts_.push_back(0);
    system_.cancel();
    std::vector<double> masses = masses_;
    masses.insert(masses.end(), node_masses.begin(), node_masses.end());
    system_.set_node_masses(masses);
    add_body(model, firsts_.back());
    masses_.swap(masses);
    firsts_.push_back(static_cast<uint32_t>(masses_.size()));
  }

  static rayc_contact_system_options options(uint32_t precision) {
    rayc_contact_system_options options = default_contact_system_options();
    options.precision = precision;
    return options;
  }

  /** Two of it in series are the law. */
  static rayc_material material(const ContactLaw& law) {
    rayc_material material{};
    material.struct_size = sizeof material;
    material.stiffness = 2 * law.stiffness;
    material.damping_time = law.damping_time;
    material.friction = law.friction;
    material.depth_cap = law.depth_cap;
    return material;
  }

  void require_one_for_each_model(std::size_t models, std::size_t a, std::size_t b) const {
    for (const std::size_t count : {models, a, b})
      if (count != surfaceCount())
        throw Error(RAYC_STATUS_WRONG_COUNT, std::to_string(count) + " arrays or models for the " +
                                                 std::to_string(surfaceCount()) + " surfaces; give one for each");
  }

  /** NULL is zero. */
  template <class Vectors>
  void gather(std::vector<double>& numbers, const std::vector<const Vectors*>& models, const char* what) const {
    numbers.assign(3 * masses_.size(), 0);
    for (std::size_t model = 0; model < models.size(); ++model) {
      if (models[model] == nullptr) continue;
      const std::size_t first = firsts_[model], count = firsts_[model + 1] - first;
      const auto name = [&] { return std::string(what) + " of model " + std::to_string(model); };
      if (models[model]->size() != count)
        throw Error(RAYC_STATUS_WRONG_COUNT, name() + ": there are " + std::to_string(models[model]->size()) +
                                                 ", but it has " + std::to_string(count) + " vertices");
      const auto* vectors = models[model]->data();
      for (std::size_t k = 0; k < 3 * count; ++k) {
        const double number = vectors[k / 3][k % 3];
        if (!std::isfinite(number))
          throw Error(RAYC_STATUS_NOT_FINITE, name() + ": node " + std::to_string(k / 3) + " is not finite");
        numbers[3 * first + k] = number;
      }
    }
  }

  void scatter(const std::vector<double>& numbers, const std::vector<VecDeriv*>& models) const {
    for (std::size_t model = 0; model < models.size(); ++model) {
      if (models[model] == nullptr) continue;
      auto* vectors = models[model]->data();
      const std::size_t first = firsts_[model], count = firsts_[model + 1] - first;
      for (std::size_t k = 0; k < 3 * count; ++k) {
        using Real = std::remove_reference_t<decltype(vectors[0][0])>;
        vectors[k / 3][k % 3] += static_cast<Real>(numbers[3 * first + k]);
      }
    }
  }

  ContactSystem system_;
  uint32_t precision_;
  /** The first node of each model, and the number of all. */
  std::vector<uint32_t> firsts_;
  std::vector<double> masses_, positions_, velocities_, free_, changes_, forces_, products_;
  FreePoints points_;
  Blocks blocks_;
  double energy_ = 0;
  bool is_under_way_ = false;
};

}  // namespace raycontact

#endif  // RAYCONTACT_SOFA_RESPONSE_HPP
