//! What kind of failure ended a run: a word for programs, beside the sentence for people.

use serde::Serialize;
use serde_json::{Value, json};

use crate::arrange::ArrangeError;
use crate::pipeline::{LimitError, Trouble};

/// What kind of failure ended a run. In reports its name is written with hyphens: `nothing-enclosed`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Class {
    /// The program has a bug.
    Internal,
    /// Options that contradict each other or ask for what cannot be.
    Usage,
    /// A limit that the caller has set does not hold: `--fail-on`, `--max-memory` that was exceeded.
    Limit,
    /// An input that cannot be read, or that the verb cannot take.
    Input,
    /// No triangle of an input has an area. Field: `operand`.
    Empty,
    /// The result would enclose nothing. Field: `reason`, and those of the reason.
    NothingEnclosed,
    /// An operation on a solid leaves nothing. Field: `thinner_than`, model units.
    NothingLeft,
    /// What is left is thinner than the voxels. Field: `voxel`, model units.
    TooThin,
    /// More triangles or crossings than can be numbered.
    TooMany,
    /// The voxel does not go with the coordinates.
    Voxel,
    /// A closed surface is needed, and the input is none. Field: `problem`.
    NotClosed,
    /// There is no exact result. Fields of an open operand: `edges`, `operand`, `ends`.
    NotExact,
    /// What was made is no valid solid. Field: `problems`.
    NotSolid,
    /// Most of the shape is lost, and the result was not written without being asked for.
    Withheld,
    /// More memory than can be had. Fields: `needed`, `allowed`, bytes; `voxel_that_fits`, model units.
    Memory,
    /// The time has passed.
    Deadline,
    /// A file or stream cannot be written.
    Write,
    /// Interrupted.
    Interrupted,
    /// The graphics processor cannot do it.
    Device,
}

impl Class {
    /// What the trouble of a pipeline is, and what belongs to it; `None`: what the exit status tells.
    pub(super) fn of_trouble(trouble: &Trouble<'_>) -> Option<(Self, Value)> {
        Some(match trouble {
            Trouble::Empty { operand } => (Self::Empty, json!({ "operand": operand })),
            Trouble::Nothing(why) => (Self::NothingEnclosed, serde_json::to_value(why).unwrap_or_default()),
            Trouble::NothingLeft { thinner_than } => (Self::NothingLeft, json!({ "thinner_than": thinner_than })),
            Trouble::TooThin { voxel } => (Self::TooThin, json!({ "voxel": voxel })),
            Trouble::TooMany => (Self::TooMany, Value::Null),
            Trouble::Voxel => (Self::Voxel, Value::Null),
            Trouble::NotClosed { problem } => (Self::NotClosed, json!({ "problem": problem })),
            Trouble::NotExact(ArrangeError::Open { edges, first, .. }) => {
                (Self::NotExact, json!({ "edges": edges, "operand": first.operand, "ends": first.ends }))
            }
            Trouble::NotExact(_) => (Self::NotExact, Value::Null),
            Trouble::Memory(LimitError::Memory { needed, allowed, voxel_that_fits }) => {
                (Self::Memory, json!({ "needed": needed, "allowed": allowed, "voxel_that_fits": voxel_that_fits }))
            }
            Trouble::NotSolid(what) => (Self::NotSolid, json!({ "problems": what.validity.problems() })),
            Trouble::Device => (Self::Device, Value::Null),
            _ => return None,
        })
    }
}
