//! The ParaView files that the demos write: a list, and a file for each frame.

use std::path::Path;

pub struct Series {
    /// Never empty; all with the same triangles and bodies.
    pub frames: Vec<Frame>,
}

pub struct Frame {
    /// Seconds.
    pub time: f64,
    pub positions: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
    /// Where each body's vertices begin, and where the last one's end.
    starts: Vec<usize>,
}

impl Series {
    pub fn read(list: &Path) -> Result<Self, String> {
        let wrong = |what: &str| format!("{}: {what}; is it a demo's list of frames?", list.display());
        let text = std::fs::read_to_string(list).map_err(|error| wrong(&error.to_string()))?;
        let xml = roxmltree::Document::parse(&text).map_err(|error| wrong(&error.to_string()))?;
        let entries = xml.descendants().filter(|node| node.has_tag_name("DataSet"));
        let frame = |node: roxmltree::Node| {
            let file = node.attribute("file").ok_or_else(|| wrong("a frame without a file"))?;
            let time = node.attribute("timestep").and_then(|time| time.parse().ok());
            Frame::read(&list.with_file_name(file), time.ok_or_else(|| wrong("a frame without a time"))?)
        };
        let frames: Vec<Frame> = entries.map(frame).collect::<Result<_, String>>()?;
        let first = frames.first().ok_or_else(|| wrong("no frame"))?;
        if frames.iter().any(|frame| frame.triangles != first.triangles || frame.starts != first.starts) {
            return Err(wrong("the triangles change"));
        }
        Ok(Self { frames })
    }
}

impl Frame {
    /// A file of the demo: XML whose arrays follow as they lie in memory, each after its size as a `u64`.
    fn read(path: &Path, time: f64) -> Result<Self, String> {
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
        let bodies = found("body")?;
        let changes = (1..bodies.len()).filter(|&vertex| bodies[vertex] != bodies[vertex - 1]);
        Ok(Self {
            time,
            positions: found("position")?.as_chunks().0.iter().map(position).collect(),
            triangles: found("connectivity")?.as_chunks().0.iter().map(triangle).collect(),
            starts: std::iter::once(0).chain(changes).chain([bodies.len()]).collect(),
        })
    }

    pub fn body_count(&self) -> usize {
        self.starts.len() - 1
    }

    pub fn positions_of(&self, body: usize) -> &[[f64; 3]] {
        &self.positions[self.starts[body]..self.starts[body + 1]]
    }

    /// By the body's own numbers of vertices.
    pub fn triangles_of(&self, body: usize) -> Vec<[u32; 3]> {
        let own = self.starts[body]..self.starts[body + 1];
        let is_own = |corners: &&[u32; 3]| own.contains(&(corners[0] as usize));
        let shifted = |corners: &[u32; 3]| corners.map(|corner| corner - own.start as u32);
        self.triangles.iter().filter(is_own).map(shifted).collect()
    }
}
