/* What golden_hash.c does in one precision: included once with REAL float and once with REAL double. */

/* A wave without a sine: t (1 - 4 t^2) for t from -1/2 to 1/2, over and over. */
static void NAME(ripple)(const REAL* point, int step, REAL* out) {
  const REAL phase = point[0] * (REAL)0.5 + point[1] * (REAL)0.25 + (REAL)(step * 0.0625);
  const REAL t = phase - ROUND(phase);
  const REAL height = t * ((REAL)1 - (REAL)4 * t * t) * (REAL)0.05;
  out[0] = point[0] + height * (REAL)0.25;
  out[1] = point[1] + (REAL)0;
  out[2] = point[2] + height;
}

static rayc_scene* NAME(new_scene)(const struct setting* setting, REAL* const* positions) {
  rayc_scene_options options;
  CHECK_OK(rayc_default_scene_options(sizeof options, &options));
  options.precision = SCALAR;
  rayc_scene* scene = NULL;
  CHECK_OK(rayc_scene_create(&options, &scene));
  CHECK_OK(rayc_scene_set_detection_options(scene, &setting->detection));
  for (uint32_t k = 0; k < setting->count; ++k) {
    const struct surface* body = &setting->bodies[k];
    rayc_mesh_options mesh_options;
    CHECK_OK(rayc_default_mesh_options(sizeof mesh_options, &mesh_options));
    mesh_options.precision = SCALAR;
    mesh_options.open = body->is_open;
    const rayc_vectors vectors = {.data = positions[k], .count = body->vertex_count, .scalar = SCALAR};
    rayc_mesh* mesh = NULL;
    uint32_t number = 42;
    CHECK_OK(rayc_mesh_create(&mesh_options, &vectors, body->triangles, body->triangle_count, &mesh));
    CHECK_OK(rayc_scene_add_mesh(scene, mesh, &number));
    CHECK_OK(rayc_scene_set_self_collision(scene, number, body->collides_with_itself));
    CHECK_OK(rayc_mesh_destroy(mesh));
  }
  return scene;
}

/* Each body goes a little along its force, so that what follows depends on it. */
static void NAME(move)(REAL* positions, const REAL* forces, size_t count, uint64_t* hash) {
  REAL push[3] = {0, 0, 0}, size = 0;
  for (size_t i = 0; i < 3 * count; ++i) {
    add_number(hash, forces[i]);
    push[i % 3] += forces[i];
  }
  for (int axis = 0; axis < 3; ++axis) {
    const REAL length = push[axis] < 0 ? -push[axis] : push[axis];
    if (length > size) size = length;
  }
  const REAL factor = size > 0 ? (REAL)0.02 / size : 1;
  for (size_t i = 0; i < 3 * count; ++i) positions[i] += push[i % 3] * factor;
}

static uint64_t NAME(hash_of)(const struct setting* setting) {
  REAL* positions[MOST_BODIES];
  REAL* forces[MOST_BODIES];
  rayc_vectors_mut force_vectors[MOST_BODIES];
  uint64_t hash = FNV_OFFSET;
  for (uint32_t k = 0; k < setting->count; ++k) {
    const size_t numbers = 3 * setting->bodies[k].vertex_count;
    positions[k] = malloc(numbers * sizeof(REAL));
    forces[k] = malloc(numbers * sizeof(REAL));
    for (size_t i = 0; i < numbers; ++i) positions[k][i] = (REAL)setting->bodies[k].positions[i];
    const rayc_vectors_mut vectors = {.data = forces[k], .count = numbers / 3, .scalar = SCALAR};
    force_vectors[k] = vectors;
  }
  rayc_scene* scene = NAME(new_scene)(setting, positions);
  rayc_contacts* contacts = NULL;
  CHECK_OK(rayc_contacts_create(&contacts));
  rayc_response_options law;
  CHECK_OK(rayc_default_response_options(sizeof law, &law));
  law.weighting = setting->weighting;
  for (int step = 0; step < STEPS; ++step) {
    for (uint32_t k = 0; k < setting->count; ++k) {
      /* The forces' place holds the rippled positions first. */
      const size_t vertices = setting->bodies[k].vertex_count;
      for (size_t i = 0; i < vertices; ++i) NAME(ripple)(positions[k] + 3 * i, step, forces[k] + 3 * i);
      const rayc_vectors rippled = {.data = forces[k], .count = vertices, .scalar = SCALAR};
      CHECK_OK(rayc_scene_set_positions(scene, k, &rippled));
      memset(forces[k], 0, 3 * vertices * sizeof(REAL));
    }
    CHECK_OK(rayc_scene_query(scene, contacts));
    add_contacts(&hash, contacts);
    CHECK_OK(rayc_contacts_add_forces(contacts, &law, setting->count, NULL, NULL, force_vectors));
    for (uint32_t k = 0; k < setting->count; ++k) {
      NAME(move)(positions[k], forces[k], setting->bodies[k].vertex_count, &hash);
    }
  }
  CHECK_OK(rayc_contacts_destroy(contacts));
  CHECK_OK(rayc_scene_destroy(scene));
  for (uint32_t k = 0; k < setting->count; ++k) {
    free(positions[k]);
    free(forces[k]);
  }
  return hash;
}
