//! What stands on the page beside the view: sentences, tables, charts.

use std::fmt::Write;

use glam::DVec3;

use super::chart::Histogram;
use super::escape::html;
use super::pack::data_address;

/// A part of the page with a heading.
#[derive(Debug, Clone, Default)]
pub struct Section {
    /// What it is called within the page.
    pub id: &'static str,
    /// Its heading.
    pub title: String,
    /// What stands in it.
    pub parts: Vec<Part>,
    /// Whether it is shut until a reader opens it.
    pub folded: bool,
}

/// A piece of a section.
#[derive(Debug, Clone)]
pub enum Part {
    /// A sentence or more.
    Text(String),
    /// Sentences, one below the other.
    List(Vec<String>),
    /// A table.
    Table(Table),
    /// A histogram.
    Chart(Histogram),
    /// Text as it is typed.
    Code(String),
    /// A picture.
    Picture {
        /// A PNG file.
        png: Vec<u8>,
        /// What it shows.
        caption: String,
    },
}

/// A table.
#[derive(Debug, Clone, Default)]
pub struct Table {
    /// The names of the columns.
    pub head: Vec<String>,
    /// The rows.
    pub rows: Vec<Row>,
    /// Rows that there are besides.
    pub more: usize,
}

/// A row of a table.
#[derive(Debug, Clone, Default)]
pub struct Row {
    /// Its cells.
    pub cells: Vec<String>,
    /// Where the view goes when the row is chosen.
    pub place: Option<Place>,
}

/// A place that the view can show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Where it is.
    pub at: DVec3,
    /// How large it is.
    pub size: f64,
    /// From where it is seen best: a direction, or nothing.
    pub from: DVec3,
}

/// Tables of more rows are not printed whole, and as many rows of them are.
const SHORT: usize = 14;
const PRINTED: usize = 8;

impl Section {
    pub(super) fn html(&self) -> String {
        let mut out = format!("<section id=\"{}\">", self.id);
        let _ = match self.folded {
            true => write!(out, "<details><summary><h2>{}</h2></summary>", html(&self.title)),
            false => write!(out, "<h2>{}</h2>", html(&self.title)),
        };
        self.parts.iter().for_each(|part| part.add_to(&mut out));
        out.push_str(if self.folded { "</details></section>\n" } else { "</section>\n" });
        out
    }
}

impl Part {
    fn add_to(&self, out: &mut String) {
        // Writing to a string cannot fail.
        let _ = match self {
            Self::Text(text) => write!(out, "<p>{}</p>", html(text)),
            Self::List(items) => {
                let items: String = items.iter().map(|item| format!("<li>{}</li>", html(item))).collect();
                write!(out, "<ul>{items}</ul>")
            }
            Self::Table(table) => write!(out, "{}", table.html()),
            Self::Chart(chart) => write!(out, "{}", chart.svg()),
            Self::Picture { png, caption } => {
                let (caption, address) = (html(caption), data_address("image/png", png));
                write!(
                    out,
                    "<figure class=\"slice\"><img alt=\"{caption}\" src=\"{address}\"><figcaption>{caption}</figcaption></figure>"
                )
            }
            Self::Code(text) => write!(out, "<pre><code>{}</code></pre>", html(text)),
        };
    }
}

impl Table {
    fn html(&self) -> String {
        let head: String = self.head.iter().map(|cell| format!("<th scope=\"col\">{}</th>", html(cell))).collect();
        let mut out = format!("<div class=\"wide\"><table><thead><tr>{head}</tr></thead><tbody>\n");
        let printed = if self.rows.len() > SHORT { PRINTED } else { SHORT };
        for (n, row) in self.rows.iter().enumerate() {
            let class = if n >= printed { " class=\"unprinted\"" } else { "" };
            let place = row.place.map_or(String::new(), |place| {
                let text = |p: DVec3| p.to_array().map(|x| x.to_string()).join(" ");
                format!(
                    " data-at=\"{}\" data-size=\"{}\" data-from=\"{}\"",
                    text(place.at),
                    place.size,
                    text(place.from)
                )
            });
            let cells: String = row.cells.iter().map(|cell| format!("<td>{}</td>", html(cell))).collect();
            let _ = writeln!(out, "<tr{class}{place}>{cells}</tr>");
        }
        out.push_str("</tbody></table></div>");
        if self.more > 0 {
            let _ = write!(out, "<p class=\"note\">And {} more, which the report in JSON has.</p>", self.more);
        }
        if let Some(unprinted) = self.rows.len().checked_sub(printed).filter(|&n| n > 0) {
            let _ =
                write!(out, "<p class=\"note printed\">{unprinted} further rows are on the page and not on paper.</p>");
        }
        out
    }
}
