//! Where the bodies of a scene overlap, and the forces that part them: the query, its contacts, their forces for explicit and
//! implicit integrators, and how contacts are looked for.

mod detection;
mod escape_push;
mod forces;
mod list;
mod statistics;

pub use detection::*;
pub use escape_push::*;
pub use forces::*;
pub(super) use forces::{most_force, velocities_for};
pub use list::*;
pub use statistics::*;

use crate::capi::ffi::{Failure, Handle, HandleKind, InPrecision, range_of, with_precision};
use crate::contact::ContactList;
use crate::distributed::ForcesByPair;
use std::ops::Range;

/// The contacts of one query, in a fixed order: by pair, then the colliding body, then along its surface.
///
/// Threads: several threads may make calls with const contacts at the same time. The caller frees the list with
/// rayc_contacts_destroy(). It stays valid when meshes, octrees and scenes are gone. Each query replaces its contents
/// and reuses its memory.
pub struct rayc_contacts {
    pub(super) list: AnyContacts,
    pub(super) pair_forces: AnyForcesByPair,
}

impl Handle for rayc_contacts {
    const KIND: HandleKind = HandleKind::CONTACTS;
}

/// Contacts of either precision.
pub(super) type AnyContacts = InPrecision<ContactList<f32>, ContactList<f64>>;

/// Their forces, summed pair by pair.
pub(super) type AnyForcesByPair = InPrecision<ForcesByPair<f32>, ForcesByPair<f64>>;

macro_rules! as_precision {
    ($either:ty, $own:ident($value:ty)) => {
        /// The value, made anew first where it was of the other precision.
        impl AsMut<$value> for $either {
            fn as_mut(&mut self) -> &mut $value {
                if !matches!(self, Self::$own(_)) {
                    *self = Self::$own(Default::default());
                }
                let Self::$own(value) = self else { unreachable!("replaced above") };
                value
            }
        }
    };
}

as_precision!(AnyContacts, F32(ContactList<f32>));
as_precision!(AnyContacts, F64(ContactList<f64>));
as_precision!(AnyForcesByPair, F32(ForcesByPair<f32>));
as_precision!(AnyForcesByPair, F64(ForcesByPair<f64>));

impl AnyContacts {
    pub(super) fn len(&self) -> usize {
        with_precision!(self, |list| list.len())
    }

    pub(super) fn range(&self, first: usize, count: usize) -> Result<Range<usize>, Failure> {
        range_of("contacts", first, count, self.len())
    }
}
