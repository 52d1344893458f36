// SPDX-License-Identifier: MIT OR Apache-2.0
/** Contact with friction in Simbody, whose integrators choose their own steps, beside Simbody's own contact. */
#include <Simbody.h>

#include <cmath>
#include <cstdio>
#include <ctime>
#include <vector>

#include "raycontact.hpp"

using namespace SimTK;

/** Contact of rigid bodies as a force, for any of Simbody's integrators. */
class RayTracedContact : public Force::Custom::Implementation {
 public:
  explicit RayTracedContact(const rayc_response_options& response) : response_(response) {
    scene_.advance(0);  // no query ends a step, so nothing is remembered
    scene_.set_sampling(RAYC_SAMPLING_ACCURACY, 0.05);
  }
  void add(const MobilizedBody& body, const ContactGeometry::TriangleMesh& surface) {
    std::vector<Vec3> positions(surface.getNumVertices());
    std::vector<uint32_t> triangles;
    for (int v = 0; v < surface.getNumVertices(); ++v) positions[v] = surface.getVertexPosition(v);
    for (int k = 0; k < 3 * surface.getNumFaces(); ++k) triangles.push_back(surface.getFaceVertex(k / 3, k % 3));
    scene_.add({raycontact::vectors(positions), triangles});
    bodies_.push_back(body);
  }

  void calcForce(const State& state, Vector_<SpatialVec>& forces, Vector_<Vec3>&, Vector&) const override {
    const std::size_t n = bodies_.size();
    std::vector<Vec3> points, velocities, wrenches(2 * n, Vec3(0));
    for (const MobilizedBody& body : bodies_) {
      const Transform& at = body.getBodyTransform(state);
      rayc_pose pose;
      for (int k = 0; k < 9; ++k) pose.rotation[k / 3][k % 3] = at.R()[k / 3][k % 3];
      for (int k = 0; k < 3; ++k) pose.position[k] = at.p()[k];
      scene_.set_pose(uint32_t(points.size()), pose);
      points.push_back(at.p());
      velocities.insert(velocities.end(), {body.getBodyOriginVelocity(state), body.getBodyAngularVelocity(state)});
    }
    scene_.query(contacts_);
    contacts_.add_wrenches(response_, {&points[0][0], 3 * n}, {&velocities[0][0], 6 * n}, {&wrenches[0][0], 6 * n});
    for (std::size_t b = 0; b < n; ++b)
      forces[bodies_[b].getMobilizedBodyIndex()] += SpatialVec(wrenches[2 * b + 1], wrenches[2 * b]);
  }
  Real calcPotentialEnergy(const State&) const override { return 0; }  // no integrator asks for it

 private:
  rayc_response_options response_;
  std::vector<MobilizedBody> bodies_;
  mutable raycontact::Scene scene_;
  mutable raycontact::Contacts contacts_;
};

namespace {

constexpr double stiffness = 1e6;      // N/m^3: the brick sinks in by 1 mm
constexpr double damping_time = 0.01;  // s
constexpr double friction = 0.5;
constexpr double slip_speed = 2e-3;    // m/s
constexpr double slope = 0.1;          // rad
const Vec3 half(0.1, 0.1, 0.05);       // of the brick's edges, m
constexpr double radius = 0.05;        // of the ball

struct Outcome {
  int steps;
  double seconds, height, creep;
};

/** A brick falls onto a slope; a ball falls beside it, rolls against it and leans on it. */
Outcome run(bool is_ray_traced) {
  MultibodySystem system;
  SimbodyMatterSubsystem matter(system);
  GeneralForceSubsystem forces(system);
  Force::Gravity(forces, matter, Vec3(std::sin(slope), 0, -std::cos(slope)) * 9.81);
  ContactTrackerSubsystem tracker(system);
  CompliantContactSubsystem compliant(system, tracker);
  compliant.setTransitionVelocity(slip_speed);

  PolygonalMesh below = PolygonalMesh::createBrickMesh(Vec3(2, 2, 0.5), 1);
  below.transformMesh(Vec3(0, 0, -0.5));
  const ContactGeometry::TriangleMesh floor(below), brick(PolygonalMesh::createBrickMesh(half, 4)),
      ball(PolygonalMesh::createSphereMesh(radius, 3));
  // 1000 kg/m^3.
  const double brick_mass = 8000 * half[0] * half[1] * half[2], ball_mass = 4000 * Pi / 3 * radius * radius * radius;
  Body::Rigid brick_body(MassProperties(brick_mass, Vec3(0), brick_mass * UnitInertia::brick(half)));
  Body::Rigid ball_body(MassProperties(ball_mass, Vec3(0), ball_mass * UnitInertia::sphere(radius)));
  if (!is_ray_traced) {
    // Layers of 1 m, of which each contact has two in series.
    const ContactMaterial material(2 * stiffness, 1, friction, friction, 0);
    const Transform upwards(Rotation(Pi / 2, YAxis), Vec3(0));
    matter.Ground().updBody().addContactSurface(upwards, ContactSurface(ContactGeometry::HalfSpace(), material));
    brick_body.addContactSurface(Transform(), ContactSurface(brick, material, 1));
    ball_body.addContactSurface(Transform(), ContactSurface(ball, material, 1));
  }
  MobilizedBody::Free first(matter.Ground(), brick_body), second(matter.Ground(), ball_body);
  if (is_ray_traced) {
    rayc_response_options response = raycontact::default_response_options();
    response.stiffness = stiffness;
    response.damping_time = damping_time;
    response.friction = friction;
    response.slip_speed = slip_speed;
    auto* contact = new RayTracedContact(response);  // the system will free it
    contact->add(matter.Ground(), floor);
    contact->add(first, brick);
    contact->add(second, ball);
    Force::Custom(forces, contact);
  }
  State state = system.realizeTopology();
  first.setQToFitTranslation(state, Vec3(0, 0, half[2] + 0.02));
  second.setQToFitTranslation(state, Vec3(-half[0] - radius - 0.05, 0, radius + 0.02));

  CPodesIntegrator integrator(system);
  integrator.setAccuracy(1e-3);
  TimeStepper stepper(system, integrator);
  stepper.initialize(state);
  const std::clock_t start = std::clock();
  stepper.stepTo(2);
  const Vec3 before = first.getBodyOriginLocation(integrator.getState());
  stepper.stepTo(3);
  const Vec3 after = first.getBodyOriginLocation(integrator.getState());
  const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
  return {integrator.getNumStepsTaken(), seconds, after[2], (after - before).norm()};
}

bool print(const char* contact, const Outcome& outcome) {
  const auto& [steps, seconds, height, creep] = outcome;
  std::printf("| %s | %d | %.2f | %.2f | %.2f |\n", contact, steps, seconds, 1e3 * height, 1e3 * creep);
  return std::abs(height - half[2] + 0.001) < 1e-4 && creep < 1e-3;
}

}  // namespace

int main() {
  std::puts("| contact | steps | processor time, s | brick's height, mm | its creep, mm/s |\n| --- | ---: | ---: | ---: | ---: |");
  const bool ray_traced_went_well = print("raycontact", run(true));
  return print("Simbody's own", run(false)) && ray_traced_went_well ? 0 : 1;
}
