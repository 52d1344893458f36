//! A host's positions on their way into a mesh: each layout has a loop of its own, so that packed arrays of the mesh's own
//! type are copied as they are, and others in one conversion.

use super::strided::Strided;
use crate::capi::base::rayc_scalar;
use crate::math::Scalar;
use crate::mesh::{Mesh, MeshError, PositionSource};
use crate::simd::LANE_COUNT;
use std::marker::PhantomData;

pub(in crate::capi) fn set_positions<T: Scalar>(mesh: &mut Mesh<T>, positions: &Strided) -> Result<(), MeshError> {
    match (positions.scalar(), positions.is_packed()) {
        (rayc_scalar::RAYC_SCALAR_F32, true) => mesh.set_positions_from(&Numbers::<f32, true>::new(positions)),
        (rayc_scalar::RAYC_SCALAR_F32, false) => mesh.set_positions_from(&Numbers::<f32, false>::new(positions)),
        (rayc_scalar::RAYC_SCALAR_F64, true) => mesh.set_positions_from(&Numbers::<f64, true>::new(positions)),
        (rayc_scalar::RAYC_SCALAR_F64, false) => mesh.set_positions_from(&Numbers::<f64, false>::new(positions)),
    }
}

/// An array of numbers of type `S`, three for each vertex.
struct Numbers<'a, S, const IS_PACKED: bool> {
    array: &'a Strided,
    number: PhantomData<S>,
}

impl<'a, S: Scalar, const IS_PACKED: bool> Numbers<'a, S, IS_PACKED> {
    fn new(array: &'a Strided) -> Self {
        Self { array, number: PhantomData }
    }

    /// Where the vector lies that comes `number` vectors after the one at `first`.
    #[inline]
    fn vector(&self, first: *const u8, number: usize) -> *const [S; 3] {
        let stride = if IS_PACKED { size_of::<[S; 3]>() } else { self.array.stride() };
        first.wrapping_add(number * stride).cast()
    }
}

impl<S: Scalar, T: Scalar, const IS_PACKED: bool> PositionSource<T> for Numbers<'_, S, IS_PACKED> {
    fn count(&self) -> usize {
        self.array.count()
    }

    #[inline]
    fn position(&self, vertex: usize) -> [T; 3] {
        let place = self.array.places(vertex, 1);
        // SAFETY: one vector of type S lies there, aligned or not.
        unsafe { self.vector(place, 0).read_unaligned() }.map(|x| T::of(x.to_f64()))
    }

    #[inline]
    fn block(&self, first: usize) -> [[T; 3]; LANE_COUNT] {
        let place = self.array.places(first, LANE_COUNT);
        std::array::from_fn(|number| {
            // SAFETY: sixteen vectors of type S lie there, aligned or not.
            unsafe { self.vector(place, number).read_unaligned() }.map(|x| T::of(x.to_f64()))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capi::base::rayc_vectors;
    use crate::math::{Aabb, Vector3};
    use crate::mesh::test_mesh::{torus_at, torus_positions};

    /// So many bytes lie before each vector, none of them a finite number's.
    fn bytes<S: Scalar>(positions: &[[f64; 3]], gap: usize, write: impl Fn(S, &mut Vec<u8>)) -> Vec<u8> {
        let mut bytes = Vec::new();
        for position in positions {
            bytes.extend(std::iter::repeat_n(0xff, gap));
            position.iter().for_each(|&x| write(S::of(x), &mut bytes));
        }
        bytes
    }

    fn held_to_the_numbers_given<S: Scalar, T: Scalar>(gap: usize, scalar: rayc_scalar, write: fn(S, &mut Vec<u8>)) {
        // 38 × 5 vertices and a far one: eleven blocks of sixteen, and fifteen.
        let sides = [38, 5];
        let mut mesh = torus_at(sides, 0);
        let mut given = torus_positions(sides, 3);
        let set = |mesh: &mut Mesh<T>, given: &[[f64; 3]]| {
            let bytes = bytes(given, gap, write);
            let vectors = rayc_vectors {
                data: bytes[gap..].as_ptr().cast(),
                count: given.len(),
                stride: if gap == 0 { 0 } else { gap + size_of::<[S; 3]>() },
                scalar: scalar as u32,
            };
            // SAFETY: the array is as it says.
            let array = unsafe { Strided::new(&vectors, "positions") }.unwrap_or_else(|_| panic!("it is an array"));
            set_positions(mesh, &array)
        };
        assert!(set(&mut mesh, &given).is_ok());
        let expected: Vec<Vector3<T>> =
            given.iter().map(|position| position.map(|x| T::of(S::of(x).to_f64())).into()).collect();
        assert_eq!(mesh.positions(), expected);
        // Without the vertex of no triangle.
        let mut around = Aabb::empty();
        expected[..given.len() - 1].iter().for_each(|position| around.include(position));
        assert_eq!(*mesh.aabb(), around);
        for vertex in 0..given.len() {
            let kept = std::mem::replace(&mut given[vertex][vertex % 3], f64::NAN);
            let refused = set(&mut mesh, &given);
            assert!(matches!(refused, Err(MeshError::NotFinite { vertex: told, .. }) if told == vertex), "{refused:?}");
            assert_eq!(mesh.positions(), expected);
            given[vertex][vertex % 3] = kept;
        }
    }

    #[test]
    fn every_layout_gives_the_numbers_it_holds() {
        let (single, double) = (rayc_scalar::RAYC_SCALAR_F32, rayc_scalar::RAYC_SCALAR_F64);
        let write_f32 = |x: f32, to: &mut Vec<u8>| to.extend(x.to_ne_bytes());
        let write_f64 = |x: f64, to: &mut Vec<u8>| to.extend(x.to_ne_bytes());
        // Packed, aligned with a gap, and at any address.
        for gap in [0, 8, 3] {
            held_to_the_numbers_given::<f32, f32>(gap, single, write_f32);
            held_to_the_numbers_given::<f32, f64>(gap, single, write_f32);
            held_to_the_numbers_given::<f64, f32>(gap, double, write_f64);
            held_to_the_numbers_given::<f64, f64>(gap, double, write_f64);
        }
    }
}
