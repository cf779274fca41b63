//! A motion or a model in chunks: cut by the host, put together and checked by the device.
use super::field::{Field, Writer};
use super::message::{Bytes, Message, Points};
use super::sample::Point;
use super::state::refusal;

/// The chunks of a motion, in order.
pub fn motion_chunks(motion: &[Point]) -> impl Iterator<Item = Message> {
    let capacity = Points::new().capacity();
    let (total, check) = (motion.len() as u32, check_sum(motion));
    motion.chunks(capacity).enumerate().map(move |(at, chunk)| Message::Excite {
        total,
        first: (at * capacity) as u32,
        check,
        points: chunk.iter().copied().collect(),
    })
}

/// The chunks of a model file, in order.
pub fn model_chunks(file: &[u8]) -> impl Iterator<Item = Message> {
    let capacity = Bytes::new().capacity();
    let (total, check) = (file.len() as u32, check_sum(file));
    file.chunks(capacity).enumerate().map(move |(at, chunk)| Message::Model {
        total,
        first: (at * capacity) as u32,
        check,
        bytes: chunk.iter().copied().collect(),
    })
}

/// CRC-32 of items as they stand in a frame.
fn check_sum<T: Field>(items: &[T]) -> u32 {
    let mut sum = crc32fast::Hasher::new();
    add(&mut sum, items);
    sum.finalize()
}

fn add<T: Field>(sum: &mut crc32fast::Hasher, items: &[T]) {
    for some in items.chunks(32) {
        let mut out = Writer::new();
        some.iter().for_each(|item| item.write(&mut out));
        sum.update(out.written());
    }
}

/// What a device has of an upload: points of a motion or bytes of a model.
#[derive(Debug, Clone)]
pub struct Upload<T> {
    capacity: usize,
    total: u32,
    check: u32,
    items: Vec<T>,
    sum: crc32fast::Hasher,
}

// Points and bytes: what else stands in a frame is nobody else's business.
#[allow(private_bounds)]
impl<T: Field + Copy> Upload<T> {
    /// Nothing yet, and room for so many items.
    pub fn new(capacity: usize) -> Self {
        Self { capacity, total: 0, check: 0, items: Vec::new(), sum: crc32fast::Hasher::new() }
    }

    /// All items; none while some are missing.
    pub fn whole(&self) -> Option<&[T]> {
        (self.total > 0 && self.items.len() == self.total as usize).then_some(&self.items)
    }

    /// What is there so far, in order.
    pub fn so_far(&self) -> &[T] {
        &self.items
    }

    /// Takes a chunk. The first chunk forgets what was there; a chunk that is already there changes nothing.
    ///
    /// # Errors
    /// The `refusal` code.
    pub fn take(&mut self, total: u32, first: u32, check: u32, chunk: &[T]) -> Result<(), u16> {
        if first == 0 {
            *self = Self { total, check, ..Self::new(self.capacity) };
            if total as usize > self.capacity {
                self.total = 0;
                return Err(refusal::LARGE);
            }
        }
        let (from, have) = (first as usize, self.items.len());
        let to = from.saturating_add(chunk.len());
        if chunk.is_empty() || (total, check) != (self.total, self.check) || to > total as usize {
            return Err(refusal::ORDER);
        }
        if to <= have {
            return Ok(());
        }
        if from != have {
            return Err(refusal::ORDER);
        }
        self.items.extend_from_slice(chunk);
        add(&mut self.sum, chunk);
        if self.whole().is_some() && self.sum.clone().finalize() != check {
            *self = Self::new(self.capacity);
            return Err(refusal::CHECK);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion(points: usize) -> Vec<Point> {
        (0..points).map(|i| Point { theta: 1e-3 * i as f64, omega: 5.0, alpha: -0.5 }).collect()
    }

    fn give(upload: &mut Upload<Point>, chunk: &Message) -> Result<(), u16> {
        let Message::Excite { total, first, check, points } = chunk else { panic!("{chunk:?}") };
        upload.take(*total, *first, *check, points)
    }

    #[test]
    fn what_the_host_cut_the_device_puts_together() {
        let mut upload = Upload::new(1000);
        let motion = motion(130);
        for chunk in motion_chunks(&motion) {
            assert!(upload.whole().is_none());
            assert_eq!(give(&mut upload, &chunk), Ok(()));
        }
        assert_eq!(upload.whole(), Some(&motion[..]));
        let (file, mut upload) = (vec![b'#'; 2500], Upload::new(4096));
        for chunk in model_chunks(&file) {
            let Message::Model { total, first, check, bytes } = chunk else { panic!("{chunk:?}") };
            assert_eq!(upload.take(total, first, check, &bytes), Ok(()));
        }
        assert_eq!(upload.whole(), Some(&file[..]));
    }

    #[test]
    fn a_lost_chunk_is_noticed_and_a_repeated_one_changes_nothing() {
        let motion = motion(200);
        let chunks: Vec<_> = motion_chunks(&motion).collect();
        let mut upload = Upload::new(1000);
        assert_eq!(give(&mut upload, &chunks[0]), Ok(()));
        assert_eq!(give(&mut upload, &chunks[2]), Err(refusal::ORDER));
        assert_eq!(give(&mut upload, &chunks[1]), Ok(()));
        assert_eq!(give(&mut upload, &chunks[1]), Ok(()));
        assert_eq!(give(&mut upload, &chunks[2]), Ok(()));
        assert_eq!(give(&mut upload, &chunks[3]), Ok(()));
        assert_eq!(upload.whole(), Some(&motion[..]));
    }

    #[test]
    fn chunks_of_two_uploads_are_never_mixed() {
        let (motion, mut other) = (motion(100), motion(100));
        other[99].omega = 6.0;
        let [one, two] = [&motion, &other].map(|points| motion_chunks(points).collect::<Vec<_>>());
        let mut upload = Upload::new(1000);
        assert_eq!(give(&mut upload, &one[0]), Ok(()));
        assert_eq!(give(&mut upload, &two[1]), Err(refusal::ORDER));
    }

    #[test]
    fn a_wrong_check_sum_leaves_nothing() {
        let mut upload = Upload::new(1000);
        assert_eq!(upload.take(2, 0, 7, &motion(2)), Err(refusal::CHECK));
        assert!(upload.whole().is_none());
    }

    #[test]
    fn what_is_too_large_is_refused_at_once() {
        let mut upload = Upload::new(10);
        let motion = motion(100);
        let chunks: Vec<_> = motion_chunks(&motion).collect();
        assert_eq!(give(&mut upload, &chunks[0]), Err(refusal::LARGE));
        assert_eq!(give(&mut upload, &chunks[1]), Err(refusal::ORDER));
    }
}
