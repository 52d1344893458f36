//! A demo's frames and the contacts found on them, quantised and packed, for the report's player.

mod pack;
mod series;

use pack::Packer;
use raycontact::contact::{ContactList, DetectionOptions};
use raycontact::mesh::Mesh;
use raycontact::scene::Scene;
use series::{Frame, Series};
use std::path::PathBuf;

/// Turns the ParaView files of a demo into a recording for the report.
#[derive(clap::Args)]
pub struct Arguments {
    /// The demo's list of frames, a `.pvd` file.
    series: PathBuf,
    /// The recording.
    #[arg(long)]
    out: PathBuf,
    /// Contacts as the paper has them, with nothing that goes beyond.
    #[arg(long)]
    paper: bool,
}

pub fn run(arguments: &Arguments) -> Result<(), String> {
    let series = Series::read(&arguments.series)?;
    let mut detection = Detection::new(&series.frames[0], arguments.paper)?;
    let found = series.frames.iter().map(|frame| detection.find(frame)).collect::<Result<Vec<_>, _>>()?;
    let written = Packer::new(&series).pack(&series, &found).and_then(|bytes| std::fs::write(&arguments.out, bytes));
    written.map_err(|error| format!("cannot write {}: {error}", arguments.out.display()))
}

/// All bodies in a scene that remembers its pairs from frame to frame.
struct Detection {
    scene: Scene<f64>,
    contacts: ContactList<f64>,
}

impl Detection {
    fn new(frame: &Frame, paper: bool) -> Result<Self, String> {
        let mut scene = Scene::new(1).map_err(|error| error.to_string())?;
        if paper {
            scene.set_options(DetectionOptions::paper());
        }
        for body in 0..frame.body_count() {
            let mesh = Mesh::new(frame.positions_of(body), &frame.triangles_of(body));
            let number = scene.add(mesh.map_err(|error| error.to_string())?);
            // Bodies that do not fold have no contacts of their own.
            scene.set_self_collision(number, !paper).map_err(|error| error.to_string())?;
        }
        Ok(Self { scene, contacts: ContactList::default() })
    }

    /// Both ends of each contact.
    fn find(&mut self, frame: &Frame) -> Result<Vec<[f64; 3]>, String> {
        for body in 0..frame.body_count() {
            let mesh = self.scene.mesh_mut(body as u32).map_err(|error| error.to_string())?;
            mesh.set_positions(frame.positions_of(body)).map_err(|error| error.to_string())?;
        }
        self.scene.query(&mut self.contacts);
        let contacts = &self.contacts.contacts;
        let ends = contacts.iter().flat_map(|contact| [contact.p1.position.into(), contact.p2.position.into()]);
        Ok(ends.collect())
    }
}
