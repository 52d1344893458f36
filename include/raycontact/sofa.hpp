// SPDX-License-Identifier: MIT OR Apache-2.0
/**
 * @file
 * A narrow phase in the words of SOFA, templated on the host's vector types: a plugin hands its calls through. It
 * includes nothing of SOFA. The plugin is plugins/sofa, its manual docs/sofa.md.
 */
#ifndef RAYCONTACT_SOFA_HPP
#define RAYCONTACT_SOFA_HPP

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "../raycontact.hpp"

#ifdef RAYCONTACT_NO_EXCEPTIONS
#error "raycontact/sofa.hpp reports errors as exceptions, as SOFA does"
#endif

namespace raycontact {

/** A collision model's number, as CollisionStage::addCollisionModel gave it. */
using ModelId = uint32_t;

/** A triangle of a collision model. */
struct CollisionElement {
  ModelId model;   ///< The collision model.
  uint32_t index;  ///< The triangle's number in it.
};

/** One contact, as sofa::core::collision::DetectionOutput describes it. */
template <class Coord>
struct DetectionOutput {
  std::pair<CollisionElement, CollisionElement> elem;  ///< One triangle of the first model, one of the second.
  int64_t id;      ///< Its place among the pair's; contacts are found anew in each step, so it means no more.
  Coord point[2];  ///< On the surface of the first model and of the second, in m.
  Coord normal;    ///< Of unit length, outward from the first model.
  /// Minus the depth, in m: (point[1] - point[0]) . normal, or for a pair that escapes what its deepest point has.
  double value;
  double deltaT;        ///< 0: nothing is predicted.
  std::size_t contact;  ///< Its place in CollisionStage::contacts().
};

/**
 * The stage of a collision pipeline that finds contacts.
 *
 * One step: setPositions() for each model that moved; beginNarrowPhase(), addCollisionPair() for each pair that the
 * broad phase lets through, endNarrowPhase(); getDetectionOutputs(). A pair that is not added has no contacts, whether
 * its boxes overlap or not. Where a ContactResponse (raycontact/sofa_response.hpp) looks for contacts itself,
 * chooseCollisionPairs() takes the place of endNarrowPhase().
 *
 * Threads: one call at a time. Errors are exceptions of type raycontact::Error.
 *
 * @tparam DataTypes names the host's types as sofa::defaulttype::Vec3Types does: VecCoord and VecDeriv, with data(),
 * size() and resize(); Coord and Deriv, three numbers of float or double with operator[].
 */
template <class DataTypes>
class CollisionStage {
 public:
  using Coord = typename DataTypes::Coord;        ///< A position.
  using VecCoord = typename DataTypes::VecCoord;  ///< Positions of a model.
  using Output = DetectionOutput<Coord>;          ///< One contact.
  using Outputs = std::vector<Output>;            ///< The contacts of a pair of models.
  using Pair = std::pair<ModelId, ModelId>;       ///< Two models, in the caller's order, or one twice: with itself.

  /** @param options how the scene works, threads above all */
  explicit CollisionStage(const rayc_scene_options& options = default_scene_options()) : scene_(options) {}

  /** How contacts are found from the next endNarrowPhase() on. */
  void setDetectionOptions(const rayc_detection_options& options) { scene_.set_detection_options(options); }

  /**
   * Adds a closed triangle surface; `triangles` holds three vertex numbers each, of any type of integer.
   * @return its number: the next one, and after tens of thousands of removals the one that has been free for longest
   */
  template <class Triangles>
  ModelId addCollisionModel(const VecCoord& x, const Triangles& triangles,
                            const rayc_mesh_options& options = default_mesh_options()) {
    std::vector<uint32_t> indices;
    indices.reserve(3 * triangles.size());
    for (const auto& triangle : triangles)
      for (int corner = 0; corner < 3; ++corner) indices.push_back(static_cast<uint32_t>(triangle[corner]));
    const ModelId id = scene_.add(Mesh(vectors(x), indices, options));
    if (id >= models_.size()) models_.resize(id + 1);
    models_[id] = Model{true, x.size()};
    // Only pairs that are added collide.
    for (ModelId other = 0; other < models_.size(); ++other)
      if (other != id && models_[other].is_there) scene_.set_pair_collision(id, other, false);
    return id;
  }

  /** Removes a model; its number is refused until, tens of thousands of removals later, another model gets it. */
  void removeCollisionModel(ModelId model) {
    scene_.remove(model);
    models_[model] = Model{};
    const auto names = [model](const Pair& pair) { return pair.first == model || pair.second == model; };
    for (auto* pairs : {&asked_, &active_})
      pairs->erase(std::remove_if(pairs->begin(), pairs->end(), names), pairs->end());
    for (auto place = outputs_.begin(); place != outputs_.end();)
      place = names(place->first) ? outputs_.erase(place) : std::next(place);
    contacts_.clear();
  }

  /** Renews the positions of a model's vertices. */
  void setPositions(ModelId model, const VecCoord& x) { scene_.set_positions(model, vectors(x)); }

  /** Forgets the pairs and outputs of the last step. */
  void beginNarrowPhase() {
    asked_.clear();
    for (auto& entry : outputs_) entry.second.clear();
  }

  /** Asks for the contacts between two models; the same number twice: for those of the model with itself. */
  void addCollisionPair(const Pair& pair) {
    require(pair.first);
    require(pair.second);
    asked_.push_back(pair);
  }

  /** The same for many pairs. */
  template <class Pairs>
  void addCollisionPairs(const Pairs& pairs) {
    for (const Pair& pair : pairs) addCollisionPair(pair);
  }

  /** Finds the contacts of all pairs that were added. */
  void endNarrowPhase() {
    chooseCollisionPairs();
    scene_.query(found_);
    found_.copy_to(contacts_);
    fill_outputs();
  }

  /** Lets the pairs collide that were added, in any later query of the scene, and no others. */
  void chooseCollisionPairs() {
    // Only what differs from the last step is switched.
    wanted_.clear();
    for (const Pair& pair : asked_) wanted_.push_back(ordered(pair));
    std::sort(wanted_.begin(), wanted_.end());
    wanted_.erase(std::unique(wanted_.begin(), wanted_.end()), wanted_.end());
    const auto contains = [](const std::vector<Pair>& pairs, const Pair& pair) {
      return std::binary_search(pairs.begin(), pairs.end(), pair);
    };
    for (const Pair& pair : active_)
      if (!contains(wanted_, pair)) switch_pair(pair, false);
    for (const Pair& pair : wanted_)
      if (!contains(active_, pair)) switch_pair(pair, true);
    active_.swap(wanted_);
  }

  /** The contacts of a pair that was added, in that order of its models. Valid until beginNarrowPhase(). */
  const Outputs& getDetectionOutputs(const Pair& pair) const {
    static const Outputs none;
    const auto found = outputs_.find(pair);
    return found == outputs_.end() ? none : found->second;
  }

  /** Whether no contact was found. */
  bool zeroCollision() const { return contacts_.empty(); }

  /** All contacts with their weights, as raycontact.h describes them. */
  const std::vector<rayc_contact>& contacts() const { return contacts_; }

  /** What the last detection did. */
  rayc_statistics statistics() const { return found_.statistics(); }

  /** How many numbers have been given to models; some may have been removed. */
  std::size_t modelCount() const { return models_.size(); }

  /** How many vertices a model has; 0 where it has been removed. */
  std::size_t vertexCount(ModelId model) const { return models_[model].vertex_count; }

  /** The bodies, by the models' numbers. */
  Scene& scene() { return scene_; }

 private:
  struct Model {
    bool is_there = false;
    std::size_t vertex_count = 0;
  };

  void require(ModelId model) const {
    if (model >= models_.size() || !models_[model].is_there)
      throw Error(RAYC_STATUS_UNKNOWN_BODY,
                  "collision model " + std::to_string(model) + ": it was never added, or was removed");
  }

  static Pair ordered(const Pair& pair) {
    return {std::min(pair.first, pair.second), std::max(pair.first, pair.second)};
  }

  void switch_pair(const Pair& pair, bool is_on) {
    if (pair.first == pair.second)
      scene_.set_self_collision(pair.first, is_on);
    else
      scene_.set_pair_collision(pair.first, pair.second, is_on);
  }

  /** Contacts are in ascending order of their pairs. */
  void fill_outputs() {
    const auto before = [](const rayc_contact& contact, const Pair& pair) {
      return ordered({contact.colliding, contact.collided}) < pair;
    };
    for (const Pair& asked : asked_) {
      Outputs& outputs = outputs_[asked];
      outputs.clear();  // where a pair was added twice
      const Pair pair = ordered(asked);
      auto contact = std::lower_bound(contacts_.begin(), contacts_.end(), pair, before);
      for (; contact != contacts_.end() && ordered({contact->colliding, contact->collided}) == pair; ++contact)
        outputs.push_back(output(asked, *contact, static_cast<int64_t>(outputs.size())));
    }
  }

  Output output(const Pair& pair, const rayc_contact& contact, int64_t id) const {
    const bool is_first = contact.colliding == pair.first;
    const rayc_surface_point& first = is_first ? contact.p1 : contact.p2;
    const rayc_surface_point& second = is_first ? contact.p2 : contact.p1;
    Output output{};
    output.elem = {{pair.first, first.triangle}, {pair.second, second.triangle}};
    output.id = id;
    // The ray runs inward where it starts, and outward where it ends.
    for (int axis = 0; axis < 3; ++axis) {
      using Real = std::remove_reference_t<decltype(output.normal[axis])>;
      output.point[0][axis] = static_cast<Real>(first.position[axis]);
      output.point[1][axis] = static_cast<Real>(second.position[axis]);
      output.normal[axis] = static_cast<Real>(is_first ? -contact.direction[axis] : contact.direction[axis]);
    }
    output.value = -contact.depth;
    output.contact = static_cast<std::size_t>(&contact - contacts_.data());
    return output;
  }

  Scene scene_;
  Contacts found_;
  std::vector<rayc_contact> contacts_;
  std::vector<Model> models_;
  /** The pairs of this step as they were added; and in ascending order those switched on, and those wanted. */
  std::vector<Pair> asked_, active_, wanted_;
  std::map<Pair, Outputs> outputs_;
};

}  // namespace raycontact

#endif  // RAYCONTACT_SOFA_HPP
