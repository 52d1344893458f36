// SPDX-License-Identifier: MIT OR Apache-2.0
// Chen, Diaz and Yuksel 2023, "Shortest path to boundary for self-intersecting meshes", rebuilt from the paper on
// Embree 3.13. Two queries for each vertex of the surface: in which tetrahedra elsewhere in the body does it lie, and
// which point of the surface is the nearest that a straight path through the body leads to? Trees in single precision,
// refitted in each step; the rest in double precision.
//
// c++ -std=c++17 -O3 -march=native -shared -fPIC shortest_path.cpp -o shortest_path.so -lembree3
#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "penetration.h"

namespace {

struct Vector {
  double x, y, z;
};
Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vector operator*(double s, Vector a) { return {s * a.x, s * a.y, s * a.z}; }
double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vector cross(Vector a, Vector b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

using Triangle = std::array<uint32_t, 3>;
using Tetrahedron = std::array<uint32_t, 4>;
constexpr uint32_t none = UINT32_MAX;
// Counter-clockwise seen from outside.
constexpr int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
// How far, as a part of the path, rounding may move its end, and how far beyond its feasible region a point may lie.
constexpr double tolerance = 1e-6;

struct Tree {
  RTCScene scene = nullptr;
  RTCGeometry geometry = nullptr;

  Tree() = default;
  Tree(const Tree&) = delete;
  void make(RTCDevice device, RTCGeometryType type) {
    release();
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_DYNAMIC | RTC_SCENE_FLAG_ROBUST);
    // Only so does a scene keep one tree for each geometry, which alone can be refitted.
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW);
    geometry = rtcNewGeometry(device, type);
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
  }
  void commit() {
    rtcCommitGeometry(geometry);
    rtcCommitScene(scene);
  }
  void release() {
    if (!scene) return;
    rtcReleaseGeometry(geometry);
    rtcReleaseScene(scene);
    scene = nullptr;
  }
};

struct Body {
  std::vector<Vector> positions;
  std::vector<float> rounded;                     // of the surface's vertices
  std::vector<Triangle> triangles, across;        // the triangle beyond each edge
  std::vector<Tetrahedron> tetrahedra, beside;    // the tetrahedron beyond each face
  std::vector<std::vector<uint32_t>> neighbours;  // along the surface's edges
  Tree volume, surface;
};

Body body;

void bounds(const RTCBoundsFunctionArguments* of) {
  float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (const uint32_t vertex : body.tetrahedra[of->primID]) {
    const Vector& p = body.positions[vertex];
    const float at[3] = {float(p.x), float(p.y), float(p.z)};
    for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], at[k]), high[k] = std::max(high[k], at[k]);
  }
  RTCBounds& box = *of->bounds_o;
  box.lower_x = low[0], box.lower_y = low[1], box.lower_z = low[2];
  box.upper_x = high[0], box.upper_y = high[1], box.upper_z = high[2];
}

bool has(const Tetrahedron& tetrahedron, uint32_t vertex) {
  return std::find(tetrahedron.begin(), tetrahedron.end(), vertex) != tetrahedron.end();
}

Vector corner(uint32_t tetrahedron, int k) { return body.positions[body.tetrahedra[tetrahedron][k]]; }

// Outward, twice as long as the face is large.
Vector normal_of(uint32_t tetrahedron, const int (&face)[3]) {
  const Vector a = corner(tetrahedron, face[0]);
  return cross(corner(tetrahedron, face[1]) - a, corner(tetrahedron, face[2]) - a);
}

struct Holders {
  uint32_t vertex;
  std::vector<uint32_t> tetrahedra;
};

// The first query's: keeps a tetrahedron that the vertex is in and is no corner of.
bool hold(RTCPointQueryFunctionArguments* arguments) {
  Holders& found = *static_cast<Holders*>(arguments->userPtr);
  const uint32_t tetrahedron = arguments->primID;
  if (has(body.tetrahedra[tetrahedron], found.vertex)) return false;
  const Vector& point = body.positions[found.vertex];
  for (const auto& face : faces)
    if (dot(point - corner(tetrahedron, face[0]), normal_of(tetrahedron, face)) > 0) return false;
  found.tetrahedra.push_back(tetrahedron);
  return false;
}

// The nearest point of a triangle, and the corners that have a part in it: one, two or three.
struct Nearest {
  Vector point;
  int count;
  uint32_t corners[3];
};

Nearest nearest(Vector p, uint32_t triangle) {
  const Triangle& v = body.triangles[triangle];
  const Vector x[3] = {body.positions[v[0]], body.positions[v[1]], body.positions[v[2]]};
  const Vector normal = cross(x[1] - x[0], x[2] - x[0]);
  Nearest best{p - (dot(p - x[0], normal) / dot(normal, normal)) * normal, 3, {v[0], v[1], v[2]}};
  double least = INFINITY;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const Vector along = x[next] - x[k];
    if (dot(cross(along, p - x[k]), normal) >= 0) continue;
    // Beyond this edge.
    const double share = dot(p - x[k], along) / dot(along, along);
    Nearest found{x[k] + std::clamp(share, 0.0, 1.0) * along, 2, {v[k], v[next], none}};
    if (share <= 0 || share >= 1) found.count = 1, found.corners[0] = v[share <= 0 ? k : next];
    const Vector way = found.point - p;
    if (dot(way, way) < least) least = dot(way, way), best = found;
  }
  return best;
}

// Whether the point, seen from within the body, is nearer to nothing else around: then no step along the surface from
// there is a shorter path.
bool is_feasible(Vector p, uint32_t triangle, const Nearest& found) {
  const Vector way = p - found.point;
  const double most = tolerance * std::sqrt(dot(way, way));
  const auto leads_on = [&](Vector along) { return dot(way, along) > most * std::sqrt(dot(along, along)); };
  const auto normal = [](uint32_t of) {
    const Triangle& v = body.triangles[of];
    return cross(body.positions[v[1]] - body.positions[v[0]], body.positions[v[2]] - body.positions[v[0]]);
  };
  if (found.count == 1) {
    for (const uint32_t other : body.neighbours[found.corners[0]])
      if (leads_on(body.positions[other] - found.point)) return false;
    return true;
  }
  if (found.count == 3) return !leads_on(normal(triangle));
  const Triangle& v = body.triangles[triangle];
  const int edge = int(std::find(v.begin(), v.end(), found.corners[0]) - v.begin());
  const Vector along = body.positions[found.corners[1]] - body.positions[found.corners[0]];
  const Vector here = normal(triangle), there = normal(body.across[triangle][edge]);
  // Into the two triangles, across the edge; and out of the body.
  return !leads_on(cross(here, along)) && !leads_on(cross(along, there)) && !leads_on(here + there);
}

// Whether the straight path from a point of a tetrahedron stays in the body until it ends at those corners' surface.
bool is_path(Vector from, uint32_t tetrahedron, const Nearest& to) {
  const Vector way = to.point - from;
  uint32_t before = none;
  for (size_t steps = 0; steps <= body.tetrahedra.size(); ++steps) {
    double share = INFINITY;
    uint32_t next = none;
    for (int k = 0; k < 4; ++k) {
      const uint32_t other = body.beside[tetrahedron][k];
      if (other != none && other == before) continue;
      const Vector normal = normal_of(tetrahedron, faces[k]);
      const double outward = dot(way, normal);
      if (outward <= 0) continue;
      const double leaves = dot(corner(tetrahedron, faces[k][0]) - from, normal) / outward;
      if (leaves < share) share = leaves, next = other;
    }
    if (share >= 1 - tolerance)
      return std::all_of(to.corners, to.corners + to.count,
                         [&](uint32_t vertex) { return has(body.tetrahedra[tetrahedron], vertex); });
    if (next == none) return false;
    before = tetrahedron, tetrahedron = next;
  }
  return false;
}

struct Shortest {
  Vector from, to;
  uint32_t tetrahedron;
  double square = INFINITY;
};

// The second query's: takes a triangle's nearest point if it has the shortest path so far, and shrinks the query to
// that.
bool shorten(RTCPointQueryFunctionArguments* arguments) {
  Shortest& best = *static_cast<Shortest*>(arguments->userPtr);
  const Nearest found = nearest(best.from, arguments->primID);
  const Vector way = found.point - best.from;
  const double square = dot(way, way);
  if (square >= best.square || !is_feasible(best.from, arguments->primID, found) ||
      !is_path(best.from, best.tetrahedron, found))
    return false;
  best.square = square, best.to = found.point;
  arguments->query->radius = float(std::sqrt(square) * (1 + tolerance));
  return true;
}

void ask(RTCScene scene, Vector at, float radius, RTCPointQueryFunction function, void* found) {
  RTCPointQuery query{float(at.x), float(at.y), float(at.z), 0, radius};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene, &query, &context, function, found);
}

void place(const double* positions) {
  for (size_t i = 0; i < body.positions.size(); ++i)
    body.positions[i] = {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]};
  std::copy_n(positions, 3 * body.neighbours.size(), body.rounded.begin());
}

// What lies beyond each side of each element: the other one that has the same corners there.
template <class Elements, class Corners>
void join(const Elements& elements, Elements& beyond, Corners corners) {
  const size_t sides = elements[0].size();
  std::map<decltype(corners(elements[0], 0)), std::pair<uint32_t, size_t>> open;
  beyond = elements;
  for (uint32_t i = 0; i < elements.size(); ++i)
    for (size_t k = 0; k < sides; ++k) {
      auto key = corners(elements[i], k);
      std::sort(key.begin(), key.end());
      beyond[i][k] = none;
      const auto [other, is_new] = open.insert({key, {i, k}});
      if (!is_new) beyond[i][k] = other->second.first, beyond[other->second.first][other->second.second] = i;
    }
}

}  // namespace

int penetration_load_body(const penetration_body* given) {
  static const RTCDevice device = rtcNewDevice("threads=1");
  if (!device) return PENETRATION_FAILED;
  body.positions.resize(given->vertex_count);
  body.triangles.resize(given->triangle_count);
  body.tetrahedra.resize(given->tetrahedron_count);
  std::copy_n(given->triangles, 3 * given->triangle_count, body.triangles[0].begin());
  std::copy_n(given->tetrahedra, 4 * given->tetrahedron_count, body.tetrahedra[0].begin());
  join(body.triangles, body.across, [](const Triangle& t, size_t k) {
    return std::array<uint32_t, 2>{t[k], t[(k + 1) % 3]};
  });
  join(body.tetrahedra, body.beside, [](const Tetrahedron& t, size_t k) {
    return Triangle{t[faces[k][0]], t[faces[k][1]], t[faces[k][2]]};
  });
  body.neighbours.clear();
  for (const Triangle& triangle : body.triangles)
    for (int k = 0; k < 3; ++k) {
      if (triangle[k] >= body.neighbours.size()) body.neighbours.resize(triangle[k] + 1);
      body.neighbours[triangle[k]].push_back(triangle[(k + 1) % 3]);
    }
  body.rounded.resize(3 * body.neighbours.size() + 1);  // Embree reads 16 bytes at the last one
  place(given->positions);

  body.volume.make(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(body.volume.geometry, unsigned(body.tetrahedra.size()));
  rtcSetGeometryBoundsFunction(body.volume.geometry, bounds, nullptr);
  body.surface.make(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(body.surface.geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, body.rounded.data(),
                             0, 3 * sizeof(float), body.neighbours.size());
  rtcSetSharedGeometryBuffer(body.surface.geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, body.triangles.data(),
                             0, sizeof(Triangle), body.triangles.size());
  for (Tree* tree : {&body.volume, &body.surface}) {
    rtcCommitGeometry(tree->geometry);
    rtcAttachGeometry(tree->scene, tree->geometry);
    rtcCommitScene(tree->scene);
  }
  return rtcGetDeviceError(device) == RTC_ERROR_NONE ? PENETRATION_OK : PENETRATION_FAILED;
}

ptrdiff_t penetration_exits(const double* positions, penetration_exit* exits, size_t capacity) {
  static Holders holders;
  size_t count = 0;
  place(positions);
  rtcUpdateGeometryBuffer(body.surface.geometry, RTC_BUFFER_TYPE_VERTEX, 0);
  body.surface.commit();
  body.volume.commit();
  for (uint32_t vertex = 0; vertex < body.neighbours.size(); ++vertex) {
    holders.vertex = vertex;
    holders.tetrahedra.clear();
    ask(body.volume.scene, body.positions[vertex], 0, hold, &holders);
    Shortest best{body.positions[vertex], {}, 0};
    for (const uint32_t tetrahedron : holders.tetrahedra) {
      best.tetrahedron = tetrahedron;
      ask(body.surface.scene, best.from, float(std::sqrt(best.square)), shorten, &best);
    }
    if (best.square == INFINITY) continue;
    if (count < capacity) exits[count] = {vertex, {best.to.x, best.to.y, best.to.z}};
    ++count;
  }
  return ptrdiff_t(count);
}

// Pairs are not its task here.
int penetration_load(const penetration_surface*, const penetration_surface*) { return PENETRATION_OK; }
int penetration_move(const double*, const double*, const double*) { return PENETRATION_OK; }
int penetration_inside(uint8_t*, uint8_t*) { return PENETRATION_NOT_SUPPORTED; }
ptrdiff_t penetration_contacts(penetration_contact*, size_t) { return -PENETRATION_NOT_SUPPORTED; }
