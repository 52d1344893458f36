// SPDX-License-Identifier: MIT OR Apache-2.0
// Bullet 3.24: its own soft-soft detection, vertices near faces (VF_SS). It finds what lies within a margin of the other
// surface, so its contacts are not the method's: nothing deeper than the margin is seen.
#include <BulletSoftBody/btSoftBody.h>

#include "clock.hpp"
#include "pairs.hpp"

namespace bench {
namespace {

class BulletPeer : public Peer {
 public:
  explicit BulletPeer(const Bodies& bodies) : bodies_(bodies), pairs_(bodies) {
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

 private:
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
    for (int side = 0; side < 2; ++side) {
      for (int i = before[side]; i < soft[side]->m_scontacts.size(); ++i) {
        const auto& found = soft[side]->m_scontacts[i];
        Contact contact{};
        contact.colliding = side == 0 ? a : b;
        contact.collided = side == 0 ? b : a;
        contact.vertex = uint32_t(found.m_node - &soft[side]->m_nodes[0]);
        contact.triangle = uint32_t(found.m_face - &soft[1 - side]->m_faces[0]);
        contacts.push_back(contact);
      }
    }
  }

  Bodies bodies_;
  Pairs pairs_;
  btSoftBodyWorldInfo world_;
  std::vector<std::unique_ptr<btSoftBody>> bodies_of_bullet_;
};

}  // namespace

std::unique_ptr<Peer> make_bullet(const std::string& method, const Bodies& bodies) {
  if (method == "bullet-vf") return std::make_unique<BulletPeer>(bodies);
  return nullptr;
}

}  // namespace bench
