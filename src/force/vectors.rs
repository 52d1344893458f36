use crate::math::{Scalar, Vector3};

/// One body's vectors (positions, velocities, displacements), one for each vertex, in whatever layout the host keeps.
pub trait Vectors<T: Scalar> {
    /// The vector at a vertex.
    fn get(&self, vertex: u32) -> Vector3<T>;
}

/// One body's vectors (forces), to be added to.
pub trait VectorsMut<T: Scalar> {
    /// Adds `vector` at a vertex.
    fn add(&mut self, vertex: u32, vector: Vector3<T>);
}

/// All bodies' vectors (forces), by the bodies' numbers, to be added to.
pub trait BodiesMut<T: Scalar> {
    /// Adds `vector` at a vertex of a body.
    fn add_to(&mut self, body: u32, vertex: u32, vector: Vector3<T>);
}

impl<T: Scalar, V: VectorsMut<T>> BodiesMut<T> for [V] {
    fn add_to(&mut self, body: u32, vertex: u32, vector: Vector3<T>) {
        self[body as usize].add(vertex, vector);
    }
}

impl<T: Scalar, V: VectorsMut<T>> BodiesMut<T> for Vec<V> {
    fn add_to(&mut self, body: u32, vertex: u32, vector: Vector3<T>) {
        self[..].add_to(body, vertex, vector);
    }
}

impl<T: Scalar, V: VectorsMut<T>, const N: usize> BodiesMut<T> for [V; N] {
    fn add_to(&mut self, body: u32, vertex: u32, vector: Vector3<T>) {
        self[..].add_to(body, vertex, vector);
    }
}

impl<T: Scalar> Vectors<T> for &[Vector3<T>] {
    fn get(&self, vertex: u32) -> Vector3<T> {
        self[vertex as usize]
    }
}

impl<T: Scalar> Vectors<T> for Vec<Vector3<T>> {
    fn get(&self, vertex: u32) -> Vector3<T> {
        self[vertex as usize]
    }
}

impl<T: Scalar> VectorsMut<T> for Vec<Vector3<T>> {
    fn add(&mut self, vertex: u32, vector: Vector3<T>) {
        self[vertex as usize] += vector;
    }
}
