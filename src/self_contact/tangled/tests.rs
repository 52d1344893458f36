use crate::contact::{ContactList, DetectionOptions, detect_self, query_self_with_all_rays};
use crate::mesh::Mesh;
use crate::mesh::test_mesh::{boxes, torus, torus_positions, torus_triangles};
use crate::query::{Layout, Octree};
use crate::self_contact::tangled::is_tangled;

const SIDES: [u32; 2] = [64, 24];

/// A torus whose vertices are moved.
fn bent(place: &dyn Fn(usize, [f64; 3]) -> [f64; 3]) -> Mesh<f64> {
    let mut mesh = torus(SIDES);
    let positions: Vec<_> = torus_positions(SIDES, 0).into_iter().enumerate().map(|(i, p)| place(i, p)).collect();
    mesh.set_positions(&positions).expect("finite");
    mesh
}

/// The contacts of every ray.
fn of_every_ray(mesh: &Mesh<f64>) -> ContactList<f64> {
    let mut all = ContactList::default();
    query_self_with_all_rays(mesh, &Octree::new(mesh), &DetectionOptions::default(), &mut all).expect("new");
    all
}

/// A bent torus: its contacts with itself, and how many pairs of triangles were held against
/// each other, for each triangle.
fn found(layout: Layout, place: &dyn Fn(usize, [f64; 3]) -> [f64; 3]) -> (ContactList<f64>, f64) {
    let mesh = bent(place);
    let (octree, mut contacts) = (Octree::with_layout(&mesh, layout), ContactList::default());
    let tracer = octree.tracer(&mesh).expect("it is new");
    detect_self(0, tracer, &octree, &DetectionOptions::default(), None, &mut contacts);
    let tried = contacts.workspace.own.touching.tried as f64 / mesh.topology().triangles().len() as f64;
    (contacts, tried)
}

/// Anywhere in a box, by Knuth's linear congruential generator.
fn anywhere(vertex: usize) -> [f64; 3] {
    let mut state = vertex as u64 + 1;
    [(); 3].map(|()| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 * (-53f64).exp2()
    })
}

#[test]
fn garbage_takes_no_more_pairs_than_so_many_for_each_triangle() {
    for layout in [Layout::PaperOctree, Layout::Bvh] {
        let (point, collapsed) = found(layout, &|_, _| [1.0, 2.0, 3.0]);
        let (near, nearly) = found(layout, &|_, p| p.map(|x| 1.0 + 1e-15 * x));
        let (box_, thrown) = found(layout, &|vertex, _| anywhere(vertex));
        let (partly, tenth) = found(layout, &|vertex, p| if vertex % 10 == 0 { anywhere(vertex) } else { p });
        let tried = [collapsed, nearly, thrown, tenth];
        assert_eq!(tried, [0.0; 4], "{layout:?}: pairs for each triangle");
        let tangled = [&point, &near, &box_, &partly].map(|list| list.statistics.tangled_bodies);
        assert_eq!(tangled, [0, 1, 1, 1], "what has collapsed has no contacts");
        assert!([&point, &near, &box_, &partly].iter().all(|list| list.is_empty() && list.statistics.rays == 0));
    }
}

/// Bodies of 128 to 512 triangles: thrown anywhere, crumpled, and of fifteen plates or thirty boxes across one another.
#[test]
fn small_bodies_are_tangled_where_a_sixth_of_them_touches() {
    let moved = |sides, place: &dyn Fn(usize, [f64; 3]) -> [f64; 3]| {
        let mut mesh = torus(sides);
        let positions: Vec<_> = torus_positions(sides, 0).into_iter().enumerate().map(|(i, p)| place(i, p)).collect();
        mesh.set_positions(&positions).expect("finite");
        mesh
    };
    for sides in [[8, 8], [16, 8], [24, 10]] {
        assert!(is_tangled(&moved(sides, &|vertex, _| anywhere(vertex))), "{sides:?}");
        let edge = 2.0 * std::f64::consts::PI / f64::from(sides[0]);
        for edges in [0.25, 0.5] {
            let crumpled = moved(sides, &|vertex, p| {
                let by = anywhere(vertex);
                [0, 1, 2].map(|axis| p[axis] + edge * edges * (2.0 * by[axis] - 1.0))
            });
            assert!(!is_tangled(&crumpled), "{sides:?}, {edges}");
        }
    }
    let across = |count: usize, size: &dyn Fn(usize) -> [f64; 3]| {
        let boxed = |number: usize| {
            let (middle, size) = (anywhere(number), size(number));
            [-0.5, 0.5].map(|side| [0, 1, 2].map(|axis| middle[axis] + side * size[axis]))
        };
        boxes(&(0..count).map(boxed).collect::<Vec<_>>())
    };
    let plate = |number: usize| [0, 1, 2].map(|axis| if axis == number % 3 { 0.03 } else { 1.0 });
    assert!(!is_tangled(&across(15, &plate)));
    assert!(!is_tangled(&across(30, &|_| [0.4; 3])));
}

/// A vertex thrown about by so many edges, in each direction; the torus' edges are about 0.1 long.
fn thrown(vertex: usize, p: [f64; 3], edges: f64) -> [f64; 3] {
    let by = anywhere(vertex).map(|x| 0.1 * edges * (2.0 * x - 1.0));
    std::array::from_fn(|axis| p[axis] + by[axis])
}

/// Neither whole nor garbage: from rags to spikes there is an end to the pairs that are looked at.
#[test]
fn what_is_not_quite_garbage_takes_few_pairs_for_each_triangle() {
    const EDGES: [f64; 7] = [0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 5.0];
    const ONE_OF: [usize; 4] = [100, 30, 10, 3];
    for layout in [Layout::PaperOctree, Layout::Bvh] {
        let is_tangled = |place: &dyn Fn(usize, [f64; 3]) -> [f64; 3]| {
            let (list, tried) = found(layout, place);
            assert!(tried < 8.5, "{tried} pairs for each triangle");
            list.statistics.tangled_bodies
        };
        let all = EDGES.map(|edges| is_tangled(&|vertex, p| thrown(vertex, p, edges)));
        let half = EDGES.map(|edges| is_tangled(&|vertex, p| if p[0] > 0.0 { thrown(vertex, p, edges) } else { p }));
        let spikes =
            ONE_OF.map(|one_of| is_tangled(&|vertex, p| if vertex % one_of == 0 { anywhere(vertex) } else { p }));
        let expected = ([0, 1, 1, 1, 1, 1, 1], [0, 1, 1, 1, 1, 1, 1], [1, 1, 1, 1]);
        assert_eq!((all, half, spikes), expected, "{layout:?}");
    }
}

/// Numbers from 0 in an order that nobody chose.
fn shuffled(count: usize, seed: usize) -> Vec<u32> {
    let mut numbers: Vec<u32> = (0..count as u32).collect();
    numbers.sort_by(|a, b| {
        let [a, b] = [a, b].map(|&number| anywhere(seed * count + number as usize));
        a.partial_cmp(&b).expect("finite")
    });
    numbers
}

/// From spikes to rags: other numbers of vertices and triangles give the same verdict, also where it is a
/// near thing.
#[test]
fn numbers_do_not_matter_to_what_is_tangled() {
    let (positions, triangles) = (torus_positions(SIDES, 0), torus_triangles(SIDES));
    let meshes = [0, 1, 2].map(|seed| {
        let vertices = shuffled(positions.len(), seed);
        let mut moved = positions.clone();
        vertices.iter().zip(&positions).for_each(|(&number, position)| moved[number as usize] = *position);
        let corners = |&triangle: &u32| triangles[triangle as usize].map(|vertex| vertices[vertex as usize]);
        let order = shuffled(triangles.len(), seed + 10);
        let mesh: Mesh<f64> = Mesh::new(&moved, &order.iter().map(corners).collect::<Vec<_>>()).expect("it is closed");
        (mesh, vertices)
    });
    let verdicts: Vec<[bool; 3]> = (0..60)
        .map(|step| {
            let edges = 1.0 + 0.1 * f64::from(step);
            meshes.each_ref().map(|(mesh, vertices)| {
                let (mut mesh, mut moved) = (mesh.clone(), positions.clone());
                for (i, &number) in vertices.iter().enumerate() {
                    moved[number as usize] = thrown(i, positions[i], edges);
                }
                mesh.set_positions(&moved).expect("finite");
                is_tangled(&mesh)
            })
        })
        .collect();
    assert!(verdicts.iter().all(|[a, b, c]| a == b && b == c), "{verdicts:?}");
    let tangled = verdicts.iter().filter(|[first, ..]| *first).count();
    assert!((10..50).contains(&tangled), "{tangled} of 60");
}

/// Flattened, everything lies on the rest and encloses nothing: a search of every ray finds no contacts either.
#[test]
fn a_flattened_body_is_tangled_and_nothing_is_lost() {
    let place = |_: usize, [x, y, _]: [f64; 3]| [x, y, 0.25];
    let all = of_every_ray(&bent(&place));
    let (culled, _) = found(Layout::Bvh, &place);
    assert_eq!((all.len(), culled.len(), culled.statistics.tangled_bodies), (0, 0, 1));
}

/// Crumpled, folded or with a ring of its vertices in one point, a body is not tangled: it has the contacts of
/// every ray.
#[test]
fn what_is_not_tangled_has_the_contacts_of_every_ray() {
    let crumpled = |vertex: usize, p: [f64; 3]| thrown(vertex, p, 0.4);
    let pinched = |vertex: usize, p: [f64; 3]| if vertex / 24 == 8 { [0.4, 0.1, 0.0] } else { p };
    // Pushed together in the middle, until the inner sides pass through each other.
    let folded = |_: usize, [x, y, z]: [f64; 3]| [x, y * (1.0 - 0.87 * (-4.0 * x * x).exp() / y.hypot(0.3)), z];
    let places: [&dyn Fn(usize, [f64; 3]) -> [f64; 3]; 3] = [&crumpled, &pinched, &folded];
    for (number, place) in places.into_iter().enumerate() {
        let all = of_every_ray(&bent(place));
        let (culled, tried) = found(Layout::Bvh, place);
        assert_eq!(culled.contacts, all.contacts, "{number}");
        assert!(culled.statistics.tangled_bodies == 0 && tried < 200.0, "{number}: {tried}");
        assert!(number != 2 || !all.is_empty());
    }
}
