#include <raycontact.hpp>

#include <array>
#include <cmath>
#include <cstdio>

using Vec3 = std::array<double, 3>;  // any type with operator[] will do, such as Eigen::Vector3d

const std::vector<Vec3> octahedron = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
const std::vector<uint32_t> faces = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};

struct Body {
  std::vector<Vec3> x = octahedron, v = std::vector<Vec3>(6), f = v;
  uint32_t number = 0;  // in the scene
};

void add_spring(Body& body, int i, int j, double stiffness) {
  Vec3 d;
  double length = 0, rest = 0;
  for (int k = 0; k < 3; ++k) {
    d[k] = body.x[j][k] - body.x[i][k];
    length += d[k] * d[k];
    rest += std::pow(octahedron[j][k] - octahedron[i][k], 2);
  }
  const double tension = stiffness * (1 - std::sqrt(rest / length));
  for (int k = 0; k < 3; ++k) {
    body.f[i][k] += tension * d[k];
    body.f[j][k] -= tension * d[k];
  }
}

int main() {
  const double dt = 0.002, mass = 0.1;  // s, kg for each vertex
  std::vector<Body> bodies(2);
  for (Vec3& x : bodies[1].x) x[0] += 0.5;

  raycontact::Scene scene;  // or Scene(4): with a pool of four threads
  for (Body& body : bodies) body.number = scene.add({raycontact::vectors(body.x), faces});
  raycontact::Contacts contacts;
  rayc_response_options response = raycontact::default_response_options();
  response.stiffness = 100;      // N/m^3: pressure for each metre below the surface
  response.damping_time = 0.05;  // s

  for (int step = 0; step < 500; ++step) {
    std::vector<rayc_vectors> x, v;
    std::vector<rayc_vectors_mut> f;
    for (Body& body : bodies) {
      body.f.assign(6, Vec3{});
      scene.set_positions(body.number, raycontact::vectors(body.x));
      x.push_back(raycontact::vectors(body.x)), v.push_back(raycontact::vectors(body.v));
      f.push_back(raycontact::vectors_mut(body.f));
    }
    scene.query(contacts);
    contacts.add_forces(response, x, v, f);
    scene.advance(dt);
    for (Body& body : bodies) {
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < i; ++j) add_spring(body, i, j, 50);
      for (int i = 0; i < 6; ++i)
        for (int k = 0; k < 3; ++k) body.x[i][k] += dt * (body.v[i][k] += dt * body.f[i][k] / mass);
    }
    if (step % 100 == 0) std::printf("step %3d: %zu contacts\n", step, contacts.size());
  }
  double momentum = 0;
  for (const Body& body : bodies)
    for (const Vec3& v : body.v) momentum += mass * v[0];
  std::printf("%zu contacts left, momentum %s\n", contacts.size(), std::abs(momentum) < 1e-12 ? "kept" : "lost");
}
