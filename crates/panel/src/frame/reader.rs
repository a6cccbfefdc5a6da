//! Numbers from bytes, without a panic if there are too few bytes.

use super::FrameError;

/// The bytes of a frame that are not read yet.
#[derive(Debug)]
pub(super) struct Reader<'a> {
    /// The number of all bytes.
    length: usize,
    /// The bytes that remain.
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    /// Reads from the first byte.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Reader { length: bytes.len(), rest: bytes }
    }

    /// The number of bytes that remain.
    pub(super) fn remaining(&self) -> usize {
        self.rest.len()
    }

    /// The next bytes.
    pub(super) fn bytes(&mut self, count: usize) -> Result<&'a [u8], FrameError> {
        let (bytes, rest) =
            self.rest.split_at_checked(count).ok_or(FrameError::TooShort { length: self.length })?;
        self.rest = rest;
        Ok(bytes)
    }

    /// The next bytes, if their number is known at compile time.
    fn array<const N: usize>(&mut self) -> Result<[u8; N], FrameError> {
        let (bytes, rest) =
            self.rest.split_first_chunk::<N>().ok_or(FrameError::TooShort { length: self.length })?;
        self.rest = rest;
        Ok(*bytes)
    }

    /// The next byte.
    pub(super) fn u8(&mut self) -> Result<u8, FrameError> {
        self.array().map(u8::from_le_bytes)
    }

    /// The next number of 2 bytes.
    pub(super) fn u16(&mut self) -> Result<u16, FrameError> {
        self.array().map(u16::from_le_bytes)
    }

    /// The next number of 4 bytes.
    pub(super) fn u32(&mut self) -> Result<u32, FrameError> {
        self.array().map(u32::from_le_bytes)
    }

    /// The next number of 4 bytes as an index or a count.
    pub(super) fn count(&mut self) -> Result<usize, FrameError> {
        let value = self.u32()?;
        usize::try_from(value).map_err(|_| FrameError::UnknownValue { field: "count", value })
    }

    /// The next number with a fraction.
    pub(super) fn f64(&mut self) -> Result<f64, FrameError> {
        self.array().map(f64::from_le_bytes)
    }

    /// The next groups of `N` numbers with 4 bytes each.
    pub(super) fn f32s<const N: usize>(&mut self, groups: usize) -> Result<Vec<[f32; N]>, FrameError> {
        let size = groups.checked_mul(4 * N).ok_or(FrameError::TooShort { length: self.length })?;
        let numbers = self.bytes(size)?.as_chunks::<4>().0;
        let groups = numbers.as_chunks::<N>().0.iter();
        Ok(groups.map(|group| group.map(f32::from_le_bytes)).collect())
    }
}
