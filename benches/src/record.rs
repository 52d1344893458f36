//! A demo's frames and their contacts, quantised, for the report's player.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use raycontact::contact::{ContactList, DetectionOptions, query_pair};
use raycontact::mesh::Mesh;
use raycontact::octree::Octree;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Turns the ParaView files of a demo into a recording for the report.
#[derive(clap::Args)]
pub struct Arguments {
    /// The folder with one `.vtp` file for each frame.
    frames: PathBuf,
    /// The recording.
    #[arg(long, default_value = "docs/report/two_bodies.json")]
    out: PathBuf,
    /// Of so many frames one is taken.
    #[arg(long, default_value_t = 1)]
    every: usize,
}

/// Numbers are little-endian and in base 64: positions three `u16` each, from the box's lower to its upper corner.
#[derive(Serialize)]
struct Recording {
    lower: [f64; 3],
    upper: [f64; 3],
    vertex_count: usize,
    /// Vertices of the first body; the second's follow.
    first_count: usize,
    /// `u32`, three each.
    triangles: String,
    frames: Vec<RecordedFrame>,
}

#[derive(Serialize)]
struct RecordedFrame {
    positions: String,
    /// Both ends, as positions are.
    contacts: String,
    /// Depth of the deepest contact, in the surfaces' unit of length.
    deepest: f64,
}

struct Surface {
    positions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    first_count: usize,
}

pub fn run(arguments: &Arguments) -> Result<(), String> {
    let failed = |path: &Path, error: std::io::Error| format!("cannot use {}: {error}", path.display());
    let entries = std::fs::read_dir(&arguments.frames).map_err(|error| failed(&arguments.frames, error))?;
    let mut paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "vtp"));
    paths.sort();
    let surfaces = paths.iter().step_by(arguments.every.max(1)).map(|path| read(path));
    let surfaces: Vec<Surface> = surfaces.collect::<Result<_, _>>()?;
    let first = surfaces.first().ok_or_else(|| format!("{} holds no .vtp file", arguments.frames.display()))?;
    let bound = |pick: fn(f64, f64) -> f64, start: f64| -> [f64; 3] {
        let all = || surfaces.iter().flat_map(|surface| &surface.positions);
        std::array::from_fn(|axis| all().map(|p| p[axis]).fold(start, pick))
    };
    let (lower, upper) = (bound(f64::min, f64::INFINITY), bound(f64::max, f64::NEG_INFINITY));
    let quantise = |points: &[[f64; 3]]| {
        let place = |p: f64, axis: usize| (p - lower[axis]) / (upper[axis] - lower[axis]) * f64::from(u16::MAX);
        let bytes = points.iter().flat_map(|p| (0..3).map(move |axis| place(p[axis], axis).round() as u16));
        STANDARD.encode(bytes.flat_map(u16::to_le_bytes).collect::<Vec<u8>>())
    };
    let mut frames = Vec::new();
    for surface in &surfaces {
        let (ends, deepest) = contacts(surface)?;
        frames.push(RecordedFrame {
            positions: quantise(&surface.positions),
            contacts: quantise(&ends),
            deepest: (deepest * 1e5).round() / 1e5,
        });
    }
    let corners = first.triangles.as_flattened().iter().flat_map(|corner| corner.to_le_bytes());
    let recording = Recording {
        lower,
        upper,
        vertex_count: first.positions.len(),
        first_count: first.first_count,
        triangles: STANDARD.encode(corners.collect::<Vec<u8>>()),
        frames,
    };
    let text = serde_json::to_string(&recording).map_err(|error| error.to_string())?;
    std::fs::write(&arguments.out, text + "\n").map_err(|error| failed(&arguments.out, error))
}

/// A file of the demo: XML whose arrays follow as they lie in memory, each after its size as a `u64`.
fn read(path: &Path) -> Result<Surface, String> {
    let wrong = |what: &str| format!("{}: {what}; is it a file of the demo?", path.display());
    let bytes = std::fs::read(path).map_err(|error| wrong(&error.to_string()))?;
    const RAW: &[u8] = b"<AppendedData encoding=\"raw\">\n_";
    let place = bytes.windows(RAW.len()).position(|window| window == RAW).ok_or_else(|| wrong("no raw data"))?;
    let raw = &bytes[place + RAW.len()..];
    let head = String::from_utf8_lossy(&bytes[..place]) + "</VTKFile>";
    let xml = roxmltree::Document::parse(&head).map_err(|error| wrong(&error.to_string()))?;
    let array = |name: &str| {
        let node = xml.descendants().find(|node| node.attribute("Name") == Some(name))?;
        let start: usize = node.attribute("offset")?.parse().ok()?;
        let (size, values) = raw.get(start..)?.split_first_chunk()?;
        values.get(..u64::from_le_bytes(*size) as usize)
    };
    let found = |name: &str| array(name).ok_or_else(|| wrong(&format!("no array '{name}'")));
    let position = |p: &[u8; 12]| -> [f64; 3] {
        let (numbers, _) = p.as_chunks();
        std::array::from_fn(|axis| f64::from(f32::from_le_bytes(numbers[axis])))
    };
    let triangle = |t: &[u8; 12]| -> [u32; 3] {
        let (numbers, _) = t.as_chunks();
        std::array::from_fn(|corner| u32::from_le_bytes(numbers[corner]))
    };
    Ok(Surface {
        positions: found("position")?.as_chunks().0.iter().map(position).collect(),
        triangles: found("connectivity")?.as_chunks().0.iter().map(triangle).collect(),
        first_count: found("body")?.iter().filter(|number| **number == 0).count(),
    })
}

/// Both ends of each contact between the two bodies, and the largest depth.
fn contacts(surface: &Surface) -> Result<(Vec<[f64; 3]>, f64), String> {
    let first = surface.first_count as u32;
    let mesh = |is_first: bool| {
        let (positions, shift) = match is_first {
            true => (&surface.positions[..first as usize], 0),
            false => (&surface.positions[first as usize..], first),
        };
        let own = surface.triangles.iter().filter(|corners| (corners[0] < first) == is_first);
        let triangles: Vec<[u32; 3]> = own.map(|corners| corners.map(|corner| corner - shift)).collect();
        Mesh::new(positions, &triangles).map_err(|error| error.to_string())
    };
    let (a, b) = (mesh(true)?, mesh(false)?);
    let mut list = ContactList::default();
    query_pair(&a, &Octree::new(&a), &b, &Octree::new(&b), &DetectionOptions::default(), &mut list)
        .map_err(|error| error.to_string())?;
    let ends = list.contacts.iter().flat_map(|contact| [contact.p1.position.into(), contact.p2.position.into()]);
    Ok((ends.collect(), list.contacts.iter().map(|contact| contact.depth).fold(0.0, f64::max)))
}
