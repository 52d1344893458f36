use crate::contact::point_pair::SurfacePoint;
use crate::math::{Scalar, Vector3};

/// Where on a surface rays start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sampling<T: Scalar> {
    /// Where the load needs them: from patches of nearly flat, connected triangles, from triangles, or from parts of
    /// triangles, each as large as leaves the net force of each pair, and its torque over the overlap box's half diagonal,
    /// within about this part of that force, in (0, 1], or of a tenth of the sizes of all its forces where these cancel.
    /// Few large ones are halved where the other surface crosses them, where the depth bends, and where they carry much of the
    /// load, by the depth below the other body's surface that is measured in their middles. So it is an estimate, not a bound:
    /// half of all are within 0.6 of it, nearly all within twice (docs/options.md). Their number hardly depends on the
    /// triangulation.
    /// Default: 0.01.
    ///
    /// In a scene, where both bodies of a pair overlap more than 12 others, n at the least, by their boxes, it is n/12 times
    /// as much, at most 16 times: what pushes a body is off by less, since the errors of many pairs are independent. Such pairs
    /// are counted ([`Statistics::crowded_pairs`](crate::contact::Statistics::crowded_pairs)).
    ///
    /// Under [`ContactLaw::RayLength`](crate::contact::ContactLaw) and with an open mesh depths say nothing beforehand: there
    /// rays start in the middle of each triangle, along its normal, and triangles that are large beside the overlap are cut
    /// first, so that about 128 rays stand on its largest side; in crowds fewer, but at least 8. Where a pair escapes, patches
    /// cast that many. Of a body with itself each triangle casts one.
    Accuracy(T),
    /// About so far apart, a length > 0, whatever the triangulation. Larger triangles are cut into pieces of that size, and
    /// each piece casts from its middle. Smaller ones are joined to patches of at most the length's square, connected and
    /// nearly flat, each of which casts from its centroid along its mean normal, with its triangles' areas added as vectors.
    /// The patches are those of the mesh as it is when they are first asked for. Their sizes go in steps, four to each doubling
    /// of the area. Contacts of a body with itself know no patches.
    Spacing(T),
    /// At each vertex, along the mean of the surrounding normals: the paper's.
    Vertices,
}

impl<T: Scalar> Default for Sampling<T> {
    fn default() -> Self {
        Self::Accuracy(T::of(0.01))
    }
}

/// A surface point that casts a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample<T: Scalar> {
    pub(crate) point: SurfacePoint<T>,
    /// Outward, of unit length.
    pub(crate) normal: Vector3<T>,
    /// The area of the surface that it stands for.
    pub(crate) area: T,
    /// As [`Contact::piece`](crate::contact::Contact::piece).
    pub(crate) piece: u32,
    /// How far the other body's surface is, where that is known; for an element, from its centre.
    pub(crate) distance: Option<T>,
}

/// The piece of a vertex.
pub(crate) const VERTEX: u32 = 0;
/// The piece that is a whole triangle.
pub(crate) const WHOLE: u32 = 1;
