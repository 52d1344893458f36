//! The arrays of all bodies that a call is given, read and written where they lie.

use super::checks::check_numbers;
use super::failure::Failure;
use super::pointers::slice;
use super::strided::Strided;
use crate::capi::base::{rayc_status, rayc_vectors, rayc_vectors_mut};
use crate::contact::{Contact, ContactList, WeightedVertices};
use crate::force::{BodiesMut, Vectors, VectorsMut};
use crate::math::{Scalar, Vector3};
use crate::memory::text;

/// One body's array, which has been checked.
#[repr(transparent)]
pub(in crate::capi) struct BodyArray(rayc_vectors);

impl BodyArray {
    /// # Safety
    /// `bodies` is NULL or points to `count` arrays that are as they say and stay so during `'a`.
    pub(in crate::capi) unsafe fn all<'a>(
        bodies: *const rayc_vectors,
        count: usize,
        name: &str,
    ) -> Result<&'a [Self], Failure> {
        // SAFETY: by this function's contract.
        let bodies = unsafe { slice(bodies, count, name) }?;
        for (body, vectors) in bodies.iter().enumerate() {
            // SAFETY: by this function's contract.
            unsafe { Strided::new(vectors, format_args!("{name}[{body}]")) }?;
        }
        // SAFETY: a checked array is laid out as any other.
        Ok(unsafe { std::slice::from_raw_parts(bodies.as_ptr().cast(), count) })
    }

    /// The same; NULL stands for none.
    ///
    /// # Safety
    /// As [`all`](Self::all).
    pub(in crate::capi) unsafe fn if_any<'a>(
        bodies: *const rayc_vectors,
        count: usize,
        name: &str,
    ) -> Result<Option<&'a [Self]>, Failure> {
        // SAFETY: by this function's contract.
        if bodies.is_null() { Ok(None) } else { unsafe { Self::all(bodies, count, name) }.map(Some) }
    }

    #[inline]
    fn known(&self) -> Strided {
        // SAFETY: only `all` makes this.
        unsafe { Strided::known(&self.0) }
    }
}

impl<T: Scalar> Vectors<T> for BodyArray {
    #[inline]
    fn get(&self, vertex: u32) -> Vector3<T> {
        self.known().read(vertex as usize)
    }
}

/// The arrays to which all bodies' forces are added.
pub(in crate::capi) struct BodyArraysMut<'a>(&'a [rayc_vectors_mut]);

impl BodyArraysMut<'_> {
    /// # Safety
    /// As [`BodyArray::all`], and nobody else uses the arrays.
    pub(in crate::capi) unsafe fn all(
        bodies: *const rayc_vectors_mut,
        count: usize,
        name: &str,
    ) -> Result<Self, Failure> {
        // SAFETY: by this function's contract.
        let bodies = unsafe { slice(bodies, count, name) }?;
        for (body, vectors) in bodies.iter().enumerate() {
            // SAFETY: by this function's contract.
            unsafe { Strided::new_mut(vectors, format_args!("{name}[{body}]")) }?;
        }
        Ok(Self(bodies))
    }

    fn known(&self) -> impl Iterator<Item = Strided> {
        // SAFETY: only `all` makes this.
        self.0.iter().map(|array| unsafe { Strided::known_mut(array) })
    }
}

impl<T: Scalar> BodiesMut<T> for BodyArraysMut<'_> {
    #[inline]
    fn add_to(&mut self, body: u32, vertex: u32, vector: Vector3<T>) {
        // SAFETY: only `all` makes this.
        unsafe { Strided::known_mut(&self.0[body as usize]) }.add(vertex, vector);
    }
}

/// The arrays that a call reads, with their names, and those that it writes.
pub(in crate::capi) struct Arrays<'a, const N: usize> {
    pub(in crate::capi) read: [(&'static str, Option<&'a [BodyArray]>); N],
    pub(in crate::capi) written: Option<&'a BodyArraysMut<'a>>,
}

impl<const N: usize> Arrays<'_, N> {
    /// Refuses, before anything is changed, arrays that do not reach to every body and vertex of the contacts or are not finite
    /// there, and contacts whose sum might not be finite. `most(contact, sizes)`: what a contact gives at most where the sizes of
    /// the numbers read for it sum up to `sizes`, array by array.
    pub(in crate::capi) fn check<T: Scalar>(
        &self,
        list: &ContactList<T>,
        most: impl Fn(&Contact<T>, [T; N]) -> T,
    ) -> Result<(), Failure> {
        self.check_apart()?;
        let count = T::of(list.contacts.len() as f64);
        for contact in &list.contacts {
            let vertices = list.spreads.vertices_of(contact);
            let first = self.check_weighted(contact.colliding, &vertices[0])?;
            let second = self.check_weighted(contact.collided, &vertices[1])?;
            let most = most(contact, std::array::from_fn(|array| first[array] + second[array]));
            if !(most * count).is_finite() {
                return Err(beyond_range(contact));
            }
        }
        Ok(())
    }

    /// Refuses arrays that do not reach to each of so many vertices of a body or are not finite there.
    pub(in crate::capi) fn check_all_of<T: Scalar>(&self, body: u32, vertex_count: usize) -> Result<(), Failure> {
        (0..vertex_count as u32).try_for_each(|vertex| self.check_vertices::<T, 1>(body, [vertex]).map(drop))
    }

    /// Refuses to write to what is read. Arrays may be interleaved, as those of the members of a vertex are.
    fn check_apart(&self) -> Result<(), Failure> {
        let Some(written) = self.written else { return Ok(()) };
        let (first, last) = written.known().fold((usize::MAX, 0), |(first, last), array| {
            let bytes = array.bytes();
            if bytes.is_empty() { (first, last) } else { (first.min(bytes.start), last.max(bytes.end)) }
        });
        for (name, arrays) in &self.read {
            for (body, read) in arrays.iter().flat_map(|arrays| arrays.iter().enumerate()) {
                let read = read.known();
                let bytes = read.bytes();
                if bytes.end <= first || last <= bytes.start {
                    continue;
                }
                if let Some(other) = written.known().position(|array| array.shares_with(&read)) {
                    let message = text!(
                        "{name} of body {body} and forces of body {other} share memory; give forces an array of their own"
                    );
                    return Err(Failure::new(rayc_status::RAYC_STATUS_INVALID_OPTION, message));
                }
            }
        }
        Ok(())
    }

    #[inline(always)]
    fn check_weighted<T: Scalar>(&self, body: u32, vertices: &WeightedVertices<'_, T>) -> Result<[T; N], Failure> {
        match vertices {
            WeightedVertices::Point(point) => self.check_vertices(body, point.vertices),
            WeightedVertices::Spread(vertices) => vertices.iter().try_fold([T::zero(); N], |sizes, &(vertex, _)| {
                let of_vertex: [T; N] = self.check_vertices(body, [vertex])?;
                Ok(std::array::from_fn(|array| sizes[array] + of_vertex[array]))
            }),
        }
    }

    #[inline(always)]
    fn check_vertices<T: Scalar, const M: usize>(&self, body: u32, vertices: [u32; M]) -> Result<[T; N], Failure> {
        let mut sizes = [T::zero(); N];
        for (size, (name, arrays)) in sizes.iter_mut().zip(&self.read) {
            let Some(arrays) = arrays else { continue };
            let array = arrays.get(body as usize);
            check_reach(body, vertices, array.map(|array| array.0.count))?;
            let get = |vertex: u32| array.map_or_else(Vector3::zeros, |array| array.get(vertex));
            *size = vertices.iter().fold(T::zero(), |sum, &vertex| sum + size_of_vector(&get(vertex)));
            if !size.is_finite() {
                let is_finite = |vertex: &u32| get(*vertex).iter().all(|x: &T| x.is_finite());
                let vertex = vertices.into_iter().find(|vertex| !is_finite(vertex)).unwrap_or(vertices[0]);
                let given: Vector3<f64> = array.map_or_else(Vector3::zeros, |array| array.get(vertex));
                check_numbers::<T>(given.as_slice(), format_args!("{name}[{body}]: vertex {vertex}"))?;
            }
        }
        if let Some(BodyArraysMut(arrays)) = self.written {
            check_reach(body, vertices, arrays.get(body as usize).map(|array| array.count))?;
        }
        Ok(sizes)
    }
}

/// The sum of the sizes of its numbers, which is at least its length.
#[inline(always)]
fn size_of_vector<T: Scalar>(vector: &Vector3<T>) -> T {
    vector.x.abs() + vector.y.abs() + vector.z.abs()
}

#[cold]
pub(in crate::capi) fn beyond_range<T: Scalar>(contact: &Contact<T>) -> Failure {
    let Contact { colliding, collided, .. } = contact;
    let largest = T::LARGEST.to_f64();
    let message = text!(
        "what a contact of bodies {colliding} and {collided} gives might be beyond {largest:e}, the largest number of the \
         contacts' precision; give a smaller stiffness or damping time, or smaller vectors"
    );
    Failure::new(rayc_status::RAYC_STATUS_INVALID_OPTION, message)
}

#[inline(always)]
fn check_reach<const M: usize>(body: u32, vertices: [u32; M], count: Option<usize>) -> Result<(), Failure> {
    let has = |vertex: &u32| count.is_some_and(|count| (*vertex as usize) < count);
    match vertices.into_iter().find(|vertex| !has(vertex)) {
        Some(vertex) => Err(out_of_reach(body, vertex, count)),
        None => Ok(()),
    }
}

#[cold]
fn out_of_reach(body: u32, vertex: u32, count: Option<usize>) -> Failure {
    let reach = count.map_or(text!("no array"), |count| text!("an array of {count} vectors"));
    let message = text!(
        "a contact needs vertex {vertex} of body {body}, which has {reach}; give one vector for each vertex of each body"
    );
    Failure::new(rayc_status::RAYC_STATUS_WRONG_COUNT, message)
}
