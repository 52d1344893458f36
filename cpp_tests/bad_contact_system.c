/* What a contact system is asked wrongly has its own status, and nothing changes; asked rightly it keeps momentum. */
#include <stdlib.h>

#include "check.h"
#include "raycontact/distributed.h"
#include "shapes.h"

#define NODES OCTAHEDRON_VERTICES
#define UNKNOWNS (3 * 2 * NODES)

static const double no_shift[3] = {0, 0, 0};
static const double inertia[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
static const rayc_material fine = {sizeof fine, 1e4, 0.01, 0.3, 0.05, 0};

static rayc_scene* scene = NULL;
static rayc_contact_system* contacts = NULL;
static double x[UNKNOWNS], v[UNKNOWNS], out[UNKNOWNS];

/* Two octahedra that overlap: bodies 0 and 1. */
static void make_scene(void) {
  CHECK_OK(rayc_scene_create(NULL, &scene));
  for (int k = 0; k < 2; ++k) {
    const double* shift = k == 0 ? no_shift : octahedron_shift;
    uint32_t body = 42;
    rayc_mesh* mesh = octahedron_mesh(shift);
    CHECK_OK(rayc_scene_add_mesh(scene, mesh, &body));
    CHECK_OK(rayc_mesh_destroy(mesh));
    octahedron_shifted(shift, x + 3 * NODES * k);
  }
}

static rayc_status add(uint32_t body, const rayc_material* material) {
  return rayc_contact_system_add_deformable(contacts, scene, body, body * NODES, NODES, NULL, 0, NULL, NULL, material);
}

static void options_are_refused(void) {
  rayc_contact_system* other = NULL;
  rayc_contact_system_options options;
  CHECK_OK(rayc_default_contact_system_options(sizeof options, &options));
  CHECK(options.precision == RAYC_SCALAR_F64 && options.keeps_rigid_unknowns == 0);
  options.keeps_rigid_unknowns = 2;
  CHECK_STATUS(rayc_contact_system_create(&options, &other), RAYC_STATUS_INVALID_OPTION, "keeps_rigid_unknowns is 2");
  options.keeps_rigid_unknowns = 0;
  options.look_ahead = 2;
  CHECK_STATUS(rayc_contact_system_create(&options, &other), RAYC_STATUS_INVALID_OPTION, "look_ahead is 2");
  options.look_ahead = 0;
  options.weighting = 7;
  CHECK_STATUS(rayc_contact_system_create(&options, &other), RAYC_STATUS_UNKNOWN_ENUM, "weighting is 7");
  options.weighting = RAYC_WEIGHTING_VERTEX;
  options.precision = 7;
  CHECK_STATUS(rayc_contact_system_create(&options, &other), RAYC_STATUS_UNKNOWN_ENUM, "precision");
  options.struct_size = 4;
  CHECK_STATUS(rayc_contact_system_create(&options, &other), RAYC_STATUS_INVALID_STRUCT_SIZE, "struct_size");
  CHECK_STATUS(rayc_contact_system_create(NULL, NULL), RAYC_STATUS_NULL_POINTER, "system");
  CHECK(other == NULL);
  CHECK_OK(rayc_contact_system_destroy(NULL));

  rayc_material material = {42, 42, 42, 42, 42, 42};
  CHECK_STATUS(rayc_bearing_material(0, 1, sizeof material, &material), RAYC_STATUS_INVALID_MATERIAL, "pressure is 0");
  CHECK_STATUS(rayc_bearing_material(1, -1, sizeof material, &material), RAYC_STATUS_INVALID_MATERIAL, "depth is -1");
  CHECK_STATUS(rayc_elastic_material(1, 0.5, 1, sizeof material, &material), RAYC_STATUS_INVALID_MATERIAL,
               "poissons_ratio is 0.5");
  CHECK_STATUS(rayc_elastic_material(1, 0, -1, sizeof material, &material), RAYC_STATUS_INVALID_MATERIAL, "edge is -1");
  CHECK_STATUS(rayc_bearing_material(1, 1, 8, &material), RAYC_STATUS_INVALID_STRUCT_SIZE, "rayc_material");
  CHECK(material.stiffness == 42 && material.depth_cap == 42 && material.restitution == 42);
  CHECK_OK(rayc_bearing_material(500, 0.25, sizeof material, &material));
  CHECK(material.stiffness == 2000 && material.depth_cap == 0.25 && material.restitution == 0);
}

static void bodies_are_refused(void) {
  const double masses[2] = {1, -1}, many[2 * NODES] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
  CHECK_STATUS(rayc_contact_system_set_node_masses(contacts, 2, masses), RAYC_STATUS_INVALID_MASS, "node 1 is -1");
  CHECK_STATUS(rayc_contact_system_set_node_masses(contacts, 2, NULL), RAYC_STATUS_NULL_POINTER, "masses");
  CHECK_STATUS(add(0, &fine), RAYC_STATUS_WRONG_COUNT, "node masses");
  CHECK_OK(rayc_contact_system_set_node_masses(contacts, 2 * NODES, many));
  CHECK_STATUS(add(2, &fine), RAYC_STATUS_UNKNOWN_BODY, "no body 2");
  CHECK_STATUS(add(0, NULL), RAYC_STATUS_NULL_POINTER, "material");

  rayc_material wrong = fine;
  wrong.stiffness = -1;
  CHECK_STATUS(add(0, &wrong), RAYC_STATUS_INVALID_MATERIAL, "stiffness is -1");
  wrong = fine;
  wrong.struct_size += sizeof(double);
  CHECK_STATUS(add(0, &wrong), RAYC_STATUS_INVALID_STRUCT_SIZE, "rayc_material");
  wrong = fine;
  wrong.friction = NAN;
  CHECK_STATUS(add(0, &wrong), RAYC_STATUS_INVALID_MATERIAL, "friction is NaN");
  wrong = fine;
  wrong.restitution = 1.5;
  CHECK_STATUS(add(0, &wrong), RAYC_STATUS_INVALID_MATERIAL, "restitution is 1.5; it must be from 0 to 1");
  wrong = fine;
  wrong.friction = NAN;

  uint32_t offsets[NODES + 1], nodes[NODES];
  double weights[NODES];
  for (uint32_t k = 0; k <= NODES; ++k) offsets[k] = k;
  for (uint32_t k = 0; k < NODES; ++k) nodes[k] = k, weights[k] = 1;
#define ADD(count, n, w) rayc_contact_system_add_deformable(contacts, scene, 0, 0, NODES, offsets, count, n, w, &fine)
  weights[2] = 0.5;
  CHECK_STATUS(ADD(NODES, nodes, weights), RAYC_STATUS_INVALID_WEIGHTS, "vertex 2 sum to 0.5");
  weights[2] = NAN;
  CHECK_STATUS(ADD(NODES, nodes, weights), RAYC_STATUS_NOT_FINITE, "weights[2]");
  weights[2] = 1;
  nodes[3] = NODES;
  CHECK_STATUS(ADD(NODES, nodes, weights), RAYC_STATUS_INVALID_WEIGHTS, "node 6 of 6");
  nodes[3] = 3;
  CHECK_STATUS(ADD(NODES - 1, nodes, weights), RAYC_STATUS_INVALID_WEIGHTS, "offsets");
  CHECK_STATUS(ADD(NODES, NULL, weights), RAYC_STATUS_NULL_POINTER, "nodes");

  CHECK_STATUS(rayc_contact_system_add_rigid(contacts, scene, 0, 0, inertia, &fine), RAYC_STATUS_INVALID_MASS, "mass");
  const double flat[9] = {1, 0, 0, 0, 1, 0, 0, 0, 0};
  CHECK_STATUS(rayc_contact_system_add_rigid(contacts, scene, 0, 1, flat, &fine), RAYC_STATUS_INVALID_INERTIA,
               "singular");
  const double slanted[3] = {0, 1, 1}, up[3] = {0, 0, 1};
  CHECK_STATUS(rayc_contact_system_add_half_space(contacts, slanted, 0, &fine), RAYC_STATUS_INVALID_DIRECTION,
               "normalise");
  CHECK_STATUS(rayc_contact_system_add_half_space(contacts, up, NAN, &fine), RAYC_STATUS_NOT_FINITE, "offset");

  CHECK_OK(ADD(NODES, nodes, weights));
  CHECK_STATUS(add(0, &fine), RAYC_STATUS_BODY_TWICE, "already");
  const rayc_motion still = {{0, 0, 0}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0}, {0}};
  CHECK_STATUS(rayc_contact_system_set_motion(contacts, 0, &still), RAYC_STATUS_UNKNOWN_BODY, "0");
  CHECK_OK(rayc_contact_system_add_moved(contacts, scene, 1, &fine));
  rayc_motion turned = still;
  turned.rotation[1][1] = -1;
  CHECK_STATUS(rayc_contact_system_set_motion(contacts, 1, &turned), RAYC_STATUS_INVALID_DIRECTION, "orthonormal");
  CHECK_OK(rayc_contact_system_set_motion(contacts, 1, &still));
  CHECK_STATUS(rayc_contact_system_set_added_inertia(contacts, 1, NULL), RAYC_STATUS_UNKNOWN_BODY, "1");
  CHECK_OK(rayc_contact_system_remove_body(contacts, 1));
  CHECK_STATUS(rayc_contact_system_remove_body(contacts, 1), RAYC_STATUS_UNKNOWN_BODY, "1");
  CHECK_OK(add(1, &fine));
  CHECK_STATUS(rayc_contact_system_set_pair_material(contacts, 0, 9, &fine), RAYC_STATUS_UNKNOWN_BODY, "9");
  CHECK_STATUS(rayc_contact_system_set_pair_material(contacts, 0, 1, &wrong), RAYC_STATUS_INVALID_MATERIAL, "friction");
  CHECK_OK(rayc_contact_system_set_pair_material(contacts, 0, 1, &fine));
  CHECK_OK(rayc_contact_system_set_pair_material(contacts, 0, 1, NULL));
  CHECK_STATUS(rayc_contact_system_set_half_space_material(contacts, 0, 0, &fine), RAYC_STATUS_WRONG_COUNT,
               "no half-space 0");
  double force[3] = {42, 42, 42};
  CHECK_STATUS(rayc_contact_system_pair_force(contacts, 9, 0, 0, force), RAYC_STATUS_UNKNOWN_BODY, "9");
  CHECK_STATUS(rayc_contact_system_pair_force(contacts, 0, 0, 1, force), RAYC_STATUS_WRONG_COUNT, "no half-space 0");
  CHECK_STATUS(rayc_contact_system_pair_force(contacts, 0, 1, 2, force), RAYC_STATUS_INVALID_OPTION, "is_half_space");
  CHECK(force[0] == 42);
  CHECK_OK(rayc_contact_system_pair_force(contacts, 0, 1, 0, force));
  CHECK(force[0] == 0 && force[1] == 0 && force[2] == 0);
}

static rayc_status begin(double dt, size_t count) {
  return rayc_contact_system_begin(contacts, scene, dt, count, x, v, v);
}

static void calls_out_of_order_are_refused(void) {
  double number = 42;
  size_t count = 42;
  uint32_t is_more = 42;
  const rayc_status none = RAYC_STATUS_OUT_OF_ORDER;
  CHECK_STATUS(rayc_contact_system_add_forces(contacts, UNKNOWNS, v, out), none, "begin");
  CHECK_STATUS(rayc_contact_system_misjudged(contacts, UNKNOWNS, v, &number), none, "begin");
  CHECK_STATUS(rayc_contact_system_add_product(contacts, 1, UNKNOWNS, v, out), none, "begin");
  CHECK_STATUS(rayc_contact_system_block_count(contacts, &count), none, "begin");
  CHECK_STATUS(rayc_contact_system_copy_blocks(contacts, 1, 0, NULL, NULL, NULL), none, "begin");
  rayc_csr matrix = {42, 42, NULL, NULL, NULL};
  CHECK_STATUS(rayc_contact_system_csr(contacts, 1, &matrix), none, "begin");
  CHECK(matrix.row_count == 42);
  CHECK_STATUS(rayc_contact_system_energy(contacts, UNKNOWNS, v, &number), none, "begin");
  CHECK_STATUS(rayc_contact_system_linearise(contacts, UNKNOWNS, v, &number), none, "begin");
  CHECK_STATUS(rayc_contact_system_detect_again(contacts, scene, UNKNOWNS, v, &is_more), none, "begin");
  CHECK_STATUS(rayc_contact_system_finish(contacts, UNKNOWNS, v), none, "begin");
  CHECK(number == 42 && count == 42 && is_more == 42);
  CHECK_OK(rayc_contact_system_cancel(contacts));

  CHECK_STATUS(begin(0, UNKNOWNS), RAYC_STATUS_INVALID_STEP, "0 seconds");
  CHECK_STATUS(begin(-1, UNKNOWNS), RAYC_STATUS_INVALID_STEP, "-1 seconds");
  CHECK_STATUS(begin(NAN, UNKNOWNS), RAYC_STATUS_INVALID_STEP, "NaN seconds");
  CHECK_STATUS(begin(0.01, UNKNOWNS - 1), RAYC_STATUS_WRONG_COUNT, "positions");
  x[4] = INFINITY;
  CHECK_STATUS(begin(0.01, UNKNOWNS), RAYC_STATUS_NOT_FINITE, "positions[4]");
  x[4] = octahedron_positions[4];
  CHECK_OK(begin(0.01, UNKNOWNS));
  CHECK_STATUS(begin(0.01, UNKNOWNS), none, "finish");
  CHECK_STATUS(rayc_contact_system_remove_body(contacts, 0), none, "finish");
}

static void a_step_keeps_momentum(void) {
  CHECK_STATUS(rayc_contact_system_add_forces(contacts, UNKNOWNS, v, v), RAYC_STATUS_INVALID_OPTION, "overlaps");
  CHECK_STATUS(rayc_contact_system_add_forces(contacts, UNKNOWNS - 3, v, out), RAYC_STATUS_WRONG_COUNT, "velocities");
  CHECK_OK(rayc_contact_system_add_forces(contacts, UNKNOWNS, v, out));
  double sum = 0, size = 0, joules = 0;
  for (int k = 0; k < UNKNOWNS; ++k) size += fabs(out[k]);
  for (int k = 0; k < UNKNOWNS; k += 3) sum += out[k];
  CHECK(size > 1);
  CHECK_NEAR(sum, 0, 1e-12 * size);
  CHECK_OK(rayc_contact_system_energy(contacts, UNKNOWNS, v, &joules));
  CHECK(joules > 0);

  /* The blocks' product with the velocities is the product. */
  size_t count = 0;
  CHECK_OK(rayc_contact_system_block_count(contacts, &count));
  printf("%g blocks\n", (double)count);
  CHECK(count > 0);
  uint32_t *rows = malloc(count * sizeof *rows), *columns = malloc(count * sizeof *columns);
  double* blocks = malloc(9 * count * sizeof *blocks);
  CHECK(rows != NULL && columns != NULL && blocks != NULL);
  CHECK_STATUS(rayc_contact_system_copy_blocks(contacts, 1, count - 1, rows, columns, blocks), RAYC_STATUS_WRONG_COUNT,
               "room for");
  CHECK_OK(rayc_contact_system_copy_blocks(contacts, 1, count, rows, columns, blocks));
  double change[UNKNOWNS], product[UNKNOWNS] = {0};
  for (int k = 0; k < UNKNOWNS; ++k) change[k] = sin(k + 1.0);
  CHECK_OK(rayc_contact_system_add_product(contacts, 1, UNKNOWNS, change, product));
  for (size_t b = 0; b < count; ++b)
    for (size_t k = 0; k < 9; ++k) product[3 * rows[b] + k / 3] -= blocks[9 * b + k] * change[3 * columns[b] + k % 3];
  for (int k = 0; k < UNKNOWNS; ++k) CHECK_NEAR(product[k], 0, 1e-9 * size);
  free(rows);
  free(columns);
  free(blocks);

  rayc_csr matrix = {42, 42, NULL, NULL, NULL};
  CHECK_STATUS(rayc_contact_system_csr(contacts, NAN, &matrix), RAYC_STATUS_NOT_FINITE, "factor");
  CHECK_STATUS(rayc_contact_system_csr(contacts, 1, NULL), RAYC_STATUS_NULL_POINTER, "matrix");
  CHECK(matrix.row_count == 42 && matrix.values == NULL);

  double wrong = 42;
  uint32_t is_more = 42;
  CHECK_OK(rayc_contact_system_linearise(contacts, UNKNOWNS, v, &wrong));
  CHECK(wrong >= 0 && wrong <= 1);
  CHECK_OK(rayc_contact_system_detect_again(contacts, scene, UNKNOWNS, v, &is_more));
  CHECK(is_more == 0);
  CHECK_OK(rayc_contact_system_finish(contacts, UNKNOWNS, v));
  double twist[6];
  CHECK_STATUS(rayc_contact_system_rigid_velocity(contacts, 0, twist), RAYC_STATUS_UNKNOWN_BODY, "0");

  double longest = 0, forces[UNKNOWNS] = {0};
  CHECK_OK(rayc_contact_system_explicit_step(contacts, scene, 0.01, UNKNOWNS, x, v, UNKNOWNS, forces, &longest));
  CHECK(longest > 0 && longest < 1);
  for (int k = 0; k < UNKNOWNS; ++k) CHECK_NEAR(forces[k], out[k], 1e-9 * size);
}

/* Forces part by part, and what pairs remember, between processes that share bodies. */
static void parts_and_memories(void) {
  size_t part_count = 42, block_count = 42, count = 42;
  CHECK_STATUS(rayc_contact_system_part_count(contacts, &part_count, &block_count), RAYC_STATUS_OUT_OF_ORDER, "begin");
  CHECK_STATUS(rayc_contact_system_part_forces(contacts, UNKNOWNS, v, 0, NULL), RAYC_STATUS_OUT_OF_ORDER, "begin");
  CHECK_STATUS(rayc_contact_system_look_ahead(contacts, scene, 0, UNKNOWNS, x, v, v), RAYC_STATUS_INVALID_STEP,
               "seconds");
  CHECK_STATUS(rayc_contact_system_look_ahead(contacts, scene, 0.01, 3, x, v, v), RAYC_STATUS_WRONG_COUNT, "positions");
  CHECK_OK(rayc_contact_system_look_ahead(contacts, scene, 0.01, UNKNOWNS, x, v, v));
  CHECK_OK(rayc_contact_system_begin(contacts, scene, 0.01, UNKNOWNS, x, v, v));
  CHECK_OK(rayc_contact_system_part_count(contacts, &part_count, &block_count));
  CHECK(part_count == 2 && block_count > 2 && block_count <= 2 * NODES);

  rayc_contact_part parts[2];
  uint32_t blocks[2 * NODES];
  double forces[UNKNOWNS] = {0}, of_parts[UNKNOWNS];
  CHECK_STATUS(rayc_contact_system_copy_parts(contacts, 1, parts, block_count, blocks), RAYC_STATUS_WRONG_COUNT,
               "room for 1, but takes 2");
  CHECK_OK(rayc_contact_system_copy_parts(contacts, 2, parts, block_count, blocks));
  CHECK(parts[0].body != parts[1].body && parts[0].other == parts[1].body && parts[0].is_half_space == 0);
  CHECK_STATUS(rayc_contact_system_part_forces(contacts, UNKNOWNS, v, 1, of_parts), RAYC_STATUS_WRONG_COUNT, "forces");
  CHECK_STATUS(rayc_contact_system_part_products(contacts, 1, UNKNOWNS, v, 1, of_parts), RAYC_STATUS_WRONG_COUNT,
               "result");
  CHECK_STATUS(rayc_contact_system_part_forces(contacts, UNKNOWNS, v, block_count, v), RAYC_STATUS_INVALID_OPTION,
               "overlaps");
  CHECK_OK(rayc_contact_system_add_forces(contacts, UNKNOWNS, v, forces));
  CHECK_OK(rayc_contact_system_part_forces(contacts, UNKNOWNS, v, block_count, of_parts));
  for (size_t i = 0; i < block_count; ++i)
    for (size_t axis = 0; axis < 3; ++axis) forces[3 * blocks[i] + axis] -= of_parts[3 * i + axis];
  for (int k = 0; k < UNKNOWNS; ++k) CHECK_NEAR(forces[k], 0, 1e-9 * (1 + fabs(out[k])));
  CHECK_OK(rayc_contact_system_finish(contacts, UNKNOWNS, v));

  CHECK_OK(rayc_contact_system_memory_count(contacts, &count));
  CHECK(count == 1);
  rayc_contact_memory memory;
  CHECK_STATUS(rayc_contact_system_copy_memories(contacts, 2, &memory), RAYC_STATUS_WRONG_COUNT,
               "room for 2, but takes 1");
  CHECK_OK(rayc_contact_system_copy_memories(contacts, 1, &memory));
  CHECK(memory.first == 0 && memory.second == 1 && memory.length > 0);
  unsigned char* bytes = malloc(memory.length);
  CHECK(bytes != NULL);
  if (bytes == NULL) return;
  CHECK_OK(rayc_contact_system_pack_memory(contacts, &memory, bytes));
  CHECK_OK(rayc_contact_system_put_memory(contacts, &memory, bytes));
  bytes[memory.length / 2] ^= 1;
  CHECK_STATUS(rayc_contact_system_put_memory(contacts, &memory, bytes), RAYC_STATUS_SAVED_STATE_BROKEN, "bytes");
  memory.length -= 1;
  CHECK_STATUS(rayc_contact_system_pack_memory(contacts, &memory, bytes), RAYC_STATUS_WRONG_COUNT, "bytes");
  memory.second = 7;
  CHECK_STATUS(rayc_contact_system_put_memory(contacts, &memory, bytes), RAYC_STATUS_UNKNOWN_BODY, "7");
  memory.is_half_space = 2;
  CHECK_STATUS(rayc_contact_system_put_memory(contacts, &memory, bytes), RAYC_STATUS_INVALID_OPTION, "is_half_space");
  free(bytes);
}

/* Two octahedra of 1 kg: a stiffness that their masses are lost beside is refused, and the host goes on with a softer one. */
static void lost_masses_are_refused(void) {
  rayc_contact_system* rigid = NULL;
  CHECK_OK(rayc_contact_system_create(NULL, &rigid));
  rayc_scene* apart = NULL;
  CHECK_OK(rayc_scene_create(NULL, &apart));
  rayc_material hard = fine;
  hard.stiffness = 1e20;
  for (uint32_t k = 0; k < 2; ++k) {
    uint32_t body = 42;
    rayc_mesh* mesh = octahedron_mesh(no_shift);
    CHECK_OK(rayc_scene_add_mesh(apart, mesh, &body));
    CHECK_OK(rayc_mesh_destroy(mesh));
    CHECK_OK(rayc_contact_system_add_rigid(rigid, apart, k, 1, inertia, &hard));
  }
  rayc_motion motion = {{0, 0, 0}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0}, {0}};
  memcpy(motion.position, octahedron_shift, sizeof motion.position);
  CHECK_OK(rayc_contact_system_set_motion(rigid, 1, &motion));
  CHECK_STATUS(rayc_contact_system_begin(rigid, apart, 0.01, 0, NULL, NULL, NULL), RAYC_STATUS_TOO_STIFF,
               "take a softer material");
  CHECK_STATUS(rayc_contact_system_finish(rigid, 0, NULL), RAYC_STATUS_OUT_OF_ORDER, "begin");
  CHECK_OK(rayc_contact_system_set_pair_material(rigid, 0, 1, &fine));
  CHECK_OK(rayc_contact_system_begin(rigid, apart, 0.01, 0, NULL, NULL, NULL));
  rayc_csr matrix;
  CHECK_STATUS(rayc_contact_system_csr(rigid, 1, &matrix), RAYC_STATUS_RIGID_ELIMINATED, "unknowns kept");
  CHECK_OK(rayc_contact_system_finish(rigid, 0, NULL));
  double velocities[2][6];
  for (uint32_t k = 0; k < 2; ++k) CHECK_OK(rayc_contact_system_rigid_velocity(rigid, k, velocities[k]));
  CHECK(velocities[0][0] < 0);
  CHECK_NEAR(velocities[0][0] + velocities[1][0], 0, 1e-14);

  hard.stiffness = 1e30;
  CHECK_STATUS(rayc_contact_system_set_pair_material(rigid, 0, 1, &hard), RAYC_STATUS_INVALID_MATERIAL,
               "stiffness is 1000000000000000000000000000000");
  hard = fine;
  hard.friction = 1e100;
  CHECK_STATUS(rayc_contact_system_set_pair_material(rigid, 0, 1, &hard), RAYC_STATUS_INVALID_MATERIAL, "friction");
  motion.velocity[4] = 1e100;
  CHECK_STATUS(rayc_contact_system_set_motion(rigid, 1, &motion), RAYC_STATUS_INVALID_OPTION, "velocity[4] is 1e100");
  CHECK_STATUS(rayc_contact_system_begin(rigid, apart, 1e-300, 0, NULL, NULL, NULL), RAYC_STATUS_INVALID_STEP,
               "from 8.27e-25");
  const double light = 1e-300;
  CHECK_STATUS(rayc_contact_system_set_node_masses(rigid, 1, &light), RAYC_STATUS_INVALID_MASS, "node 0");
  CHECK_OK(rayc_contact_system_destroy(rigid));
  CHECK_OK(rayc_scene_destroy(apart));
}

static void precisions_do_not_mix(void) {
  rayc_contact_system_options options;
  CHECK_OK(rayc_default_contact_system_options(sizeof options, &options));
  options.precision = RAYC_SCALAR_F32;
  rayc_contact_system* single = NULL;
  CHECK_OK(rayc_contact_system_create(&options, &single));
  CHECK_STATUS(rayc_contact_system_add_moved(single, scene, 0, &fine), RAYC_STATUS_PRECISION_MISMATCH, "precision");
  CHECK_STATUS(rayc_contact_system_begin(single, scene, 0.01, 0, NULL, NULL, NULL), RAYC_STATUS_PRECISION_MISMATCH,
               "precision");
  CHECK_OK(rayc_contact_system_destroy(single));
}

int main(void) {
  options_are_refused();
  make_scene();
  CHECK_OK(rayc_contact_system_create(NULL, &contacts));
  size_t count = 42;
  CHECK_OK(rayc_contact_system_unknown_count(contacts, &count));
  CHECK(count == 0);
  bodies_are_refused();
  CHECK_OK(rayc_contact_system_unknown_count(contacts, &count));
  CHECK(count == UNKNOWNS);
  calls_out_of_order_are_refused();
  a_step_keeps_momentum();
  parts_and_memories();
  lost_masses_are_refused();
  precisions_do_not_mix();
  CHECK_OK(rayc_contact_system_destroy(contacts));
  CHECK_OK(rayc_scene_destroy(scene));
  return check_result();
}
