//! What a mesh and its octree cost when they are made: time and memory for each triangle.
//!
//! A program of its own: what counts memory here would slow down every allocation of the others.

mod support;

use allocation_counter::measure;
use raycontact::distributed::{pack_mesh, unpack_mesh};
use raycontact::math::Scalar;
use raycontact::mesh::{Mesh, read_obj_file};
use raycontact::query::Octree;
use std::hint::black_box;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;
use support::arguments::Arguments;
use support::shapes;

const HELP: &str = "\
usage: cargo run --release --example creation -- [options]

Times how a mesh and its octree are made, in single and in double precision: from arrays; for a clone, whose clusters of
triangles are known; and from packed bytes.

  --sizes LIST      tori: comma-separated numbers of quads around the ring, half as many across (default 24,80,320)
  --file PATH       a Wavefront .obj file instead, of a closed surface
  --rounds N        how often each is made, in turns (default 25)
  --help            this text

Prints a line for each surface and precision. Times are medians, in microseconds a triangle; bytes a triangle are those that
stay allocated. The first octree also finds the mesh's clusters, which stay with the mesh and are counted there.
Exit status: 0; 1 where the file is not a closed surface; 2 for a wrong command line.";

fn main() -> ExitCode {
    let mut arguments = Arguments::new("creation", HELP, std::env::args().skip(1));
    let sizes = arguments.list("--sizes", &[24, 80, 320]);
    let path: String = arguments.value("--file", String::new());
    let rounds: usize = arguments.value("--rounds", 25);
    if sizes.iter().any(|&size| size < 6) || rounds == 0 {
        arguments.fail("at least 6 quads around, and 1 round");
    }
    arguments.finish();
    let surfaces: Vec<Surface> = if path.is_empty() {
        sizes.iter().map(|&size| torus(size)).collect()
    } else {
        match read_obj_file(Path::new(&path)) {
            Ok((points, triangles)) => vec![(points, triangles)],
            Err(error) => {
                eprintln!("error: {error}");
                return ExitCode::FAILURE;
            }
        }
    };
    println!("                        us a triangle                                    bytes a triangle");
    println!("triangles  precision    mesh  octree  clone, octree  unpacked, octree    mesh  octree");
    for surface in &surfaces {
        if let Err(error) = Mesh::<f64>::new(&surface.0, &surface.1) {
            eprintln!("error: {error}");
            return ExitCode::FAILURE;
        }
        print_line::<f32>("single", surface, rounds);
        print_line::<f64>("double", surface, rounds);
    }
    ExitCode::SUCCESS
}

type Surface = (Vec<[f64; 3]>, Vec<[u32; 3]>);

fn torus(size: usize) -> Surface {
    let shape = shapes::torus(size, size / 2, 0.4, false);
    (shape.points.iter().map(|point| (*point).into()).collect(), shape.triangles)
}

fn print_line<T: Scalar>(precision: &str, (points, triangles): &Surface, rounds: usize) {
    let points: Vec<[T; 3]> = points.iter().map(|point| point.map(T::of)).collect();
    let mut times = [const { Vec::new() }; 4];
    for _ in 0..rounds {
        let start = Instant::now();
        let mesh = Mesh::new(&points, triangles).expect("closed, as double precision said");
        let made = Instant::now();
        let octree = Octree::new(&mesh);
        let searchable = Instant::now();
        let clone = mesh.clone();
        let of_clone = Octree::new(&clone);
        let cloned = Instant::now();
        let mut bytes = Vec::new();
        pack_mesh(&mesh, &mut bytes);
        let packed = Instant::now();
        let unpacked = unpack_mesh::<T>(&bytes).expect("just packed");
        let of_unpacked = Octree::new(&unpacked);
        let end = Instant::now();
        black_box((octree, of_clone, of_unpacked));
        let parts = [made - start, searchable - made, cloned - searchable, end - packed];
        times.iter_mut().zip(parts).for_each(|(list, part)| list.push(part.as_secs_f64() * 1e6));
    }
    let count = triangles.len() as f64;
    let [mesh, octree, clone, unpacked] = [0, 1, 2, 3].map(|part: usize| {
        times[part].sort_by(f64::total_cmp);
        times[part][rounds / 2] / count
    });
    let (kept, of_mesh) = kept_by(|| Mesh::new(&points, triangles).expect("closed, as before"));
    let (dropped, of_both) = kept_by(|| Octree::new(&kept));
    // What an octree leaves with its mesh is the mesh's.
    let of_octree = -measure(|| drop(dropped)).bytes_current as f64 / count;
    let of_mesh = (of_mesh + of_both) as f64 / count - of_octree;
    print!("{count:9}  {precision:9} {mesh:7.3} {octree:7.3} {clone:14.3} {unpacked:17.3} ");
    println!("{of_mesh:7.1} {of_octree:7.1}");
}

/// A value, and how many bytes stay allocated for it.
fn kept_by<V>(make: impl FnOnce() -> V) -> (V, i64) {
    let mut made = None;
    let bytes = measure(|| made = Some(make())).bytes_current;
    (made.expect("it has been made"), bytes)
}
