//! The images and materials that a mesh names, fetched from beside it or from within its file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::super::text::quoted;
use super::TextureImage;
use super::beside::{MOST_BESIDE, file_beside, read_beside};

/// Files beside a mesh that are looked for: a small file may name any number.
const MOST_FILES: usize = 4096;

/// So many files that cannot be had are named; the others are counted.
const MOST_NAMED: usize = 16;

/// What is read beside a mesh, each file once.
pub(in crate::io) struct Gallery<'a> {
    /// The mesh's own file; `None` for a stream.
    base: Option<&'a Path>,
    /// Bytes that may still be read.
    left: u64,
    /// Numbers of images by what they are called in the file.
    known: BTreeMap<String, u32>,
    looked_for: usize,
    /// The images so far.
    pub(in crate::io) images: Vec<TextureImage>,
    /// The files that were read.
    pub(in crate::io) files: Vec<PathBuf>,
    /// Sentences about what could not be had.
    warnings: Vec<String>,
    /// How many there would be more.
    unsaid: usize,
}

impl<'a> Gallery<'a> {
    pub(in crate::io) fn beside(base: Option<&'a Path>) -> Self {
        Self {
            base,
            left: MOST_BESIDE,
            known: BTreeMap::new(),
            looked_for: 0,
            images: Vec::new(),
            files: Vec::new(),
            warnings: Vec::new(),
            unsaid: 0,
        }
    }

    /// The bytes of the file of this name, or why there are none.
    pub(in crate::io) fn file(&mut self, name: &str) -> Result<Vec<u8>, String> {
        let base = self.base.ok_or("it lies in another file, which a stream does not give")?;
        let elsewhere = "it is not a file in the folder of the mesh";
        let file = file_beside(name, base).ok_or(elsewhere)?;
        self.looked_for += 1;
        if self.looked_for > MOST_FILES {
            return Err(format!("more than {MOST_FILES} files are named"));
        }
        let reason = |error: std::io::Error| {
            let text = error.to_string();
            text.split(" (os error").next().unwrap_or(&text).to_owned()
        };
        let bytes = read_beside(&file, base, self.left.saturating_add(1)).map_err(reason)?.ok_or(elsewhere)?;
        self.left = self.left.checked_sub(bytes.len() as u64).ok_or("the files beside the mesh are too large")?;
        self.files.push(file);
        Ok(bytes)
    }

    /// Says something about what could not be had.
    pub(in crate::io) fn complain(&mut self, sentence: String) {
        match self.warnings.len() < MOST_NAMED {
            true => self.warnings.push(sentence),
            false => self.unsaid += 1,
        }
    }

    /// What was said.
    pub(in crate::io) fn sentences(&mut self) -> Vec<String> {
        let more = (self.unsaid > 0).then(|| format!("{} more of such files left out", self.unsaid));
        std::mem::take(&mut self.warnings).into_iter().chain(more).collect()
    }

    /// The number of the image in the file of this name, which is fetched when first asked for. Where there is none, the image has its name
    /// alone, and a sentence says why.
    pub(in crate::io) fn image(&mut self, name: &str) -> u32 {
        // Programs for Windows write its separators, which no name has elsewhere.
        let name = name.replace('\\', "/");
        self.own(name.clone(), |gallery| gallery.file(&name).map(Arc::from), &name)
    }

    /// The number of an image called `key` within the mesh's file, which `fetch` gets when it is first asked for.
    pub(in crate::io) fn own(
        &mut self,
        key: String,
        fetch: impl FnOnce(&mut Self) -> Result<Arc<[u8]>, String>,
        name: &str,
    ) -> u32 {
        if let Some(&known) = self.known.get(&key) {
            return known;
        }
        let bytes = fetch(self).unwrap_or_else(|reason| {
            let what = quoted(name.as_bytes());
            self.complain(format!("the image {what} left out: {reason}; texture coordinates are kept"));
            Arc::from([])
        });
        let number = self.images.len() as u32;
        let file_name = name.rsplit('/').next().unwrap_or_default();
        // What was written beside a mesh begins as that does; written beside another, it shall not begin as both.
        let stem = self.base.and_then(Path::file_stem).map(|stem| stem.to_string_lossy().into_owned() + "_");
        let own =
            stem.and_then(|stem| file_name.strip_prefix(&stem)).filter(|own| !own.starts_with('.') && !own.is_empty());
        let file_name = own.unwrap_or(file_name).to_owned();
        self.images.push(TextureImage { name: file_name, bytes });
        self.known.insert(key, number);
        number
    }
}
