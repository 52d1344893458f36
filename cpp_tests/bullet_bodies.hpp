// What the tests in Bullet share: cubes of a soft body, rigid bodies, and what is asked of them.
#ifndef BULLET_BODIES_HPP
#define BULLET_BODIES_HPP

#include <algorithm>
#include <memory>

#include "raycontact/bullet.hpp"
#include "shapes.hpp"

inline const demo::Surface cube{
    "cube",
    {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1},
    {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5}};

inline raycontact::bullet::Cage cube_at(double x, double y, double z) {
  demo::Surface moved = cube;
  demo::move(moved, {x, y, z});
  return raycontact::bullet::make_cage(moved.positions, moved.triangles, 3);
}

inline raycontact::bullet::ContactOptions stiff_contact(double friction = 0) {
  raycontact::bullet::ContactOptions options;
  options.stiffness = 1e5;
  options.friction = friction;
  return options;
}

inline btVector3 momentum(const btSoftBody& body) {
  btVector3 sum(0, 0, 0);
  for (int n = 0; n < body.m_nodes.size(); ++n) sum += body.m_nodes[n].m_v / body.m_nodes[n].m_im;
  return sum;
}

inline double lowest(const btSoftBody& body) {
  double y = 1e9;
  for (int n = 0; n < body.m_nodes.size(); ++n) y = std::min(y, double(body.m_nodes[n].m_x.y()));
  return y;
}

inline std::unique_ptr<btRigidBody> rigid(btCollisionShape& shape, double mass, const btVector3& at) {
  btVector3 inertia(0, 0, 0);
  if (mass > 0) shape.calculateLocalInertia(btScalar(mass), inertia);
  auto body =
      std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo(btScalar(mass), nullptr, &shape, inertia));
  btTransform transform = btTransform::getIdentity();
  transform.setOrigin(at);
  body->setCenterOfMassTransform(transform);
  return body;
}

#endif
