//! Where a caller lays meshes for a verb, and finds what it made.

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::product::{GridProduct, MeshProduct, Product};
use super::{Answer, Refusal};
use crate::cli::exit::{Exit, Failure};
use crate::cli::report::RunReport;
use crate::io::{DistanceSamples, Loaded, Paint, Unit};
use crate::mesh::{TriMesh, Validity};
use crate::picture::Image;
use crate::pipeline::{TriangleKind, TriangleSource};
use crate::progress::Progress;

/// How the name of a result begins that stays in memory.
const RESULT: &str = "<result>";

/// What lies between a verb and its caller.
pub struct Desk {
    /// Hears how far the work is, and stops it.
    pub progress: Progress,
    meshes: RefCell<HashMap<PathBuf, Loaded>>,
    made: RefCell<Made>,
}

#[derive(Default)]
struct Made {
    products: Vec<Product>,
    /// Of the mesh that will be laid next: where its triangles come from, and what they are.
    sources: Option<(Vec<TriangleSource>, Vec<TriangleKind>)>,
    end: Option<(Result<Exit, Failure>, serde_json::Value)>,
}

impl Desk {
    /// One with these meshes.
    pub fn new(meshes: impl IntoIterator<Item = (PathBuf, Loaded)>, progress: Progress) -> Self {
        Self { progress, meshes: RefCell::new(meshes.into_iter().collect()), made: RefCell::default() }
    }

    /// Whether a mesh of this name lies here.
    pub fn holds(&self, path: &Path) -> bool {
        self.meshes.borrow().contains_key(path)
    }

    /// Whether what goes to `path` stays in memory.
    pub fn takes(path: &Path) -> bool {
        path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(RESULT))
    }

    /// The mesh of this name, if it lies here; it is gone then.
    pub fn take(&self, path: &Path) -> Option<Loaded> {
        self.meshes.borrow_mut().remove(path)
    }

    /// Where the triangles of the mesh come from that is laid next, and what they are.
    pub fn lay_sources(&self, sources: Vec<TriangleSource>, kinds: Vec<TriangleKind>) {
        self.made.borrow_mut().sources = Some((sources, kinds));
    }

    /// Lays a mesh.
    pub fn lay_mesh(&self, mesh: &TriMesh, validity: Validity, paint: &Paint<'_>, unit: Option<Unit>) {
        let mut made = self.made.borrow_mut();
        let (sources, kinds) = made.sources.take().unzip();
        made.products.push(Product::Mesh(Box::new(MeshProduct {
            mesh: mesh.clone(),
            validity,
            sources,
            kinds,
            colours: paint.colours.cloned(),
            texture: paint.texture.cloned(),
            unit,
        })));
    }

    /// Lays values over a lattice.
    pub fn lay_grid(&self, samples: &DistanceSamples<'_>) {
        self.made.borrow_mut().products.push(Product::Grid(GridProduct::of(samples)));
    }

    /// Lays a picture.
    pub fn lay_picture(&self, image: Image) {
        self.made.borrow_mut().products.push(Product::Picture(image));
    }

    /// How the verb has ended.
    pub fn close(&self, end: Result<Exit, Failure>, report: &RunReport) {
        let report = serde_json::to_value(report).unwrap_or_default();
        self.made.borrow_mut().end = Some((end, report));
    }

    /// What the caller finds.
    pub fn answer(&self) -> Result<Answer, Box<Refusal>> {
        let Made { products, end, .. } = self.made.take();
        match end {
            Some((Ok(exit), report)) => Ok(Answer { products, report, exit }),
            Some((Err(failure), report)) => Err(Box::new(Refusal { failure, report: Some(report) })),
            None => Err(Failure::usage("this verb does nothing within another program").into()),
        }
    }
}
