// SPDX-License-Identifier: MIT OR Apache-2.0
// Two soft bodies that start deep inside one another, pushed apart by raycontact in Bullet's deformable world.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "inside_test.hpp"
#include "raycontact/bullet.hpp"
#include "shapes.hpp"
#include "soft_world.hpp"
#include "terminal.hpp"
#include "two_bodies_options.hpp"
#include "vtp_file.hpp"

namespace {

using demo::Options;
using demo::Surface;
namespace rb = raycontact::bullet;

struct Body {
  Surface surface;
  rb::Cage cage;
  double mass = 0;
  btSoftBody* soft = nullptr;
  std::vector<uint8_t> inside;  // of each vertex: 1 = inside the other body

  void follow_cage() {
    std::vector<btScalar> positions;
    rb::skin_positions(*soft, cage.skin, positions);
    surface.positions.assign(positions.begin(), positions.end());
  }
};

std::vector<Body> make_bodies(const Options& options) {
  std::vector<Body> bodies(2);
  if (options.surfaces.empty()) {
    const auto around = static_cast<uint32_t>(options.around);
    for (Body& body : bodies) body.surface = demo::torus(around, around / 2);
    demo::move(bodies[1].surface, {{0.25, 0.1, 0.3}});
    // 6 x 5 x 2 nodes for each torus, as in the paper; the torus is flat along y.
    for (Body& body : bodies) body.cage = rb::make_cage(body.surface.positions, body.surface.triangles, {{5, 1, 4}});
  } else {
    for (std::size_t i = 0; i < 2; ++i) {
      bodies[i].surface = demo::read_obj(options.surfaces[i]);
      demo::normalise(bodies[i].surface, 2.8);  // m, the size of the tori
    }
    demo::move(bodies[1].surface, {{0.1, 0.04, 0.12}});
    for (Body& body : bodies)
      body.cage = rb::make_cage(body.surface.positions, body.surface.triangles, static_cast<int>(options.cells));
  }
  for (Body& body : bodies) body.mass = options.density * demo::volume(body.surface);
  return bodies;
}

/** Marks the vertices of each body inside the other, by winding number: the library's contacts have no say in it. */
std::size_t mark_inside(std::vector<Body>& bodies) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    Body& body = bodies[i];
    const Surface& other = bodies[1 - i].surface;
    const demo::InsideTest test(other.positions, other.triangles);
    body.inside.assign(body.surface.vertex_count(), 0);
    for (std::size_t v = 0; v < body.inside.size(); ++v) {
      body.inside[v] = test.contains(&body.surface.positions[3 * v]) ? 1 : 0;
      count += body.inside[v];
    }
  }
  return count;
}

demo::VtpSurface frame(const std::vector<Body>& bodies) {
  demo::VtpSurface frame;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    const int32_t first = static_cast<int32_t>(frame.body.size());
    for (double x : body.surface.positions) frame.points.push_back(static_cast<float>(x));
    for (uint32_t v : body.surface.triangles) frame.triangles.push_back(first + static_cast<int32_t>(v));
    frame.body.insert(frame.body.end(), body.inside.size(), static_cast<uint8_t>(i));
    frame.inside.insert(frame.inside.end(), body.inside.begin(), body.inside.end());
  }
  return frame;
}

int inverted_tetrahedra(const std::vector<Body>& bodies) {
  int count = 0;
  for (const Body& body : bodies) count += rb::inverted_tetrahedra(*body.soft);
  return count;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Result {
  std::size_t vertices = 0, inside_start = 0, inside_end = 0, contacts_start = 0, contacts_end = 0, contacts_most = 0;
  int steps = 0;  // until no vertex was inside any more
  int steps_in_all = 0;
  int inverted_start = 0, inverted = 0, inverted_most = 0;
  double detect_ms = 0, solve_ms = 0, step_ms = 0, contacts = 0;  // medians over the steps with contact

  double percent(std::size_t count) const { return 100.0 * static_cast<double>(count) / static_cast<double>(vertices); }
};

Result run(const Options& options, std::vector<Body>& bodies, demo::SoftWorld& world, demo::PvdSeries& series) {
  Result result;
  for (const Body& body : bodies) result.vertices += body.surface.vertex_count();
  std::size_t inside = result.inside_start = mark_inside(bodies);
  result.inverted_start = result.inverted = inverted_tetrahedra(bodies);
  series.add(0, frame(bodies));

  std::vector<double> detect_ms, solve_ms, step_ms, contact_counts;
  const demo::ProgressBar progress;
  const int most = static_cast<int>(options.steps), every = static_cast<int>(options.every);
  const int rest = static_cast<int>(std::max(5.0, 0.5 / options.dt));  // must stay apart so long
  int step = 0;
  for (; step < most && (inside > 0 || step - result.steps < rest); ++step) {
    const auto start = std::chrono::steady_clock::now();
    world.step(options.dt);
    const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    const std::size_t contacts = world.contact().contact_count();
    if (contacts > 0) {
      detect_ms.push_back(world.contact().last_detection_ms());
      solve_ms.push_back(ms - detect_ms.back());
      step_ms.push_back(ms);
      contact_counts.push_back(static_cast<double>(contacts));
    }
    if (step == 0) result.contacts_start = contacts;
    result.contacts_end = contacts;
    result.contacts_most = std::max(result.contacts_most, contacts);

    for (Body& body : bodies) body.follow_cage();
    result.inverted = inverted_tetrahedra(bodies);
    result.inverted_most = std::max(result.inverted_most, result.inverted);
    inside = mark_inside(bodies);
    if (inside > 0) result.steps = step + 1;
    if ((step + 1) % every == 0) series.add((step + 1) * options.dt, frame(bodies));
    char note[96];
    std::snprintf(note, sizeof note, "step %d, %.1f%% inside, %zu contacts", step + 1, result.percent(inside),
                  contacts);
    progress.show(1 - static_cast<double>(inside) / static_cast<double>(std::max<std::size_t>(1, result.inside_start)),
                  note);
  }
  if (step % every != 0) series.add(step * options.dt, frame(bodies));
  // The vertices were last inside after that many steps; one more brought them out.
  result.steps = std::min(step, result.steps + (inside == 0 && result.inside_start > 0 ? 1 : 0));
  result.steps_in_all = step;
  result.inside_end = inside;
  result.detect_ms = median(detect_ms);
  result.solve_ms = median(solve_ms);
  result.step_ms = median(step_ms);
  result.contacts = median(contact_counts);
  return result;
}

void print_table(const Options& options, const std::vector<Body>& bodies, const Result& result, double stiffness,
                 const demo::PvdSeries& series) {
  std::printf("%-22s %12s %12s\n", "body", bodies[0].surface.name.c_str(), bodies[1].surface.name.c_str());
  const auto row = [&](const char* label, auto value) {
    std::printf("%-22s %12zu %12zu\n", label, static_cast<std::size_t>(value(bodies[0])),
                static_cast<std::size_t>(value(bodies[1])));
  };
  row("skin vertices", [](const Body& b) { return b.surface.vertex_count(); });
  row("skin triangles", [](const Body& b) { return b.surface.triangles.size() / 3; });
  row("cage nodes", [](const Body& b) { return b.cage.nodes.size(); });
  row("cage tetrahedra", [](const Body& b) { return b.cage.tetrahedra.size(); });
  std::printf("%-22s %12.3g %12.3g\n\n", "mass / kg", bodies[0].mass, bodies[1].mass);

  std::printf("%-22s %12s %12s\n", "", "start", "end");
  std::printf("%-22s %11.1f%% %11.1f%%\n", "vertices inside", result.percent(result.inside_start),
              result.percent(result.inside_end));
  std::printf("%-22s %12zu %12zu   (most %zu)\n", "contacts", result.contacts_start, result.contacts_end,
              result.contacts_most);
  std::printf("%-22s %12d %12d   (most %d)\n\n", "inverted tetrahedra", result.inverted_start, result.inverted,
              result.inverted_most);

  std::printf("Young's modulus %g Pa, contact %.4g N/m^3 with %g s of damping, time step %g s, Bullet in %s\n",
              options.youngs_modulus, stiffness, options.damping, options.dt,
              rb::double_precision ? "double" : "float");
  std::printf("ran %d steps; wrote %zu frames, listed in %s\n", result.steps_in_all, series.count(),
              series.path().c_str());
}

int simulate(const Options& options) {
  std::vector<Body> bodies = make_bodies(options);
  const double edge = std::min(bodies[0].cage.cell_edge, bodies[1].cage.cell_edge);
  rb::ContactOptions contact = rb::ContactOptions::elastic(options.youngs_modulus, 0.3, edge);
  contact.stiffness *= options.stiffness;
  contact.damping_time = options.damping;
  contact.depth_cap = options.depth_cap * edge;
  // The skins are much finer than the cages: their vertices are enough.
  contact.sampling = options.spacing > 0   ? RAYC_SAMPLING_SPACING
                     : options.spacing < 0 ? RAYC_SAMPLING_ACCURACY
                                           : RAYC_SAMPLING_VERTICES;
  contact.sampling_value = options.spacing < 0 ? options.accuracy : options.spacing;
  contact.threads = static_cast<uint32_t>(options.threads);

  demo::SoftWorld world(options.youngs_modulus, 0.3, contact);
  for (Body& body : bodies) body.soft = &world.add(body.cage, body.mass);
  demo::PvdSeries series(options.out, "two_bodies");
  const Result result = run(options, bodies, world, series);
  print_table(options, bodies, result, contact.stiffness, series);
  const bool separated = result.inside_end == 0;
  std::printf("medians over the steps with contact: %g contacts, %.2f ms of detection, %.2f ms of the rest of a step\n",
              result.contacts, result.detect_ms, result.solve_ms);
  std::printf("%s inside_start=%.1f%% inside_end=%.1f%% steps=%d inverted=%d detect_ms=%.2f step_ms=%.2f\n",
              separated ? "separated" : "not separated", result.percent(result.inside_start),
              result.percent(result.inside_end), result.steps, result.inverted, result.detect_ms, result.step_ms);
  return separated ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const Options options = demo::parse_options(argc, argv);
    if (options.help) {
      std::fputs(demo::usage(), stdout);
      return 0;
    }
    return simulate(options);
  } catch (const demo::UsageError& error) {
    std::fprintf(stderr, "two_bodies: %s\n\n%s", error.what(), demo::usage());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "two_bodies: %s\n", error.what());
  }
  return 2;
}
