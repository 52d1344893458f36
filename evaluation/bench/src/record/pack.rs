//! How a recording is written: a line of JSON, then whole numbers of 16 bits, all of it as one gzip file.
//!
//! Numbers come in tables. In a table each number is the difference from the one `stride` before it, zigzagged (0, -1, 1, -2
//! as 0, 1, 2, 3), first the low bytes of all, then the high ones: mostly small, so that gzip makes them short. In order:
//! the triangles' corners (stride 3), then for each frame the positions (stride 3), less those of the frame before, and the
//! contacts' ends (six for each, stride 6). Positions are in units of `unit` from `lower`.

use super::series::Series;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde::Serialize;
use std::io::Write;

/// Units along the longest side of the box around all frames.
const UNITS: f64 = 2047.0;

#[derive(Serialize)]
struct Header {
    lower: [f64; 3],
    unit: f64,
    /// Of each body.
    vertex_counts: Vec<usize>,
    triangle_count: usize,
    /// Seconds, of each frame.
    times: Vec<f64>,
    /// Of each frame.
    contact_counts: Vec<usize>,
}

pub struct Packer {
    lower: [f64; 3],
    unit: f64,
}

impl Packer {
    pub fn new(series: &Series) -> Self {
        let bound = |pick: fn(f64, f64) -> f64, start: f64| -> [f64; 3] {
            let all = || series.frames.iter().flat_map(|frame| &frame.positions);
            std::array::from_fn(|axis| all().map(|p| p[axis]).fold(start, pick))
        };
        let (lower, upper) = (bound(f64::min, f64::INFINITY), bound(f64::max, f64::NEG_INFINITY));
        let longest = (0..3).map(|axis| upper[axis] - lower[axis]).fold(0.0, f64::max);
        Self { lower, unit: longest / UNITS }
    }

    pub fn pack(&self, series: &Series, ends: &[Vec<[f64; 3]>]) -> std::io::Result<Vec<u8>> {
        let first = &series.frames[0];
        if first.positions.len() > usize::from(u16::MAX) {
            return Err(std::io::Error::other("more than 65535 vertices are too many for a recording"));
        }
        let header = Header {
            lower: self.lower,
            unit: self.unit,
            vertex_counts: (0..first.body_count()).map(|body| first.positions_of(body).len()).collect(),
            triangle_count: first.triangles.len(),
            times: series.frames.iter().map(|frame| frame.time).collect(),
            contact_counts: ends.iter().map(|ends| ends.len() / 2).collect(),
        };
        let mut file = GzEncoder::new(Vec::new(), Compression::best());
        writeln!(file, "{}", serde_json::to_string(&header)?)?;
        let corners: Vec<u16> = first.triangles.as_flattened().iter().map(|&corner| corner as u16).collect();
        file.write_all(&table(&corners, 3))?;
        let mut before = vec![0; 3 * first.positions.len()];
        for (frame, ends) in series.frames.iter().zip(ends) {
            let now = self.quantise(&frame.positions);
            let moved: Vec<u16> = now.iter().zip(&before).map(|(now, before)| now.wrapping_sub(*before)).collect();
            file.write_all(&table(&moved, 3))?;
            file.write_all(&table(&self.quantise(ends), 6))?;
            before = now;
        }
        file.finish()
    }

    fn quantise(&self, points: &[[f64; 3]]) -> Vec<u16> {
        let place = |x: f64, lower: f64| ((x - lower) / self.unit).round() as u16;
        points.iter().flat_map(|p| (0..3).map(|axis| place(p[axis], self.lower[axis]))).collect()
    }
}

fn table(values: &[u16], stride: usize) -> Vec<u8> {
    let zeros = std::iter::repeat_n(&0, stride);
    let differences = values.iter().zip(zeros.chain(values)).map(|(value, before)| value.wrapping_sub(*before));
    let zigzagged = differences.map(|x| (x << 1) ^ if x >> 15 == 1 { u16::MAX } else { 0 });
    let [low, high]: [Vec<u8>; 2] = {
        let numbers: Vec<[u8; 2]> = zigzagged.map(u16::to_le_bytes).collect();
        [0, 1].map(|byte| numbers.iter().map(|number| number[byte]).collect())
    };
    [low, high].concat()
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_table_holds_zigzagged_differences_low_bytes_first() {
        let values = [5, 1000, 4, 300];
        // 5, 1000, -1, -700 as 10, 2000, 1, 1399.
        assert_eq!(super::table(&values, 2), [10, 208, 1, 119, 0, 7, 0, 5]);
    }
}
