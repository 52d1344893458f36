// Soft bodies beyond two that part: with themselves, pinned, added and removed while running, with Bullet's render mesh
// as skin, in the classic world; and what is refused.
#include <BulletSoftBody/btDeformableMassSpringForce.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "bullet_bodies.hpp"
#include "expect.hpp"
#include "inside_test.hpp"
#include "raycontact/bullet.hpp"
#include "shapes.hpp"
#include "soft_world.hpp"

namespace bullet = raycontact::bullet;

namespace {

bullet::ContactOptions contact_for(const bullet::Cage& cage) {
  return bullet::ContactOptions::elastic(2000, 0.3, cage.cell_edge);
}

bullet::Cage torus_at(double x, double y, double z) {
  demo::Surface torus = demo::torus(24, 12);
  demo::move(torus, {x, y, z});
  return bullet::make_cage(torus.positions, torus.triangles, {5, 1, 4});
}

// Two arms, above and below, joined at the left: a U lying on its side.
demo::Surface horseshoe() {
  demo::Surface surface{"horseshoe", {}, {}};
  const double pi = std::acos(-1.0);
  constexpr uint32_t along = 40;
  for (uint32_t i = 0; i <= along; ++i) {
    // The middle line: an arm of length 1.5, half a circle of radius 0.5, and the other arm.
    const double s = (1.5 * 2 + 0.5 * pi) * i / along;
    double x = 1.5 - s, y = 0.5, nx = 0, ny = 1;
    if (s > 1.5 + 0.5 * pi) {
      x = s - 1.5 - 0.5 * pi;
      y = -0.5;
      ny = -1;
    } else if (s > 1.5) {
      const double turn = pi / 2 + (s - 1.5) / 0.5;
      nx = std::cos(turn);
      ny = std::sin(turn);
      x = 0.5 * nx;
      y = 0.5 * ny;
    }
    for (int corner = 0; corner < 4; ++corner) {
      const double out = corner == 0 || corner == 3 ? -0.15 : 0.15, side = corner < 2 ? -0.3 : 0.3;
      surface.positions.insert(surface.positions.end(), {x + out * nx, y + out * ny, side});
    }
  }
  for (uint32_t i = 0; i < along; ++i)
    for (uint32_t c = 0; c < 4; ++c) {
      const uint32_t a = 4 * i + c, b = 4 * i + (c + 1) % 4, d = a + 4, e = b + 4;
      surface.triangles.insert(surface.triangles.end(), {a, d, b, b, d, e});
    }
  const uint32_t last = 4 * along;
  surface.triangles.insert(surface.triangles.end(),
                           {0, 1, 2, 0, 2, 3, last, last + 2, last + 1, last, last + 3, last + 2});
  if (demo::volume(surface) < 0)
    for (std::size_t t = 0; t < surface.triangles.size(); t += 3)
      std::swap(surface.triangles[t], surface.triangles[t + 1]);
  return surface;
}

// The arms of a horseshoe swing towards one another. Returns by how much the upper one has come to lie below the lower.
double swing(bool self_collision, const char* test) {
  const demo::Surface surface = horseshoe();
  const bullet::Cage cage = bullet::make_cage(surface.positions, surface.triangles, 14);
  demo::SoftWorld world(2000, 0.3, contact_for(cage));
  world.keep_momentum();
  bullet::BodyOptions options;
  options.self_collision = self_collision;
  btSoftBody& body = world.add(cage, 10, options);
  for (int n = 0; n < body.m_nodes.size(); ++n) {
    btSoftBody::Node& node = body.m_nodes[n];
    if (node.m_x.x() > 0) node.m_v = node.m_vn = btVector3(0, node.m_x.y() > 0 ? btScalar(-6) : btScalar(6), 0);
  }
  const btVector3 before = momentum(body);
  std::size_t most = 0;
  double deepest = -1;
  for (int step = 0; step < 40; ++step) {
    world.step(0.01);
    most = std::max(most, world.contact().contact_count());
    for (const rayc_contact& contact : world.contact().contacts())
      expect(contact.colliding == 0 && contact.collided == 0, test, "contacts are of the body with itself");
    std::vector<btScalar> x;
    bullet::skin_positions(body, cage.skin, x);
    deepest = std::max(deepest, double(x[3 * 160 + 1] - x[1]));  // the lower arm's end above the upper arm's
  }
  expect((most > 0) == self_collision, test, "contacts if and only if they are asked for");
  // Its 10 kg, of which the arms start at 6 m/s.
  const double gained = double((momentum(body) - before).length());
  expect(gained < 10 * demo::SoftWorld::rounding, test, "a body does not push itself away");
  return deepest;
}

void self_collision() {
  const double without = swing(false, "self-collision off"), with = swing(true, "self-collision on");
  std::printf("arms pass by %.3f without, %.3f with self-collision\n", without, with);
  expect(without > 0.2, "self-collision off", "the arms pass through one another");
  expect(with < 0.15, "self-collision on", "the arms are stopped by one another");
}

void pinned_nodes() {
  const char* test = "pinned";
  const bullet::Cage cage = torus_at(0, 0, 0), falling = torus_at(0, 1.2, 0);
  demo::SoftWorld world(2000, 0.3, contact_for(cage), btVector3(0, -10, 0));
  btSoftBody& held = world.add(cage, 1);
  world.add(falling, 1);
  std::vector<btVector3> before;
  for (int n = 0; n < held.m_nodes.size(); ++n) {
    if (n % 3 == 0) held.setMass(n, 0);
    before.push_back(held.m_nodes[n].m_x);
  }
  for (int step = 0; step < 60; ++step) world.step(0.02);
  expect(world.contact().contact_count() > 0, test, "they touch");
  for (int n = 0; n < held.m_nodes.size(); n += 3)
    expect_near(double((held.m_nodes[n].m_x - before[std::size_t(n)]).length()), 0, 1e-6, test, "way of a pinned node");
}

// A cube that hangs by Bullet's anchors on a still body meets another: the anchors stay, and what flew is thrown back.
void anchored_nodes() {
  const char* test = "anchors";
  demo::SoftWorld world(2e4, 0.3, stiff_contact());
  btSoftBody& held = world.add(cube_at(-0.5, 0, -0.5), 3);
  btBoxShape box(btVector3(btScalar(0.5), btScalar(0.1), btScalar(0.5)));
  const auto carrier = rigid(box, 0, btVector3(0, btScalar(1.1), 0));
  world.world().addRigidBody(carrier.get(), 0, 0);
  for (int n = 0; n < held.m_nodes.size(); ++n)
    if (held.m_nodes[n].m_x.y() > btScalar(0.99)) held.appendDeformableAnchor(n, carrier.get());
  btSoftBody& flying = world.add(cube_at(-0.5, -1.2, -0.5), 1);
  flying.setVelocity(btVector3(0, 4, 0));
  double most_force = 0;
  for (int step = 0; step < 60; ++step) {
    world.step(1.0 / 60);
    most_force = std::max(most_force, double(world.contact().pair_force(held, flying).y()));
    for (int a = 0; a < held.m_deformableAnchors.size(); ++a) {
      const auto& anchor = held.m_deformableAnchors[a];
      const btVector3 off = carrier->getWorldTransform() * anchor.m_local - anchor.m_node->m_x;
      expect_near(double(off.length()), 0, 1e-5, test, "an anchor's way from its place");
    }
  }
  expect(most_force > 10, test, "the cubes have met");
  expect(double(momentum(flying).y()) < 0, test, "what flew is thrown back");
  world.world().removeRigidBody(carrier.get());
}

void bodies_come_and_go() {
  const char* test = "come and go";
  const bullet::Cage a = torus_at(0, 0, 0), b = torus_at(0.25, 0.1, 0.3), c = torus_at(-0.3, 0.2, 0);
  demo::SoftWorld world(2000, 0.3, contact_for(a));
  btSoftBody& first = world.add(a, 1);
  world.step(0.02);
  expect(world.contact().contact_count() == 0, test, "one body touches nothing");
  btSoftBody& second = world.add(b, 1);
  world.step(0.02);
  expect(world.contact().contact_count() > 0, test, "the second is met");
  expect(world.contact().last_detection_ms() > 0, test, "detection takes some time");
  btSoftBody& third = world.add(c, 1);
  world.step(0.02);
  world.remove(second);
  world.step(0.02);
  for (const rayc_contact& contact : world.contact().contacts())
    expect(contact.colliding < 2 && contact.collided < 2, test, "bodies count in the order in which they were added");
  expect_refusal([&] { world.contact().pair_force(first, second); }, test, "removed");
  for (int step = 0; step < 60; ++step) world.step(0.02);
  expect(world.contact().contact_count() == 0, test, "the other two part");
  expect(double(world.contact().pair_force(first, third).length()) == 0, test, "no contact, no force");
}

void render_mesh_as_skin() {
  const char* test = "render mesh";
  const bullet::Cage cage = torus_at(0, 0, 0);
  btSoftBodyWorldInfo info;
  const auto body = bullet::make_soft_body(info, cage, 1);
  expect_refusal([&] { bullet::skin_from_render_mesh(*body); }, test, "no render mesh");
  body->m_renderNodes.resize(static_cast<int>(cage.skin.points.size()));
  std::vector<btScalar> positions;
  bullet::skin_positions(*body, cage.skin, positions);
  for (int i = 0; i < body->m_renderNodes.size(); ++i)
    body->m_renderNodes[i].m_x =
        btVector3(positions[std::size_t(3 * i)], positions[std::size_t(3 * i + 1)], positions[std::size_t(3 * i + 2)]);
  for (std::size_t t = 0; t < cage.skin.triangles.size(); t += 3) {
    btSoftBody::RenderFace face;
    for (std::size_t k = 0; k < 3; ++k)
      face.m_n[k] = &body->m_renderNodes[static_cast<int>(cage.skin.triangles[t + k])];
    body->m_renderFaces.push_back(face);
  }
  expect_refusal([&] { bullet::skin_from_render_mesh(*body); }, test, "interpolateBarycentricWeights");
  btSoftBodyHelpers::interpolateBarycentricWeights(body.get());
  const bullet::Skin skin = bullet::skin_from_render_mesh(*body);
  for (int n = 0; n < body->m_nodes.size(); ++n) body->m_nodes[n].m_x += btVector3(1, 2, 3);
  std::vector<btScalar> moved;
  bullet::skin_positions(*body, skin, moved);
  expect(skin.triangles == cage.skin.triangles, test, "the same triangles");
  for (std::size_t i = 0; i < moved.size(); ++i)
    expect_near(double(moved[i] - positions[i]), double(i % 3 + 1), 1e-4, test, "way of a coordinate of the skin");
}

void classic_bodies() {
  const char* test = "classic";
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  world.setGravity(btVector3(0, 0, 0));
  world.getWorldInfo().m_gravity.setZero();
  const bullet::Cage cages[2] = {torus_at(0, 0, 0), torus_at(0.25, 0.1, 0.3)};
  bullet::ClassicContact contact;
  std::vector<std::unique_ptr<btSoftBody>> bodies;
  for (const bullet::Cage& cage : cages) {
    bodies.push_back(bullet::make_soft_body(world.getWorldInfo(), cage, 1));
    world.addSoftBody(bodies.back().get());
    contact.add_body(*bodies.back(), cage.skin);
  }
  const double dt = 0.02;
  for (int step = 0; step < 100; ++step) {
    world.stepSimulation(btScalar(dt), 0);
    contact.apply(dt);
    if (step == 0) expect(contact.contact_count() > 30, test, "contacts at the start, as far apart as nodes");
  }
  expect(contact.contact_count() == 0, test, "the tori have parted");
  expect_refusal([&] { contact.apply(0); }, test, "above 0");
  contact.remove_body(*bodies[0]);
  contact.apply(dt);
  for (const auto& body : bodies) world.removeSoftBody(body.get());
}

// A classic torus falls onto a half-space or a rigid box and stays above; a rigid ball that meets it is slowed.
void classic_bodies_and_rigid_ones() {
  for (const bool has_box : {false, true}) {
    const char* test = has_box ? "classic on a box" : "classic on a half-space";
    btSoftBodyRigidBodyCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
    world.getWorldInfo().m_gravity = btVector3(0, -10, 0);
    const bullet::Cage cage = torus_at(0, 0.6, 0);
    const auto body = bullet::make_soft_body(world.getWorldInfo(), cage, 1);
    world.addSoftBody(body.get());
    btBoxShape slab(btVector3(3, 1, 3));
    btSphereShape sphere(btScalar(0.4));
    btRigidBody box(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &slab));
    btRigidBody ball(btRigidBody::btRigidBodyConstructionInfo(1, nullptr, &sphere, btVector3(1, 1, 1)));
    box.setWorldTransform(btTransform(btMatrix3x3::getIdentity(), btVector3(0, -1, 0)));
    ball.setWorldTransform(btTransform(btMatrix3x3::getIdentity(), btVector3(-3, btScalar(0.4), 0)));
    ball.setLinearVelocity(btVector3(2, 0, 0));
    ball.setActivationState(DISABLE_DEACTIVATION);
    bullet::ClassicContact contact;
    contact.add_body(*body, cage.skin);
    contact.add_rigid_body(ball);
    if (has_box)
      contact.add_rigid_body(box);
    else
      contact.add_half_space({btVector3(0, 1, 0), 0, 1000});
    // Classic worlds handle soft and rigid bodies' own contacts by themselves: these are the adapter's alone.
    world.addRigidBody(&ball, 0, 0);
    ball.setGravity(btVector3(0, 0, 0));
    std::size_t most = 0;
    for (int step = 0; step < 75; ++step) {
      world.stepSimulation(btScalar(0.02), 0);
      contact.apply(0.02);
      most = std::max(most, contact.contact_count());
    }
    std::vector<btScalar> x;
    bullet::skin_positions(*body, cage.skin, x);
    btScalar lowest = x[1];
    for (std::size_t i = 1; i < x.size(); i += 3) lowest = std::min(lowest, x[i]);
    expect(double(lowest) > -0.1, test, "lowest point is " + std::to_string(double(lowest)));
    expect(double(lowest) < 0.1, test, "it has come down: " + std::to_string(double(lowest)));
    expect(double(ball.getLinearVelocity().x()) < 1.9, test,
           "the ball is slowed: " + std::to_string(double(ball.getLinearVelocity().x())));
    expect(most > 0 && contact.last_detection_ms() > 0, test, "contacts found, in some time");
    world.removeRigidBody(&ball);
    world.removeSoftBody(body.get());
  }
}

template <class Spoil>
void refused(Spoil spoil, const char* part) {
  const bullet::Cage cage = torus_at(0, 0, 0);
  demo::SoftWorld world(2000, 0.3, {});
  const auto body = bullet::make_soft_body(world.world().getWorldInfo(), cage, 1);
  bullet::Skin skin = cage.skin;
  spoil(*body, skin);
  expect_refusal([&] { world.contact().add_body(*body, skin); }, "refused", part);
}

// Cloth, which is open, and a closed shell that nothing fills: the message says what either may do.
void surfaces_are_no_solids() {
  const char* test = "cloth";
  btSoftBodyWorldInfo info;
  const std::unique_ptr<btSoftBody> cloth(btSoftBodyHelpers::CreatePatch(
      info, btVector3(0, 0, 0), btVector3(1, 0, 0), btVector3(0, 0, 1), btVector3(1, 0, 1), 5, 5, 0, true));
  const char* advice = "leave cloth to Bullet's own contact";
  bullet::ContactForce contact;
  expect_refusal([&] { contact.add_body(*cloth); }, test, "cloth, an open surface");
  expect_refusal([&] { contact.add_body(*cloth); }, test, advice);
  bullet::ClassicContact classic;
  expect_refusal([&] { classic.add_body(*cloth); }, test, "MESH_OPEN");
  expect_refusal([&] { classic.add_body(*cloth); }, test, advice);
  refused([](btSoftBody& b, bullet::Skin&) { b.m_tetras.clear(); }, "fill a closed shell with appendTetra");
}

// Square cloth of 1 kg at a height, in none of Bullet's own contacts; its front is below.
std::unique_ptr<btSoftBody> level_cloth(demo::SoftWorld& world, btScalar half, btScalar h, int nodes) {
  std::unique_ptr<btSoftBody> cloth(btSoftBodyHelpers::CreatePatch(
      world.world().getWorldInfo(), btVector3(-half, h, -half), btVector3(half, h, -half), btVector3(-half, h, half),
      btVector3(half, h, half), nodes, nodes, 0, true));
  cloth->setTotalMass(1);
  cloth->m_cfg.collisions = 0;
  cloth->setActivationState(DISABLE_DEACTIVATION);
  return cloth;
}

// Cloth falls onto a rigid ball or onto a pinned soft cube that its front faces, and comes to lie on it.
void cloth_on_volumes() {
  for (const bool is_soft : {false, true}) {
    const char* test = is_soft ? "cloth on a cube" : "cloth on a ball";
    bullet::ContactOptions options;
    options.stiffness = 1e4;
    options.friction = 0.5;
    btDeformableMassSpringForce springs(100, 1, true);
    btDeformableGravityForce weight(btVector3(0, -10, 0));
    demo::SoftWorld world(2e4, 0.3, options, btVector3(0, -10, 0));
    btSphereShape shape(1);
    const auto ball = rigid(shape, 0, btVector3(0, 0, 0));
    btSoftBody& soft = world.add(cube_at(-0.5, is_soft ? 0 : -9, -0.5), 10);
    for (int n = 0; n < soft.m_nodes.size(); ++n)
      if (soft.m_nodes[n].m_x.y() < btScalar(0.01)) soft.setMass(n, 0);
    if (!is_soft) {
      world.world().addRigidBody(ball.get(), 0, 0);
      world.contact().add_rigid_body(*ball);
    }
    const auto cloth = level_cloth(world, 1, btScalar(1.1), 15);
    world.world().addSoftBody(cloth.get());
    world.world().addForce(cloth.get(), &springs);
    world.world().addForce(cloth.get(), &weight);
    bullet::BodyOptions open;
    open.open = true;
    world.contact().add_body(*cloth, open);
    const btCollisionObject& below = is_soft ? static_cast<const btCollisionObject&>(soft) : *ball;
    double borne = 0;
    for (int step = 0; step < 480; ++step) {
      world.step(1.0 / 240);
      if (step >= 360) borne += double(world.contact().pair_force(*cloth, below).y()) / 120;
    }
    double highest = -1e9, deepest = 0, deepest_of_border = 0;
    for (int n = 0; n < cloth->m_nodes.size(); ++n) {
      highest = std::max(highest, double(cloth->m_nodes[n].m_x.y()));
      const bool is_border = std::min(n / 15, n % 15) == 0 || std::max(n / 15, n % 15) == 14;
      double& deepest_there = is_border ? deepest_of_border : deepest;
      deepest_there = std::max(deepest_there, 1 - double(cloth->m_nodes[n].m_x.length()));
    }
    expect_near(highest, 1, 0.05, test, "its highest node");
    if (!is_soft) {
      expect_near(deepest, 0, 0.02, test, "its deepest node below the ball's surface");
      // A sheet pushes less towards its border.
      expect_near(deepest_of_border, 0, 0.06, test, "the deepest node of its border");
    }
    expect_near(borne, 10, 2, test, "the weight that is borne, while it still swings");
    world.world().removeSoftBody(cloth.get());
    if (!is_soft) {
      world.contact().remove_rigid_body(*ball);
      world.world().removeRigidBody(ball.get());
    }
  }
}

// Cloth that resists bending a little, with damping across its springs too, falls onto a torus 2.8 m wide. After 3 s it
// lies still, and no node was ever deeper than 1 % of that.
void cloth_lies_still_on_a_torus() {
  const char* test = "cloth on a torus";
  bullet::ContactOptions options;
  options.stiffness = 1e4;
  options.friction = 0.5;
  btDeformableMassSpringForce springs(100, btScalar(0.005), false);
  btDeformableGravityForce weight(btVector3(0, -10, 0));
  demo::SoftWorld world(2e4, 0.3, options, btVector3(0, -10, 0));
  const demo::Surface ring = demo::torus(48, 24);
  const auto corner = [&](std::size_t i) {
    const double* x = &ring.positions[3 * ring.triangles[i]];
    return btVector3(btScalar(x[0]), btScalar(x[1]), btScalar(x[2]));
  };
  btTriangleMesh triangles;
  for (std::size_t i = 0; i < ring.triangles.size(); i += 3)
    triangles.addTriangle(corner(i), corner(i + 1), corner(i + 2));
  btBvhTriangleMeshShape shape(&triangles, true);
  const auto below = rigid(shape, 0, btVector3(0, 0, 0));
  world.world().addRigidBody(below.get(), 0, 0);
  world.contact().add_rigid_body(*below);
  const auto cloth = level_cloth(world, btScalar(1.6), btScalar(0.5), 29);
  cloth->generateBendingConstraints(2);
  world.world().addSoftBody(cloth.get());
  world.world().addForce(cloth.get(), &springs);
  world.world().addForce(cloth.get(), &weight);
  bullet::BodyOptions open;
  open.open = true;
  world.contact().add_body(*cloth, open);
  double deepest = 0, fastest = 0, lowest = 1e9;
  for (int step = 1; step <= 360; ++step) {
    world.step(1.0 / 120);
    for (int n = 0; n < cloth->m_nodes.size(); ++n) {
      const btVector3& x = cloth->m_nodes[n].m_x;
      deepest = std::max(deepest, 0.4 - std::hypot(std::hypot(double(x.x()), double(x.z())) - 1, double(x.y())));
      if (step < 360) continue;
      fastest = std::max(fastest, double(cloth->m_nodes[n].m_v.length()));
      lowest = std::min(lowest, double(x.y()));
    }
  }
  expect_near(deepest, 0, 0.028, test, "the deepest node at any time");
  expect_near(fastest, 0, 0.02, test, "the fastest node after 3 s");
  expect_near(lowest, -0.6, 0.2, test, "the lowest node of its border");
  world.world().removeSoftBody(cloth.get());
  world.contact().remove_rigid_body(*below);
  world.world().removeRigidBody(below.get());
}

void bad_bodies() {
  refused([](btSoftBody& b, bullet::Skin&) { std::swap(b.m_tetras[3].m_n[0], b.m_tetras[3].m_n[1]); }, "tetrahedron 3");
  refused([](btSoftBody& b, bullet::Skin&) { b.m_tetras[2].m_element_measure = 0; }, "initializeDmInverse");
  refused([](btSoftBody& b, bullet::Skin&) { b.m_links.clear(); }, "appendLink");
  refused([](btSoftBody& b, bullet::Skin&) { b.m_tetraScratches.resize(1); }, "m_tetraScratches");
  refused([](btSoftBody& b, bullet::Skin&) { b.m_cfg.collisions = btSoftBody::fCollision::VF_DD; }, "VF_DD");
  refused([](btSoftBody& b, bullet::Skin&) { b.forceActivationState(ACTIVE_TAG); }, "DISABLE_DEACTIVATION");
  refused([](btSoftBody&, bullet::Skin& s) { s.points[7].nodes[2] = 9999; }, "skin point 7");
  refused([](btSoftBody&, bullet::Skin& s) { s.triangles[4] = 9999; }, "skin triangle 1");
  refused([](btSoftBody&, bullet::Skin& s) { s.triangles.resize(s.triangles.size() - 3); }, "MESH_OPEN");
  refused(
      [](btSoftBody&, bullet::Skin& s) {
        for (std::size_t t = 0; t < s.triangles.size(); t += 3) std::swap(s.triangles[t], s.triangles[t + 1]);
      },
      "MESH_INWARD");
  refused([](btSoftBody&, bullet::Skin& s) { s.triangles.push_back(0); }, "no multiple of three");
  const demo::Surface torus = demo::torus(12, 6);
  std::vector<double> positions = torus.positions;
  std::vector<uint32_t> triangles = torus.triangles;
  positions.push_back(0);
  triangles.resize(triangles.size() - 1);
  const char* said = "no multiple of three";
  expect_refusal([&] { bullet::make_cage(positions, torus.triangles); }, "a number too many", said);
  expect_refusal([&] { bullet::make_cage(torus.positions, triangles); }, "a number too few", said);
  expect_refusal([&] { bullet::make_cage(torus.positions, triangles, {{2, 2, 2}}); }, "a number too few", said);
  expect_refusal([&] { demo::InsideTest(positions, torus.triangles); }, "a number too many", said);
  expect_refusal([&] { demo::InsideTest(torus.positions, triangles); }, "a number too few", said);
  bullet::ContactOptions options;
  options.damping_time = -1;
  expect_refusal([&] { bullet::ContactForce contact(options); }, "options", "damping_time");
  options.damping_time = 0;
  options.depth_cap = 0;
  expect_refusal([&] { bullet::ContactForce contact(options); }, "options", "depth_cap");
  options.depth_cap = 1;
  options.sampling_value = -0.1;
  expect_refusal([&] { bullet::ContactForce contact(options); }, "options", "sampling_value");

  const bullet::Cage cage = torus_at(0, 0, 0);
  demo::SoftWorld world(2000, 0.3, contact_for(cage));
  btSoftBody& body = world.add(cage, 1);
  bullet::ContactForce unregistered;
  expect_refusal([&] { unregistered.add_body(body, cage.skin); }, "unregistered", "call register_with(world)");

  // register_with() has set the world, and what would not work is said where it is set anew.
  btDeformableMultiBodyDynamicsWorld& settings = world.world();
  settings.setLineSearch(true);
  settings.setImplicit(false);
  expect_refusal([&] { world.step(0.02); }, "settings changed later", "setImplicit(true)");
  settings.setImplicit(true);
  expect_refusal([&] { world.step(0.02); }, "settings changed later", "setLineSearch(false)");
  settings.setLineSearch(false);
  world.step(0.02);
}

}  // namespace

int main() {
  self_collision();
  pinned_nodes();
  anchored_nodes();
  bodies_come_and_go();
  render_mesh_as_skin();
  classic_bodies();
  classic_bodies_and_rigid_ones();
  surfaces_are_no_solids();
  cloth_on_volumes();
  cloth_lies_still_on_a_torus();
  bad_bodies();
  return failures == 0 ? 0 : 1;
}
