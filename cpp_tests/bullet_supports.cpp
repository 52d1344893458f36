// Cubes on what carries them: static bodies of every shape, half-spaces, slopes with friction, and a material of a
// pair's own. Judged by the laws of mechanics.
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>

#include <cmath>
#include <memory>
#include <vector>

#include "bullet_bodies.hpp"
#include "expect.hpp"
#include "raycontact/bullet.hpp"
#include "soft_world.hpp"

namespace bullet = raycontact::bullet;

namespace {

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

// How deep the lower side of a body that stands on y = 0 lies in the middle: the mean over its area.
double mean_depth(const btSoftBody& soft) {
  double sum = 0, area = 0;
  for (int face = 0; face < soft.m_faces.size(); ++face) {
    btVector3 corners[3];
    for (int k = 0; k < 3; ++k) corners[k] = soft.m_faces[face].m_n[k]->m_x;
    const btVector3 doubled = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    const double middle = double(corners[0].y() + corners[1].y() + corners[2].y()) / 3;
    if (middle > 0.05 || std::abs(doubled.y()) < btScalar(0.9) * doubled.length()) continue;
    sum -= middle * double(doubled.length());
    area += double(doubled.length());
  }
  return sum / area;
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
    depths[is_softer ? 1 : 0] = mean_depth(soft);
    expect_near(double(world.contact().pair_force(soft, *support).y()), 300, 3, test, "it carries the weight");
    rayc_material negative = material;
    rayc_material bouncing = material;
    bouncing.restitution = 0.5;
    expect_refusal([&] { world.contact().set_pair_material(soft, *support, bouncing); }, test, "restitution is 0.5");
    negative.stiffness = -1;
    expect_refusal([&] { world.contact().set_pair_material(soft, *support, negative); }, test, "stiffness is -1");
    world.contact().set_pair_material(soft, soft, material);
    world.step(0.02);  // a material of a body with itself changes nothing for the pair
    expect_near(mean_depth(soft), depths[is_softer ? 1 : 0], 1e-4, test, "depth a step later");
    world.contact().remove_rigid_body(*support);
    expect_refusal([&] { world.contact().set_pair_material(soft, *support, material); }, test, "removed");
    world.world().removeRigidBody(support.get());
  }
  expect_near(depths[0], 0.003, 0.0006, test, "depth with the options' stiffness");
  expect_near(depths[1], 0.03, 0.002, test, "depth with a tenth of it");
}

}  // namespace

int main() {
  static_supports();
  more_shapes_and_masks();
  friction_on_a_slope();
  no_creep_on_a_slope();
  a_pair_of_its_own_material();
  return failures == 0 ? 0 : 1;
}
