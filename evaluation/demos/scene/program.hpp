// SPDX-License-Identifier: MIT OR Apache-2.0
/** The command line that all scenes share. */
#ifndef RAYCONTACT_DEMOS_SCENE_PROGRAM_HPP
#define RAYCONTACT_DEMOS_SCENE_PROGRAM_HPP

#include <functional>
#include <string>
#include <vector>

#include "scene.hpp"

namespace demo {

/** `make` gets what stands on the command line besides the options: surfaces of the user's, or nothing. */
using MakeScene = std::function<Scene(const std::vector<std::string>& arguments)>;

/**
 * Runs the scene as the command line says: ParaView files with --out, a progress bar, a table on standard error and one
 * line of comma-separated values on standard output. Returns the exit status: 0 ok, 1 another verdict, 2 wrong usage.
 */
int run_program(int argc, char** argv, const char* description, const MakeScene& make);

}  // namespace demo

#endif  // RAYCONTACT_DEMOS_SCENE_PROGRAM_HPP
