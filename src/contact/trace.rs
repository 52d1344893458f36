use crate::bvh::{Candidates, PacketHits};
use crate::math::Scalar;
use crate::query::PointDistances;
use crate::triangle::RayPacket;

/// The rays of a packet of samples, where they first meet the other body, and scratch memory.
pub(crate) struct Rays<T: Scalar> {
    pub(crate) packet: RayPacket<T>,
    pub(crate) candidates: Candidates<T>,
    pub(crate) hits: PacketHits<T>,
    pub(crate) distances: PointDistances<T>,
}

impl<T: Scalar> Rays<T> {
    pub(crate) fn new() -> Self {
        Self {
            packet: RayPacket::empty(),
            candidates: Candidates::new(),
            hits: PacketHits::empty(),
            distances: PointDistances::new(),
        }
    }
}
