//! How values stand in a frame: little-endian, one after another, without padding.
use arrayvec::{ArrayString, ArrayVec};

/// Longest frame before stuffing, bytes: header, body and check sum.
pub const MAX_PLAIN: usize = 1024;
/// Version, type, sequence and device time, bytes.
pub const HEADER: usize = 1 + 1 + 4 + 8;
/// The check sum at the end, bytes.
pub const CHECK: usize = 4;
/// Longest body, bytes.
pub const MAX_BODY: usize = MAX_PLAIN - HEADER - CHECK;

/// A frame that is being written.
pub(super) struct Writer {
    buffer: [u8; MAX_PLAIN],
    length: usize,
}

impl Writer {
    pub fn new() -> Self {
        Self { buffer: [0; MAX_PLAIN], length: 0 }
    }

    /// Appends bytes. There is always room: the capacity of every list comes from `MAX_BODY`.
    pub fn put(&mut self, bytes: &[u8]) {
        let end = self.length + bytes.len();
        if let Some(room) = self.buffer.get_mut(self.length..end) {
            room.copy_from_slice(bytes);
            self.length = end;
        }
    }

    pub fn written(&self) -> &[u8] {
        &self.buffer[..self.length]
    }
}

/// A frame that is being read; `None` where it ends too early.
pub(super) struct Reader<'a>(pub &'a [u8]);

impl Reader<'_> {
    pub fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (&first, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(first)
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// A value with a place in a frame.
pub(super) trait Field: Sized {
    fn write(&self, out: &mut Writer);
    fn read(from: &mut Reader<'_>) -> Option<Self>;
}

macro_rules! numbers {
    ($($number:ty)*) => {$(
        impl Field for $number {
            fn write(&self, out: &mut Writer) {
                out.put(&self.to_le_bytes());
            }
            fn read(from: &mut Reader<'_>) -> Option<Self> {
                from.take().map(Self::from_le_bytes)
            }
        }
    )*};
}
numbers!(u8 u16 u32 u64 i16 i32 f32 f64);

/// A list reaches to the end of the body, so it stands last and needs no count.
impl<T: Field, const N: usize> Field for ArrayVec<T, N> {
    fn write(&self, out: &mut Writer) {
        for item in self {
            item.write(out);
        }
    }

    fn read(from: &mut Reader<'_>) -> Option<Self> {
        let mut list = Self::new();
        while !from.is_empty() {
            list.try_push(T::read(from)?).ok()?;
        }
        Some(list)
    }
}

/// Serial number of a device: ASCII, filled up with zero bytes.
pub type Serial = ArrayString<16>;

impl Field for Serial {
    fn write(&self, out: &mut Writer) {
        let mut filled = [0; 16];
        filled[..self.len()].copy_from_slice(self.as_bytes());
        out.put(&filled);
    }

    fn read(from: &mut Reader<'_>) -> Option<Self> {
        let filled: [u8; 16] = from.take()?;
        let length = filled.iter().position(|&byte| byte == 0).unwrap_or(filled.len());
        let (text, filling) = filled.split_at(length);
        if filling.iter().any(|&byte| byte != 0) {
            return None;
        }
        printable(text).and_then(|text| Self::from(text).ok())
    }
}

/// A sentence for a person: printable ASCII up to the end of the body.
pub type Text = ArrayString<120>;

impl Field for Text {
    fn write(&self, out: &mut Writer) {
        out.put(self.as_bytes());
    }

    fn read(from: &mut Reader<'_>) -> Option<Self> {
        let text = std::mem::take(&mut from.0);
        printable(text).and_then(|text| Self::from(text).ok())
    }
}

fn printable(bytes: &[u8]) -> Option<&str> {
    let text = std::str::from_utf8(bytes).ok()?;
    bytes.iter().all(|byte| (b' '..=b'~').contains(byte)).then_some(text)
}

/// A struct whose fields stand in a frame in the order of their declaration.
macro_rules! record {
    ($(#[$about:meta])* pub struct $name:ident { $($(#[$what:meta])* pub $field:ident: $type:ty,)* }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
        pub struct $name { $($(#[$what])* pub $field: $type,)* }

        impl crate::wire::field::Field for $name {
            fn write(&self, out: &mut crate::wire::field::Writer) {
                $(self.$field.write(out);)*
            }
            fn read(from: &mut crate::wire::field::Reader<'_>) -> Option<Self> {
                Some(Self { $($field: crate::wire::field::Field::read(from)?,)* })
            }
        }
    };
}
pub(super) use record;

/// A choice that stands in a frame as one byte; any other byte makes the body unreadable.
macro_rules! choice {
    ($(#[$about:meta])* pub enum $name:ident { $($(#[$what:meta])* $variant:ident = $code:literal,)* }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
        #[serde(rename_all = "snake_case")]
        #[repr(u8)]
        pub enum $name { $($(#[$what])* $variant = $code,)* }

        impl crate::wire::field::Field for $name {
            fn write(&self, out: &mut crate::wire::field::Writer) {
                out.put(&[*self as u8]);
            }
            fn read(from: &mut crate::wire::field::Reader<'_>) -> Option<Self> {
                match <u8 as crate::wire::field::Field>::read(from)? {
                    $($code => Some(Self::$variant),)*
                    _ => None,
                }
            }
        }
    };
}
pub(super) use choice;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_stands_with_its_low_byte_first() {
        let mut out = Writer::new();
        0x0102_0304_u32.write(&mut out);
        (-2_i16).write(&mut out);
        assert_eq!(out.written(), [4, 3, 2, 1, 0xFE, 0xFF]);
    }

    #[test]
    fn a_list_longer_than_its_capacity_is_unreadable() {
        assert!(ArrayVec::<u16, 2>::read(&mut Reader(&[0; 4])).is_some());
        assert!(ArrayVec::<u16, 2>::read(&mut Reader(&[0; 6])).is_none());
        assert!(ArrayVec::<u16, 2>::read(&mut Reader(&[0; 3])).is_none());
    }

    #[test]
    fn text_is_printable_ascii() {
        assert!(Text::read(&mut Reader(b"limit 0.5 N m")).is_some());
        assert!(Text::read(&mut Reader("5 µs".as_bytes())).is_none());
        assert!(Text::read(&mut Reader(b"bell\x07")).is_none());
        assert!(Text::read(&mut Reader(&[b'x'; 121])).is_none());
    }

    #[test]
    fn a_serial_number_ends_at_its_filling() {
        assert_eq!(Serial::read(&mut Reader(b"KC-0007\0\0\0\0\0\0\0\0\0")).as_deref(), Some("KC-0007"));
        assert_eq!(Serial::read(&mut Reader(b"KC\0x\0\0\0\0\0\0\0\0\0\0\0\0")), None);
    }

    #[test]
    fn a_frame_never_grows_beyond_its_buffer() {
        let mut out = Writer::new();
        out.put(&[1; MAX_PLAIN]);
        out.put(&[2]);
        assert_eq!(out.written(), [1; MAX_PLAIN]);
    }
}
