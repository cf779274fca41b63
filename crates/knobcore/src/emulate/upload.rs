//! A motion or a model that arrives in chunks.

use crate::wire::refusal;

/// Items that arrive chunk by chunk, with the check sum of the whole.
#[derive(Debug, Clone)]
pub(super) struct Upload<T> {
    items: Vec<T>,
    bytes: crc32fast::Hasher,
    total: usize,
    check: u32,
}

/// What a chunk says of itself and of the whole.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chunk {
    pub total: u32,
    pub first: u32,
    pub check: u32,
}

impl<T> Default for Upload<T> {
    fn default() -> Self {
        Self { items: Vec::new(), bytes: crc32fast::Hasher::new(), total: 0, check: 0 }
    }
}

impl<T: Clone> Upload<T> {
    /// Takes a chunk, whose items stand in the frame as `bytes`; true when the whole is there.
    ///
    /// # Errors
    /// The code of the refusal.
    pub fn take(&mut self, chunk: Chunk, items: &[T], bytes: &[u8], most: usize) -> Result<bool, u16> {
        let (total, first) = (chunk.total as usize, chunk.first as usize);
        if total > most {
            return Err(refusal::LARGE);
        }
        if first == 0 {
            *self = Self { total, check: chunk.check, ..Self::default() };
        }
        let fits = first == self.items.len() && first + items.len() <= total && !items.is_empty();
        if !fits || total != self.total || chunk.check != self.check {
            return Err(refusal::ORDER);
        }
        self.items.extend_from_slice(items);
        self.bytes.update(bytes);
        if self.items.len() < total {
            return Ok(false);
        }
        if self.bytes.clone().finalize() != self.check {
            self.items.clear();
            return Err(refusal::CHECK);
        }
        Ok(true)
    }

    /// The whole, if it is there.
    pub fn whole(&self) -> Option<&[T]> {
        (self.total > 0 && self.items.len() == self.total).then_some(&self.items)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: &[u8] = b"a model file";

    fn chunk(first: u32, check: u32) -> Chunk {
        Chunk { total: WHOLE.len() as u32, first, check }
    }

    #[test]
    fn chunks_in_order_make_a_whole() {
        let (check, mut upload) = (crc32fast::hash(WHOLE), Upload::default());
        assert_eq!(upload.take(chunk(0, check), &WHOLE[..5], &WHOLE[..5], 100), Ok(false));
        assert_eq!(upload.whole(), None);
        assert_eq!(upload.take(chunk(5, check), &WHOLE[5..], &WHOLE[5..], 100), Ok(true));
        assert_eq!(upload.whole(), Some(WHOLE));
    }

    #[test]
    fn what_does_not_follow_is_too_large_or_is_not_what_was_promised_is_refused() {
        let (check, mut upload) = (crc32fast::hash(WHOLE), Upload::default());
        assert_eq!(upload.take(chunk(5, check), &WHOLE[5..], &WHOLE[5..], 100), Err(refusal::ORDER));
        assert_eq!(upload.take(chunk(0, check), WHOLE, WHOLE, 3), Err(refusal::LARGE));
        assert_eq!(upload.take(chunk(0, 1), WHOLE, WHOLE, 100), Err(refusal::CHECK));
        assert_eq!(upload.whole(), None);
    }
}
