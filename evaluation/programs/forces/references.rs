//! Against evaluation/references/: hydroelastic contact as Drake computes it, and the exact gradient of the overlap volume.

use super::Row;
use crate::support::{Mode, Vector, net_force};
use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion};
use raycontact::mesh::{Mesh, read_obj_file};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A pose, and what the other programs say of it.
struct Reference {
    pair: String,
    is_pressed: bool,
    pose: Isometry3<f64>,
    hydroelastic: Vector,
    even_pressure: Vector,
}

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("evaluation/references")
}

/// The rows of a file, without their heading, as words.
fn rows(name: &str) -> Vec<Vec<String>> {
    let path = folder().join(name);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

fn references() -> Vec<Reference> {
    let number = |word: &String| word.parse::<f64>().expect("a number");
    let vector = |words: &[String]| Vector::new(number(&words[0]), number(&words[1]), number(&words[2]));
    let (hydroelastic, even_pressure) = (rows("hydroelastic.csv"), rows("overlap_volume.csv"));
    rows("poses.csv")
        .iter()
        .zip(hydroelastic.iter().zip(&even_pressure))
        .map(|(pose, (hydroelastic, even_pressure))| {
            assert!(pose[0] == hydroelastic[0] && pose[0] == even_pressure[0], "the rows name the same pose");
            let [w, x, y, z] = [3, 4, 5, 6].map(|column| number(&pose[column]));
            Reference {
                pair: pose[1].clone(),
                is_pressed: pose[2] == "pressed",
                pose: Isometry3::from_parts(
                    Translation3::from(vector(&pose[7..10])),
                    UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)),
                ),
                hydroelastic: vector(&hydroelastic[1..4]),
                even_pressure: vector(&even_pressure[2..5]),
            }
        })
        .collect()
}

fn shape(name: &str) -> Mesh<f64> {
    let path = folder().join("shapes").join(format!("{name}.obj"));
    let (positions, triangles) = read_obj_file(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    Mesh::new(&positions, &triangles).expect("a closed shape")
}

/// Angles to both in degrees; for bodies pressed between walls, where forces nearly cancel, the error of the force instead.
pub fn measure(_poses: usize, _seed: u64) -> Vec<Row> {
    let mut pairs: BTreeMap<String, Vec<Reference>> = BTreeMap::new();
    references().into_iter().for_each(|reference| pairs.entry(reference.pair.clone()).or_default().push(reference));
    let mut rows = Vec::new();
    for (pair, references) in pairs {
        let (first, second) = pair.split_once('-').expect("two shapes");
        let (first, resting) = (shape(first), shape(second));
        for mode in [Mode::RayLength, Mode::Default, Mode::Accurate] {
            let forces: Vec<Vector> = references
                .iter()
                .map(|reference| {
                    let moved = |point: &Vector| reference.pose.transform_point(&Point3::from(*point)).coords.into();
                    let positions: Vec<[f64; 3]> = resting.positions().iter().map(moved).collect();
                    let mut second = resting.clone();
                    second.set_positions(&positions).expect("finite");
                    net_force(mode, &first, &second, &Vector::zeros()).force
                })
                .collect();
            let each = |measure: fn(&Vector, &Reference) -> f64| -> Vec<f64> {
                forces.iter().zip(&references).map(|(force, reference)| measure(force, reference)).collect()
            };
            if references[0].is_pressed {
                // Two bodies of stiffness k meet half way: between walls that is half of the force.
                let errors = each(|force, reference| {
                    (force / 2.0 / reference.hydroelastic.norm()
                        - reference.hydroelastic / reference.hydroelastic.norm())
                    .norm()
                });
                let bodies = format!("{pair} to hydroelastic (part)");
                rows.push(Row { bodies, mode, errors, targets: [0.1; 3] });
                continue;
            }
            let errors = each(|force, reference| force.angle(&reference.hydroelastic).to_degrees());
            let bodies = format!("{pair} to hydroelastic (degrees)");
            rows.push(Row { bodies, mode, errors, targets: [1.0, 4.0, 90.0] });
            let errors = each(|force, reference| force.angle(&reference.even_pressure).to_degrees());
            let bodies = format!("{pair} to even pressure (degrees)");
            rows.push(Row { bodies, mode, errors, targets: [3.0, 7.0, 90.0] });
        }
    }
    rows
}
