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
//!         u32      generation: it grows when the screen is erased or a new trace begins on it
//!         u32      c, the number of channels in use (against time), or 1 (X-Y) or 0
//!   against time:
//!         f64      problem time at the left edge in seconds
//!         f64      seconds per column
//!         u32      m, the number of columns that the trace has reached, from the left
//!         u32      bits of the channels in use: 1 channel 0, 2 channel 1
//!         f32[2m]  for each channel in use: minimum and maximum of each column in volts; NaN for an empty column
//!   X-Y, if c is 1:
//!         u32      index of the first point that follows. Points before it are those of earlier frames
//!         u32      p, the number of points
//!         f32[3p]  for each point: x and y in volts, and the seconds since the point before; negative seconds begin a
//!                  new curve
//! ```
