// The C++ headers without exceptions: every failure comes as a Result. This file is compiled with -fno-exceptions and
// is part of a program whose other files use exceptions.
#include <array>
#include <cstring>

#include "check.h"
#include "raycontact.hpp"

#ifndef RAYCONTACT_NO_EXCEPTIONS
#error "the headers did not notice that exceptions are off"
#endif

using namespace raycontact;

int check_results_without_exceptions();

int check_results_without_exceptions() {
  const std::array<std::array<double, 3>, 4> corners = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const uint32_t faces[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  const Result<Mesh> mesh = Mesh::create(vectors(corners), faces);
  CHECK(mesh);

  const Result<Mesh> holed = Mesh::create(vectors(corners), Span<const uint32_t>(faces, 9));
  CHECK(!holed && holed.error().status() == RAYC_STATUS_MESH_OPEN);
  CHECK(std::strstr(holed.error().what(), "RAYC_STATUS_MESH_OPEN: ") != nullptr);
  const Result<Mesh> odd = Mesh::create(vectors(corners), Span<const uint32_t>(faces, 11));
  CHECK(!odd && odd.error().status() == RAYC_STATUS_WRONG_COUNT);

  Result<Scene> scene = Scene::create();
  CHECK(scene);
  const Result<uint32_t> body = scene.value().add(mesh.value());
  CHECK(body && body.value() == 0);
  const Result<void> removed = scene.value().remove(7);
  CHECK(!removed && removed.error().status() == RAYC_STATUS_UNKNOWN_BODY);
  Result<Contacts> contacts = Contacts::create();
  CHECK(contacts && scene.value().query(contacts.value()));
  const Result<std::size_t> count = contacts.value().size();
  CHECK(count && count.value() == 0);

  // What has been moved away refuses with an error, too.
  const Scene taken = std::move(scene).value();
  CHECK(!scene.value().query(contacts.value()));
  return check_result();
}
