use crate::contact::quadrature::Sampling;
use crate::math::{Aabb, Scalar};

/// How contacts are found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DetectionOptions<T: Scalar> {
    /// What forces grow with. Default: the distance to the other body's surface.
    pub law: ContactLaw,
    /// Where rays start.
    pub sampling: Sampling<T>,
    /// Whether edges are traced too where no ray settles whether the bodies overlap. Default: yes.
    pub edges: bool,
    /// Whether a pair whose contacts cannot part it is pushed along one direction, in a scene until it is apart. Default:
    /// yes.
    pub escape: bool,
    /// Whether rays go past other folds of either body, as the winding number tells: a ray that meets its own body first is
    /// refused only where it has left the body altogether, and one that enters another fold of the other body on its way
    /// out of it is not taken for one from outside. For bodies that overlap themselves; a scene does so by itself for those
    /// whose self-collision is switched on. Default: no.
    pub past_folds: bool,
}

impl<T: Scalar> Default for DetectionOptions<T> {
    fn default() -> Self {
        Self { law: ContactLaw::default(), sampling: Sampling::default(), edges: true, escape: true, past_folds: false }
    }
}

/// The surface of a body in a region has at most about this many times the area of the region's largest face.
const MOST_FACES: f64 = 5.0;
/// About this many rays and distances at a tolerance of 1; at others more, in inverse proportion.
const RAYS_AT_TOLERANCE_OF_ONE: f64 = 10.0;

impl<T: Scalar> DetectionOptions<T> {
    /// About how many rays a body casts in these regions.
    pub(crate) fn expected_rays(&self, regions: &[Aabb<T>]) -> usize {
        match (self.law, self.sampling) {
            (ContactLaw::Pressure, Sampling::Accuracy(tolerance)) => {
                regions.len().saturating_mul((RAYS_AT_TOLERANCE_OF_ONE / tolerance.to_f64()) as usize)
            }
            (_, Sampling::Spacing(spacing)) => {
                let rays = |region: &Aabb<T>| region.largest_face() * T::of(MOST_FACES) / (spacing * spacing);
                regions.iter().map(rays).fold(T::zero(), |sum, rays| sum + rays).to_f64() as usize
            }
            _ => usize::MAX,
        }
    }

    /// Just what the paper does: rays from the vertices, both filters, its law, nothing else.
    pub fn paper() -> Self {
        let (law, sampling) = (ContactLaw::RayLength, Sampling::Vertices);
        Self { law, sampling, edges: false, escape: false, past_folds: false }
    }
}

/// What is pressed against what: the measure of depth that a contact's force grows with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ContactLaw {
    /// Pressure k · m at every surface point inside the other body, m being the distance to the nearest point of that
    /// body's surface. The force is the gradient of k times the integral of m over the overlap, so that closed paths cost
    /// no work; it is that of Archimedes on what lies in a flat face, and near that of hydroelastic contact (Elandt et al.,
    /// IROS 2019; Masterjohn et al., RA-L 2022) elsewhere. A contact's `cos_alpha` is then m / depth.
    ///
    /// Rays' own law stays where a body folds over itself, so that m may lead to an inner fold: for rays that went past
    /// folds, and for contacts of a body with itself.
    #[default]
    Pressure,
    /// Pressure k · depth · cos α along the ray, at points whose ray leaves the other body before their own: the paper's
    /// (Hermann, Faure, Raffin 2008, section 4). It is no gradient, and beside edges it may point the wrong way.
    RayLength,
}
