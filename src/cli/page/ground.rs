//! The meshes that were read: together as one, with their defects.

use crate::arrange::crossing_curves;
use crate::cli::exit::Failure;
use crate::cli::input::Input;
use crate::mesh::{Defects, TriMesh, defects};
use crate::page::{Classes, Cluster, DefectKind, Lines, clusters};
use crate::progress::Progress;

use super::file_name;

/// The inputs.
pub(super) struct Ground {
    /// All of them as one mesh.
    pub mesh: TriMesh,
    /// Of each input the triangles, and its name.
    pub inputs: Vec<(usize, String)>,
    /// The defects, each with the number of its input.
    pub clusters: Vec<(usize, Cluster)>,
    /// Where they are, as lines.
    pub lines: Vec<Lines>,
    /// What is wrong with each triangle.
    pub wrong: Classes,
}

/// What stands for each input where there are several: Okabe and Ito's colours.
const INPUTS: [[u8; 3]; 6] =
    [[86, 180, 233], [230, 159, 0], [0, 158, 115], [204, 121, 167], [0, 114, 178], [213, 94, 0]];

impl Ground {
    /// Of some inputs, in their order.
    pub(super) fn new(inputs: &[Input], progress: &Progress) -> Result<Self, Failure> {
        let mut made = Self {
            mesh: TriMesh::default(),
            inputs: Vec::new(),
            clusters: Vec::new(),
            lines: Vec::new(),
            wrong: Classes { name: "Defects of triangles".into(), ..Classes::default() },
        };
        let edge_kinds = [DefectKind::OpenEdges, DefectKind::NonManifoldEdges, DefectKind::Inconsistent];
        made.lines = edge_kinds.map(line_layer).into();
        for (n, input) in inputs.iter().enumerate() {
            let mesh = &input.loaded.mesh;
            let options = input.loaded.validate_options();
            let found = defects(mesh, &options, progress)?;
            made.wrong.of.extend(wrong(mesh.triangles.len(), &found));
            let edges = [&found.open_edges, &found.nonmanifold_edges, &found.inconsistent_edges];
            for (lines, edges) in made.lines.iter_mut().zip(edges) {
                lines.segments.extend(edges.iter().map(|ends| ends.map(|v| mesh.positions[v as usize])));
            }
            made.clusters.extend(clusters(mesh, &found, options.weld).into_iter().map(|cluster| (n, cluster)));
            made.inputs.push((mesh.triangles.len(), file_name(&input.label).to_string()));
            made.mesh.append(mesh);
        }
        let crossing = made.wrong.of.contains(&CROSSING) || inputs.len() > 1;
        if let Some(Ok(curves)) = crossing.then(|| crossing_curves(&made.mesh, progress)) {
            let colour = [0, 60, 136];
            made.lines.push(Lines { name: "Lines where triangles cross".into(), colour, segments: curves });
        }
        progress.check()?;
        made.lines.retain(|lines| !lines.segments.is_empty());
        made.wrong.legend = legend();
        Ok(made)
    }

    /// Which input each triangle is of, where there are several.
    pub(super) fn by_input(&self) -> Option<Classes> {
        (self.inputs.len() > 1).then(|| {
            let of =
                self.inputs.iter().enumerate().flat_map(|(n, (count, _))| std::iter::repeat_n(input_class(n), *count));
            Classes { name: INPUT.into(), of: of.collect(), legend: self.input_legend() }
        })
    }

    /// The colours of the inputs.
    pub(super) fn input_legend(&self) -> Vec<([u8; 3], String)> {
        let made_up = ([176, 190, 205], "of no input".to_string());
        let names = self.inputs.iter().take(MOST_INPUTS).enumerate();
        let of_inputs = names.map(|(n, (_, name))| (INPUTS[n % INPUTS.len()], format!("{}: {name}", n + 1)));
        std::iter::once(made_up).chain(of_inputs).collect()
    }
}

/// The name of the layer that tells inputs apart.
pub(super) const INPUT: &str = "Which input it comes from";

/// As many inputs are told apart.
const MOST_INPUTS: usize = 250;

/// The number of an input in the legend of inputs.
pub(super) fn input_class(input: usize) -> u8 {
    (input + 1).min(MOST_INPUTS) as u8
}

/// The numbers of triangles without defects, and of those that cross others.
const CROSSING: u8 = 1;

fn line_layer(kind: DefectKind) -> Lines {
    let mut name = kind.words().to_string();
    name[..1].make_ascii_uppercase();
    Lines { name, colour: kind.colour(), segments: Vec::new() }
}

fn wrong(count: usize, found: &Defects) -> Vec<u8> {
    let mut of = vec![0; count];
    for (class, list) in (CROSSING..).zip([&found.self_intersecting, &found.duplicates, &found.degenerate]) {
        list.iter().for_each(|&t| of[t as usize] = class);
    }
    of
}

fn legend() -> Vec<([u8; 3], String)> {
    let kinds = [DefectKind::Crossing, DefectKind::Repeated, DefectKind::NoArea];
    let texts = ["crosses another", "repeats another", "has no area"];
    let of_kinds = kinds.into_iter().zip(texts).map(|(kind, text)| (kind.colour(), text.to_string()));
    std::iter::once(([176, 190, 205], "no defect of its own".to_string())).chain(of_kinds).collect()
}
