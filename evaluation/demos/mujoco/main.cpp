// SPDX-License-Identifier: MIT OR Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "run.hpp"
#include "vtp_file.hpp"

namespace {

using flexes::Contact;

struct Options {
  std::string scene, contact = "raycontact", out, xml, only;
  std::vector<std::string> files;
  double dt = 0;
};

void print_usage(FILE* out) {
  std::fputs(
      "usage: mujoco_flexes SCENE [options]\n"
      "       mujoco_flexes table [options]\n"
      "       mujoco_flexes map [--only SCENE]\n\n"
      "Flexes, MuJoCo's deformable bodies, in contact: raycontact's, or MuJoCo's own to compare with.\n\n"
      "  tori              two tetrahedral tori that start 0.19 m deep in one another\n"
      "  impact            two tetrahedral tori that meet at 2 m/s\n"
      "  skins             two skins in 4 x 4 x 4 trilinear cells that start deep in one another\n"
      "  pile              ten tetrahedral tori fall in a pile\n"
      "  table             all scenes, step by step beside MuJoCo's own contact, as docs/mujoco.md has them\n"
      "  map               all scenes at many time steps, with each contact: lines for docs/hosts/map.csv\n\n"
      "  --contact WHO     raycontact (the default); mujoco: MuJoCo's constraints; passive: its passive contact\n"
      "  --dt SECONDS      time step (0.005)\n"
      "  --only SCENE      of the table or map, that scene alone\n"
      "  --obj FILE        a closed surface in place of a skin; to be given twice\n"
      "  --out FOLDER      write ParaView files there, about 60 frames\n"
      "  --xml FILE        write the model\n"
      "  --help            this text\n\n"
      "Prints lines of figures. Exit status: 0 where bodies came apart in time, or lie in a pile, no element turned "
      "inside\n"
      "out, and no energy or momentum came from nowhere; 1 where not, 2 wrong usage or unusable input.\n",
      out);
}

int wrong_usage(const std::string& what) {
  std::fprintf(stderr, "mujoco_flexes: %s\n\n", what.c_str());
  print_usage(stderr);
  return 2;
}

void write_frame(demo::PvdSeries& series, const flexes::Run& run, double time) {
  demo::VtpSurface surface;
  for (std::size_t b = 0; b < run.body_count(); ++b) {
    const auto first = static_cast<uint32_t>(surface.points.size() / 3);
    // ParaView's and the picture's up is y.
    const std::vector<double> x = run.judge().positions(run.data(), b);
    for (std::size_t k = 0; k < x.size(); k += 3)
      for (const double value : {x[k], x[k + 2], -x[k + 1]}) surface.points.push_back(static_cast<float>(value));
    const std::vector<uint8_t>& inside = run.judge().inside(b);
    surface.inside.insert(surface.inside.end(), inside.begin(), inside.end());
    for (const uint32_t corner : run.judge().triangles(b))
      surface.triangles.push_back(static_cast<int32_t>(first + corner));
    surface.body.resize(surface.points.size() / 3, static_cast<uint8_t>(b));
  }
  series.add(time, surface);
}

std::string apart_of(const flexes::Figures& figures) {
  if (figures.apart < 0) return "never";
  char text[40];
  std::snprintf(text, sizeof text, "%.3f s", figures.apart);
  return text;
}

/** Whether a run went as it should. */
bool is_good(const flexes::Scene& scene, const flexes::Figures& figures, double dt) {
  if (!figures.error.empty() || figures.most_inverted > 0) return false;
  const std::string name = scene.name;
  // Bodies may sink into one another and the floor by a part of an element's edge, 0.3 m.
  if (name == "pile") return figures.deepest < 0.15 && figures.last_depth < 0.05 && figures.lowest > -0.05;
  const double half_step = dt / 2;
  if (figures.apart < 0 || figures.energy_gain > 1e-3 || figures.drift > 1e-5 * scene.model.bodies[0].mass)
    return false;
  if (name == "tori") return figures.apart < 0.12 + half_step;
  if (name == "skins") return figures.apart < 0.15 + half_step;
  return figures.deepest < (dt < 0.01 ? 0.012 : 0.02) && figures.most_energy < (1 + 1e-9) * figures.start_energy;
}

/** How a run ended, whoever made the contact: other than is_good() it asks for no time and no depth. */
const char* verdict_of(const flexes::Scene& scene, const flexes::Figures& figures, bool is_done) {
  if (!figures.error.empty()) return "exploded";
  if (figures.most_inverted > 0) return "inverted";
  if (!is_done) return "unfinished";
  if (figures.energy_gain > 1e-3) return "exploded";
  const bool is_pile = scene.name == std::string("pile");
  const bool lies = figures.last_depth < 0.05 && figures.lowest > -0.05;
  return (is_pile ? lies : figures.apart >= 0) ? "ok" : "overlapping";
}

int print_map(const Options& options) {
  constexpr double most_seconds = 120;  // of the processor
  for (const char* name : {"tori", "impact", "skins", "pile"}) {
    if (!options.only.empty() && options.only != name) continue;
    const flexes::Scene scene = flexes::scene_named(name, {});
    for (const Contact contact : {Contact::raycontact, Contact::mujoco, Contact::passive})
      for (const double dt : {0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001}) {
        flexes::Run run(scene, contact, dt);
        const std::clock_t start = std::clock();
        while (!run.is_done() && double(std::clock() - start) < most_seconds * CLOCKS_PER_SEC) run.step();
        std::printf("MuJoCo,%s,%s,%g,%s\n", name, flexes::name_of(contact), dt,
                    verdict_of(scene, run.figures(), run.is_done()));
        std::fflush(stdout);
      }
  }
  return 0;
}

int run_one(const Options& options) {
  const flexes::Scene scene = flexes::scene_named(options.scene, options.files);
  Contact contact = Contact::raycontact;
  for (const Contact known : {Contact::mujoco, Contact::passive})
    if (options.contact == flexes::name_of(known)) contact = known;
  const double dt = options.dt > 0 ? options.dt : 0.005;
  if (!options.xml.empty()) {
    std::ofstream file = demo::open_for_writing(options.xml);
    flexes::Model model = scene.model;
    model.timestep = dt;
    file << flexes::xml_of(model, contact);
    demo::close_checked(file, options.xml);
  }
  flexes::Run run(scene, contact, dt);
  if (!options.out.empty()) {
    demo::PvdSeries series(options.out, std::string("mujoco_") + scene.name);
    // About 60 frames, the first and the last step among them.
    const auto steps = static_cast<int>(std::lround(scene.seconds / dt)), between = std::max(1, steps / 60);
    write_frame(series, run, 0);
    for (int step = 1; !run.is_done(); ++step) {
      run.step();
      if (step % between == 0 || run.is_done()) write_frame(series, run, step * dt);
    }
  } else {
    while (!run.is_done()) run.step();
  }
  const flexes::Figures f = run.figures();
  const bool good = is_good(scene, f, dt);
  std::printf(
      "%s: %s, apart after %s, depth %.4f m at the start, %.4f m at most, %.4f m at the end, %d inside out, energy "
      "%.4g J at "
      "the start, %.4g J at most, %.4g J at the end, rise by %.3g J, gain once apart %.2g, momentum changed by %.2g kg "
      "m/s, lowest "
      "%.3f m, "
      "%.2f ms of the processor a step, %.2f ms of it the adapter%s%s\n",
      scene.name, good ? "ok" : "failed", apart_of(f).c_str(), f.start_depth, f.deepest, f.last_depth, f.most_inverted,
      f.start_energy, f.most_energy, f.last_energy, f.largest_rise, f.energy_gain, f.drift, f.lowest, 1e3 * f.step_time,
      1e3 * f.adapter_time, f.error.empty() ? "" : ", ", f.error.c_str());
  return good ? 0 : 1;
}

int print_table(const Options& options) {
  std::printf("| scene | dt, s | contact | apart | deepest, m | inside out | ms a step | of it the adapter |\n");
  std::printf("| --- | --- | --- | --- | --- | --- | --- | --- |\n");
  bool good = true;
  for (const char* name : {"tori", "impact", "skins", "pile"}) {
    if (!options.only.empty() && options.only != name) continue;
    const flexes::Scene scene = flexes::scene_named(name, options.files);
    std::vector<double> steps = {0.002, 0.005, 0.02};
    if (std::string(name) == "pile") steps = {0.005};
    if (options.dt > 0) steps = {options.dt};
    for (const double dt : steps) {
      // All step in turn, so that what else the machine does falls on all of them.
      std::vector<std::unique_ptr<flexes::Run>> runs;
      const std::vector<Contact> contacts = {Contact::raycontact, Contact::mujoco, Contact::passive};
      for (const Contact contact : contacts) runs.push_back(std::make_unique<flexes::Run>(scene, contact, dt));
      while (!runs[0]->is_done())
        for (const auto& run : runs) run->step();
      for (std::size_t i = 0; i < runs.size(); ++i) {
        const flexes::Figures f = runs[i]->figures();
        std::printf("| %s | %g | %s | %s | %.4f | %d | %.2f |", name, dt, flexes::name_of(contacts[i]),
                    apart_of(f).c_str(), f.deepest, f.most_inverted, 1e3 * f.step_time);
        if (i == 0)
          std::printf(" %.2f |\n", 1e3 * f.adapter_time);
        else
          std::printf(" |\n");
        std::fflush(stdout);
        good = good && (i > 0 || is_good(scene, f, dt));
      }
    }
  }
  return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const std::string value = i + 1 < argc ? argv[i + 1] : "";
    if (argument == "--help" || argument == "-h") return print_usage(stdout), 0;
    if (argument[0] != '-') {
      if (!options.scene.empty()) return wrong_usage("'" + argument + "' is one scene too many");
      options.scene = argument;
      continue;
    }
    if (argument != "--contact" && argument != "--dt" && argument != "--obj" && argument != "--out" &&
        argument != "--xml" && argument != "--only")
      return wrong_usage("unknown option '" + argument + "'");
    if (value.empty()) return wrong_usage(argument + " needs a value");
    ++i;
    if (argument == "--contact") options.contact = value;
    if (argument == "--obj") options.files.push_back(value);
    if (argument == "--out") options.out = value;
    if (argument == "--xml") options.xml = value;
    if (argument == "--only") options.only = value;
    if (argument == "--dt") {
      char* end = nullptr;
      options.dt = std::strtod(value.c_str(), &end);
      if (*end != '\0' || !(options.dt > 0 && options.dt <= 0.1))
        return wrong_usage("--dt needs a number above 0, at most 0.1");
    }
  }
  if (options.scene.empty()) return wrong_usage("name a scene, table or map");
  if (options.contact != "raycontact" && options.contact != "mujoco" && options.contact != "passive")
    return wrong_usage("--contact is raycontact, mujoco or passive");
  if (!options.files.empty() && options.files.size() != 2) return wrong_usage("give --obj twice, or not at all");
  try {
    if (!options.only.empty()) flexes::scene_named(options.only, {});
    if (options.scene == "map") return print_map(options);
    return options.scene == "table" ? print_table(options) : run_one(options);
  } catch (const std::invalid_argument& error) {
    return wrong_usage(error.what());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mujoco_flexes: %s\n", error.what());
    return 2;
  }
}
