// What one implicit step does with one contact, against the step's closed form: nearly rigid cubes on half-spaces.
#include <cmath>
#include <vector>

#include "bullet_bodies.hpp"
#include "expect.hpp"
#include "raycontact/bullet.hpp"
#include "soft_world.hpp"

namespace bullet = raycontact::bullet;

namespace {

constexpr double mass = 2, dt = 0.02, stiffness = 500;  // kg, s, N/m^3

bullet::ContactOptions options_with(double damping_time) {
  bullet::ContactOptions options;
  options.stiffness = stiffness;
  options.damping_time = damping_time;
  return options;
}

// A cube between a floor and a ceiling that it overlaps by `depth` each, so that nothing turns it.
class Squeezed {
 public:
  Squeezed(const bullet::ContactOptions& options, double floor_depth, double ceiling_depth,
           const btVector3& gravity = btVector3(0, 0, 0))
      : world_(1e6, 0.3, options, gravity),
        body_(world_.add(bullet::make_cage(cube.positions, cube.triangles, 1), mass)) {
    if (floor_depth > 0)
      world_.contact().add_half_space({btVector3(0, 1, 0), btScalar(floor_depth), btScalar(stiffness)});
    if (ceiling_depth > 0)
      world_.contact().add_half_space({btVector3(0, -1, 0), btScalar(ceiling_depth - 1), btScalar(stiffness)});
  }

  btVector3 velocity_after_step() {
    world_.step(dt);
    btVector3 momentum(0, 0, 0);
    for (int n = 0; n < body_.m_nodes.size(); ++n) momentum += body_.m_nodes[n].m_v / body_.m_nodes[n].m_im;
    return momentum / btScalar(mass);
  }

 private:
  demo::SoftWorld world_;
  btSoftBody& body_;
};

// Of the face of 1 m^2 that is pressed against a half-space, N/m.
constexpr double k = stiffness * 1;

// m v = dt K (depth - (dt + damping time) v): pushed out of the floor.
void along_the_normal() {
  for (const double damping_time : {0.0, 0.05, 0.5}) {
    Squeezed cube_on_floor(options_with(damping_time), 0.05, 0);
    const double v = dt * k * 0.05 / (mass + dt * k * (dt + damping_time));
    expect_near(double(cube_on_floor.velocity_after_step().y()), v, 0.01 * v, "normal",
                "velocity with a damping time of " + std::to_string(damping_time));
  }
}

// The same with the depth capped.
void depth_cap() {
  bullet::ContactOptions options = options_with(0.05);
  options.depth_cap = 0.01;
  Squeezed capped(options, 0.05, 0);
  const double v = dt * k * 0.01 / (mass + dt * k * (dt + 0.05));
  expect_near(double(capped.velocity_after_step().y()), v, 0.01 * v, "depth cap", "velocity");
  // A body at rest must be held however deep the cap lets it lie: what it would fall within the step is no depth.
  Squeezed falling(options, 0.01, 0, btVector3(0, -10, 0));
  const double held = (dt * k * 0.01 - dt * mass * 10) / (mass + dt * k * (dt + 0.05));
  expect_near(double(falling.velocity_after_step().y()), held, 0.01 * dt * 10, "depth cap", "velocity under gravity");
}

// Without friction nothing resists along the surface.
void across_the_normal() {
  Squeezed squeezed(options_with(0), 0.05, 0.05, btVector3(3, 0, 0));
  expect_near(double(squeezed.velocity_after_step().x()), dt * 3, 0.01 * dt * 3, "along the surface", "velocity");
}

// Friction that holds is a spring with the contact's stiffness and damping time: m v = dt (m g - K (dt + damping time)
// v).
void friction_that_holds() {
  bullet::ContactOptions options = options_with(0.05);
  options.friction = 100;
  Squeezed held(options, 0.05, 0.05, btVector3(3, 0, 0));
  const double v = dt * mass * 3 / (mass + dt * 2 * k * (dt + 0.05));
  expect_near(double(held.velocity_after_step().x()), v, 0.01 * v, "friction", "velocity");
}

void suggestions() {
  const char* test = "suggestions";
  const auto suggested = [](double poissons_ratio) {
    return bullet::ContactOptions::elastic(2000, poissons_ratio, 0.25).stiffness;
  };
  expect_near(suggested(0.3), 8000, 1e-9, test, "stiffness E / h");
  expect_near(suggested(0.45), 8000 / 0.3, 1e-9, test, "stiffness by the bulk modulus");
  expect_refusal([&] { suggested(0.5); }, test, "poissons_ratio");
  expect_near(bullet::suggested_depth_cap(2000, 0.2, 1e4), 0.05, 1e-12, test, "cap of a stiff contact, h / 4");
  expect_near(bullet::suggested_depth_cap(2000, 0.2, 4000, 0.1), 0.05, 1e-12, test, "cap of a soft one, E / k / 10");
}

}  // namespace

int main() {
  along_the_normal();
  depth_cap();
  across_the_normal();
  friction_that_holds();
  suggestions();
  return failures == 0 ? 0 : 1;
}
