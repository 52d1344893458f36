use super::*;
use crate::query::Layout;
use crate::shapes;

type Corners = [Vector3<f64>; 3];

/// Turned about z, then about x.
fn turned(point: [f64; 3], (about_z, about_x): (f64, f64)) -> Vector3<f64> {
    let [x, y, z] = point;
    let (x, y) = (about_z.cos() * x - about_z.sin() * y, about_z.sin() * x + about_z.cos() * y);
    Vector3::new(x, about_x.cos() * y - about_x.sin() * z, about_x.sin() * y + about_x.cos() * z)
}

/// Both triangles away from the origin, turned in many ways, in either order, and begun at each of their corners.
fn for_each_way(pair: [[[f64; 3]; 3]; 2], mut ask: impl FnMut(&[Corners; 2])) {
    for way in 0..72 {
        let turn = (0.7 * f64::from(way), 1.9 * f64::from(way));
        let away = Vector3::new(3.0, -5.0, 2.0);
        let [mut a, mut b] = pair.map(|corners| corners.map(|corner| turned(corner, turn) + away));
        a.rotate_left(way as usize % 3);
        b.rotate_left(way as usize / 3 % 3);
        ask(&if way < 36 { [a, b] } else { [b, a] });
    }
}

/// The lowest corner of the second is so high above the first.
fn face_and_corner(height: f64) -> [[[f64; 3]; 3]; 2] {
    [[[-1.0, -1.0, 0.0], [2.0, -0.5, 0.0], [-0.3, 1.5, 0.0]], [[0.1, 0.1, height], [1.0, 0.2, 0.5], [-0.4, 1.0, 0.9]]]
}

/// The lowest edge of the second crosses the highest of the first so high above it.
fn two_edges(height: f64) -> [[[f64; 3]; 3]; 2] {
    [[[-1.0, 0.0, 0.0], [1.5, 0.0, 0.0], [0.2, 0.3, -0.8]], [[0.1, -1.0, height], [0.1, 1.2, height], [-0.5, 0.3, 0.9]]]
}

fn within(mesh: &Mesh<f64>, margin: f64) -> Reach<f64> {
    Reach { margin, tile_margin: margin, ..Touching::reach(mesh) }
}

#[test]
fn separation_is_the_distance_across_a_face_or_two_edges() {
    for height in [0.001, 0.25] {
        for pair in [face_and_corner(height), two_edges(height)] {
            for_each_way(pair, |corners| {
                assert!((separation(corners, f64::INFINITY) - height).abs() < 1e-14, "{corners:?}");
                let found = separation(corners, 0.5 * height);
                assert!(0.5 * height <= found && found < height + 1e-14, "{found} of {height}: {corners:?}");
            });
        }
    }
}

#[test]
fn triangles_that_cross_are_not_parted() {
    for pair in [face_and_corner(-0.01), two_edges(-0.01)] {
        for_each_way(pair, |corners| {
            assert_eq!(separation(corners, f64::INFINITY), 0.0, "{corners:?}");
            assert!(!are_apart(corners, 0.0), "{corners:?}");
        });
    }
}

#[test]
fn triangles_with_one_centre_are_not_parted() {
    let flat = [[-1.0, -1.0, 0.0], [2.0, -1.0, 0.0], [-1.0, 2.0, 0.0]].map(Vector3::from);
    let upright = [[-1.0, 0.0, -1.0], [2.0, 0.0, -1.0], [-1.0, 0.0, 2.0]].map(Vector3::from);
    assert_eq!(separation(&[flat, upright], 1.0), 0.0);
    assert!(!are_apart(&[flat, upright], 0.0));
}

/// In one plane neither normals nor products of edges part them.
#[test]
fn triangles_in_one_plane_are_parted_where_their_boxes_are() {
    let flat = [[[0.0, -10.0], [1.0, -10.0], [1.0, 10.0]], [[1.125, -10.0], [1.125, 30.0], [2.0, 30.0]]];
    for (axis, mirror) in (0..3).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
        let corners =
            flat.map(|corners| corners.map(|[x, y]| Vector3::from_fn(|i, _| mirror * [x, y, 0.0][(i + axis) % 3])));
        assert_eq!(separation(&corners, f64::INFINITY), 0.125, "{axis} {mirror}");
    }
}

/// Two of one shape, one above the other at height 1: apart by more than √1.5 times what is less than √(2/3).
#[test]
fn the_line_of_centres_tells_what_is_apart() {
    let triangle = |z: f64| [[-1.0, -1.0, z], [2.0, -0.5, z], [-0.3, 1.5, z]];
    for_each_way([triangle(0.0), triangle(1.0)], |corners| {
        for exponent in [-100, 0, 100] {
            let scale = f64::exp2(f64::from(exponent));
            let corners = corners.map(|corners| corners.map(|corner| corner * scale));
            assert!(are_apart(&corners, 0.8 * scale) && !are_apart(&corners, 0.83 * scale), "{corners:?}");
        }
    });
    for scale in [-520.0, 510.0].map(f64::exp2) {
        let corners = [triangle(0.0), triangle(1.0)].map(|corners| corners.map(|corner| Vector3::from(corner) * scale));
        assert!(!are_apart(&corners, 0.01 * scale), "squares tell nothing at {scale:e}");
    }
}

fn octahedron(middle: f64) -> Mesh<f64> {
    shapes::octahedron().map(|point| point.map(|x| x + middle)).mesh()
}

/// What the fans around vertices allow and touch.
fn fans_of(mesh: &Mesh<f64>) -> (Fans<f64>, Touching<f64>) {
    let mut touching = Touching::default();
    touching.reset(mesh);
    (touching.search_fans(mesh), touching)
}

/// Each triangle is √1.5 high, and √0.5 seen along the axis of its fan. What is kept for rounding grows with the
/// coordinates.
#[test]
fn fans_of_an_octahedron_have_the_altitudes_of_its_triangles() {
    for middle in [0.0, 1e9, 1e11] {
        let (found, touching) = fans_of(&octahedron(middle));
        let kept = 64.0 * 64.0 * (middle + 1.0) * f64::EPSILON / 2.0;
        assert!((found.fineness / 1.5f64.sqrt() - 1.0).abs() < 1e-14);
        assert!((found.stretch / ((0.5f64.sqrt() - kept) / 3.0) - 1.0).abs() < 1e-13, "{}", found.stretch);
        assert!(!touching.any && touching.touched == [false; 8]);
    }
    let (_, touching) = fans_of(&octahedron(1e13));
    assert!(touching.any && touching.touched == [true; 8], "coordinates tell no altitude apart");
}

/// An affine map strains all triangles by at most the root of the sum of its squares. By what they may be, its triangles
/// still cover a plane once around each vertex.
#[test]
fn fans_hold_while_triangles_are_strained_by_what_they_may() {
    let mesh = octahedron(0.0);
    let (_, touching) = fans_of(&mesh);
    let allowed = touching.strains[0];
    assert!(allowed > 0.2 && touching.strains.iter().all(|strain| (strain - allowed).abs() < 1e-12), "{allowed}");
    for way in 0..200 {
        let strain = nalgebra::Matrix3::from_fn(|i, j| f64::from(way * (3 * i + j + 1) as u32 + 1).sin());
        let map = nalgebra::Matrix3::identity() + strain * (allowed / strain.norm());
        let positions: Vec<[f64; 3]> = mesh.positions().iter().map(|p| (map * p).into()).collect();
        let mut moved = mesh.clone();
        moved.set_positions(&positions).expect("finite");
        assert!(!fans_of(&moved).1.any, "way {way}");
    }
}

/// Two pyramids on a rim whose corners stand at these angles, in twelfths of a turn.
fn pyramids(rim: &[u32]) -> Mesh<f64> {
    let count = rim.len() as u32;
    let at = |&twelfth: &u32| std::f64::consts::TAU * f64::from(twelfth) / 12.0;
    let corners = rim.iter().map(|place| [at(place).cos(), at(place).sin(), 0.0]);
    let positions: Vec<_> = corners.chain([[0.0, 0.0, 0.5], [0.0, 0.0, -0.5]]).collect();
    let two = |k: u32| [[k, (k + 1) % count, count], [(k + 1) % count, k, count + 1]];
    Mesh::new(&positions, &(0..count).flat_map(two).collect::<Vec<_>>()).expect("it is closed")
}

#[test]
fn a_fan_that_folds_or_goes_round_twice_touches_itself() {
    let apex_of = |rim: &[u32]| {
        let mesh = pyramids(rim);
        let (found, touching) = fans_of(&mesh);
        let apex = [0, 1].map(|k| altitude_of_fan(&mesh, rim.len() as u32 + k, |t| touching.facets[t as usize]).0);
        (apex, found.stretch, touching)
    };
    for rim in [[0, 4, 8].as_slice(), &[0, 3, 6, 9], &[0, 2, 4, 6, 8, 10], &[1, 4, 5, 9]] {
        let (apex, stretch, touching) = apex_of(rim);
        assert!(apex[0] > 0.0 && apex[0] == apex[1] && stretch > 0.0 && !touching.any, "{rim:?}");
    }
    for rim in [[0, 5, 3, 8].as_slice(), &[0, 3, 2, 6, 9], &[0, 5, 10, 15, 20], &[0, 4, 8, 12, 16, 20]] {
        let (apex, _, touching) = apex_of(rim);
        assert_eq!(apex, [0.0; 2], "{rim:?}");
        assert!(touching.any && touching.touched.iter().all(|&touched| touched), "{rim:?}");
    }
}

/// The tip of one tetrahedron above a face of another.
fn tip_above_face(gap: f64) -> Mesh<f64> {
    let base = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, -4.0]];
    let above = [[1.0, 1.0, gap], [0.5, 1.0, 1.0], [1.0, 2.0, 1.5], [1.5, 0.5, 1.5]];
    let triangles = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2], [4, 5, 6], [4, 6, 7], [4, 7, 5], [5, 7, 6]];
    Mesh::new(&[base, above].concat(), &triangles).expect("it is closed")
}

/// 256 rounding units of its largest coordinate.
const TOUCH: f64 = 256.0 * 4.0 * f64::EPSILON / 2.0;

#[test]
fn a_tip_touches_what_it_is_near_to() {
    for (gap, is_touching) in [(0.9 * TOUCH, true), (1.1 * TOUCH, false), (-0.01, true), (0.01, false)] {
        let mesh = tip_above_face(gap);
        for (layout, margin) in [(Layout::Bvh, 0.0), (Layout::Bvh, 0.5), (Layout::PaperOctree, 0.0)] {
            let (octree, mut touching) = (Octree::with_layout(&mesh, layout), Touching::default());
            touching.reset(&mesh);
            touching.search_pairs(&octree, &mesh, &within(&mesh, margin), &mut NearTiles::default());
            touching.pairs.sort();
            let expected: &[[u32; 2]] = if is_touching { &[[0, 4], [0, 5], [0, 6]] } else { &[] };
            assert_eq!((touching.pairs.as_slice(), touching.any), (expected, is_touching), "{gap:e} {layout:?}");
            let touched: Vec<u32> = (0..8).filter(|&triangle| touching.touched[triangle as usize]).collect();
            assert_eq!(touched, if is_touching { vec![0, 4, 5, 6] } else { vec![] });
        }
    }
}

/// Until it touches it may come nearer, and no farther; then what has lapsed is asked whether it does.
#[test]
fn a_tip_may_come_as_near_as_it_does_not_touch() {
    let mut mesh = tip_above_face(10.0 * TOUCH);
    let (mut octree, mut touching, mut near) = (Octree::new(&mesh), Touching::default(), NearTiles::default());
    touching.reset(&mesh);
    touching.search_pairs(&octree, &mesh, &within(&mesh, 20.0 * TOUCH), &mut near);
    // Strain shall not tell.
    octree.keep(&mesh, &[1e3; 8], &mut near);
    let then = mesh.positions().to_vec();
    for (gap, has_lapsed, touches) in
        [(10.0, false, false), (1.1, false, false), (0.9, true, true), (30.0, true, false)]
    {
        mesh.set_positions_with(
            8,
            |vertex| if vertex == 4 { Vector3::new(1.0, 1.0, gap * TOUCH) } else { then[vertex] },
        )
        .expect("finite");
        octree.update(&mesh).expect("its own");
        assert_eq!(octree.find_lapsed(&mesh, f64::INFINITY, &mut near).part > 0.0, has_lapsed, "{gap}");
        assert_eq!(Touching::any_lapsed_touch(&octree, &mesh, &mut near), touches, "{gap}");
    }
}

/// Where squares of what rounding loses underflow or overflow, all touches.
#[test]
fn sizes_whose_squares_tell_nothing_touch_everywhere() {
    // (64 ε / 2)² = 2⁻⁹⁴; squares are safe from 2⁻⁹¹⁸ to just below 2⁹²⁰.
    for (exponent, is_safe) in [(-413, false), (-412, true), (0, true), (506, true), (507, false)] {
        let mut mesh = octahedron(0.0);
        let scaled = mesh.positions().iter().map(|position| position * f64::exp2(f64::from(exponent)));
        let scaled: Vec<_> = scaled.collect();
        mesh.set_positions_with(6, |vertex| scaled[vertex]).expect("finite");
        let mut touching = Touching::default();
        touching.reset(&mesh);
        assert_eq!((touching.any, touching.touched), (!is_safe, vec![!is_safe; 8]), "{exponent}");
    }
}
