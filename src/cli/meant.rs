//! What may have been meant by words of a command line that are not understood: verbs, flags, values, endings of names.

use clap::{Arg, Command};

use super::words;
use crate::io::{Format, GridFormat, Unit};
use crate::nearest::nearest;
use crate::picture::View;

/// As many verbs that have a flag are named.
const NAMED: usize = 3;

/// The verb whose name, or other word for it, is near.
pub fn verb<'a>(word: &str, program: &'a Command) -> Option<&'a str> {
    let names =
        program.get_subcommands().flat_map(|verb| std::iter::once(verb.get_name()).chain(verb.get_all_aliases()));
    program.find_subcommand(nearest(word, names)?).map(Command::get_name)
}

/// What there is to say of a flag, `--name` or `-n`, that a verb does not have: which one is near, and which verbs have it.
pub fn flag(word: &str, verb: &Command, program: &Command) -> Option<String> {
    let asked = word.strip_prefix("--");
    let flags = |command: &Command| -> Vec<String> {
        let long = |argument: &Arg| argument.get_long().map(|name| format!("--{name}"));
        let short = |argument: &Arg| argument.get_short().map(|name| format!("-{name}"));
        let all = command.get_arguments();
        all.filter_map(|argument| if asked.is_some() { long(argument) } else { short(argument) }).collect()
    };
    let owners = |flag: &str| -> Vec<String> {
        let has = |command: &&Command| flags(command).iter().any(|other| other == flag);
        program.get_subcommands().filter(has).map(|command| format!("`{}`", command.get_name())).collect()
    };
    let bare = |flag: &str| flag.trim_start_matches('-').to_string();
    let near = |flags: &[String]| -> Option<String> {
        let names: Vec<String> = flags.iter().map(|flag| bare(flag)).collect();
        let found = nearest(&bare(word), names.iter().map(String::as_str))?;
        flags.iter().find(|flag| bare(flag) == found).cloned()
    };
    let of_others = |flag: &str| match owners(flag) {
        none if none.is_empty() => None,
        all if all.len() <= NAMED + 1 => Some(format!("it is a flag of {}", words::list(&all))),
        mut all => {
            let more = all.split_off(NAMED).len();
            all.push(words::plural(more, "other verb"));
            Some(format!("it is a flag of {}", words::list(&all)))
        }
    };
    if let Some(told) = of_others(word) {
        return Some(told);
    }
    if let Some(own) = near(&flags(verb)) {
        return Some(format!("did you mean {own}?"));
    }
    let others: Vec<String> = program.get_subcommands().flat_map(flags).collect();
    let other = near(&others)?;
    Some(format!("did you mean {other}? {}", of_others(&other)?))
}

/// Values that may be meant by `text`, for a flag whose value is called `kind` in its help, the likeliest first.
pub fn values(kind: &str, text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut near = |names: &[&str]| found.extend(nearest(text, names.iter().copied()).map(str::to_string));
    let keywords: Vec<&str> = kind.split('|').filter(|word| word.chars().all(|c| c.is_ascii_lowercase())).collect();
    near(&keywords);
    match kind {
        "FORMAT" => near(&all_formats()),
        "UNIT" => near(&units()),
        "VIEW" => near(&View::NAMES),
        _ => {}
    }
    let suffixes: Vec<&str> = match kind {
        "DUR" => ["s", "min", "m", "h"].into(),
        "SIZE" => ["K", "M", "G", "T", "KB", "MB", "GB", "TB", "KiB", "MiB", "GiB", "TiB"].into(),
        _ => units(),
    };
    found.extend(Some(mended(text, &suffixes)).filter(|mended| mended != text));
    found
}

/// Units by their symbols and names.
fn units() -> Vec<&'static str> {
    Unit::ALL.into_iter().map(Unit::symbol).chain(Unit::ALL.into_iter().map(Unit::word)).collect()
}

/// `text` with known suffixes behind its numbers, and small letters for axes, where these are near.
pub fn mended(text: &str, suffixes: &[&str]) -> String {
    let parts = text.split_inclusive([',', '@', '=', ' ']);
    let part = |part: &str| {
        let end = part.trim_end_matches([',', '@', '=', ' ']).len();
        let (word, separator) = part.split_at(end);
        let (length, power) = ["^3", "³", "3"]
            .iter()
            .find(|power| word.strip_suffix(**power).is_some_and(|rest| rest.ends_with(char::is_alphabetic)))
            .map_or((word, ""), |power| (&word[..word.len() - power.len()], *power));
        let number = length.trim_end_matches(char::is_alphabetic);
        let suffix = &length[number.len()..];
        let known = match number.trim() {
            "" => ["x", "y", "z"].into_iter().find(|axis| suffix.eq_ignore_ascii_case(axis)),
            _ => nearest(suffix, suffixes.iter().copied()),
        };
        format!("{number}{}{power}{separator}", known.unwrap_or(suffix))
    };
    parts.map(part).collect()
}

/// A length with the unit that may be meant by what stands behind its number.
pub fn length(text: &str) -> Option<String> {
    Some(mended(text, &units())).filter(|mended| mended != text)
}

/// The names of the formats of meshes.
pub fn mesh_formats() -> Vec<&'static str> {
    Format::ALL.into_iter().map(Format::name).collect()
}

/// Those of the formats of lattices.
pub fn grid_formats() -> Vec<&'static str> {
    GridFormat::ALL.into_iter().map(GridFormat::name).collect()
}

/// All of them.
pub fn all_formats() -> Vec<&'static str> {
    [mesh_formats(), grid_formats()].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_behind_numbers_are_mended_and_numbers_are_not() {
        for (kind, text, meant) in [
            ("LEN", "0.4mn", "0.4mm"),
            ("LEN", "2inhc", "2inch"),
            ("LEN|off", "of", "off"),
            ("D@X,Y,Z", "3mn@1,2mmm,-5", "3mm@1,2mm,-5"),
            ("VOLUME", "0.5mn3", "0.5mm3"),
            ("DUR", "5mn", "5min"),
            ("DUR", "5mni", "5min"),
            ("SIZE", "2GX", "2GB"),
            ("UNIT", "inhc", "inch"),
            ("FORMAT", "sltt", "stl"),
            ("VIEW", "fornt", "front"),
            ("AXIS[=AT]", "X=50%", "x=50%"),
        ] {
            assert_eq!(values(kind, text).first().map(String::as_str), Some(meant), "{kind} {text}");
        }
        for (kind, text) in
            [("LEN", "0.4xyz"), ("LEN", "soon"), ("LEN", "-3"), ("FORMAT", "step"), ("AXIS[=AT]", "w=3")]
        {
            assert_eq!(values(kind, text), Vec::<String>::new(), "{kind} {text}");
        }
    }
}
