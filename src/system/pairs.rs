//! What a host says and asks of single pairs: materials and forces.

use super::loads::{Key, Surface, in_order};
use super::{ContactSystem, Material, SystemError};
use crate::math::Scalar;
use crate::memory::Room;

impl<T: Scalar> ContactSystem<T> {
    /// Gives two bodies, or a body with itself, a material of their own in place of the
    /// [combined](Material::combined) one; `None` takes it back. Within a step one of them must have
    /// joined it.
    pub fn set_pair_material(&mut self, a: u32, b: u32, material: Option<Material>) -> Result<(), SystemError> {
        self.check_joined(&[a, b])?;
        self.index_of(b)?;
        self.set_material((a, Surface::Body(b)), material)
    }

    /// The same for a body and a half-space.
    pub fn set_half_space_material(
        &mut self,
        body: u32,
        half_space: u32,
        material: Option<Material>,
    ) -> Result<(), SystemError> {
        self.check_no_step()?;
        self.check_half_space(half_space)?;
        self.set_material((body, Surface::HalfSpace(half_space)), material)
    }

    fn set_material(&mut self, key: Key, material: Option<Material>) -> Result<(), SystemError> {
        self.index_of(key.0)?;
        material.as_ref().map_or(Ok(()), Material::check)?;
        let (key, _) = in_order(key);
        match (self.pair_materials.binary_search_by_key(&key, |(pair, _)| *pair), material) {
            (Ok(index), Some(material)) => self.pair_materials[index].1 = material,
            (Ok(index), None) => drop(self.pair_materials.remove(index)),
            (Err(index), Some(material)) => self.pair_materials.room_for(1).insert(index, (key, material)),
            (Err(_), None) => {}
        }
        Ok(())
    }

    /// The pairs that the last finished step left something to remember, or that were given it since: the body of the
    /// smaller number and what it touches.
    pub fn remembered_pairs(&self) -> impl ExactSizeIterator<Item = (u32, Surface)> + '_ {
        self.loads.before_keys()
    }

    /// The net force in N with which `other` acted on a body in the last finished step; zero for a body and itself.
    pub fn pair_force(&self, body: u32, other: Surface) -> Result<[f64; 3], SystemError> {
        self.index_of(body)?;
        match other {
            Surface::Body(other) if other == body => return Ok([0.0; 3]),
            Surface::Body(other) => drop(self.index_of(other)?),
            Surface::HalfSpace(number) => self.check_half_space(number)?,
        }
        Ok(self.loads.force((body, other)).into())
    }

    fn check_half_space(&self, half_space: u32) -> Result<(), SystemError> {
        match self.half_spaces.len() {
            count if (half_space as usize) < count => Ok(()),
            count => Err(SystemError::UnknownHalfSpace { half_space, count }),
        }
    }
}
