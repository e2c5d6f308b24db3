//! What a page shows of the meshes of a run, until it is written.

use crate::page::{Histogram, Pane, Table};

/// What is shown beside the report.
#[derive(Default)]
pub struct Scene {
    pub(super) panes: Vec<Pane>,
    pub(super) view_title: String,
    pub(super) first: String,
    pub(super) defects: Option<Table>,
    pub(super) defects_title: String,
    pub(super) defects_text: String,
    pub(super) charts: Vec<Histogram>,
    pub(super) bodies: Option<Table>,
}
