//! The verbs that a batch runs.

use std::path::{Path, PathBuf};

use super::super::choices::AnyFormat;

/// What a verb makes of its input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Product {
    /// A mesh.
    Mesh,
    /// A mesh of a mesh, and a lattice of a lattice.
    Same,
    /// Values over a lattice.
    Grid,
    /// A picture.
    Picture,
    /// A report, and nothing else.
    Report,
}

/// A verb that a batch runs.
#[derive(Debug, PartialEq, Eq)]
pub struct BatchVerb {
    /// Its name.
    pub name: &'static str,
    /// What it makes.
    pub product: Product,
    /// How many inputs it takes, at least and at most.
    pub inputs: (usize, usize),
}

const ONE: (usize, usize) = (1, 1);
const SEVERAL: (usize, usize) = (2, usize::MAX);

/// All of them. Those that take several inputs are for manifests.
const VERBS: [BatchVerb; 17] = [
    BatchVerb { name: "repair", product: Product::Mesh, inputs: ONE },
    BatchVerb { name: "dilate", product: Product::Mesh, inputs: ONE },
    BatchVerb { name: "erode", product: Product::Mesh, inputs: ONE },
    BatchVerb { name: "open", product: Product::Mesh, inputs: ONE },
    BatchVerb { name: "close", product: Product::Mesh, inputs: ONE },
    BatchVerb { name: "canals", product: Product::Mesh, inputs: ONE },
    BatchVerb { name: "thicken", product: Product::Mesh, inputs: ONE },
    BatchVerb { name: "hollow", product: Product::Mesh, inputs: ONE },
    BatchVerb { name: "decimate", product: Product::Mesh, inputs: ONE },
    BatchVerb { name: "convert", product: Product::Same, inputs: ONE },
    BatchVerb { name: "sdf", product: Product::Grid, inputs: ONE },
    BatchVerb { name: "render", product: Product::Picture, inputs: (1, 2) },
    BatchVerb { name: "inspect", product: Product::Report, inputs: ONE },
    BatchVerb { name: "union", product: Product::Mesh, inputs: SEVERAL },
    BatchVerb { name: "intersection", product: Product::Mesh, inputs: SEVERAL },
    BatchVerb { name: "difference", product: Product::Mesh, inputs: SEVERAL },
    BatchVerb { name: "compare", product: Product::Report, inputs: (2, 2) },
];

/// The verb of this name, as the program's command knows it.
pub fn of_name(name: &str) -> Option<&'static BatchVerb> {
    VERBS.iter().find(|verb| verb.name == name)
}

/// The names of those that take one input.
pub fn of_one_input() -> Vec<String> {
    VERBS.iter().filter(|verb| verb.takes_one()).map(|verb| verb.name.to_owned()).collect()
}

impl BatchVerb {
    /// Whether one input is enough.
    pub fn takes_one(&self) -> bool {
        self.inputs.0 == 1
    }

    /// Whether it writes nothing but its report.
    pub fn only_reports(&self) -> bool {
        self.product == Product::Report
    }

    /// Whether it has `--max-memory`.
    pub fn caps_memory(&self) -> bool {
        !matches!(self.name, "decimate" | "convert" | "inspect" | "compare")
    }

    /// Whether `--out-format` can be this one.
    pub fn makes(&self, format: AnyFormat) -> bool {
        match self.product {
            Product::Mesh => matches!(format, AnyFormat::Mesh(_)),
            Product::Grid => matches!(format, AnyFormat::Grid(_)),
            Product::Same => true,
            Product::Picture | Product::Report => false,
        }
    }

    /// The name of what it makes of the file `name`, folders before it left as they are.
    pub fn output_name(&self, name: &Path, format: Option<AnyFormat>) -> PathBuf {
        let named = AnyFormat::from_path(name);
        let extension = match (self.product, format) {
            (Product::Report, _) => return with_more(name, "json"),
            (Product::Picture, _) => "png",
            (_, Some(format)) => format.name(),
            (_, None) if named.is_some_and(|format| self.makes(format)) => return name.to_owned(),
            (Product::Grid, None) => "vdb",
            (Product::Mesh | Product::Same, None) => "stl",
        };
        if named.is_some() { name.with_extension(extension) } else { with_more(name, extension) }
    }
}

/// `part.v2` as `part.v2.stl`.
pub fn with_more(name: &Path, extension: &str) -> PathBuf {
    let mut name = name.as_os_str().to_owned();
    name.push(".");
    name.push(extension);
    name.into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::Format;

    #[test]
    fn the_table_is_what_the_program_has() {
        use clap::CommandFactory;
        let program = super::super::super::args::Cli::command();
        for verb in &VERBS {
            let command = program.find_subcommand(verb.name).expect("a verb");
            let has = |flag| command.get_arguments().any(|argument| argument.get_long() == Some(flag));
            assert_eq!(verb.caps_memory(), has("max-memory"), "{}", verb.name);
            assert_eq!(verb.product != Product::Report, has("output"), "{}", verb.name);
        }
    }

    #[test]
    fn outputs_are_named_as_their_inputs() {
        let ply = Some(AnyFormat::Mesh(Format::Ply));
        for (verb, name, format, expected) in [
            ("repair", "sub/a.STL", None, "sub/a.STL"),
            ("repair", "sub/a.STL", ply, "sub/a.ply"),
            ("repair", "pipe", None, "pipe.stl"),
            ("repair", "part.v2", ply, "part.v2.ply"),
            ("repair", "field.vdb", None, "field.stl"),
            ("convert", "field.vdb", None, "field.vdb"),
            ("sdf", "a.obj", None, "a.vdb"),
            ("render", "a.b.obj", None, "a.b.png"),
            ("inspect", "sub/a.obj", None, "sub/a.obj.json"),
        ] {
            let verb = of_name(verb).expect("a verb");
            assert_eq!(verb.output_name(Path::new(name), format), Path::new(expected));
        }
    }
}
