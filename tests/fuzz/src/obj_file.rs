//! An `.obj` file from bytes: any bytes, and words of the format in any order.

use crate::Bytes;
use raycontact::mesh::{Mesh, read_obj_file};

const WORDS: [&str; 24] = [
    "v ", "f ", "vn ", "vt ", "o ", "g ", "s ", "l ", "p ", "usemtl ", "mtllib ", "#", "\n", "\n", " ", "1", "2", "3",
    "-1", "/", "//", "0.5 ", "1e39 ", "nan ",
];

fn text(bytes: &mut Bytes) -> Vec<u8> {
    if bytes.below(4) == 0 {
        return bytes.rest().to_vec();
    }
    let mut text = String::new();
    while bytes.are_left() {
        match bytes.below(WORDS.len() + 4) {
            word if word < WORDS.len() => text += WORDS[word],
            24 => text += "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n",
            25 => text += "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n",
            26 => text += "f -4 -3 -1\n",
            _ => text += &format!("{} ", bytes.number()),
        }
    }
    text.into_bytes()
}

pub fn run(bytes: &mut Bytes) {
    let path = std::env::temp_dir().join(format!("raycontact-fuzz-{}.obj", std::process::id()));
    std::fs::write(&path, text(bytes)).expect("the temporary folder can be written");
    let read = read_obj_file(&path);
    std::fs::remove_file(&path).expect("it was written");
    let (positions, triangles) = match read {
        Ok(surface) => surface,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    assert!(triangles.as_flattened().iter().all(|&vertex| (vertex as usize) < positions.len()));
    if let Err(error) = Mesh::open(&positions, &triangles) {
        assert!(!error.to_string().is_empty());
    }
}
