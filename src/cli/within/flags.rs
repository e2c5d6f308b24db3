//! The flags of a verb, for callers that offer them under names of their own.

use clap::{Arg, ArgAction, CommandFactory};

use crate::cli::args::Cli;

/// A flag of a verb.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Flag {
    /// Its name, without the two hyphens.
    pub name: String,
    /// A sentence of help.
    pub help: String,
    /// What its value is called in the help, such as `LEN`; `None` for one that takes no value.
    pub value: Option<String>,
    /// Its value where it is not given.
    pub default: Option<String>,
    /// The words that it chooses from; none where it takes other values.
    pub choices: Vec<String>,
    /// Whether its value may be left away.
    pub optional_value: bool,
    /// Whether it must be given.
    pub required: bool,
    /// Whether it may be given several times.
    pub several: bool,
}

/// All flags of a verb, in the order of its help; `None` for a word that is no verb.
pub fn flags(verb: &str) -> Option<Vec<Flag>> {
    let mut command = Cli::command();
    command.build();
    let found = command.find_subcommand(verb)?;
    Some(
        found
            .get_arguments()
            .filter(|arg| !matches!(arg.get_id().as_str(), "help" | "version"))
            .filter_map(flag)
            .collect(),
    )
}

fn flag(arg: &Arg) -> Option<Flag> {
    let name = arg.get_long()?.to_string();
    let takes = arg.get_action().takes_values();
    let names = arg.get_value_names().unwrap_or_default();
    let choices = if takes { arg.get_possible_values() } else { Vec::new() };
    Some(Flag {
        name,
        help: arg.get_help().map(ToString::to_string).unwrap_or_default(),
        value: takes.then(|| names.first().map_or_else(|| "VALUE".into(), ToString::to_string)),
        default: takes
            .then(|| arg.get_default_values().first())
            .flatten()
            .map(|value| value.to_string_lossy().into_owned()),
        choices: choices.iter().map(|choice| choice.get_name().to_string()).collect(),
        optional_value: takes && arg.get_num_args().is_some_and(|count| count.min_values() == 0),
        required: arg.is_required_set(),
        several: matches!(arg.get_action(), ArgAction::Append) || arg.get_value_delimiter().is_some(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_are_those_of_the_help() {
        let flags = flags("repair").expect("a verb");
        let named = |name: &str| flags.iter().find(|flag| flag.name == name).expect("it is there");
        assert_eq!(named("resolution").default.as_deref(), Some("256"));
        assert_eq!(named("method").choices, ["auto", "exact", "voxel"]);
        assert_eq!(named("no-fit").value, None);
        assert!(super::flags("mend").is_none());
    }
}
