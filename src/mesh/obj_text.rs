//! The text of a Wavefront `.obj` file. Only vertices and faces matter here: all other statements are skipped, as are
//! comments in whatever encoding.

use crate::memory::{Room, text};

/// A word that is quoted in a message is cut to this length.
const QUOTED_LENGTH: usize = 40;

/// What is wrong, and in which line.
type Fault = String;

/// The surface of a file, and where in the file it stands.
#[derive(Debug, Default)]
pub(crate) struct ObjSurface {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The line of the face that each triangle is a part of, from 1.
    pub(crate) lines: Vec<u32>,
}

/// The surface, or why the text holds none.
pub(crate) fn read(text: &[u8]) -> Result<ObjSurface, Fault> {
    let mut surface = ObjSurface::default();
    let mut rest = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let (mut words, mut corners) = (Vec::new(), Vec::new());
    let (mut line, mut statement) = (0u32, 0u32);
    while !rest.is_empty() {
        let (content, following) = split_line(rest);
        rest = following;
        line = line.saturating_add(1);
        if words.is_empty() {
            statement = line;
        }
        if append_words(&mut words, content) && !rest.is_empty() {
            continue;
        }
        match *words.as_slice() {
            [b"v", ref numbers @ ..] => surface.positions.room_for(1).push(position(numbers, statement)?),
            [b"f", ref words @ ..] => surface.add_face(words, statement, &mut corners)?,
            _ => (),
        }
        words.clear();
    }
    surface.check()?;
    Ok(surface)
}

/// The first line, and what follows it. Lines end as on any system.
fn split_line(text: &[u8]) -> (&[u8], &[u8]) {
    let Some(end) = text.iter().position(|&byte| byte == b'\n' || byte == b'\r') else { return (text, &[]) };
    let length = if text[end..].starts_with(b"\r\n") { 2 } else { 1 };
    (&text[..end], &text[end + length..])
}

/// Whether the statement goes on in the next line, as a backslash at the end says. One within a comment does not.
fn append_words<'a>(words: &mut Vec<&'a [u8]>, line: &'a [u8]) -> bool {
    let comment = line.iter().position(|&byte| byte == b'#');
    let content = &line[..comment.unwrap_or(line.len())].trim_ascii_end();
    let (content, goes_on) = match content.strip_suffix(b"\\") {
        Some(content) if comment.is_none() => (content, true),
        _ => (*content, false),
    };
    let found = content.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    found.for_each(|word| words.room_for(1).push(word));
    goes_on
}

fn quoted(word: &[u8]) -> impl std::fmt::Display + '_ {
    word[..word.len().min(QUOTED_LENGTH)].escape_ascii()
}

/// Weights and colours may follow the three numbers.
fn position(words: &[&[u8]], line: u32) -> Result<[f64; 3], Fault> {
    let [x, y, z, ..] = words else {
        return Err(text!("line {line} gives a vertex {} coordinates, but it has three", words.len()));
    };
    Ok([number(x, line)?, number(y, line)?, number(z, line)?])
}

fn number(word: &[u8], line: u32) -> Result<f64, Fault> {
    let number: Option<f64> = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
    match number {
        Some(number) if number.is_infinite() && word.iter().any(u8::is_ascii_digit) => {
            Err(text!("line {line}: {} is larger than the largest double, {:e}", quoted(word), f64::MAX))
        }
        Some(number) => Ok(number),
        None => Err(text!("line {line}: '{}' is not a number", quoted(word))),
    }
}

impl ObjSurface {
    /// `words` are `vertex`, `vertex/texture`, `vertex//normal` or all three; `corners` is scratch memory.
    fn add_face(&mut self, words: &[&[u8]], line: u32, corners: &mut Vec<u32>) -> Result<(), Fault> {
        if words.len() < 3 {
            return Err(text!("line {line}: a face of fewer than three corners"));
        }
        corners.clear();
        for word in words {
            corners.room_for(1).push(self.corner(word, line)?);
        }
        for pair in corners[1..].windows(2) {
            self.triangles.room_for(1).push([corners[0], pair[0], pair[1]]);
            self.lines.room_for(1).push(line);
        }
        Ok(())
    }

    fn corner(&self, word: &[u8], line: u32) -> Result<u32, Fault> {
        let digits = word.split(|&byte| byte == b'/').next().unwrap_or_default();
        let given: Option<i64> = std::str::from_utf8(digits).ok().and_then(|digits| digits.parse().ok());
        let count = self.positions.len();
        let place = match given {
            None => return Err(text!("line {line}: the corner '{}' names no vertex", quoted(word))),
            Some(0) => return Err(text!("line {line} names vertex 0, but vertices count from 1")),
            // From the last vertex so far backwards.
            Some(back) if back < 0 => (count as i64).checked_add(back),
            Some(number) => Some(number - 1),
        };
        place.and_then(|place| u32::try_from(place).ok()).ok_or_else(|| {
            text!("line {line} names vertex {}, but there are {count} vertices up to there", quoted(digits))
        })
    }

    /// A face may name vertices that come after it, so this is known only at the end.
    fn check(&self) -> Result<(), Fault> {
        if self.triangles.is_empty() {
            return Err(text!("it has no line of a face, such as 'f 1 2 3'"));
        }
        let count = self.positions.len();
        for (corners, line) in self.triangles.iter().zip(&self.lines) {
            if let Some(&vertex) = corners.iter().find(|&&vertex| vertex as usize >= count) {
                let number = u64::from(vertex) + 1;
                return Err(text!("line {line} names vertex {number}, but there are {count} vertices"));
            }
        }
        Ok(())
    }
}
