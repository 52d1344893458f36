//! What a pair's friction remembers from step to step, as bytes, for another system that finds the pair from now on.

use crate::bytes::{CHECKSUM, Reader, checksum};
use crate::math::{Scalar, Vector3};
use crate::memory::Room;
use crate::system::hooks::{Anchor, AnchorPoint, Hold, Key};
use crate::system::{ContactSystem, Surface, SystemError};

const MARK: [u8; 8] = *b"raycgrip";
const VERSION: u32 = 2;
const HEAD: usize = MARK.len() + 4 + 6 * 8;
/// Three numbers.
const NUMBERS: usize = 3 * 8;
/// Three vertices, their weights and a height.
const CORNERS: usize = 3 * 4 + NUMBERS + 8;
/// Three flags, the triangle, and the corners from which it holds.
const ANCHOR: usize = 3 + 4 + CORNERS;

/// How many bytes [`pack_memory`] appends; none where nothing is remembered.
pub fn packed_memory_length<T: Scalar>(system: &ContactSystem<T>, pair: Key) -> usize {
    let in_space = |anchor: &Anchor| matches!(anchor.hold, Hold::Space(_));
    let length = |anchor: &Anchor| ANCHOR + if in_space(anchor) { NUMBERS } else { CORNERS };
    let of_key = |key: Key| system.anchors.of(key).iter().map(length).sum::<usize>();
    let of_anchors = || keys(pair).into_iter().flatten().map(of_key).sum::<usize>();
    system.loads.remembered(pair).map_or(0, |_| HEAD + of_anchors() + 1 + CHECKSUM)
}

/// Appends what a pair remembers: its load, and what its friction springs hold on to. The bytes carry their version and
/// a checksum, and are the same on every machine.
///
/// # Errors
/// [`SystemError::NotRemembered`].
pub fn pack_memory<T: Scalar>(system: &ContactSystem<T>, pair: Key, bytes: &mut Vec<u8>) -> Result<(), SystemError> {
    let load = system.loads.remembered(pair).ok_or(SystemError::NotRemembered { body: pair.0 })?;
    let start = bytes.len();
    bytes.room_for(packed_memory_length(system, pair));
    bytes.extend(MARK);
    bytes.extend(VERSION.to_le_bytes());
    let put = |bytes: &mut Vec<u8>, numbers: &[f64]| numbers.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    put(bytes, &load);
    for (is_turned, key) in keys(pair).into_iter().enumerate() {
        for anchor in key.map_or(&[][..], |key| system.anchors.of(key)) {
            bytes.extend([1, is_turned as u8, u8::from(matches!(anchor.hold, Hold::Space(_)))]);
            bytes.extend(anchor.triangle.to_le_bytes());
            let put_corners = |bytes: &mut Vec<u8>, corners: &AnchorPoint| {
                corners.vertices.iter().for_each(|vertex| bytes.extend(vertex.to_le_bytes()));
                put(bytes, &corners.weights);
                put(bytes, &[corners.height]);
            };
            put_corners(bytes, &anchor.from);
            match &anchor.hold {
                Hold::Material(corners) => put_corners(bytes, corners),
                Hold::Space(point) => put(bytes, point.as_slice()),
            }
        }
    }
    bytes.push(0);
    let sum = checksum(&bytes[start..]);
    bytes.extend(sum.to_le_bytes());
    Ok(())
}

/// Takes over what a pair remembers, as [`pack_memory`] of this system or another gave it, in place of what it remembers here.
/// `pair`: the bodies in the order in which they were packed.
///
/// # Errors
/// [`SystemError::UnknownBody`]; [`SystemError::StepUnderWay`] unless one of the bodies has joined in the step;
/// [`SystemError::Memory`] where the bytes are not what was packed, or are of other meshes.
pub fn put_memory<T: Scalar>(system: &mut ContactSystem<T>, pair: Key, bytes: &[u8]) -> Result<(), SystemError> {
    match pair.1 {
        Surface::Body(second) => system.check_joined(&[pair.0, second])?,
        Surface::HalfSpace(_) => system.check_no_step()?,
    }
    let other = match pair.1 {
        Surface::Body(second) => system.vertex_count(second)?,
        Surface::HalfSpace(number) if (number as usize) < system.half_spaces.len() => 0,
        Surface::HalfSpace(number) => return Err(SystemError::UnknownBody { body: number }),
    };
    let counts = [system.vertex_count(pair.0)?, other];
    let broken = SystemError::Memory { length: bytes.len() };
    let Some((load, anchors)) = read(bytes, pair, counts) else { return Err(broken) };
    system.anchors.replace(|key| keys(pair).contains(&Some(*key)), &anchors);
    system.loads.put(pair, load);
    Ok(())
}

/// The two keys of a pair's contacts: one for those of each body's rays.
fn keys((first, second): Key) -> [Option<Key>; 2] {
    let turned = match second {
        Surface::Body(second) if second != first => Some((second, Surface::Body(first))),
        _ => None,
    };
    [Some((first, second)), turned]
}

fn read(bytes: &[u8], pair: Key, counts: [usize; 2]) -> Option<([f64; 6], Vec<Anchor>)> {
    let (body, end) = bytes.split_last_chunk::<CHECKSUM>()?;
    let mut reader = Reader { rest: body };
    if checksum(body).to_le_bytes() != *end || reader.take() != Some(MARK) || reader.whole() != Some(VERSION) {
        return None;
    }
    let mut load = [0.0; 6];
    for number in &mut load {
        *number = reader.number().filter(|x: &f64| x.is_finite())?;
    }
    let keys = keys(pair);
    let mut anchors = Vec::new();
    while reader.take()? == [1] {
        let [is_turned, is_in_space] = reader.take()?;
        let key = (*keys.get(is_turned as usize)?)?;
        let counts = if is_turned == 0 { counts } else { [counts[1], counts[0]] };
        let triangle = reader.whole()?;
        let from = corners(&mut reader, counts[0])?;
        let hold = match (is_in_space, key.1) {
            (0, Surface::Body(_)) => Hold::Material(corners(&mut reader, counts[1])?),
            (1, Surface::HalfSpace(_)) => Hold::Space(Vector3::from(numbers(&mut reader)?)),
            _ => return None,
        };
        anchors.room_for(1).push(Anchor { key, triangle, from, hold });
    }
    reader.rest.is_empty().then_some((load, anchors))
}

fn corners(reader: &mut Reader, count: usize) -> Option<AnchorPoint> {
    let vertices = [reader.whole()?, reader.whole()?, reader.whole()?];
    let (weights, height) = (numbers(reader)?, reader.number().filter(|x: &f64| x.is_finite())?);
    vertices.iter().all(|&vertex| (vertex as usize) < count).then_some(AnchorPoint { vertices, weights, height })
}

fn numbers(reader: &mut Reader) -> Option<[f64; 3]> {
    let numbers = [reader.number()?, reader.number()?, reader.number()?];
    numbers.iter().all(|x: &f64| x.is_finite()).then_some(numbers)
}
