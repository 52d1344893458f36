// A second translation unit with the adapter: what is not inline in its headers stops the linker.
#include "raycontact/bullet.hpp"

std::size_t points_of_own_faces(const btSoftBody& body);

std::size_t points_of_own_faces(const btSoftBody& body) {
  return raycontact::bullet::skin_from_faces(body).points.size();
}
