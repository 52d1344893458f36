/* A missing or broken .obj file is refused with its own status; the message names the file and the line.
   The first argument is a folder for the files. */
#include "check.h"

static const char* folder;

static const char* path_of(const char* name) {
  static char path[1024];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  return path;
}

static const char* write_file(const char* name, const char* text) {
  const char* path = path_of(name);
  FILE* file = fopen(path, "wb");
  CHECK(file != NULL);
  if (file != NULL) {
    CHECK(fputs(text, file) >= 0);
    CHECK(fclose(file) == 0);
  }
  return path;
}

static void check_refused(const char* path, const char* name, rayc_status status, const char* part) {
  static int sentinel;
  rayc_mesh* const untouched = (rayc_mesh*)(void*)&sentinel;
  rayc_mesh* mesh = untouched;
  const int failures_before = check_failures;
  const rayc_status actual = rayc_mesh_create_from_obj(NULL, path, &mesh);
  CHECK_STATUS(actual, status, name);
  CHECK_STATUS(actual, status, part);
  CHECK(mesh == untouched);
  if (check_failures != failures_before) {
    fprintf(stderr, "  in case: %s\n", name);
  }
}

static void check_broken(const char* name, const char* text, const char* part) {
  check_refused(write_file(name, text), name, RAYC_STATUS_FILE_BROKEN, part);
}

#define TETRAHEDRON_VERTICES "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
#define TETRAHEDRON_FACES "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"

int main(int argc, char** argv) {
  if (argc != 2) {
    fprintf(stderr, "usage: %s <folder for the files>\n", argv[0]);
    return 2;
  }
  folder = argv[1];

  check_refused(path_of("missing.obj"), "missing.obj", RAYC_STATUS_FILE_NOT_READABLE, "No such file");
  check_refused(folder, folder, RAYC_STATUS_FILE_NOT_READABLE, NULL);
  check_refused(NULL, "path", RAYC_STATUS_NULL_POINTER, "path");

  check_broken("number.obj", "v 0 0 0\nv 1 zero 0\n" TETRAHEDRON_FACES, "line 2");
  check_broken("coordinates.obj", "v 0 0 0\nv 1 0 0\nv 0 1\n" TETRAHEDRON_FACES, "line 3");
  check_broken("index.obj", TETRAHEDRON_VERTICES "f 1 3 2\nf 1 2 9\n", "vertex 9");
  check_broken("zero.obj", TETRAHEDRON_VERTICES "f 0 3 2\n", "line 5");
  check_broken("face.obj", TETRAHEDRON_VERTICES "f 1 3\n", "fewer than three");
  check_broken("huge.obj", TETRAHEDRON_VERTICES "f 4294967297 3 2\n", "4294967297");
  check_broken("no_faces.obj", TETRAHEDRON_VERTICES, "no line of a face");
  check_broken("empty.obj", "", "no line of a face");
  check_broken("binary.obj", "\x01\x02\xff\xfe\x80", NULL);

  /* In text and, with bytes that look like a line of a vertex, in binary. */
  const char* others = "only .obj files are read: convert other formats";
  check_broken("text.stl", "solid one\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n", others);
  check_broken("binary.stl", "\x01\x01\nv \x02\n\x03", others);
  check_broken("text.ply", "ply\nformat ascii 1.0\nelement vertex 3\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", others);

  check_broken("continued.obj", "v 0 0 \\\n0\nv 1 0 \\\n zero\n" TETRAHEDRON_FACES, "line 3: 'zero'");

  /* Readable, but not a closed surface: the mesh's own statuses. */
  check_refused(write_file("open.obj", TETRAHEDRON_VERTICES "f 1 3 2\nf 1 2 4\nf 1 4 3\n"), "open.obj",
                RAYC_STATUS_MESH_OPEN, "edge (2, 3) belongs to the face in line 5");
  check_refused(write_file("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nv 0 0 1\n" TETRAHEDRON_FACES), "nan.obj",
                RAYC_STATUS_NOT_FINITE, "vertex 1 has a coordinate that is NaN or infinite; check the input");

  rayc_mesh* mesh = NULL;
  size_t count = 0;
  /* With a byte-order mark, a comment in Latin-1, points, and a line that goes on. */
  const char* good = write_file("good.obj", "\xef\xbb\xbf# Kr\xf6te\nvp 0.5\n" TETRAHEDRON_VERTICES
                                            "p 1 2\nf 1 3 \\\n2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  CHECK_OK(rayc_mesh_create_from_obj(NULL, good, &mesh));
  CHECK_OK(rayc_mesh_triangle_count(mesh, &count));
  CHECK(count == 4);
  CHECK_OK(rayc_mesh_destroy(mesh));
  return check_result();
}
