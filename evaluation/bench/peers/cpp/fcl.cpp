// SPDX-License-Identifier: MIT OR Apache-2.0
// FCL 0.7: pairs of intersecting triangles with positions, normals and depths, from trees of boxes refitted each step.
// It says where two surfaces cross, not how deep one lies inside the other, so its contacts are not the method's.
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/utility.h>
#include <fcl/narrowphase/detail/traversal/collision/mesh_collision_traversal_node.h>
#include <fcl/narrowphase/detail/traversal/traversal_recurse.h>

#include "clock.hpp"
#include "pairs.hpp"

namespace bench {
namespace {

using Scalar = float;
using Model = fcl::BVHModel<fcl::AABB<Scalar>>;

class FclPeer : public Peer {
 public:
  explicit FclPeer(const Bodies& bodies) : bodies_(bodies), pairs_(bodies), models_(bodies.size()) {
    request_.enable_contact = true;
    request_.num_max_contacts = 100'000'000;
    for (size_t index = 0; index < bodies.size(); ++index) {
      const BodyView& body = bodies[index];
      std::vector<fcl::Triangle> triangles;
      for (uint32_t t = 0; t < body.triangle_count; ++t) {
        const uint32_t* corner = body.triangles + 3 * size_t(t);
        triangles.emplace_back(corner[0], corner[1], corner[2]);
      }
      read(body);
      models_[index].beginModel(int(body.triangle_count), int(body.vertex_count));
      models_[index].addSubModel(points_, triangles);
      models_[index].endModel();
    }
  }

  bool step(Stages& stages) override {
    Clock clock;
    for (size_t body = 0; body < bodies_.size(); ++body) pairs_.find_box(body);
    pairs_.find_pairs();
    stages.normals = clock.lap();

    for (const uint32_t body : pairs_.touched()) {
      read(bodies_[body]);
      models_[body].beginReplaceModel();
      models_[body].replaceSubModel(points_);
      models_[body].endReplaceModel(true, true);
    }
    stages.structure = clock.lap();

    contacts.clear();
    for (const auto& pair : pairs_.pairs()) collide(pair.bodies[0], pair.bodies[1]);
    stages.trace = clock.lap();
    return true;
  }

 private:
  void read(const BodyView& body) {
    points_.resize(body.vertex_count);
    for (uint32_t v = 0; v < body.vertex_count; ++v) {
      const float* p = body.positions + 3 * size_t(v);
      points_[v] = {p[0], p[1], p[2]};
    }
  }

  // As fcl::collide does, but without its copies of both models.
  void collide(uint32_t a, uint32_t b) {
    fcl::CollisionResult<Scalar> result;
    fcl::detail::MeshCollisionTraversalNode<fcl::AABB<Scalar>> node;
    fcl::Transform3<Scalar> frame_a = fcl::Transform3<Scalar>::Identity(), frame_b = frame_a;
    fcl::detail::initialize(node, models_[a], frame_a, models_[b], frame_b, request_, result);
    fcl::detail::collisionRecurse<Scalar>(&node, 0, 0, nullptr);
    for (size_t i = 0; i < result.numContacts(); ++i) {
      const auto& found = result.getContact(i);
      Contact contact{};
      contact.colliding = a;
      contact.collided = b;
      contact.vertex = ~0u;  // triangles against triangles
      contact.cos_alpha = 1;
      contact.triangle = uint32_t(found.b2);
      contact.depth = float(found.penetration_depth);
      for (int axis = 0; axis < 3; ++axis) {
        contact.p2[axis] = found.pos[axis];
        contact.direction[axis] = -found.normal[axis];  // its normal points to the second model
      }
      contacts.push_back(contact);
    }
  }

  Bodies bodies_;
  Pairs pairs_;
  std::vector<Model> models_;
  std::vector<fcl::Vector3<Scalar>> points_;
  fcl::CollisionRequest<Scalar> request_;
};

}  // namespace

std::unique_ptr<Peer> make_fcl(const std::string& method, const Bodies& bodies) {
  if (method == "fcl-aabb") return std::make_unique<FclPeer>(bodies);
  return nullptr;
}

}  // namespace bench
