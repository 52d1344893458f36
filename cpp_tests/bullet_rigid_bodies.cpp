// Rigid bodies as collided surfaces, floors and friction: judged by the laws of mechanics.
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <cmath>
#include <memory>
#include <vector>

#include "expect.hpp"
#include "raycontact/bullet.hpp"
#include "shapes.hpp"
#include "soft_world.hpp"

namespace bullet = raycontact::bullet;

namespace {

const demo::Surface cube{
    "cube",
    {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1},
    {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5}};

bullet::Cage cube_at(double x, double y, double z) {
  demo::Surface moved = cube;
  demo::move(moved, {x, y, z});
  return bullet::make_cage(moved.positions, moved.triangles, 3);
}

bullet::ContactOptions stiff_contact(double friction = 0) {
  bullet::ContactOptions options;
  options.stiffness = 1e5;
  options.friction = friction;
  return options;
}

btVector3 momentum(const btSoftBody& body) {
  btVector3 sum(0, 0, 0);
  for (int n = 0; n < body.m_nodes.size(); ++n) sum += body.m_nodes[n].m_v / body.m_nodes[n].m_im;
  return sum;
}

double lowest(const btSoftBody& body) {
  double y = 1e9;
  for (int n = 0; n < body.m_nodes.size(); ++n) y = std::min(y, double(body.m_nodes[n].m_x.y()));
  return y;
}

std::unique_ptr<btRigidBody> rigid(btCollisionShape& shape, double mass, const btVector3& at) {
  btVector3 inertia(0, 0, 0);
  if (mass > 0) shape.calculateLocalInertia(btScalar(mass), inertia);
  auto body =
      std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo(btScalar(mass), nullptr, &shape, inertia));
  btTransform transform = btTransform::getIdentity();
  transform.setOrigin(at);
  body->setCenterOfMassTransform(transform);
  return body;
}

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

/** Counts contacts. */
class Drawer : public btIDebugDraw {
 public:
  void drawLine(const btVector3&, const btVector3&, const btVector3&) override {}
  void drawContactPoint(const btVector3&, const btVector3&, btScalar, int, const btVector3&) override { ++contacts; }
  void reportErrorWarning(const char*) override {}
  void draw3dText(const btVector3&, const char*) override {}
  void setDebugMode(int) override {}
  int getDebugMode() const override { return DBG_DrawAabb; }
  std::size_t contacts = 0;
};

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

// On a static hull, on an open triangle mesh and on a half-space a cube comes to rest; without them it falls.
void static_supports() {
  btBoxShape slab(btVector3(3, btScalar(0.5), 3));
  btTriangleMesh triangles;
  const btVector3 corners[4] = {{-3, 0, -3}, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}};
  triangles.addTriangle(corners[0], corners[1], corners[2]);
  triangles.addTriangle(corners[0], corners[2], corners[3]);
  btBvhTriangleMeshShape terrain(&triangles, true);
  for (int kind = 0; kind < 3; ++kind) {
    const char* test = kind == 0 ? "hull" : kind == 1 ? "terrain" : "half-space";
    demo::SoftWorld world(2e4, 0.3, stiff_contact(), btVector3(0, -10, 0));
    btSoftBody& soft = world.add(cube_at(-0.5, 0.1, -0.5), 3);
    std::unique_ptr<btRigidBody> support;
    if (kind < 2) {
      support = rigid(kind == 0 ? static_cast<btCollisionShape&>(slab) : terrain, 0,
                      btVector3(0, kind == 0 ? btScalar(-0.5) : 0, 0));
      world.world().addRigidBody(support.get(), 0, 0);
      world.contact().add_rigid_body(*support);
    } else {
      world.contact().add_half_space({btVector3(0, 1, 0), 0, btScalar(1e5)});
    }
    for (int step = 0; step < 100; ++step) world.step(0.02);
    expect_near(lowest(soft), 0, 0.02, test, "lowest point at rest");
    if (support) {
      expect_near(double(world.contact().pair_force(soft, *support).y()), 30, 1, test, "it carries the weight");
      world.contact().remove_rigid_body(*support);
      for (int step = 0; step < 50; ++step) world.step(0.02);
      expect(lowest(soft) < -1, test, "it falls when the support is gone");
      world.world().removeRigidBody(support.get());
    }
  }
}

// On a slope a cube slides with g (sin - mu cos), or stays where friction is larger than the slope.
void friction_on_a_slope() {
  const double angle = 0.3, g = 10;
  for (const double mu : {0.0, 0.15, 0.6}) {
    const char* test = "friction";
    demo::SoftWorld world(1e5, 0.3, stiff_contact(mu),
                          btVector3(btScalar(g * std::sin(angle)), btScalar(-g * std::cos(angle)), 0));
    btSoftBody& soft = world.add(cube_at(0, 0, 0), 3);
    world.contact().add_half_space({btVector3(0, 1, 0), 0, btScalar(1e5)});
    const int steps = 100;
    const double dt = 0.01;
    for (int step = 0; step < steps; ++step) world.step(dt);
    const double speed = double(momentum(soft).x()) / 3;
    const double expected = std::max(0.0, g * (std::sin(angle) - mu * std::cos(angle))) * steps * dt;
    expect_near(speed, expected, 0.05 * expected + 0.05, test, "speed down the slope with mu = " + std::to_string(mu));
  }
}

double farthest(const btSoftBody& body, const std::vector<btVector3>& from) {
  double way = 0;
  for (int n = 0; n < body.m_nodes.size(); ++n)
    way = std::max(way, double((body.m_nodes[n].m_x - from[std::size_t(n)]).length()));
  return way;
}

std::vector<btVector3> places(const btSoftBody& body) {
  std::vector<btVector3> x;
  for (int n = 0; n < body.m_nodes.size(); ++n) x.push_back(body.m_nodes[n].m_x);
  return x;
}

// Friction that holds does so for ever: two cubes, one on the other on a slope, and a static hull below or a
// half-space.
void no_creep_on_a_slope() {
  const double angle = 0.3, g = 10;
  btBoxShape slab(btVector3(3, btScalar(0.5), 3));
  for (const bool has_hull : {false, true}) {
    const char* test = has_hull ? "no creep on a hull" : "no creep on a half-space";
    bullet::ContactOptions options = stiff_contact(0.6);
    options.stiffness = 3e5;
    options.sampling = RAYC_SAMPLING_SPACING;
    options.sampling_value = 0.3;
    demo::SoftWorld world(1e5, 0.3, options,
                          btVector3(btScalar(g * std::sin(angle)), btScalar(-g * std::cos(angle)), 0));
    btSoftBody* bodies[2] = {&world.add(cube_at(-0.5, 0, -0.5), 3), &world.add(cube_at(-0.4, 1, -0.45), 3)};
    std::unique_ptr<btRigidBody> support;
    if (has_hull) {
      support = rigid(slab, 0, btVector3(0, btScalar(-0.5), 0));
      world.world().addRigidBody(support.get(), 0, 0);
      world.contact().add_rigid_body(*support);
    } else {
      world.contact().add_half_space({btVector3(0, 1, 0), 0, btScalar(3e5)});
    }
    for (int step = 0; step < 100; ++step) world.step(0.02);
    const std::vector<btVector3> settled[2] = {places(*bodies[0]), places(*bodies[1])};
    for (int step = 0; step < 150; ++step) world.step(0.02);
    for (std::size_t b = 0; b < 2; ++b)
      expect(farthest(*bodies[b], settled[b]) < 5e-6, test,
             "way in 150 steps at rest: " + std::to_string(farthest(*bodies[b], settled[b])));
    const btVector3 force = world.contact().pair_force(*bodies[1], *bodies[0]);
    expect_near(double(force.x()), -3 * g * std::sin(angle), 0.1, test, "friction carries the upper cube's pull");
    expect_near(double(force.y()), 3 * g * std::cos(angle), 0.1, test, "the lower cube carries its weight");
    if (support) {
      world.contact().remove_rigid_body(*support);
      world.world().removeRigidBody(support.get());
    }
  }
}

// On a height field and on a compound of two boxes a cube comes to rest; a body whose mask leaves them out falls
// through.
void more_shapes_and_masks() {
  const btScalar heights[16] = {};
  btHeightfieldTerrainShape field(4, 4, heights, btScalar(-1), btScalar(1), 1, false);
  field.setLocalScaling(btVector3(2, 1, 2));
  btBoxShape half(btVector3(btScalar(1.5), btScalar(0.5), 3));
  btCompoundShape slab;
  for (const double x : {-1.6, 1.6})
    slab.addChildShape(btTransform(btMatrix3x3::getIdentity(), btVector3(btScalar(x), btScalar(-0.5), 0)), &half);
  for (btCollisionShape* shape : {static_cast<btCollisionShape*>(&field), static_cast<btCollisionShape*>(&slab)})
    for (const bool is_masked : {false, true}) {
      const char* test = shape == &field ? "height field" : "compound";
      demo::SoftWorld world(2e4, 0.3, stiff_contact(), btVector3(0, -10, 0));
      btSoftBody& soft = world.add(cube_at(0.2, 0.1, -0.5), 3);
      const auto support = rigid(*shape, 0, btVector3(0, 0, 0));
      world.world().addRigidBody(support.get(), 0, 0);
      bullet::BodyOptions options;
      if (is_masked) options.group = 2, options.mask = ~uint32_t{1};
      world.contact().add_rigid_body(*support, options);
      for (int step = 0; step < 100; ++step) world.step(0.02);
      Drawer drawer;
      world.world().setDebugDrawer(&drawer);
      world.world().debugDrawWorld();
      if (is_masked) {
        expect(lowest(soft) < -1, test, "what its mask leaves out does not hold it");
        expect(drawer.contacts == 0, test, "nothing is drawn");
      } else {
        expect_near(lowest(soft), 0, 0.02, test, "lowest point at rest");
        expect_near(double(world.contact().pair_force(soft, *support).y()), 30, 1, test, "it carries the weight");
        expect(drawer.contacts > 0 && drawer.contacts == world.contact().contact_count(), test, "contacts are drawn");
      }
      world.world().setDebugDrawer(nullptr);
      world.contact().remove_rigid_body(*support);
      world.world().removeRigidBody(support.get());
    }
}

// A cube lies on a slab whose pair with it has a material of its own: as much deeper as it is softer.
void a_pair_of_its_own_material() {
  const char* test = "material of a pair";
  btBoxShape slab(btVector3(3, btScalar(0.5), 3));
  double depths[2];
  for (const bool is_softer : {false, true}) {
    demo::SoftWorld world(2e6, 0.3, stiff_contact(), btVector3(0, -10, 0));
    btSoftBody& soft = world.add(cube_at(-0.5, 0, -0.5), 30);
    const auto support = rigid(slab, 0, btVector3(0, btScalar(-0.5), 0));
    world.world().addRigidBody(support.get(), 0, 0);
    world.contact().add_rigid_body(*support);
    rayc_material material = raycontact::bearing_material(1e4, 1);
    if (is_softer) world.contact().set_pair_material(soft, *support, material);
    for (int step = 0; step < 200; ++step) world.step(0.02);
    depths[is_softer ? 1 : 0] = -lowest(soft);
    expect_near(double(world.contact().pair_force(soft, *support).y()), 300, 3, test, "it carries the weight");
    rayc_material negative = material;
    negative.stiffness = -1;
    expect_refusal([&] { world.contact().set_pair_material(soft, *support, negative); }, test, "stiffness is -1");
    world.contact().set_pair_material(soft, soft, material);
    world.step(0.02);  // a material of a body with itself changes nothing for the pair
    expect_near(-lowest(soft), depths[is_softer ? 1 : 0], 1e-4, test, "depth a step later");
    world.contact().remove_rigid_body(*support);
    expect_refusal([&] { world.contact().set_pair_material(soft, *support, material); }, test, "removed");
    world.world().removeRigidBody(support.get());
  }
  expect_near(depths[0], 0.003, 0.0006, test, "depth with the options' stiffness");
  expect_near(depths[1], 0.03, 0.002, test, "depth with a tenth of it");
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
  expect_refusal([&] { unregistered.add_rigid_body(*moving); }, test, "register_with(solver, world)");
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
  momentum_passes_between(false);
  momentum_passes_between(true);
  a_cube_in_the_hole_of_a_ring();
  a_lift();
  light_ball_between_cubes();
  static_supports();
  friction_on_a_slope();
  no_creep_on_a_slope();
  more_shapes_and_masks();
  a_pair_of_its_own_material();
  a_ball_that_sleeps();
  floors_of_bullets_own();
  one_answer_to_a_contact();
  bad_rigid_bodies();
  return failures == 0 ? 0 : 1;
}
