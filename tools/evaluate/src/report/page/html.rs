//! Markup: sections, tables and figures, by XML's rules, so that any parser reads the page.

pub(super) use crate::plot::escape;
use crate::report::Sheet;

/// A part of the page under a heading; `id` is what the contents link to.
pub(super) fn section(id: &str, title: &str, body: &str) -> String {
    format!(
        "<section id=\"{id}\">\n<h2>{}</h2>\n{body}</section>\n",
        escape(title)
    )
}

/// A paragraph of plain text.
pub(super) fn paragraph(text: &str) -> String {
    format!("<p>{}</p>\n", escape(text))
}

/// Terms, each with its text.
pub(super) fn definition_list(entries: &[(&str, String)]) -> String {
    let mut list = String::from("<dl>\n");
    for (term, text) in entries {
        list += &format!("<dt>{}</dt><dd>{}</dd>\n", escape(term), escape(text));
    }
    list + "</dl>\n"
}

/// A heading within a section.
pub(super) fn subheading(text: &str) -> String {
    format!("<h3>{}</h3>\n", escape(text))
}

/// A table of a sheet, whose first column names the rows.
pub(super) fn table(caption: &str, sheet: &Sheet) -> String {
    let words: Vec<&str> = (0..sheet.heading.len())
        .map(|i| if is_text(sheet, i) { WORDS } else { "" })
        .collect();
    classed_table(caption, sheet, &words)
}

/// A table of words of which one column is marked as the best.
pub(super) fn marked_table(caption: &str, sheet: &Sheet, marked: usize) -> String {
    let mut classes = vec![WORDS; sheet.heading.len()];
    if let Some(class) = classes.get_mut(marked) {
        *class = " class=\"words best\"";
    }
    classed_table(caption, sheet, &classes)
}

/// A table whose cells have the classes of their columns.
fn classed_table(caption: &str, sheet: &Sheet, words: &[&str]) -> String {
    let heading: String = sheet
        .heading
        .iter()
        .zip(words)
        .map(|(h, class)| column_head(h, if class.is_empty() { "" } else { WORDS }))
        .collect();
    let mut body = String::new();
    for row in &sheet.rows {
        body += &table_row(row, words);
    }
    framed(caption, &format!("<tr>{heading}</tr>\n"), &body)
}

/// A row, whose first cell names it; `classes` are those of the columns.
fn table_row(cells: &[String], classes: &[&str]) -> String {
    let mut row = String::from("<tr>");
    for (i, cell) in cells.iter().enumerate() {
        let text = escape(cell);
        if i == 0 {
            row += &format!("<th scope=\"row\">{text}</th>");
        } else {
            row += &format!("<td{}>{text}</td>", classes.get(i).unwrap_or(&""));
        }
    }
    row + "</tr>\n"
}

/// Marks columns of words, which begin on the left.
const WORDS: &str = " class=\"words\"";

/// Whether no cell of a column is a figure.
fn is_text(sheet: &Sheet, column: usize) -> bool {
    sheet.rows.iter().all(|row| {
        row.get(column)
            .is_some_and(|cell| cell.starts_with(char::is_alphabetic))
    })
}

/// A heading of a column; `attributes` begin with a space.
pub(super) fn column_head(text: &str, attributes: &str) -> String {
    format!("<th scope=\"col\"{attributes}>{}</th>", escape(text))
}

/// A table from rows of markup, in a frame that scrolls where the screen is narrow.
pub(super) fn framed(caption: &str, head: &str, body: &str) -> String {
    let caption = escape(caption);
    format!(
        "<div class=\"wide\" role=\"region\" aria-label=\"{caption}\" tabindex=\"0\"><table>\n\
         <caption>{caption}</caption>\n<thead>\n{head}</thead>\n<tbody>\n{body}</tbody>\n</table></div>\n",
    )
}

/// A part that is folded away until a reader opens it.
pub(super) fn folded(title: &str, body: &str) -> String {
    format!(
        "<details>\n<summary>{}</summary>\n{body}</details>\n",
        escape(title)
    )
}

/// Charts side by side, as many as the screen holds.
pub(super) fn charts<'a>(pictures: impl IntoIterator<Item = &'a String>) -> String {
    grid_of_charts("charts", pictures)
}

/// Charts side by side, two in a row at most.
pub(super) fn chart_pairs<'a>(pictures: impl IntoIterator<Item = &'a String>) -> String {
    grid_of_charts("charts pairs", pictures)
}

fn grid_of_charts<'a>(class: &str, pictures: impl IntoIterator<Item = &'a String>) -> String {
    let figures: String = pictures
        .into_iter()
        .map(|svg| format!("<figure class=\"chart\">\n{svg}</figure>\n"))
        .collect();
    format!("<div class=\"{class}\">\n{figures}</div>\n")
}
