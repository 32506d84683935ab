//! A reading position in the bytes of a file, in text or in binary.

use crate::mesh::MeshError;
use std::path::Path;

/// A fault at a byte of the file.
pub(super) type FileFault = (usize, String);

/// Encoding of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    /// Little-endian: int of 4 bytes, size_t and double of 8.
    Binary,
}

/// The bytes of a file and how far they are read.
pub(super) struct MeshReader<'a> {
    bytes: &'a [u8],
    position: usize,
    pub(super) encoding: Encoding,
}

impl<'a> MeshReader<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, position: 0, encoding: Encoding::Text }
    }

    /// Returns where the next thing starts.
    pub(super) fn position(&mut self) -> usize {
        if self.encoding == Encoding::Text {
            self.skip_blanks();
        }
        self.position
    }

    /// The most items of at least one byte that can follow: what a count may make the reader reserve.
    pub(super) fn remaining(&self) -> usize {
        self.bytes.len() - self.position
    }

    pub(super) fn skip_blanks(&mut self) {
        while self.bytes.get(self.position).is_some_and(u8::is_ascii_whitespace) {
            self.position += 1;
        }
    }

    /// Returns whether only blanks are left.
    pub(super) fn is_at_end(&mut self) -> bool {
        self.skip_blanks();
        self.position == self.bytes.len()
    }

    /// The next word of text.
    pub(super) fn word(&mut self, expected: &str) -> Result<String, FileFault> {
        self.skip_blanks();
        let rest = &self.bytes[self.position..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        if length == 0 {
            return Err((self.position, truncated(expected)));
        }
        self.position += length;
        Ok(String::from_utf8_lossy(&rest[..length]).into_owned())
    }

    /// A number written as text whatever the file's encoding.
    pub(super) fn number<T: std::str::FromStr>(&mut self, expected: &str) -> Result<T, FileFault> {
        self.skip_blanks();
        let start = self.position;
        let word = self.word(expected)?;
        word.parse().map_err(|_| (start, unexpected(expected, &shown(&word))))
    }

    /// Text in quotes.
    pub(super) fn quoted(&mut self, expected: &str) -> Result<String, FileFault> {
        self.skip_blanks();
        let start = self.position;
        let rest = &self.bytes[start..];
        let line_length = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        let line = String::from_utf8_lossy(&rest[..line_length]).trim_end().to_owned();
        self.position += line_length;
        match line.strip_prefix('"').and_then(|text| text.strip_suffix('"')) {
            Some(text) => Ok(text.to_owned()),
            None if start == self.bytes.len() => Err((start, truncated(expected))),
            None => Err((start, unexpected(expected, &line))),
        }
    }

    /// The end of a line, after which binary data starts.
    pub(super) fn line_end(&mut self) -> Result<(), FileFault> {
        while let Some(&byte) = self.bytes.get(self.position) {
            if !byte.is_ascii_whitespace() {
                let found = (byte as char).escape_debug().to_string();
                return Err((self.position, unexpected("the end of the line", &found)));
            }
            self.position += 1;
            if byte == b'\n' {
                return Ok(());
            }
        }
        Ok(())
    }

    /// An int of the file's encoding.
    pub(super) fn integer(&mut self, expected: &str) -> Result<i64, FileFault> {
        match self.encoding {
            Encoding::Text => self.number(expected),
            Encoding::Binary => Ok(i32::from_le_bytes(self.take(expected)?).into()),
        }
    }

    /// A size_t of the file's encoding.
    pub(super) fn size(&mut self, expected: &str) -> Result<u64, FileFault> {
        match self.encoding {
            Encoding::Text => self.number(expected),
            Encoding::Binary => Ok(u64::from_le_bytes(self.take(expected)?)),
        }
    }

    /// A double of the file's encoding.
    pub(super) fn real(&mut self, expected: &str) -> Result<f64, FileFault> {
        match self.encoding {
            Encoding::Text => self.number(expected),
            Encoding::Binary => Ok(f64::from_le_bytes(self.take(expected)?)),
        }
    }

    fn take<const COUNT: usize>(&mut self, expected: &str) -> Result<[u8; COUNT], FileFault> {
        let bytes = self.bytes[self.position..]
            .first_chunk::<COUNT>()
            .ok_or_else(|| (self.bytes.len(), truncated(expected)))?;
        self.position += COUNT;
        Ok(*bytes)
    }

    /// The line that ends a section.
    pub(super) fn section_end(&mut self, section: &str) -> Result<(), FileFault> {
        self.skip_blanks();
        let (start, expected) = (self.position, format!("$End{section}"));
        let found = self.word(&expected)?;
        if found == expected {
            return Ok(());
        }
        Err((start, unexpected(&expected, &shown(&found))))
    }

    /// Skips a section that does not concern the mesh.
    pub(super) fn skip_section(&mut self, section: &str) -> Result<(), FileFault> {
        let end = format!("$End{section}");
        let rest = &self.bytes[self.position..];
        match rest.windows(end.len()).position(|window| window == end.as_bytes()) {
            Some(offset) => {
                self.position += offset + end.len();
                Ok(())
            }
            None => Err((self.bytes.len(), truncated(&end))),
        }
    }

    /// The trouble with its file and place: a line of text, from 1, or a byte of binary data, from 0.
    pub(super) fn error(&self, path: &Path, (position, fault): FileFault) -> MeshError {
        let place = match self.encoding {
            Encoding::Text => {
                let before = &self.bytes[..position.min(self.bytes.len())];
                format!(":{}", 1 + before.iter().filter(|&&byte| byte == b'\n').count())
            }
            Encoding::Binary => format!(", byte {position}"),
        };
        MeshError(format!("{}{place}: {fault}", path.display()))
    }
}

/// Other text than the format requires here.
pub(super) fn unexpected(expected: &str, found: &str) -> String {
    format!("expected {expected}, found '{found}'; is a count of this section wrong, or the file edited?")
}

/// Too early an end.
fn truncated(expected: &str) -> String {
    format!("the file ends where {expected} should be; it is truncated, save it again")
}

/// The beginning of a word in a message, which binary rubbish would make unreadable.
pub(super) fn shown(word: &str) -> String {
    word.chars().take(40).collect::<String>().escape_debug().to_string()
}
