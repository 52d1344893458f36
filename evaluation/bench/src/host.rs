//! The host's arrays of positions, rewritten before each step at the same addresses.

use crate::workload::Workload;

/// Positions of one body, in both precisions, of equal value. A peer may read four scalars behind the end.
pub struct HostBody {
    single: Vec<[f32; 3]>,
    double: Vec<[f64; 3]>,
    vertex_count: usize,
}

pub struct Host {
    pub bodies: Vec<HostBody>,
}

impl HostBody {
    pub fn single(&self) -> &[[f32; 3]] {
        &self.single[..self.vertex_count]
    }

    pub fn double(&self) -> &[[f64; 3]] {
        &self.double[..self.vertex_count]
    }
}

impl Host {
    pub fn new(workload: &Workload) -> Self {
        let bodies = workload.bodies.iter().map(|body| {
            let vertex_count = body.rest.len();
            HostBody {
                single: vec![[0.0; 3]; vertex_count + 2],
                double: vec![[0.0; 3]; vertex_count + 2],
                vertex_count,
            }
        });
        let mut host = Self { bodies: bodies.collect() };
        host.write(&Frame::new(workload, 0));
        host
    }

    /// Takes over the positions of a step.
    pub fn write(&mut self, frame: &Frame) {
        for (body, positions) in self.bodies.iter_mut().zip(&frame.bodies) {
            for (vertex, p) in positions.iter().enumerate() {
                body.single[vertex] = *p;
                body.double[vertex] = p.map(f64::from);
            }
        }
    }
}

/// The positions of one step, rounded to single precision so that both precisions see the same surfaces.
pub struct Frame {
    bodies: Vec<Vec<[f32; 3]>>,
}

impl Frame {
    pub fn new(workload: &Workload, step: u32) -> Self {
        let rounded = |body| workload.positions(body, step).map(|p| p.map(|x| x as f32)).collect();
        Self { bodies: workload.bodies.iter().map(rounded).collect() }
    }
}
