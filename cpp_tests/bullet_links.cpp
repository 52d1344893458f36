// Links of multibodies: what they exchange with soft bodies, what their motors bear, and which are refused. Judged by
// the laws of mechanics.
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "bullet_bodies.hpp"
#include "bullet_examples/scenes.hpp"
#include "expect.hpp"
#include "multibody.hpp"
#include "raycontact/bullet.hpp"
#include "soft_world.hpp"

namespace bullet = raycontact::bullet;

namespace {

// In empty space a base with a link that slides flies into a soft cube: what it loses the cube gains, and the joint
// gives way.
void momentum_passes_between() {
  const char* test = "momentum";
  demo::SoftWorld world(2e4, 0.3, stiff_contact());
  world.keep_momentum();
  btSoftBody& soft = world.add(cube_at(0, -0.5, -0.5), 3);
  btBoxShape box(btVector3(btScalar(0.2), btScalar(0.2), btScalar(0.2)));
  demo::Multibody hammer(world.world(), 1, 2, btVector3(btScalar(-1.2), 0, 0), false);
  hammer.add_slider(box, 1, btVector3(1, 0, 0), btVector3(btScalar(0.8), 0, 0));
  hammer.start(btVector3(2, 0, 0));
  world.contact().add_link(hammer.link(0));
  const double dt = 0.02, lost = 20 * demo::SoftWorld::rounding;
  double most_force = 0;
  for (int step = 0; step < 100; ++step) {
    const btVector3 before = momentum(soft);
    world.step(dt);
    const btVector3 force = world.contact().pair_force(soft, hammer.link(0));
    most_force = std::max(most_force, double(force.length()));
    expect_near(double((momentum(soft) - before - btScalar(dt) * force).length()), 0, lost, test,
                "momentum that the cube gained without a force");
  }
  // Bullet's own steps of a multibody that turns keep it to some millionths.
  const btVector3 total = momentum(soft) + hammer.momentum();
  expect_near(double((total - btVector3(6, 0, 0)).length()), 0, 6e-4, test, "total momentum lost");
  expect(most_force > 10, test, "they have met");
  expect(double(hammer.body().getJointVel(0)) < -0.5, test, "the link is pushed back along its joint");
  world.contact().remove_rigid_body(hammer.link(0));
}

// A cube falls onto a table that a motor holds up. The motor bears both, and if it cannot both sink as fast as what it
// does not bear makes them.
void a_motor_bears_the_weight() {
  for (const double most_force : {1000.0, 35.0}) {
    const bool holds = most_force > 40;
    const char* test = holds ? "motor" : "weak motor";
    const double dt = 1.0 / 60;
    demo::SoftWorld world(2e4, 0.3, stiff_contact(), btVector3(0, -10, 0));
    btSoftBody& soft = world.add(cube_at(-0.5, 0.02, -0.5), 3);
    btBoxShape slab(btVector3(2, btScalar(0.5), 2));
    demo::Multibody table(world.world(), 1, 1, btVector3(0, -2, 0), true);
    table.add_slider(slab, 1, btVector3(0, 1, 0), btVector3(0, btScalar(1.5), 0));
    table.start(btVector3(0, 0, 0));
    btMultiBodyJointMotor motor(&table.body(), 0, 0, 0, btScalar(1000 * dt));
    motor.finalizeMultiDof();
    world.world().addMultiBodyConstraint(&motor);
    world.contact().add_link(table.link(0));
    for (int step = 0; step < 120; ++step) world.step(dt);
    const double height = double(table.body().getJointPos(0)), speed = double(table.body().getJointVel(0));
    expect_near(double(world.contact().pair_force(table.link(0), soft).y()), -30, 0.3, test, "the cube's weight");
    expect_near(double(motor.getAppliedImpulse(0)) / dt, 40, 0.4, test, "what the motor bears");
    motor.setMaxAppliedImpulse(btScalar(most_force * dt));
    for (int step = 0; step < 30; ++step) world.step(dt);
    const double lost = holds ? 0 : (40 - most_force) / 4 * 30 * dt;
    expect_near(double(table.body().getJointVel(0)), speed - lost, 0.02, test, "speed of the table");
    expect_near(double(momentum(soft).y()) / 3, speed - lost, 0.02, test, "speed of the cube");
    if (holds) expect_near(double(table.body().getJointPos(0)), height, 1e-3, test, "height of the table");
    world.world().removeMultiBodyConstraint(&motor);
    world.contact().remove_rigid_body(table.link(0));
  }
}

// Two fingers grasp a soft cube, lift it off the floor and hold it for ten seconds.
void a_gripper_holds() {
  const char* test = "gripper";
  const double dt = 1.0 / 240;
  demo::Grasped scene(true);
  for (int step = 0; step < 480; ++step) scene.step(dt);
  const double taken = scene.below_base();
  for (int step = 0; step < 2400; ++step) scene.step(dt);
  expect_near(scene.below_base(), taken, 1e-4, test, "ten seconds later it");
  expect(taken < demo::Grasped::arm + 0.005, test, "the cube was lifted");
  expect(scene.fastest() < 1e-3, test, "at rest");
  expect(scene.inverted() == 0, test, "no element is inside out");
  const btVector3 up = scene.force_of_fingers();
  expect_near(double(up.y()), 0.1 * 9.81, 0.01, test, "the fingers carry its weight");
}

// The same at steps of 1/120 and 1/60 s. In the longer ones gravity alone would move the cube by nearly half the
// thickness of a finger.
void a_gripper_holds_in_long_steps() {
  for (const double steps : {120.0, 60.0}) {
    const char* test = steps > 100 ? "gripper, 1/120 s" : "gripper, 1/60 s";
    demo::Grasped scene(true);
    for (int step = 0; step < int(2.2 * steps); ++step) scene.step(1 / steps);
    const double taken = scene.below_base();
    for (int step = 0; step < int(10 * steps); ++step) scene.step(1 / steps);
    expect_near(scene.below_base(), taken, 1e-4, test, "ten seconds later it");
    expect(taken < demo::Grasped::arm + 0.005, test, "the cube was lifted");
    expect(scene.inverted() == 0, test, "no element is inside out");
    expect_near(double(scene.force_of_fingers().y()), 0.1 * 9.81, 0.02, test, "the fingers carry its weight");
  }
}

// A fixed base carries what stands on it, and a link that sleeps wakes when it is touched.
void bases_and_sleepers() {
  const char* test = "base";
  demo::SoftWorld world(2e4, 0.3, stiff_contact(), btVector3(0, -10, 0));
  btBoxShape slab(btVector3(2, btScalar(0.5), 2));
  demo::Multibody floor(world.world(), 0, 0, btVector3(0, btScalar(-0.5), 0), true);
  floor.set_base_shape(slab);
  floor.start(btVector3(0, 0, 0));
  btBoxShape box(btVector3(btScalar(0.3), btScalar(0.3), btScalar(0.3)));
  demo::Multibody sleeper(world.world(), 0, 1, btVector3(0, btScalar(1.7), 0), false);
  sleeper.set_base_shape(box);
  sleeper.start(btVector3(0, 0, 0));
  sleeper.body().setCanSleep(true);
  sleeper.body().goToSleep();
  sleeper.base().forceActivationState(ISLAND_SLEEPING);
  btSoftBody& soft = world.add(cube_at(-0.5, 0.1, -0.5), 3);
  world.contact().add_link(floor.base());
  world.contact().add_link(sleeper.base());
  for (int step = 0; step < 60; ++step) world.step(0.02);
  expect_near(lowest(soft), 0, 0.02, test, "lowest point at rest");
  expect_near(double(world.contact().pair_force(soft, floor.base()).y()), 30, 1, test, "it carries the weight");
  expect(double(sleeper.body().getBasePos().y()) == double(btScalar(1.7)), test,
         "the sleeper stays until it is touched");
  for (int n = 0; n < soft.m_nodes.size(); ++n) soft.m_nodes[n].m_v = soft.m_nodes[n].m_vn = btVector3(0, 6, 0);
  for (int step = 0; step < 10; ++step) world.step(0.02);
  expect(sleeper.body().isAwake() && double(sleeper.body().getBaseVel().y()) > 1, test, "the cube wakes and throws it");
  world.contact().remove_rigid_body(floor.base());
  world.contact().remove_rigid_body(sleeper.base());
}

void bad_links() {
  const char* test = "bad links";
  demo::SoftWorld world(2e4, 0.3, stiff_contact());
  btBoxShape box(btVector3(1, 1, 1));
  demo::Multibody arm(world.world(), 1, 1, btVector3(0, 0, 0), true);
  arm.add_slider(box, 0, btVector3(1, 0, 0), btVector3(1, 0, 0));
  arm.start(btVector3(0, 0, 0));
  expect_refusal([&] { world.contact().add_link(arm.link(0)); }, test, "link 0: its mass");
}

}  // namespace

int main() {
  momentum_passes_between();
  a_motor_bears_the_weight();
  a_gripper_holds();
  a_gripper_holds_in_long_steps();
  bases_and_sleepers();
  bad_links();
  return failures == 0 ? 0 : 1;
}
