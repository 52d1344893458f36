// SPDX-License-Identifier: MIT OR Apache-2.0
// Bullet 3.24: its own soft-soft detection. Vertices near faces (VF_SS): it finds what lies within a margin of the
// other surface, so its contacts are not the method's: nothing deeper than the margin is seen. Clusters (CL_SS): each
// body in convex pieces, of which those that overlap are pushed apart.
#include <BulletSoftBody/btSoftBody.h>

#include "clock.hpp"
#include "pairs.hpp"

namespace bench {
namespace {

class BulletPeer : public Peer {
 public:
  BulletPeer(const Bodies& bodies, bool by_clusters) : bodies_(bodies), by_clusters_(by_clusters), pairs_(bodies) {
    for (const auto& body : bodies) bodies_of_bullet_.push_back(make(body));
  }

  bool step(Stages& stages) override {
    Clock clock;
    for (size_t body = 0; body < bodies_.size(); ++body) pairs_.find_box(body);
    pairs_.find_pairs();
    stages.normals = clock.lap();

    for (const uint32_t body : pairs_.touched()) {
      btSoftBody& soft = *bodies_of_bullet_[body];
      follow(soft, bodies_[body]);
      if (by_clusters_) {
        soft.updateClusters();
        free_joints(soft);
        continue;
      }
      soft.updateNodeTree(false, true);
      soft.updateFaceTree(false, true);
      soft.m_scontacts.resize(0);
    }
    stages.structure = clock.lap();

    contacts.clear();
    for (const auto& pair : pairs_.pairs()) collide(pair.bodies[0], pair.bodies[1]);
    stages.trace = clock.lap();
    return true;
  }

  ~BulletPeer() override {
    for (auto& soft : bodies_of_bullet_) free_joints(*soft);
  }

 private:
  // Of each body.
  static constexpr int clusters = 64;

  static void free_joints(btSoftBody& soft) {
    for (int i = 0; i < soft.m_joints.size(); ++i) btAlignedFree(soft.m_joints[i]);
    soft.m_joints.resize(0);
  }

  static void follow(btSoftBody& soft, const BodyView& body) {
    for (uint32_t v = 0; v < body.vertex_count; ++v) {
      const float* p = body.positions + 3 * size_t(v);
      // The margin grows with the last motion; there is none here.
      soft.m_nodes[int(v)].m_x = soft.m_nodes[int(v)].m_q = {p[0], p[1], p[2]};
    }
  }

  std::unique_ptr<btSoftBody> make(const BodyView& body) {
    std::vector<btVector3> points;
    double area = 0;
    for (uint32_t v = 0; v < body.vertex_count; ++v) {
      const float* p = body.positions + 3 * size_t(v);
      points.emplace_back(p[0], p[1], p[2]);
    }
    auto soft = std::make_unique<btSoftBody>(&world_, int(body.vertex_count), points.data(), nullptr);
    for (uint32_t t = 0; t < body.triangle_count; ++t) {
      const uint32_t* corner = body.triangles + 3 * size_t(t);
      soft->appendFace(int(corner[0]), int(corner[1]), int(corner[2]));
      // Bullet builds its trees along links; each edge belongs to two triangles.
      for (int i = 0; i < 3; ++i) {
        const uint32_t from = corner[i], to = corner[(i + 1) % 3];
        if (from < to) soft->appendLink(int(from), int(to));
      }
      const btVector3 &a = points[corner[0]], &b = points[corner[1]], &c = points[corner[2]];
      area += (b - a).cross(c - a).length() / 2;
    }
    if (by_clusters_) {
      soft->m_cfg.collisions = btSoftBody::fCollision::CL_SS;
      soft->setTotalMass(1, true);
      soft->generateClusters(clusters);
      return soft;
    }
    soft->m_cfg.collisions = btSoftBody::fCollision::VF_SS;
    // A quarter of a triangle's side: both bodies' margins together then are half a side.
    const btScalar margin = btScalar(std::sqrt(area / body.triangle_count) / 4);
    soft->getCollisionShape()->setMargin(margin);
    soft->m_sst.radmrg = margin;
    soft->initializeFaceTree();
    return soft;
  }

  void collide(uint32_t a, uint32_t b) {
    btSoftBody* soft[] = {bodies_of_bullet_[a].get(), bodies_of_bullet_[b].get()};
    const int before[] = {soft[0]->m_scontacts.size(), soft[1]->m_scontacts.size()};
    soft[0]->defaultCollisionHandler(soft[1]);
    if (by_clusters_) {
      collect_joints(*soft[0], a, b);
      return;
    }
    for (int side = 0; side < 2; ++side) {
      for (int i = before[side]; i < soft[side]->m_scontacts.size(); ++i) {
        const auto& found = soft[side]->m_scontacts[i];
        Contact contact{};
        contact.colliding = side == 0 ? a : b;
        contact.collided = side == 0 ? b : a;
        contact.vertex = uint32_t(found.m_node - &soft[side]->m_nodes[0]);
        contact.triangle = uint32_t(found.m_face - &soft[1 - side]->m_faces[0]);
        btVector3 on_face(0, 0, 0);
        for (int corner = 0; corner < 3; ++corner) on_face += found.m_face->m_n[corner]->m_x * found.m_weights[corner];
        // As its solver does: until the vertex is a margin away along the normal.
        write(contact, found.m_node->m_x, found.m_normal,
              found.m_margin - btDot(found.m_node->m_x - on_face, found.m_normal));
        contacts.push_back(contact);
      }
    }
  }

  void collect_joints(btSoftBody& soft, uint32_t a, uint32_t b) {
    for (int i = 0; i < soft.m_joints.size(); ++i) {
      auto& joint = *static_cast<btSoftBody::CJoint*>(soft.m_joints[i]);
      Contact contact{};
      contact.colliding = a;
      contact.collided = b;
      contact.vertex = contact.triangle = ~0u;
      write(contact, joint.m_bodies[0].xform().getOrigin() + joint.m_rpos[0], joint.m_normal, joint.m_drift.length());
      contacts.push_back(contact);
    }
    free_joints(soft);
  }

  static void write(Contact& contact, const btVector3& start, const btVector3& direction, btScalar depth) {
    contact.depth = depth;
    contact.cos_alpha = 1;
    for (int axis = 0; axis < 3; ++axis) {
      contact.direction[axis] = direction[axis];
      contact.p2[axis] = start[axis] + depth * direction[axis];
    }
  }

  Bodies bodies_;
  bool by_clusters_;
  Pairs pairs_;
  btSoftBodyWorldInfo world_;
  std::vector<std::unique_ptr<btSoftBody>> bodies_of_bullet_;
};

}  // namespace

std::unique_ptr<Peer> make_bullet(const std::string& method, const Bodies& bodies) {
  if (method == "bullet-vf" || method == "bullet-cl") {
    return std::make_unique<BulletPeer>(bodies, method == "bullet-cl");
  }
  return nullptr;
}

}  // namespace bench
