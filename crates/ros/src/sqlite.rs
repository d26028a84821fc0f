//! The tables of an SQLite file, read from its bytes: bags that ROS 2 recorded before Iron are such files.
//!
//! As <https://www.sqlite.org/fileformat2.html> has it, as far as reading whole tables needs it: pages, b-trees of
//! tables, records. A journal beside the file is not looked at: a recorder that ended has none.

/// Pages of a tree below each other.
const DEEPEST: usize = 20;
/// A text is UTF-8.
const UTF_8: u32 = 1;
/// What a file begins with.
pub(crate) const MAGIC: &[u8] = b"SQLite format 3\0";

/// A value of a row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    /// None.
    Null,
    /// A whole number.
    Integer(i64),
    /// A number.
    Real(f64),
    /// A text.
    Text(String),
    /// Bytes.
    Blob(Vec<u8>),
}

impl Value {
    /// A whole number.
    pub(crate) fn integer(&self) -> Option<i64> {
        match self {
            Self::Integer(value) => Some(*value),
            _ => None,
        }
    }

    /// A text.
    pub(crate) fn text(&self) -> Option<&str> {
        match self {
            Self::Text(value) => Some(value),
            _ => None,
        }
    }
}

/// An SQLite file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Database<'a> {
    bytes: &'a [u8],
    page_size: usize,
    /// Of a page, without what extensions keep at its end.
    usable: usize,
}

impl<'a> Database<'a> {
    /// A file by its bytes; `None` if it is none, or has texts in UTF-16.
    pub(crate) fn open(bytes: &'a [u8]) -> Option<Self> {
        let size = usize::from(u16_at(bytes, 16)?);
        let page_size = if size == 1 { 65_536 } else { size };
        let encoding = u32::from_be_bytes(*bytes.get(56..)?.first_chunk()?);
        let is_one = bytes.starts_with(MAGIC) && page_size.is_power_of_two() && page_size >= 512;
        let usable = page_size.checked_sub(usize::from(*bytes.get(20)?))?;
        let database = Self {
            bytes,
            page_size,
            usable,
        };
        (is_one && usable >= 480 && encoding <= UTF_8).then_some(database)
    }

    /// The rows of a table, in the order of their numbers; a column that is their number is that. `None`: there is no
    /// such table, or the file is damaged.
    pub(crate) fn rows(&self, table: &str) -> Option<Vec<Vec<Value>>> {
        let mut root = None;
        // A sound file has each of its bytes in one place.
        let mut left = 2 * self.bytes.len();
        self.walk(1, 0, &mut left, &mut |_, row| {
            let is_it = row.first()?.text() == Some("table") && row.get(1)?.text() == Some(table);
            root = is_it.then(|| row.get(3)?.integer()).flatten().or(root);
            Some(())
        })?;
        let mut rows = Vec::new();
        let root = usize::try_from(root?).ok()?;
        self.walk(root, 0, &mut left, &mut |number, mut row| {
            if let Some(key @ Value::Null) = row.first_mut() {
                *key = Value::Integer(number);
            }
            rows.push(row);
            Some(())
        })?;
        Some(rows)
    }

    fn page(&self, number: usize) -> Option<&'a [u8]> {
        let from = number.checked_sub(1)?.checked_mul(self.page_size)?;
        self.bytes.get(from..from.checked_add(self.page_size)?)
    }

    fn walk(
        &self,
        number: usize,
        deep: usize,
        left: &mut usize,
        take: &mut dyn FnMut(i64, Vec<Value>) -> Option<()>,
    ) -> Option<()> {
        let page = self.page(number).filter(|_| deep < DEEPEST)?;
        *left = left.checked_sub(self.page_size)?;
        // The first page begins with the file's header.
        let at = if number == 1 { 100 } else { 0 };
        let is_leaf = match page.get(at)? {
            13 => true,
            5 => false,
            _ => return None,
        };
        let count = usize::from(u16_at(page, at + 3)?);
        let cells = at + if is_leaf { 8 } else { 12 };
        for index in 0..count {
            let cell = usize::from(u16_at(page, cells + 2 * index)?);
            if is_leaf {
                let (size, at) = varint(page, cell)?;
                let (number, at) = varint(page, at)?;
                let size = usize::try_from(size).ok()?;
                *left = left.checked_sub(size.saturating_sub(self.usable))?;
                let row = record(&self.payload(page, at, size)?)?;
                take(number, row)?;
            } else {
                self.walk(u32_at(page, cell)?, deep + 1, left, take)?;
            }
        }
        match is_leaf {
            true => Some(()),
            false => self.walk(u32_at(page, at + 8)?, deep + 1, left, take),
        }
    }

    /// A record, which may go on in pages of its own.
    fn payload(&self, page: &[u8], at: usize, size: usize) -> Option<Vec<u8>> {
        let usable = self.usable;
        if size <= usable - 35 {
            return Some(page.get(at..at + size)?.to_vec());
        }
        let least = (usable - 12) * 32 / 255 - 23;
        let local = least + (size - least) % (usable - 4);
        let local = if local <= usable - 35 { local } else { least };
        let mut payload = page.get(at..at + local)?.to_vec();
        let mut next = u32_at(page, at + local)?;
        while payload.len() < size {
            let page = self.page(next)?;
            next = u32_at(page, 0)?;
            let end = (size - payload.len()).min(usable - 4);
            payload.extend(page.get(4..4 + end)?);
        }
        Some(payload)
    }
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_be_bytes(*bytes.get(at..)?.first_chunk()?))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<usize> {
    Some(u32::from_be_bytes(*bytes.get(at..)?.first_chunk()?) as usize)
}

/// A number of one to nine bytes, and what is behind it.
fn varint(bytes: &[u8], at: usize) -> Option<(i64, usize)> {
    let mut value: i64 = 0;
    for index in 0..8 {
        let byte = *bytes.get(at + index)?;
        value = value << 7 | i64::from(byte & 0x7F);
        if byte & 0x80 == 0 {
            return Some((value, at + index + 1));
        }
    }
    let last = *bytes.get(at + 8)?;
    Some((value << 8 | i64::from(last), at + 9))
}

fn record(bytes: &[u8]) -> Option<Vec<Value>> {
    let (length, mut at) = varint(bytes, 0)?;
    let mut data = usize::try_from(length).ok()?;
    let end = data;
    let mut row = Vec::new();
    while at < end {
        let (kind, after) = varint(bytes, at)?;
        at = after;
        let size = match kind {
            0 | 8 | 9 => 0,
            1..=4 => kind as usize,
            5 => 6,
            6 | 7 => 8,
            12.. => usize::try_from((kind - 12) / 2).ok()?,
            _ => return None,
        };
        let value = bytes.get(data..data.checked_add(size)?)?;
        data += size;
        row.push(match kind {
            0 => Value::Null,
            8 | 9 => Value::Integer(kind - 8),
            7 => Value::Real(f64::from_be_bytes(*value.first_chunk()?)),
            1..=6 => {
                let sign = if value[0] & 0x80 == 0 { 0 } else { -1 };
                let digits = value.iter();
                Value::Integer(digits.fold(sign, |all, byte| all << 8 | i64::from(*byte)))
            }
            _ if kind % 2 == 0 => Value::Blob(value.to_vec()),
            _ => Value::Text(String::from_utf8_lossy(value).into_owned()),
        });
    }
    Some(row)
}
