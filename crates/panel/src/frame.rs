//! Frames: the voltages and traces of an instant as bytes, for a client that draws them.
//!
//! All numbers are little-endian. Offsets are in bytes; every part begins at a multiple of 4.
//!
//! ```text
//! offset  type     content
//! 0       u32      0x31464350, the letters "PCF1"
//! 4       u32      revision of the patch; the client ignores voltages of another revision
//! 8       f64      problem time in seconds
//! 16      f64      seconds of problem time that the last advance covered, divided by those it should have covered
//! 24      u8       mode: 0 pot set, 1 problem check, 2 initial condition, 3 operate, 4 hold, 5 repetitive, 6 single
//! 25      u8       flags: 1 the machine moves, 2 the clock stands, 4 a lamp is lit, 8 the machine stopped by a fault
//! 26      u16      number of the output whose lamp lit first, plus 1; 0 if there is none
//! 28      u32      repetitions since repetitive operation began
//! 32      f64      voltmeter in volts; NaN if it is disconnected
//! 40      f64      null meter in volts; NaN if it is disconnected
//! 48      u32      n, the number of outputs
//! 52      f32[n]   their voltages, in the order of `PatchView::outputs`
//! ...     u8[n]    their lamps: 0 off or none, 1 lit; padded with 0 to a multiple of 4
//! ...              two scopes, each:
//!         u32      display: 0 against time, 1 X-Y
//!         u32      generation: it grows when the screen is erased or a new trace begins on it. The last frame of a
//!                  generation has its complete trace
//!         u32      c, the number of channels in use (against time), or 1 (X-Y) or 0
//!   against time:
//!         f64      problem time at the left edge in seconds
//!         f64      seconds per column
//!         u32      m, the number of columns that the trace has reached, from the left
//!         u32      bits of the channels in use: 1 channel 0, 2 channel 1
//!         f32[2m]  for each channel in use: minimum and maximum of each column in volts; NaN for an empty column
//!   X-Y, if c is 1:
//!         u32      index of the first point that follows. Points before it are those of earlier frames. Those that
//!                  the client has from this index on are replaced: the end of the curve is provisional
//!         u32      p, the number of points
//!         f32[3p]  for each point: x and y in volts, and the seconds since the point before; negative seconds begin a
//!                  new curve
//! ```

mod reader;

use crate::scope::{CHANNELS, SCOPES, Scope};
use reader::Reader;

/// The first four bytes of a frame.
const MAGIC: u32 = 0x3146_4350;
/// The flag of a machine that moves.
const MOVES: u8 = 1;
/// The flag of a clock that stands.
const PAUSED: u8 = 2;
/// The flag of a lamp that is lit.
const OVERLOAD: u8 = 4;
/// The flag of a machine that a fault stopped.
const STOPPED: u8 = 8;
/// The number of modes.
const MODES: u8 = 7;

/// The part of a frame that does not depend on the patch.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FrameHeader {
    /// Revision of the patch.
    pub revision: u32,
    /// Problem time in seconds.
    pub time: f64,
    /// Seconds of problem time that the last advance covered, divided by those it should have covered.
    pub factor: f64,
    /// The mode: its position in `command::Mode`.
    pub mode: u8,
    /// Whether the machine moves.
    pub moves: bool,
    /// Whether the clock stands.
    pub paused: bool,
    /// Whether a fault stopped the machine.
    pub stopped: bool,
    /// Number of the output whose lamp lit first.
    pub first_lamp: Option<usize>,
    /// Repetitions since repetitive operation began.
    pub repetitions: u32,
    /// The voltmeter in volts; absent if it is disconnected.
    pub meter: Option<f64>,
    /// The null meter in volts; absent if it is disconnected.
    pub null_meter: Option<f64>,
}

/// The content of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// The part that does not depend on the patch.
    pub header: FrameHeader,
    /// Whether a lamp is lit.
    pub overload: bool,
    /// The voltages of all outputs.
    pub volts: Vec<f32>,
    /// Whether the lamp of each output is lit.
    pub lamps: Vec<bool>,
    /// The pictures of the scopes.
    pub scopes: [Picture; SCOPES],
}

/// What is new on the screen of a scope.
#[derive(Debug, Clone, PartialEq)]
pub enum Picture {
    /// Channels against time.
    Time(TimePicture),
    /// One channel against the other one.
    Plane(PlanePicture),
}

/// The present trace against time.
#[derive(Debug, Clone, PartialEq)]
pub struct TimePicture {
    /// A number that grows from trace to trace.
    pub generation: u32,
    /// Problem time at the left edge in seconds.
    pub left: f64,
    /// Seconds per column.
    pub column_seconds: f64,
    /// Number of columns that the trace has reached.
    pub reached: usize,
    /// Minimum and maximum of each column in volts, for each channel in use. Both are NaN in an empty column.
    pub channels: [Option<Vec<[f32; 2]>>; CHANNELS],
}

/// The new part of an X-Y curve.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanePicture {
    /// A number that grows from curve to curve.
    pub generation: u32,
    /// Index of the first point. It replaces the points that the client has from there on.
    pub first: usize,
    /// For each point: x and y in volts, and the seconds since the point before. Negative seconds begin a curve.
    pub points: Vec<[f32; 3]>,
}

/// Why bytes are not a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum FrameError {
    /// They do not begin like a frame.
    #[error("the data do not begin with the letters PCF1: they are not a frame")]
    OtherFormat,
    /// They end too early.
    #[error("the frame ends after {length} bytes, inside of its content")]
    TooShort {
        /// The number of bytes.
        length: usize,
    },
    /// They continue after the frame.
    #[error("{extra} bytes follow after the end of the frame")]
    TooLong {
        /// The number of bytes after the frame.
        extra: usize,
    },
    /// A value has no meaning.
    #[error("the frame has the {field} {value}, which this version does not know")]
    UnknownValue {
        /// What the value is.
        field: &'static str,
        /// The value.
        value: u32,
    },
}

/// A frame as bytes. There are as many lamps as voltages, and [`SCOPES`] scopes.
pub fn encode(header: &FrameHeader, volts: &[f64], lamps: &[bool], scopes: &mut [Scope]) -> Vec<u8> {
    debug_assert_eq!((volts.len(), SCOPES), (lamps.len(), scopes.len()));
    let flags = [
        (header.moves, MOVES),
        (header.paused, PAUSED),
        (lamps.contains(&true), OVERLOAD),
        (header.stopped, STOPPED),
    ];
    let first_lamp = header.first_lamp.and_then(|output| u16::try_from(output + 1).ok()).unwrap_or(0);
    let mut out = Vec::new();
    out.extend_from_slice(&MAGIC.to_le_bytes());
    out.extend_from_slice(&header.revision.to_le_bytes());
    out.extend_from_slice(&header.time.to_le_bytes());
    out.extend_from_slice(&header.factor.to_le_bytes());
    out.push(header.mode);
    out.push(flags.iter().filter(|(is_set, _)| *is_set).map(|(_, flag)| flag).sum());
    out.extend_from_slice(&first_lamp.to_le_bytes());
    out.extend_from_slice(&header.repetitions.to_le_bytes());
    for meter in [header.meter, header.null_meter] {
        out.extend_from_slice(&meter.unwrap_or(f64::NAN).to_le_bytes());
    }
    out.extend_from_slice(&(volts.len() as u32).to_le_bytes());
    volts.iter().for_each(|volts| out.extend_from_slice(&(*volts as f32).to_le_bytes()));
    out.extend(lamps.iter().map(|is_lit| u8::from(*is_lit)));
    out.resize(out.len().next_multiple_of(4), 0);
    scopes.iter_mut().for_each(|scope| scope.encode(&mut out));
    out
}

/// The content of a frame.
///
/// # Errors
///
/// The bytes are not a frame of this version.
pub fn decode(bytes: &[u8]) -> Result<Frame, FrameError> {
    let mut reader = Reader::new(bytes);
    if reader.u32() != Ok(MAGIC) {
        return Err(FrameError::OtherFormat);
    }
    let (header, overload) = decode_header(&mut reader)?;
    let outputs = reader.count()?;
    let volts = reader.f32s::<1>(outputs)?.into_iter().map(|[volts]| volts).collect();
    let lamps = reader.bytes(outputs)?.iter().map(|lamp| *lamp != 0).collect();
    reader.bytes(outputs.next_multiple_of(4) - outputs)?;
    let scopes = [decode_picture(&mut reader)?, decode_picture(&mut reader)?];
    match reader.remaining() {
        0 => Ok(Frame { header, overload, volts, lamps, scopes }),
        extra => Err(FrameError::TooLong { extra }),
    }
}

/// The header after the first four bytes, and whether a lamp is lit.
fn decode_header(reader: &mut Reader) -> Result<(FrameHeader, bool), FrameError> {
    let revision = reader.u32()?;
    let (time, factor) = (reader.f64()?, reader.f64()?);
    let (mode, flags) = (reader.u8()?, reader.u8()?);
    if mode >= MODES {
        return Err(FrameError::UnknownValue { field: "mode", value: mode.into() });
    }
    let first_lamp = usize::from(reader.u16()?).checked_sub(1);
    let repetitions = reader.u32()?;
    let [meter, null_meter] = [reader.f64()?, reader.f64()?].map(|volts| (!volts.is_nan()).then_some(volts));
    let header = FrameHeader {
        revision,
        time,
        factor,
        mode,
        moves: flags & MOVES != 0,
        paused: flags & PAUSED != 0,
        stopped: flags & STOPPED != 0,
        first_lamp,
        repetitions,
        meter,
        null_meter,
    };
    Ok((header, flags & OVERLOAD != 0))
}

/// The picture of a scope.
fn decode_picture(reader: &mut Reader) -> Result<Picture, FrameError> {
    let display = reader.u32()?;
    let generation = reader.u32()?;
    let count = reader.u32()?;
    match display {
        0 => decode_time(reader, generation, count).map(Picture::Time),
        1 => decode_plane(reader, generation, count).map(Picture::Plane),
        value => Err(FrameError::UnknownValue { field: "display", value }),
    }
}

/// The trace of a scope, after the number of channels in use.
fn decode_time(reader: &mut Reader, generation: u32, count: u32) -> Result<TimePicture, FrameError> {
    let (left, column_seconds) = (reader.f64()?, reader.f64()?);
    let reached = reader.count()?;
    let bits = reader.u32()?;
    if bits >> CHANNELS != 0 || bits.count_ones() != count {
        return Err(FrameError::UnknownValue { field: "channels in use", value: bits });
    }
    let mut channels: [Option<Vec<[f32; 2]>>; CHANNELS] = Default::default();
    for (index, channel) in channels.iter_mut().enumerate() {
        if (bits >> index) & 1 == 1 {
            *channel = Some(reader.f32s::<2>(reached)?);
        }
    }
    Ok(TimePicture { generation, left, column_seconds, reached, channels })
}

/// The curve of a scope, after the number of curves.
fn decode_plane(reader: &mut Reader, generation: u32, count: u32) -> Result<PlanePicture, FrameError> {
    if count == 0 {
        return Ok(PlanePicture { generation, first: 0, points: Vec::new() });
    }
    if count > 1 {
        return Err(FrameError::UnknownValue { field: "number of curves", value: count });
    }
    let first = reader.count()?;
    let points = reader.count()?;
    Ok(PlanePicture { generation, first, points: reader.f32s::<3>(points)? })
}

#[cfg(test)]
mod tests;
