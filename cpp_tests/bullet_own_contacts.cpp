// Beside Bullet's own contacts: those with bodies that only Bullet knows stay as they were, and nothing is added to
// contact between bodies that raycontact knows.
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <algorithm>
#include <vector>

#include "bullet_bodies.hpp"
#include "expect.hpp"
#include "raycontact/bullet.hpp"
#include "soft_world.hpp"

namespace bullet = raycontact::bullet;

namespace {

using collision = btSoftBody::fCollision;

/** Where the nodes of a cube are that has fallen onto a floor which is Bullet's alone: a rigid body, or a multibody. */
std::vector<btScalar> on_a_floor_of_bullets(int flags, bool is_multibody, bool is_added) {
  // Bullet's own contacts fail with stiffer bodies in implicit worlds, whether they were added or not.
  demo::SoftWorld world(1000, 0.3, stiff_contact(), btVector3(0, -10, 0));
  btBoxShape slab(btVector3(5, 1, 5));
  const btVector3 below(0, -1, 0);
  const auto floor = rigid(slab, 0, below);
  btMultiBody links(0, 0, btVector3(0, 0, 0), true, false);
  btMultiBodyLinkCollider base(&links, -1);
  if (is_multibody) {
    links.setBasePos(below);
    links.finalizeMultiDof();
    base.setCollisionShape(&slab);
    base.setWorldTransform(floor->getWorldTransform());
    links.setBaseCollider(&base);
    world.world().addMultiBody(&links);
    world.world().addCollisionObject(&base);
  } else {
    world.world().addRigidBody(floor.get());
  }
  btSoftBody& soft = world.add(cube_at(0, 0.1, 0), 3);
  soft.m_cfg.collisions = flags;
  if (!is_added) world.contact().removeSoftBody(&soft);
  for (int step = 0; step < 120; ++step) world.step(1.0 / 60);
  std::vector<btScalar> positions;
  for (int n = 0; n < soft.m_nodes.size(); ++n)
    for (int axis = 0; axis < 3; ++axis) positions.push_back(soft.m_nodes[n].m_x[axis]);
  if (is_multibody) {
    world.world().removeCollisionObject(&base);
    world.world().removeMultiBody(&links);
  } else {
    world.world().removeRigidBody(floor.get());
  }
  return positions;
}

// With the flags of Bullet's examples: a body that is added meets Bullet's own bodies as one that is not, to the last
// digit.
void floors_of_bullets_own() {
  const struct {
    const char* test;
    int flags;
    bool is_multibody;
  } cases[] = {{"SDF_RDN", collision::SDF_RD | collision::SDF_RDN, false},
               {"SDF_RDF", collision::SDF_RD | collision::SDF_RDF, false},
               {"SDF_RDF and SDF_MDF", collision::SDF_RD | collision::SDF_RDF | collision::SDF_MDF, false},
               {"SDF_MDF on a multibody", collision::SDF_RD | collision::SDF_MDF, true}};
  for (const auto& [test, flags, is_multibody] : cases) {
    const std::vector<btScalar> added = on_a_floor_of_bullets(flags, is_multibody, true);
    double lowest_node = 1e9;
    for (std::size_t y = 1; y < added.size(); y += 3) lowest_node = std::min(lowest_node, double(added[y]));
    // Bullet keeps the distance of its margins, 0.03 and 0.04.
    expect_near(lowest_node, 0.035, 0.035, test, "the cube stands, and its lowest node");
    expect(added == on_a_floor_of_bullets(flags, is_multibody, false), test, "as one that was not added");
  }
}

// Bullet's own flags, and the continuous collision that any of them starts, add nothing to contact between bodies.
void one_answer_to_a_contact() {
  const char* test = "one answer";
  std::vector<btScalar> positions[2];
  for (const bool has_flags : {false, true}) {
    demo::SoftWorld world(2e4, 0.3, stiff_contact());
    btSoftBody* bodies[2] = {&world.add(cube_at(0, 0, 0), 3), &world.add(cube_at(0.3, 1.1, 0.2), 3)};
    for (int n = 0; n < bodies[1]->m_nodes.size(); ++n)
      bodies[1]->m_nodes[n].m_v = bodies[1]->m_nodes[n].m_vn = btVector3(0, -3, 0);
    for (btSoftBody* body : bodies) {
      if (has_flags)
        body->m_cfg.collisions = collision::SDF_RD | collision::SDF_RDN | collision::SDF_RDF | collision::SDF_MDF;
      body->setSelfCollision(true);
    }
    int seen = 0;
    std::size_t most = 0;
    for (int step = 0; step < 60; ++step) {
      world.step(1.0 / 60);
      most = std::max(most, world.contact().contact_count());
      for (btSoftBody* body : bodies) seen += body->m_faceNodeContactsCCD.size();
    }
    expect(most > 0, test, "they meet");
    expect((seen > 0) == has_flags, test, "Bullet's continuous collision sees them with flags only");
    for (btSoftBody* body : bodies)
      for (int n = 0; n < body->m_nodes.size(); ++n)
        for (int axis = 0; axis < 3; ++axis) positions[has_flags ? 1 : 0].push_back(body->m_nodes[n].m_x[axis]);
  }
  expect(positions[0] == positions[1], test, "the same to the last digit with flags and without");
}

}  // namespace

int main() {
  floors_of_bullets_own();
  one_answer_to_a_contact();
  return failures == 0 ? 0 : 1;
}
