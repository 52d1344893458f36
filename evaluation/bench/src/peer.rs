//! The peers, out of the shared library that is compiled for this very processor.

use crate::host::{Host, HostBody};
use crate::method::{Description, Key, Method, Precision, Push, Stages};
use crate::shared_library::shared_library;
use crate::workload::{Body, Workload};
use nalgebra::Vector3;
use std::ffi::{CString, c_char, c_void};
use std::sync::Arc;

/// As `BodyView` in `peers/cpp/peer.hpp`.
#[repr(C)]
pub struct BodyView {
    positions: *const f32,
    double_positions: *const f64,
    triangles: *const u32,
    vertex_count: u32,
    triangle_count: u32,
    rows: u32,
    columns: u32,
}

/// As `Contact` in `peers/cpp/peer.hpp`.
#[repr(C)]
pub struct PeerContact {
    /// Vertex or triangle where there is none: `u32::MAX`.
    key: [u32; 4],
    depth: f32,
    cos_alpha: f32,
    weights: [f32; 2],
    p2: [f32; 3],
    direction: [f32; 3],
}

impl BodyView {
    /// Good while the host lives.
    pub fn new(body: &Body, host: &HostBody) -> Self {
        Self {
            positions: host.single().as_ptr().cast(),
            double_positions: host.double().as_ptr().cast(),
            triangles: body.triangles.as_ptr().cast(),
            vertex_count: body.rest.len() as u32,
            triangle_count: body.triangles.len() as u32,
            rows: body.rows,
            columns: body.columns,
        }
    }
}

shared_library! {
    /// Peers that detect contacts, and Embree's rays.
    Library, "scripts/bench.sh builds it";
    peer_new: fn(*const c_char, u32, *const BodyView, usize) -> *mut c_void;
    peer_step: fn(*mut c_void, *mut Stages) -> bool;
    peer_contacts: fn(*const c_void, *mut usize) -> *const PeerContact;
    peer_free: fn(*mut c_void);
    rays_new: fn(bool, *const c_char, bool, *const BodyView) -> *mut c_void;
    rays_trace: fn(*const c_void, *mut c_void, usize, u32);
    rays_free: fn(*mut c_void);
}

impl Library {
    /// `host` must outlive the peer: peers read its arrays.
    pub fn start(self: &Arc<Self>, method: &Description, workload: &Workload, host: &Host) -> Result<Peer, String> {
        let bodies = workload.bodies.iter().zip(&host.bodies);
        let views: Vec<BodyView> = bodies.map(|(body, host)| BodyView::new(body, host)).collect();
        let name = match method.precision {
            Precision::F32 => method.name.to_owned(),
            Precision::F64 => format!("{}-f64", method.name),
        };
        let terminated = CString::new(name).expect("names hold no zero");
        // SAFETY: the views are good, and what they point to outlives the peer.
        let peer = unsafe { (self.peer_new)(terminated.as_ptr(), method.threads, views.as_ptr(), views.len()) };
        if peer.is_null() {
            return Err(format!("the peers know no method '{}'", method.name));
        }
        Ok(Peer { library: Arc::clone(self), peer })
    }
}

pub struct Peer {
    library: Arc<Library>,
    peer: *mut c_void,
}

impl Method for Peer {
    fn step(&mut self, _: &Host) -> Option<Stages> {
        let mut stages = Stages::default();
        // SAFETY: the peer lives.
        unsafe { (self.library.peer_step)(self.peer, &mut stages) }.then_some(stages)
    }

    fn contacts(&self) -> Vec<Key> {
        let key = |contact: &PeerContact| {
            let [colliding, collided, vertex, triangle] = contact.key;
            Key { colliding, collided, vertex, triangle }
        };
        self.found().iter().map(key).collect()
    }

    fn pushes(&self) -> Vec<Push> {
        let push = |contact: &PeerContact| {
            let [colliding, collided, vertex, _] = contact.key;
            let [p2, direction] = [contact.p2, contact.direction].map(|v| Vector3::from(v.map(f64::from)));
            let depth = f64::from(contact.depth);
            Push {
                bodies: [colliding, collided],
                point: p2 - direction * depth,
                force: direction * (depth * f64::from(contact.cos_alpha)),
                area: None,
                vertices: if vertex == u32::MAX { Vec::new() } else { vec![[colliding, vertex]] },
            }
        };
        self.found().iter().map(push).collect()
    }
}

impl Peer {
    fn found(&self) -> &[PeerContact] {
        let mut count = 0;
        // SAFETY: the peer lives, and its contacts last until its next step.
        unsafe {
            let first = (self.library.peer_contacts)(self.peer, &mut count);
            if count == 0 { &[] } else { std::slice::from_raw_parts(first, count) }
        }
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // SAFETY: the peer lives, and ends here.
        unsafe { (self.library.peer_free)(self.peer) }
    }
}
