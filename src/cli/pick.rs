//! `--part`: which objects of a file are meant, by their numbers or names.

use std::collections::BTreeSet;

use clap::Args;

use super::exit::Failure;
use super::words;
use crate::io::Loaded;
use crate::nearest::apart;

/// As many names are listed where one is not known.
const LISTED: usize = 5;

/// Which objects of a file `repair` works on.
#[derive(Debug, Clone, Default, Args)]
pub struct PickArgs {
    /// Work on this object alone, by its name or the number that `inspect` lists (may be given several times): with --each the others stay as they are, without it they are left out
    #[arg(long, value_name = "NAME|N")]
    pub part: Vec<String>,
}

impl PickArgs {
    /// The numbers, from 0, of the parts that are meant, of a file with parts of these names; `None` where nothing is asked for.
    pub fn numbers(&self, names: &[&str], label: &str) -> Result<Option<BTreeSet<usize>>, Failure> {
        if self.part.is_empty() {
            return Ok(None);
        }
        let mut picked = BTreeSet::new();
        for asked in &self.part {
            let named: Vec<usize> = (0..names.len()).filter(|&n| !asked.is_empty() && names[n] == asked).collect();
            if !named.is_empty() {
                picked.extend(named);
                continue;
            }
            match asked.parse::<usize>() {
                Ok(number) if (1..=names.len()).contains(&number) => {
                    picked.insert(number - 1);
                }
                _ => return Err(unknown(asked, names, label)),
            }
        }
        Ok(Some(picked))
    }

    /// Leaves the other parts of a file out.
    pub fn apply(&self, loaded: &mut Loaded, label: &str) -> Result<(), Failure> {
        let names: Vec<&str> = loaded.parts.iter().map(|part| part.name.as_str()).collect();
        if let Some(picked) = self.numbers(&names, label)? {
            loaded.keep_parts(|n| picked.contains(&n));
        }
        Ok(())
    }
}

/// No part is called so: which ones are called nearly so.
fn unknown(asked: &str, names: &[&str], label: &str) -> Failure {
    let mut near: Vec<(usize, usize)> = names
        .iter()
        .enumerate()
        .filter(|(_, name)| !name.is_empty())
        .map(|(n, name)| {
            let [asked, name] = [asked, name].map(str::to_lowercase);
            let apart = if name.contains(&asked) { 0 } else { apart(&asked, &name) };
            (apart, n)
        })
        .collect();
    near.sort_unstable();
    let mut told = BTreeSet::new();
    let near = near.into_iter().filter(|&(_, n)| told.insert(names[n])).take(LISTED);
    let near: Vec<String> = near.map(|(_, n)| format!("{} `{}`", n + 1, names[n])).collect();
    let failure =
        Failure::usage(format!("{label} has no object `{asked}`, and {} in all", words::plural(names.len(), "object")));
    match near.is_empty() {
        true => failure.hint("they have no names; `meshwright inspect` lists them with their numbers"),
        false => failure.hint(format!("the nearest names: {}; `meshwright inspect` lists all", near.join(", "))),
    }
}

/// A sentence on the objects of a file that become one; `None` where there is only one.
pub fn fused(loaded: &Loaded, label: &str) -> Option<String> {
    let count = loaded.parts.len();
    (loaded.format.has_objects() && count > 1).then(|| {
        let objects = words::plural(count, "object");
        format!("{label}: {objects} were fused into one solid; --each keeps them apart")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_before_numbers_and_unknown_ones_list_the_nearest() {
        let names = ["wheel", "2", "wheel", ""];
        let pick = |asked: &[&str]| {
            let part = asked.iter().map(ToString::to_string).collect();
            PickArgs { part }.numbers(&names, "a.3mf")
        };
        assert_eq!(pick(&[]).ok().flatten(), None);
        assert_eq!(pick(&["wheel"]).ok().flatten(), Some([0, 2].into()));
        assert_eq!(pick(&["2", "4"]).ok().flatten(), Some([1, 3].into()));
        for asked in ["5", "0", "weel", ""] {
            let failure = pick(&[asked]).expect_err("no such object");
            assert!(failure.hint.is_some_and(|hint| hint.contains("1 `wheel`")), "{asked}");
        }
    }
}
