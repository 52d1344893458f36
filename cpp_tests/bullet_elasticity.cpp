// Elasticity does not ask how a body is turned: its elements pull alike in every pose.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "expect.hpp"
#include "raycontact/bullet.hpp"
#include "shapes.hpp"
#include "soft_world.hpp"

namespace bullet = raycontact::bullet;

namespace {

// A world without gravity, contact or damping in which a stretched body takes one step.
class Stretched {
 public:
  explicit Stretched(btDeformableLinearElasticityForce& elasticity)
      : elasticity_(elasticity), world_(&dispatcher_, &broadphase_, &constraints_, &configuration_, &solver_) {
    constraints_.setDeformableSolver(&solver_);
    world_.setImplicit(true);
    world_.setUseProjection(true);
    world_.setLineSearch(false);
    world_.setGravity(btVector3(0, 0, 0));
    elasticity_.setPoissonRatio(btScalar(0.3));
    elasticity_.setYoungsModulus(btScalar(2e4));
    demo::Surface torus = demo::torus(24, 12);
    body_ = bullet::make_soft_body(world_.getWorldInfo(), bullet::make_cage(torus.positions, torus.triangles, 5), 20);
    for (int n = 0; n < body_->m_nodes.size(); ++n) rest_.push_back(body_->m_nodes[n].m_x);
    world_.addSoftBody(body_.get());
    world_.addForce(body_.get(), &elasticity_);
  }

  ~Stretched() {
    solver_.getLagrangianForceArray()->clear();
    world_.removeSoftBody(body_.get());
  }

  // The velocities after a step from rest, turned back.
  std::vector<btVector3> velocities(const btVector3& stretch, const btMatrix3x3& turn) {
    for (std::size_t n = 0; n < rest_.size(); ++n) {
      btSoftBody::Node& node = body_->m_nodes[static_cast<int>(n)];
      node.m_x = node.m_q = turn * (stretch * rest_[n]);
      node.m_v = node.m_vn = btVector3(0, 0, 0);
    }
    world_.stepSimulation(btScalar(1) / 60, 0);
    std::vector<btVector3> result;
    for (int n = 0; n < body_->m_nodes.size(); ++n) result.push_back(turn.transpose() * body_->m_nodes[n].m_v);
    return result;
  }

 private:
  btDeformableLinearElasticityForce& elasticity_;
  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btDeformableBodySolver solver_;
  btDeformableMultiBodyConstraintSolver constraints_;
  btDeformableMultiBodyDynamicsWorld world_;
  std::unique_ptr<btSoftBody> body_;
  std::vector<btVector3> rest_;
};

// The greatest difference of a velocity from that of the body that is not turned, over the fastest of these.
double worst_difference(btDeformableLinearElasticityForce& elasticity) {
  Stretched stretched(elasticity);
  const btVector3 stretch(btScalar(1.1), btScalar(0.95), 1);
  const std::vector<btVector3> straight = stretched.velocities(stretch, btMatrix3x3::getIdentity());
  double fastest = 0, worst = 0;
  for (const btVector3& v : straight) fastest = std::max(fastest, double(v.length()));
  // About axes all over the sphere, by up to a whole turn; half a turn, about these and the body's own, is among them.
  for (int i = 0; i < 120; ++i) {
    btVector3 axis(btScalar(std::sin(2.0 * i)), btScalar(std::cos(3.0 * i)), btScalar(std::sin(1 + 5.0 * i)));
    if (i < 3) axis = btVector3(i == 0, i == 1, i == 2);
    const double angle = std::acos(-1.0) * (i < 40 ? 1 : 0.025 * (i - 40));
    const btMatrix3x3 turn(btQuaternion(axis.normalized(), btScalar(angle)));
    const std::vector<btVector3> turned = stretched.velocities(stretch, turn);
    for (std::size_t n = 0; n < turned.size(); ++n)
      worst = std::max(worst, double((turned[n] - straight[n]).length()) / fastest);
  }
  return worst;
}

void every_pose_is_alike() {
  btDeformableLinearElasticityForce stock;
  bullet::CorotatedElasticity elasticity;
  const double before = worst_difference(stock), after = worst_difference(elasticity);
  std::printf("velocities differ from the body's that is not turned by %.2g with Bullet's rotations, %.2g with ours\n",
              before, after);
  // As close as Bullet's solver gets in float.
  expect(after < 1e-3, "every pose is alike", "the greatest difference is " + std::to_string(after));
}

}  // namespace

int main() {
  every_pose_is_alike();
  return failures == 0 ? 0 : 1;
}
