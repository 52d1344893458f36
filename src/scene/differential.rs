use super::{Scene, SceneError};
use crate::contact::{ContactLaw, ContactList};
use crate::force::{Between, BodiesMut, PenaltyLaw, Vectors, add_whole_differential};
use crate::math::Scalar;
use crate::query::Tracer;

impl<T: Scalar> Scene<T> {
    /// Adds `stiffness_factor` · (∂force/∂position) d + `damping_factor` · (∂force/∂velocity) d to `forces`, for the displacements
    /// d, as [`add_differential`](crate::force::add_differential) does, but with contacts found anew where d leads. `contacts` are
    /// those of the newest query, and bodies are where they were then. For Newton's method.
    ///
    /// Rays move with their triangles. The distance that a push grows with, its area and direction, and the point where the ray
    /// ends change as the surfaces do; so the derivative is not symmetric, though the energy's would be: samples make the
    /// difference. How many samples there are is held, and over which vertices patches spread their loads. With
    /// [`Sampling::Spacing`](crate::contact::Sampling), no longer than the triangles' edges, it is that of the forces. By accuracy
    /// it lacks how elements fade in: tens of per cent on curved bodies. Contacts of edges, escapes, damping and friction are held.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`], [`SceneError::ContactsOutdated`]. Nothing is added then.
    ///
    /// # Panics
    /// Where a body or vertex of a contact lies beyond the given arrays.
    pub fn add_differential<P: Vectors<T>, F: BodiesMut<T> + ?Sized>(
        &self,
        contacts: &ContactList<T>,
        law: &PenaltyLaw,
        factors: [f64; 2],
        displacements: &[P],
        forces: &mut F,
    ) -> Result<(), SceneError> {
        for contact in &contacts.contacts {
            for (body, point) in [(contact.colliding, &contact.p1), (contact.collided, &contact.p2)] {
                let triangle = self.current(body)?.mesh().topology().triangles().get(point.triangle as usize);
                if !triangle.is_some_and(|corners| point.vertices.iter().all(|vertex| corners.contains(vertex))) {
                    return Err(SceneError::ContactsOutdated { body });
                }
            }
        }
        add_whole_differential(contacts, law, factors, displacements, forces, |contact| {
            let [own, other] = [contact.colliding, contact.collided]
                .map(|body| self.current(body).expect("all bodies were looked at before"));
            let are_closed = !own.mesh().is_open() && !other.mesh().is_open();
            let measures_distances =
                self.options.law == ContactLaw::Pressure && contact.colliding != contact.collided && are_closed;
            Between { own: own.mesh(), other, measures_distances }
        });
        Ok(())
    }

    /// What rays of a body are traced in, if it has not moved since.
    fn current(&self, body: u32) -> Result<Tracer<'_, T>, SceneError> {
        let surface = &self.bodies.get(body).ok_or(SceneError::UnknownBody { body })?.surface;
        surface.octree().tracer(surface.mesh()).map_err(|_| SceneError::ContactsOutdated { body })
    }
}
