// Rigid bodies that move: what they exchange with soft ones, and which are refused. Judged by the laws of mechanics.
#include <memory>

#include "bullet_bodies.hpp"
#include "expect.hpp"
#include "raycontact/bullet.hpp"
#include "shapes.hpp"
#include "soft_world.hpp"

namespace bullet = raycontact::bullet;

namespace {

/** A torus with ring radius 1 about y and tube radius 0.4, scaled. */
bullet::RigidSurface ring(btScalar scale) {
  const demo::Surface torus = demo::torus();
  bullet::RigidSurface surface{{}, torus.triangles};
  for (std::size_t i = 0; i < torus.positions.size(); i += 3) {
    const btVector3 point(btScalar(torus.positions[i]), btScalar(torus.positions[i + 1]),
                          btScalar(torus.positions[i + 2]));
    surface.points.push_back(scale * point);
  }
  return surface;
}

// In empty space a rigid ball, or a ring of triangles, meets a soft cube: what one loses the other gains, in every
// step.
void momentum_passes_between(bool is_ring) {
  const char* test = is_ring ? "momentum of a ring" : "momentum";
  demo::SoftWorld world(2e4, 0.3, stiff_contact());
  world.keep_momentum();
  btSoftBody& soft = world.add(cube_at(0, 0, 0), 3);
  btSphereShape shape(btScalar(0.4));
  const auto ball = rigid(shape, 2, btVector3(btScalar(-0.6), btScalar(0.4), btScalar(0.55)));
  ball->setLinearVelocity(btVector3(2, 0, 0));
  ball->setActivationState(DISABLE_DEACTIVATION);
  world.world().addRigidBody(ball.get(), 0, 0);
  world.contact().add_rigid_body(*ball, is_ring ? ring(btScalar(0.4 / 1.4)) : bullet::surface_of_shape(shape));
  const double dt = 0.02, lost = 4 * demo::SoftWorld::rounding;  // of 4 N s
  double most_force = 0;
  for (int step = 0; step < 100; ++step) {
    const btVector3 before = momentum(soft);
    world.step(dt);
    const btVector3 gained = momentum(soft) - before;
    const btVector3 force = world.contact().pair_force(soft, *ball);
    most_force = std::max(most_force, double(force.length()));
    expect_near(double((gained - btScalar(dt) * force).length()), 0, lost, test, "momentum gained without a force");
    const btVector3 back = world.contact().pair_force(*ball, soft);
    expect_near(double((force + back).length()), 0, 1e-6 * (1 + double(force.length())), test, "action and reaction");
  }
  const btVector3 total = momentum(soft) + 2 * ball->getLinearVelocity();
  expect_near(double((total - btVector3(4, 0, 0)).length()), 0, lost, test, "total momentum lost");
  expect(most_force > 10, test, "they have met");
  expect(double(ball->getLinearVelocity().x()) < 0.9, test, "the ball is slowed");
  expect(double(ball->getAngularVelocity().length()) > 1e-3, test, "the ball, hit off its middle, turns");
  world.contact().remove_rigid_body(*ball);
  world.world().removeRigidBody(ball.get());
}

// A ring flies past a soft cube that stands in its hole and touches nothing; its hull takes the cube along.
void a_cube_in_the_hole_of_a_ring() {
  for (const bool is_hull : {false, true}) {
    const char* test = is_hull ? "hull of a ring" : "hole of a ring";
    demo::SoftWorld world(2e4, 0.3, stiff_contact());
    world.keep_momentum();
    btSoftBody& soft = world.add(cube_at(-0.5, -0.5, -0.5), 3);
    btConvexHullShape hull;
    const bullet::RigidSurface torus = ring(2);
    for (const btVector3& point : torus.points) hull.addPoint(point);
    const auto flying = rigid(hull, 2, btVector3(0, btScalar(-1.5), 0));
    flying->setLinearVelocity(btVector3(0, 3, 0));
    flying->setActivationState(DISABLE_DEACTIVATION);
    world.world().addRigidBody(flying.get(), 0, 0);
    world.contact().add_rigid_body(*flying, is_hull ? bullet::surface_of_shape(hull) : torus);
    std::size_t contacts = 0;
    for (int step = 0; step < 50; ++step) {
      world.step(0.02);
      contacts += world.contact().contact_count();
    }
    if (is_hull) {
      expect(contacts > 0 && double(momentum(soft).y()) > 1, test, "the cube is taken along");
    } else {
      expect(contacts == 0, test, "nothing is touched");
      // Its own elasticity rounds.
      expect_near(double(momentum(soft).length()), 0, demo::SoftWorld::rounding, test, "momentum of the cube");
      expect_near(double(flying->getCenterOfMassPosition().y()), 1.5, 1e-4, test, "the ring is past the cube");
    }
    world.contact().remove_rigid_body(*flying);
    world.world().removeRigidBody(flying.get());
  }
}

/** Goes up at a steady speed. */
class Lift : public btMotionState {
 public:
  void getWorldTransform(btTransform& transform) const override {
    transform.setIdentity();
    transform.setOrigin(btVector3(0, height, 0));
  }
  void setWorldTransform(const btTransform&) override {}
  btScalar height = 0;
};

// A triangle mesh that the host moves: the cube on it goes with it, and weighs no more than at rest.
void a_lift() {
  const char* test = "lift";
  const double dt = 0.02, speed = 0.5;
  demo::SoftWorld world(2e4, 0.3, stiff_contact(), btVector3(0, -10, 0));
  btSoftBody& soft = world.add(cube_at(-0.5, 0, -0.5), 3);
  btTriangleMesh triangles;
  const btVector3 corners[4] = {{-3, 0, -3}, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}};
  triangles.addTriangle(corners[0], corners[1], corners[2]);
  triangles.addTriangle(corners[0], corners[2], corners[3]);
  btBvhTriangleMeshShape shape(&triangles, true);
  Lift lift;
  btRigidBody platform(btRigidBody::btRigidBodyConstructionInfo(0, &lift, &shape));
  platform.setCollisionFlags(platform.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
  platform.setActivationState(DISABLE_DEACTIVATION);
  world.world().addRigidBody(&platform, 0, 0);
  world.contact().add_rigid_body(platform);
  for (int step = 0; step < 150; ++step) {
    lift.height += btScalar(speed * dt);
    world.step(dt);
  }
  expect_near(double(platform.getCenterOfMassPosition().y()), 1.5, 1e-4, test, "height of the platform");
  expect_near(lowest(soft), double(platform.getCenterOfMassPosition().y()), 0.02, test, "the cube stands on it");
  expect_near(double(momentum(soft).y()) / 3, speed, 0.01, test, "speed of the cube");
  expect_near(double(world.contact().pair_force(soft, platform).y()), 30, 1, test, "it carries the weight");
  world.contact().remove_rigid_body(platform);
  world.world().removeRigidBody(&platform);
}

// A stiff contact and a light rigid body at a large step: the coupling is implicit, nothing blows up.
void light_ball_between_cubes() {
  const char* test = "light ball";
  demo::SoftWorld world(2e4, 0.3, stiff_contact(), btVector3(0, -10, 0));
  btSoftBody& soft = world.add(cube_at(-0.5, 0, -0.5), 30);
  world.contact().add_half_space({btVector3(0, 1, 0), 0, btScalar(1e5)});
  btSphereShape shape(btScalar(0.3));
  const auto ball = rigid(shape, 0.01, btVector3(0, btScalar(1.4), 0));
  ball->setActivationState(DISABLE_DEACTIVATION);
  world.world().addRigidBody(ball.get(), 0, 0);
  world.contact().add_rigid_body(*ball);
  double fastest = 0;
  for (int step = 0; step < 60; ++step) {
    world.step(0.05);
    fastest = std::max(fastest, double(ball->getLinearVelocity().length()));
  }
  expect(fastest < 5, test, "no explosion");
  expect_near(double(ball->getCenterOfMassPosition().y()), 1.3, 0.1, test, "height at rest");
  expect_near(double(world.contact().pair_force(*ball, soft).y()), 0.1, 0.02, test,
              "the cube carries the ball's weight");
  world.contact().remove_rigid_body(*ball);
  world.world().removeRigidBody(ball.get());
}

// A ball that sleeps in the air stays there until a soft cube touches it, and falls with what mass it has by then.
void a_ball_that_sleeps() {
  const char* test = "sleeping ball";
  demo::SoftWorld world(2e4, 0.3, stiff_contact(), btVector3(0, -10, 0));
  btSoftBody& soft = world.add(cube_at(-0.5, 1.2, -0.5), 3);
  btSphereShape shape(btScalar(0.4));
  const auto ball = rigid(shape, 1, btVector3(0, 0, 0));
  world.world().addRigidBody(ball.get(), 0, 0);
  world.contact().add_rigid_body(*ball);
  ball->forceActivationState(ISLAND_SLEEPING);
  int touched = -1;
  for (int step = 0; step < 40 && touched < 0; ++step) {
    world.step(0.02);
    if (world.contact().contact_count() > 0) touched = step;
    if (touched < 0)
      expect(double(ball->getCenterOfMassPosition().length()) == 0, test, "it stays until it is touched");
  }
  expect(touched > 5 && ball->isActive(), test, "the cube wakes it");
  ball->setMassProps(10, btVector3(1, 1, 1));
  world.world().setGravity(btVector3(0, 0, 0));  // of rigid bodies
  ball->setGravity(btVector3(0, 0, 0));
  const double before = double(momentum(soft).y()) + 10 * double(ball->getLinearVelocity().y());
  for (int step = 0; step < 5; ++step) world.step(0.02);
  const double after = double(momentum(soft).y()) + 10 * double(ball->getLinearVelocity().y());
  expect_near(after - before, -3 * 10 * 0.1, 0.05, test, "only the cube's weight changes the momentum of both");
  world.contact().remove_rigid_body(*ball);
  world.world().removeRigidBody(ball.get());
}

void bad_rigid_bodies() {
  const char* test = "bad rigid bodies";
  demo::SoftWorld world(2e4, 0.3, stiff_contact());
  btStaticPlaneShape plane(btVector3(0, 1, 0), 0);
  const auto floor = rigid(plane, 0, btVector3(0, 0, 0));
  expect_refusal([&] { world.contact().add_rigid_body(*floor); }, test, "half-space");
  expect_refusal([&] { world.contact().add_half_space({btVector3(0, 2, 0), 0, 1}); }, test, "normalise it");
  btBoxShape box(btVector3(1, 1, 1));
  const auto moving = rigid(box, 1, btVector3(0, 0, 0));
  bullet::ContactForce unregistered;
  expect_refusal([&] { unregistered.add_rigid_body(*moving); }, test, "register_with(world)");
  world.contact().add_rigid_body(*moving);
  expect_refusal([&] { world.contact().add_rigid_body(*moving); }, test, "added already");
  bullet::RigidSurface inward = bullet::surface_of_shape(box);
  std::swap(inward.triangles[0], inward.triangles[1]);
  world.contact().remove_rigid_body(*moving);
  expect_refusal([&] { world.contact().add_rigid_body(*moving, inward); }, test, "MESH");
  bullet::RigidSurface odd = bullet::surface_of_shape(box);
  odd.triangles.push_back(0);
  expect_refusal([&] { world.contact().add_rigid_body(*moving, odd); }, test, "no multiple of three");
}

}  // namespace

int main() {
  momentum_passes_between(false);
  momentum_passes_between(true);
  a_cube_in_the_hole_of_a_ring();
  a_lift();
  light_ball_between_cubes();
  a_ball_that_sleeps();
  bad_rigid_bodies();
  return failures == 0 ? 0 : 1;
}
