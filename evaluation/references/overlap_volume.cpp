// Writes overlap_volume.csv: the volume V that two placed bodies share, and the force -dV/dx of an even pressure on the
// first. All in exact arithmetic, rounded once at the end: the poses of poses.csv are taken as the exact rotations of
// their quaternions, the meshes are cut with CGAL's corefinement.
//
// By the divergence theorem -dV/dx is minus the area vector of that part of the first surface that lies inside the
// second.
//
//   c++ -O2 -DNDEBUG -std=c++17 overlap_volume.cpp -lgmp -lmpfr -o /tmp/overlap_volume && /tmp/overlap_volume
//   /tmp/overlap_volume check     compares every 50th row with a difference of V over 2e-6 and writes nothing
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Surface_mesh.h>

#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Number = Kernel::FT;
using Point = Kernel::Point_3;
using Vector = Kernel::Vector_3;
using Mesh = CGAL::Surface_mesh<Point>;
using Face = Mesh::Face_index;

// Notes which faces of the intersection come from the first mesh.
struct Origin : pmp::Corefinement::Default_visitor<Mesh> {
  const Mesh* first;
  std::set<Face>* from_first;
  Origin(const Mesh& first, std::set<Face>& from_first) : first(&first), from_first(&from_first) {}
  void after_face_copy(Face, const Mesh& source, Face face, const Mesh&) {
    if (&source == first) from_first->insert(face);
  }
};

struct Overlap {
  Number volume;
  Vector force;
};

struct Pose {
  std::string id, pair, kind;
  double quaternion[4], translation[3];
};

Mesh read_obj(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  Mesh mesh;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      double x, y, z;
      words >> x >> y >> z;
      mesh.add_vertex(Point(x, y, z));
    } else if (word == "f") {
      unsigned a, b, c;
      words >> a >> b >> c;
      using Vertex = Mesh::Vertex_index;
      if (mesh.add_face(Vertex(a - 1), Vertex(b - 1), Vertex(c - 1)) == Mesh::null_face())
        throw std::runtime_error("not a surface: " + path);
    }
  }
  if (!CGAL::is_closed(mesh)) throw std::runtime_error("not closed: " + path);
  return mesh;
}

// Divided by the quaternion's squared length, so that the rotation is exact although the length is 1 only nearly.
Kernel::Aff_transformation_3 placement(const Pose& pose, const Vector& offset) {
  const Number w = pose.quaternion[0], x = pose.quaternion[1], y = pose.quaternion[2], z = pose.quaternion[3];
  const Number s = w * w + x * x + y * y + z * z;
  return {w * w + x * x - y * y - z * z,
          2 * (x * y - w * z),
          2 * (x * z + w * y),
          s * (pose.translation[0] + offset.x()),
          2 * (x * y + w * z),
          w * w - x * x + y * y - z * z,
          2 * (y * z - w * x),
          s * (pose.translation[1] + offset.y()),
          2 * (x * z - w * y),
          2 * (y * z + w * x),
          w * w - x * x - y * y + z * z,
          s * (pose.translation[2] + offset.z()),
          s};
}

Overlap overlap(Mesh first, Mesh second, const Pose& pose, const Vector& offset = {0, 0, 0}) {
  const auto place = placement(pose, offset);
  for (const auto v : second.vertices()) {
    second.point(v) = place(second.point(v));
    CGAL::exact(second.point(v));
  }
  Mesh both;
  std::set<Face> from_first;
  const auto visitor = CGAL::parameters::visitor(Origin(first, from_first));
  if (!pmp::corefine_and_compute_intersection(first, second, both, visitor))
    throw std::runtime_error("no intersection of row " + pose.id);
  Vector area(0, 0, 0);
  for (const Face face : from_first) {
    const auto h = both.halfedge(face);
    const Point &a = both.point(both.source(h)), &b = both.point(both.target(h)),
                &c = both.point(both.target(both.next(h)));
    area = area + CGAL::cross_product(b - a, c - a) / 2;
  }
  return {both.is_empty() ? Number(0) : pmp::volume(both), -area};
}

double rounded(const Number& number) { return CGAL::to_double(CGAL::exact(number)); }

std::vector<Pose> read_poses(const char* path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(std::string("cannot read ") + path);
  std::vector<Pose> poses;
  std::string line;
  for (std::getline(file, line); std::getline(file, line);) {
    std::istringstream cells(line);
    Pose pose;
    std::getline(cells, pose.id, ',');
    std::getline(cells, pose.pair, ',');
    std::getline(cells, pose.kind, ',');
    const auto number = [&] {
      std::string cell;
      std::getline(cells, cell, ',');
      return std::stod(cell);
    };
    for (double& x : pose.quaternion) x = number();
    for (double& x : pose.translation) x = number();
    poses.push_back(pose);
  }
  return poses;
}

// The central difference of V as the first body moves, that is, as the second moves the other way.
void check(const Mesh& first, const Mesh& second, const Pose& pose) {
  const Overlap here = overlap(first, second, pose);
  const double step = 1e-6;
  double worst = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector move(axis == 0 ? step : 0, axis == 1 ? step : 0, axis == 2 ? step : 0);
    const Number rise = overlap(first, second, pose, -move).volume - overlap(first, second, pose, move).volume;
    worst = std::max(worst, std::abs(rounded(here.force[axis] + rise / (2 * Number(step)))));
  }
  std::printf("%s %s: V %.6g, largest difference of the force %.3g\n", pose.id.c_str(), pose.pair.c_str(),
              rounded(here.volume), worst);
}

int main(int count, char**) {
  std::map<std::string, Mesh> shapes;
  const auto shape = [&](const std::string& name) -> const Mesh& {
    const auto found = shapes.find(name);
    return found != shapes.end() ? found->second : shapes[name] = read_obj("shapes/" + name + ".obj");
  };
  const auto poses = read_poses("poses.csv");
  std::ofstream file;
  if (count == 1) file.open("overlap_volume.csv");
  file.precision(17);
  file << "id,volume,force_x,force_y,force_z\n";
  for (size_t i = 0; i < poses.size(); ++i) {
    const Pose& pose = poses[i];
    const size_t dash = pose.pair.find('-');
    const Mesh first = shape(pose.pair.substr(0, dash)), second = shape(pose.pair.substr(dash + 1));
    if (count > 1) {
      if (i % 50 == 0) check(first, second, pose);
      continue;
    }
    const Overlap result = overlap(first, second, pose);
    file << pose.id << ',' << rounded(result.volume);
    for (int axis = 0; axis < 3; ++axis) file << ',' << rounded(result.force[axis]);
    file << '\n';
  }
}
