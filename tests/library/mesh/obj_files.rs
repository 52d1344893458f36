//! `.obj` files as programs write them, and what is said of those that cannot be read.

use crate::common::c::{
    self, RAYC_STATUS_FILE_BROKEN, RAYC_STATUS_MESH_BEYOND_RANGE, RAYC_STATUS_MESH_DEGENERATE_TRIANGLE,
};
use crate::common::c::{RAYC_STATUS_MESH_INWARD, RAYC_STATUS_MESH_OPEN, RAYC_STATUS_NOT_FINITE};
use raycontact::capi::rayc_status;
use raycontact::mesh::{Mesh, read_obj_file};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};

const VERTICES: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
const FACES: &str = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const POSITIONS: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const TRIANGLES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

/// A file that ends with the test.
struct TemporaryFile(PathBuf);

impl TemporaryFile {
    fn new(content: &[u8]) -> Self {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("raycontact-test-{}-{number}.obj", std::process::id()));
        std::fs::write(&path, content).expect("the temporary folder can be written");
        Self(path)
    }
}

impl Drop for TemporaryFile {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

fn check_is_the_tetrahedron(what: &str, content: &[u8]) {
    let file = TemporaryFile::new(content);
    let surface = read_obj_file(&file.0).unwrap_or_else(|error| panic!("{what}: {error}"));
    assert_eq!(surface, (POSITIONS.to_vec(), TRIANGLES.to_vec()), "{what}");
}

#[test]
fn files_of_every_habit_are_read() {
    let all = format!("{VERTICES}{FACES}");
    let check = |what: &str, text: String| check_is_the_tetrahedron(what, text.as_bytes());
    check("plain", all.clone());
    check("byte-order mark", format!("\u{feff}{all}"));
    check("byte-order mark before a comment", format!("\u{feff}# made by hand\n{all}"));
    check("lines of Windows", all.replace('\n', "\r\n"));
    check("lines of an old Macintosh", all.replace('\n', "\r"));
    check("no end of the last line", all.trim_end().to_owned());
    check("tabs and spaces", all.replace(' ', " \t "));
    check("points and lines", format!("{VERTICES}p 1\np 1 2 3 4\nl 1 2\nl 1/1 2/2\n{FACES}"));
    check("curves", format!("vp 0.1 0.2\ncstype bezier\ndeg 3\ncurv 0 1 1 2\nparm u 0 1\nend\n{all}"));
    check("parameter space", format!("vp 0.1\n{all}vp 0.1 0.2 0.3\n"));
    check("what nobody knows", format!("{all}xyzzy 1 2 3\nusemtl # \\\nmtllib a b.mtl\ns off\ns 1\n"));
    check(
        "a line that goes on",
        format!("v 0 \\\n0 0\nv 1 0 0\nv 0\\\n 1\\\n 0\nv 0 0 1\nf 1 3 2 \\\n\n{}", &FACES[8..]),
    );
    check("a backslash in a comment", format!("# C:\\models\\\n{all}"));
    check("comments behind", all.replace('\n', " # a comment\n"));
    check(
        "colours and weights",
        all.replacen("v 1 0 0", "v 1 0 0 0.5 0.25 1", 1).replacen("v 0 1 0", "v 0 1 0 1.0", 1),
    );
    check(
        "texture and normal",
        format!("{VERTICES}vt 0 0\nvn 0 0 1\nf 1/1/1 3/1/1 2/1/1\nf 1//1 2//1 4//1\n{}", &FACES[16..]),
    );
    check("from the end", format!("{VERTICES}f -4 -2 -3\nf -4 -3 -1\n{}", &FACES[16..]));
    check("faces first", format!("{FACES}{VERTICES}"));
    check("objects and groups", format!("o one\n{VERTICES}g a b\nf 1 3 2\nf 1 2 4\ng\no two\n{}", &FACES[16..]));
    let latin = [b"# Kr\xf6te, \xa9 1999\ng Kr\xf6te\nusemtl gr\xfcn\n", all.as_bytes()].concat();
    check_is_the_tetrahedron("Latin-1", &latin);
}

/// They went through float.
#[test]
fn numbers_are_read_as_double() {
    let text = format!("{VERTICES}{FACES}").replacen("v 1 0 0", "v 0.1 -1.7976931348623157e308 4.9e-324", 1);
    let (positions, _) = read_obj_file(&TemporaryFile::new(text.as_bytes()).0).expect("finite");
    assert_eq!(positions[1], [0.1, -f64::MAX, f64::from_bits(1)]);
}

#[test]
fn polygons_become_fans() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0.5 0\nf 1 2 3 4 5\n";
    let (_, triangles) = read_obj_file(&TemporaryFile::new(text.as_bytes()).0).expect("one face");
    assert_eq!(triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
}

/// What is said of a file, and that no Rust shows through.
fn refusal(precision: u32, text: &[u8]) -> (rayc_status, String) {
    let file = TemporaryFile::new(text);
    let path = file.0.to_str().expect("UTF-8");
    let Err(refused) = c::Mesh::from_obj(precision, path) else { panic!("{} was accepted", text.escape_ascii()) };
    let message = c::last_error();
    assert!(message.contains(path), "{message}");
    for debug in ["Some(", "None", "Ok(", "Err(", "\\\"", "position:"] {
        assert!(!message.contains(debug), "{message}");
    }
    (refused, message.replace(path, "FILE"))
}

#[track_caller]
fn check_refused(text: &[u8], status: rayc_status, parts: &[&str]) {
    let (refused, message) = refusal(64, text);
    assert_eq!(refused, status, "{message}");
    for part in parts {
        assert!(message.contains(part), "'{message}' does not say '{part}'");
    }
}

#[test]
fn broken_lines_are_named_from_1() {
    let check = |text: &str, parts: &[&str]| check_refused(text.as_bytes(), RAYC_STATUS_FILE_BROKEN, parts);
    check("v 0 0 0\nv 1 zero 0\n", &["line 2", "'zero' is not a number"]);
    check("v 0 0 0\r\nv 1 zero 0\r\n", &["line 2"]);
    check("v 0 0 0\n\n# comment\nv 1 0 \\\n zero\n", &["line 4"]);
    check("v 0 0\n", &["line 1", "2 coordinates"]);
    check(&format!("{VERTICES}f 1 2 nine\n"), &["line 5", "'nine'"]);
    check(&format!("{VERTICES}f 1 2 9\n"), &["line 5", "vertex 9", "4 vertices"]);
    check(&format!("{VERTICES}f 1 2 -9\n"), &["line 5", "vertex -9", "4 vertices"]);
    check(&format!("{VERTICES}f 1 2 0\n"), &["line 5", "vertex 0"]);
    check(&format!("{VERTICES}f 1 2 4294967297\n"), &["line 5", "4294967297"]);
    check(&format!("{VERTICES}f 1 2 99999999999999999999\n"), &["line 5", "99999999999999999999"]);
    check(&format!("{VERTICES}f 1 2 -9223372036854775808\n"), &["line 5", "-9223372036854775808"]);
    check(&format!("{VERTICES}f 1 2\n"), &["line 5", "fewer than three"]);
    check("v 1e400 0 0\n", &["line 1", "1e400", "largest double"]);
    check(VERTICES, &["no line of a face", "only .obj files are read: convert other formats"]);
    check_refused(b"v 0 0 0\nv \xff\xfe 0 0\n", RAYC_STATUS_FILE_BROKEN, &["line 2", "not a number"]);
    check_refused(b"\xff\xfev\0 \x000\0", RAYC_STATUS_FILE_BROKEN, &["no line of a face"]);
    let long = [b"v ", "9x".repeat(5000).as_bytes(), b" 0 0\n"].concat();
    assert!(refusal(64, &long).1.len() < 300);
}

#[test]
fn faults_of_the_surface_are_told_in_the_numbers_of_the_file() {
    let check = |text: String, status, parts: &[&str]| check_refused(text.as_bytes(), status, parts);
    let count = "count from 1";
    check(format!("{VERTICES}f 1 3 2\nf 1 2 4\nf 1 4 3\n"), RAYC_STATUS_MESH_OPEN, &["edge (2, 3)", "line 5", count]);
    check(format!("{VERTICES}f 1 3 3\n"), RAYC_STATUS_MESH_DEGENERATE_TRIANGLE, &["line 5", "(1, 3, 3)", count]);
    let turned = "\n\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";
    check(format!("{VERTICES}{turned}"), RAYC_STATUS_MESH_INWARD, &["line 7", "inside out", count]);
    let not_a_number = VERTICES.replacen("v 0 1 0", "v 0 nan 0", 1) + FACES;
    check(not_a_number.clone(), RAYC_STATUS_NOT_FINITE, &["vertex 3", "NaN or infinite", "check the input", count]);
    assert!(!refusal(64, not_a_number.as_bytes()).1.contains("last step"));
    let wide = VERTICES.replacen("v 0 1 0", "v 0 1e39 0", 1) + FACES;
    let (status, message) = refusal(32, wide.as_bytes());
    assert_eq!(status, RAYC_STATUS_MESH_BEYOND_RANGE, "{message}");
    for part in ["vertex 3", "1e39", "3.4028234663852886e38", "double precision", count] {
        assert!(message.contains(part), "{message}");
    }
}

/// Arrays count from 0, and the message says so.
#[test]
fn faults_of_arrays_are_told_in_the_numbers_of_arrays() {
    let error = Mesh::<f64>::new(&POSITIONS, &TRIANGLES[..3]).expect_err("open").to_string();
    assert!(error.contains("edge (1, 2)") && error.contains("triangle 0") && error.contains("count from 0"), "{error}");
    let error = Mesh::<f64>::new(&POSITIONS, &[[0, 1, 9]]).expect_err("no such vertex").to_string();
    assert!(error.contains("vertex 9") && error.contains("count from 0"), "{error}");
}
