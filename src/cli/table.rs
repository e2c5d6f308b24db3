//! Aligned lines.

/// A label and what stands behind it; rows of one block are aligned.
pub type Row = (&'static str, String);

/// The rows as aligned lines. Rows that follow a row of the same label go without it.
pub fn table(rows: &[Row]) -> String {
    let width = rows.iter().map(|(label, _)| label.chars().count()).max().unwrap_or(0);
    let mut before = "";
    rows.iter().fold(String::new(), |mut text, (label, value)| {
        let shown = if *label == before { "" } else { label };
        before = label;
        text.push_str(format!("{shown:width$}  {value}").trim_end());
        text.push('\n');
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_aligned_and_repeated_labels_left_out() {
        let rows: Vec<Row> = vec![("a", "one".into()), ("long", "two".into()), ("long", "three".into())];
        assert_eq!(table(&rows), "a     one\nlong  two\n      three\n");
    }
}
