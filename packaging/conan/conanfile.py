"""Conan recipe: `conan create conan` from the root of the repository. A Rust toolchain is taken from the PATH."""

import os
import re

from conan import ConanFile
from conan.errors import ConanInvalidConfiguration
from conan.tools.cmake import CMake, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load, rm, rmdir

SOURCES = ["CMakeLists.txt", "Cargo.toml", "Cargo.lock", "build.rs", "README.md", "LICENSE-*", "packaging/cmake/*", "include/*", "src/*"]


class Raycontact(ConanFile):
    name = "raycontact"
    description = "Ray-traced contact detection and response for deformable bodies"
    license = "MIT OR Apache-2.0"
    topics = ("collision", "contact", "physics", "simulation", "deformable")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False]}
    default_options = {"shared": False}
    no_copy_source = True  # so that cargo knows the sources again when only an option differs
    # user.raycontact:cargo_target_dir=<folder> shares the build products of cargo between builds.

    def set_version(self):
        cargo = load(self, os.path.join(self.recipe_folder, "..", "..", "Cargo.toml"))
        self.version = re.search(r'^version = "([^"]+)"', cargo, re.MULTILINE).group(1)

    def export_sources(self):
        root = os.path.join(self.recipe_folder, "..", "..")
        for pattern in SOURCES:
            copy(self, pattern, src=root, dst=self.export_sources_folder)

    def validate(self):
        if self.settings.os != "Linux":
            raise ConanInvalidConfiguration("raycontact's CMake build is tested on Linux only")

    def layout(self):
        cmake_layout(self)

    def configure(self):
        # The library's interface is C, and its headers need no C++ runtime of its own.
        self.settings.rm_safe("compiler.libcxx")
        self.settings.rm_safe("compiler.cppstd")

    def generate(self):
        toolchain = CMakeToolchain(self)
        toolchain.variables["RAYCONTACT_BUILD_TESTS"] = False
        toolchain.variables["RAYCONTACT_BUILD_DEMOS"] = False
        cargo_target_dir = self.conf.get("user.raycontact:cargo_target_dir")
        if cargo_target_dir:
            toolchain.cache_variables["RAYCONTACT_CARGO_TARGET_DIR"] = cargo_target_dir
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()
        libraries = os.path.join(self.package_folder, "lib")
        rm(self, "*.a" if self.options.shared else "*.so*", libraries)
        # Conan writes these for its consumers itself.
        rmdir(self, os.path.join(libraries, "cmake"))

    def package_info(self):
        self.cpp_info.libs = ["raycontact"]
        if not self.options.shared:
            self.cpp_info.system_libs = self._system_libraries()
        self.cpp_info.set_property("cmake_target_name", "raycontact::raycontact")

    def _system_libraries(self):
        """What rustc named when the library was built."""
        pkg_config = load(self, os.path.join(self.package_folder, "lib", "pkgconfig", "raycontact.pc"))
        flags = re.search(r"^Libs\.private:(.*)$", pkg_config, re.MULTILINE).group(1).split()
        return [flag.removeprefix("-l") for flag in flags]
