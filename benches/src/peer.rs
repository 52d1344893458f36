//! The peers, out of the shared library that is compiled for this very processor.

use crate::host::{Host, HostBody};
use crate::method::{Description, Key, Method, Precision, Push, Stages};
use crate::workload::{Body, Workload};
use nalgebra::Vector3;
use std::ffi::{CString, OsStr, c_char, c_void};
use std::mem::ManuallyDrop;
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
struct PeerContact {
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

type New = unsafe extern "C" fn(*const c_char, u32, *const BodyView, usize) -> *mut c_void;
type Step = unsafe extern "C" fn(*mut c_void, *mut Stages) -> bool;
type Contacts = unsafe extern "C" fn(*const c_void, *mut usize) -> *const PeerContact;
type Free = unsafe extern "C" fn(*mut c_void);

struct Functions {
    new: New,
    step: Step,
    contacts: Contacts,
    free: Free,
}

pub struct Library(Arc<Functions>);

impl Library {
    pub fn open(path: &OsStr) -> Result<Self, String> {
        let failed = |error: libloading::Error| {
            format!("cannot open the peers at {}: {error}; scripts/bench.sh builds them", path.display())
        };
        // SAFETY: the library is this package's own; its functions have the types above.
        unsafe {
            // Never closed: threads of Embree's may still be running in it when this program ends.
            let library = ManuallyDrop::new(libloading::Library::new(path).map_err(failed)?);
            Ok(Self(Arc::new(Functions {
                new: *library.get::<New>(b"peer_new").map_err(failed)?,
                step: *library.get::<Step>(b"peer_step").map_err(failed)?,
                contacts: *library.get::<Contacts>(b"peer_contacts").map_err(failed)?,
                free: *library.get::<Free>(b"peer_free").map_err(failed)?,
            })))
        }
    }

    /// `host` must outlive the peer: peers read its arrays.
    pub fn start(&self, method: &Description, workload: &Workload, host: &Host) -> Result<Peer, String> {
        let bodies = workload.bodies.iter().zip(&host.bodies);
        let views: Vec<BodyView> = bodies.map(|(body, host)| BodyView::new(body, host)).collect();
        let name = match method.precision {
            Precision::F32 => method.name.to_owned(),
            Precision::F64 => format!("{}-f64", method.name),
        };
        let terminated = CString::new(name).expect("names hold no zero");
        // SAFETY: the views are good, and what they point to outlives the peer.
        let peer = unsafe { (self.0.new)(terminated.as_ptr(), method.threads, views.as_ptr(), views.len()) };
        if peer.is_null() {
            return Err(format!("the peers know no method '{}'", method.name));
        }
        Ok(Peer { functions: Arc::clone(&self.0), peer })
    }
}

pub struct Peer {
    functions: Arc<Functions>,
    peer: *mut c_void,
}

impl Method for Peer {
    fn step(&mut self, _: &Host) -> Option<Stages> {
        let mut stages = Stages::default();
        // SAFETY: the peer lives.
        unsafe { (self.functions.step)(self.peer, &mut stages) }.then_some(stages)
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
            let first = (self.functions.contacts)(self.peer, &mut count);
            if count == 0 { &[] } else { std::slice::from_raw_parts(first, count) }
        }
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // SAFETY: the peer lives, and ends here.
        unsafe { (self.functions.free)(self.peer) }
    }
}
