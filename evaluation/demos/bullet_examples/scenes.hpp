// SPDX-License-Identifier: MIT OR Apache-2.0
/** The scenes: PinchFriction, Pinch, VolumetricDeformable, Collide and GraspDeformable. */
#ifndef RAYCONTACT_DEMOS_BULLET_EXAMPLES_SCENES_HPP
#define RAYCONTACT_DEMOS_BULLET_EXAMPLES_SCENES_HPP

#include <cstdio>
#include <string>

#include "examples.hpp"

namespace demo {

/** "1.2 m above the floor" and the like. */
inline std::string metres(double value, const char* what) {
  char text[80];
  std::snprintf(text, sizeof text, "%.3g m %s", value, what);
  return text;
}

/** Two heavy plates press `count` soft boxes together, lift them and hold them. */
class Pinched : public Example {
 public:
  static std::unique_ptr<Pinched> friction(bool is_ours) {
    return make(is_ours, {15, 0.25, 2, 0.5, true}, {btVector3(2, 2, 1), 3, 2.2, 2.1, 0.6}, 0.45, 2);
  }
  static std::unique_ptr<Pinched> alone(bool is_ours) {
    return make(is_ours, {25, 0.3, 0.5, 0.5, true}, {btVector3(2, 2, 2), 1, 0, 4, 1}, 0.9, 5);
  }

  void step(double dt) override {
    const double pressed = std::min(time_, press_), lifted = std::min(std::max(time_ - press_, 0.0), 1.0);
    for (std::size_t side = 0; side < 2; ++side) {
      const double sign = side == 0 ? 1 : -1;
      const btVector3 at(btScalar(0.5), btScalar(3 + lift_ * lifted), btScalar(sign * (4 - 2 * pressed)));
      plates_[side]->setCenterOfMassTransform(btTransform(btQuaternion::getIdentity(), at));
      plates_[side]->setAngularVelocity(btVector3(0, 0, 0));
      plates_[side]->setLinearVelocity(
          btVector3(0, btScalar(time_ > press_ && lifted < 1 ? lift_ : 0), btScalar(time_ < press_ ? -2 * sign : 0)));
    }
    Example::step(dt);
  }

  std::string outcome() const override { return metres(lowest(), "above the floor"); }

 private:
  struct Boxes {
    btVector3 half;
    int count;
    double apart, height, mass;
  };

  static std::unique_ptr<Pinched> make(bool is_ours, const Material& material, const Boxes& boxes, double press,
                                       double lift) {
    return std::unique_ptr<Pinched>(new Pinched(is_ours, material, boxes, press, lift));
  }

  Pinched(bool is_ours, const Material& material, const Boxes& boxes, double press, double lift)
      : Example(is_ours, 10, material), press_(press), lift_(lift) {
    add_box(btVector3(150, 25, 150), 0, btVector3(0, -25, 0));
    for (int i = 0; i < boxes.count; ++i)
      add_soft(boxes.half, btVector3(0, btScalar(boxes.height), btScalar(boxes.apart * (i - (boxes.count - 1) / 2))),
               boxes.mass, collision::SDF_RD | collision::SDF_RDF | (boxes.count > 1 ? collision::VF_DD : 0), 0.025);
    for (const btScalar z : {btScalar(4), btScalar(-4)})
      plates_.push_back(&add_box(btVector3(3, 3, btScalar(0.5)), 1e6, btVector3(0, 3, z)));
    for (btRigidBody* plate : plates_) plate->setFriction(btScalar(is_ours ? 1 : 10 * boxes.count));
  }

  double press_, lift_;
  std::vector<btRigidBody*> plates_;
};

/** A soft box in a pit of rigid walls; four rigid boxes, sixteen times its weight, fall onto it. */
class Buried : public Example {
 public:
  explicit Buried(bool is_ours) : Example(is_ours, 100, {50, 0.3, 1, 0.5, false}) {
    add_box(btVector3(150, 50, 150), 0, btVector3(0, -50, 0));
    for (const btScalar side : {btScalar(5), btScalar(-5)}) {
      add_box(btVector3(1, 5, 5), 0, btVector3(side, 0, 0));
      add_box(btVector3(5, 5, 1), 0, btVector3(0, 0, side));
    }
    add_soft(btVector3(2, 2, 2), btVector3(0, 5, 0), 0.5, collision::SDF_RD | collision::SDF_RDN, 0.1);
    for (int i = 0; i < 4; ++i)
      add_box(btVector3(1, 1, 1), 2, btVector3(btScalar(i), btScalar(10 + 2 * i), btScalar(i - 1)));
  }

  std::string outcome() const override { return metres(size(), "of 4 m are left of its height"); }
};

/** A soft and a rigid box of the same mass fly into one another, at 15 m/s each. */
class Collided : public Example {
 public:
  explicit Collided(bool is_ours) : Example(is_ours, 0, {50, 0.3, 0, 0.5, false}) {
    add_soft(btVector3(2, 2, 2), btVector3(0, 7, 0), 0.5, collision::SDF_RD | collision::SDF_RDN, 0.1)
        .setVelocity(btVector3(0, -15, 0));
    rigid_ = &add_box(btVector3(2, 2, 2), 0.5, btVector3(0, -2, 0));
    rigid_->setLinearVelocity(btVector3(0, 15, 0));
  }

  std::string outcome() const override {
    double energy = 0.5 * 0.5 * double(rigid_->getLinearVelocity().length2());
    for (int n = 0; n < soft(0).m_nodes.size(); ++n)
      energy += 0.5 * double(soft(0).m_nodes[n].m_v.length2() / soft(0).m_nodes[n].m_im);
    char text[80];
    std::snprintf(text, sizeof text, "%.3g of 112.5 J move on", energy);
    return text;
  }

 private:
  btRigidBody* rigid_;
};

/** Two hinged fingers of a multibody close on a soft cube of 4 cm and 100 g, lift it by 5 cm and hold it. */
class Grasped : public Example {
 public:
  explicit Grasped(bool is_ours)
      : Example(is_ours, 9.81, {2e4, 0.3, 1, edge / 3, true}),
        gripper_(world_, 2, 0.1, btVector3(0, btScalar(arm), 0), true) {
    add_box(btVector3(1, 1, 1), 0, btVector3(0, btScalar(-1 - edge / 2), 0));
    cube_ = &add_soft(btVector3(1, 1, 1) * btScalar(edge / 2), btVector3(0, 0, 0), 0.1,
                      collision::SDF_RD | collision::SDF_RDF | collision::SDF_MDF, 0.001);
    finger_.setMargin(btScalar(0.001));
    for (const double side : {-1.0, 1.0}) {
      const btScalar z = btScalar(side * (edge / 2 + 0.003));
      gripper_.add_hinge(finger_, 0.1, btVector3(1, 0, 0), btVector3(0, 0, z), btVector3(0, btScalar(-arm), z));
    }
    gripper_.start(btVector3(0, 0, 0), 2, 3);
    for (int i = 0; i < 2; ++i) {
      btScalar open = btScalar(i == 0 ? 0.1 : -0.1);
      gripper_.body().setJointPosMultiDof(i, &open);
      motors_[std::size_t(i)] = std::make_unique<btMultiBodyJointMotor>(&gripper_.body(), i, 0, 0, 1);
      motors_[std::size_t(i)]->finalizeMultiDof();
      world_.addMultiBodyConstraint(motors_[std::size_t(i)].get());
      gripper_.link(std::size_t(i)).setFriction(1);
      if (is_ours) contact_.add_link(gripper_.link(std::size_t(i)));  // +
      boxes_.push_back({&gripper_.link(std::size_t(i)), finger_.getHalfExtentsWithMargin()});
    }
    gripper_.place();
  }

  ~Grasped() override {
    for (std::size_t i = 0; i < 2; ++i) {
      world_.removeMultiBodyConstraint(motors_[i].get());
      contact_.remove_rigid_body(gripper_.link(i));
    }
  }

  void step(double dt) override {
    gripper_.body().setBaseVel(btVector3(0, btScalar(time_ > 1 && time_ < 2 ? 0.05 : 0), 0));
    for (std::size_t i = 0; i < 2; ++i)
      motors_[i]->setVelocityTarget(btScalar((i == 0 ? -1 : 1) * (time_ < 1 ? 0.3 : 0)), 1);
    Example::step(dt);
  }

  /** How far the cube's middle hangs below the gripper's base, m. */
  double below_base() const {
    double height = 0;
    for (int n = 0; n < cube_->m_nodes.size(); ++n) height += double(cube_->m_nodes[n].m_x.y()) / cube_->m_nodes.size();
    return double(gripper_.body().getBasePos().y()) - height;
  }

  std::string outcome() const override { return metres(below_base(), "below the gripper (arms of 0.06 m)"); }

  btVector3 force_of_fingers() {
    return contact_.pair_force(*cube_, gripper_.link(0)) + contact_.pair_force(*cube_, gripper_.link(1));
  }

  static constexpr double edge = 0.04, arm = 0.06, thickness = 0.006;

 private:
  btBoxShape finger_{btVector3(btScalar(0.02), btScalar(0.02), btScalar(thickness / 2))};
  Multibody gripper_;
  btSoftBody* cube_ = nullptr;
  std::array<std::unique_ptr<btMultiBodyJointMotor>, 2> motors_;
};

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_BULLET_EXAMPLES_SCENES_HPP
