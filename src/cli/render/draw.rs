//! What `render` draws: surfaces, or slices.

use super::RenderArgs;
use super::surfaces::{Surfaces, surfaces};
use crate::cli::entries::SliceEntry;
use crate::cli::exit::Failure;
use crate::cli::given::{Given, Which};
use crate::cli::input::Input;
use crate::cli::session::Session;
use crate::cli::slice::{self, Field, SliceWords};
use crate::io::LegendEntry;
use crate::picture::Image;

/// What is drawn, and how.
pub(super) struct Inputs<'a> {
    pub(super) given: Given,
    pub(super) args: &'a RenderArgs,
}

/// What was drawn.
#[derive(Default)]
pub(super) struct Drawn {
    pub(super) images: Vec<Image>,
    /// How many of them stand beside each other on the sheet.
    pub(super) columns: usize,
    pub(super) slices: Vec<SliceEntry>,
    /// What the colours of defects and regions mean.
    pub(super) legend: Vec<LegendEntry>,
    /// What the user should know.
    pub(super) notes: Vec<String>,
}

impl From<Surfaces> for Drawn {
    fn from(surfaces: Surfaces) -> Self {
        let Surfaces { images, columns, legend, notes } = surfaces;
        Self { images, columns, legend, notes, slices: Vec::new() }
    }
}

impl Inputs<'_> {
    /// Whether slices are drawn: of the grids, or else of the meshes where that was asked for.
    pub(super) fn slices(&self) -> bool {
        !self.given.grids.is_empty() || self.args.slice.is_some()
    }

    /// The images in the order of the inputs, and what is to be said of them.
    pub(super) fn draw(&self, session: &Session) -> Result<Drawn, Failure> {
        let meshes: Vec<&Input> = self.given.meshes.iter().collect();
        match (self.slices(), self.args.turntable) {
            (true, Some(_)) => Err(Failure::usage("a turn is drawn of meshes, and this is a grid")),
            (true, None) => self.sliced(session),
            (false, _) => surfaces(&meshes, self.args, session).map(Drawn::from),
        }
    }

    /// Slices of the grids, or of all meshes, and the meshes beside grids as they are.
    fn sliced(&self, session: &Session) -> Result<Drawn, Failure> {
        let (given, args) = (&self.given, self.args);
        let sliced: Vec<Which> = match given.grids.is_empty() {
            true => given.order.clone(),
            false => given.order.iter().copied().filter(|which| matches!(which, Which::Grid(_))).collect(),
        };
        let field = |which: &Which| match *which {
            Which::Mesh(n) => Field::of_mesh(&given.meshes[n], session),
            Which::Grid(n) => Ok(Field::of_grid(&given.grids[n])),
        };
        let fields: Vec<Field<'_>> = sliced.iter().map(field).collect::<Result<_, _>>()?;
        let words = SliceWords { y_up: args.y_up, titles: &args.title, plain: args.plain };
        let choice = args.slice.unwrap_or_default();
        let mut slices = slice::draw(&fields, &choice, [args.width, args.height], &words, session)?.into_iter();
        let mut drawn = Drawn { columns: given.order.len(), ..Drawn::default() };
        for which in &given.order {
            match (sliced.contains(which).then(|| slices.next()).flatten(), *which) {
                (Some((image, entry)), _) => {
                    drawn.images.push(image);
                    drawn.slices.push(entry);
                }
                (None, Which::Mesh(n)) => {
                    let one = surfaces(&[&given.meshes[n]], args, session)?;
                    drawn.images.extend(one.images);
                    drawn.legend.extend(one.legend);
                    drawn.notes.extend(one.notes);
                }
                (None, Which::Grid(_)) => return Err(Failure::internal("a grid was not drawn")),
            }
        }
        Ok(drawn)
    }
}
