//! The header: lines of `field: value` and `key:=value`.

use crate::io::error::{FileError, FileProblem};
use crate::io::text::quoted;

/// The lines of a header, and where the numbers begin.
pub(super) struct Header {
    /// Name in lower case, value, and line.
    fields: Vec<(String, String, usize)>,
    keys: Vec<(String, String)>,
    /// The first byte after the blank line.
    pub(super) data: usize,
    /// Lines of the header, the blank one included.
    pub(super) lines: usize,
}

/// A field's value and its line.
#[derive(Clone, Copy)]
pub(super) struct Field<'a> {
    pub(super) text: &'a str,
    pub(super) line: usize,
}

impl Header {
    pub(super) fn new(bytes: &[u8]) -> Result<Self, FileError> {
        let mut header = Self { fields: Vec::new(), keys: Vec::new(), data: bytes.len(), lines: 0 };
        let mut at = 0;
        while at < bytes.len() {
            let end = bytes[at..].iter().position(|&byte| byte == b'\n').map_or(bytes.len(), |n| at + n);
            let line = bytes[at..end].strip_suffix(b"\r").unwrap_or(&bytes[at..end]);
            header.lines += 1;
            at = (end + 1).min(bytes.len());
            if line.is_empty() {
                header.data = at;
                return Ok(header);
            }
            if header.lines > 1 && !line.starts_with(b"#") {
                header.add(line)?;
            }
        }
        // A detached header may end without a blank line; its data file is what `read` complains about.
        Ok(header)
    }

    fn add(&mut self, line: &[u8]) -> Result<(), FileError> {
        let text = String::from_utf8_lossy(line);
        if let Some((key, value)) = text.split_once(":=") {
            self.keys.push((key.trim().to_owned(), value.trim().to_owned()));
            return Ok(());
        }
        let (name, value) = text.split_once(':').ok_or_else(|| {
            FileProblem::syntax("`field: value`, `key:=value` or a blank line", quoted(line)).at_line(self.lines)
        })?;
        self.fields.push((name.trim().to_ascii_lowercase(), value.trim().to_owned(), self.lines));
        Ok(())
    }

    /// The field that goes by one of `names`.
    pub(super) fn field(&self, names: &[&str]) -> Option<Field<'_>> {
        let found = self.fields.iter().find(|(name, ..)| names.contains(&name.as_str()));
        found.map(|(_, text, line)| Field { text, line: *line })
    }

    /// The same, where it must be there.
    pub(super) fn needed(&self, names: &[&str]) -> Result<Field<'_>, FileError> {
        let none = || FileProblem::syntax(format!("the field `{}`", names[0]), "none").at_item("header");
        self.field(names).ok_or_else(none)
    }

    /// The value of a key.
    pub(super) fn key(&self, key: &str) -> Option<&str> {
        self.keys.iter().find(|(name, _)| name == key).map(|(_, value)| value.as_str())
    }
}

impl Field<'_> {
    pub(super) fn wrong(self, expected: &str) -> FileError {
        FileProblem::syntax(expected, quoted(self.text.as_bytes())).at_line(self.line)
    }

    /// Three numbers apart by blanks.
    pub(super) fn three(self) -> Result<[f64; 3], FileError> {
        let numbers: Option<Vec<f64>> = self.text.split_whitespace().map(|word| word.parse().ok()).collect();
        numbers.and_then(|n| n.try_into().ok()).ok_or_else(|| self.wrong("three numbers"))
    }

    /// Vectors such as `(1,0,0) (0,1,0)`.
    pub(super) fn vectors<const N: usize>(self) -> Result<[[f64; 3]; N], FileError> {
        let wrong = || self.wrong(if N == 1 { "a vector (x,y,z)" } else { "three vectors (x,y,z)" });
        let mut vectors = Vec::new();
        for part in self.text.split(')').map(str::trim).filter(|part| !part.is_empty()) {
            let inner = part.strip_prefix('(').ok_or_else(wrong)?;
            let numbers: Option<Vec<f64>> = inner.split(',').map(|word| word.trim().parse().ok()).collect();
            vectors.push(numbers.and_then(|n| n.try_into().ok()).ok_or_else(wrong)?);
        }
        vectors.try_into().map_err(|_| wrong())
    }
}
