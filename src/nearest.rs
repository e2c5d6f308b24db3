//! What may have been meant by a word that is not known.

/// How far two words are from each other, in typing errors: letters that are wrong, missing, too many, or swapped. Capitals count as small letters.
pub(crate) fn apart(asked: &str, name: &str) -> usize {
    strsim::damerau_levenshtein(&asked.to_lowercase(), &name.to_lowercase())
}

/// Of some names the nearest to a word, if one is near: with one error, from five letters on two, and in shorter words also two where they have all letters
/// of the name. Of names that are as near as each other one that begins alike and is as long is taken, and of those the first.
pub(crate) fn nearest<'a>(asked: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = asked.chars().count();
    let first = |word: &str| word.chars().next().map(|c| c.to_ascii_lowercase());
    let rank = |name: &'a str| {
        let errors = apart(asked, name);
        let has_all = name.chars().all(|c| asked.contains(c));
        let allowed = if length >= 5 || has_all { 2 } else { 1 };
        // Of two different letters neither stands for the other.
        let is_near = errors == 0 || length > 1 && errors <= allowed && errors < name.chars().count();
        is_near.then_some((errors, first(asked) != first(name), name.chars().count().abs_diff(length), name))
    };
    let near = names.into_iter().filter_map(rank);
    near.min_by_key(|&(errors, differs, longer, _)| (errors, differs, longer)).map(|(.., name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_with_a_typing_error_are_found_and_others_are_not() {
        let names = ["repair", "render", "report", "mm", "m", "in", "stl", "obj", "off"];
        for (asked, name) in [
            ("reapir", "repair"),
            ("repar", "repair"),
            ("REPAIR", "repair"),
            ("rendr", "render"),
            ("raport", "report"),
            ("mn", "mm"),
            ("M", "m"),
            ("sltt", "stl"),
            ("ojb", "obj"),
            ("of", "off"),
        ] {
            assert_eq!(nearest(asked, names), Some(name), "{asked}");
        }
        for asked in ["", "x", "furlong", "step", "xyz", "transform", "dx"] {
            assert_eq!(nearest(asked, names), None, "{asked}");
        }
    }
}
