// SPDX-License-Identifier: MIT OR Apache-2.0
/** Where contacts took hold of the other body: what lets bodies at rest stay there instead of creeping. */
#ifndef RAYCONTACT_BULLET_FRICTION_ANCHORS_HPP
#define RAYCONTACT_BULLET_FRICTION_ANCHORS_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "raycontact/bullet/surface_set.hpp"

namespace raycontact::bullet::detail {

/**
 * An anchor is a material point of the collided body, given in one of its triangles (weights may lie outside it), so it
 * moves, turns and stretches with the body and nothing adds up from step to step. A contact finds its own again by
 * the triangle it starts from and, among several there, by the nearest point.
 */
class FrictionAnchors {
 public:
  void forget() {
    kept_.clear();
    sorted_.clear();
    start_step();
  }

  void start_step() {
    pending_.clear();
    found_.clear();
  }

  /** What a contact holds on to; a new one in the step, which lets go unless keep() or drag() is called for it. */
  Hold find(const std::vector<ContactBody>& bodies, const rayc_contact& contact) {
    Anchor anchor{contact.colliding, contact.collided, false, contact.p1.triangle, {}, {}, {0, 0, 0}};
    anchor.from = corners(contact.p1);
    anchor.to = corners(contact.p2);
    return find(bodies, anchor);
  }

  /** The same for a point of a skin on the half-space of this number: anchors then are points in space. */
  Hold find(const std::vector<ContactBody>& bodies, std::size_t body, std::size_t point, std::size_t half_space) {
    const uint32_t p = static_cast<uint32_t>(point);
    Anchor anchor{static_cast<uint32_t>(body), static_cast<uint32_t>(half_space), true, p, {}, {}, {0, 0, 0}};
    anchor.from = {{{p, p, p}}, {{1, 0, 0}}};
    return find(bodies, anchor);
  }

  /** The hold of this number stays where it is: to the bit, so that rounding does not add up to a way. */
  void keep(std::size_t number) { next_.push_back(kept_[found_[number]]); }

  /** It is now at `offset` from its point, both where detection had them. */
  void drag(const std::vector<ContactBody>& bodies, std::size_t number, const btVector3& offset) {
    Anchor anchor = pending_[number];
    const btVector3 at = position(bodies[anchor.first], anchor.from) + offset;
    if (anchor.in_space)
      anchor.point = at;
    else
      anchor.to.weights = weights_of(bodies[anchor.second], anchor.to.vertices, at);
    next_.push_back(anchor);
  }

  void finish_step() {
    std::swap(kept_, next_);
    next_.clear();
    sorted_.clear();
    for (std::size_t i = 0; i < kept_.size(); ++i) sorted_.push_back({kept_[i].key(), i});
    std::sort(sorted_.begin(), sorted_.end());
  }

 private:
  struct Corners {
    std::array<uint32_t, 3> vertices;
    std::array<double, 3> weights;
  };

  using Key = std::pair<uint64_t, uint64_t>;

  struct Anchor {
    uint32_t first, second;  // bodies, or a body and a half-space
    bool in_space;
    uint32_t triangle;  // of the first body, or its point on a half-space
    Corners from, to;
    btVector3 point;  // in space

    Key key() const { return {uint64_t(first) << 32 | second, uint64_t(in_space ? 1 : 0) << 32 | triangle}; }
  };

  // By rising vertex number: a contact that starts from a vertex has that one first.
  static Corners corners(const rayc_surface_point& p) {
    std::array<std::size_t, 3> order{{0, 1, 2}};
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p.vertices[a] < p.vertices[b]; });
    Corners c{};
    for (std::size_t k = 0; k < 3; ++k) {
      c.vertices[k] = p.vertices[order[k]];
      c.weights[k] = p.weights[order[k]];
    }
    return c;
  }

  static btVector3 vertex(const ContactBody& body, uint32_t v) {
    const btScalar* x = &body.positions[3 * std::size_t(v)];
    return {x[0], x[1], x[2]};
  }

  static btVector3 position(const ContactBody& body, const Corners& at) {
    btVector3 x(0, 0, 0);
    for (std::size_t k = 0; k < 3; ++k) x += static_cast<btScalar>(at.weights[k]) * vertex(body, at.vertices[k]);
    return x;
  }

  static std::array<double, 3> weights_of(const ContactBody& body, const std::array<uint32_t, 3>& triangle,
                                          const btVector3& x) {
    const btVector3 a = vertex(body, triangle[0]), u = vertex(body, triangle[1]) - a, v = vertex(body, triangle[2]) - a,
                    w = x - a;
    const double uu = double(u.dot(u)), uv = double(u.dot(v)), vv = double(v.dot(v));
    const double wu = double(w.dot(u)), wv = double(w.dot(v)), determinant = uu * vv - uv * uv;
    if (!(determinant > 0)) return {{1, 0, 0}};
    const double b = (vv * wu - uv * wv) / determinant, c = (uu * wv - uv * wu) / determinant;
    return {{1 - b - c, b, c}};
  }

  Hold find(const std::vector<ContactBody>& bodies, const Anchor& wanted) {
    Hold hold{pending_.size(), false, {0, 0, 0}};
    pending_.push_back(wanted);
    found_.push_back(none);
    const Anchor* nearest = nullptr;
    double least = 0;
    const Key key = wanted.key();
    for (auto found = std::lower_bound(sorted_.begin(), sorted_.end(), std::make_pair(key, std::size_t(0)));
         found != sorted_.end() && found->first == key; ++found) {
      const Anchor& a = kept_[found->second];
      double distance = 0;
      for (std::size_t k = 0; k < 3; ++k)
        distance += (a.from.weights[k] - wanted.from.weights[k]) * (a.from.weights[k] - wanted.from.weights[k]);
      if (nearest != nullptr && !(distance < least)) continue;
      nearest = &a;
      least = distance;
    }
    if (nearest == nullptr) return hold;
    found_.back() = static_cast<std::size_t>(nearest - kept_.data());
    const btVector3 anchor = wanted.in_space ? nearest->point : position(bodies[nearest->second], nearest->to);
    hold.offset = anchor - position(bodies[nearest->first], nearest->from);
    hold.is_old = true;
    return hold;
  }

  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  std::vector<Anchor> kept_, next_, pending_;        // of the step before, of this one, and new ones
  std::vector<std::pair<Key, std::size_t>> sorted_;  // those kept, by key
  std::vector<std::size_t> found_;                   // for each new one, its own of those kept
};

}  // namespace raycontact::bullet::detail

#endif  // RAYCONTACT_BULLET_FRICTION_ANCHORS_HPP
