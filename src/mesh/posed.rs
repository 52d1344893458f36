//! A mesh moved by a pose: its vertices are placed where they are needed.

use super::{Mesh, next_stamp};
use crate::math::{Aabb, Pose, Scalar, Vector3};
use crate::memory::{self, Room};
use crate::simd::{LANE_COUNT, Lanes, Mask, Vectors, set_lane};

impl<T: Scalar> Mesh<T> {
    /// The pose that moves its reference positions; `None` once it was given positions.
    pub(crate) fn pose(&self) -> Option<&Pose> {
        self.pose.as_ref()
    }

    /// Moves the reference positions by a pose; `aabb` is the smallest box around the moved surface. Vertices are placed later.
    /// Octrees of this mesh are stale from here on.
    pub(crate) fn follow(&mut self, pose: &Pose, aabb: Aabb<T>) {
        let nowhere = Vector3::repeat(T::of(f64::NAN));
        // Reserved now, so that no later step allocates.
        self.placed.room_for(self.positions.len() - self.placed.len());
        if self.pose.is_some() {
            for vertex in self.placed.drain(..) {
                self.positions[vertex as usize] = nowhere;
            }
        } else {
            self.positions.fill(nowhere);
        }
        self.pose = Some(*pose);
        self.all.take();
        self.aabb = aabb;
        self.stamp = next_stamp();
    }

    /// The mesh has positions of its own from here on.
    pub(crate) fn leave_pose(&mut self) {
        self.pose = None;
        self.placed.clear();
        self.all.take();
    }

    /// Places all vertices, as if they had been given one by one.
    pub(crate) fn settle(&mut self) {
        if let Some(pose) = self.pose {
            for (position, reference) in self.positions.iter_mut().zip(&self.reference.positions) {
                *position = pose.moved(reference);
            }
            self.leave_pose();
            self.stamp = next_stamp();
        }
    }

    /// Places some vertices, so that they are there when they are asked for.
    #[inline(always)]
    pub(crate) fn place_vertices(&mut self, vertices: &[u32; LANE_COUNT]) {
        let Some(pose) = &self.pose else { return };
        for &vertex in vertices {
            let position = &mut self.positions[vertex as usize];
            if is_nowhere(position) {
                *position = pose.moved(&self.reference.positions[vertex as usize]);
                self.placed.push(vertex);
            }
        }
    }

    /// The position of a vertex.
    #[inline(always)]
    pub(crate) fn position(&self, vertex: u32) -> Vector3<T> {
        match &self.pose {
            None => self.positions[vertex as usize],
            Some(pose) => self.position_by(pose, vertex),
        }
    }

    /// Apart from the above, so that a mesh without a pose pays for one look alone.
    #[cold]
    fn position_by(&self, pose: &Pose, vertex: u32) -> Vector3<T> {
        let position = self.positions[vertex as usize];
        if is_nowhere(&position) { pose.moved(&self.reference.positions[vertex as usize]) } else { position }
    }

    #[cold]
    pub(crate) fn corners_by(&self, pose: &Pose, corners: [u32; 3]) -> [Vector3<T>; 3] {
        corners.map(|vertex| self.position_by(pose, vertex))
    }

    /// The positions of sixteen vertices.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn gather<L: Lanes<T>>(&self, vertices: &[u32; LANE_COUNT]) -> Vectors<T, L> {
        let found = Vectors::<T, L>::gather(&self.positions, vertices);
        if self.pose.is_none() || found.x.is_at_most(found.x) == Mask::MAX {
            return found;
        }
        Vectors::load(&self.gather_moved(vertices))
    }

    #[cold]
    fn gather_moved(&self, vertices: &[u32; LANE_COUNT]) -> [[T; LANE_COUNT]; 3] {
        let mut rows = [[T::zero(); LANE_COUNT]; 3];
        for (lane, &vertex) in vertices.iter().enumerate() {
            set_lane(&mut rows, lane, &self.position(vertex));
        }
        rows
    }

    /// The position of every vertex.
    ///
    /// For a body that was moved by a [`Pose`], all are computed when they are first asked for at that pose.
    pub fn positions(&self) -> &[Vector3<T>] {
        match &self.pose {
            None => &self.positions,
            Some(pose) => {
                self.all.get_or_init(|| memory::listed(self.reference.positions.iter().map(|point| pose.moved(point))))
            }
        }
    }
}

/// Whether a vertex of a mesh with a pose is not placed: positions are finite.
#[inline(always)]
fn is_nowhere<T: Scalar>(position: &Vector3<T>) -> bool {
    !position.x.is_finite()
}
