// The adapter in Debian's unmodified Bullet: bodies that start deep inside one another come apart, unharmed. Compiled
// once against the float build and once against the double build.
#include <cmath>
#include <cstdio>
#include <vector>

#include "raycontact/bullet.hpp"
#include "shapes.hpp"
#include "soft_world.hpp"

namespace bullet = raycontact::bullet;

std::size_t points_of_own_faces(const btSoftBody& body);  // in bullet_second_unit.cpp

namespace {

constexpr double youngs_modulus = 2000, poisson_ratio = 0.3, time_step = 0.02;
int failures = 0;

void expect(bool condition, const char* scene, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "%s: failed: %s\n", scene, what);
  ++failures;
}

// |sum of m v| over the sum of m |v|: contact forces must not push the pair as a whole.
double momentum_share(const std::vector<btSoftBody*>& bodies) {
  btVector3 momentum(0, 0, 0);
  double motion = 0;
  for (const btSoftBody* body : bodies)
    for (int i = 0; i < body->m_nodes.size(); ++i) {
      const btSoftBody::Node& node = body->m_nodes[i];
      momentum += node.m_v / node.m_im;
      motion += double(node.m_v.length() / node.m_im);
    }
  return motion > 0 ? double(momentum.length()) / motion : 0;
}

// Gives the number of contacts at the start.
std::size_t parts(const char* scene, const bullet::Cage& first, const bullet::Cage& second, std::size_t least_contacts,
                  rayc_sampling sampling = RAYC_SAMPLING_ACCURACY) {
  bullet::ContactOptions options = bullet::ContactOptions::elastic(youngs_modulus, poisson_ratio, first.cell_edge);
  options.sampling = sampling;
  demo::SoftWorld world(youngs_modulus, poisson_ratio, options);
  world.keep_momentum();
  const std::vector<btSoftBody*> bodies{&world.add(first, 1), &world.add(second, 1)};

  world.step(time_step);
  const std::size_t contacts_at_start = world.contact().contact_count();
  expect(contacts_at_start >= least_contacts, scene, "enough contacts at the start");
  int steps = 1;
  while (world.contact().contact_count() > 0 && steps < 100) {
    world.step(time_step);
    ++steps;
  }
  int inverted = 0;
  for (const btSoftBody* body : bodies) inverted += bullet::inverted_tetrahedra(*body);
  const double share = momentum_share(bodies);
  std::printf("%s: %zu contacts at the start, %zu after %d steps, %d inverted, momentum share %.1e\n", scene,
              contacts_at_start, world.contact().contact_count(), steps, inverted, share);
  expect(world.contact().contact_count() == 0, scene, "no contact after 100 steps");
  expect(inverted == 0, scene, "no tetrahedron is inverted");
  // With thousands of contacts a step, single precision spends up to 3.3e-6 by rounding.
  expect(share < 10 * demo::SoftWorld::rounding, scene, "momentum is kept");
  return contacts_at_start;
}

void skins_in_cages() {
  demo::Surface first = demo::torus(24, 12), second = first;
  demo::move(second, {0.25, 0.1, 0.3});
  parts("skins in cages", bullet::make_cage(first.positions, first.triangles, {6, 5, 2}),
        bullet::make_cage(second.positions, second.triangles, {6, 5, 2}), 100);
}

void fine_skins_with_few_rays() {
  demo::Surface first = demo::torus(96, 48), second = first;
  demo::move(second, {0.9, 0.2, 0.3});
  const bullet::Cage cages[] = {bullet::make_cage(first.positions, first.triangles, {6, 5, 2}),
                                bullet::make_cage(second.positions, second.triangles, {6, 5, 2})};
  const std::size_t all = parts("fine skins, from vertices", cages[0], cages[1], 1000, RAYC_SAMPLING_VERTICES);
  const std::size_t few = parts("fine skins", cages[0], cages[1], 50);
  expect(few * 2 < all, "fine skins", "half of the contacts is enough");
}

const demo::Surface cube{
    "cube",
    {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1},
    {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5}};

// What the present rows give a body in a step, in N s, by the nodes' velocities.
btVector3 impulse(bullet::ContactForce& contact, const btSoftBody& body, int node_count) {
  bullet::ContactForce::TVStack forces;
  forces.resize(node_count, btVector3(0, 0, 0));
  contact.addScaledForces(btScalar(time_step), forces);
  btVector3 sum(0, 0, 0);
  for (int n = 0; n < body.m_nodes.size(); ++n) sum += forces[body.m_nodes[n].index];
  return sum;
}

// Contacts sought again within a step, for the sake of a third body that something has stopped, leave the push on a
// swallowed one as it is.
void swallowed_while_another_is_stopped() {
  const char* scene = "swallowed while another is stopped";
  demo::Surface inner = cube, far = cube;
  demo::normalise(inner, 0.3);
  demo::move(inner, {0.45, 0.5, 0.55});
  demo::move(far, {9, 0, 0});
  bullet::ContactOptions options = bullet::ContactOptions::elastic(youngs_modulus, poisson_ratio, 0.5);
  options.depth_cap = bullet::suggested_depth_cap(youngs_modulus, 0.5, options.stiffness);
  demo::SoftWorld world(youngs_modulus, poisson_ratio, options);
  int node_count = 0;
  const auto add = [&](const demo::Surface& surface, int cells) -> btSoftBody& {
    btSoftBody& body = world.add(bullet::make_cage(surface.positions, surface.triangles, cells), 1);
    node_count += body.m_nodes.size();
    return body;
  };
  add(cube, 2);
  const btSoftBody& swallowed = add(inner, 1);
  btSoftBody& stopped = add(far, 1);
  for (int step = 0; step < 5 && world.contact().statistics().escaping_pairs == 0; ++step) world.step(time_step);
  expect(world.contact().statistics().escaping_pairs == 1, scene, "the pair is escaping");
  world.contact().reinitialize(true);  // another step begins
  const btVector3 before = impulse(world.contact(), swallowed, node_count);
  expect(before.length() > btScalar(0.1), scene, "the swallowed body is pushed");

  for (int n = 0; n < stopped.m_nodes.size(); ++n) stopped.m_nodes[n].m_v.setValue(100, 0, 0);
  world.contact().detect_again();
  const btVector3 after = impulse(world.contact(), swallowed, node_count);
  std::printf("%s: %g N s before, %g N s after\n", scene, double(before.length()), double(after.length()));
  expect((after - before).length() <= btScalar(1e-3) * before.length(), scene, "it is pushed as before");
}

// Lattices of tetrahedra with their own boundary as the collision surface.
bullet::Cage lattice_with_own_faces(const demo::Surface& surface) {
  bullet::Cage cage = bullet::make_cage(surface.positions, surface.triangles, 3);
  btSoftBodyWorldInfo info;
  const auto body = bullet::make_soft_body(info, cage, 1);
  expect(points_of_own_faces(*body) == cage.nodes.size(), "own faces", "one point for each node");
  cage.skin = bullet::skin_from_faces(*body);
  return cage;
}

void own_faces() {
  demo::Surface second = cube;
  demo::move(second, {0.7, 0.15, 0.1});
  parts("own faces", lattice_with_own_faces(cube), lattice_with_own_faces(second), 4);
}

}  // namespace

int main() {
  std::printf("Bullet in %s precision\n", bullet::double_precision ? "double" : "float");
  skins_in_cages();
  fine_skins_with_few_rays();
  own_faces();
  swallowed_while_another_is_stopped();
  return failures == 0 ? 0 : 1;
}
