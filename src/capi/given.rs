//! The arrays of all bodies that a call is given, read and written where they lie.

use super::failure::{Failure, rayc_status};
use super::pointers::slice;
use super::vectors::{Strided, rayc_vectors, rayc_vectors_mut};
use crate::contact::ContactList;
use crate::math::{Scalar, Vector3};
use crate::memory::text;
use crate::response::{BodiesMut, PenaltyLaw, Vectors, VectorsMut};

/// One body's array, known to be as it should.
#[repr(transparent)]
pub(super) struct Given(rayc_vectors);

impl Given {
    /// # Safety
    /// `bodies` is NULL or points to `count` arrays that are as they say and stay so during `'a`.
    pub(super) unsafe fn all<'a>(bodies: *const rayc_vectors, count: usize, name: &str) -> Result<&'a [Self], Failure> {
        // SAFETY: by this function's contract.
        let bodies = unsafe { slice(bodies, count, name) }?;
        for (body, vectors) in bodies.iter().enumerate() {
            // SAFETY: by this function's contract.
            unsafe { Strided::new(vectors, format_args!("{name}[{body}]")) }?;
        }
        // SAFETY: an array known to be as it should is laid out as any other.
        Ok(unsafe { std::slice::from_raw_parts(bodies.as_ptr().cast(), count) })
    }

    /// The same; NULL stands for none.
    ///
    /// # Safety
    /// As [`all`](Self::all).
    pub(super) unsafe fn if_any<'a>(
        bodies: *const rayc_vectors,
        count: usize,
        name: &str,
    ) -> Result<Option<&'a [Self]>, Failure> {
        // SAFETY: by this function's contract.
        if bodies.is_null() { Ok(None) } else { unsafe { Self::all(bodies, count, name) }.map(Some) }
    }
}

impl<T: Scalar> Vectors<T> for Given {
    fn get(&self, vertex: u32) -> Vector3<T> {
        // SAFETY: only `all` makes this.
        unsafe { Strided::known(&self.0) }.read(vertex as usize)
    }
}

/// The arrays to which all bodies' forces are added.
pub(super) struct GivenMut<'a>(&'a [rayc_vectors_mut]);

impl GivenMut<'_> {
    /// # Safety
    /// As [`Given::all`], and nobody else uses the arrays.
    pub(super) unsafe fn all(bodies: *const rayc_vectors_mut, count: usize, name: &str) -> Result<Self, Failure> {
        // SAFETY: by this function's contract.
        let bodies = unsafe { slice(bodies, count, name) }?;
        for (body, vectors) in bodies.iter().enumerate() {
            // SAFETY: by this function's contract.
            unsafe { Strided::new_mut(vectors, format_args!("{name}[{body}]")) }?;
        }
        Ok(Self(bodies))
    }
}

impl<T: Scalar> BodiesMut<T> for GivenMut<'_> {
    fn add_to(&mut self, body: u32, vertex: u32, vector: Vector3<T>) {
        // SAFETY: only `all` makes this.
        unsafe { Strided::known_mut(&self.0[body as usize]) }.add(vertex, vector);
    }
}

/// What a call is to read, with its names, and to write.
pub(super) struct Arrays<'a, const N: usize> {
    pub(super) read: [(&'static str, Option<&'a [Given]>); N],
    pub(super) written: Option<&'a GivenMut<'a>>,
}

impl<const N: usize> Arrays<'_, N> {
    /// Refuses arrays that do not reach to every body and vertex of the contacts, and of the pushes where they are used,
    /// or that are not finite there, before anything is changed.
    pub(super) fn check<T: Scalar>(&self, list: &ContactList<T>, law: &PenaltyLaw) -> Result<(), Failure> {
        for contact in &list.contacts {
            for (body, point) in [(contact.colliding, &contact.p1), (contact.collided, &contact.p2)] {
                point.vertices.iter().try_for_each(|&vertex| self.check_vertex::<T>(body, vertex))?;
            }
        }
        for push in list.pushes().iter().filter(|_| law.pushes_whole_bodies()) {
            for (&body, &count) in push.bodies.iter().zip(&push.vertex_counts) {
                // The last one first: where the array is too short that is what it should reach to.
                (0..count).rev().try_for_each(|vertex| self.check_vertex::<T>(body, vertex))?;
            }
        }
        Ok(())
    }

    fn check_vertex<T: Scalar>(&self, body: u32, vertex: u32) -> Result<(), Failure> {
        for (name, arrays) in &self.read {
            let Some(arrays) = arrays else { continue };
            let array = arrays.get(body as usize);
            check_reach(body, vertex, array.map(|array| array.0.count))?;
            let vector: Option<Vector3<T>> = array.map(|array| array.get(vertex));
            if !vector.is_some_and(|vector| vector.iter().all(|x| x.is_finite())) {
                return Err(not_finite(name, body, vertex));
            }
        }
        let Some(GivenMut(arrays)) = self.written else { return Ok(()) };
        check_reach(body, vertex, arrays.get(body as usize).map(|array| array.count))
    }
}

fn check_reach(body: u32, vertex: u32, count: Option<usize>) -> Result<(), Failure> {
    if count.is_some_and(|count| (vertex as usize) < count) {
        return Ok(());
    }
    let reach = count.map_or(text!("no array"), |count| text!("an array of {count} vectors"));
    let message = text!(
        "a contact needs vertex {vertex} of body {body}, which has {reach}; give one vector for each vertex of each body"
    );
    Err(Failure::new(rayc_status::RAYC_STATUS_WRONG_COUNT, message))
}

#[cold]
fn not_finite(name: &str, body: u32, vertex: u32) -> Failure {
    let message =
        text!("{name}[{body}]: vertex {vertex} has a number that is NaN or infinite; check the simulation's last step");
    Failure::new(rayc_status::RAYC_STATUS_NOT_FINITE, message)
}
