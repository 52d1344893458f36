use super::SystemError;
use crate::math::margins;

/// How a body's surface bears load, damps and rubs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Pressure per depth, in N/m³; from 0 to 2⁸⁰ (1.2e24).
    pub stiffness: f64,
    /// Damping over stiffness, in s; from 0 to 2⁸⁰.
    pub damping_time: f64,
    /// Coulomb's coefficient, static and kinetic; from 0 to 2⁸⁰.
    pub friction: f64,
    /// The depth, in m, beyond which one step asks for no more force than there: > 0, and infinity for none. In a step that
    /// looks ahead, bodies that start deep part no faster than by this over the damping time. What they close within the
    /// step is met in full.
    pub depth_cap: f64,
    /// How fast two bodies that meet part again, over the speed with which they met; from 0 to 1. Above 0, an impact of
    /// bodies that are not deformable is over in one step of implicit Euler, however soft and damped their surfaces are, and
    /// these bear bodies at rest alone: what closes faster than by what free motion adds in two steps is an impact. At 0 it
    /// is the surfaces that stop what meets, and give back what damping and the length of the steps leave. A deformable
    /// body bounces by its own elasticity and takes no restitution, and neither does an explicit step; the midpoint rule
    /// wants 0.
    pub restitution: f64,
}

impl Material {
    /// A material that bears `pressure` (Pa) at `depth` (m), and asks for no more in one step: stiffness is `pressure` /
    /// `depth`, and the cap is `depth`. Damping time 0.05 s, friction 0.5, restitution 0.
    ///
    /// For an elastic body there is [`elastic`](Self::elastic). For a rigid or still one, take some ten times the pressure that
    /// it bears at rest (weight over the area that carries it), and ten times the depth to which bodies may sink in.
    ///
    /// # Errors
    /// [`SystemError::Material`] where a number is not finite and > 0.
    pub fn bearing(pressure: f64, depth: f64) -> Result<Self, SystemError> {
        check_positive([("pressure", pressure), ("depth", depth)])?;
        let stiffness = pressure / depth;
        let material = Self { stiffness, damping_time: 0.05, friction: 0.5, depth_cap: depth, restitution: 0.0 };
        material.check()?;
        Ok(material)
    }

    /// The material of an elastic body, by its Young's modulus (Pa), Poisson's ratio and the edge (m) of its elements: it bears
    /// the largest pressure that a strongly squeezed body meets, its Young's modulus or, where that is more, its bulk modulus,
    /// at a fortieth of an edge. The cap is a twentieth of an edge.
    ///
    /// # Errors
    /// [`SystemError::Material`] where a number is out of its range.
    pub fn elastic(youngs_modulus: f64, poissons_ratio: f64, element_edge: f64) -> Result<Self, SystemError> {
        check_positive([("youngs_modulus", youngs_modulus), ("element_edge", element_edge)])?;
        if !(poissons_ratio > -1.0 && poissons_ratio < 0.5) {
            let (what, range) = ("poissons_ratio", "between -1 and 0.5");
            return Err(SystemError::Material { what, value: poissons_ratio, range });
        }
        let bulk_modulus = youngs_modulus / (3.0 - 6.0 * poissons_ratio);
        let bearing = Self::bearing(youngs_modulus.max(bulk_modulus), element_edge / 40.0)?;
        Ok(Self { depth_cap: element_edge / 20.0, ..bearing })
    }

    /// The material of a contact between two bodies, unless the pair has one of its own. The two surfaces are springs in
    /// series, so the softer decides; damping times are weighted by how much of the depth each surface takes (as in Drake's
    /// compliant contact); friction is the geometric mean, so a frictionless body slides on everything; the smaller cap
    /// holds, and the larger restitution, so a bouncing ball bounces on everything (as in Box2D).
    pub fn combined(&self, other: &Self) -> Self {
        let sum = self.stiffness + other.stiffness;
        // The fraction of the depth that the first surface takes.
        let first = if sum > 0.0 { other.stiffness / sum } else { 0.5 };
        Self {
            stiffness: self.stiffness * first,
            damping_time: first * self.damping_time + (1.0 - first) * other.damping_time,
            friction: (self.friction * other.friction).sqrt(),
            depth_cap: self.depth_cap.min(other.depth_cap),
            restitution: self.restitution.max(other.restitution),
        }
    }

    pub(super) fn check(&self) -> Result<(), SystemError> {
        let Self { stiffness, damping_time, friction, depth_cap, restitution } = *self;
        for (what, value) in [("stiffness", stiffness), ("damping_time", damping_time), ("friction", friction)] {
            if !(0.0..=margins::LARGEST_GIVEN).contains(&value) {
                return Err(SystemError::Material { what, value, range: "finite and at least 0" });
            }
        }
        if !(0.0..=1.0).contains(&restitution) {
            return Err(SystemError::Material { what: "restitution", value: restitution, range: "from 0 to 1" });
        }
        if depth_cap > 0.0 {
            Ok(())
        } else {
            Err(SystemError::Material { what: "depth_cap", value: depth_cap, range: "above 0" })
        }
    }
}

fn check_positive(numbers: [(&'static str, f64); 2]) -> Result<(), SystemError> {
    match numbers.into_iter().find(|(_, value)| !(value.is_finite() && *value > 0.0)) {
        Some((what, value)) => Err(SystemError::Material { what, value, range: "finite and above 0" }),
        None => Ok(()),
    }
}
