// SPDX-License-Identifier: MIT OR Apache-2.0
/** The demo's models, as MuJoCo's XML: bodies of tetrahedra and skins in trilinear cells. */
#ifndef RAYCONTACT_DEMOS_MUJOCO_MODEL_HPP
#define RAYCONTACT_DEMOS_MUJOCO_MODEL_HPP

#include <array>
#include <string>
#include <vector>

namespace flexes {

/** Who makes contact between flexes. */
enum class Contact {
  raycontact,
  mujoco,   ///< MuJoCo's constraints, its default
  passive,  ///< MuJoCo's own passive contact
};

const char* name_of(Contact contact);

/** A tetrahedral or triangle mesh. */
struct Shape {
  int dim;  // 2: a surface, 3: tetrahedra
  std::vector<std::array<double, 3>> points;
  std::vector<int> elements;  // dim + 1 points each
};

/** Radii 1 and 0.4 of tetrahedra; a ring of nodes runs inside. */
Shape torus(int around, int across);
/** A closed surface with bumps, about 0.7 in radius, of 20 * 4^times triangles; `phase` turns the bumps. */
Shape lumpy_ball(int times, double phase);
/** A closed surface from a Wavefront file, scaled so that its box's largest side is 1.7. */
Shape from_obj(const std::string& path);

struct Body {
  Shape shape;
  std::array<double, 3> place;
  double mass = 30;    // kg
  double young = 5e4;  // Pa
  double friction = 0;
};

struct Model {
  std::vector<Body> bodies;
  double timestep = 0.005, gravity = 0;
  bool has_floor = false;
};

/** The XML, ready for mj_loadXML; bodies are flexes named b0, b1, ... */
std::string xml_of(const Model& model, Contact contact);

}  // namespace flexes

#endif  // RAYCONTACT_DEMOS_MUJOCO_MODEL_HPP
