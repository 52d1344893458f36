//! Impacts of bodies that are not deformable: how fast what meets parts again.

use super::ContactSystem;
use super::row::{Row, Slip};
use super::twist::V3;
use crate::math::{Scalar, direction};

/// The damping of a pair in an impact, times dt, over the mass of its bodies: about one in this many of the speed is left.
const STIFFNESS: f64 = 1000.0;

impl<T: Scalar> ContactSystem<T> {
    /// Makes rows from index `first` on open within the step as fast as restitution says, if they close faster than by what
    /// free motion adds in two steps: bodies at rest do not bounce. It is the impact law of Moreau's time stepping (M. Jean,
    /// The non-smooth contact dynamics method, 1999), along the pair's net push. Rows at the rim of a deep prediction lean, and
    /// along their own directions they would return motion across the push too.
    pub(super) fn add_impacts(&mut self, first: usize, dt: f64) {
        let Self { rows, loads, buffers, .. } = self;
        let mut begin = rows.begin(first);
        for rows in rows.rows[first..].chunk_by_mut(|one, next| one.pair == next.pair) {
            let pair = &loads.now[rows[0].pair];
            let restitution = pair.material.restitution;
            let has_nodes = rows.iter().any(|row| row.end > begin);
            begin = rows[rows.len() - 1].end;
            if restitution == 0.0 || has_nodes {
                continue;
            }
            let push = |row: &Row| row.direction * (row.order * row.coefficient);
            let Some(net) = direction(&rows.iter().map(push).sum()) else { continue };
            // How fast a row is to open; `None` where it is no impact.
            let parting = |row: &Row| {
                let along = net * row.order;
                let (mut closing, mut added, mut gained) = (along.dot(&row.given), 0.0, 0.0);
                for end in row.rigid.iter().flatten() {
                    let own = along.dot(&end.velocity(&buffers.twists));
                    let change = along.dot(&end.velocity(&buffers.free_twists)) - own;
                    (closing, added, gained) = (closing + own, added + change, gained + change.abs());
                }
                // An escape acts at centres, and is no impact.
                let is_contact = row.rigid.iter().flatten().any(|end| end.arm != V3::zeros());
                let is_impact = is_contact && row.coefficient > 0.0 && restitution * closing > 2.0 * gained;
                // Faster, it would gain more energy by its height at the end of the step than the impact takes.
                is_impact.then(|| (restitution * closing).min(closing.hypot(added) - added))
            };
            let hit = |row: &&Row| parting(row).is_some();
            let whole: f64 = rows.iter().filter(hit).map(|row| row.coefficient).sum();
            for row in rows {
                let Some(parting) = parting(row) else { continue };
                let time = (dt + row.damping_time).max(STIFFNESS / (dt * pair.inverse_mass * whole));
                let ahead = row.direction * row.ahead.along + row.ahead.across;
                row.direction = net * row.order;
                row.ahead = Slip { along: row.direction.dot(&ahead), across: row.across(&ahead) };
                row.stretch = row.ahead.across * dt;
                row.sliding = row.across(&row.sliding);
                row.friction = pair.material.friction;
                row.damping_time = time - dt;
                row.depth = time * parting + dt * row.ahead.along;
            }
        }
    }
}
